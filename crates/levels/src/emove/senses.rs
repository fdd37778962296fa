//! The state variables of the commands. Each table receives those that its rows name (docs/design/tables.md "State
//! variables").

use interfaces::{
    CommonMemory,
    emove::{EmoveCommand, EmoveVerb, Holding},
    prim::JoystickGrip,
};
use rcs_core::{handshake::Lower, state_variables};

use super::{
    EmoveInputs, State,
    gripper::EmoveGripper,
    gripper_exchange::{along, holster, shut},
    motion::route::Ahead,
    tables::{
        At, AtDrum, Bias, Departure, EmoveCalibration, EmoveHolster, EmoveLink, EmoveOpening, EmoveReach,
        ExchangePosition, FingerMotion, Fingers, Knowledge, Lock, Mate, PlaceKnowledge, Readiness,
        ReleaseWork, Ring, Shut, Sight, Spread, Subordinates, Tooling, Tries, known,
    },
    vision::{can_aim, sight},
};
use crate::{execution::Work, held::Held};

pub struct Senses<'a> {
    state: &'a State,
    command: &'a EmoveCommand,
    inputs: &'a EmoveInputs<'a>,
    subordinates: &'a Subordinates,
    along: ExchangePosition,
}

impl<'a> Senses<'a> {
    #[must_use]
    pub fn new(
        state: &'a State,
        command: &'a EmoveCommand,
        inputs: &'a EmoveInputs<'a>,
        subordinates: &'a Subordinates,
    ) -> Self {
        Self { state, command, inputs, subordinates, along: along(command, inputs) }
    }

    #[must_use]
    /// The command.
    pub const fn verb(&self) -> EmoveVerb {
        self.command.command
    }

    const fn memory(&self) -> &CommonMemory {
        self.inputs.memory
    }

    fn attached(&self) -> EmoveGripper {
        EmoveGripper::attached(self.memory())
    }

    fn holding(&self) -> Holding {
        self.state.holding(self.memory())
    }
}

