//! Compares docs/traceability.md, docs/reasons.md, the design pages ([`design`]), and the table of packages
//! ([`packages`]) with the code. Every command, variable and status value of chapters V and VI exists and has a test;
//! every name of the interfaces is on the page.

mod design;
mod packages;
mod sources;

use std::{
    collections::{BTreeMap, BTreeSet},
    fmt::Write as _,
    fs,
};

use interfaces::{CommonMemory, ExternalInputs, Reason};
use levels::task::plan::TaskVerb;
use neighbours::mailbox::TABLE;
use rcs_core::{
    Plain,
    plain::{EnumSchema, Schema, StructSchema, UnionSchema, VariantSchema},
};
use sessions::network::Role;
use whole_system_tests::root;

use self::sources::Sources;

struct Line {
    kind: &'static str,
    name: String,
    section: String,
    /// `Type::Variant` or `Record.field`; `None` for an omitted name, with the reason in place of the test.
    code: Option<String>,
    test: String,
}

struct Page {
    lines: Vec<Line>,
    /// Names that are not in the manual: code and reason. A star includes all of a type.
    beyond: Vec<(String, String)>,
    differences: Vec<[String; 4]>, // another meaning than the manual's: name, section, the manual, here
    mailboxes: Vec<[String; 3]>,   // chapter IX: name, section, test
}

fn cells(line: &str) -> Option<Vec<String>> {
    let row = line.strip_prefix("| ")?.strip_suffix(" |")?;
    Some(row.split(" | ").map(|cell| cell.trim().trim_matches('`').to_owned()).collect())
}

/// Texts in backquotes between commas; [`cells`] has removed the outer backquotes.
fn items(cell: &str) -> impl Iterator<Item = String> {
    cell.split(", ").map(|item| item.trim_matches('`').to_owned())
}

fn page() -> Page {
    let text = fs::read_to_string(root().join("docs/traceability.md")).expect("the page is there");
    let mut page =
        Page { lines: Vec::new(), beyond: Vec::new(), differences: Vec::new(), mailboxes: Vec::new() };
    let mut heading = "";
    for line in text.lines() {
        if let Some(title) = line.strip_prefix("## ") {
            heading = title;
        }
        let Some(cells) = cells(line) else { continue };
        match (heading, cells.as_slice()) {
            (_, [first, ..]) if first == "name" || first == "why" || first == "mailbox" => {}
            ("Beyond the manual", [why, codes]) => {
                page.beyond.extend(items(codes).map(|code| (code, why.clone())));
            }
            ("Differences", [name, section, manual, here]) => {
                page.differences.push([name, section, manual, here].map(Clone::clone));
            }
            ("Mailboxes", [mailbox, section, test]) => {
                page.mailboxes.push([mailbox, section, test].map(Clone::clone));
            }
            (_, [names, section, codes, test]) => {
                let kind = match heading {
                    "Commands" => "commands",
                    "Interface variables" => "variables",
                    "Status values" => "statuses",
                    _ => panic!("{line} is under {heading}"),
                };
                let names: Vec<String> = items(names).collect();
                let codes: Vec<Option<String>> =
                    if codes == "—" { vec![None; names.len()] } else { items(codes).map(Some).collect() };
                assert_eq!(names.len(), codes.len(), "{line}");
                page.lines.extend(names.into_iter().zip(codes).map(|(name, code)| Line {
                    kind,
                    name,
                    section: section.clone(),
                    code,
                    test: test.clone(),
                }));
            }
            _ => panic!("a line with {} cells: {line}", cells.len()),
        }
    }
    page
}

#[derive(Default)]
struct Interfaces {
    enums: BTreeMap<&'static str, &'static EnumSchema>,
    unions: BTreeMap<&'static str, &'static UnionSchema>,
    records: BTreeMap<&'static str, &'static StructSchema>,
}

impl Interfaces {
    fn new() -> Self {
        let mut all = Self::default();
        for schema in [CommonMemory::SCHEMA, ExternalInputs::SCHEMA, TaskVerb::SCHEMA] {
            all.add(&schema);
        }
        all
    }

