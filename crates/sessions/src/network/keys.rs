//! Authentication between machines: keys and certificates, and the roles of each certificate.
//!
//! TLS 1.3, with certificates on both sides, without tickets and early data. A directory holds
//!
//! | file | contents |
//! |---|---|
//! | `ca.pem` | certificates of the trusted authorities |
//! | `controller.pem`, `controller.key` | certificate, followed by those of intermediate authorities; private key |
//! | `workstation.pem`, `workstation.key`, ... | the same for a neighbour |
//! | `roles` | optional, at the controller: a role and a SHA-256 fingerprint on each line |
//!
//! The controller's certificate is for TLS servers and has the DNS name [`CONTROLLER_NAME`], whatever its address is.
//! A neighbour's certificate is for TLS clients. Its URI names (`rcs2:workstation`) give its roles. If there is a file
//! `roles`, its fingerprint in that file gives them instead, and certificates that are not in the file are refused,
//! even if a trusted authority has signed them. The common name is not used.

use std::{
    fmt::Write as _,
    fs, io,
    os::unix::fs::MetadataExt as _,
    path::{Path, PathBuf},
    sync::Arc,
};

use os_io::files;
use ring::digest::{SHA256, SHA256_OUTPUT_LEN, digest};
use rustls::{
    ClientConfig, ClientConnection, RootCertStore, ServerConfig, ServerConnection,
    client::Resumption,
    crypto::{CryptoProvider, ring as provider},
    pki_types::{CertificateDer, PrivateKeyDer, ServerName, pem::PemObject as _},
    server::{VerifierBuilderError, WebPkiClientVerifier},
    version::TLS13,
};
use webpki::EndEntityCert;

use super::{Address, Role};

/// The DNS name in the certificate of a controller.
pub const CONTROLLER_NAME: &str = "controller.rcs2.internal";
/// File with the certificates of the trusted authorities.
pub const AUTHORITY: &str = "ca.pem";
/// Name, without extension, of the files of a controller.
pub const CONTROLLER: &str = "controller";
/// File with the roles of fingerprints.
pub const ROLES: &str = "roles";
/// Greatest size of a file, bytes.
const LARGEST: u64 = 1 << 20;

/// SHA-256 of a certificate.
type Fingerprint = [u8; SHA256_OUTPUT_LEN];

/// Why keys cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum KeysError {
    /// A file cannot be read.
    #[error("{} cannot be read: {source}", .file.display())]
    Read {
        /// Path of the file.
        file: PathBuf,
        /// Error of the system.
        source: io::Error,
    },
    /// A private key that other users can read.
    #[error("the private key {} can be read by others than its owner: chmod 600", .0.display())]
    Public(PathBuf),
    /// A file lacks the expected PEM entry.
    #[error("{what} in PEM was expected in {}", .file.display())]
    Pem {
        /// Path of the file.
        file: PathBuf,
        /// The expected entry.
        what: &'static str,
    },
    /// A line of the file of roles has the wrong form.
    #[error("{}:{line}: a role and a SHA-256 fingerprint of 64 hexadecimal digits were expected, found {found:?}", .file.display())]
    Roles {
        /// Path of the file.
        file: PathBuf,
        /// Number of the line, from 1.
        line: usize,
        /// The line.
        found: String,
    },
    /// Certificate and private key do not match, or an authority is not valid.
    #[error("the keys in {} cannot be used: {source}", .directory.display())]
    Tls {
        /// Directory of the keys.
        directory: PathBuf,
        /// Error of the TLS library.
        source: Box<rustls::Error>,
    },
    /// No keys for an address on a network: any computer could command the robot.
    #[error("{0}: TLS with keys on both sides was expected; name their directory with --keys")]
    Missing(Address),
    /// Keys for a socket in the file system, which admits only processes of the same user anyway.
    #[error("{0}: keys are for an address that begins with tcp: or zenoh:")]
    Needless(Address),
}

impl KeysError {
    /// Check that there are keys if the address needs them, and only then.
    pub(super) fn check(address: &Address, has_keys: bool) -> Result<(), Self> {
        match (address, has_keys) {
            (Address::Unix(_), true) => Err(Self::Needless(address.clone())),
            (Address::Tcp(_) | Address::Zenoh(_), false) => Err(Self::Missing(address.clone())),
            _ => Ok(()),
        }
    }
}

/// The name of a role in a certificate.
#[must_use]
pub fn role_uri(role: Role) -> String {
    format!("rcs2:{role}")
}

/// Keys of a controller.
#[derive(Clone)]
pub struct ControllerKeys {
    config: Arc<ServerConfig>,
    roles: Option<Vec<(Role, Fingerprint)>>,
}

/// Keys of a neighbour.
#[derive(Clone)]
pub struct NeighbourKeys {
    config: Arc<ClientConfig>,
}

/// The files in a directory of one owner: the controller, or a neighbour.
struct Files {
    directory: PathBuf,
    provider: Arc<CryptoProvider>,
    authorities: Arc<RootCertStore>,
    chain: Vec<CertificateDer<'static>>,
    key: PrivateKeyDer<'static>,
}

