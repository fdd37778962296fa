//! `rcs-neighbour keys`: makes a certificate authority, and certificates for the controller and all neighbours.
//!
//! Existing files are kept. To renew a certificate, delete it and its key; the same authority then signs a new one.
//! [`sessions::network::keys`] explains the names and purposes in the certificates.

use std::{
    fs::{DirBuilder, OpenOptions},
    io::{self, Write as _},
    os::unix::fs::{DirBuilderExt as _, OpenOptionsExt as _},
    path::{Path, PathBuf},
};

use os_io::files;
use rcgen::{
    BasicConstraints, CertificateParams, DnType, ExtendedKeyUsagePurpose, IsCa, Issuer, KeyPair,
    KeyUsagePurpose, SanType,
};
use rustls_pki_types::{CertificateDer, pem::PemObject as _};
use sessions::network::{
    Role,
    keys::{AUTHORITY, CONTROLLER, CONTROLLER_NAME, role_uri},
};
use time::{Duration, OffsetDateTime};

use crate::cli::KeysArguments;

/// Common name of the authority.
const NAME: &str = "RCS-II cell authority";
/// Validity of the authority, days.
const AUTHORITY_DAYS: i64 = 3650;
/// Tolerance for clocks of other machines that are behind.
const SKEW: Duration = Duration::hours(1);
/// File mode of certificates, readable by all, and of private keys, readable by the owner.
const CERTIFICATE: u32 = 0o644;
const PRIVATE: u32 = 0o600;

/// Errors of making keys.
#[derive(Debug, thiserror::Error)]
pub enum KeysFailure {
    /// A file cannot be written; an existing file is not replaced.
    #[error("{} cannot be written: {source}", .file.display())]
    Write {
        /// Path of the file.
        file: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The authority cannot be read.
    #[error("the authority {} cannot be read: {source}", .file.display())]
    Read {
        /// Path of the file.
        file: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// Another program made the authority.
    #[error("{} is not a certificate authority of this program: sign with the program that made it, or name another directory", .0.display())]
    Foreign(PathBuf),
    /// A certificate cannot be made.
    #[error("a certificate cannot be made: {0}")]
    Make(#[from] rcgen::Error),
}

/// Contents of a certificate.
struct Subject {
    /// First part of the names of its files.
    name: &'static str,
    /// Subject alternative name: what the certificate is bound to.
    binding: SanType,
    purpose: ExtendedKeyUsagePurpose,
}

/// Makes all missing keys and certificates in a directory, and the directory if it does not exist.
pub fn make(arguments: &KeysArguments) -> Result<(), KeysFailure> {
    let directory = &arguments.directory;
    let made = DirBuilder::new().recursive(true).mode(0o700).create(directory);
    made.map_err(|source| KeysFailure::Write { file: directory.clone(), source })?;
    let mut subjects = vec![Subject {
        name: CONTROLLER,
        binding: SanType::DnsName(CONTROLLER_NAME.try_into()?),
        purpose: ExtendedKeyUsagePurpose::ServerAuth,
    }];
    for role in Role::ALL {
        subjects.push(Subject {
            name: role.text(),
            binding: SanType::URI(role_uri(role).try_into()?),
            purpose: ExtendedKeyUsagePurpose::ClientAuth,
        });
    }
    let issuer = authority(directory)?;
    for subject in subjects {
        if directory.join(subject.name).with_extension("pem").exists() {
            continue;
        }
        let key = KeyPair::generate()?;
        let mut params = params(subject.name, arguments.days.into())?;
        params.subject_alt_names = vec![subject.binding];
        params.key_usages = vec![KeyUsagePurpose::DigitalSignature];
        params.extended_key_usages = vec![subject.purpose];
        params.use_authority_key_identifier_extension = true;
        let certificate = params.signed_by(&key, &issuer)?;
        write(directory, subject.name, "pem", CERTIFICATE, &certificate.pem())?;
        write(directory, subject.name, "key", PRIVATE, &key.serialize_pem())?;
    }
    os_io::stdout_line!(
        "{} has an authority and certificates of {} days for the controller and its neighbours.\n\
         Copy {AUTHORITY}, NAME.pem and NAME.key to the machine of each; keep ca.key where no other program reads it.",
        directory.display(),
        arguments.days
    );
    Ok(())
}

/// Loads the authority of the directory, or makes a new one if there is none.
fn authority(directory: &Path) -> Result<Issuer<'static, KeyPair>, KeysFailure> {
    let (certificate, private) = (directory.join(AUTHORITY), directory.join("ca.key"));
    if certificate.exists() {
        let read = |file: &Path| {
            files::read_text(file).map_err(|source| KeysFailure::Read { file: file.to_owned(), source })
        };
        let ours = CertificateDer::from_pem_slice(read(&certificate)?.as_bytes())
            .is_ok_and(|known| known.windows(NAME.len()).any(|bytes| bytes == NAME.as_bytes()));
        if !ours {
            return Err(KeysFailure::Foreign(certificate));
        }
        return Ok(Issuer::new(params(NAME, AUTHORITY_DAYS)?, KeyPair::from_pem(&read(&private)?)?));
    }
    let key = KeyPair::generate()?;
    let mut params = params(NAME, AUTHORITY_DAYS)?;
    params.is_ca = IsCa::Ca(BasicConstraints::Constrained(0));
    params.key_usages = vec![KeyUsagePurpose::KeyCertSign, KeyUsagePurpose::CrlSign];
    let certificate = params.self_signed(&key)?;
    write(directory, "ca", "pem", CERTIFICATE, &certificate.pem())?;
    write(directory, "ca", "key", PRIVATE, &key.serialize_pem())?;
    Ok(Issuer::new(params, key))
}

fn params(name: &str, days: i64) -> Result<CertificateParams, KeysFailure> {
    let mut params = CertificateParams::new(Vec::new())?;
    let now = OffsetDateTime::now_utc();
    (params.not_before, params.not_after) = (now - SKEW, now + Duration::days(days));
    params.distinguished_name.push(DnType::CommonName, name);
    Ok(params)
}

fn write(directory: &Path, name: &str, extension: &str, mode: u32, text: &str) -> Result<(), KeysFailure> {
    let file = directory.join(name).with_extension(extension);
    let created = OpenOptions::new().write(true).create_new(true).mode(mode).open(&file);
    let written = created.and_then(|mut created| created.write_all(text.as_bytes()));
    written.map_err(|source| KeysFailure::Write { file, source })
}
