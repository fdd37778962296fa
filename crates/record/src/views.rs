//! The state of a run outside the buffers: job, commander, robot controller, parts and places of the cell. Each has a
//! channel.
//!
//! A message has the whole state, so that a reader needs only the last one. It is written when the state
//! changes, and repeated with the buffers.

use std::{
    borrow::Cow,
    io::{Seek, Write},
};

use mcap::McapResult;
use rcs_core::tick::Tick;

use crate::{
    channels::Output,
    proto::typed::{self, Message, messages},
    reader::Log,
};

pub const JOB_LINES: &str = "/job/lines";
pub const JOB_STATE: &str = "/job/state";
pub const COMMANDER: &str = "/operator/state";
pub const CONTROLLER: &str = "/cell/controller";
pub const PARTS: &str = "/cell/parts";
pub const PLACES: &str = "/cell/places";
pub const FIELD: &str = "/field";

messages! {
    /// A line of a job.
    JobLine {
        /// Its number in the job, from 1: comments and empty lines are not counted.
        number: u32,
        /// The line as written, without its comment.
        text: String,
        /// It is a command for Task, not an action of the workstation.
        is_command: bool,
        /// The command must fail.
        expects_error: bool,
    }

    /// The lines of a job. An operator can replace the rest of a job during the run.
    JobLines {
        /// Name of the job.
        name: String,
        /// The lines, in order.
        lines: Vec<JobLine>,
    }

    /// Progress of a job.
    JobState {
        /// `plays`, `waits` for an operator, `over`, `failed`, `ends` (the robot is brought to rest), or `outside`: a
        /// workstation controller in another process commands.
        phase: Cow<'static, str>,
        /// Number of the line that was begun last; 0 before the first.
        index: u32,
        /// Number of lines.
        lines: u32,
        /// The step that was begun last: a line of the job, PAUSE, or a command of an operator or of the workstation
        /// controller.
        text: String,
        /// The step is a command for Task, not an action of the workstation.
        is_command: bool,
        /// The tick after which the step was begun.
        began: u64,
        /// `executing`, `finished`, `error`, `error as expected`, `interrupted`; empty before the first step.
        outcome: Cow<'static, str>,
        /// Duration of the step, ticks; 0 while it is executed.
        ticks: u64,
        /// Why the job waits or has failed.
        reason: String,
        /// What a person has to do before the job can continue, if it is known.
        remedy: String,
        /// Number of the present retry of the line; 0 for none.
        retry: u32,
        /// Greatest number of retries of a line.
        retries: u32,
    }

    /// Who commands the robot.
    Commander {
        /// `job`, `operator`, or `workstation controller`.
        source: Cow<'static, str>,
        /// Name of the operator in command; empty for none. Other operators may only stop the robot.
        operator: String,
        /// Names of the connected operators.
        connected: Vec<String>,
        /// An operator has stopped the robot: the velocity knob is at 0 until `go`.
        is_stopped: bool,
        /// The joystick box controls the robot.
        by_hand: bool,
    }

    /// Lamps and latching keys of the robot controller's console.
    Lamps {
        /// Control power is on.
        power: bool,
        /// FAULT RESET is lit.
        fault_reset: bool,
        /// HYD ENABLED is lit.
        hydraulics_enabled: bool,
        /// MANUAL is on: the actuators have pressure.
        hydraulics_on: bool,
        /// Auto mode.
        auto: bool,
        /// Hold is on.
        hold: bool,
    }

    /// The simulated robot controller.
    Controller {
        /// Stage of its start-up, such as `hydraulics enabled` or `DEPC`.
        stage: String,
        /// Lamps and keys.
        lamps: Lamps,
        /// The emergency stops that are pressed, by their places: `on the control panel`.
        pressed: Vec<String>,
        /// Cause of the loss of pressure; empty under pressure.
        cut: String,
        /// The last warning or error on its screen; empty for none.
        screen: String,
        /// The tick of this warning or error.
        screen_tick: u64,
    }

    /// A part in the cell.
    Part {
        /// Its number, from 1.
        id: u32,
        /// Its frame on `/tf`, and its name in `/meshes`.
        frame: String,
        /// Its name in the task data at present.
        name: String,
        /// A location: a unit, the location of the vise, the drum or the pedestal, `gripper`, `floor` or `elsewhere`.
        location: String,
        /// The nearest sector of the unit; 0 elsewhere.
        sector: u32,
        /// The gripper holds it.
        held: bool,
        /// The vise holds it.
        clamped: bool,
    }

    /// The parts in the cell.
    Parts {
        /// By their numbers.
        parts: Vec<Part>,
    }

    /// A place for parts or grippers.
    Place {
        /// Name of the location.
        location: String,
        /// The sector of the location; 0 if it has none.
        sector: u32,
        /// Its origin in the world, metres.
        x: f64,
        /// Metres.
        y: f64,
        /// Metres.
        z: f64,
    }

    /// The places of the cell.
    Places {
        /// The places.
        places: Vec<Place>,
    }

    /// A coupler between the controller and devices of the cell.
    Coupler {
        /// Its name in the mapping.
        name: String,
        /// `starting`, `running`, `stale`, `tripped`, `silent` (it has no orders) or `ended`.
        state: Cow<'static, str>,
        /// Age of its inputs, ms.
        age_ms: u64,
        /// Its input words at the last read.
        inputs: Vec<u32>,
        /// The output words of the controller.
        commanded: Vec<u32>,
        /// The output words that it has acknowledged last.
        acknowledged: Vec<u32>,
        /// Number of requests and connections that failed.
        failures: u32,
        /// Number of times that its outputs were made safe until a release.
        trips: u32,
    }

    /// The couplers of a run.
    Couplers {
        /// In the order of their names.
        couplers: Vec<Coupler>,
    }
}

