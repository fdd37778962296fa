//! The object in the fingers, its position there, and the object released last.

use geometry::pose::Pose;
use interfaces::{
    CommonMemory,
    emove::{EmoveCommand, EmoveVerb, Estimates, Grasped, Holding, PlacedObject, RobotPlace, Seat},
    grip::Felt,
    prim::PrimReport,
};
use rcs_core::{Plain, handshake::Lower};

use super::{
    EmoveInputs,
    grasp::sizes,
    gripper::{EmoveGripper, is_open},
    grippers::{FingerVerb, Grippers},
    localization::{LOST_INCHES, LOST_RADIANS},
    motion::route::FULL_OPENING,
    robot_place::{is_moved_by_hand, may_push, near, present_frame},
    tables::{EmoveLoad, Fingers},
};
use crate::execution::{Execution, Outcome};

/// Ticks without contact of a held object (0.2 s). A part needs less time from one finger to the other.
const ABSENT_TICKS: u8 = 5;
/// Least opening that releases an unknown object, 0.01 in (ASSUMED).
const LEAST_RELEASE: i32 = 50;

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct HeldObject {
    held: Option<Grasped>, // the object in the gripper
    /// The object of the last grasp command. `None` with a held object means that its release was interrupted.
    grasping: Option<Grasped>,
    empty: bool, // the fingers are empty, and have not been commanded to close since
    seat: Seat,  // seat of the object grasped last
    disturbed: Option<RobotPlace>, // the last place at which an object may have been displaced
    placed: Option<PlacedObject>, // the object released last, and where
    releasing: bool, // the last order to the fingers releases the held object
    unfelt: u8,  // ticks without contact of the held object
    carrying: bool, // an object was held when the current command arrived
    gripper_gone: bool, // the last held object was removed with its gripper
}

impl HeldObject {
    pub(super) const fn adopt(&mut self, estimates: &Estimates) {
        (self.held, self.grasping, self.empty) = (estimates.held, estimates.grasping, estimates.empty);
        (self.seat, self.disturbed, self.placed) = (estimates.seat, estimates.disturbed, estimates.placed);
    }

    pub(super) const fn write_to(&self, estimates: &mut Estimates) {
        (estimates.held, estimates.grasping, estimates.empty) = (self.held, self.grasping, self.empty);
        (estimates.seat, estimates.disturbed, estimates.placed) = (self.seat, self.disturbed, self.placed);
    }

    /// A release may have been interrupted by the restart.
    pub(super) fn start(&mut self, order: FingerVerb) {
        let is_cut_off = self.held.is_some() && self.grasping.is_none();
        self.releasing = is_cut_off || order == FingerVerb::Release;
    }

    pub const fn begin(&mut self) {
        self.carrying = self.held.is_some();
    }

    pub(super) const fn held(&self) -> Option<&Grasped> {
        self.held.as_ref()
    }

    pub(super) const fn seat(&self) -> Seat {
        self.seat
    }

    pub(super) const fn placed(&self) -> Option<PlacedObject> {
        self.placed
    }

    pub(super) fn hold(&mut self, grasped: Grasped, at: Option<&RobotPlace>) {
        (self.held, self.placed) = (Some(grasped), None);
        self.forget_disturbance(at);
        self.unfelt = 0;
    }

    /// The operator names the held object; without a name the fingers are empty.
    pub(super) const fn name(&mut self, grasped: Option<Grasped>) {
        self.grasping = grasped;
        if grasped.is_some() {
            self.empty = false;
        } else {
            self.held = None;
        }
    }

    pub(super) const fn forget_placed(&mut self) {
        self.placed = None;
    }

    /// Closing by hand keeps the name of the held object, and ends its release.
    pub(super) const fn close(&mut self, on: Option<Grasped>, seat: Seat) {
        if on.is_some() {
            // A regrasped object is held once the fingers have closed on it.
            (self.held, self.carrying, self.grasping) = (None, false, on);
        } else {
            self.grasping = self.held;
        }
        // A placed object may be taken, and lost elsewhere.
        (self.seat, self.placed, self.empty) = (seat, None, false);
    }

    pub(super) fn note_order(&mut self, order: FingerVerb) {
        self.releasing = order == FingerVerb::Release;
    }

    /// Records a paused release, which the order no longer shows, for a restarted E-move.
    pub(super) const fn pause_release(&mut self) {
        self.grasping = None;
    }

    /// True if a release has begun at the robot's place and has not ended.
    #[must_use]
    pub const fn is_releasing(&self, at_place: bool) -> bool {
        self.releasing && self.held.is_some() && at_place
    }

    pub(super) const fn load(&self, is_misread: bool) -> EmoveLoad {
        match self.held {
            None if self.carrying && self.gripper_gone => EmoveLoad::GripperGone,
            None if self.carrying => EmoveLoad::Lost,
            Some(_) if self.carrying && is_misread => EmoveLoad::PinsFail,
            _ => EmoveLoad::Kept,
        }
    }

