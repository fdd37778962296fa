//! T3 Interface (VI.1): turns the frames of Prim into positions on the DEPC line, resolver angles into a frame, and watches the
//! link.
//!
//! Prim may send a point every tick. T3I queues them by number, sends one frame a tick, and says in its status whether it
//! wants another:
//!
//! | tick | Prim | T3I | line | controller |
//! |---|---|---|---|---|
//! | k   | writes point n | | | |
//! | k+1 | writes n+1 | reads n, sends it, reports 3 | frame n | acknowledges n and moves |
//! | k+2 | reads 3, writes n+2 | reads the ACK of n, sends n+1 | frame n+1 | acknowledges n+1 and moves |
//!
//! While nothing moves the last position is repeated every tick, so that a dead link is noticed within three ticks. A
//! point beyond the velocity limits stays in the queue and is approached as fast as they allow. RESTART, PAUSE and the loss
//! of the link empty the queue; while Prim is held or lost the queue waits and the position stands.
//!
//! * [`tables`]: the decision tables; * [`state`]: what is remembered; * this module: the three phases.

pub mod state;
pub mod tables;
#[cfg(test)]
mod tests;

use core::f64::consts::PI;

use depc::{
    Limits, Plate,
    host::{HostEvent, Intent},
    step::{Position, step},
    wire::{DataCommand, NO_FUNCTION},
};
use rcs_core::{
    handshake::{Arrival, successor},
    interface::{
        Header, T3iOutputs,
        device::{LinkBytes, RESOLVER_COUNTS, Resolvers},
        t3i::{LinkFault, T3iCommand, T3iReport, T3iStatus, T3iVerb},
    },
    kinematics::T3,
    pose::WireFrame,
    process::{Inputs, Process},
    table::Table,
};

pub use self::state::State;
use self::tables::{Above, Intake, Line, Link, Order, Output, Phase, Queue, Refusal, TABLES, Trouble};

/// The T3 Interface process.
#[derive(Clone, Debug)]
pub struct T3i {
    state: State,
}

impl Default for T3i {
    /// With the limits of 40 ms and three ticks for an answer.
    fn default() -> Self {
        Self { state: State::nbs() }
    }
}

/// State variables of this tick.
struct Seen {
    arrival: Arrival,
    order: Order,
    above: Above,
}

/// What was decided in this tick.
struct Decided {
    output: Output,
    report: T3iReport,
}

impl<Data: ?Sized> Process<Data> for T3i {
    type Outputs = T3iOutputs;
    type State = State;
    type Seen = ();
    type Action = ();

