//! Keys and certificates: `ca.pem`, `NAME.pem` and `NAME.key` in one directory. `tools/keys.sh` makes them.
//!
//! Zenoh does not check who can read a private key, so the gateway does. It also checks its own certificate, because
//! Zenoh reports a wrong one only as a failed connection.

use std::{
    fs, io,
    os::unix::fs::MetadataExt as _,
    path::{Path, PathBuf},
};

use rustix::process::geteuid;
use x509_parser::prelude::{FromDer as _, Pem, X509Certificate};

use crate::address::Name;

const AUTHORITY: &str = "ca.pem"; // certificates of the trusted authority
/// Name of the authority's private key without its extension. No gateway or neighbour may use it.
const AUTHORITY_KEY: &str = "ca";
const OTHERS: u32 = 0o077; // mode bits of access for others than the owner

#[derive(Debug, thiserror::Error)]
pub enum KeysError {
    #[error("{}: {source}; tools/keys.sh makes keys and certificates", .path.display())]
    File { path: PathBuf, source: io::Error },
    #[error("{}: other users can read this private key (mode {mode:o}): use chmod 600", .path.display())]
    Open { path: PathBuf, mode: u32 },
    #[error("{}: expected a private key of user {expected}, found one of user {found}", .path.display())]
    Owner { path: PathBuf, expected: u32, found: u32 },
    #[error("{}: expected a certificate in PEM, found something else", .0.display())]
    Certificate(PathBuf),
    #[error("{}: expected a certificate with the common name {expected}, found {found:?}", .path.display())]
    CommonName { path: PathBuf, expected: Name, found: String },
    #[error("{}: valid from {from} until {until}, and not now: make a new certificate", .path.display())]
    Expired { path: PathBuf, from: String, until: String },
    #[error(
        "{}: expected one private key NAME.key, found {}; choose one with --name NAME",
        .directory.display(), list(.found)
    )]
    Which { directory: PathBuf, found: Vec<String> },
}

fn list(names: &[String]) -> String {
    if names.is_empty() { "none".to_owned() } else { names.join(", ") }
}

#[derive(Clone, Debug)]
pub struct Keys {
    pub name: Name,
    pub authority: PathBuf,
    pub certificate: PathBuf,
    pub key: PathBuf,
}

impl Keys {
    pub fn load(directory: &Path, name: &Name) -> Result<Self, KeysError> {
        let keys = Self {
            name: name.clone(),
            authority: directory.join(AUTHORITY),
            certificate: directory.join(format!("{name}.pem")),
            key: directory.join(format!("{name}.key")),
        };
        keys.check_key()?;
        certificate(&keys.authority, |_| Ok(()))?;
        certificate(&keys.certificate, |certificate| keys.check_certificate(certificate))?;
        Ok(keys)
    }

    /// The keys of `name` in a directory, or the only ones.
    pub fn named_or_only(directory: &Path, name: Option<&Name>) -> Result<Self, KeysError> {
        name.map_or_else(|| Self::only(directory), |name| Self::load(directory, name))
    }

    /// The only keys in a directory, apart from the authority's. Fails with [`KeysError::Which`] if there are more.
    fn only(directory: &Path) -> Result<Self, KeysError> {
        let failed = |source| KeysError::File { path: directory.to_owned(), source };
        let mut found = Vec::new();
        for entry in fs::read_dir(directory).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            if path.extension().is_some_and(|extension| extension == "key") {
                found.extend(path.file_stem().map(|stem| stem.to_string_lossy().into_owned()));
            }
        }
        found.retain(|name| name != AUTHORITY_KEY);
        found.sort();
        match found.first().map(|name| name.parse()) {
            Some(Ok(name)) if found.len() == 1 => Self::load(directory, &name),
            _ => Err(KeysError::Which { directory: directory.to_owned(), found }),
        }
    }

    fn check_key(&self) -> Result<(), KeysError> {
        let path = self.key.clone();
        let found = fs::metadata(&path).map_err(|source| KeysError::File { path: path.clone(), source })?;
        match access(&found) {
            Access::Private => Ok(()),
            Access::OfUser(found) => Err(KeysError::Owner { path, expected: geteuid().as_raw(), found }),
            Access::Open(mode) => Err(KeysError::Open { path, mode }),
        }
    }

    fn check_certificate(&self, found: &X509Certificate<'_>) -> Result<(), KeysError> {
        let path = self.certificate.clone();
        let common = found.subject().iter_common_name().next().and_then(|name| name.as_str().ok());
        if common != Some(self.name.as_str()) {
            let found = common.unwrap_or_default().to_owned();
            return Err(KeysError::CommonName { path, expected: self.name.clone(), found });
        }
        let validity = found.validity();
        if !validity.is_valid() {
            let (from, until) = (validity.not_before.to_string(), validity.not_after.to_string());
            return Err(KeysError::Expired { path, from, until });
        }
        Ok(())
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    Private,     // this user only
    OfUser(u32), // it belongs to another user
    Open(u32),   // other users can read it; its mode
}

#[must_use]
pub fn access(found: &fs::Metadata) -> Access {
    match (found.uid(), found.mode()) {
        (user, _) if user != geteuid().as_raw() => Access::OfUser(user),
        (_, mode) if mode & OTHERS != 0 => Access::Open(mode & 0o777),
        _ => Access::Private,
    }
}

fn certificate(
    path: &Path,
    check: impl FnOnce(&X509Certificate<'_>) -> Result<(), KeysError>,
) -> Result<(), KeysError> {
    let text = fs::read(path).map_err(|source| KeysError::File { path: path.to_owned(), source })?;
    let wrong = || KeysError::Certificate(path.to_owned());
    let pem = Pem::iter_from_buffer(&text).next().and_then(Result::ok).ok_or_else(wrong)?;
    let (_, found) = X509Certificate::from_der(&pem.contents).map_err(|_| wrong())?;
    check(&found)
}
