//! The neighbours of a run: the source of Task's commands, the Data System, Active Pedestal and vision. A neighbour
//! runs in this or another process, and is reached through mailboxes. In fast clock, results are bit-identical.

mod command;

use std::{
    sync::atomic::Ordering,
    thread,
    time::{Duration, Instant},
};

use closed_loop::{JobPlayer, StepContext, workstation::SimulatedWorkstation};
use interfaces::{CommonMemory, DataBaseStatus, DeviceInputs, OutsidePedestal};
use neighbours::{
    vision::picture::Part,
    workstation::player::{BegunStep, Hwsc, Outcome, Progress, Retry, WaitReason},
};
use plant::camera::Subject;
use rcs_core::{Plain as _, tick::Tick};
use sessions::{
    data_system::DataSystem,
    network::{Endpoint, EndpointHandle, Role},
    pedestal, vision,
};

use super::{
    commanded::Commanded,
    switched::{SwitchContext, Switched},
};
use crate::{
    config::{ClockKind, RunConfig},
    error::StartError,
    event::Event,
    judge::{CommandJudge, play},
    network::Network,
    observer::Observer,
};

pub enum WorkstationSource {
    Emulator(Box<JobPlayer>),
    Outside(Box<Commanded>),
    /// The emulator, whose job transfers the command to a workstation controller in another process.
    Switched(Box<Switched>),
}

impl WorkstationSource {
    #[must_use]
    pub fn outside(endpoint: Endpoint) -> Self {
        Self::Outside(Box::new(Commanded::new(endpoint)))
    }
}

pub struct Neighbours {
    pub(crate) workstation: WorkstationSource,
    data_system: Option<DataSystem>, // the Data System; `None` if the run keeps the items itself
    /// `None` if the controller contains the processes of the pedestal.
    pedestal: Option<Box<pedestal::Agent>>,
    /// The port of vision. Without it, the cell analyses its pictures itself.
    vision: Option<vision::Port>,
    pub(crate) network: Option<Network>,
    pub(crate) events: Vec<Event>,
    unchecked: bool, // true to ignore errors in the records that a command uses
    is_ending: bool, // true if no more commands are accepted
}

impl Neighbours {
    /// Make the source of commands, the Data System, and pedestal and vision if they are other processes.
    #[must_use]
    pub fn new(
        workstation: WorkstationSource,
        data_system: Option<DataSystem>,
        pedestal: Option<Box<pedestal::Agent>>,
        vision: Option<vision::Port>,
        network: Option<Network>,
    ) -> Self {
        Self {
            workstation,
            data_system,
            pedestal,
            vision,
            network,
            events: Vec::new(),
            unchecked: false,
            is_ending: false,
        }
    }

    #[must_use]
    pub fn unchecked(self, unchecked: bool) -> Self {
        Self { unchecked, ..self }
    }

    /// Wait for neighbours in other processes, until the time limit or an interruption. On the 40 ms grid only for the
    /// workstation controller; in fast clock a run ends when one disconnects. `say` receives the run's state.
    pub fn gather(
        &self,
        config: &RunConfig,
        say: impl Fn(&str),
        observer: &mut dyn Observer,
    ) -> Result<(), StartError> {
        let Some(network) = &self.network else { return Ok(()) };
        let (limit, started) = (Duration::from_secs(config.wait.into()), Instant::now());
        let fast = config.clock == ClockKind::Fast;
        let is_missing = |handle: &&EndpointHandle| match handle.role() {
            Role::Workstation if self.can_switch() => false,
            Role::Workstation if fast => !handle.was_connected(),
            Role::Workstation => !handle.is_connected(),
            Role::DataSystem | Role::Pedestal | Role::Vision => fast && !handle.is_connected(),
            Role::Operator => false,
        };
        let mut said = String::new();
        loop {
            let missing: Vec<_> = network.handles.iter().filter(is_missing).collect();
            let waits = waits_for(&missing, config);
            if !missing.is_empty() && waits != said {
                say(&waits);
                said = waits;
            }
            if missing.is_empty() || config.stop.load(Ordering::Relaxed) {
                return Ok(());
            }
            if started.elapsed() >= limit {
                if missing.iter().any(|handle| handle.role() == Role::Workstation) {
                    return Err(StartError::NoWorkstation(config.wait));
                }
                for handle in missing {
                    let role = handle.role();
                    observer.message(&format!("{role} has not connected; the run begins without it"));
                }
                return Ok(());
            }
            thread::sleep(Duration::from_millis(10));
        }
    }

