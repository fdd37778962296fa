//! Subtask with doubles of the processes below it: an E-move and an Active Pedestal that do at once what they
//! are told, or fail as a test wants.

use geometry::pose::Pose;
use interfaces::{
    CommonMemory, EmoveOutputs, ExternalInputs, Header, PedestalOutputs, Reason, StatusReport,
    SubtaskOutputs,
    emove::{EmoveCommand, EmoveVerb, Holding, LocatedObject, ObjectGrip, PlacedObject, Standing},
    grip::Felt,
    pedestal::{PedestalCommand, PedestalReport, PedestalVerb},
    subtask::{SubtaskCommand, SubtaskVerb},
};
use rcs_core::{
    handshake::{Arrival, Receiver},
    name::Name16,
    tick::Tick,
};
use taskdata::files::{EndEffId, TaskData};

use super::data::data;
use crate::{
    bench::{self, Tested, World},
    places::Missing,
    subtask::Subtask,
};

/// Ticks that a double takes for a command.
const WORK: u32 = 3;

/// How a double ends a command that a test has singled out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mishap {
    /// With an error.
    Error(Reason),
    /// It does not end.
    Hang,
    /// It is not even echoed.
    Silence,
    /// The joystick box becomes active (E-move); can't-do (pedestal).
    Special(Reason),
    /// It is reported done and has had no effect.
    NoEffect,
    /// It is done, and the object is no longer held.
    Loss,
    /// QC-ATTACH: another gripper comes on.
    OtherGripper(u8),
}

/// The E-move that a test sees.
#[derive(Clone, Default)]
pub struct EmoveDouble {
    receiver: Receiver,
    left: u32,
    pub outputs: EmoveOutputs,
    pub received: Vec<EmoveCommand>,
    pub mishap: Option<(EmoveVerb, Mishap)>,
    /// It reports done and does nothing.
    pub ignores: bool,
}

impl EmoveDouble {
    fn step(&mut self, tick: Tick, command: &EmoveCommand) {
        let silent =
            self.mishap.is_some_and(|(verb, mishap)| verb == command.command && mishap == Mishap::Silence);
        self.outputs.header = Header { stamp: tick, ..Header::default() };
        if silent {
            return;
        }
        match self.receiver.observe(command.number) {
            Arrival::New => {
                self.received.push(*command);
                self.left = WORK;
                self.outputs.status.report = StatusReport::Executing;
                self.outputs.status.reason = Reason::None;
            }
            Arrival::Same if self.left > 0 => {
                self.left -= 1;
                if self.left == 0 {
                    self.end(command);
                }
            }
            _ => {}
        }
        self.outputs.status.echo = self.receiver.echo;
    }

    fn end(&mut self, command: &EmoveCommand) {
        let mishap = self.mishap.filter(|(verb, _)| *verb == command.command).map(|(_, mishap)| mishap);
        let status = &mut self.outputs.status;
        status.report = StatusReport::Done;
        match mishap {
            _ if self.ignores => {}
            None => self.effect(command),
            Some(Mishap::Error(reason)) => (status.report, status.reason) = (StatusReport::Error, reason),
            Some(Mishap::Special(reason)) => {
                (status.report, status.reason) = (StatusReport::JoystickOn, reason)
            }
            Some(Mishap::Hang | Mishap::Silence) => status.report = StatusReport::Executing,
            Some(Mishap::NoEffect) => {}
            Some(Mishap::Loss) => {
                self.effect(command);
                self.hold("", 0);
            }
            Some(Mishap::OtherGripper(id)) => status.end_effector_id = Some(id),
        }
    }

    fn effect(&mut self, command: &EmoveCommand) {
        match command.command {
            EmoveVerb::GraspObj => self.hold(command.object.unwrap_or_default().as_str(), command.grip),
            EmoveVerb::AcquireTool => {
                self.hold(command.object.unwrap_or_default().as_str(), command.grip);
                self.outputs.status.drum = true;
            }
            EmoveVerb::InsertTool => self.outputs.status.drum = true,
            EmoveVerb::RemoveTool => self.outputs.status.drum = false,
            EmoveVerb::Release => {
                if let Some(held) = self.outputs.status.held.object() {
                    self.outputs.status.placed =
                        Some(PlacedObject { object: held, grip: command.grip, site: command.site });
                }
                self.hold("", 0);
            }
            EmoveVerb::ReleaseTool => {
                self.hold("", 0);
                self.outputs.status.drum = false;
            }
            EmoveVerb::LocateObj => {
                self.outputs.status.located =
                    command.object.map(|object| LocatedObject { object, site: command.site });
            }
            EmoveVerb::QcDetach => {
                (self.outputs.status.end_effector_id, self.outputs.status.exchange) = (None, None);
            }
            EmoveVerb::QcAttach => {
                self.outputs.status.end_effector_id = command.end_effector_id;
                self.outputs.status.exchange = None;
            }
            EmoveVerb::MovToLoc | EmoveVerb::MovToObj | EmoveVerb::MovObjTo | EmoveVerb::MovToHol => {
                self.outputs.status.at = Some(Standing {
                    site: command.site,
                    grip: Some(command.grip).filter(|_| command.command != EmoveVerb::MovToLoc),
                });
            }
            _ => {}
        }
    }

