use core::f64::consts::PI;

use depc::{
    host::Intent,
    step::Position,
    wire::{DataCommand, NO_FUNCTION},
};
use geometry::{kinematics::T3, pose::WireFrame};
use interfaces::{
    T3iOutputs,
    device::{LinkBytes, RESOLVER_COUNTS, Resolvers},
    process::Inputs,
    t3i::{LinkFault, PathLeft, SentWords, T3iReport, T3iStatus},
};
use rcs_core::handshake::Arrival;

use super::{
    state::State,
    tables::{
        Action, Before, StateVariables, Step,
        follow::Supervision,
        receive::{ReceiveStep, T3iIntake},
        report::Comparison,
    },
};

impl State {
    pub(super) fn take(&mut self, intake: T3iIntake, seen: &StateVariables) {
        let arrival = seen.request.arrival;
        if matches!(arrival, Arrival::New | Arrival::Restarted) {
            self.command = seen.command.command;
        }
        if arrival == Arrival::New {
            self.step = Step::first(self.command);
        }
        match intake {
            T3iIntake::Keep | T3iIntake::Ignore => {}
            T3iIntake::Restart => {
                self.empty();
                self.host.clear_fault();
                self.left = None;
            }
            T3iIntake::Pause | T3iIntake::Refuse => self.empty(),
            T3iIntake::Append => self.append(seen.command.frame),
        }
    }

    pub(super) fn compare(&mut self, comparison: Comparison) {
        match comparison {
            Comparison::Keep => {}
            Comparison::TakeRepeated => {
                let here = self.position.plate.words;
                self.sent = Some(SentWords { last: here, before: here });
            }
        }
    }

    pub(super) fn supervise(&mut self, supervision: Supervision, seen: &StateVariables) {
        match supervision {
            Supervision::Continue => {}
            Supervision::Stop => {
                self.empty();
                self.left = Some(PathLeft {
                    commanded: WireFrame::from_frame(&self.position.plate.to_tool(&T3)),
                    fed_back: seen.resolvers,
                    deviation: self.deviation,
                });
            }
        }
    }

    pub(super) fn send(&mut self, action: Action, seen: &StateVariables) -> LinkBytes {
        let mut tx = LinkBytes::default();
        let command = |position: &Position| {
            Intent::Position(DataCommand { function: NO_FUNCTION, plate: position.plate })
        };
        self.before = Before::Nothing;
        match action {
            Action::Nothing(_) => drop(self.host.transmit(&Intent::Idle, &mut tx)),
            Action::Restart(_) => drop(self.host.transmit(&Intent::Restart, &mut tx)),
            Action::Repeat(report) => {
                let words = self.position.plate.words;
                let other = self.sent.is_none_or(|sent| sent.last != words);
                if self.host.transmit(&command(&self.position), &mut tx)
                    && other
                    && report != T3iReport::Error
                {
                    self.before = Before::Repeated;
                }
            }
            Action::Advance(_) => {
                if let Some(next) = seen.advance
                    && self.host.transmit(&command(&next.position), &mut tx)
                {
                    let (last, before) = (next.position.plate.words, self.position.plate.words);
                    self.sent = Some(SentWords { last, before });
                    self.before = Before::Point;
                    self.position = next.position;
                    if next.reached {
                        self.remove_first();
                    } else {
                        self.host.count_limited();
                    }
                }
            }
            Action::Refuse(_) => {
                self.empty();
                self.receive = ReceiveStep::Refusing;
                self.host.transmit(&command(&self.position), &mut tx);
            }
        }
        if self.host.is_running() {
            self.track.push(self.position.plate);
        }
        tx
    }

    pub(super) fn outputs<Data: ?Sized>(
        &self,
        action: Action,
        link_tx: LinkBytes,
        seen: &StateVariables,
        inputs: &Inputs<'_, Data>,
    ) -> T3iOutputs {
        let resolver_frame = seen.resolvers;
        let running = self.host.is_running();
        let header = self.rows.header(inputs.tick, self.step.text());
        let status = T3iStatus {
            cycle: inputs.tick,
            cycle_echo: inputs.memory.prim.t3i.cycle,
            echo: self.receiver.echo,
            command: self.command,
            report: action.report(),
            fault: match self.host.fault() {
                LinkFault::None if self.receive == ReceiveStep::Refusing => LinkFault::InvalidCommand,
                fault => fault,
            },
            frame_feedback: if running {
                WireFrame::from_frame(&self.position.plate.to_tool(&T3))
            } else {
                resolver_frame
            },
            scale_factor: i32::try_from(RESOLVER_COUNTS).unwrap_or(i32::MAX),
            joint_limit: 0,
            resolver_frame: Some(resolver_frame).filter(|_| inputs.external.devices.resolvers.valid),
            link_running: running,
            controller_ready: self.host.has_dtr(),
            silent: self.host.is_silent(),
            check: self.check,
            sent: self.sent,
            following: self.following,
            deviation: self.deviation,
            left: self.left,
            counters: *self.host.counters(),
        };
        T3iOutputs { header, status, link_tx }
    }
}

impl Action {
    const fn report(self) -> T3iReport {
        match self {
            Self::Nothing(report)
            | Self::Restart(report)
            | Self::Repeat(report)
            | Self::Advance(report)
            | Self::Refuse(report) => report,
        }
    }
}

/// Counts beyond 17 bits are whole turns and do not matter.
pub(super) fn resolver_frame(resolvers: &Resolvers) -> WireFrame {
    let turn = 2.0 * PI / f64::from(RESOLVER_COUNTS);
    WireFrame::from_frame(
        &T3.forward(&resolvers.counts.map(|counts| f64::from(counts % RESOLVER_COUNTS) * turn)),
    )
}
