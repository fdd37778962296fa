//! The persons who may open the page: a file with a line `NAME ROLE HASH` for each. The hash is that of a secret, by
//! Argon2id in the PHC format. The gateway makes the secrets, so that none can be guessed.

use std::{
    fmt, fs, io,
    io::ErrorKind,
    os::unix::fs::OpenOptionsExt as _,
    path::{Path, PathBuf},
    str::FromStr,
    sync::OnceLock,
};

use argon2::{Argon2, PasswordHasher as _, PasswordVerifier as _, password_hash::phc::PasswordHash};
use os_io::{files, replace};
use rustix::process::geteuid;

use crate::{
    address::{AddressError, Name},
    keys::{self, Access},
    keyspace::random_digits,
};

/// Greatest length of a name: the run puts `page12.` before it, and shows 24 characters.
const LONGEST: usize = 16;
/// Letters of a secret: digits and letters that are not mistaken for each other (Crockford's base 32).
const LETTERS: &[u8; 32] = b"0123456789abcdefghjkmnpqrstvwxyz";
const LENGTH: usize = 16; // number of letters of a secret, of five bits each, and of a group of them
const GROUP: usize = 4;

#[derive(Debug, thiserror::Error)]
pub enum PeopleError {
    #[error("{}: {source}; rcs-gateway person add NAME --role ROLE --people FILE makes the file", .path.display())]
    File { path: PathBuf, source: io::Error },
    #[error("{}: expected a file that only user {user} can read, found {found}: use chmod 600", .path.display())]
    Open { path: PathBuf, user: u32, found: String },
    #[error("{}:{line}: expected NAME ROLE HASH as rcs-gateway person writes them, found {found:?}", .path.display())]
    Line { path: PathBuf, line: usize, found: String },
    #[error("{}: {name} already exists; for a new secret, remove the person first", .path.display())]
    Known { path: PathBuf, name: PersonName },
    #[error("{}: expected one of its persons, found {name}; rcs-gateway person list prints them", .path.display())]
    Unknown { path: PathBuf, name: PersonName },
    #[error("a secret cannot be made: {0}")]
    Secret(String),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PersonName(Name); // the name of a person: 1 to 16 letters, digits, `-`, `_` and `.`

impl FromStr for PersonName {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.parse::<Name>() {
            Ok(name) if text.len() <= LONGEST => Ok(Self(name)),
            Ok(_) => Err(format!("expected a name of at most {LONGEST} characters, found {}", text.len())),
            Err(error @ AddressError::Name(_)) => Err(error.to_string()),
            Err(error) => Err(error.to_string()),
        }
    }
}

impl fmt::Display for PersonName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// What a person may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Role {
    /// Watch the run
    Viewer,
    /// Watch and operate the run
    Operator,
}

impl fmt::Display for Role {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Viewer => "viewer",
            Self::Operator => "operator",
        })
    }
}

impl FromStr for Role {
    type Err = ();

    fn from_str(text: &str) -> Result<Self, ()> {
        [Self::Viewer, Self::Operator].into_iter().find(|role| role.to_string() == text).ok_or(())
    }
}

/// A person who may open the page. With a new secret it is another person.
#[derive(Clone, PartialEq, Eq)]
pub struct Person {
    pub name: PersonName,
    pub role: Role,
    hash: String,
}

impl Person {
    fn parse(line: &str) -> Option<Self> {
        let mut words = line.split_whitespace();
        let (name, role, hash) = (words.next()?, words.next()?, words.next()?);
        let (name, role) = (name.parse().ok()?, role.parse().ok()?);
        let is_hash = PasswordHash::new(hash).is_ok_and(|hash| hash.algorithm.as_str() == "argon2id");
        (is_hash && words.next().is_none()).then(|| Self { name, role, hash: hash.to_owned() })
    }
}

#[derive(Clone, Default)]
pub struct People(Vec<Person>);