    /// The gripper holds an object; an empty name for none.
    pub fn hold(&mut self, object: &str, grip: i32) {
        let object = Name16::new(object).unwrap();
        let held = Holding::Object(ObjectGrip { object, grip });
        self.outputs.status.held = if object.is_empty() {
            Holding::Nothing
        } else {
            self.outputs.status.located = None;
            held
        };
    }
}

/// The Active Pedestal that a test sees.
#[derive(Clone, Default)]
pub struct PedestalDouble {
    receiver: Receiver,
    left: u32,
    pub outputs: PedestalOutputs,
    pub received: Vec<PedestalCommand>,
    pub mishap: Option<(PedestalVerb, Mishap)>,
    /// Size of what is in the hand's reach, 0.01 in.
    pub part: i32,
    /// The hand loses the object while the table turns.
    pub slips: bool,
    /// It reports done and does nothing.
    pub ignores: bool,
}

impl PedestalDouble {
    fn step(&mut self, tick: Tick, command: &PedestalCommand) {
        let mishap = self.mishap.filter(|(verb, _)| *verb == command.command).map(|(_, mishap)| mishap);
        let outputs = &mut self.outputs;
        if mishap == Some(Mishap::Silence) {
            return;
        }
        outputs.header = Header { stamp: tick, ..Header::default() };
        let status = &mut outputs.status;
        match self.receiver.observe(command.number) {
            Arrival::New => {
                self.received.push(*command);
                self.left = WORK;
                (status.report, status.reason) = (PedestalReport::Executing, Reason::None);
            }
            Arrival::Same if self.left > 0 => {
                self.left -= 1;
                if self.left == 0 {
                    (status.report, status.reason) = match mishap {
                        Some(Mishap::Error(reason)) => (PedestalReport::Error, reason),
                        Some(Mishap::Special(reason)) => (PedestalReport::CannotDo, reason),
                        Some(Mishap::Hang) => (PedestalReport::Executing, Reason::None),
                        _ => (PedestalReport::Done, Reason::None),
                    };
                    match command.command {
                        _ if mishap == Some(Mishap::NoEffect) || self.ignores => {}
                        PedestalVerb::PreGrip => {
                            status.grip_size = command.grasp_size;
                            status.table_position = Some(command.table_angle);
                            (status.felt, status.gripped) = (Felt::Nothing, false);
                        }
                        PedestalVerb::Release => {
                            status.grip_size = command.grasp_size;
                            (status.felt, status.gripped) = (Felt::Nothing, false);
                        }
                        PedestalVerb::Grip => {
                            let holds = self.part > command.grasp_size;
                            status.grip_size = self.part.max(command.grasp_size);
                            status.felt = if holds { Felt::Something } else { Felt::Nothing };
                            status.gripped = true;
                        }
                        PedestalVerb::Flip if !self.slips => {
                            status.table_position =
                                status.table_position.map(|position| position + command.table_angle);
                        }
                        PedestalVerb::Flip => (status.grip_size, status.felt) = (0, Felt::Nothing),
                        _ => {}
                    }
                }
            }
            _ => {}
        }
        status.echo = self.receiver.echo;
    }
}

/// Subtask, and the doubles.
pub type Bench<'d> = bench::Bench<Subtask, Below, TaskData<'d>>;

#[derive(Clone)]
pub struct Below {
    pub emove: EmoveDouble,
    pub pedestal: PedestalDouble,
    /// Task writes no buffers.
    pub task_is_lost: bool,
}

impl World<Subtask> for Below {
    fn act(&mut self, tick: Tick, before: &CommonMemory, after: &mut CommonMemory, _: &mut ExternalInputs) {
        self.emove.step(tick, &before.subtask.emove);
        self.pedestal.step(tick, &before.subtask.pedestal);
        if !self.task_is_lost {
            after.task.header.stamp = tick;
        }
        (after.emove, after.pedestal) = (self.emove.outputs, self.pedestal.outputs);
    }
}

