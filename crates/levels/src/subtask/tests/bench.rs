//! Subtask with doubles of E-move and the Active Pedestal, which complete or fail each order after a few ticks.

use geometry::pose::Pose;
use interfaces::{
    CommonMemory, EmoveOutputs, ExternalInputs, Header, PedestalOutputs, Reason, StatusReport,
    SubtaskOutputs,
    emove::{EmoveCommand, EmoveVerb, Holding, ObjectGrip},
    grip::Felt,
    pedestal::{PedestalCommand, PedestalReport, PedestalStatus, PedestalVerb},
    subtask::{SubtaskCommand, SubtaskVerb},
};
use rcs_core::{name::Name16, tick::Tick};
use taskdata::files::{EndEffId, TaskData};

use super::data::data;
use crate::{
    bench::{self, Tested, World},
    environment::{
        emove,
        worker::{Turn, Worker},
    },
    places::Missing,
    subtask::Subtask,
};

const WORK: u32 = 3; // ticks of a command

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DeliveryFault {
    Error(Reason),
    Hang,
    /// No answer, not even an echo.
    Silence,
    /// The joystick box becomes active (E-move); can't-do (pedestal).
    Special(Reason),
    NoEffect,
    Loss,
    /// QC-ATTACH attaches another gripper.
    OtherGripper(u8),
}

#[derive(Clone, Default)]
pub struct EmoveDouble {
    worker: Worker,
    pub outputs: EmoveOutputs,
    pub received: Vec<EmoveCommand>,
    pub mishap: Option<(EmoveVerb, DeliveryFault)>,
    pub ignores: bool,
}

impl EmoveDouble {
    fn step(&mut self, tick: Tick, command: &EmoveCommand) {
        let silent = self
            .mishap
            .is_some_and(|(verb, mishap)| verb == command.command && mishap == DeliveryFault::Silence);
        self.outputs.header = Header { stamp: tick, ..Header::default() };
        if silent {
            return;
        }
        match self.worker.turn(command.number, WORK) {
            Turn::Takes => {
                self.received.push(*command);
                emove::take(&mut self.outputs.status, command.number);
                self.outputs.status.reason = Reason::None;
            }
            Turn::Ends => self.end(command),
            Turn::Waits => {}
        }
        self.outputs.status.echo = self.worker.echo();
    }

    fn end(&mut self, command: &EmoveCommand) {
        let mishap = self.mishap.filter(|(verb, _)| *verb == command.command).map(|(_, mishap)| mishap);
        let status = &mut self.outputs.status;
        status.report = StatusReport::Done;
        match mishap {
            _ if self.ignores => {}
            None => emove::effect(status, command),
            Some(DeliveryFault::Error(reason)) => {
                (status.report, status.reason) = (StatusReport::Error, reason)
            }
            Some(DeliveryFault::Special(reason)) => {
                (status.report, status.reason) = (StatusReport::JoystickOn, reason)
            }
            Some(DeliveryFault::Hang | DeliveryFault::Silence) => status.report = StatusReport::Executing,
            Some(DeliveryFault::NoEffect) => {}
            Some(DeliveryFault::Loss) => {
                emove::effect(status, command);
                status.held = Holding::Nothing;
            }
            Some(DeliveryFault::OtherGripper(id)) => status.end_effector_id = Some(id),
        }
    }

    /// The gripper holds an object, or nothing if the name is empty.
    pub fn hold(&mut self, object: &str, grip: i32) {
        let status = &mut self.outputs.status;
        match Name16::clipped(object) {
            object if object.is_empty() => status.held = Holding::Nothing,
            object => emove::grasp(status, ObjectGrip { object, grip }),
        }
    }
}

#[derive(Clone, Default)]
pub struct PedestalDouble {
    worker: Worker,
    pub outputs: PedestalOutputs,
    pub received: Vec<PedestalCommand>,
    pub mishap: Option<(PedestalVerb, DeliveryFault)>,
    pub part: i32,   // width of the part at the hand, 0.01 in
    pub slips: bool, // the hand loses the object while the table turns
    pub ignores: bool,
}

impl PedestalDouble {
    fn step(&mut self, tick: Tick, command: &PedestalCommand) {
        let mishap = self.mishap.filter(|(verb, _)| *verb == command.command).map(|(_, mishap)| mishap);
        let outputs = &mut self.outputs;
        if mishap == Some(DeliveryFault::Silence) {
            return;
        }
        outputs.header = Header { stamp: tick, ..Header::default() };
        let status = &mut outputs.status;
        match self.worker.turn(command.number, WORK) {
            Turn::Takes => {
                self.received.push(*command);
                (status.report, status.reason) = (PedestalReport::Executing, Reason::None);
            }
            Turn::Ends => {
                (status.report, status.reason) = match mishap {
                    Some(DeliveryFault::Error(reason)) => (PedestalReport::Error, reason),
                    Some(DeliveryFault::Special(reason)) => (PedestalReport::CannotDo, reason),
                    Some(DeliveryFault::Hang) => (PedestalReport::Executing, Reason::None),
                    _ => (PedestalReport::Done, Reason::None),
                };
                if mishap != Some(DeliveryFault::NoEffect) && !self.ignores {
                    Self::effect(status, command, self.part, self.slips);
                }
            }
            Turn::Waits => {}
        }
        status.echo = self.worker.echo();
    }

    /// The effect of a completed order. `part` is the size of the part within reach of the hand.
    const fn effect(status: &mut PedestalStatus, command: &PedestalCommand, part: i32, slips: bool) {
        match command.command {
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
                let holds = part > command.grasp_size;
                status.grip_size = if holds { part } else { command.grasp_size };
                status.felt = if holds { Felt::Something } else { Felt::Nothing };
                status.gripped = true;
            }
            PedestalVerb::Flip if slips => (status.grip_size, status.felt) = (0, Felt::Nothing),
            PedestalVerb::Flip => {
                if let Some(position) = status.table_position {
                    status.table_position = Some(position + command.table_angle);
                }
            }
            PedestalVerb::None | PedestalVerb::Pause => {}
        }
    }
}

pub type Bench<'d> = bench::Bench<Subtask, Below, TaskData<'d>>;

#[derive(Clone)]
pub struct Below {
    pub emove: EmoveDouble,
    pub pedestal: PedestalDouble,
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

    pub fn sent(&self) -> Vec<&'static str> {
        self.world.emove.received.iter().map(|command| command.command.text()).collect()
    }

    pub fn sent_to_pedestal(&self) -> Vec<&'static str> {
        self.world.pedestal.received.iter().map(|command| command.command.text()).collect()
    }

    pub fn fixing() -> Self
    where
        Self: Default,
    {
        let mut bench = Self::grasped("PART", 1);
        bench.command(SubtaskVerb::FixGrip, "PART", (1, -1), "");
        bench
    }

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

pub const DONE: (StatusReport, Reason) = (StatusReport::Done, Reason::None);
