//! Preconditions of a command: fields, grips, data for a regrip on the Active Pedestal, a tool in the gripper (V.4.1,
//! V.3.1 FIX-GRIP). Task and Subtask would refuse it only when it is sent.

use interfaces::HwsCommand;
use rcs_core::name::{Name10, Name16};

use super::{Field, Finding, Held, finding};
use crate::files::{ArrayId, Direction, LocptId, OwnerId, RefType, Reference, TaskData};

const PEDESTAL: &str = "PEDESTAL"; // grips an object (V.3.1 FIX-GRIP)
const NEAR_DRUM: &str = "TOOL-SAFE"; // V.4.1 ACQUIRE-TOOL
pub(super) const DRUM: &str = "TOOL-TRNS"; // tools are passed to the drum
const TOOL_GRIPPER: i32 = 3; // `endeff-id#` (VII.7.2)

struct Place {
    name: Option<Name16>,
    sector: Option<i32>,
    grip: i32,
    sector_field: Field,
    grip_field: Field,
}

pub(super) struct Needs<'c, 'd> {
    pub command: &'c HwsCommand,
    pub verb: &'static str, // the full word
    pub data: &'c TaskData<'d>,
    pub findings: &'c mut Vec<Finding>,
}

impl Needs<'_, '_> {
    fn is(&self, verbs: &[&str]) -> bool {
        verbs.contains(&self.verb)
    }

    fn is_for_tools(&self) -> bool {
        self.is(&["INSERT-TOOL", "RELEASE-TOOL", "ACQUIRE-TOOL", "REMOVE-TOOL"])
    }

    fn carries(&self) -> bool {
        self.is(&["TRANSFER", "REFIXTURE"]) || self.verb == "MOVE" && self.command.object.is_some()
    }

    const fn source(&self) -> Place {
        let command = self.command;
        Place {
            name: command.source,
            sector: command.source_sector,
            grip: command.source_grip,
            sector_field: Field::SourceSector,
            grip_field: Field::SourceGrip,
        }
    }

    const fn destination(&self) -> Place {
        let command = self.command;
        Place {
            name: command.destination,
            sector: command.destination_sector,
            grip: command.destination_grip,
            sector_field: Field::DestinationSector,
            grip_field: Field::DestinationGrip,
        }
    }

    const fn end_at(&self) -> Place {
        let command = self.command;
        Place {
            name: command.end_at,
            sector: command.end_at_sector,
            grip: 0,
            sector_field: Field::EndAtSector,
            grip_field: Field::EndAt,
        }
    }

    fn gripped(&self) -> [Option<Place>; 2] {
        match self.verb {
            "POSITION" if self.command.source.is_some() => [Some(self.source()), None],
            "POSITION" => [Some(self.destination()), None],
            "ACQUIRE" => [Some(self.source()), None],
            _ if self.carries() => [Some(self.source()), Some(self.destination())],
            _ => [None, None],
        }
    }

    pub(super) fn check(&mut self, held: Held) -> Held {
        self.fields();
        self.sectors();
        self.grips();
        self.regrip();
        self.pedestal();
        self.tool(held);
        let object = self.command.object;
        let taken = Held::Object(object.unwrap_or_default());
        match self.verb {
            "TRANSFER" | "POSITION" | "RELEASE-TOOL" => Held::Nothing,
            "ACQUIRE" | "REFIXTURE" | "ACQUIRE-TOOL" | "REMOVE-TOOL" => taken,
            // It is already reported that the object was not held.
            "INSERT-TOOL" if object.is_some() && held == Held::Nothing => taken,
            "MOVE" if object.is_some() => taken,
            _ => held,
        }
    }

    fn error(&mut self, field: Field, message: String, help: impl Into<String>) {
        self.findings.push(finding(field, "job.needs", message, Some(help.into())));
    }

