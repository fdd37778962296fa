//! All changes are compiled together; a test program selects one when it starts. Next to `pub TURN: fn turn(..)` each
//! change adds a table, `TURN_CHANGED_17`, and `turn` consults the table whose number is in [`CHANGED`]. If
//! [`REACHED`] names a file, no change is selected, and the numbers of those that would have decided otherwise are
//! written to it: a test that does not reach a change cannot detect it.

use std::{
    collections::{BTreeMap, HashMap},
    fmt::Write as _,
    fs, io,
    ops::Range,
    path::{Path, PathBuf},
};

use whole_system_tests::tables::Table;

use crate::mutate::Mutant;

pub const CHANGED: &str = "RCS_CHANGED_ROW"; // number of the selected change
pub const REACHED: &str = "RCS_REACHED_ROWS"; // file for the numbers of the reached changes

/// The addition to `lib.rs` of the copy.
const SELECTION: &str = r#"
extern crate std;

/// Number of the change that is switched on: 0 for none, `usize::MAX` to write which ones are reached.
pub(crate) fn changed_row() -> usize {
    static CHANGED: std::sync::OnceLock<usize> = std::sync::OnceLock::new();
    let number = || std::env::var("RCS_CHANGED_ROW").map_or(0, |text| text.parse().unwrap_or(0));
    *CHANGED.get_or_init(|| std::env::var("RCS_REACHED_ROWS").map_or_else(|_| number(), |_| usize::MAX))
}

/// Write the number of a change that is reached, once.
pub(crate) fn reached_row(number: usize) {
    static KNOWN: std::sync::Mutex<std::collections::BTreeSet<usize>> =
        std::sync::Mutex::new(std::collections::BTreeSet::new());
    if KNOWN.lock().is_ok_and(|mut known| known.insert(number)) {
        let path = std::env::var("RCS_REACHED_ROWS").unwrap_or_default();
        let file = std::fs::OpenOptions::new().create(true).append(true).open(path);
        let _ = file.and_then(|mut file| std::io::Write::write_all(&mut file, std::format!("{number}\n").as_bytes()));
    }
}
"#;

/// A test that compares the text of the table. Every changed condition would fail it.
const CHECK: (&str, &str) = (
    "assert_eq!(read, Some(row), \"{} with {values:?}\", table.name);",
    "let (_, _, _) = (read, row, table.name);",
);

/// `pub TURN: fn turn(enum TurnStep, super::Situation) -> super::Action or () {`. With `struct of super::Senses` the
/// table declares the struct `TurnSituation`.
struct Head<'a> {
    name: &'a str,
    decide: &'a str,
    step: Option<&'a str>,
    declares: bool,
    situation: &'a str,
    result: &'a str,
}

impl<'a> Head<'a> {
    fn read(text: &'a str) -> Option<Self> {
        let (name, rest) = text.trim().strip_prefix("pub ")?.split_once(": fn ")?;
        let (decide, rest) = rest.split_once('(')?;
        let (parameters, result) = rest.split_once(") -> ")?;
        let result = result.strip_suffix(" {")?;
        let (step, situation) = match parameters.split_once(", ") {
            Some((step, situation)) => (Some(step), situation),
            None => (None, parameters),
        };
        let declares = step.is_some_and(|step| step.starts_with("enum "));
        let step = step.map(|step| step.trim_start_matches("enum "));
        Some(Self { name, decide, step, declares, situation, result })
    }

    fn variables(&self) -> String {
        if !self.situation.starts_with("struct of ") {
            return self.situation.to_owned();
        }
        let words = self.name.split('_').map(|word| word[..1].to_owned() + &word[1..].to_lowercase());
        words.collect::<String>() + "Situation"
    }

    fn function(&self, which: &str) -> String {
        format!("{}_{which}", self.decide.trim_start_matches("r#"))
    }

    fn unchanged(&self) -> String {
        let step = match (self.step, self.declares) {
            (Some(step), true) => format!("enum {step}, "),
            (Some(step), false) => format!("{step}, "),
            (None, _) => String::new(),
        };
        let (name, function) = (self.name, self.function("unchanged"));
        format!("    pub {name}: fn {function}({step}{}) -> {} {{", self.situation, self.result)
    }

    fn changed(&self, number: usize) -> String {
        let step = self.step.map_or_else(String::new, |step| format!("{step}, "));
        let (name, function) = (self.name, self.function(&format!("changed_{number}")));
        format!(
            "    pub {name}_CHANGED_{number}: fn {function}({step}{}) -> {} {{",
            self.variables(),
            self.result
        )
    }

