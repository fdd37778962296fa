//! The model around the two ends: a line per direction, the host's user, the panel, and the true state. The robot
//! moves around a ring of four points, one count apart, so a skipped or repeated point or a step back is visible, and
//! the search is finite.

use depc::{
    Limits, Plate,
    controller::{Controller, ControllerInputs, ControllerState, Refusal, Robot},
    host::{ANSWER_TICKS, Host, HostEvent, HostState, Intent, RESTART_TICKS},
    link::{LinkBytes, LinkFault},
    wire::{DataCommand, FRAME_BYTES, NO_FUNCTION},
};

use crate::image::Image;

const RING: i16 = 4; // points
/// The position of a point, except for the first word.
const AT: Plate = Plate { words: [0, -6296, -635, -9000, 13495, 0] };
const SILENCE_TICKS: u16 = RESTART_TICKS + 5; // slightly more than a second; the real value only takes longer
const LATE: [u8; 3] = [1, 2, 3]; // of a late frame

pub type Wrong = &'static str;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    CommandLost,
    CommandDamaged,
    CommandDoubled,
    CommandLate,
    AnswerLost,
    AnswerDamaged,
    AnswerDoubled,
    AnswerLate,
    CtsLow, // the host's DTR is off for a tick
    DtrLow, // the controller's DTR is off for a tick
    Hold,
    Interrupt,
    Restart,
    Cancel,
}

pub const KINDS: [Kind; 14] = [
    Kind::CommandLost,
    Kind::CommandDamaged,
    Kind::CommandDoubled,
    Kind::CommandLate,
    Kind::AnswerLost,
    Kind::AnswerDamaged,
    Kind::AnswerDoubled,
    Kind::AnswerLate,
    Kind::CtsLow,
    Kind::DtrLow,
    Kind::Hold,
    Kind::Interrupt,
    Kind::Restart,
    Kind::Cancel,
];