    fn fields(&mut self) {
        let (verb, command) = (self.verb, self.command);
        let takes = self.is(&["TRANSFER", "REFIXTURE", "ACQUIRE"]);
        if (takes || verb == "ACQUIRE-TOOL") && command.object.is_none() {
            self.error(Field::Object, format!("{verb} needs an object"), "name it in the first field");
        }
        let (from, to) = (command.source, command.destination);
        if (takes || self.carries()) && from.is_none() {
            let help = "name the location where the object is in the third field";
            self.error(Field::Source, format!("{verb} needs a source location"), help);
        }
        if (self.carries() || self.is(&["MOVE", "ACQUIRE-TOOL"])) && to.is_none() {
            let help = "name the location in the sixth field";
            self.error(Field::Destination, format!("{verb} needs a destination location"), help);
        }
        if verb == "POSITION" && from.is_none() && to.is_none() {
            self.error(Field::Source, "POSITION needs a location".to_owned(), "name it in the third field");
        }
        if verb == "ACQUIRE-TOOL"
            && let Some(to) = to.filter(|to| to.as_str() != NEAR_DRUM)
        {
            let message = format!("ACQUIRE-TOOL goes to the drum from {NEAR_DRUM}, {to} found");
            self.error(Field::Destination, message, format!("write {NEAR_DRUM} as the destination"));
        }
    }

    /// A location in a tray needs a sector: its location point is only the corner (VIII.3).
    fn sectors(&mut self) {
        let places = match self.verb {
            "MOVE" | "REFIXTURE" => [Some(self.source()), Some(self.destination()), None],
            "ACQUIRE" => [Some(self.source()), None, None],
            _ => [Some(self.source()), Some(self.destination()), Some(self.end_at())],
        };
        let object = self.command.object.unwrap_or_default();
        for place in places.into_iter().flatten().filter(|place| place.sector.is_none()) {
            let Some(name) = place.name else { continue };
            let owner = self.data.owner_named(&Name10::clipped(name.as_str()));
            let members = owner.map_or(&[][..], |owner| self.data.members_of(owner));
            if !members.iter().any(|member| member.member.kind == RefType::Array) {
                continue;
            }
            let record = self.data.object_named(&object);
            let assigned = record.into_iter().flat_map(|record| self.data.object_locations(record));
            let here =
                assigned.filter(|assigned| members.iter().any(|member| member.member == *assigned)).last();
            let array = here.and_then(|here| self.data.array(ArrayId::new(here.number)));
            let help = match (here.map(|here| here.kind), array) {
                // The object location form assigns the object to the location point itself.
                (Some(RefType::LocationPoint), _) => continue,
                (_, Some(array)) => format!("{name} has sectors 1 to {} for {object}", array.sectors()),
                (_, None) => "name a location point beside the tray".to_owned(),
            };
            self.error(place.sector_field, format!("{name} is a tray and needs a sector, 0 found"), help);
        }
    }

    /// +0 is not a grip.
    fn grips(&mut self) {
        let Some(object) = self.command.object else { return };
        for place in self.gripped().into_iter().flatten().filter(|place| place.grip == 0) {
            let Some(name) = place.name else { continue };
            let message = format!("{} needs a grip of {object} at {name}, +0 found", self.verb);
            self.error(place.grip_field, message, grips_of(self.data, &object));
        }
    }

    /// Checks the data for a regrip, which different grips at source and destination need.
    fn regrip(&mut self) {
        let (data, command) = (self.data, self.command);
        let Some(object) = command.object.filter(|_| self.carries()) else { return };
        let (from, to) = (command.source_grip, command.destination_grip);
        if from == to {
            if self.verb == "REFIXTURE" {
                let message = format!("REFIXTURE changes the grip, {from:+} found twice");
                self.error(Field::DestinationGrip, message, "write another grip at the destination, or MOVE");
            }
            return;
        }
        // A grip without an object form is already reported, and so is +0.
        if [from, to].iter().any(|grip| data.object(&object, *grip).is_none()) {
            return;
        }
        let what = format!("from grip {from:+} to {to:+} {object} goes over the pedestal");
        match data.ped_para(&object) {
            None => {
                let help =
                    "add a pedestal form, >FILE PED-PARA (VII.7.4), or use one grip for both locations";
                self.error(Field::DestinationGrip, format!("{what}, and has no PED-PARA record"), help);
            }
            Some((_, record)) if record.flip_angle == 0 => {
                let help = "give the angle that turns the object from one grip to the other (VII.7.4)";
                self.error(Field::DestinationGrip, format!("{what}, and its ped-flip-angle is 0"), help);
            }
            Some(_) => {}
        }
        let Ok(pedestal) = data.resolve_location(&Name16::clipped(PEDESTAL), None, Some(&object)) else {
            let help = "add it to a location point form (VII.3)";
            self.error(Field::DestinationGrip, format!("{what}, and there is no location {PEDESTAL}"), help);
            return;
        };
        for (number, field) in [(from, Field::SourceGrip), (to, Field::DestinationGrip)] {
            let entries = [
                ("-grip-", "movetable for", data.grip_movetable(&object, number, &pedestal.place).is_some()),
                ("-appr obj", "approach with", data.approach(&object, number, &pedestal.place).is_some()),
                ("-dept obj", "depart with", data.depart(&object, number, &pedestal.place).is_some()),
            ];
            for (word, what_is, _) in entries.into_iter().filter(|(_, _, there)| !there) {
                let message = format!("{what}, and has no {what_is} grip {number:+} at {PEDESTAL}");
                let help = format!("add `{word} {object} {number} lpt {PEDESTAL}`");
                self.error(field, message, help);
            }
        }
    }