    /// Stop reading commands of job and workstation controller: the run is about to end.
    pub const fn stop_commanding(&mut self) {
        self.is_ending = true;
    }

    #[must_use]
    pub const fn is_ending(&self) -> bool {
        self.is_ending
    }

    #[must_use]
    pub fn are_commanding(&self) -> bool {
        match &self.workstation {
            WorkstationSource::Emulator(_) => false,
            WorkstationSource::Outside(commanded) => !commanded.is_stand_alone(),
            WorkstationSource::Switched(switched) => switched.is_handed_over(),
        }
    }

    /// The emulator of the workstation controller that plays the job; `None` if another process may command.
    pub fn job_player(&mut self) -> Option<&mut Hwsc> {
        match &mut self.workstation {
            WorkstationSource::Emulator(emulator) => Some(&mut emulator.hwsc),
            WorkstationSource::Outside(_) | WorkstationSource::Switched(_) => None,
        }
    }

    /// The job, if it is the present source of commands. Errors: a sentence that names the present source.
    pub fn job_under_way(&mut self) -> Result<&mut Hwsc, String> {
        if self.is_ending {
            return Err("the run is about to end".to_owned());
        }
        let other =
            "the workstation controller commands this run: ask there, or end its session; stops are possible";
        match &mut self.workstation {
            WorkstationSource::Emulator(emulator) => Ok(&mut emulator.hwsc),
            WorkstationSource::Switched(switched) => switched.job_under_way().ok_or_else(|| other.to_owned()),
            WorkstationSource::Outside(commanded) => {
                commanded.job_under_way().ok_or_else(|| format!("{other}, and `stand-alone` takes over"))
            }
        }
    }

    /// The job, also while the run is about to end; `None` while a workstation controller commands.
    #[must_use]
    pub fn job(&self) -> Option<&Hwsc> {
        match &self.workstation {
            WorkstationSource::Emulator(emulator) => Some(&emulator.hwsc),
            WorkstationSource::Switched(switched) => switched.job(),
            WorkstationSource::Outside(commanded) => commanded.job(),
        }
    }

    /// The reason why the job has begun to wait for an operator; each reason is returned once.
    pub fn operator_news(&mut self) -> Option<WaitReason> {
        match &mut self.workstation {
            WorkstationSource::Emulator(emulator) => emulator.hwsc.operator_news(),
            WorkstationSource::Switched(switched) => switched.job_under_way()?.operator_news(),
            WorkstationSource::Outside(commanded) => commanded.job_under_way()?.operator_news(),
        }
    }

    #[must_use]
    pub const fn can_switch(&self) -> bool {
        matches!(self.workstation, WorkstationSource::Switched(_))
    }

    /// The status of a Data System outside the run.
    #[must_use]
    pub fn data_base(&self) -> DataBaseStatus {
        self.data_system.as_ref().map(DataSystem::status).unwrap_or_default()
    }

    #[must_use]
    pub fn pedestal(&self) -> &OutsidePedestal {
        self.pedestal.as_deref().map_or(&OutsidePedestal::ZERO, pedestal::Agent::sent)
    }

    /// Before the first tick: the pedestal reads the initial buffers, and a Data System's connection is recorded.
    pub fn begin(&mut self, memory: &CommonMemory, inputs: &DeviceInputs) {
        self.data_system.iter().for_each(|system| system.keeper().look());
        self.step_pedestal(Tick::BEFORE_START, memory, inputs);
    }

    /// The pedestal reads the outputs of a tick, and the device words of the next tick.
    fn step_pedestal(&mut self, tick: Tick, memory: &CommonMemory, inputs: &DeviceInputs) {
        let Some(agent) = &mut self.pedestal else { return };
        agent.exchange(tick.next(), &memory.subtask.pedestal, &inputs.pedestal);
        self.events.extend(agent.remarks().into_iter().map(Event::from));
    }

    /// Vision reads E-move's request and the camera picture. Its answer is among the device words of the next tick.
    fn step_vision(&mut self, tick: Tick, memory: &CommonMemory, workstation: &mut SimulatedWorkstation) {
        let Some(port) = &mut self.vision else { return };
        let cell = &mut workstation.cell;
        port.step(tick.0, &memory.emove.vision, || cell.picture().iter().map(pictured).collect());
        cell.hear_vision(port.response());
        self.events.extend(port.remarks().into_iter().map(Event::from));
    }

