//! The steps of an interruption, tick by tick: by a person at the box, at the panel or in the cell, or by a fault.

use std::sync::Arc;

use depc::fault::{ALWAYS, FaultKind, Plan, Rule};
use interfaces::device::{KNOB_FULL, joystick_frame};
use levels::ladder::ProcessId;
use plant::{
    BoxAction, BoxButton, Key, WorkstationAction,
    fault::{self, Fault, FaultPlan, When, text::FaultFile},
    t3::Stage,
};
use rcs_core::tick::Tick;

use super::{
    branch::Branch,
    disturbance::{self, DisturbanceKind, Lead, Undo},
    outage::{self, Outage},
    power,
};

/// Height by which the robot is moved away, in.
const RISE: f64 = 3.0;
/// Distance that a robot continues when the button is released on the way back, in.
const OVERRUN: f64 = 0.8;
/// Longest time for which a button of the joystick box is held down, ticks.
const BUTTON_TICKS: u64 = 100;
/// Ticks for which a refused key of the panel is repeated.
const KEY_TICKS: u64 = 2000;
/// Ticks from CYCLE START to the DEPC function: the program makes two short motions.
const REHEARSAL: u64 = 75;
pub const FAULT: u64 = 20; // ticks for which a fault is on
/// Least probability of a random fault, in millionths per tick or byte. With it a fault occurs within [`FAULT`] ticks.
const CHANCE: u32 = 50_000;

pub const fn at_box(action: BoxAction) -> ScriptStep {
    ScriptStep::Workstation(WorkstationAction::Joystick(action))
}

/// Switches the box on, performs the actions, and switches it off again.
fn joystick(knob: u16, steps: impl IntoIterator<Item = ScriptStep>) -> Vec<ScriptStep> {
    // A robot in motion ramps down first.
    let mut all = vec![
        at_box(BoxAction::Velocity(knob)),
        at_box(BoxAction::Frame(joystick_frame::WORLD)),
        ScriptStep::Wait(25),
    ];
    all.extend(steps);
    all.extend([at_box(BoxAction::Frame(0)), at_box(BoxAction::Velocity(KNOB_FULL)), ScriptStep::Wait(5)]);
    all
}

/// Deflect the stick along X for some ticks, and back.
pub fn nudge() -> Vec<ScriptStep> {
    const TICKS: u32 = 11;
    let stick = |x: i16| {
        [at_box(BoxAction::Stick { x, y: 0, ticks: TICKS }), ScriptStep::Wait(u64::from(TICKS) + 10)]
    };
    joystick(100, [1000, -1000].into_iter().flat_map(stick))
}

/// Stop the robot with the box, move it up, and move it back by eye to the height at which it stopped.
pub fn away() -> Vec<ScriptStep> {
    let stop = [at_box(BoxAction::Press(BoxButton::Up, 2)), ScriptStep::Wait(25)];
    let lead = [ScriptStep::Rise, ScriptStep::Wait(15), ScriptStep::Sink, ScriptStep::Wait(15)];
    joystick(500, stop.into_iter().chain(lead))
}

#[derive(Clone, Debug)]
pub enum ScriptStep {
    Workstation(WorkstationAction),
    Wait(u64),
    Restart(ProcessId),
    Lose(ProcessId),
    Cut,
    Journal, // the journal writes its last entry
    PowerOff,
    PowerOn,
    AirLost(u64), // the supply of air fails for a number of ticks
    Answer(FaultKind),
    Faults(Arc<FaultFile>),
    Enter,                   // ENTER, if the robot controller shows a warning
    StartUp,                 // the start-up at the panel, if the robot controller has lost its pressure
    Key(Key),                // a key of the panel, as soon as the controller accepts it
    Rise,       // button D of the joystick box, until the robot is [`RISE`] higher or stops rising
    Sink,       // button E, until the robot is almost back at the height at which it rose
    Lead(Lead), // stick and buttons, which move the robot along a path
    Change(DisturbanceKind), // a change of the parts in the cell
    Undo(Undo),
    Outage(Outage),
    Release, // `io go` to the devices that have tripped, until all are running
}

impl ScriptStep {
    pub const fn key(key: Key) -> Self {
        Self::Workstation(WorkstationAction::T3(key))
    }
}

