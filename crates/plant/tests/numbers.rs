//! Every number of a cell description: for any value, either a message rejects the cell or it runs.

use std::{
    fs,
    ops::Range,
    panic::{AssertUnwindSafe, catch_unwind},
};

use diagnostics::Diagnostic;
use interfaces::device::DeviceOutputs;
use plant::{Cell, CellDescription};

/// Positions of the numbers in a description: after an equals sign, or in an array.
fn numbers(text: &str) -> Vec<Range<usize>> {
    let (mut found, mut begin, mut quoted, mut remark) = (Vec::new(), None, false, false);
    for (at, character) in text.char_indices() {
        match character {
            '\n' => remark = false,
            '"' if !remark => quoted = !quoted,
            '#' if !quoted => remark = true,
            _ => {}
        }
        let part = !quoted && !remark && (character.is_ascii_digit() || "+-.".contains(character));
        match (part, begin) {
            (true, None) if text[..at].ends_with([' ', '[', '=', ',', '\n']) => begin = Some(at),
            (false, Some(start)) => {
                let is_value = [' ', ',', ']', '\n', '}'].contains(&character);
                found.extend(is_value.then_some(start..at));
                begin = None;
            }
            _ => {}
        }
    }
    found
}

fn runs(text: &str) -> Result<(), String> {
    let description = CellDescription::from_toml(text).map_err(|error| error.to_string())?;
    let mut cell = Cell::new(&description, 1).map_err(|error| error.to_string())?;
    for _ in 0..10 {
        cell.step(&DeviceOutputs::default());
    }
    Ok(())
}

#[test]
fn every_number_is_refused_with_a_message_or_runs() {
    let text = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/cell.toml")).unwrap();
    let numbers = numbers(&text);
    assert!(numbers.len() > 200, "{} numbers", numbers.len());
    assert_eq!(runs(&text), Ok(()));
    let mut panicked = Vec::new();
    for place in &numbers {
        for value in ["1e308", "-1e308", "nan", "inf", "-inf", "0", "0.0", "1e-300", "1e5", "-1e5"] {
            let changed = format!("{}{value}{}", &text[..place.start], &text[place.end..]);
            match catch_unwind(AssertUnwindSafe(|| runs(&changed))) {
                Ok(Ok(())) => {
                    assert!(
                        !["1e308", "-1e308", "nan", "inf", "-inf"].contains(&value),
                        "{value} at {place:?}"
                    );
                }
                Ok(Err(why)) => assert!(!why.is_empty()),
                Err(_) => {
                    let line = text[..place.start].lines().count();
                    panicked.push(format!("line {line}: {} = {value}", &text[place.clone()]));
                }
            }
        }
    }
    assert!(panicked.is_empty(), "{panicked:#?}");
}

/// The expected values in the message that rejects a value here; `None` if the cell is accepted.
fn expected(text: &str, place: &Range<usize>, value: &str) -> Option<String> {
    let changed = format!("{}{value}{}", &text[..place.start], &text[place.end..]);
    let report = CellDescription::from_toml(&changed).err()?;
    let here = |fault: &&Diagnostic| fault.at().is_some_and(|at| at.start as usize == place.start);
    report.diagnostics().iter().find(here).and_then(|fault| fault.expected().map(str::to_owned))
}

#[test]
fn positive_values_get_only_positive_suggestions() {
    let text = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/cell.toml")).unwrap();
    let mut positive = 0;
    for place in numbers(&text) {
        if expected(&text, &place, "-1.0").as_deref() == Some("more than 0") {
            positive += 1;
            for value in ["1e308", "-1e308", "1e-300"] {
                let offered = expected(&text, &place, value);
                assert_eq!(
                    offered.as_deref(),
                    Some("a number from 0.000001 to 100000"),
                    "{value} at {place:?}"
                );
            }
        }
    }
    assert!(positive > 100, "{positive} numbers must be more than 0");
}
