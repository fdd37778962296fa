//! The database: items, devices, storage positions, and the past places of every item, in one SQLite file.
//!
//! The number identifies an item: a machined blank keeps it and changes its name. Items without a number are identified
//! by name. A repeated report has no further effect.
//!
//! ```sql
//! SELECT * FROM whereabouts WHERE number = '17';   -- where it is
//! SELECT * FROM history WHERE number = '17';       -- where it has been
//! ```
//!
//! Answered reports survive the end of a killed program.

use std::{
    io,
    path::{Path, PathBuf},
};

use neighbours::data_system::{Item, LastStatement, Records};
use rusqlite::{Connection, OptionalExtension as _, Row, TransactionBehavior, params};

use super::alone::DatabaseLock;

const APPLICATION_ID: i32 = 0x5243_5332; // application ID in the file of the database: "RCS2"
const VERSION: i32 = 2;

/// Tables that are new in version 2: the controllers with their last numbers, and the last numbered command.
const CLIENTS: &str = "
    CREATE TABLE client (
        name TEXT PRIMARY KEY,
        session INTEGER NOT NULL,
        last_number INTEGER NOT NULL DEFAULT 0,
        last_statement TEXT NOT NULL DEFAULT ''
    );
";

const TABLES: &str = "
    CREATE TABLE device (
        id INTEGER PRIMARY KEY,
        name TEXT NOT NULL UNIQUE
    );
    CREATE TABLE storage_position (
        id INTEGER PRIMARY KEY,
        device INTEGER NOT NULL REFERENCES device,
        name TEXT NOT NULL,
        sector INTEGER NOT NULL,
        UNIQUE (device, name, sector)
    );
    CREATE TABLE item (
        id INTEGER PRIMARY KEY,
        number TEXT NOT NULL,
        type TEXT NOT NULL,
        name TEXT NOT NULL,
        storage_position INTEGER NOT NULL REFERENCES storage_position
    );
    CREATE UNIQUE INDEX item_by_number ON item (number) WHERE number <> '';
    CREATE UNIQUE INDEX item_by_name ON item (name) WHERE number = '';
    CREATE TABLE report (
        id INTEGER PRIMARY KEY,
        at TEXT NOT NULL DEFAULT (strftime('%Y-%m-%dT%H:%M:%fZ')),
        client TEXT NOT NULL,
        item INTEGER NOT NULL REFERENCES item,
        type TEXT NOT NULL,
        name TEXT NOT NULL,
        storage_position INTEGER NOT NULL REFERENCES storage_position
    );
    CREATE VIEW whereabouts AS
        SELECT item.number, item.name, item.type, device.name AS device, place.name AS position, place.sector
        FROM item
        JOIN storage_position AS place ON place.id = item.storage_position
        JOIN device ON device.id = place.device
        ORDER BY item.name, item.number;
    CREATE VIEW history AS
        SELECT report.at, report.client, item.number, report.name, device.name AS device,
               place.name AS position, place.sector
        FROM report
        JOIN item ON item.id = report.item
        JOIN storage_position AS place ON place.id = report.storage_position
        JOIN device ON device.id = place.device
        ORDER BY report.id;
";

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Visit {
    /// Time of the report, UTC, in the format of ISO 8601.
    pub at: String,
    pub client: String,
    /// `STORAGE_POS`.
    pub position: String,
    /// Number of the sector at the storage position; 0 for none.
    pub sector: u8,
}

#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    #[error("{}: {source}", .file.display())]
    Sqlite { file: PathBuf, source: rusqlite::Error },
    #[error("{}: a database of items was expected, this one belongs to another program", .file.display())]
    Foreign { file: PathBuf },
    #[error(
        "{}: another run or Data System uses this database: end it, or name another database",
        .file.display()
    )]
    InUse { file: PathBuf },
    #[error("{}: its lock file cannot be locked: {source}", .file.display())]
    Lock { file: PathBuf, source: io::Error },
    #[error("{}: tables of version {VERSION} were expected, found version {found}", .file.display())]
    Version {
        file: PathBuf,
        found: i32, // version of the tables in the file
    },
}