impl Files {
    fn load(directory: &Path, owner: &str) -> Result<Self, KeysError> {
        let mut authorities = RootCertStore::empty();
        for authority in certificates(&directory.join(AUTHORITY))? {
            authorities.add(authority).map_err(tls(directory))?;
        }
        Ok(Self {
            directory: directory.to_owned(),
            provider: Arc::new(provider::default_provider()),
            authorities: Arc::new(authorities),
            chain: certificates(&directory.join(owner).with_extension("pem"))?,
            key: private_key(directory.join(owner).with_extension("key"))?,
        })
    }
}

impl ControllerKeys {
    /// Load the controller's keys from a directory.
    ///
    /// # Errors
    /// [`KeysError`].
    pub fn load(directory: &Path) -> Result<Self, KeysError> {
        let files = Files::load(directory, CONTROLLER)?;
        let tls = tls(&files.directory);
        let verifier =
            WebPkiClientVerifier::builder_with_provider(files.authorities, Arc::clone(&files.provider));
        let verifier = verifier.build().map_err(|error| match error {
            VerifierBuilderError::InvalidCrl(error) => error.into(),
            other => rustls::Error::General(other.to_string()),
        });
        let mut config = ServerConfig::builder_with_provider(files.provider)
            .with_protocol_versions(&[&TLS13])
            .map_err(&tls)?
            .with_client_cert_verifier(verifier.map_err(&tls)?)
            .with_single_cert(files.chain, files.key)
            .map_err(&tls)?;
        // No tickets: each connection is authenticated anew.
        config.send_tls13_tickets = 0;
        Ok(Self { config: Arc::new(config), roles: roles(directory.join(ROLES))? })
    }

    pub(super) fn connection(&self) -> Result<ServerConnection, rustls::Error> {
        ServerConnection::new(Arc::clone(&self.config))
    }

    /// Check that a certificate, which TLS has verified, is bound to a role; the error is a sentence with the roles it
    /// is bound to.
    pub(super) fn check(&self, certificate: &CertificateDer<'_>, role: Role) -> Result<(), String> {
        let bound = self.bound(certificate);
        if bound.contains(&role) {
            return Ok(());
        }
        let names: Vec<_> = bound.iter().map(ToString::to_string).collect();
        let names = if names.is_empty() { "no neighbour".to_owned() } else { names.join(" and ") };
        let fingerprint = hex(&fingerprint(certificate));
        Err(format!("the certificate is bound to {names}, not to {role} (SHA-256 {fingerprint})"))
    }

    fn bound(&self, certificate: &CertificateDer<'_>) -> Vec<Role> {
        if let Some(roles) = &self.roles {
            let found = fingerprint(certificate);
            return roles.iter().filter(|(_, known)| *known == found).map(|(role, _)| *role).collect();
        }
        let Ok(certificate) = EndEntityCert::try_from(certificate) else { return Vec::new() };
        let uris: Vec<&str> = certificate.valid_uri_names().collect();
        Role::ALL.into_iter().filter(|&role| uris.contains(&role_uri(role).as_str())).collect()
    }
}

impl NeighbourKeys {
    /// Load the keys of a role from a directory.
    ///
    /// # Errors
    /// [`KeysError`].
    pub fn load(directory: &Path, role: Role) -> Result<Self, KeysError> {
        let files = Files::load(directory, role.text())?;
        let tls = tls(&files.directory);
        let mut config = ClientConfig::builder_with_provider(files.provider)
            .with_protocol_versions(&[&TLS13])
            .map_err(&tls)?
            .with_root_certificates(files.authorities)
            .with_client_auth_cert(files.chain, files.key)
            .map_err(&tls)?;
        config.resumption = Resumption::disabled();
        Ok(Self { config: Arc::new(config) })
    }

    pub(super) fn connection(&self) -> Result<ClientConnection, rustls::Error> {
        let name = ServerName::try_from(CONTROLLER_NAME)
            .map_err(|error| rustls::Error::General(error.to_string()))?;
        ClientConnection::new(Arc::clone(&self.config), name)
    }
}

fn tls(directory: &Path) -> impl Fn(rustls::Error) -> KeysError {
    let directory = directory.to_owned();
    move |source| KeysError::Tls { directory: directory.clone(), source: Box::new(source) }
}

fn read(file: &Path) -> Result<Vec<u8>, KeysError> {
    files::read(file, LARGEST).map_err(|source| KeysError::Read { file: file.to_owned(), source })
}

fn certificates(file: &Path) -> Result<Vec<CertificateDer<'static>>, KeysError> {
    let read: Result<Vec<_>, _> = CertificateDer::pem_slice_iter(&read(file)?).collect();
    let found = read.ok().filter(|found| !found.is_empty());
    found.ok_or_else(|| KeysError::Pem { file: file.to_owned(), what: "a certificate" })
}

