//! The page of a small example, and a check that it explains every name in the controller's tables.

use super::*;
use rcs_core::{Actions, Plain, Variables, decision_table};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Door {
    /// Nothing is in the way.
    Open,
    /// Both switches see it.
    Shut,
    /// It stands between its switches.
    Stuck,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Lamp {
    /// It is off.
    Off,
    /// It is on.
    On,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct Situation {
    /// The door, see [`Door`].
    pub door: Door,
    /// The lamp.
    pub lamp: Lamp,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct Request {
    /// The lamp when the command arrived.
    pub lamp: Lamp,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Reason {
    /// The door did not shut.
    #[text = "the door is stuck"]
    DoorStuck,
    /// The lamp is off.
    #[text = "it is dark"]
    Dark,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Speed {
    /// As fast as it can.
    Full,
    /// As slowly as it can.
    Creep,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Action {
    /// Nothing new.
    Wait,
    /// Drive the door.
    Drive(Speed),
    /// Report done.
    Finish,
    /// Report an error.
    Fail(Reason),
}

decision_table! {
    /// ACCEPT: it must not be dark.
    pub ACCEPT: fn accept(Request) -> Action or () {
        1: lamp: Off  => Fail(Dark);
        2: lamp: On   => consult;
    }
}

decision_table! {
    /// CLOSE-DOOR: shut it.
    pub CLOSE_DOOR: fn close_door(enum CloseDoorStep, Situation) -> Action {
        any {
            1: door: Shut          => Finish;
            2: lamp: Off           => Fail(Dark);
        }
        /// Nothing done yet.
        Start {
            3: door: Open | Stuck  => Drive(Creep)  -> Closing;
        }
        /// The door is driven.
        Closing {
            4: door: Open          => Wait;
            5: door: Stuck         => Fail(DoorStuck);
        }
    }
}

decision_table! {
    /// PAUSE: do nothing.
    pub PAUSE: fn pause(Situation) -> Action {
        1: otherwise  => Finish;
    }
}

decision_table! {
    /// LOOK: look at the door.
    pub LOOK: fn look(Situation) -> Action {
        1: door: Open | Shut  => Finish;
        2: door: Stuck        => Wait;
    }
}

static PROCESSES: [ProcessInfo; 2] = [
    ProcessInfo { name: "Front Door", tables: &[&ACCEPT, &CLOSE_DOOR, &PAUSE, &LOOK], goals: &[] },
    ProcessInfo { name: "Gate", tables: &[&PAUSE], goals: &[] },
];

#[test]
fn page_explains_each_table_word_once() {
    let all = page(&PROCESSES);
    let text = all.strip_prefix(HEAD).expect("the form is explained first");
    let sources = |line: &&str| !line.starts_with("Source: ");
    let text: String = text.lines().filter(sources).flat_map(|line| [line, "\n"]).collect();
    assert_eq!(
        text,
        "
- [Front Door](#front-door): ACCEPT, CLOSE-DOOR, PAUSE, LOOK
- [Gate](#gate): PAUSE

## Front Door

### 1. ACCEPT

ACCEPT: it must not be dark.


| row | when      | action     |
| --: | --------- | ---------- |
|   1 | lamp: Off | Fail(Dark) |
|   2 | lamp: On  | consult    |

State variables:

- `lamp`: The lamp when the command arrived.
  - `Off`: It is off.
  - `On`: It is on.

### 2. CLOSE-DOOR

CLOSE-DOOR: shut it.


| row | step    | when                | action          | next    |
| --: | ------- | ------------------- | --------------- | ------- |
|   1 | any     | door: Shut          | Finish          |         |
|   2 |         | lamp: Off           | Fail(Dark)      |         |
|   3 | Start   | door: Open or Stuck | Drive(Creep)    | Closing |
|   4 | Closing | door: Open          | Wait            |         |
|   5 |         | door: Stuck         | Fail(DoorStuck) |         |

Steps:

- `Start`: Nothing done yet.
- `Closing`: The door is driven.

State variables:

- `lamp`: The lamp.
  - `Off`: It is off.

### 3. PAUSE

PAUSE: do nothing.


| row | when      | action |
| --: | --------- | ------ |
|   1 | otherwise | Finish |

### 4. LOOK

LOOK: look at the door.


| row | when               | action |
| --: | ------------------ | ------ |
|   1 | door: Open or Shut | Finish |
|   2 | door: Stuck        | Wait   |

### Values

What several tables of the process share.

State variables:

- `door`: The door, see `Door`.
  - `Open`: Nothing is in the way.
  - `Shut`: Both switches see it.
  - `Stuck`: It stands between its switches.

Actions:

- `Wait`: Nothing new.
- `Drive`: Drive the door.
  - `Creep`: As slowly as it can.
- `Finish`: Report done.
- `Fail`: Report an error.
  - `DoorStuck`: the door is stuck
  - `Dark`: it is dark

## Gate

1. PAUSE: table 3 of [Front Door](#front-door)
"
    );
    let passed = accept((), &Request { lamp: Lamp::On });
    assert_eq!(passed, rcs_core::table::Verdict::Passed(()));
    let decision = close_door(CloseDoorStep::Start, &Situation { door: Door::Stuck, lamp: Lamp::On });
    assert_eq!((decision.row, pause((), &Situation { door: Door::Shut, lamp: Lamp::On }).row), (3, 1));
    assert_eq!(look((), &Situation { door: Door::Stuck, lamp: Lamp::On }).row, 2);
}

#[test]
fn doc_comment_links_are_omitted() {
    assert_eq!(
        prose(" See [`Pose`](crate::rcs_run::pose), [`Tick`] and [the cell](docs/cell.md)."),
        "See `Pose`, `Tick` and the cell."
    );
    assert_eq!(prose("The sector, [1, 16], of poses[2]"), "The sector, [1, 16], of poses[2]");
}

/// The page explains every name in a row.
#[test]
fn every_value_in_a_row_is_explained() {
    let tables = Ladder::processes().iter().flat_map(|process| process.tables);
    for (table, row) in tables.flat_map(|table| table.rows.iter().map(move |row| (table, row))) {
        let at = || format!("{} row {}", table.name, row.number);
        let told =
            |of: &EnumSchema, name: &str| of.named(name).is_some_and(|value| !sentence(value).is_empty());
        for asked in row.when {
            let variable = table.variables.iter().find(|variable| variable.name == asked.variable);
            let variable = variable.unwrap_or_else(|| panic!("{}: {}", at(), asked.variable));
            assert!(!variable.doc.is_empty(), "{}: {}", at(), variable.name);
            assert!(asked.values.iter().all(|value| told(variable.values, value)), "{}: {asked}", at());
        }
        if let Some(steps) = table.steps {
            assert!(row.steps.iter().copied().chain(row.next).all(|step| told(steps, step)), "{}", at());
        }
        if let Some(action) = table.actions.iter().find(|action| action.name == row.action) {
            assert!(!action.doc.is_empty(), "{}: {}", at(), action.name);
            let carried = row.argument.is_none_or(|name| action.argument.is_some_and(|of| told(of, name)));
            assert!(carried, "{}: {}", at(), row.call());
        } else {
            assert!(row.action == "consult" || table.actions.is_empty(), "{}: {}", at(), row.action);
        }
    }
}