#[derive(Debug)]
pub struct Store {
    connection: Connection,
    _alone: Option<DatabaseLock>, // held by a writing program, and released after the connection is closed
}

impl Store {
    /// A database in memory, which is lost at the end of the program.
    pub fn in_memory() -> Result<Self, StoreError> {
        let file = PathBuf::from(":memory:");
        let connection = Connection::open_in_memory()
            .map_err(|source| StoreError::Sqlite { file: file.clone(), source })?;
        Self::with_tables(connection, &file)
    }

    /// Open the database in a file, which is created if necessary.
    pub fn open(file: &Path) -> Result<Self, StoreError> {
        let connection =
            Connection::open(file).map_err(|source| StoreError::Sqlite { file: file.to_owned(), source })?;
        Self::with_tables(connection, file)
    }

    /// Open or create the database for writing. Fails with [`StoreError::InUse`] if another program writes to it.
    pub fn open_alone(file: &Path) -> Result<Self, StoreError> {
        let connection =
            Connection::open(file).map_err(|source| StoreError::Sqlite { file: file.to_owned(), source })?;
        let alone = DatabaseLock::take(file)
            .map_err(|source| StoreError::Lock { file: file.to_owned(), source })?
            .ok_or_else(|| StoreError::InUse { file: file.to_owned() })?;
        Ok(Self { _alone: Some(alone), ..Self::with_tables(connection, file)? })
    }

    fn with_tables(mut connection: Connection, file: &Path) -> Result<Self, StoreError> {
        let failed = |source| StoreError::Sqlite { file: file.to_owned(), source };
        let number = |connection: &Connection, pragma: &str| {
            connection.pragma_query_value(None, pragma, |row| row.get::<_, i32>(0)).map_err(failed)
        };
        let application = number(&connection, "application_id")?;
        if application == APPLICATION_ID {
            let found = number(&connection, "user_version")?;
            match found {
                VERSION => {}
                1 => {
                    let transaction = connection.transaction().map_err(failed)?;
                    transaction.execute_batch(CLIENTS).map_err(failed)?;
                    transaction.pragma_update(None, "user_version", VERSION).map_err(failed)?;
                    transaction.commit().map_err(failed)?;
                }
                found => return Err(StoreError::Version { file: file.to_owned(), found }),
            }
        } else {
            let objects: i64 = connection
                .query_row("SELECT count(*) FROM sqlite_schema", [], |row| row.get(0))
                .map_err(failed)?;
            if application != 0 || objects != 0 {
                return Err(StoreError::Foreign { file: file.to_owned() });
            }
            let transaction =
                connection.transaction_with_behavior(TransactionBehavior::Immediate).map_err(failed)?;
            if number(&transaction, "application_id")? == APPLICATION_ID {
                transaction.commit().map_err(failed)?;
                return Self::with_tables(connection, file);
            }
            transaction.execute_batch(TABLES).map_err(failed)?;
            transaction.execute_batch(CLIENTS).map_err(failed)?;
            transaction.pragma_update(None, "application_id", APPLICATION_ID).map_err(failed)?;
            transaction.pragma_update(None, "user_version", VERSION).map_err(failed)?;
            transaction.commit().map_err(failed)?;
        }
        connection.pragma_update(None, "foreign_keys", true).map_err(failed)?;
        // With a write-ahead journal, readers do not delay reports. Answered reports survive a power cut.
        connection.pragma_update(None, "journal_mode", "wal").map_err(failed)?;
        connection.pragma_update(None, "synchronous", "full").map_err(failed)?;
        Ok(Self { connection, _alone: None })
    }

    /// The past places of the item with a number, the oldest first. Fails with an error of SQLite.
    pub fn history(&self, number: &str) -> rusqlite::Result<Vec<Visit>> {
        let read = |row: &Row<'_>| {
            Ok(Visit { at: row.get(0)?, client: row.get(1)?, position: row.get(2)?, sector: row.get(3)? })
        };
        let mut rows =
            self.connection.prepare("SELECT at, client, position, sector FROM history WHERE number = ?1")?;
        rows.query_map(params![number], read)?.collect()
    }
}