fn private_key(file: PathBuf) -> Result<PrivateKeyDer<'static>, KeysError> {
    let bytes = read(&file)?;
    match fs::metadata(&file) {
        Ok(found) if found.mode() & 0o077 != 0 => Err(KeysError::Public(file)),
        Ok(_) => {
            PrivateKeyDer::from_pem_slice(&bytes).map_err(|_| KeysError::Pem { file, what: "a private key" })
        }
        Err(source) => Err(KeysError::Read { file, source }),
    }
}

/// Read the file of roles; `None` if it does not exist.
fn roles(file: PathBuf) -> Result<Option<Vec<(Role, Fingerprint)>>, KeysError> {
    let text = match files::read_text(&file) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
        Err(source) => return Err(KeysError::Read { file, source }),
        Ok(text) => text,
    };
    let lines =
        text.lines().enumerate().map(|(at, line)| (at + 1, line.split('#').next().unwrap_or("").trim()));
    let bindings = lines.filter(|(_, line)| !line.is_empty()).map(|(line, found)| {
        binding(found).ok_or_else(|| KeysError::Roles { file: file.clone(), line, found: found.to_owned() })
    });
    bindings.collect::<Result<_, _>>().map(Some)
}

/// Parse a line such as `workstation 3A:5B:...`: with colons, as openssl prints fingerprints, or without.
fn binding(line: &str) -> Option<(Role, Fingerprint)> {
    let (role, digits) = line.split_once(char::is_whitespace)?;
    let digits: Vec<char> = digits.trim().chars().filter(|digit| *digit != ':').collect();
    let mut fingerprint = Fingerprint::default();
    if digits.len() != fingerprint.len() * 2 {
        return None;
    }
    for (byte, pair) in fingerprint.iter_mut().zip(digits.chunks(2)) {
        let digit = |at: usize| pair[at].to_digit(16).and_then(|digit| u8::try_from(digit).ok());
        *byte = digit(0)? << 4 | digit(1)?;
    }
    Some((role.parse().ok()?, fingerprint))
}

fn fingerprint(certificate: &CertificateDer<'_>) -> Fingerprint {
    let digest = digest(&SHA256, certificate);
    let mut fingerprint = Fingerprint::default();
    fingerprint.copy_from_slice(digest.as_ref());
    fingerprint
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        // Writing to a `String` does not fail.
        let _ = write!(text, "{byte:02X}");
        text
    })
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::PermissionsExt as _;

    use super::*;

    #[test]
    fn a_line_of_the_roles_is_a_role_and_a_fingerprint() {
        let colons = (0..32).map(|n| format!("{n:02x}")).collect::<Vec<_>>().join(":");
        let plain = colons.replace(':', "").to_uppercase();
        let expected: Vec<u8> = (0..32).collect();
        for digits in [&colons, &plain] {
            let (role, found) = binding(&format!("data-system  {digits}")).unwrap();
            assert_eq!(
                (role, found.to_vec(), hex(&found)),
                (Role::DataSystem, expected.clone(), plain.clone())
            );
        }
        for wrong in [
            "vision",
            "vision 00",
            &format!("foreman {plain}"),
            &format!("vision {plain}0"),
            &format!("vision é{}", &plain[1..]),
        ] {
            assert_eq!(binding(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn a_mistake_in_the_roles_is_named_with_its_line() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join(ROLES);
        assert!(roles(file.clone()).unwrap().is_none(), "there need be none");
        fs::write(&file, format!("# roles of this cell\n\nvision {}  # at the camera\n", "AB".repeat(32)))
            .unwrap();
        assert_eq!(roles(file.clone()).unwrap(), Some(vec![(Role::Vision, [0xAB; 32])]));
        fs::write(&file, "# roles of this cell\nvision\n").unwrap();
        let said = roles(file.clone()).unwrap_err().to_string();
        assert!(said.ends_with("64 hexadecimal digits were expected, found \"vision\""), "{said}");
        assert!(said.contains("roles:2:"), "{said}");
    }

    #[test]
    fn a_private_key_is_its_owners_alone() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("vision.key");
        fs::write(&file, "-----BEGIN PRIVATE KEY-----\nMA==\n-----END PRIVATE KEY-----\n").unwrap();
        for (mode, is_refused) in [(0o600, false), (0o640, true), (0o604, true), (0o400, false)] {
            fs::set_permissions(&file, fs::Permissions::from_mode(mode)).unwrap();
            let read = private_key(file.clone());
            assert_eq!(matches!(read, Err(KeysError::Public(_))), is_refused, "{mode:o}");
        }
    }

    #[test]
    fn keys_that_cannot_be_used_are_refused_in_words() {
        let place = tempfile::tempdir().unwrap();
        let said = |error: KeysError| error.to_string().replace(&place.path().display().to_string(), "DIR");
        let missing = ControllerKeys::load(place.path()).err().unwrap();
        assert!(said(missing).starts_with("DIR/ca.pem cannot be read: "));
        fs::write(place.path().join(AUTHORITY), "no certificate").unwrap();
        let empty = NeighbourKeys::load(place.path(), Role::Vision).err().unwrap();
        assert_eq!(said(empty), "a certificate in PEM was expected in DIR/ca.pem");
    }
}