    /// A ring that was open receives a gripper only in its holster, where no gripper is left with an object.
    pub(super) const fn note_gripper(&mut self, memory: &CommonMemory) {
        (self.empty, self.grasping) = (is_open(memory), None);
    }

    /// Also adopts the commanded object if the fingers detect one and none is recorded as held.
    pub(super) fn sense_grasp(
        &mut self,
        command: &EmoveCommand,
        grippers: &Grippers,
        execution: &Execution,
        inputs: &EmoveInputs<'_>,
    ) -> Option<Grasped> {
        let (tick, memory) = (inputs.tick, inputs.memory);
        let attached = EmoveGripper::attached(memory);
        // Open fingers sense nothing, so this reading proves nothing before they have closed.
        let closing = grippers.order() == FingerVerb::Grasp && grippers.are_moving(tick, memory);
        self.empty |= grippers.has_released(tick, memory);
        match attached.felt(memory) {
            Felt::Nothing => self.empty |= !closing,
            Felt::Something
                if self.held.is_none() && self.may_adopt(command, grippers, execution, inputs) =>
            {
                let at = |grasped: &Grasped| {
                    let (Ok(then), Some(now)) = (grasped.pose.to_frame(), present_frame(memory)) else {
                        return false;
                    };
                    near(&then, &now, LOST_INCHES, LOST_RADIANS)
                };
                let grasped = self.grasping.filter(at)?;
                let opening = attached.opening(memory).unwrap_or(grasped.opening);
                return Some(Grasped { opening, gripper: attached.id(), ..grasped });
            }
            Felt::Something | Felt::NotKnown => {}
        }
        None
    }

    /// False while the fingers move or do not press the object, and before the closing command has checked the grasp.
    /// Also false if the fingers were empty and have only opened since then.
    fn may_adopt(
        &self,
        command: &EmoveCommand,
        grippers: &Grippers,
        execution: &Execution,
        inputs: &EmoveInputs<'_>,
    ) -> bool {
        let grasps = matches!(command.command, EmoveVerb::GraspObj | EmoveVerb::AcquireTool);
        let looks = grasps && execution.outcome == Outcome::Executing;
        let status = grippers.status(inputs.tick, inputs.memory);
        let moving = matches!(status, Lower::Pending | Lower::Executing);
        let presses = EmoveGripper::attached(inputs.memory).presses(inputs.memory);
        !looks && !moving && presses && !self.empty
    }

    /// No sensor measures the position along the fingers. The object slides if the robot hits an obstacle while the
    /// operator moves it, or while the arm has no pressure: the robot controller is off, or the resolvers give no
    /// position. Such an arm also pushes an object that it has just released, or is about to grasp.
    ///
    /// `origin` is the last place of the robot; `ends` are the ends of its path; `drum` is the place of an unfinished
    /// tool command; `is_sensed` is false if the resolvers give no position.
    pub(super) fn sense_seat(
        &mut self,
        (origin, ends): (Option<&RobotPlace>, [Option<&RobotPlace>; 3]),
        drum: Option<&RobotPlace>,
        is_sensed: bool,
        memory: &CommonMemory,
    ) {
        let prim = &memory.prim.status;
        let is_off = prim.controller_off || prim.report == PrimReport::T3LinkOff;
        let is_off = is_off || !is_sensed;
        if !is_moved_by_hand(memory) && !is_off {
            return;
        }
        let have_closed = !self.empty && (self.held.is_some() || self.grasping.is_some());
        if have_closed || self.is_placed_at(origin) {
            self.seat = Seat::NotKnown;
        }
        let near = || ends.into_iter().flatten().find(|at| may_push(&at.pose, memory));
        self.disturbed = drum.or_else(near).copied().or(self.disturbed);
    }

    fn is_placed_at(&self, at: Option<&RobotPlace>) -> bool {
        self.placed.zip(at).is_some_and(|(placed, at)| placed.site == at.site)
    }

    /// The seat is unconfirmed if the object may have been pushed, or slid before its release, without a picture of it.
    pub(super) fn next_seat(&self, command: &EmoveCommand, is_located: bool) -> Seat {
        let is_disturbed = self.disturbed.is_some_and(|at| at.site.has_location_of(&command.site));
        match (self.empty, is_located, is_disturbed) {
            (false, ..) => self.seat,
            (true, false, true) => Seat::NotKnown,
            (true, ..) => Seat::Kept,
        }
    }

    /// Clears the disturbance after a grasp here, or after the release of an object that did not slide.
    fn forget_disturbance(&mut self, here: Option<&RobotPlace>) {
        let is_here = |at: &RobotPlace| here.is_some_and(|here| at.site.has_location_of(&here.site));
        self.disturbed = self.disturbed.filter(|at| !is_here(at));
    }

