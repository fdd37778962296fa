//! Preconditions of a command: the fields that its verb uses, the grips of its object, the data for a regrip on the
//! Active Pedestal, a tool in the gripper (V.4.1, V.3.1 FIX-GRIP). Task and Subtask would refuse the command for the
//! same reasons, but only when the job reaches it.

use diagnostics::{At, Problems};
use rcs_core::name::{Name10, Name16};

use super::fields::{Field, Number};
use crate::files::{ArrayId, Direction, LocptId, OwnerId, RefType, Reference, TaskData};

/// Location at which the Active Pedestal grips an object (V.3.1 FIX-GRIP).
const PEDESTAL: &str = "PEDESTAL";
/// Location near the tool drum (V.4.1 ACQUIRE-TOOL).
const NEAR_DRUM: &str = "TOOL-SAFE";
/// Location where tools are passed to the drum.
const DRUM: &str = "TOOL-TRNS";
/// `endeff-id#` of the tool gripper (VII.7.2).
const TOOL_GRIPPER: i32 = 3;

/// A location of a command with its sector, and the grip there.
#[derive(Clone, Copy)]
pub(super) struct Endpoint {
    pub(super) name: Field,
    pub(super) sector: Number,
    pub(super) grip: Option<Number>,
}

/// The fields of a command that are checked together. Unknown names have been reported before.
#[derive(Clone, Copy)]
pub(super) struct Command<'v> {
    pub(super) verb: &'v str,
    pub(super) at: At,
    pub(super) object: Field,
    pub(super) source: Endpoint,
    pub(super) destination: Endpoint,
    pub(super) end_at: Endpoint,
}

/// The object that the robot holds between two commands, if there was no error.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
pub(super) enum Held {
    #[default]
    Nothing,
    Object(Name16),
    /// Not known, after actions of the operator or a failed command.
    Unknown,
}

impl Command<'_> {
    fn is(&self, verbs: &[&str]) -> bool {
        verbs.contains(&self.verb)
    }

    fn is_for_tools(&self) -> bool {
        self.is(&["INSERT-TOOL", "RELEASE-TOOL", "ACQUIRE-TOOL", "REMOVE-TOOL"])
    }

    fn carries(&self) -> bool {
        self.is(&["TRANSFER", "REFIXTURE"]) || self.verb == "MOVE" && self.object.given()
    }

    /// The locations at which the verb uses a grip.
    fn gripped(&self) -> Vec<&Endpoint> {
        match self.verb {
            "POSITION" if self.source.name.given() => vec![&self.source],
            "POSITION" => vec![&self.destination],
            "ACQUIRE" => vec![&self.source],
            _ if self.carries() => vec![&self.source, &self.destination],
            _ => Vec::new(),
        }
    }

    /// Report what is missing; returns the held object after the command.
    pub(super) fn check(&self, data: &TaskData<'_>, held: Held, problems: &mut Problems) -> Held {
        let mut needs = Needs { command: self, data, problems };
        needs.fields();
        needs.sectors();
        needs.grips();
        needs.regrip();
        needs.tool(held);
        let object = Held::Object(self.object.name);
        match self.verb {
            "TRANSFER" | "POSITION" | "RELEASE-TOOL" => Held::Nothing,
            "ACQUIRE" | "REFIXTURE" | "ACQUIRE-TOOL" | "REMOVE-TOOL" => object,
            // That it was not held is reported.
            "INSERT-TOOL" if self.object.given() && held == Held::Nothing => object,
            "MOVE" if self.object.given() => object,
            _ => held,
        }
    }
}

struct Needs<'c, 'd> {
    command: &'c Command<'c>,
    data: &'c TaskData<'d>,
    problems: &'c mut Problems,
}

impl Needs<'_, '_> {
    fn error(&mut self, at: At, message: String, help: impl Into<String>) {
        self.problems.error_help("job.needs", at, message, help);
    }

