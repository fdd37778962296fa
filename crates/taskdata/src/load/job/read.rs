use diagnostics::{At, Problems, Severity, nearest};
use interfaces::hws::{Checked, HwsCommand};
use rcs_core::name::Name16;

use crate::files::{Location, TaskData};

use super::{
    super::{
        Part,
        lex::words_of_line,
        parser::is_integer,
        source::SourceLine,
        verdict::{self, Before, Finding, LookupProblem, Verdict, find_location, find_object},
    },
    JobLine, Step, Workstation,
    fields::{Field, Fields, Number},
};

pub(super) struct Reader<'s, 'p> {
    data: TaskData<'s>,
    part: Option<&'s Part>, // the readable part of data with errors; the rest may have a missing name
    reloads: std::vec::IntoIter<TaskData<'s>>, // after each line that loads blocks
    loaded: u32,
    pub(super) problems: &'p mut Problems,
    before: Before,               // the known state of the robot
    pub(super) after: Option<At>, // the last line with `after`, if no command has followed
}

impl<'s, 'p> Reader<'s, 'p> {
    pub(super) fn new(data: TaskData<'s>, reloads: Vec<TaskData<'s>>, problems: &'p mut Problems) -> Self {
        let before = Before::default();
        Self { data, part: None, reloads: reloads.into_iter(), loaded: 0, problems, before, after: None }
    }

    /// Reports only errors that the unread data cannot explain; `part` is the readable part.
    pub(super) fn among(self, part: &'s Part) -> Self {
        Self { part: Some(part), ..self }
    }

    /// Discards position and held object, which are unknown after a motion without a command.
    pub(super) fn forget(&mut self) {
        self.before = Before::unknown();
    }

    /// Later names are looked up in the new data. Returns the number of the reload, from 1; `None` without new data.
    pub(super) fn reload(&mut self) -> Option<u32> {
        self.data = self.reloads.next()?;
        self.loaded += 1;
        Some(self.loaded)
    }
}

impl Reader<'_, '_> {
    pub(super) fn end(&mut self) {
        if let Some(at) = self.after {
            self.problems.error_help(
                "job.after",
                at,
                "no command follows this line",
                "after counts its ticks from the next line with ==; ** wait waits by itself",
            );
        }
    }

    /// `None` for a line without a step, or an unreadable one, which is reported.
    pub(super) fn line(&mut self, number: u32, line: &SourceLine<'_>) -> Option<JobLine> {
        let words = words_of_line(line);
        let first = words.first()?;
        let mut fields = Fields { words: &words, next: 1 };
        let step = match first.text {
            "==" => self.command(&mut fields).map(Step::Command),
            "**" => self.workstation(&mut fields),
            _ => {
                self.problems.error_help(
                    "job.line",
                    first.at,
                    format!("a line begins with == or **, {} found", first.text),
                    "== sends a command to Task, ** says what the workstation does, % begins a comment",
                );
                None
            }
        }?;
        let can_fail = matches!(
            step,
            Step::Command(_)
                | Step::Workstation(Workstation::Load { .. })
                | Step::After { action: Workstation::Load { .. }, .. }
        );
        let expects_error = can_fail && self.expects_error(&mut fields)?;
        self.end_of_line(&mut fields)?;
        let end = words.last().map_or(0, |w| w.at.start.saturating_add(w.at.length));
        let length = usize::try_from(end.saturating_sub(line.at.start)).unwrap_or(0);
        let text = line.text.get(..length).unwrap_or(line.text);
        Some(JobLine { step, text: text.trim().to_owned(), line: number, expects_error })
    }

    /// True for `expect error`; `None` if another word follows `expect`, which is reported.
    fn expects_error(&mut self, fields: &mut Fields<'_, '_>) -> Option<bool> {
        if fields.take_if("expect").is_none() {
            return Some(false);
        }
        if fields.take_if("error").is_some() {
            return Some(true);
        }
        let help = "a command that has to fail ends with `expect error`; without it a command has to finish";
        self.problems.error_help("job.fields", fields.at(), "error was expected after expect", help);
        None
    }

    /// `None` if a word is left, which is reported.
    pub(super) fn end_of_line(&mut self, fields: &mut Fields<'_, '_>) -> Option<()> {
        let Some(extra) = fields.take() else { return Some(()) };
        self.problems.error("job.fields", extra.at, format!("the line should end before {}", extra.text));
        None
    }

    pub(super) fn missing(&mut self, what: &str, at: At) {
        self.problems.error("job.fields", at, format!("{what} was expected, the line ends"));
    }

    pub(super) fn field(&mut self, fields: &mut Fields<'_, '_>, what: &str) -> Option<Field> {
        let at = fields.at();
        let Some(word) = fields.take() else {
            self.missing(what, at);
            return None;
        };
        if word.text == "--" {
            return Some(Field { name: Name16::EMPTY, at: word.at });
        }
        if is_integer(word.text) {
            let help = "a command has nine fields: object, grip, location, sector, grip, location, sector, end-at, sector; -- is null";
            self.problems.error_help(
                "job.fields",
                word.at,
                format!("{what} or -- was expected, {} found", word.text),
                help,
            );
            return None;
        }
        match Name16::new(word.text) {
            Ok(name) => Some(Field { name, at: word.at }),
            Err(error) => {
                self.problems.error("name.length", word.at, format!("{what}: {error}"));
                None
            }
        }
    }

    fn integer(&mut self, fields: &mut Fields<'_, '_>, what: &str) -> Option<Number> {
        self.number(fields, what, NINE_FIELDS)
    }