impl People {
    /// Reads a file. Fails if it cannot be read, others can read it, or a line has another form.
    pub fn load(path: &Path) -> Result<Self, PeopleError> {
        let failed = |source| PeopleError::File { path: path.to_owned(), source };
        let text = files::read_text(path).map_err(failed)?;
        let found = match keys::access(&fs::metadata(path).map_err(failed)?) {
            Access::Private => None,
            Access::OfUser(user) => Some(format!("one of user {user}")),
            Access::Open(mode) => Some(format!("mode {mode:o}")),
        };
        if let Some(found) = found {
            return Err(PeopleError::Open { path: path.to_owned(), user: geteuid().as_raw(), found });
        }
        let mut people = Self::default();
        for (number, line) in (1..).zip(text.lines()) {
            if line.trim().is_empty() || line.starts_with('#') {
                continue;
            }
            let person = Person::parse(line).filter(|person| people.named(&person.name).is_none());
            let words = || line.split_whitespace().take(2).collect::<Vec<_>>().join(" ");
            let wrong = || PeopleError::Line { path: path.to_owned(), line: number, found: words() };
            people.0.push(person.ok_or_else(wrong)?);
        }
        Ok(people)
    }

    fn named(&self, name: &PersonName) -> Option<&Person> {
        self.0.iter().find(|person| person.name == *name)
    }

    /// True if the file has the person with the same role and secret.
    #[must_use]
    pub fn has(&self, person: &Person) -> bool {
        self.0.contains(person)
    }

    /// The person with this name and secret. It takes as long for an unknown name as for a wrong secret.
    #[must_use]
    pub fn verify(&self, name: &str, secret: &str) -> Option<&Person> {
        let person = name.parse().ok().and_then(|name| self.named(&name));
        let decoy = decoy();
        let hash: &str = match person {
            Some(person) => &person.hash,
            None => decoy,
        };
        let verified = Argon2::default().verify_password(normalized(secret).as_bytes(), hash);
        person.filter(|_| verified.is_ok())
    }
}

impl fmt::Display for People {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0
            .iter()
            .try_for_each(|person| writeln!(f, "{:LONGEST$} {}", person.name.to_string(), person.role))
    }
}

/// The hash of a secret that no person has.
fn decoy() -> &'static str {
    static DECOY: OnceLock<String> = OnceLock::new();
    DECOY.get_or_init(|| {
        let secret = random_digits().unwrap_or_default();
        hash(&secret).unwrap_or_default()
    })
}

fn hash(secret: &str) -> Result<String, PeopleError> {
    let hash = Argon2::default().hash_password(secret.as_bytes());
    hash.map(|hash| hash.to_string()).map_err(|error| PeopleError::Secret(error.to_string()))
}

/// A secret as typed: with or without hyphens and spaces, in capital letters, with O for 0 and I or L for 1.
fn normalized(secret: &str) -> String {
    let letter = |letter: char| match letter.to_ascii_lowercase() {
        'o' => '0',
        'i' | 'l' => '1',
        other => other,
    };
    secret.chars().filter(|letter| !matches!(letter, '-' | ' ')).map(letter).collect()
}

fn random_secret() -> Result<String, PeopleError> {
    let mut random = [0; LENGTH];
    getrandom::fill(&mut random).map_err(|error| PeopleError::Secret(error.to_string()))?;
    let letters: Vec<char> = random.iter().map(|byte| char::from(LETTERS[usize::from(byte % 32)])).collect();
    Ok(letters.chunks(GROUP).map(|group| group.iter().collect::<String>()).collect::<Vec<_>>().join("-"))
}

/// Adds a person to a file, which is created if missing. Returns the secret, which is stored nowhere.
pub fn add(path: &Path, name: &PersonName, role: Role) -> Result<String, PeopleError> {
    let failed = |source| PeopleError::File { path: path.to_owned(), source };
    match fs::OpenOptions::new().write(true).create_new(true).mode(0o600).open(path) {
        Err(error) if error.kind() != ErrorKind::AlreadyExists => return Err(failed(error)),
        Ok(_) | Err(_) => {}
    }
    if People::load(path)?.named(name).is_some() {
        return Err(PeopleError::Known { path: path.to_owned(), name: name.clone() });
    }
    let secret = random_secret()?;
    let line = format!("{name} {role} {}\n", hash(&normalized(&secret))?);
    let mut text = files::read_text(path).map_err(failed)?;
    if !text.is_empty() && !text.ends_with('\n') {
        text.push('\n');
    }
    replace::replace_text(path, &(text + &line)).map_err(failed)?;
    Ok(secret)
}

