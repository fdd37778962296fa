//! The items in memory: a value that can be cloned, with the answers of the database in a file.

use std::{collections::BTreeMap, convert::Infallible};

use super::{
    server::Records,
    store::{Item, Said},
};

/// A client of the database.
#[derive(Clone, Debug, Default)]
struct Client {
    session: u8,
    last: (u16, String),
}

/// The items and the clients' connections, without the history of the items.
#[derive(Clone, Debug, Default)]
pub struct Books {
    clients: BTreeMap<String, Client>,
    items: Vec<Item>,
}

impl Records for Books {
    type Error = Infallible;

    fn session(&self, client: &str) -> Result<u8, Infallible> {
        Ok(self.clients.get(client).map_or(0, |client| client.session))
    }

    fn set_session(&mut self, client: &str, session: u8) -> Result<(), Infallible> {
        self.clients.entry(client.to_owned()).or_default().session = session;
        Ok(())
    }

    fn report(&mut self, client: &str, said: Said<'_>, item: &Item) -> Result<bool, Infallible> {
        if said.number != 0 {
            let last = &mut self.clients.entry(client.to_owned()).or_default().last;
            let (number, statement) = last;
            if (*number, statement.as_str()) == (said.number, said.statement) {
                return Ok(false);
            }
            *last = (said.number, said.statement.to_owned());
        }
        let is_same = |known: &&mut Item| {
            known.number == item.number && (!item.number.is_empty() || known.name == item.name)
        };
        match self.items.iter_mut().find(is_same) {
            Some(known) if known == item => return Ok(false),
            Some(known) => *known = item.clone(),
            None => self.items.push(item.clone()),
        }
        Ok(true)
    }

    fn items(&self) -> Result<Vec<Item>, Infallible> {
        let mut items = self.items.clone();
        items.sort_by(|one, other| (&one.name, &one.number).cmp(&(&other.name, &other.number)));
        Ok(items)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::data_system::store::Store;

    fn item() -> impl Strategy<Value = Item> {
        let word = |words: &'static [&'static str]| prop::sample::select(words).prop_map(str::to_owned);
        let texts = (
            word(&["", "17", "18"]),
            word(&["A", "B", "a"]),
            word(&["PART", "TOOL"]),
            word(&["HWS", "H_ROBOT"]),
            word(&["UNIT_1", "UNIT_2"]),
        );
        (texts, 0_u8..3).prop_map(|((number, name, kind, device, position), sector)| Item {
            number,
            name,
            kind,
            device,
            position,
            sector,
        })
    }

    #[derive(Clone, Debug)]
    enum Step {
        Session(u8),
        Report(u16, Item),
    }

    proptest! {
        #[test]
        fn books_answer_like_the_database(
            steps in prop::collection::vec(
                (any::<bool>(), prop_oneof![
                    (0_u8..3).prop_map(Step::Session),
                    ((0_u16..4), item()).prop_map(|(number, item)| Step::Report(number, item)),
                ]),
                0..40,
            )
        ) {
            let (mut books, mut store) = (Books::default(), Store::in_memory().expect("SQLite works"));
            for (first, step) in steps {
                let client = if first { "H_ROBOT" } else { "FOREMAN" };
                match step {
                    Step::Session(session) => {
                        books.set_session(client, session).expect("memory does not fail");
                        Records::set_session(&mut store, client, session).expect("SQLite works");
                    }
                    Step::Report(number, item) => {
                        let statement = item.position.clone();
                        let said = Said { number, statement: &statement };
                        prop_assert_eq!(
                            books.report(client, said, &item).expect("memory does not fail"),
                            Records::report(&mut store, client, said, &item).expect("SQLite works")
                        );
                    }
                }
                for client in ["H_ROBOT", "FOREMAN", "NOBODY"] {
                    prop_assert_eq!(books.session(client).ok(), Records::session(&store, client).ok());
                }
                prop_assert_eq!(books.items().ok(), Records::items(&store).ok());
            }
        }
    }
}
