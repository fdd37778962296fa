//! Task with test doubles of Subtask and of the Data System. Subtask completes each order after a few ticks.

use interfaces::{
    CommonMemory, DataBaseCommand, DataBaseStatus, ExternalInputs, Header, HwsCommand, Reason, StatusReport,
    SubtaskOutputs, TaskOutputs,
    data_base::{DataBaseReport, DataBaseVerb},
    emove::{Holding, ObjectGrip, PlacedObject, Standing},
    hws::HwsReport,
    location::Site,
    subtask::{SubtaskCommand, SubtaskVerb},
};
use rcs_core::{
    handshake::{Arrival, Receiver},
    name::{Name10, Name16},
    tick::Tick,
};
use taskdata::files::TaskData;

use crate::{
    bench::{self, Tested, World},
    environment::worker::{Turn, Worker},
    subtask::tests::data::data,
    task::Task,
};

const WORK: u32 = 3; // ticks of a command

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DeliveryFault {
    Error(Reason),
    /// No answer, not even an echo.
    Silence,
}

#[derive(Clone, Default)]
pub struct SubtaskDouble {
    worker: Worker,
    last: SubtaskCommand,
    pub outputs: SubtaskOutputs,
    pub received: Vec<SubtaskCommand>,
    pub mishap: Option<(SubtaskVerb, DeliveryFault)>,
    pub joystick: bool,
    /// The robot is at no known place during a motion and after an interrupted one.
    pub loses_place: bool,
}

impl SubtaskDouble {
    fn step(&mut self, tick: Tick, command: &SubtaskCommand) {
        let mishap = self.mishap.filter(|(verb, _)| *verb == command.command).map(|(_, mishap)| mishap);
        self.outputs.header = Header { stamp: tick, ..Header::default() };
        if mishap == Some(DeliveryFault::Silence) {
            return;
        }
        let is_replaced = self.worker.is_working();
        let turn = self.worker.turn(command.number, WORK);
        // A new command does not stop opening fingers.
        let last = self.last;
        let opens = matches!(last.command, SubtaskVerb::Release | SubtaskVerb::ReleaseTool);
        if turn == Turn::Takes && is_replaced && opens {
            self.effect(&last);
        }
        let status = &mut self.outputs.status;
        match turn {
            Turn::Takes => {
                self.received.push(*command);
                self.last = *command;
                let stands = matches!(
                    command.command,
                    SubtaskVerb::Pause | SubtaskVerb::GetEndeff | SubtaskVerb::Release
                );
                if self.loses_place && !stands {
                    status.at = None;
                }
                (status.report, status.reason) = (StatusReport::Executing, Reason::None);
            }
            Turn::Ends => {
                (status.report, status.reason) = match mishap {
                    Some(DeliveryFault::Error(reason)) => (StatusReport::Error, reason),
                    _ => (StatusReport::Done, Reason::None),
                };
                if mishap.is_none() {
                    self.effect(command);
                }
            }
            Turn::Waits => {}
        }
        let status = &mut self.outputs.status;
        status.echo = self.worker.echo();
        if self.joystick {
            self.worker.stop();
            (status.report, status.reason) = (StatusReport::JoystickOn, Reason::JoystickOn);
        } else if status.report == StatusReport::JoystickOn {
            status.report = StatusReport::Error;
        }
    }