    /// Check that the object and the locations that the verb needs are given.
    fn fields(&mut self) {
        let command = self.command;
        let verb = command.verb;
        let takes = command.is(&["TRANSFER", "REFIXTURE", "ACQUIRE"]);
        if (takes || verb == "ACQUIRE-TOOL") && !command.object.given() {
            self.error(command.object.at, format!("{verb} needs an object"), "name it in the first field");
        }
        let (from, to) = (command.source.name, command.destination.name);
        if (takes || command.carries()) && !from.given() {
            let help = "name the location where the object is in the third field";
            self.error(from.at, format!("{verb} needs a source location"), help);
        }
        if (command.carries() || command.is(&["MOVE", "ACQUIRE-TOOL"])) && !to.given() {
            let help = "name the location in the sixth field";
            self.error(to.at, format!("{verb} needs a destination location"), help);
        }
        if verb == "POSITION" && !from.given() && !to.given() {
            self.error(from.at, "POSITION needs a location".to_owned(), "name it in the third field");
        }
        if verb == "ACQUIRE-TOOL" && to.given() && to.name.as_str() != NEAR_DRUM {
            let message = format!("ACQUIRE-TOOL goes to the drum from {NEAR_DRUM}, {} found", to.name);
            self.error(to.at, message, format!("write {NEAR_DRUM} as the destination"));
        }
    }

    /// Check that a location in a tray has a sector: the location point of a tray is only its corner (VIII.3).
    fn sectors(&mut self) {
        let command = self.command;
        let places = match command.verb {
            "PAUSE" | "STARTUP" | "SHUTDOWN" => return,
            "MOVE" | "REFIXTURE" => vec![command.source, command.destination],
            "ACQUIRE" => vec![command.source],
            _ => vec![command.source, command.destination, command.end_at],
        };
        for place in places.into_iter().filter(|place| place.name.given() && place.sector.value == 0) {
            let name = place.name.name;
            let owner = self.data.owner_named(&Name10::clipped(name.as_str()));
            let members = owner.map_or(&[][..], |owner| self.data.members_of(owner));
            if !members.iter().any(|member| member.member.kind == RefType::Array) {
                continue;
            }
            let object = self.data.object_named(&command.object.name);
            let assigned = object.into_iter().flat_map(|object| self.data.object_locations(object));
            let here =
                assigned.filter(|assigned| members.iter().any(|member| member.member == *assigned)).last();
            let array = here.and_then(|here| self.data.array(ArrayId::new(here.number)));
            let help = match (here.map(|here| here.kind), array) {
                // The object location form assigns the object to the location point itself.
                (Some(RefType::LocationPoint), _) => continue,
                (_, Some(array)) => {
                    format!("{name} has sectors 1 to {} for {}", array.sectors(), command.object.name)
                }
                (_, None) => "name a location point beside the tray".to_owned(),
            };
            self.error(place.sector.at, format!("{name} is a tray and needs a sector, 0 found"), help);
        }
    }

    /// Check that a grip is given: +0 is not a grip.
    fn grips(&mut self) {
        let command = self.command;
        let null = |place: &&Endpoint| command.object.given() && place.name.given() && place.grip.is_some();
        for place in command.gripped().into_iter().filter(null) {
            let Some(grip) = place.grip.filter(|grip| grip.value == 0) else { continue };
            let name = command.object.name;
            let message = format!("{} needs a grip of {name} at {}, +0 found", command.verb, place.name.name);
            let help = grips_of(self.data, &name);
            self.error(grip.at, message, help);
        }
    }

