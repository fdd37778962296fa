use std::collections::VecDeque;

use geometry::pose::WireFrame;
use interfaces::{
    CommonMemory, Header, T3iOutputs,
    t3i::{Following, LinkFault, ReportCheck, T3iReport, T3iVerb},
};
use rcs_core::{
    handshake::{Arrival, Receiver, successor},
    tick::Tick,
};

const QUEUE: usize = 4;

/// T3I and everything below it, as Prim sees them: a model that stalls, fails and checks the order of points.
#[derive(Clone, Default)]
pub struct ModelT3i {
    pub receiver: Receiver,
    pub command: T3iVerb,
    pub queue: VecDeque<WireFrame>,
    pub output: WireFrame,
    pub starting: Option<u32>, // ticks until the link runs
    pub running: bool,
    pub fault: LinkFault,
    pub broken: LinkFault, // fault of each start of the link; without a fault the link runs
    pub more_faults: u32,  // faults after the link runs again
    pub dtr_off: bool,
    pub elsewhere: bool,      // the robot is not at its commanded position
    pub path: Vec<WireFrame>, // frames sent to the robot, without repetitions
    pub off: i32,             // offset of the resolvers from the output, 0.01 in
    pub dead: bool,           // T3I is not stepped; its last outputs stay
    pub held: bool,           // T3I is held; its last outputs are republished
    pub deaf: bool,           // T3I reads no command, and continues with the last one
    pub left: bool,           // the robot has left its path
    pub misplaced: bool,      // the robot is off its path again after each RESTART
}

impl ModelT3i {
    pub fn step(&mut self, tick: Tick, memory: &CommonMemory, stalled: bool) -> T3iOutputs {
        if self.dead {
            return memory.t3i;
        }
        if self.held {
            let header = Header { stamp: tick, republished: true, ..memory.t3i.header };
            return T3iOutputs { header, ..memory.t3i };
        }
        let command = &memory.prim.t3i;
        let expected = successor(self.receiver.echo);
        if !self.deaf && self.receiver.observe(command.number) == Arrival::New {
            self.command = command.command;
            match command.command {
                T3iVerb::Restart => {
                    (self.fault, self.running, self.starting) = (LinkFault::None, false, Some(7));
                    self.left = self.misplaced;
                    self.queue.clear();
                }
                T3iVerb::Point if self.fault != LinkFault::None || self.left => {}
                T3iVerb::Point => {
                    assert_eq!(command.number, expected, "a point is missing");
                    assert!(self.running, "a point before the link runs");
                    assert!(self.queue.len() < QUEUE, "the queue overruns");
                    self.queue.push_back(command.frame);
                }
                T3iVerb::Pause => {
                    self.queue.clear();
                    if self.fault == LinkFault::InvalidCommand {
                        self.fault = LinkFault::None;
                    }
                }
                T3iVerb::None => panic!("an unknown command"),
            }
        }
        if self.starting.is_some_and(|left| left == 0) {
            self.starting = None;
            self.fault = if self.dtr_off { LinkFault::NotResponding } else { self.broken };
            self.running = self.fault == LinkFault::None;
        }
        if self.running && self.more_faults > 0 {
            (self.fault, self.more_faults) = (LinkFault::Checksum, self.more_faults - 1);
        }
        self.starting = self.starting.map(|left| left - 1);
        let stalled = stalled || memory.prim.header.republished;
        if self.fault != LinkFault::None {
            self.running = false;
            self.queue.clear();
        }
        if self.left {
            self.queue.clear();
        }
        if !stalled && let Some(point) = self.queue.pop_front() {
            self.output = point;
            self.path.push(point);
        }
        self.outputs(tick)
    }

    fn outputs(&self, tick: Tick) -> T3iOutputs {
        let mut outputs =
            T3iOutputs { header: Header { stamp: tick, ..Header::default() }, ..T3iOutputs::default() };
        let status = &mut outputs.status;
        status.echo = self.receiver.echo;
        status.command = self.command;
        status.fault = self.fault;
        status.report = match self.queue.len() {
            _ if self.fault != LinkFault::None || self.left => T3iReport::Error,
            _ if self.starting.is_some() => T3iReport::Executing,
            0 => T3iReport::Finished,
            1 | 2 => T3iReport::Ready,
            _ => T3iReport::Executing,
        };
        status.following = if self.left { Following::OffPath } else { Following::OnPath };
        status.frame_feedback = self.output;
        let mut seen = self.output;
        seen.tool[0] += self.off;
        status.resolver_frame = Some(seen);
        status.link_running = self.running;
        status.controller_ready = !self.dtr_off;
        status.check = match (self.starting, self.broken) {
            (None, LinkFault::None) if self.elsewhere => ReportCheck::Elsewhere,
            (None, LinkFault::None) => ReportCheck::AsSent,
            _ => ReportCheck::NoReport,
        };
        outputs
    }
}
