//! A command of the workstation controller with its names looked up (V.4.2): TRANSLATE-HWS-CMD of Figure IV.1.

use geometry::pose::Pose;
use interfaces::{ChangingPose, HwsCommand, emove::ObjectGrip, location::Site};
use rcs_core::{
    Plain,
    name::{Name10, Name16},
};
use taskdata::files::{EndEffId, TaskData};

use super::tables::{
    Destination, DrumDeparture, SiteData, TaskRegrip, ToolData,
    item::{Takes, TaskOrigin},
};
use crate::places::{Missing, is_in_mbd, named};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
#[text(upper)]
pub enum TaskVerb {
    /// No command yet, or an unknown word.
    #[text = ""]
    None,
    /// Do nothing.
    Pause,
    /// Move an object from one location to another.
    Transfer,
    /// Move an object to a location and hold it there, or move the robot.
    Move,
    /// Release the held object and move to a position.
    Position,
    /// Move to an object and grasp it.
    Acquire,
    /// Take an object, regrip it on the pedestal and move it to a location.
    Refixture,
    /// Insert a tool into the tool drum.
    InsertTool,
    /// Release a tool in the drum.
    ReleaseTool,
    /// Move to a tool in the drum and grasp it.
    AcquireTool,
    /// Pull a tool out of the drum.
    RemoveTool,
    /// Connect the Data System.
    Startup,
    /// Disconnect the Data System.
    Shutdown,
}

/// `endeff-id#` of the tool gripper (VII.7.2).
pub const TOOL_GRIPPER: u8 = 3;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Handling {
    /// The command names no object.
    NoObject,
    /// The command names an object.
    Object,
}

/// The progress of a command that was sent before and not finished (docs/design/recovery.md "Ledger").
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Resumed {
    /// The command is new.
    Not,
    /// The command was begun and is not finished.
    Begun,
    /// The command was interrupted while Subtask had its tool command.
    AtTool,
    /// The command was interrupted on the way to the end-at location.
    Leaving,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Grips {
    /// The object stays in its grip.
    Same,
    /// The object must be regripped.
    Different,
}

/// `endeff-id#` of the gripper for the object (VII.7.2).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum TaskGripper {
    /// A gripper may have this number, or no object is named.
    Valid,
    /// No gripper can have this number.
    Invalid,
}

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Location {
    pub site: Site,
    pub pose: ChangingPose, // the T-POSE of the location
}

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct PlanSite {
    pub location: Option<Location>, // the location that the command names
    pub grip: i32,
    pub parameters: EndEffId, // record of END-EFF-PARA, if the object has that grip
}

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Plan {
    pub verb: TaskVerb,
    pub object: Option<Name16>,
    pub serial: Name16,
    /// `obj-endeff-id#` for Subtask (V.3.2); `None` if any gripper will do.
    pub end_effector_id: Option<u8>,
    pub source: PlanSite,
    pub destination: PlanSite, // destination of the object, or of the robot alone
    pub end_at: PlanSite,      // place of the robot at the end of the command
    pub update_due: bool,      // the move from or to the MBD is still to be reported
    pub from_elsewhere: bool,  // an ACQUIRE of a held object that was not taken from the source
    pub resumed: Resumed,      // progress before the command was repeated
}

#[derive(Clone, Copy, Debug, Default)]
pub struct Found {
    pub plan: Plan,
    pub missing: Missing,     // missing data of the object, else of a location
    pub gripper: TaskGripper, // number of the gripper for the object
    pub regrip: TaskRegrip,
    pub way_out: DrumDeparture, // trajectory from the tool drum to the end-at location
}

impl TaskVerb {
    /// Compares ten characters, as all processes below do (SPECNOTES.md, contradiction 22).
    #[must_use]
    pub fn of(word: &Name16) -> Option<Self> {
        let word = Name10::clipped(word.as_str());
        Self::ALL.iter().copied().find(|verb| *verb != Self::None && Name10::clipped(verb.text()) == word)
    }

    const fn is_bare(self) -> bool {
        matches!(self, Self::None | Self::Pause | Self::Startup | Self::Shutdown)
    }
    pub(super) const fn takes(self) -> bool {
        matches!(self, Self::Transfer | Self::Move | Self::Acquire | Self::Refixture)
    }
    const fn is_for_tools(self) -> bool {
        matches!(self, Self::InsertTool | Self::ReleaseTool | Self::AcquireTool | Self::RemoveTool)
    }
}

impl Plan {
    #[must_use]
    pub fn look_up(command: &HwsCommand, data: &TaskData<'_>) -> Found {
        let verb = TaskVerb::of(&command.command).unwrap_or(TaskVerb::None);
        let bare = Self { verb, ..Self::default() };
        if verb.is_bare() {
            return Found { plan: bare, ..Found::default() };
        }
        let object = command.object;
        let (end_effector_id, gripper) = gripper(verb, object.as_ref(), data);
        let locations = [
            (command.source, command.source_sector),
            (command.destination, command.destination_sector),
            (command.end_at, command.end_at_sector),
        ]
        .map(|(name, sector)| Location::look_up(name, sector, object.as_ref(), data));
        let missing = match object {
            Some(object) if data.object_named(&object).is_none() => Missing::Object,
            _ => locations.iter().find_map(|location| location.err()).unwrap_or(Missing::Nothing),
        };
        let [source, destination, end_at] = locations.map(|location| location.unwrap_or(None));
        let is_in_mbd =
            |location: Option<Location>| location.is_some_and(|location| location.is_in_mbd(data));
        let site = |location, grip| {
            let parameters = object.and_then(|object| data.object(&object, grip));
            PlanSite { location, grip, parameters: parameters.map_or(EndEffId::NULL, |(id, _)| id) }
        };
        let plan = Self {
            object,
            serial: command.serial,
            end_effector_id,
            source: site(source, command.source_grip),
            destination: site(destination, command.destination_grip),
            end_at: site(end_at, 0),
            update_due: object.is_some() && (is_in_mbd(source) || is_in_mbd(destination)),
            ..bare
        };
        let has_data = object.is_none_or(|object| data.ped_para(&object).is_some());
        let regrip = match plan.grips() {
            Grips::Same => TaskRegrip::None,
            Grips::Different if has_data => TaskRegrip::Possible,
            Grips::Different => TaskRegrip::NoData,
        };
        Found { plan, missing, gripper, regrip, way_out: plan.way_out(data) }
    }

