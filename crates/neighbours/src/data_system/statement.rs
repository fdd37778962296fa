//! The one statement of the data manipulation language that the robot sends (IX.2).
//!
//! ```text
//! UPDATE EQUIP_ITEM_ACTION SET ( column, ... ) = ( 'value', ... ) WHERE ITEM_NBR = 'value'
//! ```
//!
//! Blanks between words and trailing blanks of values are ignored; columns may be in any order.

use std::fmt;

use os_io::text::amount;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Column {
    ItemType,
    ItemName,
    Device,
    StoragePosition,
    Sector,
}

impl Column {
    const ALL: [Self; 5] =
        [Self::ItemType, Self::ItemName, Self::Device, Self::StoragePosition, Self::Sector];

    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::ItemType => "ITEM_TYPE",
            Self::ItemName => "ITEM_NAME",
            Self::Device => "DEVICE",
            Self::StoragePosition => "STORAGE_POS",
            Self::Sector => "SECTOR",
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Update<'a> {
    pub number: &'a str, // `ITEM_NBR`, or empty
    values: [Option<&'a str>; 5],
}

impl<'a> Update<'a> {
    #[must_use]
    pub const fn value(&self, column: Column) -> Option<&'a str> {
        self.values[column as usize]
    }
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{expected} expected at character {}, found {found}", .at + 1)]
pub struct StatementError {
    pub at: usize, // byte from 0
    pub expected: String,
    pub found: Found,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Found {
    End,
    Word(String), // or a punctuation mark
    Count(usize),
}

impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::End => f.write_str("the end"),
            Self::Word(word) => f.write_str(word),
            Self::Count(count) => write!(f, "{count}"),
        }
    }
}

pub fn parse(text: &str) -> Result<Update<'_>, StatementError> {
    let mut scanner = Scanner { text, at: 0 };
    for word in ["UPDATE", "EQUIP_ITEM_ACTION", "SET"] {
        scanner.word(word)?;
    }
    let columns = scanner.list(Scanner::column)?;
    scanner.sign('=')?;
    let (before, values) = (scanner.at, scanner.list(Scanner::quoted)?);
    if values.len() != columns.len() {
        let expected = amount(columns.len(), "value");
        return Err(StatementError { at: before, expected, found: Found::Count(values.len()) });
    }
    let mut update = Update::default();
    for ((at, column), value) in columns.into_iter().zip(values) {
        let slot = &mut update.values[column as usize];
        if slot.replace(value).is_some() {
            let found = Found::Word(format!("{} again", column.text()));
            return Err(StatementError { at, expected: "another column".to_owned(), found });
        }
    }
    scanner.word("WHERE")?;
    scanner.word("ITEM_NBR")?;
    scanner.sign('=')?;
    update.number = scanner.quoted()?;
    match scanner.rest() {
        "" => Ok(update),
        _ => Err(scanner.wrong("the end")),
    }
}