/// The start-up of IV.3.3 after an emergency stop.
const START_UP: [Key; 6] =
    [Key::FaultReset, Key::Hydraulics(true), Key::Manual(true), Key::Align(None), Key::Auto, Key::CycleStart];

pub struct Script {
    steps: Vec<ScriptStep>,
    at: usize,
    until: Option<Tick>,
    height: f64, // height of the tool before it was moved away, in
    lead: Option<Lead>,
    undo: Vec<Undo>,  // steps that undo the changes of the cell
    journal: Vec<u8>, // the bytes of the journal
}

/// Move the robot along a vector, 0.01 in, world, and return its control to the processes.
pub fn lead(way: [i32; 3]) -> Vec<ScriptStep> {
    let lead = Lead::by(way);
    joystick(lead.knob(), [ScriptStep::Lead(lead), ScriptStep::Wait(25)])
}

impl Script {
    #[must_use]
    pub const fn new(steps: Vec<ScriptStep>) -> Self {
        Self { steps, at: 0, until: None, height: 0.0, lead: None, undo: Vec::new(), journal: Vec::new() }
    }

    /// Undoes a person's changes that caused the refusal of a command. `None` without changes.
    #[must_use]
    pub fn undone(&self, what: &DisturbanceKind) -> Option<Self> {
        if let DisturbanceKind::Jog(way) = what {
            let lead = Lead::back(*way);
            return Some(Self::new(joystick(lead.knob(), [ScriptStep::Lead(lead), ScriptStep::Wait(25)])));
        }
        let steps: Vec<_> = self.undo.iter().cloned().map(ScriptStep::Undo).collect();
        (!steps.is_empty()).then(|| Self::new(steps))
    }

    #[must_use]
    pub const fn is_over(&self) -> bool {
        self.at >= self.steps.len()
    }

