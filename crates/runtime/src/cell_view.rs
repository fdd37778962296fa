//! Publishes the state of the simulated cell to other programs: [`CellView`], filled after each tick.

use closed_loop::failure::Failure;
use executive::memory::{
    Text,
    cell::{
        CellView, CommanderView, ControllerView, JobView, Lamps, LatenessView, PARTS, PartView, TableView,
    },
};
use plant::{
    Cell, EStop, PartState, TablePanel,
    t3::{Stage, T3Controller},
};
use rcs_core::{name::Name16, tick::Tick};
use record::views::{Commander, JobState};

use crate::pace::Pace;

const SECOND: u64 = 25; // ticks between two updates of the statistics over all ticks: 1 s

#[derive(Debug, Default)]
pub struct View {
    shown: CellView,
}

impl View {
    /// `warning`: the last on the robot controller's screen. `sank`: the arm has lost its pressure in this tick.
    pub fn look(
        &mut self,
        tick: Tick,
        (cell, warning, sank): (&Cell, Option<&Failure>, bool),
        (job, commander): (&JobState, &Commander),
        pace: &Pace,
    ) -> &CellView {
        let parts = cell.parts();
        let (fingers, force) = cell.fingers();
        let (hand, hand_force) = cell.pedestal_fingers();
        let controller = controller(cell.t3(), warning, tick, &self.shown.controller);
        self.shown = CellView {
            tick,
            controller: ControllerView {
                cut_tick: cut_tick(&self.shown.controller, &controller, tick, sank),
                ..controller
            },
            table: table(cell.table_panel()),
            joints: cell.joints(),
            tool: cell.tool().position.into(),
            fingers: [fingers, force],
            pedestal_fingers: [hand, hand_force],
            vise_opening: cell.vise_opening(),
            drum_closed: cell.drum_closed(),
            gripper: cell.gripper(),
            part_count: count(parts.len()),
            parts: shown(&parts),
            job: JobView {
                lines: job.lines,
                begun: job.index,
                line: Text::clipped(&job.text),
                began: Tick(job.began),
                phase: Text::clipped(&job.phase),
                reason: Text::clipped(&job.reason),
            },
            commander: CommanderView {
                source: Text::clipped(&commander.source),
                operator: Text::clipped(&commander.operator),
                is_stopped: commander.is_stopped,
                by_hand: commander.by_hand,
            },
            lateness: lateness(self.shown.lateness, tick, pace),
        };
        &self.shown
    }
}

/// The console of the robot controller after `tick`; `before` is the previous one.
pub fn controller(
    t3: &T3Controller,
    warning: Option<&Failure>,
    tick: Tick,
    before: &ControllerView,
) -> ControllerView {
    let stage = t3.stage();
    // While FAULT RESET is lit, the screen shows its error instead of older messages.
    let shown = match t3.error() {
        Some(error) if before.screen.as_str() == error => (before.screen_tick, before.screen),
        Some(error) => (tick, Text::clipped(error)),
        None => warning
            .map_or((Tick::BEFORE_START, Text::default()), |shown| (shown.tick, Text::clipped(&shown.text))),
    };
    let (screen_tick, screen) = shown;
    let is = |stages: &[Stage]| stages.contains(&stage);
    ControllerView {
        stage: Text::clipped(stage.text()),
        lamps: Lamps {
            power: stage != Stage::Dark,
            fault_reset: stage == Stage::Faulted,
            hydraulics_enabled: !is(&[Stage::Dark, Stage::Faulted, Stage::Ready]),
            hydraulics_on: t3.cut().is_none(),
            auto: is(&[Stage::Homing, Stage::Auto, Stage::Rehearsing, Stage::Depc]),
            hold: t3.hold(),
        },
        screen,
        screen_tick,
        cut: t3.cut().map_or_else(Text::default, |cut| Text::clipped(&cut.to_string())),
        cut_tick: Tick::BEFORE_START,
        estops: std::array::from_fn(|at| EStop::ALL.get(at).is_some_and(|site| t3.is_pressed(*site))),
        aligned: t3.aligned(),
        at_rest: t3.at_rest(),
    }
}

/// The tick in which the arm loses its pressure. A button is pressed after the tick, so it takes effect in the next.
fn cut_tick(before: &ControllerView, now: &ControllerView, tick: Tick, sank: bool) -> Tick {
    match now.cut.as_str() {
        "" => Tick::BEFORE_START,
        _ if before.cut == now.cut => before.cut_tick,
        _ if sank => tick,
        _ => tick.next(),
    }
}

const fn table(panel: TablePanel) -> TableView {
    TableView { power: panel.power, manual: panel.manual, obeys: panel.obeys }
}

fn count(number: usize) -> u32 {
    u32::try_from(number).unwrap_or(u32::MAX)
}

fn shown(parts: &[PartState]) -> [PartView; PARTS] {
    let mut views = [PartView::default(); PARTS];
    for (view, part) in views.iter_mut().zip(parts) {
        *view = PartView {
            id: part.id,
            name: Name16::clipped(&part.name),
            location: Name16::clipped(&part.location),
            sector: part.sector,
            held: part.held,
            clamped: part.clamped,
            position: part.position,
        };
    }
    views
}

/// Statistics over all ticks take too long for every tick, so they are updated once per second.
fn lateness(before: LatenessView, tick: Tick, pace: &Pace) -> LatenessView {
    let last = pace.last_late().as_secs_f64() * 1e6;
    match pace.late() {
        Some(late) if tick.0.is_multiple_of(SECOND) => {
            LatenessView { last, p50: late.p50, p99: late.p99, max: late.max }
        }
        _ => LatenessView { last, ..before },
    }
}