impl Records for Store {
    type Error = rusqlite::Error;

    fn session(&self, client: &str) -> rusqlite::Result<u8> {
        let mut rows = self.connection.prepare("SELECT session FROM client WHERE name = ?1")?;
        Ok(rows.query_row(params![client], |row| row.get(0)).optional()?.unwrap_or(0))
    }

    fn set_session(&mut self, client: &str, session: u8) -> rusqlite::Result<()> {
        self.connection
            .execute(
                "INSERT INTO client (name, session) VALUES (?1, ?2)
                 ON CONFLICT (name) DO UPDATE SET session = excluded.session",
                params![client, session],
            )
            .map(drop)
    }

    fn report(&mut self, client: &str, said: LastStatement<'_>, item: &Item) -> rusqlite::Result<bool> {
        let transaction = self.connection.transaction()?;
        if said.number != 0 {
            let fresh = transaction.execute(
                "INSERT INTO client (name, session, last_number, last_statement) VALUES (?1, 0, ?2, ?3)
                 ON CONFLICT (name) DO UPDATE SET last_number = ?2, last_statement = ?3
                 WHERE last_number <> ?2 OR last_statement <> ?3",
                params![client, said.number, said.statement],
            )?;
            if fresh == 0 {
                return Ok(false);
            }
        }
        transaction
            .execute("INSERT INTO device (name) VALUES (?1) ON CONFLICT DO NOTHING", params![item.device])?;
        transaction.execute(
            "INSERT INTO storage_position (device, name, sector)
             SELECT id, ?2, ?3 FROM device WHERE name = ?1 ON CONFLICT DO NOTHING",
            params![item.device, item.position, item.sector],
        )?;
        let place: i64 = transaction.query_row(
            "SELECT place.id FROM storage_position AS place JOIN device ON device.id = place.device
             WHERE device.name = ?1 AND place.name = ?2 AND place.sector = ?3",
            params![item.device, item.position, item.sector],
            |row| row.get(0),
        )?;
        let known = transaction
            .query_row(
                "SELECT id, type, name, storage_position FROM item
                 WHERE number = ?1 AND (number <> '' OR name = ?2)",
                params![item.number, item.name],
                |row| Ok((row.get::<_, i64>(0)?, (row.get(1)?, row.get(2)?, row.get(3)?))),
            )
            .optional()?;
        let now = (item.kind.clone(), item.name.clone(), place);
        let id = match known {
            Some((_, before)) if before == now => {
                transaction.commit()?;
                return Ok(false);
            }
            Some((id, _)) => {
                transaction.execute(
                    "UPDATE item SET type = ?2, name = ?3, storage_position = ?4 WHERE id = ?1",
                    params![id, item.kind, item.name, place],
                )?;
                id
            }
            None => {
                transaction.execute(
                    "INSERT INTO item (number, type, name, storage_position) VALUES (?1, ?2, ?3, ?4)",
                    params![item.number, item.kind, item.name, place],
                )?;
                transaction.last_insert_rowid()
            }
        };
        transaction.execute(
            "INSERT INTO report (client, item, type, name, storage_position) VALUES (?1, ?2, ?3, ?4, ?5)",
            params![client, id, item.kind, item.name, place],
        )?;
        transaction.commit()?;
        Ok(true)
    }

    fn items(&self) -> rusqlite::Result<Vec<Item>> {
        let read = |row: &Row<'_>| {
            Ok(Item {
                number: row.get(0)?,
                name: row.get(1)?,
                kind: row.get(2)?,
                device: row.get(3)?,
                position: row.get(4)?,
                sector: row.get(5)?,
            })
        };
        let mut rows = self
            .connection
            .prepare("SELECT number, name, type, device, position, sector FROM whereabouts")?;
        rows.query_map([], read)?.collect()
    }
}

#[cfg(test)]
mod tests {
    use interfaces::{DataBaseCommand, data_base::DataBaseVerb};
    use neighbours::data_system::{Server, command, status::Summary};
    use rcs_core::name::{Name10, Name16};

    use super::*;