    /// The hand of the Active Pedestal grips only during a regrip (V.3.1 FIX-GRIP): a TRANSFER cannot end there.
    fn pedestal(&mut self) {
        let to = self.command.destination.filter(|to| self.verb == "TRANSFER" && to.as_str() == PEDESTAL);
        if to.is_none() {
            return;
        }
        let object = self.command.object.unwrap_or_default();
        let message = format!(
            "TRANSFER releases {object} at {PEDESTAL}, but does not command the hand there to grip it"
        );
        let help = "name a tray, a fixture or a holster as the destination; another grip there regrips the object \
                    on the pedestal on the way";
        self.error(Field::Destination, message, help);
    }

    /// The command handles a tool, which the gripper holds; before ACQUIRE-TOOL it is empty.
    fn tool(&mut self, held: Held) {
        if !self.is_for_tools() {
            return;
        }
        let (verb, command) = (self.verb, self.command);
        if let Some(object) = command.object {
            let id = self.data.obj_grips(&object).map_or(0, |grips| grips.endeff_id);
            if id != TOOL_GRIPPER {
                let message = format!("{verb} handles tools; endeff-id# of {object} is {id}");
                self.error(
                    Field::Object,
                    message,
                    format!("tools have {TOOL_GRIPPER} in OBJ-GRIPS (VII.7.2)"),
                );
                return;
            }
            let grips = [command.source_grip, command.destination_grip];
            if !grips.iter().any(|grip| self.data.object(&object, *grip).is_some()) {
                let help = grips_of(self.data, &object);
                self.error(Field::Object, format!("{verb} needs a grip of {object}"), help);
            }
        }
        self.moves();
        let (found, first) = match held {
            Held::Unknown => return,
            Held::Object(tool) if command.object.is_none_or(|object| tool == object) => return,
            Held::Object(other) => (format!("{other} is"), other),
            Held::Nothing => ("nothing is".to_owned(), command.object.unwrap_or_default()),
        };
        let before = match verb {
            "INSERT-TOOL" => "a MOVE of the tool to TOOL-SAFE",
            "RELEASE-TOOL" => "an INSERT-TOOL",
            "REMOVE-TOOL" => "an ACQUIRE-TOOL",
            _ if Some(first) == command.object => return,
            _ => "a command that releases it",
        };
        let what = if verb == "ACQUIRE-TOOL" { "an empty gripper" } else { "a tool in the gripper" };
        let message = format!("{verb} needs {what}; {found} held here");
        self.error(Field::Command, message, format!("{before} comes before it"));
    }

    fn moves(&mut self) {
        let names: &[&str] = match self.verb {
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
                format!("{} makes the relative move {name} at {DRUM}, and there is none", self.verb);
            self.error(
                Field::Command,
                message,
                format!("add `-rel- {name} lpt {DRUM}`, see data/guarded.blk"),
            );
        }
    }
}

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

/// Help text: locations with an approach to an object, or to its view, with a grip.
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

fn named(data: &TaskData<'_>, at: Reference) -> String {
    let name = match at.kind {
        RefType::LocationPoint => data.locpt(LocptId::new(at.number)).map(|point| point.name),
        RefType::Array => data.array(ArrayId::new(at.number)).map(|array| array.name),
        RefType::Owner => data.owner(OwnerId::new(at.number)).map(|owner| owner.name),
        _ => None,
    };
    name.map_or_else(|| at.kind.text().to_owned(), |name| name.to_string())
}
