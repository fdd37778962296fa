//! Unanswered updates for the Data System, on the controller's disk.
//!
//! An update is stored here under a new number before it is sent, and deleted when the Data System has answered it. If
//! the run is killed, the next run sends it with the same number, and the Data System executes it once. The journal is
//! flushed to the disk before sending. File and journal have reserved space, because a log may fill the disk.

use std::path::{Path, PathBuf};

use neighbours::data_system::command::{DML, STRING_AT};
use rusqlite::{Connection, ErrorCode, params};

const APPLICATION_ID: i32 = 0x5243_534F; // application ID in the file of the outbox: "RCSO"

const RESERVE: u32 = 256 * 1024; // reserved bytes in the file, for some hundred updates
/// Number of journal pages after which they are copied to the file. They need much less than the reserved space.
const CHECKPOINT: u32 = 16;

const TABLES: &str = "
    CREATE TABLE IF NOT EXISTS counter (last INTEGER NOT NULL);
    INSERT INTO counter SELECT 0 WHERE NOT EXISTS (SELECT * FROM counter);
    CREATE TABLE IF NOT EXISTS reserve (bytes BLOB NOT NULL);
    CREATE TABLE IF NOT EXISTS pending (
        position INTEGER PRIMARY KEY,
        number INTEGER NOT NULL UNIQUE,
        command BLOB NOT NULL
    );
";

#[derive(Debug, thiserror::Error)]
pub enum OutboxError {
    #[error("updates cannot be kept in {}: {source}", .file.display())]
    Sqlite { file: PathBuf, source: rusqlite::Error },
    #[error(
        "updates cannot be kept in {}: another run uses this file; end it, or name another file with --outbox",
        .file.display()
    )]
    InUse { file: PathBuf },
    #[error("{}: updates for the Data System were expected, this file belongs to another program", .file.display())]
    Foreign { file: PathBuf },
}

#[derive(Debug)]
pub struct Outbox {
    connection: Connection,
    file: PathBuf,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kept {
    pub number: u16,
    /// Bytes of the command, as passed to [`Outbox::keep`].
    pub command: [u8; DML],
}

impl Outbox {
    /// Open the outbox in a file; creates the file if it does not exist. The file is locked against other processes.
    pub fn open(file: &Path) -> Result<Self, OutboxError> {
        let failed = |source| failure(file, source);
        let mut connection = Connection::open(file).map_err(failed)?;
        connection.pragma_update(None, "locking_mode", "exclusive").map_err(failed)?;
        connection.pragma_update(None, "synchronous", "full").map_err(failed)?;
        let application: i32 =
            connection.pragma_query_value(None, "application_id", |row| row.get(0)).map_err(failed)?;
        let objects: i64 = connection
            .query_row("SELECT count(*) FROM sqlite_schema", [], |row| row.get(0))
            .map_err(failed)?;
        if application != APPLICATION_ID && (application != 0 || objects != 0) {
            return Err(OutboxError::Foreign { file: file.to_owned() });
        }
        connection.pragma_update(None, "application_id", APPLICATION_ID).map_err(failed)?;
        connection.execute_batch(TABLES).map_err(failed)?;
        reserve(&mut connection).map_err(failed)?;
        Ok(Self { connection, file: file.to_owned() })
    }

    /// Store an update and return its number. An update equal to the last one is a repetition and has its number.
    pub fn keep(&mut self, command: &[u8; DML]) -> Result<u16, OutboxError> {
        self.store(command).map_err(|source| failure(&self.file, source))
    }

    fn store(&mut self, command: &[u8; DML]) -> rusqlite::Result<u16> {
        if let Some(last) = self.read()?.last()
            && last.command[STRING_AT..] == command[STRING_AT..]
        {
            return Ok(last.number);
        }
        let transaction = self.connection.transaction()?;
        let last: u16 = transaction.query_row("SELECT last FROM counter", [], |row| row.get(0))?;
        let number = neighbours::fields::successor(last);
        transaction.execute("UPDATE counter SET last = ?1", params![number])?;
        transaction.execute(
            "INSERT INTO pending (number, command) VALUES (?1, ?2)",
            params![number, &command[..]],
        )?;
        transaction.commit()?;
        Ok(number)
    }

    pub fn pending(&self) -> Result<Vec<Kept>, OutboxError> {
        self.read().map_err(|source| failure(&self.file, source))
    }

    fn read(&self) -> rusqlite::Result<Vec<Kept>> {
        let mut rows = self.connection.prepare("SELECT number, command FROM pending ORDER BY position")?;
        let read = |row: &rusqlite::Row<'_>| Ok(Kept { number: row.get(0)?, command: row.get(1)? });
        rows.query_map([], read)?.collect()
    }