    fn item(number: &str, name: &str, position: &str, sector: u8) -> Item {
        let text = str::to_owned;
        Item {
            number: text(number),
            name: text(name),
            kind: text("PART"),
            device: text("HWS"),
            position: text(position),
            sector,
        }
    }

    fn history(store: &Store) -> Vec<String> {
        let mut rows = store
            .connection
            .prepare("SELECT number || ' ' || name || ' ' || position || ' ' || sector FROM history")
            .unwrap();
        rows.query_map([], |row| row.get(0)).unwrap().map(Result::unwrap).collect()
    }

    #[test]
    fn item_keeps_its_number_and_history() {
        let mut store = Store::in_memory().unwrap();
        assert!(
            store
                .report("H_ROBOT", LastStatement::default(), &item("17", "LINKBAR1_BH", "UNIT_1", 4))
                .unwrap()
        );
        assert!(
            store
                .report("H_ROBOT", LastStatement::default(), &item("17", "LINKBAR1", "PFIXTURE", 0))
                .unwrap()
        );
        assert!(
            store.report("H_ROBOT", LastStatement::default(), &item("18", "LINKBAR1", "UNIT_1", 1)).unwrap()
        );
        assert_eq!(
            store.items().unwrap(),
            [item("17", "LINKBAR1", "PFIXTURE", 0), item("18", "LINKBAR1", "UNIT_1", 1)]
        );
        assert_eq!(
            history(&store),
            ["17 LINKBAR1_BH UNIT_1 4", "17 LINKBAR1 PFIXTURE 0", "18 LINKBAR1 UNIT_1 1"]
        );
        let visits: Vec<_> =
            store.history("17").unwrap().into_iter().map(|v| (v.position, v.sector)).collect();
        assert_eq!(visits, [("UNIT_1".to_owned(), 4), ("PFIXTURE".to_owned(), 0)]);
    }

    #[test]
    fn items_without_a_number_are_distinguished_by_name() {
        let mut store = Store::in_memory().unwrap();
        store.report("H_ROBOT", LastStatement::default(), &item("", "A", "UNIT_1", 1)).unwrap();
        store.report("H_ROBOT", LastStatement::default(), &item("", "B", "UNIT_1", 2)).unwrap();
        store.report("H_ROBOT", LastStatement::default(), &item("", "A", "UNIT_2", 3)).unwrap();
        assert_eq!(store.items().unwrap(), [item("", "A", "UNIT_2", 3), item("", "B", "UNIT_1", 2)]);
    }

    #[test]
    fn repeated_report_is_stored_once() {
        let mut store = Store::in_memory().unwrap();
        assert!(store.report("H_ROBOT", LastStatement::default(), &item("17", "A", "UNIT_1", 1)).unwrap());
        assert!(!store.report("H_ROBOT", LastStatement::default(), &item("17", "A", "UNIT_1", 1)).unwrap());
        assert_eq!(history(&store).len(), 1);
    }

    #[test]
    fn numbered_message_is_executed_once() {
        let mut store = Store::in_memory().unwrap();
        let said = |number| LastStatement { number, statement: "A is at UNIT_1" };
        assert!(store.report("H_ROBOT", said(7), &item("17", "A", "UNIT_1", 1)).unwrap());
        assert!(store.report("FOREMAN", LastStatement::default(), &item("17", "A", "UNIT_2", 1)).unwrap());
        assert!(!store.report("H_ROBOT", said(7), &item("17", "A", "UNIT_1", 1)).unwrap());
        assert_eq!(store.items().unwrap(), [item("17", "A", "UNIT_2", 1)]);
        assert!(
            store.report("H_ROBOT", said(8), &item("17", "A", "UNIT_1", 1)).unwrap(),
            "said anew it is news"
        );
        let other = LastStatement { number: 8, statement: "A is at UNIT_2" };
        assert!(
            store.report("H_ROBOT", other, &item("17", "A", "UNIT_2", 1)).unwrap(),
            "another text is another statement"
        );
    }