pub fn remove(path: &Path, name: &PersonName) -> Result<(), PeopleError> {
    let failed = |source| PeopleError::File { path: path.to_owned(), source };
    if People::load(path)?.named(name).is_none() {
        return Err(PeopleError::Unknown { path: path.to_owned(), name: name.clone() });
    }
    let text = files::read_text(path).map_err(failed)?;
    let is_other = |line: &&str| line.split_whitespace().next() != Some(&name.to_string());
    let rest: String = text.lines().filter(is_other).map(|line| format!("{line}\n")).collect();
    replace::replace_text(path, &rest).map_err(failed)
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::PermissionsExt as _;

    use super::*;

    fn name(text: &str) -> PersonName {
        text.parse().unwrap()
    }

    #[test]
    fn person_is_verified_by_the_secret_until_it_is_removed() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("people");
        let secret = add(&path, &name("anna"), Role::Operator).unwrap();
        let other = add(&path, &name("berta"), Role::Viewer).unwrap();
        assert_eq!(fs::metadata(&path).unwrap().permissions().mode() & 0o777, 0o600);
        assert!(!fs::read_to_string(&path).unwrap().contains(&secret));
        let people = People::load(&path).unwrap();
        assert_eq!(people.to_string(), "anna             operator\nberta            viewer\n");
        let typed = secret.to_uppercase().replace('-', " ").replace('0', "O").replace('1', "l");
        for good in [&secret, &typed] {
            assert_eq!(people.verify("anna", good).unwrap().role, Role::Operator, "{good}");
        }
        for (who, wrong) in [("anna", &other), ("berta", &secret), ("clara", &secret), ("", &secret)] {
            assert!(people.verify(who, wrong).is_none(), "{who}");
        }
        assert!(people.verify("anna", "").is_none() && people.verify("anna", &secret[1..]).is_none());
        let anna = people.verify("anna", &secret).unwrap();
        assert!(matches!(add(&path, &name("anna"), Role::Viewer), Err(PeopleError::Known { .. })));
        remove(&path, &name("anna")).unwrap();
        assert!(matches!(remove(&path, &name("anna")), Err(PeopleError::Unknown { .. })));
        let again = add(&path, &name("anna"), Role::Operator).unwrap();
        let renewed = People::load(&path).unwrap();
        assert!(!renewed.has(anna) && renewed.verify("anna", &secret).is_none());
        assert!(renewed.verify("anna", &again).is_some() && renewed.verify("berta", &other).is_some());
    }

    #[test]
    fn wrong_file_is_refused_with_its_line() {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("people");
        add(&path, &name("anna"), Role::Operator).unwrap();
        let good = fs::read_to_string(&path).unwrap();
        let wrong =
            ["anna", "anna operator", "anna operator x", "an/na operator $argon2id$v=19$m=8,t=1,p=1$"];
        for line in
            wrong.into_iter().map(str::to_owned).chain([good.replace("operator", "owner"), good.clone()])
        {
            fs::write(&path, format!("# comment\n\n{good}{line}")).unwrap();
            let error = People::load(&path).err().unwrap().to_string();
            assert!(error.contains("people:4: expected NAME ROLE HASH"), "{error}");
            assert!(!error.contains("argon2id"), "{error}");
        }
        fs::set_permissions(&path, fs::Permissions::from_mode(0o644)).unwrap();
        let error = People::load(&path).err().unwrap().to_string();
        assert!(error.contains("found mode 644: use chmod 600"), "{error}");
        assert!("a".repeat(17).parse::<PersonName>().unwrap_err().contains("at most 16"));
    }
}