    const NAME: &'static str = "T3 Interface";
    const TABLES: &'static [&'static Table] = TABLES;

    fn step(&mut self, inputs: &Inputs<'_, Data>, outputs: &mut T3iOutputs) {
        let seen = self.preprocess(inputs);
        let command = &inputs.memory.prim.t3i;
        let decided = self.decide(&seen, command);
        let mut tx = LinkBytes::default();
        self.send(decided.output, &mut tx);
        *outputs = T3iOutputs {
            header: Header {
                stamp: inputs.tick,
                republished: false,
                table: self.state.table,
                row: self.state.row,
                step: rcs_core::name::Name16::EMPTY,
            },
            status: self.status(inputs, decided.report),
            link_tx: tx,
        };
    }

    fn preprocess(&mut self, _: &Inputs<'_, Data>, _: &T3iOutputs) {}

    fn decide(&mut self, (): &()) {}

    fn postprocess(&mut self, (): (), (): &(), _: &Inputs<'_, Data>, _: &mut T3iOutputs) {}

    fn state_mut(&mut self) -> &mut State {
        &mut self.state
    }

    fn state(&self) -> &State {
        &self.state
    }

    fn restore(&mut self, state: State) {
        self.state = state;
    }
}

impl T3i {
    /// A process for another period of the link, or another patience with it (`answer_ticks`, at least 1).
    #[must_use]
    pub fn new(limits: Limits, answer_ticks: u16) -> Self {
        Self { state: State::new(limits, answer_ticks) }
    }

    /// Read the line and the command buffer, and set the state variables.
    fn preprocess<Data: ?Sized>(&mut self, inputs: &Inputs<'_, Data>) -> Seen {
        let state = &mut self.state;
        let devices = &inputs.external.devices;
        // First, because a port that has taken a part of a frame is not ready either, and this says more.
        let torn = if devices.link_unsent { state.host.unsent() } else { HostEvent::None };
        match state.host.receive(&devices.link_rx, devices.link_ready).max(torn) {
            HostEvent::Started => {
                state.position = Position::reported(state.host.position(), &T3);
                state.empty();
            }
            HostEvent::Lost => state.empty(),
            HostEvent::None | HostEvent::Acknowledged => {}
        }
        let prim = &inputs.memory.prim;
        let expected = successor(state.receiver.echo);
        Seen {
            arrival: state.receiver.observe(prim.t3i.number),
            order: if prim.t3i.number != expected {
                Order::Gap
            } else if state.has_room() && has_words(&prim.t3i.frame, &state.position.plate) {
                Order::Next
            } else {
                Order::Unusable
            },
            above: if prim.header.stamp == inputs.tick.previous() && !prim.header.republished {
                Above::Live
            } else {
                Above::Still
            },
        }
    }

    /// Look the state variables up: first what to do with the command, then what it does in this tick.
    fn decide(&mut self, seen: &Seen, command: &T3iCommand) -> Decided {
        let state = &mut self.state;
        let link = match state.host.fault() {
            LinkFault::None if state.host.is_running() => Link::Running,
            LinkFault::None => Link::Starting,
            _ => Link::Failed,
        };
        let taken = tables::receive(seen.arrival, command.command, seen.order, link, state.refusal);
        (state.refusal, state.intake_row) = (taken.next, taken.row);
        if matches!(seen.arrival, Arrival::New | Arrival::Restarted) {
            state.command = command.command;
        }
        match taken.action {
            Intake::Keep | Intake::Ignore => {}
            Intake::Restart => {
                state.empty();
                state.host.forgive();
            }
            Intake::Pause | Intake::Refuse => state.empty(),
            Intake::Append => state.append(command.frame),
        }
        let (table, decision) = self.decide_output(seen);
        let refused = matches!(taken.action, Intake::Ignore | Intake::Refuse);
        (self.state.table, self.state.row) = if refused { (1, taken.row) } else { (table, decision.row) };
        Decided { output: decision.action, report: decision.next }
    }

    /// The table of the current command.
    fn decide_output(&self, seen: &Seen) -> (u8, rcs_core::table::Decision<Output, T3iReport>) {
        let state = &self.state;
        let trouble = if state.refusal == Refusal::Refused || state.host.fault() != LinkFault::None {
            Trouble::Some
        } else {
            Trouble::None
        };
        let line = if state.host.can_send() {
            Line::Free
        } else if state.host.is_running() {
            Line::Busy
        } else {
            Line::Down
        };
        let queue = match state.queued {
            0 => Queue::Empty,
            1 => Queue::One,
            _ => Queue::More,
        };
        match state.command {
            T3iVerb::Restart => {
                let phase = if seen.arrival == Arrival::New { Phase::Begun } else { Phase::Going };
                (2, tables::restart(phase, trouble, line))
            }
            T3iVerb::Point => (3, tables::point(trouble, seen.above, line, queue)),
            T3iVerb::Pause | T3iVerb::None => (4, tables::pause(trouble, line)),
        }
    }

    /// Put the frame of this tick on the line.
    fn send(&mut self, output: Output, tx: &mut LinkBytes) {
        let state = &mut self.state;
        let command = |position: &Position| {
            Intent::Position(DataCommand { function: NO_FUNCTION, plate: position.plate })
        };
        match output {
            Output::Nothing => drop(state.host.transmit(&Intent::Idle, tx)),
            Output::Restart => drop(state.host.transmit(&Intent::Restart, tx)),
            Output::Repeat => drop(state.host.transmit(&command(&state.position), tx)),
            Output::Advance => {
                let goal = state.first().and_then(|point| point.to_frame().ok());
                let next = goal.and_then(|goal| step(&state.position, &goal, &T3, &state.limits).ok());
                let Some(next) = next else {
                    state.empty();
                    state.refusal = Refusal::Refused;
                    state.host.transmit(&command(&state.position), tx);
                    return;
                };
                if state.host.transmit(&command(&next.position), tx) {
                    state.position = next.position;
                    if next.reached {
                        state.remove_first();
                    } else {
                        state.host.count_limited();
                    }
                }
            }
        }
    }

    /// The status buffer.
    fn status<Data: ?Sized>(&self, inputs: &Inputs<'_, Data>, report: T3iReport) -> T3iStatus {
        let state = &self.state;
        let resolvers = &inputs.external.devices.resolvers;
        let resolver_frame = resolver_frame(resolvers);
        let running = state.host.is_running();
        let fault = if state.host.fault() == LinkFault::None && state.refusal == Refusal::Refused {
            LinkFault::InvalidCommand
        } else {
            state.host.fault()
        };
        T3iStatus {
            cycle: inputs.tick,
            cycle_echo: inputs.memory.prim.t3i.cycle,
            echo: state.receiver.echo,
            command: state.command,
            report,
            fault,
            frame_feedback: if running {
                WireFrame::from_frame(&state.position.plate.to_tool(&T3))
            } else {
                resolver_frame
            },
            scale_factor: i32::try_from(RESOLVER_COUNTS).unwrap_or(i32::MAX),
            joint_limit: 0,
            resolver_frame,
            resolver_valid: resolvers.valid,
            link_running: running,
            counters: *state.host.counters(),
        }
    }
}

/// True if the frame is one and its end plate has words on the line.
fn has_words(frame: &WireFrame, near: &Plate) -> bool {
    frame.to_frame().is_ok_and(|tool| Plate::from_tool(&tool, &T3, near).is_ok())
}

/// The tool frame at the angles of the resolvers; counts beyond 17 bits are turns too many and do not matter.
fn resolver_frame(resolvers: &Resolvers) -> WireFrame {
    let turn = 2.0 * PI / f64::from(RESOLVER_COUNTS);
    WireFrame::from_frame(
        &T3.forward(&resolvers.counts.map(|counts| f64::from(counts % RESOLVER_COUNTS) * turn)),
    )
}
