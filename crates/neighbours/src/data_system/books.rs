//! The items in memory: a value that can be cloned. It gives the same answers as a database in a file.

use std::{collections::BTreeMap, convert::Infallible};

use super::records::{Item, LastStatement, Records};

#[derive(Clone, Debug, Default)]
struct Client {
    session: u8,
    last: (u16, String),
}

/// Items and connections, without the history of the items.
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

    fn report(&mut self, client: &str, said: LastStatement<'_>, item: &Item) -> Result<bool, Infallible> {
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
