//! Openings and sizes of the object forms (VII.7.1) as orders to the attached gripper, and its opening as state
//! variables.

use core::mem;

use interfaces::{
    CommonMemory,
    emove::{Beliefs, EmoveCommand, EmoveVerb, GoneTo, Grasped, Holding, PlacedObject, RobotPlace, Seat},
    grip::Felt,
    prim::PrimReport,
    process::Inputs,
    quick_change::RingPosition,
};
use rcs_core::handshake::Lower;
use taskdata::files::{EndEffId, EndEffPara, TaskData};

use super::{
    gripper::{Gripper, is_open},
    order::{FingerOrder, FingerVerb},
    preprocess::holster,
    robot_place::{is_led, may_push, place, place_named, present_frame},
    route::{Ahead, FULL_OPENING, near, same_location},
    state::State,
    tables::{Action, Fingers, Holster, Opening, Spread},
    whereabouts::{LOST_INCHES, LOST_RADIANS},
};
use crate::{execution::Outcome, places::LocationKey};

/// Grip number of a holster object with the gripper on the robot; its approach size is the opening with which
/// the gripper goes through the holster.
const GRIPPER_ON: i32 = 1;
/// Ticks in which neither finger may feel what is held (0.2 s): longer than it takes to push a part from one
/// finger to the other.
const UNFELT_TICKS: u8 = 5;
/// Force with which the joystick box closes the parts gripper, lb: the least of the usual ones (VIII.9.1;
/// ASSUMED).
const HAND_FORCE: i32 = 30;
/// Something unknown is let go by this much at least, 0.01 in (ASSUMED).
const LEAST_RELEASE: i32 = 50;

/// Parameters of the holster object of a command with the gripper on.
pub(super) fn gripper_on<'d>(command: &EmoveCommand, data: &TaskData<'d>) -> Option<&'d EndEffPara> {
    data.object(&command.object?, GRIPPER_ON).map(|(_, parameters)| parameters)
}

/// Parameters of the object of a command.
pub(super) fn sizes<'d>(command: &EmoveCommand, data: &TaskData<'d>) -> Option<&'d EndEffPara> {
    data.end_eff(EndEffId::from_option(command.object_parameters))
}

/// Do the fingers stand at an opening, 0.01 in, without air that moves them from there?
fn attached_stands_at(opening: i32, memory: &CommonMemory) -> bool {
    let attached = Gripper::attached(memory);
    let goes = attached.has_air(!attached.closes_for(opening), memory);
    attached != Gripper::None && attached.stands_at(opening, memory) && !goes
}

impl State {
    /// Whether the held object is still held, and whether anything is between the fingers.
    pub(super) fn sense_held(&mut self, command: &EmoveCommand, inputs: &Inputs<'_, TaskData<'_>>) {
        let memory = inputs.memory;
        let attached = Gripper::attached(memory);
        if self.is_misread(memory) {
            return;
        }
        self.sense_loss(inputs);
        self.sense_seat(memory);
        if attached != mem::replace(&mut self.attached, attached) {
            // A ring that is open takes a gripper only in its holster, where none is left that may hold
            // something.
            (self.beliefs.empty, self.beliefs.grasping) = (is_open(memory), None);
            if attached != Gripper::None {
                // Its process wakes, and answers nothing that it was told before it was left.
                self.grippers.to = Gripper::None;
            }
        }
        // Before the fingers have closed they feel nothing: that says nothing of what they will hold.
        let closing =
            self.grippers.order == FingerVerb::Grasp && self.grippers.are_moving(inputs.tick, memory);
        self.beliefs.empty |= self.grippers.has_let_go(inputs.tick, memory);
        match attached.felt(memory) {
            Felt::Nothing => self.beliefs.empty |= !closing,
            Felt::Something if self.beliefs.held.is_none() && self.may_adopt(command, inputs) => {
                let at = |grasped: &Grasped| {
                    let (Ok(then), Some(now)) = (grasped.pose.to_frame(), present_frame(memory)) else {
                        return false;
                    };
                    near(&then, &now, LOST_INCHES, LOST_RADIANS)
                };
                if let Some(grasped) = self.beliefs.grasping.filter(at) {
                    let opening = attached.opening(memory).unwrap_or(grasped.opening);
                    self.hold(Grasped { opening, gripper: attached.id(), ..grasped });
                }
            }
            Felt::Something | Felt::NotKnown => {}
        }
        // What was brought has been let go, or is lost: the empty fingers depart as from any object.
        if let (None, Some(place)) = (self.beliefs.held, &mut self.beliefs.place)
            && let GoneTo::Brought(object) = place.gone_to
        {
            place.gone_to = GoneTo::Object(object);
        }
    }

