//! The commands to the gripper processes (V.2: E-move coordinates the robot with "various gripper processes").
//!
//! The parts gripper controls an opening or a force and accepts five commands (VI.3.1). V-gripper and tool gripper
//! only open or close, and accept four (VI.4.1, VI.5). The tables of E-move do not depend on the gripper: they send a
//! [`FingerVerb`] and read one [`Lower`]. Only the process of the attached gripper is stepped.
//!
//! | order     | Grip                  | V-Grip, Tool-Grip                                          |
//! |-----------|-----------------------|------------------------------------------------------------|
//! | Pause     | PAUSE                 | PAUSE, with the size commanded last                        |
//! | Stand     | POSITION              | POSE; GRASP if the opening is nearer to the closed stop    |
//! | Release   | OPEN-GRIP             | RELEASE                                                    |
//! | Grasp     | CLOSE-GRIP            | GRASP                                                      |
//! | Calibrate | UP-INIT               | PAUSE: there is nothing to calibrate                       |
//!
//! Fingers that stop at the wrong end also report `opened` or `closed` (VI.4.2); E-move treats that as an error.

use interfaces::{
    CommonMemory, EmoveOutputs, Reason,
    grip::{GripCommand, GripVerb},
    jaws::{JawsCommand, JawsReport, JawsVerb},
    prim::JoystickGrip,
};
use rcs_core::{
    Plain,
    handshake::{Commander, Lower},
    tick::Tick,
};

use super::gripper::EmoveGripper;

/// A command to the attached gripper, independent of its type.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum FingerVerb {
    /// Nothing yet.
    #[text = ""]
    None,
    /// Leave the fingers as they are.
    Pause,
    /// Bring the fingers to an opening with no object between them.
    Stand,
    /// Open and release.
    Release,
    /// Close on an object.
    Grasp,
    /// Calibrate the sensors.
    Calibrate,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FingerOrder {
    pub order: FingerVerb,
    pub opening: i32, // 0.01 in; for a grasp, the size of the object
    pub force: i32,   // lb
}