struct Scanner<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Scanner<'a> {
    fn rest(&mut self) -> &'a str {
        let rest = self.text[self.at..].trim_start_matches(' ');
        self.at = self.text.len() - rest.len();
        rest
    }

    fn wrong(&mut self, expected: &str) -> StatementError {
        let rest = self.rest();
        let word = rest.find([' ', ',', ')']).map_or(rest, |end| &rest[..end]);
        let word =
            if word.is_empty() { rest.chars().next().map(String::from) } else { Some(word.to_owned()) };
        StatementError {
            at: self.at,
            expected: expected.to_owned(),
            found: word.map_or(Found::End, |word| Found::Word(word.chars().take(40).collect())),
        }
    }

    fn sign(&mut self, sign: char) -> Result<(), StatementError> {
        if !self.rest().starts_with(sign) {
            return Err(self.wrong(&format!("`{sign}`")));
        }
        self.at += sign.len_utf8();
        Ok(())
    }

    fn identifier(&mut self) -> &'a str {
        let rest = self.rest();
        let end = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_').unwrap_or(rest.len());
        &rest[..end]
    }

    fn word(&mut self, word: &str) -> Result<(), StatementError> {
        if self.identifier() != word {
            return Err(self.wrong(word));
        }
        self.at += word.len();
        Ok(())
    }

    fn column(&mut self) -> Result<(usize, Column), StatementError> {
        let word = self.identifier();
        let Some(column) = Column::ALL.into_iter().find(|column| column.text() == word) else {
            return Err(self.wrong("a column of EQUIP_ITEM_ACTION"));
        };
        let at = self.at;
        self.at += word.len();
        Ok((at, column))
    }

    fn quoted(&mut self) -> Result<&'a str, StatementError> {
        self.sign('\'')?;
        let rest = &self.text[self.at..];
        let Some(end) = rest.find('\'') else {
            self.at = self.text.len();
            return Err(self.wrong("`'` after the value"));
        };
        self.at += end + 1;
        Ok(rest[..end].trim_end_matches(' '))
    }

    fn list<T>(
        &mut self,
        mut thing: impl FnMut(&mut Self) -> Result<T, StatementError>,
    ) -> Result<Vec<T>, StatementError> {
        self.sign('(')?;
        let mut things = vec![thing(self)?];
        while self.rest().starts_with(',') {
            self.at += 1;
            things.push(thing(self)?);
        }
        self.sign(')')?;
        Ok(things)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const GOOD: &str = "UPDATE EQUIP_ITEM_ACTION SET ( ITEM_TYPE, ITEM_NAME, DEVICE, STORAGE_POS, SECTOR ) = \
                        ('PART            ','LINKBAR1        ','HWS             ','UNIT_1          ','SECTOR-4') \
                        WHERE ITEM_NBR ='17              '";

    #[test]
    fn string_of_the_figure_parses() {
        let update = parse(GOOD).unwrap();
        let values = Column::ALL.map(|column| update.value(column));
        assert_eq!(values, ["PART", "LINKBAR1", "HWS", "UNIT_1", "SECTOR-4"].map(Some));
        assert_eq!(update.number, "17");
    }

    #[test]
    fn order_and_blanks_do_not_matter() {
        let update =
            parse("UPDATE  EQUIP_ITEM_ACTION SET(SECTOR,ITEM_NAME)=('SECTOR-0', 'A B')WHERE ITEM_NBR=''  ")
                .unwrap();
        assert_eq!(update.value(Column::Sector), Some("SECTOR-0"));
        assert_eq!(update.value(Column::ItemName), Some("A B"));
        assert_eq!((update.value(Column::Device), update.number), (None, ""));
    }

    #[test]
    fn statement_errors_have_their_place() {
        let cases = [
            ("", "UPDATE expected at character 1, found the end"),
            ("DELETE ITEMS", "UPDATE expected at character 1, found DELETE"),
            ("UPDATE ITEMS", "EQUIP_ITEM_ACTION expected at character 8, found ITEMS"),
            ("UPDATE EQUIP_ITEM_ACTION SET DEVICE", "`(` expected at character 30, found DEVICE"),
            (
                "UPDATE EQUIP_ITEM_ACTION SET (WEIGHT)",
                "a column of EQUIP_ITEM_ACTION expected at character 31, found WEIGHT",
            ),
            (
                "UPDATE EQUIP_ITEM_ACTION SET (DEVICE, DEVICE) = ('A', 'B')",
                "another column expected at character 39, found DEVICE again",
            ),
            (
                "UPDATE EQUIP_ITEM_ACTION SET (DEVICE) = ('A', 'B')",
                "1 value expected at character 40, found 2",
            ),
            (
                "UPDATE EQUIP_ITEM_ACTION SET (DEVICE) = ('A",
                "`'` after the value expected at character 44, found the end",
            ),
            (
                "UPDATE EQUIP_ITEM_ACTION SET (DEVICE) = ('A') WHERE ITEM_NBR = '1' OR",
                "the end expected at character 68, found OR",
            ),
        ];
        for (text, expected) in cases {
            assert_eq!(parse(text).unwrap_err().to_string(), expected);
        }
    }

    proptest! {
        #[test]
        fn no_text_panics(text in "\\PC*") {
            let _ = parse(&text);
        }

        #[test]
        fn changed_statement_does_not_panic(at in 0_usize..GOOD.len(), with in "\\PC{0,2}") {
            let text = format!("{}{with}{}", &GOOD[..at], &GOOD[at + 1..]);
            let _ = parse(&text);
        }
    }
}