    fn effect(&mut self, command: &SubtaskCommand) {
        let status = &mut self.outputs.status;
        match command.command {
            SubtaskVerb::GetEndeff if command.end_effector_id.is_some() => {
                status.end_effector_id = command.end_effector_id;
            }
            SubtaskVerb::GetObject => {
                self.hold(command.object.unwrap_or_default().as_str());
                self.grip(command.source_grip);
            }
            SubtaskVerb::AcquireTool => {
                self.hold(command.object.unwrap_or_default().as_str());
                self.stand("TOOL-TRNS");
            }
            SubtaskVerb::InsertTool => self.stand("TOOL-TRNS"),
            SubtaskVerb::Release => self.let_go(),
            SubtaskVerb::ReleaseTool => {
                self.let_go();
                self.outputs.status.drum = false;
            }
            SubtaskVerb::RemoveTool => self.outputs.status.drum = false,
            SubtaskVerb::PlaceObj => {
                self.hold("");
                self.outputs.status.placed = Some(PlacedObject {
                    object: command.object.unwrap_or_default(),
                    grip: command.destination_grip,
                    site: command.site,
                });
                self.stand_at(command, Some(command.destination_grip));
            }
            SubtaskVerb::GotoDest | SubtaskVerb::GotoEndpt => self.stand_at(command, None),
            SubtaskVerb::MoveObjToDest => self.stand_at(command, Some(command.destination_grip)),
            SubtaskVerb::Position => self.stand_at(command, Some(command.source_grip)),
            SubtaskVerb::FixGrip => {
                status.pedestal_part = false;
                self.hold(command.object.unwrap_or_default().as_str());
                self.grip(command.destination_grip);
            }
            _ => {}
        }
    }

    fn let_go(&mut self) {
        let (held, at) = (self.outputs.status.held, self.outputs.status.at.unwrap_or_default());
        self.hold("");
        if let Holding::Object(ObjectGrip { object, grip }) = held {
            self.outputs.status.placed = Some(PlacedObject { object, grip, site: at.site });
        }
    }

    fn stand_at(&mut self, command: &SubtaskCommand, grip: Option<i32>) {
        self.stand(command.site.location.as_str());
        if let Some(at) = &mut self.outputs.status.at {
            (at.site, at.grip) = (command.site, grip);
        }
    }

    pub fn hold(&mut self, object: &str) {
        let object = Name16::new(object).unwrap();
        let held = Holding::Object(ObjectGrip { object, grip: 1 });
        if !object.is_empty() {
            self.outputs.status.placed = None;
        }
        self.outputs.status.held = if object.is_empty() { Holding::Nothing } else { held };
    }

    fn grip(&mut self, grip: i32) {
        if let Holding::Object(held) = &mut self.outputs.status.held {
            held.grip = grip;
        }
    }

    /// If the name is empty, the robot is at no known place. At the drum's location it is in the drum.
    pub fn stand(&mut self, location: &str) {
        let location = Name10::new(location).unwrap();
        let site = Site { location, ..Site::default() };
        self.outputs.status.at = site.name().map(|_| Standing { site, grip: None });
        self.outputs.status.drum = location.as_str() == "TOOL-TRNS";
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Answer {
    #[default]
    Absent, // no answer
    After(u64), // done after these ticks
    Refuse,
}

#[derive(Clone, Default)]
pub struct DataSystem {
    receiver: Receiver,
    since: u64,
    pub status: DataBaseStatus,
    pub received: Vec<DataBaseCommand>,
    pub answer: Answer,
    pub except: Option<(DataBaseVerb, Answer)>,
}

impl DataSystem {
    fn step(&mut self, tick: Tick, command: &DataBaseCommand) {
        if self.receiver.observe(command.number) == Arrival::New {
            self.received.push(*command);
            self.since = tick.0;
        }
        let except = self.except.filter(|(verb, _)| *verb == command.command).map(|(_, answer)| answer);
        let report = match except.unwrap_or(self.answer) {
            Answer::Absent => return,
            Answer::After(ticks) if tick.0 - self.since < ticks => DataBaseReport::Executing,
            Answer::After(_) => DataBaseReport::Done,
            Answer::Refuse => DataBaseReport::Refused,
        };
        if self.receiver.echo != 0 {
            self.status = DataBaseStatus { echo: self.receiver.echo, report };
        }
    }
}

pub type Bench<'d> = bench::Bench<Task, Below, TaskData<'d>>;

#[derive(Clone, Default)]
pub struct Below {
    pub subtask: SubtaskDouble,
    pub data_system: DataSystem,
}

impl World<Task> for Below {
    fn act(
        &mut self,
        tick: Tick,
        before: &CommonMemory,
        after: &mut CommonMemory,
        external: &mut ExternalInputs,
    ) {
        self.subtask.step(tick, &before.task.subtask);
        self.data_system.step(tick, &after.task.data_base);
        after.subtask = self.subtask.outputs;
        external.data_base = self.data_system.status;
    }
}

impl<'d> Tested<TaskData<'d>> for Task {
    type Order = ();
    type End = (HwsReport, Reason);
    const LONGEST: u64 = 3000;

    fn order(_: &mut CommonMemory, (): (), _: u32) {}

    fn number_outside(external: &ExternalInputs) -> u32 {
        external.hws.number
    }

    fn end(outputs: &TaskOutputs) -> Option<(HwsReport, Reason)> {
        let status = outputs.status;
        (status.report != HwsReport::Executing).then_some((status.report, status.reason))
    }
}

impl Default for Bench<'static> {
    fn default() -> Self {
        Self::of(data())
    }
}

impl<'d> Bench<'d> {
    /// A bench with the parts gripper attached and a vise that reports a clamped part, after two idle ticks.
    pub fn of(data: TaskData<'d>) -> Self {
        let mut bench = Self::with(Below::default(), data);
        bench.world.subtask.outputs.status.end_effector_id = Some(1);
        bench.external.devices.clamping = Some(Name10::clipped("PFIXTURE"));
        bench.wait(2);
        bench
    }