    /// Opening fingers hold the object until they have released it. If they stop half-way, it is still between them,
    /// and the release can be sent again. `at` is the place of the robot.
    pub(super) fn sense_loss(
        &mut self,
        at: Option<&RobotPlace>,
        grippers: &Grippers,
        inputs: &EmoveInputs<'_>,
    ) {
        let memory = inputs.memory;
        let Some(held) = self.held else { return };
        let letting_go = self.is_releasing(at.is_some());
        let gripper = EmoveGripper::of(held.gripper);
        // A part held with little force hardly moves the fingers when it falls, so only the force shows the loss.
        let felt = letting_go || !gripper.senses_nothing(memory);
        self.unfelt = if felt { 0 } else { self.unfelt.saturating_add(1) };
        // A restarted gripper has no opening yet, which does not prove a loss.
        let slipped = !letting_go
            && gripper
                .opening(memory)
                .is_some_and(|opening| !gripper.still_grips(opening, held.grasp_size, held.opening));
        let gone = EmoveGripper::attached(memory) != gripper;
        let unfelt = self.unfelt > ABSENT_TICKS;
        let has_released = grippers.has_released(inputs.tick, memory);
        if slipped || unfelt || gone || has_released {
            (self.held, self.grasping, self.gripper_gone) = (None, None, gone);
            let let_go = |at: &RobotPlace| PlacedObject {
                object: held.object.object,
                grip: held.object.grip,
                site: at.site,
            };
            let put = at.filter(|_| has_released && !gone);
            self.placed = put.map(let_go);
            match (put, self.seat) {
                (Some(_), Seat::Kept) => self.forget_disturbance(put),
                (Some(_), Seat::NotKnown) => self.disturbed = put.copied(),
                (None, _) => {}
            }
        }
    }

    /// The grasped object while it is detected, else the reading of the sensors. `is_misread`: bad contact of the pins.
    pub(super) fn holding(&self, is_misread: bool, memory: &CommonMemory) -> Holding {
        let attached = EmoveGripper::attached(memory);
        match (self.held, attached.felt(memory)) {
            (None, _) if is_misread && self.empty => Holding::Nothing,
            _ if is_misread => Holding::NotKnown,
            (Some(held), _) => Holding::Object(held.object),
            (None, Felt::Nothing) => Holding::Nothing,
            (None, Felt::NotKnown) if self.empty => Holding::Nothing,
            // Jaws stopped while they opened are also between their stops.
            (None, Felt::Something) if self.empty && attached.has_stops() => Holding::Nothing,
            (None, Felt::Something) => Holding::Something,
            (None, Felt::NotKnown) => Holding::NotKnown,
        }
    }

    /// If the opening is unknown, the recorded object is assumed.
    pub(super) fn fingers(
        &self,
        at_place: bool,
        command: &EmoveCommand,
        grippers: &Grippers,
        inputs: &EmoveInputs<'_>,
    ) -> Fingers {
        let memory = inputs.memory;
        let grasp_size = sizes(command, inputs.data).map_or(0, |sizes| sizes.grasp_size);
        let gripper = EmoveGripper::attached(memory);
        let gripping = match gripper.opening(memory) {
            Some(opening) => gripper.grips(opening, grasp_size),
            None => self.held.is_some(),
        };
        if gripping && !self.is_partly_released(at_place, grippers, inputs) {
            Fingers::Gripping
        } else {
            Fingers::Empty
        }
    }

    /// True if a held object is being released, or fingers at rest neither detect nor press it.
    fn is_partly_released(&self, at_place: bool, grippers: &Grippers, inputs: &EmoveInputs<'_>) -> bool {
        let Some(held) = self.held else { return false };
        let (gripper, memory) = (EmoveGripper::of(held.gripper), inputs.memory);
        let around = gripper.felt(memory) != Felt::Nothing && gripper.presses(memory);
        self.is_releasing(at_place) || (!around && !grippers.are_moving(inputs.tick, memory))
    }

    /// In 0.01 in. An unknown object may be wider than that of the command, so the fingers open from where they are.
    pub(super) fn depart_opening(
        &self,
        holding: Holding,
        command: &EmoveCommand,
        inputs: &EmoveInputs<'_>,
    ) -> i32 {
        let EmoveInputs { data, memory, .. } = inputs;
        let held = self.held.and_then(|held| data.end_eff(held.parameters));
        let size = held.or_else(|| sizes(command, data)).map_or(FULL_OPENING, |sizes| sizes.depart_size);
        let now = match holding {
            Holding::Something | Holding::NotKnown => EmoveGripper::attached(memory).opening(memory),
            Holding::Nothing | Holding::Object(_) => None,
        };
        now.map_or(size, |now| size.max(now.saturating_add(LEAST_RELEASE).min(FULL_OPENING)))
    }

    pub const fn forget_places(&mut self) {
        (self.placed, self.disturbed) = (None, None);
    }

    /// Clear what no table reads, for a search that compares states (docs/evidence.md).
    pub const fn forget_unread(&mut self) {
        match &mut self.grasping {
            grasping if self.held.is_none() && self.empty => *grasping = None,
            Some(grasping) => grasping.opening = 0,
            None => {}
        }
        if self.held.is_none() {
            self.unfelt = 0;
        }
    }

    pub(super) fn grasped_at(&self) -> Option<Pose> {
        self.held.map(|held| held.pose)
    }
}