    pub fn strike_out(&self, number: u16) -> Result<(), OutboxError> {
        let deleted = self.connection.execute("DELETE FROM pending WHERE number = ?1", params![number]);
        deleted.map(drop).map_err(|source| failure(&self.file, source))
    }
}

fn failure(file: &Path, source: rusqlite::Error) -> OutboxError {
    let file = file.to_owned();
    match source.sqlite_error_code() {
        Some(ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked) => OutboxError::InUse { file },
        _ => OutboxError::Sqlite { file, source },
    }
}

/// Write [`RESERVE`] bytes and delete them. Their pages stay in the file and in the journal.
fn reserve(connection: &mut Connection) -> rusqlite::Result<()> {
    connection.pragma_update(None, "journal_mode", "wal")?;
    let transaction = connection.transaction()?;
    transaction.execute("INSERT INTO reserve (bytes) VALUES (zeroblob(?1))", params![RESERVE])?;
    transaction.commit()?;
    connection.execute("DELETE FROM reserve", [])?;
    connection.query_row("PRAGMA wal_checkpoint(RESTART)", [], |_| Ok(()))?;
    connection.pragma_update(None, "wal_autocheckpoint", CHECKPOINT)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn update(what: u8) -> [u8; DML] {
        let mut command = [0; DML];
        command[STRING_AT] = what;
        command
    }

    #[test]
    fn stored_requests_return_in_order_until_answered() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("outbox");
        let mut outbox = Outbox::open(&file).unwrap();
        assert_eq!([outbox.keep(&update(1)).unwrap(), outbox.keep(&update(2)).unwrap()], [1, 2]);
        assert!(matches!(Outbox::open(&file), Err(OutboxError::InUse { .. })), "it is another run's");
        drop(outbox);
        let mut outbox = Outbox::open(&file).unwrap();
        let numbers =
            |outbox: &Outbox| outbox.pending().unwrap().iter().map(|kept| kept.number).collect::<Vec<_>>();
        assert_eq!(numbers(&outbox), [1, 2]);
        outbox.strike_out(1).unwrap();
        assert_eq!(numbers(&outbox), [2]);
        outbox.strike_out(2).unwrap();
        assert_eq!(outbox.keep(&update(1)).unwrap(), 3, "no number is given twice");
        assert_eq!(outbox.pending().unwrap(), [Kept { number: 3, command: update(1) }]);
    }

    #[test]
    fn repeated_update_keeps_its_number() {
        let place = tempfile::tempdir().unwrap();
        let mut outbox = Outbox::open(&place.path().join("outbox")).unwrap();
        let mut again = update(1);
        again[6] = 9; // another command-id#
        assert_eq!([outbox.keep(&update(1)).unwrap(), outbox.keep(&again).unwrap()], [1, 1]);
        assert_eq!(outbox.pending().unwrap().len(), 1);
    }

    /// The files do not grow, so a full disk has no effect.
    #[test]
    fn updates_are_stored_in_reserved_space() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("outbox");
        let mut outbox = Outbox::open(&file).unwrap();
        let sizes =
            || ["outbox", "outbox-wal"].map(|name| std::fs::metadata(place.path().join(name)).unwrap().len());
        let before = sizes();
        assert!(before.iter().all(|size| *size >= u64::from(RESERVE)), "{before:?}");
        for round in 0..3 {
            let numbers: Vec<_> = (0..200_u8).map(|what| outbox.keep(&update(what)).unwrap()).collect();
            assert_eq!(sizes(), before, "round {round}");
            numbers.into_iter().for_each(|number| outbox.strike_out(number).unwrap());
        }
        assert_eq!(sizes(), before);
        let names = std::fs::read_dir(place.path()).unwrap().count();
        assert_eq!(names, 2, "an exclusive lock needs no other file");
    }

    #[test]
    fn error_names_the_outbox() {
        let full =
            rusqlite::Error::SqliteFailure(rusqlite::ffi::Error::new(rusqlite::ffi::SQLITE_FULL), None);
        let text = failure(Path::new("runs/data-system.outbox"), full).to_string();
        assert!(text.contains("updates cannot be kept in runs/data-system.outbox: "), "{text}");
    }

    #[test]
    fn files_of_other_programs_are_refused() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("items.db");
        drop(super::super::Store::open(&file).unwrap());
        assert!(matches!(Outbox::open(&file), Err(OutboxError::Foreign { .. })));
    }
}