#[state_variables]
impl Senses<'_> {
    /// The last order.
    #[passed]
    #[must_use]
    pub const fn work(&self) -> Work {
        Work::Busy
    }

    /// The next point of the route.
    #[must_use]
    pub fn ahead(&self) -> Ahead {
        self.state.motion.flight().ahead(self.inputs.data)
    }

    /// The departure from the robot's place.
    #[must_use]
    pub fn departure(&self) -> Departure {
        match self.state.localization.place() {
            _ if self.state.motion.flight().departing(self.inputs.data) => Departure::UnderWay,
            Some(_) => Departure::AtPlace,
            None => Departure::Over,
        }
    }

    /// The opening of the fingers for the goal.
    #[must_use]
    pub const fn opening(&self) -> EmoveOpening {
        self.subordinates.opening
    }

    /// The release of an object at the place of the robot.
    #[must_use]
    pub fn release(&self) -> ReleaseWork {
        if self.state.is_releasing() { ReleaseWork::UnderWay } else { ReleaseWork::None }
    }

    #[must_use]
    /// The status of the attached gripper.
    pub const fn gripper(&self) -> Lower {
        self.subordinates.gripper
    }

    /// The calibration of the attached gripper.
    #[must_use]
    pub fn calibration(&self) -> EmoveCalibration {
        if self.attached().is_uncalibrated(self.memory()) {
            EmoveCalibration::Missing
        } else {
            EmoveCalibration::Done
        }
    }

    #[must_use]
    /// Whether the object is held.
    pub fn held(&self) -> Held {
        Held::of(self.holding(), self.command.object)
    }

    /// The contents of the closed fingers, compared with the size of the object.
    #[must_use]
    pub fn fingers(&self) -> Fingers {
        let state = self.state;
        state.held.fingers(state.localization.place().is_some(), self.command, &state.grippers, self.inputs)
    }

    /// The opening, compared with the one after a release.
    #[must_use]
    pub fn spread(&self) -> Spread {
        let attached = self.attached();
        let opening = self.state.held.depart_opening(self.holding(), self.command, self.inputs);
        let open = attached.is_open(opening, self.memory());
        let at_rest = attached == EmoveGripper::None || self.subordinates.gripper == Lower::Done;
        match (attached.is_uncalibrated(self.memory()), open && at_rest) {
            (true, _) => Spread::Unknown,
            (false, true) => Spread::Open,
            (false, false) => Spread::Narrow,
        }
    }

    /// The gripper after its last order; without an order, in its initial state.
    #[must_use]
    pub fn readiness(&self) -> Readiness {
        let idle =
            self.subordinates.gripper == Lower::Done || !self.state.grippers.are_ordered(self.memory());
        match (idle, self.attached().is_uncalibrated(self.memory())) {
            (true, true) => Readiness::Uncalibrated,
            (true, false) => Readiness::Ready,
            (false, _) => Readiness::Faulty,
        }
    }

    /// The gripper that is mated with the quick change.
    #[must_use]
    pub fn mate(&self) -> Mate {
        match self.memory().quick_change.status.end_effector_id {
            None => Mate::None,
            id if id == self.command.end_effector_id => Mate::Right,
            _ => Mate::Wrong,
        }
    }

    /// The locking ring, by its sensors.
    #[must_use]
    pub fn lock(&self) -> Lock {
        self.state.exchange.lock(self.inputs.tick, self.memory())
    }

    #[must_use]
    /// The holster.
    pub fn holster(&self) -> EmoveHolster {
        holster(self.command.end_effector_id, self.memory())
    }

    /// The position of the robot in the exchange.
    #[must_use]
    pub const fn along(&self) -> ExchangePosition {
        self.along
    }

    /// The fingers, for the path through the holster.
    #[must_use]
    pub fn shut(&self) -> Shut {
        shut(self.command, self.inputs)
    }

    /// The robot's place, relative to the command's location.
    #[must_use]
    pub fn at(&self) -> At {
        self.state.localization.at(self.command)
    }

    /// The position of the robot in a tool command at the drum.
    #[must_use]
    pub fn drum(&self) -> AtDrum {
        self.state.drum.at(self.command, self.inputs)
    }

    /// The zero reading of the force sensor.
    #[must_use]
    pub const fn bias(&self) -> Bias {
        self.state.drum.bias(self.memory())
    }

    #[must_use]
    /// The answer of vision.
    pub fn sight(&self) -> Sight {
        sight(self.state.localization.last_place(), self.inputs)
    }

    /// Knowledge of the next position of the camera.
    #[must_use]
    pub fn aim(&self) -> Knowledge {
        known(can_aim(self.command, self.inputs))
    }

    /// The open fingers, relative to the object's array.
    #[must_use]
    pub fn reach(&self) -> EmoveReach {
        self.state.vision.reach(self.command, self.inputs)
    }

    /// The attempts left for a picture.
    #[must_use]
    pub const fn tries(&self) -> Tries {
        self.state.vision.tries()
    }

    #[must_use]
    /// The link to the robot.
    pub const fn link(&self) -> EmoveLink {
        if self.memory().prim.status.link_running { EmoveLink::Up } else { EmoveLink::Down }
    }

    /// Status of Prim; done if the command does not need it.
    #[must_use]
    pub const fn prim(&self) -> Lower {
        self.subordinates.prim
    }

    #[must_use]
    /// Whether the fingers move.
    pub fn motion(&self) -> FingerMotion {
        let moving = self.state.grippers.are_moving(self.inputs.tick, self.memory());
        if moving { FingerMotion::Moving } else { FingerMotion::AtRest }
    }

    /// Quick change and gripper during a pause. Grip's PAUSE is done only after a calibration at the start is done
    /// (VI.3.1 UP-INIT). A missing gripper, or one attached since, needs no wait. A ring between its ends is at rest,
    /// too: ACCEPT decides which commands it prevents.
    #[must_use]
    pub fn tooling(&self) -> Tooling {
        let asked = self.state.grippers.are_ordered(self.memory());
        match (self.subordinates.ring, self.subordinates.gripper) {
            (Ring::Faulty, _) if self.lock() != Lock::Between => Tooling::RingFaulty,
            (Ring::Busy, _) => Tooling::Busy,
            (_, Lower::Error | Lower::Joystick | Lower::Lost) if asked => Tooling::GripFaulty,
            (_, Lower::Pending | Lower::Executing) => Tooling::Busy,
            (Ring::Faulty | Ring::Locked | Ring::Unlocked, _) => Tooling::Ready,
        }
    }

    /// Knowledge of the robot's place.
    #[must_use]
    pub fn place(&self) -> PlaceKnowledge {
        self.state.place_knowledge(self.inputs)
    }

    /// The gripper button of the joystick box, if it was pressed in this tick.
    #[must_use]
    pub fn button(&self) -> JoystickGrip {
        self.state.grippers.pressed(self.memory())
    }
}