    fn selection(&self, mutants: &[(usize, &Mutant)]) -> String {
        let (generic, step) = self.step.map_or(("<Step: Copy>", "Step"), |step| ("", step));
        let (result, row) = match self.result.split_once(" or ") {
            Some((action, passed)) => (
                format!("Verdict<{action}, {step}, {passed}>"),
                "match result {
        ::rcs_core::table::Verdict::Decided(decision) => Some(decision.row),
        ::rcs_core::table::Verdict::Passed(_) => None,
    }",
            ),
            None => (format!("Decision<{}, {step}>", self.result), "Some(result.row)"),
        };
        let mut text = format!(
            "
/// Consult the table that is switched on.
#[must_use]
pub fn {}{generic}(step: {step}, situation: &{}) -> ::rcs_core::table::{result} {{
    let row = |result: &::rcs_core::table::{result}| {row};
    let unchanged = {}(step, situation);
    let (changed, before) = (crate::changed_row(), row(&unchanged));
",
            self.decide,
            self.variables(),
            self.function("unchanged")
        );
        for (number, mutant) in mutants {
            let function = self.function(&format!("changed_{number}"));
            // Rows that pass on have no number.
            let same = if mutant.passes() { "None".to_owned() } else { format!("Some({})", mutant.row) };
            let _ = writeln!(
                text,
                "    if changed == usize::MAX && (before == {same} || before != row(&{function}(step, situation))) {{
        crate::reached_row({number});
    }}"
            );
        }
        text += "    match changed {\n";
        for (number, _) in mutants {
            let function = self.function(&format!("changed_{number}"));
            let _ = writeln!(text, "        {number} => {function}(step, situation),");
        }
        text + "        _ => unchanged,\n    }\n}\n"
    }
}

type Places = Vec<(Range<usize>, usize)>; // lines of each change of a file, from 1, and its number

#[derive(Default)]
pub struct Switched {
    pub texts: HashMap<PathBuf, String>, // by path from the root of the repository
    places: HashMap<PathBuf, Places>,
}

impl Switched {
    /// The files with all changes. Fails if a file cannot be read, or does not have the expected form.
    pub fn new(root: &Path, mutants: &BTreeMap<usize, &Mutant>) -> io::Result<Self> {
        let mut switched = Self::default();
        let mut files: BTreeMap<&Path, BTreeMap<usize, &Mutant>> = BTreeMap::new();
        for (number, mutant) in mutants {
            files.entry(&mutant.file).or_default().insert(*number, mutant);
        }
        for (file, mutants) in files {
            let (text, places) =
                switch(file, &fs::read_to_string(root.join(file))?, &mutants).ok_or_else(|| {
                    io::Error::other(format!("{}: the head of a table has another form", file.display()))
                })?;
            switched.texts.insert(file.to_owned(), text);
            switched.places.insert(file.to_owned(), places);
        }
        let lib = PathBuf::from("crates/levels/src/lib.rs");
        let text = fs::read_to_string(root.join(&lib))? + SELECTION;
        switched.texts.insert(lib, text);
        let coverage = PathBuf::from("crates/levels/src/coverage.rs");
        let text = fs::read_to_string(root.join(&coverage))?;
        if !text.contains(CHECK.0) {
            return Err(io::Error::other(format!("{}: expected {:?}", coverage.display(), CHECK.0)));
        }
        switched.texts.insert(coverage, text.replace(CHECK.0, CHECK.1));
        Ok(switched)
    }

    pub fn change_at(&self, file: &Path, line: usize) -> Option<usize> {
        let places = self.places.get(file)?;
        places.iter().find(|(lines, _)| lines.contains(&line)).map(|(_, number)| *number)
    }
}

