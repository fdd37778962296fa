use std::{
    fmt, fs, io,
    ops::Range,
    path::{Path, PathBuf},
};

use whole_system_tests::tables::{Row, Table, files};

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mutant {
    pub file: PathBuf, // from the root of the repository
    table: String,
    pub row: String,
    what: What,
    pub lines: Range<usize>, // from 0; with the text of the row before and after
    pub before: String,
    pub after: String,
    pub other: Option<(Range<usize>, String)>, // an alternative moves from one row to another
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum What {
    Action,
    NextStep,
    Condition,
}

impl fmt::Display for Mutant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let what = match self.what {
            What::Action => "action",
            What::NextStep => "next step",
            What::Condition => "condition",
        };
        write!(f, "{} {} row {}: {what}", self.file.display(), self.table, self.row)
    }
}

impl Mutant {
    /// The prefix that the names of the process's tests have; empty for a table that all processes share.
    pub fn process(&self) -> String {
        let mut parts = self.file.components().skip(3).map(|part| part.as_os_str().to_string_lossy());
        match (parts.next(), parts.next()) {
            (Some(process), Some(_)) => format!("{process}::"),
            _ => String::new(),
        }
    }

    /// `row` as `"QC-LOCK 3"`.
    pub fn is_of(&self, row: &str) -> bool {
        row.rsplit_once(' ')
            .is_some_and(|(table, number)| table.replace('-', "_") == self.table && number == self.row)
    }

    /// True if the changed row passes a value on, before or after the change.
    pub fn passes(&self) -> bool {
        let other = self.other.as_ref().map(|(_, after)| after);
        [&self.before, &self.after].into_iter().chain(other).any(|row| row.contains("=> consult"))
    }

    pub fn apply(&self, text: &str) -> String {
        let mut lines: Vec<&str> = text.lines().collect();
        let other = self.other.iter().map(|(lines, after)| (lines, after));
        for (of_row, after) in [(&self.lines, &self.after)].into_iter().chain(other) {
            lines[of_row.clone()].fill(""); // the number of lines remains
            lines[of_row.start] = after;
        }
        lines.join("\n") + "\n"
    }
}

fn mutant(table: &Table, row: &Row, what: What, changed: &Row, other: Option<&Row>) -> Mutant {
    Mutant {
        file: table.file.clone(),
        table: table.name.clone(),
        row: row.number.clone(),
        what,
        lines: row.lines.clone(),
        before: row.text.clone(),
        after: changed.write(),
        other: other.map(|other| (other.lines.clone(), other.write())),
    }
}

/// All changes of a row: its action, its next step, or an alternative that moves to another row of the group.
pub fn mutants(table: &Table) -> Vec<Mutant> {
    let mut mutants = Vec::new();
    for row in &table.rows {
        let mut actions: Vec<&String> =
            table.rows.iter().map(|other| &other.action).filter(|action| **action != row.action).collect();
        actions.sort_unstable();
        actions.dedup();
        for action in actions {
            let changed = Row { action: action.clone(), ..row.clone() };
            mutants.push(mutant(table, row, What::Action, &changed, None));
        }
        let steps = table.steps.iter().cloned().map(Some).chain([None]).filter(|next| {
            // A change that names the only step as the next one has no effect.
            let stay = |next: &Option<String>| next.is_none() || *next == row.only_step;
            *next != row.next && !(stay(next) && stay(&row.next))
        });
        for next in steps {
            mutants.push(mutant(table, row, What::NextStep, &Row { next, ..row.clone() }, None));
        }
        let others = table.rows.iter().filter(|other| other.group == row.group && other.lines != row.lines);
        for other in others {
            exchange(table, row, other, &mut mutants);
        }
    }
    mutants
}

fn exchange(table: &Table, row: &Row, other: &Row, mutants: &mut Vec<Mutant>) {
    for (at, (name, values)) in row.conditions.iter().enumerate() {
        let Some(there) = other.conditions.iter().position(|(known, _)| known == name) else { continue };
        for (which, value) in values.iter().enumerate() {
            if other.conditions[there].1.contains(value) {
                continue;
            }
            let (mut mine, mut theirs) = (row.clone(), other.clone());
            if values.len() > 1 {
                mine.conditions[at].1.remove(which);
            } else {
                mine.conditions[at].1 = vec![theirs.conditions[there].1.remove(0)];
            }
            theirs.conditions[there].1.push(value.clone());
            mutants.push(mutant(table, row, What::Condition, &mine, Some(&theirs)));
        }
    }
}