    /// Check the data for a regrip on the Active Pedestal, which different grips need.
    fn regrip(&mut self) {
        let command = self.command;
        let (Some(from), Some(to)) = (command.source.grip, command.destination.grip) else { return };
        if !command.carries() || !command.object.given() {
            return;
        }
        if from.value == to.value {
            if command.verb == "REFIXTURE" {
                let message = format!("REFIXTURE changes the grip, {:+} found twice", from.value);
                self.error(to.at, message, "write another grip at the destination, or MOVE");
            }
            return;
        }
        let (object, data) = (command.object.name, self.data);
        // A grip that no object form has is reported already, and so is +0.
        if [from, to].iter().any(|grip| data.object(&object, grip.value).is_none()) {
            return;
        }
        let what = format!("from grip {:+} to {:+} {object} goes over the pedestal", from.value, to.value);
        match data.ped_para(&object) {
            None => {
                let help =
                    "add a pedestal form, >FILE PED-PARA (VII.7.4), or use one grip for both locations";
                self.error(to.at, format!("{what}, and has no PED-PARA record"), help);
            }
            Some((_, record)) if record.flip_angle == 0 => {
                let help = "give the angle that turns the object from one grip to the other (VII.7.4)";
                self.error(to.at, format!("{what}, and its ped-flip-angle is 0"), help);
            }
            Some(_) => {}
        }
        let Ok(pedestal) = data.resolve_location(&Name16::clipped(PEDESTAL), None, Some(&object)) else {
            let help = "add it to a location point form (VII.3)";
            self.error(to.at, format!("{what}, and there is no location {PEDESTAL}"), help);
            return;
        };
        for grip in [from, to] {
            let number = grip.value;
            let entries = [
                ("-grip-", "movetable for", data.grip_movetable(&object, number, &pedestal.place).is_some()),
                ("-appr obj", "approach with", data.approach(&object, number, &pedestal.place).is_some()),
                ("-dept obj", "depart with", data.depart(&object, number, &pedestal.place).is_some()),
            ];
            for (word, what_is, _) in entries.into_iter().filter(|(_, _, there)| !there) {
                let message = format!("{what}, and has no {what_is} grip {number:+} at {PEDESTAL}");
                let help = format!("add `{word} {object} {number} lpt {PEDESTAL}`");
                self.error(grip.at, message, help);
            }
        }
    }

    /// Check that a tool command handles a tool, and that the gripper holds this tool, or nothing before ACQUIRE-TOOL.
    fn tool(&mut self, held: Held) {
        let command = self.command;
        if !command.is_for_tools() {
            return;
        }
        let (verb, object) = (command.verb, command.object);
        if object.given() {
            let id = self.data.obj_grips(&object.name).map_or(0, |grips| grips.endeff_id);
            if id != TOOL_GRIPPER {
                let message = format!("{verb} handles tools; endeff-id# of {} is {id}", object.name);
                self.error(object.at, message, format!("tools have {TOOL_GRIPPER} in OBJ-GRIPS (VII.7.2)"));
                return;
            }
            let grips = [command.source.grip, command.destination.grip];
            let known = |grip: &Number| self.data.object(&object.name, grip.value).is_some();
            if !grips.iter().flatten().any(known) {
                let help = grips_of(self.data, &object.name);
                self.error(object.at, format!("{verb} needs a grip of {}", object.name), help);
            }
        }
        self.moves();
        let (found, first) = match held {
            Held::Unknown => return,
            Held::Object(tool) if !object.given() || tool == object.name => return,
            Held::Object(other) => (format!("{other} is"), other),
            Held::Nothing => ("nothing is".to_owned(), object.name),
        };
        let before = match verb {
            "INSERT-TOOL" => "a MOVE of the tool to TOOL-SAFE",
            "RELEASE-TOOL" => "an INSERT-TOOL",
            "REMOVE-TOOL" => "an ACQUIRE-TOOL",
            _ if first == object.name => return,
            _ => "a command that lets it go",
        };
        let what = if verb == "ACQUIRE-TOOL" { "an empty gripper" } else { "a tool in the gripper" };
        let message = format!("{verb} needs {what}; {found} held here");
        self.error(command.at, message, format!("{before} comes before it"));
    }