impl<'d> Tested<TaskData<'d>> for Subtask {
    type Order = SubtaskCommand;
    type End = (StatusReport, Reason);
    const LONGEST: u64 = 300;

    fn order(memory: &mut CommonMemory, order: SubtaskCommand, number: u32) {
        memory.task.subtask = SubtaskCommand { number, ..order };
    }

    fn end(outputs: &SubtaskOutputs) -> Option<(StatusReport, Reason)> {
        let status = outputs.status;
        (status.report != StatusReport::Executing).then_some((status.report, status.reason))
    }
}

impl Default for Bench<'static> {
    fn default() -> Self {
        Self::of(data())
    }
}

impl<'d> Bench<'d> {
    /// A bench with the parts gripper attached, after one tick in which nothing was commanded.
    pub fn of(data: TaskData<'d>) -> Self {
        let pedestal = PedestalDouble { part: 255, ..PedestalDouble::default() };
        let mut bench =
            Self::with(Below { emove: EmoveDouble::default(), pedestal, task_is_lost: false }, data);
        bench.world.emove.outputs.status.end_effector_id = Some(1);
        let status = &mut bench.world.pedestal.outputs.status;
        (status.felt, status.table_position) = (Felt::Nothing, Some(-200));
        bench.step();
        bench
    }

    /// Write a new command for an object at a location with the grip for source and destination.
    pub fn command(&mut self, verb: SubtaskVerb, object: &str, grips: (i32, i32), location: &str) {
        let object = Name16::new(object).unwrap();
        let mut poses = self.memory.task.poses;
        let place = (!location.is_empty()).then(|| {
            let name = Name16::new(location).unwrap();
            self.data.resolve_location(&name, None, None::<&Name16>).map_err(Missing::from).unwrap()
        });
        let number = self.memory.task.subtask.number + 1;
        let mut command = SubtaskCommand {
            command: verb,
            object: Some(object).filter(|object| !object.is_empty()),
            end_effector_id: self
                .data
                .obj_grips(&object)
                .map(|grips| grips.endeff_id as u8)
                .filter(|id| *id != 0),
            source_grip: grips.0,
            destination_grip: grips.1,
            object_parameters: self.data.object(&object, grips.0).map_or(EndEffId::NULL, |(id, _)| id),
            ..SubtaskCommand::default()
        };
        if let Some(place) = place {
            poses[0].number = Some(0x8100_0000 + number);
            poses[0].pose = Pose::from_frame(&place.frame);
            command.site = place.site();
            command.pose = poses[0].number;
        }
        self.memory.task.poses = poses;
        self.send(command);
    }

    /// Command and finish.
    pub fn run(
        &mut self,
        verb: SubtaskVerb,
        object: &str,
        grips: (i32, i32),
        location: &str,
    ) -> (StatusReport, Reason) {
        self.world.emove.received.clear();
        self.world.pedestal.received.clear();
        self.command(verb, object, grips, location);
        self.finish()
    }

    /// The words that E-move was sent since the last command began.
    pub fn sent(&self) -> Vec<&'static str> {
        self.world.emove.received.iter().map(|command| command.command.text()).collect()
    }

    /// The words that the pedestal was sent.
    pub fn sent_to_pedestal(&self) -> Vec<&'static str> {
        self.world.pedestal.received.iter().map(|command| command.command.text()).collect()
    }

    /// FIX-GRIP of the part from grip 1 to grip -1 has been sent to a robot that holds it.
    pub fn fixing() -> Self
    where
        Self: Default,
    {
        let mut bench = Self::grasped("PART", 1);
        bench.command(SubtaskVerb::FixGrip, "PART", (1, -1), "");
        bench
    }

    /// An object is held that Subtask has seen grasped with a grip.
    pub fn grasped(object: &str, grip: i32) -> Self
    where
        Self: Default,
    {
        let mut bench = Self::default();
        bench.world.emove.outputs.status.end_effector_id = Some(
            bench.data.obj_grips(&Name16::new(object).unwrap()).map_or(1, |grips| grips.endeff_id as u8),
        );
        bench.step();
        assert_eq!(bench.run(SubtaskVerb::GetObject, object, (grip, 0), "PFIXTURE"), DONE);
        bench
    }
}

/// How a command ends that succeeds.
pub const DONE: (StatusReport, Reason) = (StatusReport::Done, Reason::None);
