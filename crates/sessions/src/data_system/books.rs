//! Compares the answers of items in memory with those of the database.

use proptest::prelude::*;

use neighbours::data_system::{Books, Item, LastStatement, Records};

use super::Store;

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
    fn items_in_memory_answer_like_the_database(
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
                    let said = LastStatement { number, statement: &statement };
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