fn random(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut mixed = *state;
    mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    mixed ^ (mixed >> 31)
}

/// The seed selects first the row, then its part, then the change. A row is selected again only after all others.
pub fn drawn(root: &Path, seed: u64, only: &str) -> io::Result<Vec<Mutant>> {
    let mut paths = Vec::new();
    files(&root.join("crates/levels/src"), "rs", &mut paths)?;
    paths.sort_unstable();
    let mut state = seed;
    let mut drawn = Vec::new();
    for path in paths {
        let name = path.strip_prefix(root).unwrap_or(&path).to_owned();
        if !name.to_string_lossy().contains(only) {
            continue;
        }
        for table in Table::read(&name, &fs::read_to_string(&path)?) {
            let mutants = mutants(&table);
            for row in &table.rows {
                let mut kinds: Vec<Vec<&Mutant>> = [What::Action, What::NextStep, What::Condition]
                    .map(|what| {
                        mutants.iter().filter(|it| it.lines == row.lines && it.what == what).collect()
                    })
                    .into();
                let mut turn = 0_u64;
                loop {
                    kinds.retain(|kind| !kind.is_empty());
                    if kinds.is_empty() {
                        break;
                    }
                    let kind = pick(&mut state, kinds.len());
                    let which = pick(&mut state, kinds[kind].len());
                    drawn.push((turn, random(&mut state), kinds[kind].swap_remove(which).clone()));
                    turn += 1;
                }
            }
        }
    }
    drawn.sort_by_key(|(turn, order, _)| (*turn, *order));
    Ok(drawn.into_iter().map(|(_, _, mutant)| mutant).collect())
}

fn pick(state: &mut u64, below: usize) -> usize {
    usize::try_from(random(state) % u64::try_from(below).unwrap_or(1)).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "\
decision_table! {
    /// RELEASE: open the gripper.
    pub RELEASE: fn release(enum ReleaseStep, super::Situation) -> super::Action {
        any {
            1: work: Busy               => Wait;
        }
        /// Nothing done yet.
        Start {
            2: work: Over, held: Left | Right => Release -> Releasing;
            3: work: Over, held: None   => Finish;
        }
        /// The gripper opens.
        Releasing {
            4: otherwise                => Finish;
        }
    }
}
";

    #[test]
    fn a_row_is_changed_in_its_action_its_next_step_and_its_conditions() {
        let tables = Table::read(Path::new("release.rs"), TEXT);
        let [table] = &tables[..] else { panic!("{tables:?}") };
        assert_eq!(
            (table.name.as_str(), &table.steps[..]),
            ("RELEASE", &["Start".into(), "Releasing".into()][..])
        );
        let lines = |number: &str, what| {
            let mutants =
                mutants(table).into_iter().filter(|mutant| mutant.row == number && mutant.what == what);
            mutants.map(|mutant| mutant.apply(TEXT)).collect::<Vec<_>>()
        };
        let changed = |texts: &[String]| {
            let differ = |text: &String| {
                let pairs = TEXT.lines().zip(text.lines()).filter(|(before, after)| before != after);
                pairs.map(|(_, after)| after.trim().to_owned()).collect::<Vec<_>>().join(" ")
            };
            texts.iter().map(differ).collect::<Vec<_>>()
        };
        assert_eq!(
            changed(&lines("1", What::Action)),
            ["1: work: Busy => Finish;", "1: work: Busy => Release;"]
        );
        assert_eq!(changed(&lines("4", What::NextStep)), ["4: otherwise => Finish -> Start;"]);
        assert_eq!(
            changed(&lines("2", What::Condition)),
            [
                "2: work: Over, held: Right => Release -> Releasing; 3: work: Over, held: None | Left => Finish;",
                "2: work: Over, held: Left => Release -> Releasing; 3: work: Over, held: None | Right => Finish;",
            ]
        );
        assert_eq!(
            changed(&lines("3", What::Condition)),
            [
                "2: work: Over, held: Right | None => Release -> Releasing; 3: work: Over, held: Left => Finish;"
            ]
        );
    }

    #[test]
    fn the_seed_gives_the_order() {
        let root = whole_system_tests::root();
        let [first, again, other] =
            [1, 1, 2].map(|seed| drawn(root, seed, "").expect("the tables can be read"));
        assert_eq!(first, again);
        assert_ne!(first, other);
        assert!(first.len() > 3000, "{} changes", first.len());
    }
}