    /// Where along the fingers the object is: nothing measures it. With the robot it slides as soon as it meets
    /// anything, while a person leads the robot or the arm has no pressure: then the robot controller is off, whatever
    /// Prim has made of its last command, or the resolvers give no position. An arm that moves away from an object
    /// which it has just released pushes it in the same way, and so does one that a person leads past an object before
    /// it is grasped.
    fn sense_seat(&mut self, memory: &CommonMemory) {
        let prim = &memory.prim.status;
        let is_off = prim.controller_off || prim.report == PrimReport::T3LinkOff;
        let is_off = is_off || present_frame(memory).is_none();
        let Beliefs { held, grasping, empty, .. } = &self.beliefs;
        let have_closed = !empty && (held.is_some() || grasping.is_some());
        if !is_led(memory) && !is_off {
            return;
        }
        if have_closed || self.is_around_placed() {
            self.beliefs.seat = Seat::NotKnown;
        }
        let Beliefs { place, way, drum, .. } = self.beliefs;
        let ends = [place, way.map(|way| way.to), way.map(|way| way.from)];
        let near = || ends.into_iter().flatten().find(|at| may_push(&at.pose, memory));
        self.beliefs.disturbed = drum.or_else(near).or(self.beliefs.disturbed);
    }

    /// Is the robot still where it has released an object, or on its way from there to its next place?
    fn is_around_placed(&self) -> bool {
        let Beliefs { placed, way, .. } = &self.beliefs;
        let from = self.place().or_else(|| way.map(|way| way.from));
        placed.zip(from).is_some_and(|(placed, at)| LocationKey::of(&placed) == LocationKey::of(&at))
    }

    /// The seat of what the fingers are to close on. An object that may have been pushed, or that has slid before it was
    /// let go, is not known to be at its place, unless a picture shows where it is.
    pub(super) fn next_seat(&self, command: &EmoveCommand) -> Seat {
        let Beliefs { seat, empty, located, disturbed, .. } = self.beliefs;
        let is_disturbed = disturbed.is_some_and(|at| same_location(&place(&at), &place_named(command)));
        match (empty, located, is_disturbed) {
            (false, ..) => seat,
            (true, None, true) => Seat::NotKnown,
            (true, ..) => Seat::Kept,
        }
    }

    /// The robot has grasped an object where it stands, or has let one go there that has not slid: it is not disturbed
    /// any more.
    pub(super) fn forget_disturbance(&mut self) {
        let here = self.place();
        let is_here = |at: &RobotPlace| here.is_some_and(|here| same_location(&place(at), &place(&here)));
        self.beliefs.disturbed = self.beliefs.disturbed.filter(|at| !is_here(at));
    }

    /// Do the id pins say that the gripper has gone, while the ring has been locked ever since it was there?
    /// Then it is on, and its pins have a bad contact. What it holds is not known until they read as before.
    /// A gripper that its own holster feels, while the robot is in no holster, has been torn off the ring.
    pub(super) fn is_misread(&self, memory: &CommonMemory) -> bool {
        let read = Gripper::attached(memory);
        let locked = memory.quick_change.status.ring == RingPosition::Locked;
        let rests = self.beliefs.exchange.is_none() && holster(self.attached.id(), memory) == Holster::Full;
        locked && self.attached != Gripper::None && read != self.attached && !rests
    }

    /// May something that is felt count as grasped? Not while the fingers move or do not press it, nor before the
    /// command that closes them has looked, nor if they were only opened since nothing was felt.
    fn may_adopt(&self, command: &EmoveCommand, inputs: &Inputs<'_, TaskData<'_>>) -> bool {
        let grasps = matches!(command.command, EmoveVerb::GraspObj | EmoveVerb::AcquireTool);
        let looks = grasps && self.execution.outcome == Outcome::Executing;
        let moving =
            matches!(self.grippers.status(inputs.tick, inputs.memory), Lower::Pending | Lower::Executing);
        let presses = Gripper::attached(inputs.memory).presses(inputs.memory);
        !looks && !moving && presses && !self.beliefs.empty
    }