    pub(super) fn number(&mut self, fields: &mut Fields<'_, '_>, what: &str, help: &str) -> Option<Number> {
        let at = fields.at();
        let Some(word) = fields.take() else {
            self.missing(what, at);
            return None;
        };
        let value = word.text.parse::<i32>().ok().filter(|v| v.abs() <= MOST);
        if value.is_none() {
            let message = format!("{what}, a whole number, was expected; {} found", word.text);
            self.problems.error_help("job.fields", word.at, message, help);
        }
        value.map(|value| Number { value, at: word.at })
    }

    fn command(&mut self, fields: &mut Fields<'_, '_>) -> Option<HwsCommand> {
        self.after = None;
        let verb = self.field(fields, "a command")?;
        let object = self.field(fields, "object")?;
        let source_grip = self.integer(fields, "source grip")?;
        let source = self.field(fields, "source location")?;
        let source_sector = self.integer(fields, "source sector")?;
        let destination_grip = self.integer(fields, "destination grip")?;
        let destination = self.field(fields, "destination location")?;
        let destination_sector = self.integer(fields, "destination sector")?;
        let end_at = self.field(fields, "end-at location")?;
        let end_at_sector = self.integer(fields, "end-at sector")?;
        let serial = self.serial(fields);
        let command = HwsCommand {
            number: 0,
            command: verb.name,
            object: object.named(),
            serial,
            source_grip: source_grip.value,
            source: source.named(),
            source_sector: source_sector.given(),
            destination_grip: destination_grip.value,
            destination: destination.named(),
            destination_sector: destination_sector.given(),
            end_at: end_at.named(),
            end_at_sector: end_at_sector.given(),
            checked: Checked::Passes,
        };
        let fails = fields.words.get(fields.next).is_some_and(|word| word.text == "expect");
        let findings = self.judge(&command, fails);
        for finding in findings {
            let at = match finding.field {
                verdict::Field::Command => verb.at,
                verdict::Field::Object => object.at,
                verdict::Field::SourceGrip => source_grip.at,
                verdict::Field::Source => source.at,
                verdict::Field::SourceSector => source_sector.at,
                verdict::Field::DestinationGrip => destination_grip.at,
                verdict::Field::Destination => destination.at,
                verdict::Field::DestinationSector => destination_sector.at,
                verdict::Field::EndAt => end_at.at,
                verdict::Field::EndAtSector => end_at_sector.at,
            };
            self.problems.push(Severity::Error, finding.code, at, finding.message, finding.help);
        }
        Some(command)
    }

    /// Data with errors only show which names are probably misspelt.
    fn judge(&mut self, command: &HwsCommand, fails: bool) -> Vec<Finding> {
        if let Some(part) = self.part {
            let mut findings = verdict::names_of(command, &self.data);
            findings.retain(|finding| {
                let unknown = finding.unknown.as_ref();
                unknown.is_none_or(|(name, near)| part.is_slip(name.as_str(), near.as_deref()))
            });
            return findings;
        }
        let judge = if fails { Verdict::of_failing } else { Verdict::of };
        let Verdict { findings, after } = judge(command, &self.data, self.before);
        self.before = after;
        findings
    }

    /// The serial number, `#17`, if the line has one after its nine fields. Reports another word.
    fn serial(&mut self, fields: &mut Fields<'_, '_>) -> Name16 {
        let word = fields.words.get(fields.next).filter(|word| word.text != "expect");
        let Some(word) = word.and_then(|_| fields.take()) else { return Name16::EMPTY };
        let Some(number) = word.text.strip_prefix('#').filter(|number| !number.is_empty()) else {
            let message = format!("the line should end before {}", word.text);
            let help = "behind the nine fields only a serial number can stand, # and 1 to 16 characters, as in #17, and `expect error`";
            self.problems.error_help("job.fields", word.at, message, help);
            return Name16::EMPTY;
        };
        Name16::new(number).unwrap_or_else(|error| {
            self.problems.error("name.length", word.at, format!("serial number: {error}"));
            Name16::EMPTY
        })
    }

    pub(super) fn unknown(&mut self, what: &str, name: &str, at: At, known: &[&str]) {
        let near = nearest(name, known.iter().copied());
        let help =
            near.map_or_else(|| format!("there are {}", known.join(", ")), |n| format!("the nearest is {n}"));
        self.problems.error_help("name.unknown", at, format!("no {what} is named {name}"), help);
    }

    pub(super) fn object(&mut self, field: Field) -> bool {
        find_object(&self.data, &field.name).map_err(|unfound| self.unfound(unfound, field, field.at)).is_ok()
    }

    pub(super) fn plain_place(&mut self, field: Field) -> Option<Location> {
        self.place(field, Number { value: 0, at: field.at }, None)
    }

    pub(super) fn place(&mut self, field: Field, sector: Number, object: Option<Name16>) -> Option<Location> {
        if !field.given() {
            if sector.value != 0 {
                let message = format!("sector {} of no location", sector.value);
                self.problems.error("job.sector", sector.at, message);
            }
            return None;
        }
        let found = find_location(&self.data, &field.name, sector.given(), object.as_ref());
        found.map_err(|unfound| self.unfound(unfound, field, sector.at)).ok()
    }

    /// Reports an unknown name, unless an unreadable entry may have it.
    fn unfound(&mut self, unfound: LookupProblem, field: Field, sector: At) {
        let LookupProblem { code, message, help, near, is_sector } = unfound;
        if self.part.is_none_or(|part| part.is_slip(field.name.as_str(), near.as_deref())) {
            let at = if is_sector { sector } else { field.at };
            self.problems.push(Severity::Error, code, at, message, help);
        }
    }
}

const NINE_FIELDS: &str = "a command has nine fields: object, grip, location, sector, grip, location, sector, end-at, sector; -- is null";

pub(super) const MOST: i32 = 36_000; // in a job line