    fn add(&mut self, schema: &Schema) {
        match schema {
            Schema::Enum(of) => {
                self.enums.insert(of.name, of);
            }
            Schema::Union(of) => {
                self.unions.insert(of.name, of);
                of.variants.iter().filter_map(|variant| variant.payload.as_ref()).for_each(|of| self.add(of));
            }
            Schema::Array(of, _) | Schema::Option(of) => self.add(of),
            Schema::Struct(of) => {
                self.records.insert(of.name, of);
                of.fields.iter().for_each(|field| self.add(&field.schema));
            }
            _ => {}
        }
    }

    fn variant(&self, code: &str) -> &'static VariantSchema {
        let (name, variant) = code.split_once("::").expect("a variant");
        self.enums[name].named(variant).expect("it is in the code")
    }

    /// `Type::Variant` and `Record.field` of the interfaces. A variant with data is named by its text.
    fn everything(&self) -> BTreeSet<String> {
        let mut all = BTreeSet::new();
        for (name, of) in &self.enums {
            all.extend(of.variants.iter().map(|variant| format!("{name}::{}", variant.name)));
        }
        for (name, of) in &self.unions {
            all.extend(of.variants.iter().map(|variant| format!("{name}::{}", variant.text)));
        }
        for (name, of) in &self.records {
            all.extend(of.fields.iter().map(|field| format!("{name}.{}", field.name)));
        }
        all
    }
}

#[test]
fn names_of_the_page_are_in_the_code() {
    let all = Interfaces::new().everything();
    let page = page();
    for line in &page.lines {
        if let Some(code) = &line.code {
            assert!(all.contains(code), "{} of {}: there is no {code}", line.name, line.section);
            assert_eq!(code.contains("::"), line.kind != "variables", "{code} among the {}", line.kind);
        }
    }
    for (code, why) in &page.beyond {
        let known = match code.strip_suffix('*') {
            Some(start) => all.iter().any(|other| other.starts_with(start)),
            None => all.contains(code),
        };
        assert!(known, "there is no {code}");
        assert!(!why.is_empty(), "{code} has a reason");
    }
}

#[test]
fn each_name_of_the_interfaces_is_on_the_page_once() {
    let page = page();
    let named: BTreeSet<&str> = page.lines.iter().filter_map(|line| line.code.as_deref()).collect();
    let beyond = |code: &str| {
        page.beyond.iter().any(|(other, _)| other == code || other.strip_suffix('*') == Some(start_of(code)))
    };
    let all = Interfaces::new().everything();
    let wrong: Vec<_> = all.iter().filter(|code| named.contains(code.as_str()) == beyond(code)).collect();
    assert!(wrong.is_empty(), "not in one of the tables, and in one only: {wrong:#?}");
    let unique: BTreeSet<_> =
        page.lines.iter().map(|line| (line.kind, &line.name, &line.section, &line.code)).collect();
    assert_eq!(unique.len(), page.lines.len(), "no line stands twice");
}

#[test]
fn every_listed_difference_names_an_entry_of_the_page() {
    let page = page();
    assert!(!page.differences.is_empty());
    for [name, section, manual, here] in &page.differences {
        let is_named = |line: &Line| (&line.name, &line.section) == (name, section) && line.code.is_some();
        assert!(page.lines.iter().any(is_named), "{name} of {section} is not among the names");
        assert!(!manual.is_empty() && !here.is_empty(), "{name} differs from something in something");
    }
}

/// A code without its last word: `Type::` or `Record.`.
fn start_of(code: &str) -> &str {
    let end = code.rfind([':', '.']).map_or(0, |at| at + 1);
    &code[..end]
}

