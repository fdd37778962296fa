//! Groups of devices: mapped whole, or fixed, absent or simulated.

use std::collections::BTreeSet;

use diagnostics::{
    Problems,
    toml::{Defaulted, join},
};
use interfaces::point::{Group, Input, Kind, Output, Point, Station};

use super::{
    super::{Holds, Presence, form::Sheet},
    says, unlike,
};

const HOLDERS: [Group; 6] = [Group::Grip, Group::V, Group::Tool, Group::Pedestal, Group::Vise, Group::Drum];
/// Words for groups without points.
const WITHOUT: [Presence; 2] = [Presence::Absent, Presence::Simulated];

/// How each group is present, in the order of [`Group::ALL`].
pub(super) fn presence(
    sheet: &Sheet,
    stand_ins: &Defaulted,
    problems: &mut Problems,
) -> [Presence; Group::ALL.len()] {
    let known = Group::ALL.map(Group::name);
    for name in sheet.groups.keys().filter(|name| Group::named(name).is_none()) {
        let path = join("groups", name);
        let expected = format!("one of {}", known.join(", "));
        problems.add(unlike(&path, expected, format_args!("{name:?}")).near(name, &known));
    }
    Group::ALL.map(|group| {
        let points = Points::of(sheet, group);
        let path = join("groups", group.name());
        let said = sheet.groups.get(group.name()).filter(|_| stand_ins.trusts(&path));
        match said {
            Some(word) if !points.is_empty() => {
                let message = format!(
                    "is {word}, and the file has points of it, such as {}: leave one of them out",
                    points.first()
                );
                problems.add(says(&path, message));
                Presence::Mapped
            }
            Some(word) => WITHOUT.into_iter().find(|one| one.name() == word).unwrap_or_else(|| {
                let expected = "\"absent\" or \"simulated\"; a group with points is mapped";
                problems.add(unlike(&path, expected, format_args!("{word:?}")));
                Presence::Simulated
            }),
            None if points.is_empty() => Presence::Simulated,
            None => {
                let missing = points.missing(group);
                if !missing.is_empty() {
                    let message = format!(
                        "{} is mapped in part: {} missing; give an input that is not there `fixed`",
                        group.name(),
                        list(&missing)
                    );
                    let first = join(points.table(), points.first());
                    problems.add(says(&first, message));
                }
                points.presence()
            }
        }
    })
}

/// What keeps a part gripped while the outputs of a group are off, as the file says.
pub(super) fn holds(sheet: &Sheet, stand_ins: &Defaulted, problems: &mut Problems) -> Vec<(Group, Holds)> {
    let groups = HOLDERS.map(Group::name);
    let words = Holds::ALL.map(Holds::name);
    let mut all = Vec::new();
    for (name, word) in &sheet.holds {
        let path = join("holds", name);
        if !stand_ins.trusts(&path) {
            continue;
        }
        let group = HOLDERS.into_iter().find(|group| group.name() == name);
        let holds = Holds::ALL.into_iter().find(|holds| holds.name() == word);
        match (group, holds) {
            (None, _) => {
                let expected = format!("one of {}", groups.join(", "));
                problems.add(unlike(&path, expected, format_args!("{name:?}")).near(name, &groups));
            }
            (Some(_), None) => {
                let expected = format!("one of {}", words.join(", "));
                problems.add(unlike(&path, expected, format_args!("{word:?}")).near(word, &words));
            }
            (Some(Group::Vise | Group::Drum), Some(Holds::Nothing | Holds::TrappedAir)) => {
                let expected =
                    "bistable, check-valve or spring: a part must stay clamped when its output is off";
                problems.add(unlike(&path, expected, format_args!("{word:?}")));
            }
            (Some(group), Some(holds)) => all.push((group, holds)),
        }
    }
    all
}

/// The names of the file's points of a group.
struct Points<'s> {
    inputs: BTreeSet<&'s str>,
    outputs: BTreeSet<&'s str>,
    fixed: usize,
}

impl<'s> Points<'s> {
    fn of(sheet: &'s Sheet, group: Group) -> Self {
        let is_of = |point: Option<Point<'_>>| point.is_some_and(|point| point.group() == group);
        let inputs: BTreeSet<&str> =
            sheet.inputs.keys().map(String::as_str).filter(|name| is_of(Point::read(name))).collect();
        let outputs = sheet.outputs.keys().map(String::as_str).filter(|name| is_of(Point::written(name)));
        let fixed =
            inputs.iter().filter(|name| sheet.inputs.get(**name).is_some_and(|form| form.fixed.is_some()));
        let fixed = fixed.count();
        Self { outputs: outputs.collect(), fixed, inputs }
    }

    fn is_empty(&self) -> bool {
        self.inputs.is_empty() && self.outputs.is_empty()
    }

    fn first(&self) -> &'s str {
        self.inputs.iter().chain(&self.outputs).next().copied().unwrap_or_default()
    }

    fn table(&self) -> &'static str {
        if self.inputs.is_empty() { "out" } else { "in" }
    }

    fn presence(&self) -> Presence {
        if self.outputs.is_empty() && self.fixed == self.inputs.len() {
            Presence::Fixed
        } else {
            Presence::Mapped
        }
    }

    /// The required points that the file lacks. A fixed group needs no outputs.
    fn missing(&self, group: Group) -> Vec<String> {
        let is_fixed = self.presence() == Presence::Fixed;
        let read = Input::all().filter(|input| !matches!(input.kind(), Kind::Cable | Kind::Camera));
        let read = read.filter(|input| input.group() == group).map(|input| input.name().to_owned());
        let written =
            Output::all().filter(|output| output.group() == group).map(|output| output.name().to_owned());
        let places: BTreeSet<&str> = self
            .inputs
            .iter()
            .filter_map(|name| Station::read(name))
            .chain(self.outputs.iter().filter_map(|name| Station::written(name)))
            .map(|station| station.place)
            .collect();
        let stations = |written| {
            let names = places.iter().flat_map(move |place| {
                Station::needed(group, written).map(move |(before, after)| format!("{before}{place}{after}"))
            });
            names.collect::<BTreeSet<_>>()
        };
        let read = read.chain(stations(false)).filter(|name| !self.inputs.contains(name.as_str()));
        let written = written.chain(stations(true));
        let written = written.filter(|name| !is_fixed && !self.outputs.contains(name.as_str()));
        read.chain(written).collect()
    }
}

/// A list of names, shortened if it is long.
fn list(names: &[String]) -> String {
    const SHOWN: usize = 4;
    let shown: Vec<&str> = names.iter().take(SHOWN).map(String::as_str).collect();
    let more = names.len().saturating_sub(SHOWN);
    let verb = if names.len() == 1 { "is" } else { "are" };
    match more {
        0 => format!("{} {verb}", shown.join(", ")),
        _ => format!("{} and {more} more {verb}", shown.join(", ")),
    }
}
