//! The state of the run for viewers: job, source of commands, robot controller, parts and places, for the log.
//!
//! After each tick the states are collected, and the changed ones are logged. This is between two ticks, where
//! a run may allocate.

use closed_loop::{failure::Failure, field::FieldController};
use couplers::{Orders, Report, Span};
use executive::memory::cell::ControllerView;
use field::Device;
use geometry::frame::Frame;
use interfaces::{CommonMemory, station::EStop};
use neighbours::workstation::player::{Hwsc, Progress, WaitReason};
use plant::{Cell, CellDescription, convert::metres, part_link};
use rcs_core::tick::Tick;
use record::views::{
    Commander, Controller, Coupler, Couplers, JobLine, JobLines, JobState, KINDS, Lamps, Part, Parts, Place,
    Places, View,
};
use taskdata::load::job::Step;

use crate::{
    agreement::places::bodies,
    cell_view::controller,
    neighbours::Neighbours,
    operator::{Operator, is_moved_by_hand},
};

pub struct ViewContext<'a> {
    pub tick: Tick,
    pub memory: &'a CommonMemory,
    pub neighbours: &'a Neighbours,
    pub operator: &'a Operator,
    pub job: &'a str,
    pub played: u32,                   // number of jobs that operators have played
    pub waits: Option<&'a WaitReason>, // the reason why the job waits, if it does
    pub cell: &'a Cell,
    pub has_controller: bool, // the robot controller is that of the cell, not one outside
    pub warning: Option<&'a Failure>, // the last warning on the screen of the robot controller
    pub field: Option<&'a FieldController>,
}

#[derive(Default)]
pub struct Viewed {
    last: [Option<View>; KINDS],
    console: ControllerView,
    /// Number of lines of the job, and number of played jobs. The lines change only with these two numbers.
    lines: Option<(usize, u32)>,
}

impl Viewed {
    pub fn look(&mut self, around: &ViewContext<'_>, mut log: impl FnMut(View)) {
        let job = around.neighbours.job();
        let lines = job.map(|job| (job.lines().len(), around.played));
        if self.lines != lines {
            self.lines = lines;
            self.note(View::JobLines(job_lines(around.job, job)), &mut log);
        }
        self.note(View::JobState(job_state(around.neighbours, around.waits)), &mut log);
        self.note(View::Commander(commander(around.neighbours, around.operator, around.memory)), &mut log);
        if around.has_controller {
            self.console = controller(around.cell.t3(), around.warning, around.tick, &self.console);
            self.note(View::Controller(controller_state(&self.console)), &mut log);
        }
        self.note(View::Parts(parts(around.cell)), &mut log);
        if let Some(desk) = around.field {
            self.note(View::Couplers(couplers(desk)), &mut log);
        }
    }

    fn note(&mut self, view: View, log: &mut impl FnMut(View)) {
        if let Some(last) = self.last.get_mut(view.kind())
            && last.as_ref() != Some(&view)
        {
            *last = Some(view.clone());
            log(view);
        }
    }
}

fn job_lines(name: &str, job: Option<&Hwsc>) -> JobLines {
    let lines = job.map(Hwsc::lines).unwrap_or_default();
    let lines = (1..).zip(lines).map(|(number, line)| JobLine {
        number,
        text: line.text.clone(),
        is_command: matches!(line.step, Step::Command(_)),
        expects_error: line.expects_error,
    });
    JobLines { name: name.to_owned(), lines: lines.collect() }
}

/// The progress of the job. `waits` is the reason why it waits, if it does.
pub fn job_state(neighbours: &Neighbours, waits: Option<&WaitReason>) -> JobState {
    let (phase, failure, reason) = match neighbours.job().map(|job| (job.progress(), job.is_waiting())) {
        None => ("outside", None, String::new()),
        Some((Progress::Over, _)) => ("over", None, String::new()),
        Some((Progress::Failed(failure), _)) => ("failed", Some(failure), failure.to_string()),
        Some((Progress::Running, _)) if neighbours.is_ending() => ("ends", None, String::new()),
        Some((Progress::Running, false)) => ("plays", None, String::new()),
        Some((Progress::Running, true)) => match waits {
            Some(WaitReason::Failed(failure)) => ("waits", Some(failure), failure.to_string()),
            waits => ("waits", None, waits.map_or_else(String::new, ToString::to_string)),
        },
    };
    let (index, lines) = neighbours.place();
    let state = JobState {
        phase: phase.into(),
        index: count(index),
        lines: count(lines),
        reason,
        remedy: failure.and_then(|failure| failure.remedy()).unwrap_or_default().to_owned(),
        ..JobState::default()
    };
    let Some(step) = neighbours.begun_steps().last() else { return state };
    let retry =
        neighbours.retried().last().filter(|retry| step.began >= retry.tick && step.text == retry.line);
    let is_executed = step.outcome == neighbours::workstation::player::Outcome::Executing;
    JobState {
        text: step.text.clone(),
        is_command: step.is_command,
        began: step.began.0,
        outcome: step.outcome.text().into(),
        ticks: if is_executed { 0 } else { step.ticks },
        retry: retry.map_or(0, |retry| retry.number),
        retries: retry.map_or(0, |retry| retry.of),
        ..state
    }
}