    /// Has a release been begun at this place that has not ended?
    pub(super) fn is_letting_go(&self) -> bool {
        self.releasing && self.beliefs.held.is_some() && self.place().is_some()
    }

    /// Whether the held object is still held. Opening fingers count as holding it until they have released it: if they
    /// stop half-way, the object is still between them, and the command that releases it can be sent again.
    fn sense_loss(&mut self, inputs: &Inputs<'_, TaskData<'_>>) {
        let memory = inputs.memory;
        let Some(held) = self.beliefs.held else { return };
        let letting_go = self.is_letting_go();
        let gripper = Gripper::of(held.gripper);
        // A part that was held with little force leaves the fingers where they are when it falls: only the
        // force tells.
        let felt = letting_go || !gripper.feels_nothing(memory);
        self.unfelt = if felt { 0 } else { self.unfelt.saturating_add(1) };
        // A gripper that was restarted knows no opening: what was held is not lost for that.
        let slipped = !letting_go
            && gripper
                .opening(memory)
                .is_some_and(|opening| !gripper.still_grips(opening, held.grasp_size, held.opening));
        let gone = Gripper::attached(memory) != gripper;
        let unfelt = self.unfelt > UNFELT_TICKS;
        let has_let_go = self.grippers.has_let_go(inputs.tick, memory);
        if slipped || unfelt || gone || has_let_go {
            self.beliefs.held = None;
            self.gripper_gone = gone;
            self.beliefs.grasping = None;
            let let_go = |at: RobotPlace| PlacedObject {
                object: held.object.object,
                grip: held.object.grip,
                location: at.location,
                record: at.record,
                array: at.array,
                sector: at.sector,
            };
            let put = self.place().filter(|_| has_let_go && !gone);
            self.beliefs.placed = put.map(let_go);
            match (put, self.beliefs.seat) {
                (Some(_), Seat::Kept) => self.forget_disturbance(),
                (Some(_), Seat::NotKnown) => self.beliefs.disturbed = put,
                (None, _) => {}
            }
        }
    }

    /// What the gripper holds: what was grasped and is still felt, else what its sensors say.
    #[must_use]
    pub(super) fn holding(&self, memory: &CommonMemory) -> Holding {
        let attached = Gripper::attached(memory);
        match (self.beliefs.held, attached.felt(memory)) {
            (None, _) if self.is_misread(memory) && self.beliefs.empty => Holding::Nothing,
            _ if self.is_misread(memory) => Holding::NotKnown,
            (Some(held), _) => Holding::Object(held.object),
            (None, Felt::Nothing) => Holding::Nothing,
            (None, Felt::NotKnown) if self.beliefs.empty => Holding::Nothing,
            // Jaws that were stopped on their way to open stand between their stops, too.
            (None, Felt::Something) if self.beliefs.empty && attached.has_stops() => Holding::Nothing,
            (None, Felt::Something) => Holding::Something,
            (None, Felt::NotKnown) => Holding::NotKnown,
        }
    }