    /// Carry out the steps before the next tick. Returns the cell's message if it refuses one.
    pub fn step(&mut self, branch: &mut Branch<'_>) -> Option<String> {
        let mut refused = None;
        while let Some(step) = self.steps.get(self.at).cloned() {
            match step {
                ScriptStep::Wait(ticks) => {
                    let now = branch.at();
                    let until = *self.until.get_or_insert(Tick(now.0 + ticks));
                    if now < until {
                        return refused;
                    }
                    self.until = None;
                }
                ScriptStep::Key(key) => {
                    let now = branch.at();
                    let until = *self.until.get_or_insert(Tick(now.0 + KEY_TICKS));
                    let busy = branch.closed.workstation.cell.t3().busy();
                    if now < until && (busy || branch.closed.workstation.cell.press(key).is_err()) {
                        return refused;
                    }
                    self.until = None;
                }
                ScriptStep::Rise | ScriptStep::Sink => {
                    let (now, height) = (branch.at(), branch.closed.workstation.cell.tool().position.z);
                    if self.until.is_none() && matches!(step, ScriptStep::Rise) {
                        self.height = height;
                    }
                    let until = *self.until.get_or_insert(Tick(now.0 + BUTTON_TICKS));
                    let (button, there) = match step {
                        ScriptStep::Rise => (BoxButton::Up, height >= self.height + RISE),
                        _ => (BoxButton::Down, height <= self.height + OVERRUN),
                    };
                    if now < until && !there {
                        let press = WorkstationAction::Joystick(BoxAction::Press(button, 1));
                        let result = branch.closed.workstation.cell.workstation(&press);
                        return result.err().map(|error| error.to_string());
                    }
                    self.until = None;
                }
                ScriptStep::Lead(begun) => {
                    let lead = self.lead.get_or_insert(begun);
                    if let Some(control) = lead.step(&branch.closed.workstation.cell) {
                        let action = WorkstationAction::Joystick(control);
                        let result = branch.closed.workstation.cell.workstation(&action);
                        return result.err().map(|error| error.to_string());
                    }
                    self.lead = None;
                }
                ScriptStep::Change(what) => {
                    match disturbance::change(&mut branch.closed.workstation.cell, &what) {
                        Ok((parts, undo)) => {
                            branch.closed.note_changed(parts);
                            self.undo.extend(undo);
                        }
                        Err(why) => refused = Some(why),
                    }
                }
                ScriptStep::Undo(undo) => match disturbance::undo(&mut branch.closed.workstation.cell, &undo)
                {
                    Ok(part) => branch.closed.note_changed(vec![part]),
                    Err(why) => refused = Some(why),
                },
                ScriptStep::Workstation(action) => {
                    refused = branch
                        .closed
                        .workstation
                        .cell
                        .workstation(&action)
                        .err()
                        .map(|error| error.to_string());
                }
                ScriptStep::Restart(process) => branch.closed.course_mut().levels_mut().restart(process),
                ScriptStep::Lose(process) => branch.closed.course_mut().levels_mut().lose(process),
                ScriptStep::PowerOff => branch.closed.course_mut().levels_mut().switch_off(),
                ScriptStep::AirLost(ticks) => {
                    let from = branch.at().0 + 1;
                    let when = When { from, until: from + ticks, ..When::ALWAYS };
                    let faults = vec![Fault { number: 1, what: fault::FaultSubject::AirLost, when }];
                    let plan = FaultPlan { seed: 0, faults };
                    branch.closed.workstation.cell.add_faults(&plan, branch.facility().seed);
                }
                ScriptStep::Journal => self.journal = power::journal(branch),
                ScriptStep::PowerOn => {
                    refused = power::resume(branch, &self.journal).err().map(|error| error.to_string());
                }
                ScriptStep::Cut => {
                    let now = branch.at();
                    branch.closed.line_mut().cut(now);
                }
                ScriptStep::Answer(kind) => branch.closed.line_mut().spoil_answer(kind),
                ScriptStep::Faults(file) => {
                    let from = branch.at().0 + 1;
                    let seed = branch.facility().seed;
                    branch.closed.workstation.cell.add_faults(&cell_faults(&file.cell, from), seed);
                    if let Some(plan) = &file.line {
                        branch.closed.line_mut().replace_plan(&line_faults(plan, from));
                    }
                }
                ScriptStep::Enter => {
                    // The key has an effect only during a warning.
                    let _ = branch.closed.workstation.cell.press(Key::Enter);
                }
                ScriptStep::StartUp => self.start_up(branch),
                ScriptStep::Outage(cut) => cut.begin(branch),
                ScriptStep::Release => {
                    let now = branch.at();
                    let until = *self.until.get_or_insert(Tick(now.0 + outage::RELEASE_LIMIT));
                    let ticks = outage::RELEASE_LIMIT.saturating_sub(until.since(now));
                    if now < until && !outage::release(branch, ticks) {
                        return refused;
                    }
                    self.until = None;
                }
            }
            self.at += 1;
        }
        refused
    }

    fn start_up(&mut self, branch: &Branch<'_>) {
        if branch.closed.workstation.cell.t3().stage() == Stage::Depc {
            return;
        }
        for key in START_UP {
            self.steps.extend([ScriptStep::Key(key), ScriptStep::Wait(1)]);
        }
        self.steps.push(ScriptStep::Wait(REHEARSAL));
    }
}

/// The faults of the cell in a window. Random faults are frequent enough to occur in it.
fn cell_faults(plan: &FaultPlan, from: u64) -> FaultPlan {
    let mut plan = plan.clone();
    plan.faults.retain(|fault| !fault.what.is_delivery());
    for fault in &mut plan.faults {
        let rate = fault.when.rate.map(|rate| rate.max(f64::from(CHANCE) / f64::from(ALWAYS)));
        fault.when = When { from, until: from + FAULT, rate, ..fault.when };
    }
    plan
}

fn line_faults(plan: &Plan, from: u64) -> Plan {
    let mut windowed = Plan::new(plan.seed());
    for rule in plan.rules() {
        let single = rule.rate == 0 && rule.until == rule.from + 1;
        let rule: Rule = match single {
            true => rule.at(from),
            false if rule.rate == 0 => rule.window(from, from + FAULT),
            false => rule.window(from, from + FAULT).rate(rule.rate.max(CHANCE)),
        };
        // Rules that conflict only in this window are left out.
        let _ = windowed.add(rule);
    }
    windowed
}
