//! Logins: persons who have shown a secret, with the time of expiry. They are in memory, so a restart ends them.

use std::{
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    time::{Duration, Instant},
};

use subtle::ConstantTimeEq as _;

use crate::{keyspace::random_digits, page::people::Person};

pub const VALIDITY: Duration = Duration::from_secs(12 * 3600); // a login ends after this time: a long shift
const LOGINS: usize = 64; // greatest number of logins, and of one person
const OF_PERSON: usize = 8;
/// Greatest number of connections of a login: the page, its WebSocket, and those of a few tabs.
const CONNECTIONS: usize = 6;

pub struct Login {
    pub id: String, // value of the browser's cookie: 128 random bits
    pub person: Person,
    until: Instant,
    is_over: AtomicBool,
    open: AtomicUsize,
}

impl Login {
    #[must_use]
    pub fn is_over(&self, now: Instant) -> bool {
        self.is_over.load(Ordering::Acquire) || now >= self.until
    }
}

pub struct Connection(pub Arc<Login>); // a connection of a login; it counts until it is dropped

impl Connection {
    /// Another connection of a login; `None` if it has too many.
    #[must_use]
    pub fn open(login: Arc<Login>) -> Option<Self> {
        let connection = Self(login);
        let before = connection.0.open.fetch_add(1, Ordering::AcqRel);
        (before < CONNECTIONS).then_some(connection)
    }
}

impl Drop for Connection {
    fn drop(&mut self) {
        self.0.open.fetch_sub(1, Ordering::AcqRel);
    }
}

#[derive(Default)]
pub struct Logins(Mutex<Vec<Arc<Login>>>);

impl Logins {
    fn lock(&self) -> MutexGuard<'_, Vec<Arc<Login>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins a login. Above a limit, it ends the oldest login of the person, or of all. Fails without random bytes.
    pub fn open(&self, person: Person, now: Instant) -> Result<Arc<Login>, getrandom::Error> {
        let (is_over, open) = (AtomicBool::new(false), AtomicUsize::new(0));
        let login = Arc::new(Login { id: random_digits()?, person, until: now + VALIDITY, is_over, open });
        let mut all = self.lock();
        all.retain(|login| !login.is_over(now));
        let is_own = |other: &Arc<Login>| other.person.name == login.person.name;
        let first = if all.iter().filter(|other| is_own(other)).count() >= OF_PERSON {
            all.iter().position(is_own)
        } else {
            (all.len() >= LOGINS).then_some(0)
        };
        if let Some(first) = first {
            all.remove(first).is_over.store(true, Ordering::Release);
        }
        all.push(Arc::clone(&login));
        Ok(login)
    }

    /// The login with a cookie. The cookie is compared with all logins, each in constant time.
    #[must_use]
    pub fn find(&self, id: &str, now: Instant) -> Option<Arc<Login>> {
        let all = self.lock();
        let mut found = None;
        for login in all.iter() {
            if bool::from(login.id.as_bytes().ct_eq(id.as_bytes())) && !login.is_over(now) {
                found = Some(Arc::clone(login));
            }
        }
        found
    }

    /// Ends the logins for which `is_kept` is false, and removes those that have expired.
    pub fn retain(&self, now: Instant, is_kept: impl Fn(&Login) -> bool) {
        self.lock().retain(|login| {
            let stays = !login.is_over(now) && is_kept(login);
            login.is_over.fetch_or(!stays, Ordering::AcqRel);
            stays
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::people::{self, People, Role};

    fn persons(names: &[&str]) -> Vec<Person> {
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join("people");
        let add = |name: &&str| people::add(&path, &name.parse().unwrap(), Role::Viewer).unwrap();
        let secrets: Vec<String> = names.iter().map(add).collect();
        let people = People::load(&path).unwrap();
        names
            .iter()
            .zip(secrets)
            .map(|(name, secret)| people.verify(name, &secret).unwrap().clone())
            .collect()
    }

    #[test]
    fn login_is_found_by_its_cookie_until_it_ends() {
        let (logins, now) = (Logins::default(), Instant::now());
        let [anna, berta] = &persons(&["anna", "berta"])[..] else { panic!() };
        let first = logins.open(anna.clone(), now).unwrap();
        let second = logins.open(berta.clone(), now).unwrap();
        assert_eq!(first.id.len(), 32);
        assert!(Arc::ptr_eq(&logins.find(&first.id, now).unwrap(), &first));
        assert!(logins.find("", now).is_none() && logins.find(&first.id[1..], now).is_none());
        assert!(logins.find(&first.id, now + VALIDITY).is_none(), "it has expired");
        logins.retain(now, |login| login.person.name != anna.name);
        assert!(first.is_over(now) && logins.find(&first.id, now).is_none());
        assert!(!second.is_over(now) && logins.find(&second.id, now).is_some());
    }

    #[test]
    fn logins_and_their_connections_are_bounded() {
        let (logins, now) = (Logins::default(), Instant::now());
        let names: Vec<String> = (0..9).map(|number| format!("p{number}")).collect();
        let all = persons(&names.iter().map(String::as_str).collect::<Vec<_>>());
        let first = logins.open(all[0].clone(), now).unwrap();
        for _ in 0..OF_PERSON {
            logins.open(all[0].clone(), now).unwrap();
        }
        assert!(first.is_over(now), "the oldest login of the person ends");
        for person in &all[1..] {
            (0..OF_PERSON).for_each(|_| drop(logins.open(person.clone(), now).unwrap()));
        }
        assert_eq!(logins.lock().len(), LOGINS);
        let login = logins.open(all[1].clone(), now).unwrap();
        let open: Vec<_> = (0..CONNECTIONS).map(|_| Connection::open(Arc::clone(&login)).unwrap()).collect();
        assert!(Connection::open(Arc::clone(&login)).is_none());
        drop(open);
        assert!(Connection::open(login).is_some());
    }
}
