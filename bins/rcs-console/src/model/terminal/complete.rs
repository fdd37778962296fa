//! Tab completion, from the words of the terminals, the requests, and the names of the task data.

use std::{collections::BTreeSet, path::Path};

use diagnostics::JOBS;
use interfaces::{
    operator::Variable,
    station::{LineVerb, following},
};
use taskdata::load::{BlockNumber, Source, Store, source::blocks, verdict::TASK_COMMANDS};

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Names {
    pub objects: Vec<String>,
    /// Locations that a command can name.
    pub locations: Vec<String>,
    pub others: Vec<String>,
    pub grips: Vec<(String, i32)>,
    pub blocks: Vec<BlockNumber>,
    pub jobs: Vec<String>,
}

impl Names {
    /// The names in these texts, and the jobs in their directory. If the data have errors, only the blocks have names.
    #[must_use]
    pub fn of(sources: &[Source], directory: &Path) -> Self {
        let numbers = sources.iter().flat_map(|source| blocks(0, source).0).map(|block| block.number);
        let numbers: BTreeSet<BlockNumber> = numbers.collect();
        let jobs = JOBS.names(directory);
        let mut names = Self { blocks: numbers.into_iter().collect(), jobs, ..Self::default() };
        let Ok((store, _)) = Store::from_sources(sources.to_vec()) else { return names };
        let data = store.view();
        let sorted = |names: &mut dyn Iterator<Item = String>| {
            let names: BTreeSet<String> = names.collect();
            names.into_iter().collect::<Vec<_>>()
        };
        let object = |id| data.object_record(id).map(|object| object.name.to_string());
        names.objects = sorted(&mut data.objects.iter().map(|object| object.name.to_string()));
        names.locations = sorted(
            &mut data
                .owners
                .iter()
                .map(|owner| owner.name.to_string())
                .chain(data.locpts.iter().map(|point| point.name.to_string())),
        );
        names.others = sorted(
            &mut data
                .poses
                .iter()
                .map(|pose| pose.name.to_string())
                .chain(data.movetables.iter().map(|table| table.name.to_string())),
        );
        names.grips =
            data.end_effs.iter().filter_map(|grip| Some((object(grip.object)?, grip.grip))).collect();
        names
    }
}

/// The words that can follow the first words of a line, except those of the station ([`following`]); `*` matches any.
static FOLLOWING: [(&[&str], &[&str]); 14] = [
    (&["job"], &["wait", "go", "skip"]),
    (&["db-done"], ON_OFF),
    (&["pedestal"], &["pre-grip", "grip", "flip", "release", "pause"]),
    (&["pedestal", "release"], &["by"]),
    (&["confirm"], &["clamped", "by"]),
    (&["board"], &["0", "2", "4", "6", "8"]),
    (&["board", "*"], &["stop", "go"]),
    (
        &["execute"],
        &["TASK", "SUBTASK", "EMOVE", "PRIM", "T3I", "QUICK-CHANGE", "GRIP", "V-GRIP", "TOOL-GRIP"],
    ),
    (&["stand-alone"], &["now"]),
    (&["load"], &["16000", "20000", "21000"]),
    (&["BOARD"], &["0", "2", "4", "6", "8", "12"]),
    (&["OFFSET"], &["!", "@"]),
    (&["*", "OFFSET"], &["!"]),
    (&["send"], TASK_COMMANDS),
];
const ON_OFF: &[&str] = &["on", "off"];
/// First words of requests that are not lines for the station.
const REQUESTS: [&str; 17] = [
    "board",
    "confirm",
    "db-done",
    "execute",
    "go",
    "job",
    "leave",
    "line-load",
    "load",
    "note",
    "pedestal",
    "robot-init",
    "run",
    "send",
    "stand-alone",
    "stop",
    "write",
];
/// Words that can follow one or more numbers.
const BEHIND_NUMBERS: [&str; 7] = ["EDIT", "LINE-LOAD", "LIST", "LOAD", "OFFSET", "OLOAD", "TEACH"];

fn candidates(words: &[&str], names: &Names, terminal: &[&str]) -> Vec<String> {
    let owned = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>();
    let blocks_at = |offset: Option<u32>| {
        let found = names.blocks.iter().filter(|block| offset.is_none_or(|offset| block.offset == offset));
        found.map(|block| block.number.to_string()).collect::<Vec<_>>()
    };
    match *words {
        [] => {
            // Some words of a job have another meaning as a request, or none.
            let station =
                LineVerb::ALL.iter().filter(|verb| !matches!(verb, LineVerb::Wait | LineVerb::After));
            let first = REQUESTS.iter().chain(TASK_COMMANDS).chain(terminal).copied();
            let first: BTreeSet<&str> = first.chain(station.map(|verb| verb.text())).collect();
            owned(&first.into_iter().collect::<Vec<_>>())
        }
        ["run"] => names.jobs.clone(),
        ["line-load"] => blocks_at(Some(taskdata::load::commands::OFFSET)),
        ["load", offset] => blocks_at(offset.parse().ok()),
        ["LOC"] => [&names.objects[..], &names.locations, &names.others].concat(),
        ["vise", _] | ["tray"] => names.locations.clone(),
        ["tray", _, _] | ["drum", "tool"] | ["machine"] | ["machine", _] => names.objects.clone(),
        ["machine", _, _] => names.locations.clone(),
        ["send" | "==", ref rest @ ..] if !rest.is_empty() => candidates(rest, names, &[]),
        [verb, ref fields @ ..] if TASK_COMMANDS.contains(&verb) => field(fields, names),
        ["write"] => owned(&Variable::ALL.iter().map(|variable| variable.text()).collect::<Vec<_>>()),
        ["write", _] | [.., "<="] => values(names),
        ["write", _, object] => grips(object, names),
        [.., last] if last.parse::<u32>().is_ok() && words.iter().all(|word| word.parse::<u32>().is_ok()) => {
            owned(&BEHIND_NUMBERS)
        }
        _ => {
            let fits = |front: &[&str]| {
                front.len() == words.len()
                    && front.iter().zip(words).all(|(front, word)| *front == "*" || front == word)
            };
            let found = FOLLOWING.iter().find(|(front, _)| fits(front));
            let station = following(words).unwrap_or_default().iter().flat_map(|list| list.variants);
            found.map_or_else(
                || station.map(|variant| variant.text.to_owned()).collect(),
                |(_, following)| owned(following),
            )
        }
    }
}