#[derive(Clone, Debug)]
pub struct Setting {
    pub functions: bool,
    pub faults: u8, // at most, per run
    pub kinds: Vec<Kind>,
    pub all_bits: bool, // each bit and byte of a frame is damaged, not one per part
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carried {
    AsSent,
    Lost,
    Flipped(u8), // this bit is inverted
    Short(u8),   // this byte is lost
    Doubled(u8), // again, this many ticks later
    Late(u8),    // with all frames after it, ticks
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Panel {
    Nothing,
    Start,
    Enter,
    Cancel,
    Interrupt,
    Hold,
    Release,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    Next, // as soon as the host can send it
    Restart,
    Cancel,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    pub wanted: Wanted,
    pub dtr_low: bool,
    pub command: Carried,
    pub cts_low: bool,
    pub panel: Panel,
    pub answer: Carried,
}

pub const QUIET: Event = Event {
    wanted: Wanted::Next,
    dtr_low: false,
    command: Carried::AsSent,
    cts_low: false,
    panel: Panel::Nothing,
    answer: Carried::AsSent,
};

#[derive(Clone, Debug, Default, PartialEq)]
struct Line(Vec<(u8, Vec<u8>)>); // frames in order, each with its remaining ticks

impl Line {
    fn send(&mut self, frame: &[u8], carried: Carried) {
        if frame.is_empty() {
            return;
        }
        let mut frame = frame.to_vec();
        let late = |ticks: u8, line: &Self| line.0.last().map_or(ticks, |(before, _)| ticks.max(*before));
        match carried {
            Carried::AsSent => {}
            Carried::Lost => return,
            Carried::Flipped(bit) => frame[usize::from(bit / 8)] ^= 1 << (bit % 8),
            Carried::Short(byte) => drop(frame.remove(usize::from(byte))),
            Carried::Doubled(_) => self.0.push((late(0, self), frame.clone())),
            Carried::Late(_) => {}
        }
        let ticks = if let Carried::Doubled(ticks) | Carried::Late(ticks) = carried { ticks } else { 0 };
        self.0.push((late(ticks, self), frame));
    }

    fn arrive(&mut self) -> LinkBytes {
        let mut bytes = LinkBytes::default();
        self.0.retain_mut(|(ticks, frame)| {
            let arrives = *ticks == 0;
            if arrives {
                assert_eq!(bytes.extend(frame), frame.len(), "more arrives in a tick than can be sent");
            }
            *ticks = ticks.saturating_sub(1);
            !arrives
        });
        bytes
    }

    fn add_to(&self, image: &mut Image) {
        image.add(&[u8::try_from(self.0.len()).unwrap()]);
        for (ticks, frame) in &self.0 {
            image.add(&[*ticks, u8::try_from(frame.len()).unwrap()]);
            image.add(frame);
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct OnRing {
    at: i16,
    may_repeat: bool, // the present point may be commanded again
    wrong: Option<Wrong>,
}

fn point(at: i16) -> Plate {
    let mut plate = AT;
    plate.words[0] = at;
    plate
}

impl Robot for OnRing {
    fn present(&mut self) -> Plate {
        point(self.at)
    }

    fn accept(&mut self, goal: &Plate) -> Result<(), Refusal> {
        let to = goal.words[0];
        assert_eq!(*goal, point(to), "a position that was never sent");
        self.wrong = match (to - self.at).rem_euclid(RING) {
            0 if self.may_repeat => None,
            0 => Some("a point is executed twice"),
            1 => None,
            2 => Some("a point is skipped"),
            _ => Some("the robot goes back to a point"),
        };
        self.at = to;
        Ok(())
    }
}

#[derive(Clone)]
pub struct State {
    host: Host,
    controller: Controller,
    robot: OnRing,
    to_controller: Line,
    to_host: Line,
    dtr: bool,
    hold: bool,
    outstanding: bool, // a data command, neither answered nor given up
    faults: u8,        // remaining
}

impl State {
    pub fn first(setting: &Setting) -> Self {
        let mut host = Host::new(ANSWER_TICKS);
        host.set_silence_limit(SILENCE_TICKS);
        Self {
            host,
            controller: Controller::new(Limits::NBS),
            robot: OnRing { at: 0, may_repeat: !setting.functions, wrong: None },
            to_controller: Line::default(),
            to_host: Line::default(),
            dtr: false,
            hold: false,
            outstanding: false,
            faults: setting.faults,
        }
    }

    /// Everything that affects later ticks.
    pub fn image(&self) -> Image {
        let mut image = Image::default();
        image.add_host(&self.host, self.faults);
        image.add_plain(&self.controller);
        self.to_controller.add_to(&mut image);
        self.to_host.add_to(&mut image);
        let flags = [self.dtr, self.hold, self.outstanding].map(u8::from);
        image.add(&[u8::try_from(self.robot.at).unwrap(), flags[0], flags[1], flags[2], self.faults]);
        image
    }

    /// Returns the sent bytes; true if a command was acknowledged.
    fn host_half(
        &mut self,
        (wanted, dtr_low): (Wanted, bool),
        functions: bool,
    ) -> Result<(LinkBytes, bool), Wrong> {
        let arrived = self.to_host.arrive();
        let event = self.host.receive(&arrived, self.dtr && !dtr_low);
        let is_true = self.host.position().words[0] == self.robot.at;
        match event {
            HostEvent::Acknowledged if !is_true => return Err("a false answer is accepted"),
            HostEvent::Started if !is_true => return Err("a false report is accepted"),
            HostEvent::Started => self.host.clear_fault(),
            HostEvent::Acknowledged | HostEvent::Lost | HostEvent::None => {}
        }
        self.outstanding &= event == HostEvent::None;
        let next = point((self.host.position().words[0] + 1).rem_euclid(RING));
        let function = if functions { [1, 1] } else { NO_FUNCTION };
        let intent = match wanted {
            Wanted::Next => Intent::Position(DataCommand { function, plate: next }),
            Wanted::Restart => Intent::Restart,
            Wanted::Cancel => Intent::Cancel,
        };
        if wanted == Wanted::Restart {
            self.host.clear_fault();
        }
        let mut tx = LinkBytes::default();
        let sent = self.host.transmit(&intent, &mut tx);
        if usize::from(tx.length) == FRAME_BYTES {
            if sent && self.outstanding {
                return Err("two commands are outstanding");
            }
            self.outstanding = true;
        } else if tx.length > 0 {
            self.outstanding = false;
        }
        Ok((tx, event == HostEvent::Acknowledged))
    }

    fn controller_half(&mut self, cts_low: bool, panel: Panel) -> Result<LinkBytes, Wrong> {
        self.hold = match panel {
            Panel::Hold => true,
            Panel::Release => false,
            _ => self.hold,
        };
        let inputs = ControllerInputs {
            rx: self.to_controller.arrive(),
            cts: !cts_low,
            board: true,
            start: panel == Panel::Start,
            enter: panel == Panel::Enter,
            cancel: panel == Panel::Cancel,
            interrupt: panel == Panel::Interrupt,
            hold: self.hold,
            ..Default::default()
        };
        let out = self.controller.step(&inputs, &mut self.robot);
        self.dtr = out.dtr;
        self.robot.wrong.map_or(Ok(out.tx), Err)
    }

    /// Visits each possible tick with its result. `good`: a command was acknowledged, or a stop is reported.
    pub fn each_next(
        &self,
        setting: &Setting,
        mut visit: impl FnMut(Event, Result<(Self, bool), Wrong>) -> Result<(), Wrong>,
    ) -> Result<(), Wrong> {
        for (wanted, dtr_low) in self.wanted(setting) {
            let mut one = self.clone();
            one.faults -= u8::from(dtr_low) + u8::from(wanted != Wanted::Next);
            let event = Event { wanted, dtr_low, ..QUIET };
            let (sent, acknowledged) = match one.host_half((wanted, dtr_low), setting.functions) {
                Err(wrong) => {
                    visit(event, Err(wrong))?;
                    continue;
                }
                Ok(half) => half,
            };
            for command in carried(sent.as_slice(), one.faults, setting, true) {
                let mut two = one.clone();
                two.faults -= u8::from(command != Carried::AsSent);
                two.to_controller.send(sent.as_slice(), command);
                for (cts_low, panel) in two.panel(setting) {
                    let mut three = two.clone();
                    let fault = cts_low || matches!(panel, Panel::Hold | Panel::Interrupt);
                    three.faults -= u8::from(fault);
                    let event = Event { command, cts_low, panel, ..event };
                    let answered = match three.controller_half(cts_low, panel) {
                        Err(wrong) => {
                            visit(event, Err(wrong))?;
                            continue;
                        }
                        Ok(answered) => answered,
                    };
                    let good = acknowledged || three.is_reported();
                    for answer in carried(answered.as_slice(), three.faults, setting, false) {
                        let mut next = three.clone();
                        next.faults -= u8::from(answer != Carried::AsSent);
                        next.to_host.send(answered.as_slice(), answer);
                        visit(Event { answer, ..event }, Ok((next, good)))?;
                    }
                }
            }
        }
        Ok(())
    }

    /// The controller has stopped, and the host reports it.
    fn is_reported(&self) -> bool {
        let stopped = self.hold || self.controller.state() != ControllerState::Running;
        let host = &self.host;
        let says = host.fault() != LinkFault::None || host.is_silent() || !host.has_dtr();
        stopped && (says || host.state() == HostState::Ended)
    }

    pub fn help(&self) -> Panel {
        match self.controller.state() {
            _ if self.hold => Panel::Release,
            ControllerState::Off | ControllerState::Ended => Panel::Start,
            ControllerState::Warning => Panel::Enter,
            ControllerState::PreManual => Panel::Cancel,
            ControllerState::Running => Panel::Nothing,
        }
    }

    fn wanted(&self, setting: &Setting) -> Vec<(Wanted, bool)> {
        let can = |kind| self.faults > 0 && setting.kinds.contains(&kind);
        let mut all = vec![(Wanted::Next, false)];
        all.extend(can(Kind::DtrLow).then_some((Wanted::Next, true)));
        // After a fault the user may restart at any time.
        all.extend(can(Kind::Restart).then_some((Wanted::Restart, false)));
        all.extend(can(Kind::Cancel).then_some((Wanted::Cancel, false)));
        all
    }

    fn panel(&self, setting: &Setting) -> Vec<(bool, Panel)> {
        let can = |kind| self.faults > 0 && setting.kinds.contains(&kind);
        let mut all = vec![(false, Panel::Nothing)];
        match self.controller.state() {
            ControllerState::Off | ControllerState::Ended => all.push((false, Panel::Start)),
            ControllerState::Warning => all.extend([(false, Panel::Enter), (false, Panel::Cancel)]),
            ControllerState::PreManual => all.push((false, Panel::Cancel)),
            ControllerState::Running => {}
        }
        all.extend(self.hold.then_some((false, Panel::Release)));
        all.extend(can(Kind::CtsLow).then_some((true, Panel::Nothing)));
        all.extend((can(Kind::Hold) && !self.hold).then_some((false, Panel::Hold)));
        let running = self.controller.state() == ControllerState::Running;
        all.extend((can(Kind::Interrupt) && running).then_some((false, Panel::Interrupt)));
        all
    }
}

fn carried(frame: &[u8], faults: u8, setting: &Setting, command: bool) -> Vec<Carried> {
    let mut all = vec![Carried::AsSent];
    if frame.is_empty() || faults == 0 {
        return all;
    }
    let kinds = if command {
        [Kind::CommandLost, Kind::CommandDamaged, Kind::CommandDoubled, Kind::CommandLate]
    } else {
        [Kind::AnswerLost, Kind::AnswerDamaged, Kind::AnswerDoubled, Kind::AnswerLate]
    };
    let [lost, damaged, doubled, late] = kinds.map(|kind| setting.kinds.contains(&kind));
    let bytes = u8::try_from(frame.len()).unwrap();
    all.extend(lost.then_some(Carried::Lost));
    if damaged && (setting.all_bits || bytes == 1) {
        all.extend((0..8 * bytes).map(Carried::Flipped));
        all.extend((0..bytes).skip(1).map(Carried::Short));
    } else if damaged {
        // First byte, last byte of a report's head, a word, the checksum.
        all.extend([0, 16, 64, 120].map(Carried::Flipped));
        all.extend([0, 8, 15].map(Carried::Short));
    }
    if doubled {
        all.push(Carried::Doubled(0));
        all.extend(LATE.map(Carried::Doubled));
    }
    if late {
        all.extend(LATE.map(Carried::Late));
    }
    all
}