    pub fn connected() -> Self
    where
        Self: Default,
    {
        let mut bench = Self::default();
        bench.world.data_system.answer = Answer::After(2);
        assert_eq!(bench.run("STARTUP -- 0 -- 0 0 -- 0 -- 0"), FINISHED);
        bench.world.data_system.received.clear();
        bench
    }

    /// Write a new command: the words after `==` of a job line (Figure VIII.4).
    pub fn command(&mut self, line: &str) {
        let words: Vec<&str> = line.split_whitespace().collect();
        let name = |at: usize| match words[at] {
            "--" => None,
            word => Some(Name16::new(word).unwrap()),
        };
        let number = |at: usize| words[at].parse().unwrap();
        let sector = |at: usize| Some(number(at)).filter(|sector| *sector != 0);
        self.external.hws = HwsCommand {
            number: self.external.hws.number + 1,
            command: name(0).unwrap(),
            object: name(1),
            serial: Name16::new("S-17").unwrap(),
            source_grip: number(2),
            source: name(3),
            source_sector: sector(4),
            destination_grip: number(5),
            destination: name(6),
            destination_sector: sector(7),
            end_at: name(8),
            end_at_sector: sector(9),
            ..HwsCommand::default()
        };
    }

    pub fn run(&mut self, line: &str) -> (HwsReport, Reason) {
        self.world.subtask.received.clear();
        self.world.data_system.received.clear();
        self.command(line);
        self.finish()
    }

    /// Benches in which a line is interrupted after each tick, by another line or by a restart.
    pub fn interrupted(mut self, line: &str, by: Option<&str>) -> impl Iterator<Item = Self> {
        self.command(line);
        self.at_every_tick().map(move |mut copy| {
            match by {
                Some(other) => copy.command(other),
                None => copy.restart(),
            }
            copy.finish();
            copy.wait(10);
            copy
        })
    }

    pub fn sent(&self) -> Vec<&'static str> {
        self.world.subtask.received.iter().map(|command| command.command.text()).collect()
    }

    pub fn asked(&self) -> Vec<&'static str> {
        self.world.data_system.received.iter().map(|command| command.command.text()).collect()
    }

    pub fn set(&mut self, gripper: u8, object: &str, at: &str) {
        self.world.subtask.outputs.status.end_effector_id = (gripper != 0).then_some(gripper);
        self.world.subtask.hold(object);
        self.world.subtask.stand(at);
        if let Some(at) = &mut self.world.subtask.outputs.status.at {
            let location = at.site.location;
            at.site = Site::point(location, self.data.locpt_named(&location).unwrap_or_default());
            at.grip = (!object.is_empty()).then_some(1);
        }
        self.step();
    }
}

pub const FINISHED: (HwsReport, Reason) = (HwsReport::Finished, Reason::None);