#[derive(Clone, Debug, PartialEq)]
pub enum View {
    JobLines(JobLines),
    JobState(JobState),
    Commander(Commander),
    Controller(Controller),
    Parts(Parts),
    Places(Places),
    Couplers(Couplers),
}

pub trait State: Message + Default + PartialEq {
    const TOPIC: &'static str;
}

macro_rules! states {
    ($($of:ty: $topic:expr;)+) => { $(
        impl State for $of {
            const TOPIC: &'static str = $topic;
        }
    )+ };
}

states! {
    JobLines: JOB_LINES;
    JobState: JOB_STATE;
    Commander: COMMANDER;
    Controller: CONTROLLER;
    Parts: PARTS;
    Places: PLACES;
    Couplers: FIELD;
}

/// A state over the ticks of a log. Repetitions of a message are left out.
#[derive(Clone, Debug, Default)]
pub struct Changes<S>(Vec<(Tick, S)>);

impl<S: State> Changes<S> {
    /// The changes of a state in a log; none if the log has no such channel.
    #[must_use]
    pub fn of(log: &Log) -> Self {
        let mut changes: Vec<(Tick, S)> = Vec::new();
        for (tick, data) in log.messages(S::TOPIC) {
            let state = typed::decode(&data);
            if changes.last().is_none_or(|(_, last)| *last != state) {
                changes.push((tick, state));
            }
        }
        Self(changes)
    }

    /// The state in a tick; `None` before the first message.
    #[must_use]
    pub fn at(&self, tick: Tick) -> Option<&S> {
        let end = self.0.partition_point(|(from, _)| *from <= tick);
        self.0.get(end.checked_sub(1)?).map(|(_, state)| state)
    }

    #[must_use]
    pub fn last(&self) -> Option<&S> {
        self.0.last().map(|(_, state)| state)
    }
}

pub const KINDS: usize = 7; // number of kinds of [`View`]

const FIXED: [usize; 2] = [0, 5]; // kinds that hardly ever change: the lines of the job, and the places

impl View {
    #[must_use]
    pub const fn kind(&self) -> usize {
        match self {
            Self::JobLines(_) => 0,
            Self::JobState(_) => 1,
            Self::Commander(_) => 2,
            Self::Controller(_) => 3,
            Self::Parts(_) => 4,
            Self::Places(_) => 5,
            Self::Couplers(_) => 6,
        }
    }

    fn encode(&self) -> Vec<u8> {
        match self {
            Self::JobLines(message) => typed::encode(message),
            Self::JobState(message) => typed::encode(message),
            Self::Commander(message) => typed::encode(message),
            Self::Controller(message) => typed::encode(message),
            Self::Parts(message) => typed::encode(message),
            Self::Places(message) => typed::encode(message),
            Self::Couplers(message) => typed::encode(message),
        }
    }
}

pub(crate) struct Views([Channel; KINDS]); // the channels of the views, with the last message of each

struct Channel {
    id: u16,
    last: Vec<u8>, // the last message; empty before the first
    written: Tick,
}

impl Views {
    pub fn open<W: Write + Seek>(output: &mut Output<W>) -> McapResult<Self> {
        fn channel<S: State>(output: &mut Output<impl Write + Seek>) -> McapResult<Channel> {
            let id = output.protobuf(S::TOPIC, &typed::name::<S>(), &typed::descriptor_set::<S>())?;
            Ok(Channel { id, last: Vec::new(), written: Tick::BEFORE_START })
        }
        Ok(Self([
            channel::<JobLines>(output)?,
            channel::<JobState>(output)?,
            channel::<Commander>(output)?,
            channel::<Controller>(output)?,
            channel::<Parts>(output)?,
            channel::<Places>(output)?,
            channel::<Couplers>(output)?,
        ]))
    }

    pub fn put<W: Write + Seek>(
        &mut self,
        output: &mut Output<W>,
        tick: Tick,
        view: &View,
    ) -> McapResult<()> {
        let Some(channel) = self.0.get_mut(view.kind()) else { return Ok(()) };
        (channel.last, channel.written) = (view.encode(), tick);
        output.put(channel.id, tick, &channel.last)
    }

    /// Write the last message of each channel again, unless it is of this tick or a later one. The lines of the
    /// job and the places, which hardly ever change, are repeated only at the `start` of a log.
    pub fn repeat<W: Write + Seek>(&self, output: &mut Output<W>, tick: Tick, start: bool) -> McapResult<()> {
        let is_due = |channel: &Channel| !channel.last.is_empty() && channel.written < tick;
        let due = self
            .0
            .iter()
            .enumerate()
            .filter(|(kind, channel)| is_due(channel) && (start || !FIXED.contains(kind)));
        due.into_iter().try_for_each(|(_, channel)| output.put(channel.id, tick, &channel.last))
    }

    pub fn continue_run(&mut self, ended: &mut Self) {
        for (channel, before) in self.0.iter_mut().zip(&mut ended.0) {
            channel.last = std::mem::take(&mut before.last);
        }
    }
}