pub fn commander(neighbours: &Neighbours, operator: &Operator, memory: &CommonMemory) -> Commander {
    let (operator, connected, is_stopped) = operator.present();
    let waits = neighbours.job().is_some_and(Hwsc::is_waiting);
    let source = match operator {
        _ if neighbours.are_commanding() => "workstation controller",
        Some(_) if waits => "operator",
        _ => "job",
    };
    Commander {
        source: source.into(),
        operator: operator.unwrap_or_default().to_owned(),
        connected: connected.to_vec(),
        is_stopped,
        by_hand: is_moved_by_hand(memory),
    }
}

#[must_use]
pub fn controller_state(view: &ControllerView) -> Controller {
    let lamps = view.lamps;
    let pressed = EStop::ALL.iter().zip(view.estops).filter(|(_, is_pressed)| *is_pressed);
    Controller {
        stage: view.stage.as_str().to_owned(),
        lamps: Lamps {
            power: lamps.power,
            fault_reset: lamps.fault_reset,
            hydraulics_enabled: lamps.hydraulics_enabled,
            hydraulics_on: lamps.hydraulics_on,
            auto: lamps.auto,
            hold: lamps.hold,
        },
        pressed: pressed.map(|(site, _)| site.place().to_owned()).collect(),
        cut: view.cut.as_str().to_owned(),
        screen: view.screen.as_str().to_owned(),
        screen_tick: view.screen_tick.0,
    }
}

fn couplers(desk: &FieldController) -> Couplers {
    let words = |words: &[u16], spans: &[Span]| {
        let count = spans.iter().map(Span::words).sum();
        words.iter().take(count).map(|word| u32::from(*word)).collect()
    };
    let coupler = |(device, orders, report, age_ms): (&Device, &Orders, &Report, u64)| Coupler {
        name: device.name.clone(),
        state: report.state.word().into(),
        age_ms,
        inputs: words(&report.inputs.words, &device.plan.reads),
        commanded: words(&orders.words.words, &device.plan.writes),
        acknowledged: words(&report.acknowledged.words, &device.plan.writes),
        failures: report.counters.failures,
        trips: report.counters.trips,
    };
    Couplers { couplers: desk.devices().map(coupler).collect() }
}

fn parts(cell: &Cell) -> Parts {
    let part = |part: plant::PartState| Part {
        id: part.id,
        frame: part_link(part.id),
        name: part.name,
        location: part.location,
        sector: part.sector.into(),
        held: part.held,
        clamped: part.clamped,
    };
    Parts { parts: cell.parts().into_iter().map(part).collect() }
}

/// The places of a cell: trays with their sectors, nests, vise, pedestal, drum, holsters.
#[must_use]
pub fn places(cell: &CellDescription) -> View {
    let sectors = cell.tray.iter().flat_map(|tray| {
        (1..=u16::MAX).map_while(|sector| Some((tray.unit.as_str(), sector, tray.sector(sector)?)))
    });
    let nests = cell.nest.iter().map(|nest| (nest.location.as_str(), nest.sector, nest.frame()));
    let bodies = bodies(cell).map(|(_, location, frame)| (location, 0, frame));
    let place = |(location, sector, Frame { position, .. }): (&str, u16, Frame)| {
        let [x, y, z] = [position.x, position.y, position.z].map(metres);
        Place { location: location.to_owned(), sector: sector.into(), x, y, z }
    };
    View::Places(Places { places: sectors.chain(nests).chain(bodies).map(place).collect() })
}

fn count(number: usize) -> u32 {
    u32::try_from(number).unwrap_or(u32::MAX)
}