/// The candidates for the next field of a command (V.4.1): the object; grip, location and sector of source and
/// destination; location and sector of the end.
fn field(fields: &[&str], names: &Names) -> Vec<String> {
    let null = || "--".to_owned();
    match fields.len() {
        0 => names.objects.iter().cloned().chain([null()]).collect(),
        1 | 4 => {
            let object = fields.first().copied().unwrap_or_default();
            grips(object, names).into_iter().chain(["0".to_owned()]).collect()
        }
        2 | 5 | 7 => names.locations.iter().cloned().chain([null()]).collect(),
        _ => Vec::new(),
    }
}

/// The values that can be written to a variable.
fn values(names: &Names) -> Vec<String> {
    std::iter::once("NONE".to_owned()).chain(names.objects.iter().cloned()).collect()
}

fn grips(object: &str, names: &Names) -> Vec<String> {
    let grips = names.grips.iter().filter(|(name, _)| name == object);
    let grips: BTreeSet<String> = grips.map(|(_, grip)| format!("{grip:+}")).collect();
    grips.into_iter().collect()
}

/// The completed line, and the candidates for the word at its end. `terminal` are the words of the terminal.
#[must_use]
pub fn complete(line: &str, names: &Names, terminal: &[&str]) -> (String, Vec<String>) {
    let (front, begun) = line.rsplit_once(' ').map_or(("", line), |(front, begun)| (front, begun));
    let words: Vec<&str> = front.split_whitespace().collect();
    let mut fitting = candidates(&words, names, terminal);
    fitting.retain(|word| word.starts_with(begun));
    let Some(first) = fitting.first() else { return (line.to_owned(), fitting) };
    let common = fitting.iter().fold(first.len(), |common, word| {
        let same = first.bytes().zip(word.bytes()).take(common);
        same.take_while(|(one, other)| one == other).count()
    });
    let kept = line.len() - begun.len();
    let mut completed =
        format!("{}{}", line.get(..kept).unwrap_or(line), first.get(..common).unwrap_or(begun));
    if fitting.len() == 1 {
        completed.push(' ');
    }
    (completed, fitting)
}

#[cfg(test)]
mod tests {
    use super::*;
    use taskdata::load::source::read_blocks_under;

    fn names() -> Names {
        let directory = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data");
        Names::of(&read_blocks_under(&directory).0, &directory)
    }

    #[test]
    fn completion_offers_words_and_names_by_position() {
        let names = names();
        let completed = |line: &str| complete(line, &names, &["LIST", "TAI"]).0;
        for (line, full) in [
            ("job g", "job go "),
            ("joy", "joystick "),
            ("joystick frame WO", "joystick frame WORLD "),
            ("panel hyd", "panel hydraulics "),
            ("run link", "run linkbar "),
            ("send TRAN", "send TRANSFER "),
            ("MOVE LINKBAR1_B", "MOVE LINKBAR1_BH "),
            ("send MOVE LINKBAR1_B", "send MOVE LINKBAR1_BH "),
            ("MOVE LINKBAR1_BH +2 UNIT_1 4 +2 PFIX", "MOVE LINKBAR1_BH +2 UNIT_1 4 +2 PFIXTURE "),
            ("INSERT-TOOL DRI", "INSERT-TOOL DRILL-2 "),
            ("line-load 89", "line-load 893 "),
            ("load 21000 61", "load 21000 61"),
            ("863 LIS", "863 LIST "),
            ("TA", "TAI "),
            ("LOC SAFE-", "LOC SAFE-P "),
            ("wr", "write "),
            ("write emove.estimates.h", "write emove.estimates.held "),
            ("write emove.estimates.held NO", "write emove.estimates.held NONE "),
            (":S held <= LINKBAR1_B", ":S held <= LINKBAR1_BH "),
            ("write emove.estimates.held LINKBAR1_BH +2", "write emove.estimates.held LINKBAR1_BH +2 "),
            ("xyz", "xyz"),
        ] {
            assert_eq!(completed(line), full, "{line}");
        }
        let (_, grips) = complete("MOVE LINKBAR1_BH ", &names, &[]);
        assert!(grips.contains(&"+2".to_owned()) && grips.contains(&"0".to_owned()), "{grips:?}");
        let (_, several) = complete("st", &names, &[]);
        assert_eq!(several, ["stand-alone", "stop"]);
    }

    #[test]
    fn data_with_errors_have_known_blocks() {
        let wrong = Source { name: "x.blk".into(), text: "BLOCK# 7 OFFSET 21000\nnonsense\n".into() };
        let names = Names::of(&[wrong], Path::new("nowhere"));
        assert_eq!(names.blocks, [BlockNumber { offset: 21_000, number: 7 }]);
        assert!(names.objects.is_empty() && names.jobs.is_empty());
    }
}