    #[must_use]
    pub fn begun_steps(&self) -> &[BegunStep] {
        match &self.workstation {
            WorkstationSource::Emulator(emulator) => emulator.hwsc.begun_steps(),
            WorkstationSource::Outside(commanded) => commanded.begun_steps(),
            WorkstationSource::Switched(switched) => switched.begun_steps(),
        }
    }

    /// Number of the job's last begun line, 0 before the first, and the number of its lines; both 0 without a job.
    #[must_use]
    pub fn place(&self) -> (usize, usize) {
        match &self.workstation {
            WorkstationSource::Emulator(emulator) => emulator.hwsc.place(),
            WorkstationSource::Outside(_) => (0, 0),
            WorkstationSource::Switched(switched) => switched.place(),
        }
    }

    /// The same, with the commands of a workstation controller to which the job has transferred the command.
    #[must_use]
    pub fn all_steps(&self) -> Vec<BegunStep> {
        match &self.workstation {
            WorkstationSource::Switched(switched) => switched.all_steps(),
            WorkstationSource::Outside(commanded) => commanded.all_steps(),
            WorkstationSource::Emulator(_) => self.begun_steps().to_vec(),
        }
    }

    #[must_use]
    pub fn retried(&self) -> &[Retry] {
        match &self.workstation {
            WorkstationSource::Emulator(emulator) => emulator.hwsc.retried(),
            WorkstationSource::Outside(_) => &[],
            WorkstationSource::Switched(switched) => switched.retried(),
        }
    }

    /// The line of the job in progress in a tick. A failure at the start of a line belongs to that line.
    #[must_use]
    pub fn line_at(&self, tick: Tick) -> Option<&str> {
        let is_refused = |step: &BegunStep| step.outcome == Outcome::Failed && step.ticks == 0;
        let has_next = |step: &BegunStep| step.outcome == Outcome::Executing;
        let is_meant = |step: &&BegunStep| {
            let since = tick.since(step.began);
            (tick > step.began || is_refused(step)) && (since <= step.ticks || has_next(step))
        };
        self.begun_steps().iter().rev().find(is_meant).map(|step| step.text.as_str())
    }

    /// Called once per tick, after controller and cell: all neighbours read the outputs of the tick.
    pub fn step(&mut self, desk: StepContext<'_>) -> Progress {
        let StepContext { tick, memory, inputs, gate, workstation, generations } = desk;
        if let Some(data_system) = &mut self.data_system {
            data_system.step(tick, &memory.task.data_base);
            self.events.extend(data_system.refusals().into_iter().map(Event::DataBaseRefuses));
            self.events.extend(data_system.keeper().remarks().into_iter().map(Event::from));
        }
        self.events.extend(self.network.iter().flat_map(Network::events).map(Event::Network));
        self.step_vision(tick, memory, workstation);
        let judge = CommandJudge { generations, load: None, memory, unchecked: self.unchecked };
        let progress = match &mut self.workstation {
            _ if self.is_ending => Progress::Running,
            WorkstationSource::Emulator(emulator) => {
                play(emulator, tick, gate, workstation, &judge, &mut self.events)
            }
            WorkstationSource::Outside(commanded) => {
                commanded.step(tick, gate, workstation, &judge, &mut self.events)
            }
            WorkstationSource::Switched(switched) => {
                let data_system = self.network.iter().flat_map(|network| &network.handles);
                let mut data_system = data_system.filter(|handle| handle.role() == Role::DataSystem);
                let around = SwitchContext {
                    tick,
                    judge,
                    has_data_system: data_system.all(EndpointHandle::is_connected),
                };
                switched.step(&around, gate, workstation, &mut self.events)
            }
        };
        self.step_pedestal(tick, memory, inputs);
        progress
    }

    pub fn events(&mut self) -> Vec<Event> {
        std::mem::take(&mut self.events)
    }

    pub const fn data_system(&mut self) -> Option<&mut DataSystem> {
        self.data_system.as_mut()
    }
}

fn pictured(subject: &Subject) -> Part {
    let face = subject.face();
    Part {
        centre: face.centre.into(),
        edges: face.edges.map(|(direction, length)| (direction.into(), length)),
        reflectance: subject.reflectance(),
        seen: subject.raster(),
    }
}

fn waits_for(missing: &[&EndpointHandle], config: &RunConfig) -> String {
    let roles: Vec<_> = missing.iter().map(|handle| handle.role().to_string()).collect();
    let address = config.network.as_ref().map_or_else(String::new, |address| format!(" at {address}"));
    format!("waits for {}{address}", roles.join(", "))
}