    #[test]
    fn file_of_the_first_version_is_converted() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("items.db");
        let old = Connection::open(&file).unwrap();
        old.execute_batch(TABLES).unwrap();
        old.pragma_update(None, "application_id", APPLICATION_ID).unwrap();
        old.pragma_update(None, "user_version", 1).unwrap();
        drop(old);
        let mut store = Store::open(&file).unwrap();
        store.set_session("H_ROBOT", 2).unwrap();
        assert!(
            store
                .report("H_ROBOT", LastStatement { number: 1, statement: "" }, &item("17", "A", "UNIT_1", 1))
                .unwrap()
        );
        drop(store);
        let store = Store::open(&file).unwrap();
        assert_eq!((store.session("H_ROBOT").unwrap(), store.session("FOREMAN").unwrap()), (2, 0));
    }

    #[test]
    fn second_writer_is_refused_but_a_reader_is_not() {
        let place = tempfile::tempdir().unwrap();
        let (file, link) = (place.path().join("items.db"), place.path().join("link.db"));
        let first = Store::open_alone(&file).unwrap();
        std::os::unix::fs::symlink(&file, &link).unwrap();
        for path in [&file, &link] {
            let refused = Store::open_alone(path).unwrap_err();
            assert!(matches!(refused, StoreError::InUse { .. }), "{refused}");
        }
        assert_eq!(Store::open(&file).unwrap().items().unwrap(), []);
        drop(first);
        drop(Store::open_alone(&link).unwrap());
        assert!(!place.path().join("items.db.lock").exists());
    }

    #[test]
    fn reopened_file_keeps_its_items_and_others_are_refused() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("items.db");
        Store::open(&file)
            .unwrap()
            .report("H_ROBOT", LastStatement::default(), &item("17", "A", "UNIT_1", 1))
            .unwrap();
        assert_eq!(Store::open(&file).unwrap().items().unwrap(), [item("17", "A", "UNIT_1", 1)]);

        let newer = Connection::open(&file).unwrap();
        newer.pragma_update(None, "user_version", 3).unwrap();
        drop(newer);
        assert!(matches!(Store::open(&file), Err(StoreError::Version { found: 3, .. })));

        let other = place.path().join("other.db");
        Connection::open(&other).unwrap().execute_batch("CREATE TABLE mine (a)").unwrap();
        assert!(matches!(Store::open(&other), Err(StoreError::Foreign { .. })));
        let text = place.path().join("text");
        std::fs::write(&text, "not a database, but long enough to be looked at as if it were one").unwrap();
        assert!(matches!(Store::open(&text), Err(StoreError::Sqlite { .. })));
        assert!(matches!(Store::open(place.path()), Err(StoreError::Sqlite { .. })));
    }

    #[test]
    fn restarted_server_knows_its_clients_and_messages() {
        let place = tempfile::tempdir().unwrap();
        let file = place.path().join("items.db");
        let mut server = Server::new(Store::open(&file).unwrap());
        for (number, verb) in (1..).zip([DataBaseVerb::Abort, DataBaseVerb::Initiate, DataBaseVerb::Startup])
        {
            let step = DataBaseCommand { number, command: verb, ..DataBaseCommand::default() };
            let (bytes, length) = command::encode(&step).unwrap();
            assert_eq!(server.execute(&bytes[..length]).status.summary, Summary::Done, "{verb}");
        }
        let update = DataBaseCommand {
            number: 9,
            command: DataBaseVerb::Update,
            item: Name16::new("A").unwrap(),
            position: Name10::new("UNIT_1").unwrap(),
            ..DataBaseCommand::default()
        };
        let (mut bytes, _) = command::encode(&update).unwrap();
        command::number(&mut bytes, 3);
        assert_eq!(server.execute(&bytes).status.summary, Summary::Done);
        server = Server::new(Store::open(&file).unwrap());
        command::identify(&mut bytes, 10);
        assert_eq!(
            server.execute(&bytes).status.summary,
            Summary::Done,
            "it was lost on the way, and is asked again"
        );
        let items = server.records().items().unwrap();
        assert_eq!((items.len(), items[0].name.as_str(), items[0].position.as_str()), (1, "A", "UNIT_1"));
    }
}