#[test]
fn commands_and_statuses_have_the_names_of_the_code() {
    let (interfaces, page) = (Interfaces::new(), page());
    let matches = |line: &Line, code: &str| {
        let variant = interfaces.variant(code);
        // Tool-Grip has the words of V-Grip (VI.5).
        let bare = ["VGRIP-", "TGRIP-", "VG-", "TG-", "vgrip-", "tgrip-"]
            .iter()
            .find_map(|prefix| line.name.strip_prefix(prefix))
            .filter(|_| code.starts_with("Jaws"))
            .unwrap_or(&line.name);
        let text = variant.text.strip_prefix("vgrip-").unwrap_or(variant.text);
        bare.eq_ignore_ascii_case(text) || line.name == variant.code.to_string()
    };
    for line in page.lines.iter().filter(|line| line.kind != "variables") {
        let code = line.code.as_deref().expect("no command and no status is left out");
        let spelled = page
            .lines
            .iter()
            .filter(|other| other.section == line.section && other.code.as_deref() == Some(code))
            .any(|other| matches(other, code));
        assert!(spelled, "{} of {} is not what {code} says", line.name, line.section);
    }
}

#[test]
fn the_mailboxes_are_those_of_the_neighbours() {
    let of = |role: &Role| role.to_controller().iter().chain(role.from_controller());
    let all: BTreeSet<_> = Role::ALL.iter().flat_map(of).map(|place| place.name.to_owned()).collect();
    let page = page();
    let named: BTreeSet<_> = page.mailboxes.iter().map(|[name, ..]| name.clone()).collect();
    assert_eq!(named, all);
    let in_table = |name: &str| TABLE.iter().any(|place| place.name == name);
    for [name, section, _] in &page.mailboxes {
        assert_eq!(section.starts_with("IX, Table IX.1"), in_table(name), "{name}: {section}");
    }
}

#[test]
fn tests_named_by_the_page_exist() {
    let sources = Sources::read();
    let is_test = |name: &str| sources.files().any(|(_, text)| sources::has_test(text, name));
    let page = page();
    for [name, .., test] in page.mailboxes {
        assert!(is_test(&test), "{name}: no test {test}");
    }
    for line in page.lines {
        match line.code {
            Some(_) => {
                assert!(is_test(&line.test), "{} of {}: no test {}", line.name, line.section, line.test)
            }
            None => {
                assert!(line.test.contains(' '), "{} of {} is left out for a reason", line.name, line.section)
            }
        }
    }
}

#[test]
fn lines_and_sections_are_complete() {
    let page = page();
    let count = |kind: &str| page.lines.iter().filter(|line| line.kind == kind).count();
    assert_eq!(["commands", "variables", "statuses"].map(count), [85, 137, 53], "the manual's names");
    for line in &page.lines {
        let chapters = ["V.", "VI.", "IX.2"];
        assert!(chapters.iter().any(|c| line.section.starts_with(c)), "{}: {}", line.name, line.section);
    }
}

/// Remedies of many reasons, and their words in the table of docs/reasons.md.
const SHORT: [(&str, &str); 2] = [
    ("*data*", "correct the command in the job, or correct the task data and load them"),
    ("*job*", "send the right command, then `job skip`; correct the job"),
];

#[test]
fn every_reason_is_on_its_page() {
    let mut rows = String::new();
    for reason in Reason::ALL.iter().filter(|reason| **reason != Reason::None) {
        let remedy = reason.remedy().unwrap_or("");
        let remedy = SHORT.iter().find(|(_, long)| *long == remedy).map_or(remedy, |(short, _)| *short);
        let row = format!("| {} | {} | {remedy} |", reason.code(), reason.text());
        writeln!(rows, "{}", row.replace("  ", " ")).expect("a string has room");
    }
    let page = fs::read_to_string(root().join("docs/reasons.md")).expect("the page is there");
    for (short, long) in SHORT {
        assert!(page.contains(&format!("\n- {short}: {long}\n")), "docs/reasons.md explains {short}");
    }
    let found = page.split_once("|---|---|---|\n").expect("it has a table").1;
    assert!(found == rows, "docs/reasons.md must have these rows:\n{rows}");
}
