//! Rows of decision tables are in columns: `RCS_TABLES=write cargo test --release -p whole-system-tests --test pages
//! columns`.

use std::{env, fs, path::PathBuf};

use whole_system_tests::{
    root,
    tables::{Table, WIDEST, aligned, files},
};

#[test]
fn rows_of_tables_are_in_columns() {
    let mut paths: Vec<PathBuf> = Vec::new();
    for (directory, extension) in [("crates", "rs"), ("bins", "rs"), ("docs", "md")] {
        files(&root().join(directory), extension, &mut paths).expect("the directory can be listed");
    }
    paths.sort();
    let write = env::var_os("RCS_TABLES").is_some_and(|value| value == "write");
    let (mut old, mut wide) = (Vec::new(), Vec::new());
    for path in paths {
        let text = fs::read_to_string(&path).expect("the file can be read");
        let after = aligned(&text);
        let name = path.strip_prefix(root()).unwrap_or(&path).display();
        for row in Table::read(&path, &after).iter().flat_map(|table| &table.rows) {
            let lines = after.lines().skip(row.lines.start).take(row.lines.len());
            let too_wide = lines.filter(|line| line.chars().count() > WIDEST);
            wide.extend(too_wide.map(|line| format!("{name}: {}", line.trim())));
        }
        if after == text {
            continue;
        }
        let differs = text.lines().zip(after.lines()).find(|(line, after)| line != after);
        old.push(format!("{name}: {differs:?}"));
        if write {
            fs::write(&path, after).expect("the file can be written");
        }
    }
    assert!(wide.is_empty(), "rows wider than {WIDEST} columns; divide them:\n{}", wide.join("\n"));
    assert!(
        old.is_empty() || write,
        "rows are not in columns: RCS_TABLES=write cargo test --release -p whole-system-tests --test pages columns\n{}",
        old.join("\n")
    );
}

fn columns(rows: &str) -> Vec<String> {
    let text =
        format!("decision_table! {{\n    pub TURN: fn turn(Situation) -> Action {{\n{rows}\n    }}\n}}\n");
    let after = aligned(&text);
    assert_eq!(aligned(&after), after, "columns stay as they are");
    let rows: Vec<String> = after.lines().skip(2).map(str::to_owned).collect();
    rows[..rows.len() - 2].to_vec()
}

#[test]
fn numbers_variables_actions_and_steps_are_in_columns() {
    assert_eq!(
        columns(
            "        9: door: Shut, lamp: On=>Wait;\n        10: door: Open | Stuck, lamp:Off => Close->Closing;\n\
            \x20       11: lamp: On => Fail(Dark) -> Off;\n        12:otherwise =>Finish;"
        ),
        [
            "        9:  door: Shut,         lamp: On   => Wait;",
            "        10: door: Open | Stuck, lamp: Off  => Close       -> Closing;",
            "        11: lamp: On                       => Fail(Dark)  -> Off;",
            "        12: otherwise                      => Finish;",
        ]
    );
}

#[test]
fn variables_of_other_groups_are_not_in_a_column() {
    assert_eq!(
        columns(
            "        any {\n            1: door: Open | Stuck, lamp: On => Wait;\n        }\n        Start {\n\
            \x20           2: door: Shut, lamp: On => Wait;\n        }"
        )
        .into_iter()
        .filter(|line| line.contains("=>"))
        .collect::<Vec<_>>(),
        [
            "            1: door: Open | Stuck, lamp: On  => Wait;",
            "            2: door: Shut, lamp: On          => Wait;",
        ]
    );
}

#[test]
fn row_that_would_be_too_wide_leaves_the_columns() {
    let values = "abcdefghi".repeat(7);
    assert_eq!(
        columns(&format!(
            "        1: door: {values} => Fail(Dark) -> Off;\n        2: lamp: On => AVeryLongActionForTheColumn -> On;"
        )),
        [
            format!("        1: door: {values} => Fail(Dark) -> Off;"),
            "        2: lamp: On  => AVeryLongActionForTheColumn  -> On;".to_owned(),
        ]
    );
}

#[test]
fn row_wider_than_the_page_has_its_action_in_a_second_line() {
    let values = "abcdefghi".repeat(10);
    assert_eq!(
        columns(&format!(
            "        1: door: {values} => Fail(Dark) -> Off;\n        2: lamp: On => Wait -> On;"
        )),
        [
            format!("        1: door: {values}"),
            "                     => Fail(Dark)  -> Off;".to_owned(),
            "        2: lamp: On  => Wait        -> On;".to_owned(),
        ]
    );
}