    /// Check that the relative moves at the drum that the verb makes exist (V.2.1).
    fn moves(&mut self) {
        let command = self.command;
        let names: &[&str] = match command.verb {
            "INSERT-TOOL" => &["INS-FAR", "INS-NEAR", "INS-IN"],
            "RELEASE-TOOL" => &["REL-SLIDE", "REL-BACK"],
            "ACQUIRE-TOOL" => &["ACQ-NEAR", "ACQ-STRIKE", "ACQ-SLIDE"],
            _ => &["REM-OUT"],
        };
        let drum = self.data.place_named::<10, 16>(&Name10::clipped(DRUM), None);
        let known = |name: &str| {
            drum.is_some_and(|drum| self.data.relative_move(&Name10::clipped(name), &drum).is_some())
        };
        if let Some(name) = names.iter().find(|name| !known(name)) {
            let message =
                format!("{} makes the relative move {name} at {DRUM}, and there is none", command.verb);
            self.error(command.at, message, format!("add `-rel- {name} lpt {DRUM}`, see data/guarded.blk"));
        }
    }
}

/// Help text: the grips of an object.
pub(super) fn grips_of(data: &TaskData<'_>, object: &Name16) -> String {
    let id = data.object_named(object);
    let grips: Vec<String> =
        data.end_effs.iter().filter(|e| Some(e.object) == id).map(|e| format!("{:+}", e.grip)).collect();
    match &grips[..] {
        [] => format!("no object form (-obj-, VII.7.1) has {object}"),
        [one] => format!("{object} has grip {one}"),
        several => format!("{object} has grips {}", several.join(", ")),
    }
}

/// Help text: the locations at which a grip of an object has a movetable.
pub(super) fn places_of(data: &TaskData<'_>, object: &Name16, grip: i32) -> String {
    let id = data.object_named(object);
    let entries = data.grip_locs.iter().filter(|entry| Some(entry.object) == id && entry.grip == grip);
    let places: Vec<String> = entries.map(|entry| named(data, entry.at)).collect();
    if places.is_empty() {
        format!("no grip form (-grip-, VII.7.5) has grip {grip:+} of {object}")
    } else {
        format!("grip {grip:+} of {object} is for {}", places.join(", "))
    }
}

/// Help text: the locations at which an object, or its view, can be approached with a grip.
pub(super) fn approaches_of(data: &TaskData<'_>, kind: RefType, object: &Name16, grip: i32) -> String {
    let id = data.object_named(object).map(|id| id.number());
    let of_it = data.appr_depts.iter().filter(|entry| {
        let subject = entry.subject;
        entry.direction == Direction::Approach
            && (subject.kind, Some(subject.number), entry.grip) == (kind, id, grip)
    });
    let places: Vec<String> = of_it.map(|entry| named(data, entry.at)).collect();
    if places.is_empty() {
        "there is none".to_owned()
    } else {
        format!("there are those for {}", places.join(", "))
    }
}

/// Help text: the arrays and location points to which an object is assigned.
pub(super) fn assigned_to(data: &TaskData<'_>, object: &Name16) -> String {
    let id = data.object_named(object);
    let assigned = id.into_iter().flat_map(|id| data.object_locations(id));
    let places: Vec<String> = assigned.map(|at| named(data, at)).collect();
    if places.is_empty() {
        format!("no object location form (-o-loc-, VII.7.3) has {object}")
    } else {
        format!("{object} is assigned to {}", places.join(", "))
    }
}

/// The name of a location at which an entry applies.
fn named(data: &TaskData<'_>, at: Reference) -> String {
    let name = match at.kind {
        RefType::LocationPoint => data.locpt(LocptId::new(at.number)).map(|point| point.name),
        RefType::Array => data.array(ArrayId::new(at.number)).map(|array| array.name),
        RefType::Owner => data.owner(OwnerId::new(at.number)).map(|owner| owner.name),
        _ => None,
    };
    name.map_or_else(|| at.kind.text().to_owned(), |name| name.to_string())
}