    /// Only a command that ends at the drum needs a trajectory out of it.
    fn way_out(&self, data: &TaskData<'_>) -> DrumDeparture {
        let leaves = matches!(self.verb, TaskVerb::ReleaseTool | TaskVerb::RemoveTool);
        let Some(end_at) = self.end_at.location.filter(|_| leaves) else { return DrumDeparture::Leads };
        let Some(drum) = data.place_named::<10, 16>(&Name10::clipped(named::TOOL_TRNS), None) else {
            return DrumDeparture::Leads;
        };
        let to = end_at.site.place();
        if drum.has_location_of(&to) || data.trajectory(&drum, &to).is_some() {
            DrumDeparture::Leads
        } else {
            DrumDeparture::NoTrajectory
        }
    }

    #[must_use]
    pub const fn handling(&self) -> Handling {
        if self.object.is_some() { Handling::Object } else { Handling::NoObject }
    }

    /// True if the command names an object or a tool.
    #[must_use]
    pub const fn is_about_something(&self) -> bool {
        self.object.is_some() || self.verb.is_for_tools()
    }

    #[must_use]
    pub const fn origin(&self) -> TaskOrigin {
        if self.from_elsewhere { TaskOrigin::Elsewhere } else { TaskOrigin::Source }
    }

    #[must_use]
    pub const fn takes(&self) -> Takes {
        match self.verb {
            TaskVerb::AcquireTool if self.object.is_some() => Takes::Tool,
            verb if verb.takes() && self.object.is_some() => Takes::Object,
            _ => Takes::Nothing,
        }
    }

    #[must_use]
    pub const fn grips(&self) -> Grips {
        if self.source.grip == self.destination.grip { Grips::Same } else { Grips::Different }
    }

    #[must_use]
    pub const fn site(&self, site: &PlanSite) -> SiteData {
        if site.location.is_none() {
            SiteData::Null
        } else if self.has_grip(site) {
            SiteData::Known
        } else {
            SiteData::NoGrip
        }
    }

    /// True if the object has the grip of a site, or no object is named.
    const fn has_grip(&self, site: &PlanSite) -> bool {
        self.object.is_none() || !site.parameters.is_null()
    }

    #[must_use]
    pub const fn goal(&self) -> SiteData {
        let site =
            if matches!(self.verb, TaskVerb::Position) { self.position_site() } else { &self.destination };
        self.site(site)
    }

    #[must_use]
    pub const fn tool(&self) -> ToolData {
        if !matches!(self.end_effector_id, Some(TOOL_GRIPPER)) {
            ToolData::Unfit
        } else if self.has_grip(self.tool_site()) {
            ToolData::Fit
        } else {
            ToolData::NoGrip
        }
    }

    /// POSITION goes to the source, or to the destination if the source is null (SPECNOTES.md, contradiction 24).
    #[must_use]
    pub const fn position_site(&self) -> &PlanSite {
        if self.source.location.is_some() { &self.source } else { &self.destination }
    }

    #[must_use]
    pub fn object_at_position(&self) -> Option<ObjectGrip> {
        self.object.map(|object| ObjectGrip { object, grip: self.position_site().grip })
    }

    /// The site with the tool's grip: the source if the tool has its grip, else the destination.
    #[must_use]
    pub const fn tool_site(&self) -> &PlanSite {
        if self.source.parameters.is_null() { &self.destination } else { &self.source }
    }
}

fn gripper(verb: TaskVerb, object: Option<&Name16>, data: &TaskData<'_>) -> (Option<u8>, TaskGripper) {
    let id = match object {
        None if verb.is_for_tools() => TOOL_GRIPPER.into(),
        _ => object.and_then(|object| data.obj_grips(object)).map_or(0, |grips| grips.endeff_id),
    };
    match u8::try_from(id) {
        Ok(id) => ((id != 0).then_some(id), TaskGripper::Valid),
        Err(_) => (None, TaskGripper::Invalid),
    }
}

impl PlanSite {
    #[must_use]
    pub fn site(&self) -> Option<Site> {
        self.location.map(|location| location.site)
    }

    #[must_use]
    pub fn destination(&self) -> Destination {
        match self.location.as_ref().map(|location| location.site.location.as_str()) {
            Some(named::TOOL_SAFE) => Destination::NearDrum,
            Some(named::PEDESTAL) => Destination::Pedestal,
            Some(_) | None => Destination::Elsewhere,
        }
    }
}

impl Location {
    fn look_up(
        name: Option<Name16>,
        sector: Option<i32>,
        object: Option<&Name16>,
        data: &TaskData<'_>,
    ) -> Result<Option<Self>, Missing> {
        let Some(name) = name else { return Ok(None) };
        let found = data.resolve_location(&name, sector, object)?;
        Ok(Some(Self {
            site: found.site(),
            pose: ChangingPose { number: None, pose: Pose::from_frame(&found.frame) },
        }))
    }

    fn is_in_mbd(&self, data: &TaskData<'_>) -> bool {
        is_in_mbd(self.site.record, data)
    }
}