impl FingerOrder {
    #[must_use]
    pub const fn to(order: FingerVerb, opening: i32) -> Self {
        Self { order, opening, force: 0 }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct Grippers {
    parts: Commander,
    v: Commander,
    tool: Commander,
    to: EmoveGripper, // the gripper that has the last order
    order: FingerVerb,
    size: i32,            // the last size commanded to jaws, 0.01 in
    closing: bool,        // the last command closes jaws
    button: JoystickGrip, // the button in the previous tick: only a new press acts
}

impl Grippers {
    /// Follow the echoes until the first command.
    pub fn start(&mut self, tick: Tick, memory: &CommonMemory) {
        let written = &memory.emove;
        self.parts.start_from(tick, written.grip.number, memory.grip.status.echo);
        self.v.start_from(tick, written.v_grip.number, memory.v_grip.status.echo);
        self.tool.start_from(tick, written.tool_grip.number, memory.tool_grip.status.echo);
    }

    /// After a restart the attached gripper may still execute an earlier command.
    pub fn adopt(&mut self, memory: &CommonMemory) {
        let (attached, written) = (EmoveGripper::attached(memory), &memory.emove);
        self.order = match attached {
            EmoveGripper::None => return,
            EmoveGripper::Parts => match written.grip.command {
                GripVerb::None => return,
                GripVerb::Pause => FingerVerb::Pause,
                GripVerb::Position => FingerVerb::Stand,
                GripVerb::OpenGrip => FingerVerb::Release,
                GripVerb::CloseGrip => FingerVerb::Grasp,
                GripVerb::UpInit => FingerVerb::Calibrate,
            },
            EmoveGripper::V | EmoveGripper::Tool => {
                let jaws = if attached == EmoveGripper::V { &written.v_grip } else { &written.tool_grip };
                self.size = jaws.size;
                match jaws.command {
                    JawsVerb::None => return,
                    JawsVerb::Pause => FingerVerb::Pause,
                    JawsVerb::Pose => FingerVerb::Stand,
                    JawsVerb::Release => FingerVerb::Release,
                    JawsVerb::Grasp => FingerVerb::Grasp,
                }
            }
        };
        (self.to, self.closing) = (attached, self.order == FingerVerb::Grasp);
    }

    #[must_use]
    pub const fn order(&self) -> FingerVerb {
        self.order
    }

    #[must_use]
    pub fn are_ordered(&self, memory: &CommonMemory) -> bool {
        self.to == EmoveGripper::attached(memory)
    }

    /// The process of a new gripper wakes, and does not answer commands from before it slept.
    pub fn note_gripper(&mut self, memory: &CommonMemory) {
        if EmoveGripper::attached(memory) != EmoveGripper::None {
            self.to = EmoveGripper::None;
        }
    }

    /// The gripper button of the joystick box, in the tick in which it is pressed.
    #[must_use]
    pub fn pressed(&self, memory: &CommonMemory) -> JoystickGrip {
        match memory.prim.status.joystick_grip {
            pressed if pressed == self.button => JoystickGrip::None,
            pressed => pressed,
        }
    }

    pub const fn note_button(&mut self, memory: &CommonMemory) {
        self.button = memory.prim.status.joystick_grip;
    }

    #[must_use]
    pub fn are_moving(&self, tick: Tick, memory: &CommonMemory) -> bool {
        let busy = matches!(self.status(tick, memory), Lower::Pending | Lower::Executing);
        busy && !matches!(self.order, FingerVerb::None | FingerVerb::Pause)
    }

    /// Without a gripper, or while it sleeps, the order is only recorded.
    pub fn send(
        &mut self,
        request: FingerOrder,
        tick: Tick,
        memory: &CommonMemory,
        outputs: &mut EmoveOutputs,
    ) {
        let attached = EmoveGripper::attached(memory);
        self.to = if attached.is_asleep(memory) { EmoveGripper::None } else { attached };
        self.order = request.order;
        match self.to {
            EmoveGripper::None => {}
            EmoveGripper::Parts => {
                outputs.grip = GripCommand {
                    number: self.commander(self.to).send(tick),
                    command: match request.order {
                        FingerVerb::None | FingerVerb::Pause => GripVerb::Pause,
                        FingerVerb::Stand => GripVerb::Position,
                        FingerVerb::Release => GripVerb::OpenGrip,
                        FingerVerb::Grasp => GripVerb::CloseGrip,
                        FingerVerb::Calibrate => GripVerb::UpInit,
                    },
                    force: request.force,
                    position: request.opening,
                    velocity: 0,
                    end_effector_id: self.to.id(),
                };
            }
            EmoveGripper::V => outputs.v_grip = self.jaws_command(request, tick),
            EmoveGripper::Tool => outputs.tool_grip = self.jaws_command(request, tick),
        }
    }

    fn jaws_command(&mut self, request: FingerOrder, tick: Tick) -> JawsCommand {
        let (closed, open) = self.to.stops().unwrap_or_default();
        let command = match request.order {
            FingerVerb::None | FingerVerb::Pause | FingerVerb::Calibrate => JawsVerb::Pause,
            FingerVerb::Stand if self.to.closes_for(request.opening) => JawsVerb::Grasp,
            FingerVerb::Stand => JawsVerb::Pose,
            FingerVerb::Release => JawsVerb::Release,
            FingerVerb::Grasp => JawsVerb::Grasp,
        };
        if command != JawsVerb::Pause {
            self.size = request.opening.clamp(closed, open);
            self.closing = command == JawsVerb::Grasp;
        }
        JawsCommand {
            number: self.commander(self.to).send(tick),
            command,
            force: request.force,
            size: self.size,
            velocity: 0,
            end_effector_id: self.to.id(),
        }
    }

    /// Progress of the last order; `Lost` if its gripper is no longer attached.
    #[must_use]
    pub fn status(&self, tick: Tick, memory: &CommonMemory) -> Lower {
        let attached = EmoveGripper::attached(memory);
        if attached != self.to {
            return Lower::Lost;
        }
        let (commander, jaws) = match attached {
            EmoveGripper::None => return Lower::Done,
            EmoveGripper::Parts => return self.parts.status_of(tick, &memory.grip),
            EmoveGripper::V => (&self.v, &memory.v_grip),
            EmoveGripper::Tool => (&self.tool, &memory.tool_grip),
        };
        let report = jaws.status.report;
        match commander.status_of(tick, jaws) {
            // Paused fingers may be at any opening: on an object of another size, or moved by hand.
            Lower::Error if self.order == FingerVerb::Pause && report == JawsReport::Stuck => Lower::Done,
            Lower::Done if self.moves_fingers() && report == self.wrong_end() => Lower::Error,
            lower => lower,
        }
    }

    const fn moves_fingers(&self) -> bool {
        matches!(self.order, FingerVerb::Stand | FingerVerb::Release | FingerVerb::Grasp)
    }

    const fn wrong_end(&self) -> JawsReport {
        if self.closing { JawsReport::Opened } else { JawsReport::Closed }
    }

    #[must_use]
    pub fn fault(&self, tick: Tick, memory: &CommonMemory) -> Reason {
        let attached = EmoveGripper::attached(memory);
        let said = attached.jaws(memory).map_or(memory.grip.status.reason, |jaws| jaws.status.reason);
        if attached != self.to || attached == EmoveGripper::None {
            Reason::WrongGripper
        } else if self.status(tick, memory) == Lower::Lost {
            Reason::NeighbourLost
        } else if said != Reason::None {
            said
        } else if attached == EmoveGripper::Parts {
            Reason::GripUnattainable
        } else {
            Reason::JawsStuck
        }
    }

    #[must_use]
    pub fn has_released(&self, tick: Tick, memory: &CommonMemory) -> bool {
        self.order == FingerVerb::Release && self.status(tick, memory) == Lower::Done
    }

    /// Without a gripper, the command of the parts gripper. Searches renumber the commands (docs/evidence.md).
    pub const fn commander(&mut self, of: EmoveGripper) -> &mut Commander {
        match of {
            EmoveGripper::None | EmoveGripper::Parts => &mut self.parts,
            EmoveGripper::V => &mut self.v,
            EmoveGripper::Tool => &mut self.tool,
        }
    }
}