    /// What the fingers have between them. A gripper that does not know its opening has what counts as held.
    pub(super) fn fingers(&self, command: &EmoveCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Fingers {
        let memory = inputs.memory;
        let grasp_size = sizes(command, inputs.data).map_or(0, |sizes| sizes.grasp_size);
        let gripper = Gripper::attached(memory);
        let gripping = match gripper.opening(memory) {
            Some(opening) => gripper.grips(opening, grasp_size),
            None => self.beliefs.held.is_some(),
        };
        if gripping && !self.is_half_let_go(inputs) { Fingers::Gripping } else { Fingers::Empty }
    }

    /// Does something count as held that the fingers have been told to let go of, or do not feel or press at rest?
    fn is_half_let_go(&self, inputs: &Inputs<'_, TaskData<'_>>) -> bool {
        let Some(held) = self.beliefs.held else { return false };
        let (gripper, memory) = (Gripper::of(held.gripper), inputs.memory);
        let around = gripper.felt(memory) != Felt::Nothing && gripper.presses(memory);
        self.is_letting_go() || (!around && !self.grippers.are_moving(inputs.tick, memory))
    }

    /// The opening to release the held object, or the object of the command, 0.01 in. Something unknown may be wider
    /// than the object of the command: the fingers open from where they are.
    fn depart_opening(&self, command: &EmoveCommand, inputs: &Inputs<'_, TaskData<'_>>) -> i32 {
        let Inputs { data, memory, .. } = inputs;
        let held = self.beliefs.held.and_then(|held| data.end_eff(EndEffId::from_option(held.parameters)));
        let size = held.or_else(|| sizes(command, data)).map_or(FULL_OPENING, |sizes| sizes.depart_size);
        let now = match self.holding(memory) {
            Holding::Something | Holding::NotKnown => Gripper::attached(memory).opening(memory),
            Holding::Nothing | Holding::Object(_) => None,
        };
        now.map_or(size, |now| size.max(now.saturating_add(LEAST_RELEASE).min(FULL_OPENING)))
    }

    /// The order to the gripper that an action stands for.
    pub(super) fn request(
        &self,
        action: Action,
        command: &EmoveCommand,
        inputs: &Inputs<'_, TaskData<'_>>,
    ) -> FingerOrder {
        let sizes = sizes(command, inputs.data).copied().unwrap_or_default();
        match action {
            Action::Open => {
                let opening = self.route.and_then(|route| route.opening);
                FingerOrder::to(FingerVerb::Stand, opening.unwrap_or_default())
            }
            Action::OpenToApproach => FingerOrder::to(FingerVerb::Stand, sizes.appr_size),
            Action::CloseForHolster => {
                let opening = gripper_on(command, inputs.data).map_or(0, |on| on.appr_size);
                FingerOrder::to(FingerVerb::Stand, opening)
            }
            Action::OpenToDepart => {
                FingerOrder::to(FingerVerb::Release, self.depart_opening(command, inputs))
            }
            Action::OpenByHand | Action::OpenFully => FingerOrder::to(FingerVerb::Release, FULL_OPENING),
            Action::Close => {
                FingerOrder { order: FingerVerb::Grasp, opening: sizes.grasp_size, force: sizes.grasp_force }
            }
            Action::CloseByHand => {
                let opening = Gripper::attached(inputs.memory).closed();
                FingerOrder { order: FingerVerb::Grasp, opening, force: HAND_FORCE }
            }
            Action::Calibrate => FingerOrder { order: FingerVerb::Calibrate, ..FingerOrder::default() },
            _ => FingerOrder { order: FingerVerb::Pause, ..FingerOrder::default() },
        }
    }

    /// The opening for the goal of the route.
    pub(super) fn opening(&self, gripper: Lower, inputs: &Inputs<'_, TaskData<'_>>) -> Opening {
        if self.is_letting_go() {
            return Opening::LettingGo;
        }
        let Some((route, opening)) = self.route.and_then(|route| Some((route, route.opening?))) else {
            return Opening::Set;
        };
        if route.opening_sent {
            match gripper {
                Lower::Pending | Lower::Executing => Opening::Moving,
                Lower::Done => Opening::Set,
                Lower::Error | Lower::Joystick | Lower::Lost => Opening::Failed,
            }
        } else if gripper == Lower::Done && attached_stands_at(opening, inputs.memory) {
            Opening::Set
        } else if self.departing(inputs.data) {
            Opening::Departing
        } else if Gripper::attached(inputs.memory).is_uncalibrated(inputs.memory)
            && self.holding(inputs.memory) == Holding::Nothing
        {
            match (self.place(), self.ahead(inputs.data)) {
                (None, _) => Opening::Uncalibrated,
                (Some(_), Ahead::Through) => Opening::Departing,
                (Some(_), _) => Opening::Due,
            }
        } else {
            Opening::Due
        }
    }

    /// Are the fingers as wide open as letting go would leave them?
    pub(super) fn spread(
        &self,
        gripper: Lower,
        command: &EmoveCommand,
        inputs: &Inputs<'_, TaskData<'_>>,
    ) -> Spread {
        let attached = Gripper::attached(inputs.memory);
        let open = attached.is_open(self.depart_opening(command, inputs), inputs.memory);
        let at_rest = attached == Gripper::None || gripper == Lower::Done;
        match (attached.is_uncalibrated(inputs.memory), open && at_rest) {
            (true, _) => Spread::Unknown,
            (false, true) => Spread::Open,
            (false, false) => Spread::Narrow,
        }
    }
}