fn switch(file: &Path, text: &str, mutants: &BTreeMap<usize, &Mutant>) -> Option<(String, Places)> {
    let mut lines: Vec<String> = Vec::new();
    let mut places = Places::new();
    let before: Vec<&str> = text.lines().collect();
    let mut copied = 0;
    for table in Table::read(file, text) {
        let mine: Vec<_> =
            mutants.iter().filter(|(_, mutant)| table.lines.contains(&mutant.lines.start)).collect();
        if mine.is_empty() {
            continue;
        }
        let head = Head::read(before[table.head])?;
        lines.extend(before[copied..table.lines.end].iter().map(|line| (*line).to_owned()));
        let of_head = lines.len() - (table.lines.end - table.head);
        lines[of_head] = head.unchanged();
        copied = table.lines.end;
        for (number, mutant) in &mine {
            let changed = mutant.apply(text);
            let first = lines.len() + 1;
            lines.push(String::new());
            lines.extend(changed.lines().skip(table.lines.start).take(table.lines.len()).map(str::to_owned));
            let of_head = lines.len() - (table.lines.end - table.head);
            lines[of_head] = head.changed(**number);
            places.push((first..lines.len() + 1, **number));
        }
        let mine: Vec<_> = mine.into_iter().map(|(number, mutant)| (*number, *mutant)).collect();
        lines.extend(head.selection(&mine).lines().map(str::to_owned));
    }
    lines.extend(before[copied..].iter().map(|line| (*line).to_owned()));
    Some((lines.join("\n") + "\n", places))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "\
decision_table! {
    /// RELEASE: open the gripper.
    pub RELEASE: fn release(enum ReleaseStep, super::Situation) -> super::Action or () {
        /// Nothing done yet.
        Start {
            1: work: Busy               => Wait;
            2: work: Over               => Finish;
        }
    }
}

fn other() {}
";

    #[test]
    fn a_changed_table_is_compiled_next_to_the_table_and_selected_by_number() {
        let table = &Table::read(Path::new("release.rs"), TEXT)[0];
        let mutants = crate::mutate::mutants(table);
        let finish = mutants.iter().find(|mutant| mutant.after.contains("Busy => Finish")).unwrap();
        let (text, places) = switch(Path::new("release.rs"), TEXT, &BTreeMap::from([(17, finish)])).unwrap();
        assert_eq!(
            text,
            "\
decision_table! {
    /// RELEASE: open the gripper.
    pub RELEASE: fn release_unchanged(enum ReleaseStep, super::Situation) -> super::Action or () {
        /// Nothing done yet.
        Start {
            1: work: Busy               => Wait;
            2: work: Over               => Finish;
        }
    }
}

decision_table! {
    /// RELEASE: open the gripper.
    pub RELEASE_CHANGED_17: fn release_changed_17(ReleaseStep, super::Situation) -> super::Action or () {
        /// Nothing done yet.
        Start {
            1: work: Busy => Finish;
            2: work: Over               => Finish;
        }
    }
}

/// Consult the table that is switched on.
#[must_use]
pub fn release(step: ReleaseStep, situation: &super::Situation) -> \
::rcs_core::table::Verdict<super::Action, ReleaseStep, ()> {
    let row = |result: &::rcs_core::table::Verdict<super::Action, ReleaseStep, ()>| match result {
        ::rcs_core::table::Verdict::Decided(decision) => Some(decision.row),
        ::rcs_core::table::Verdict::Passed(_) => None,
    };
    let unchanged = release_unchanged(step, situation);
    let (changed, before) = (crate::changed_row(), row(&unchanged));
    if changed == usize::MAX && (before == Some(1) || before != row(&release_changed_17(step, situation))) {
        crate::reached_row(17);
    }
    match changed {
        17 => release_changed_17(step, situation),
        _ => unchanged,
    }
}

fn other() {}
"
        );
        assert_eq!(places, [(11..22, 17)]);
    }

    #[test]
    fn changed_table_has_the_state_variables_of_the_table() {
        let text =
            "    pub GRASP_OBJ: fn grasp_obj(enum GraspObjStep, struct of super::Senses) -> super::Action {";
        let head = Head::read(text).unwrap();
        assert_eq!(head.unchanged(), text.replace("fn grasp_obj(", "fn grasp_obj_unchanged("));
        assert_eq!(
            head.changed(3),
            "    pub GRASP_OBJ_CHANGED_3: fn grasp_obj_changed_3(GraspObjStep, GraspObjSituation) -> super::Action {"
        );
        assert!(
            head.selection(&[]).contains("fn grasp_obj(step: GraspObjStep, situation: &GraspObjSituation)")
        );
    }

    #[test]
    fn a_table_without_steps_takes_those_of_its_caller() {
        let head = Head::read("    pub PAUSE: fn r#pause(super::Situation) -> super::Action {").unwrap();
        assert_eq!(
            head.changed(3),
            "    pub PAUSE_CHANGED_3: fn pause_changed_3(super::Situation) -> super::Action {"
        );
        assert!(head.selection(&[]).contains(
            "pub fn r#pause<Step: Copy>(step: Step, situation: &super::Situation) -> \
             ::rcs_core::table::Decision<super::Action, Step> {"
        ));
    }
}
