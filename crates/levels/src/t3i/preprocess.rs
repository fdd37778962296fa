use depc::{
    Plate,
    host::{HostEvent, SILENCE_LIMIT_TICKS},
    step::{Position, Step, step},
    track,
};
use geometry::{kinematics::T3, pose::WireFrame, units::hundredths};
use interfaces::{
    T3iOutputs,
    process::Inputs,
    t3i::{Following, LinkFault, SentWords, T3iCommand, T3iVerb},
};
use rcs_core::handshake::{Arrival, successor};

use super::{
    postprocess::resolver_frame,
    state::{GRACE_TICKS, State},
    tables::{
        Answer, Dtr, Feedback, Followed, Grace, LinkStart, NextPosition, Point, PointQueue, Reported,
        Request, Restarting, Situation, StateVariables, T3iCommander, T3iLine, T3iLink, Trouble, Words,
        receive::ReceiveStep,
    },
};

/// Counts per word by which a report may differ from the sent position, because both ends round.
const NEAR_COUNTS: i32 = 2;
const TICK_MS: u16 = 40;

impl State {
    /// `outputs` are those of the previous tick. A restarted T3I reads from them what was sent.
    pub(super) fn sense<Data: ?Sized>(
        &mut self,
        inputs: &Inputs<'_, Data>,
        outputs: &T3iOutputs,
    ) -> StateVariables {
        if !self.receiver.started {
            (self.sent, self.check) = (outputs.status.sent, outputs.status.check);
            (self.following, self.left) = (outputs.status.following, outputs.status.left);
        }
        // The resolvers are compared before the line is read: a position of this tick has not reached the robot.
        let resolvers = resolver_frame(&inputs.external.devices.resolvers);
        let followed = self.followed(&resolvers, inputs);
        let (event, place) = self.receive_bytes(inputs);
        let prim = &inputs.memory.prim;
        let command = prim.t3i;
        let point = self.point(&command);
        self.rows.begin(inputs.tick);
        let arrival = self.receiver.observe(command.number);
        let restart = arrival == Arrival::New && command.command == T3iVerb::Restart;
        let devices = &inputs.external.devices;
        let answer = Answer {
            dtr: if devices.link_ready || devices.link_unsent { Dtr::On } else { Dtr::Off },
            start: match event {
                _ if restart => LinkStart::Begun,
                HostEvent::Lost => LinkStart::Begun,
                HostEvent::Started => LinkStart::Reported,
                HostEvent::None | HostEvent::Acknowledged => LinkStart::Over,
            },
            words: if self.sent.is_some() { Words::Sent } else { Words::Nothing },
            place,
            before: self.before,
        };
        let live = prim.header.stamp == inputs.tick.previous() && !prim.header.republished;
        let line = if self.host.can_send() {
            T3iLine::Free
        } else if self.host.is_running() {
            T3iLine::Busy
        } else {
            T3iLine::Down
        };
        let feedback = Feedback {
            restart: if restart { Restarting::Asked } else { Restarting::Before },
            place: followed,
            grace: if self.reported < GRACE_TICKS { Grace::Running } else { Grace::Over },
        };
        StateVariables {
            request: Request { arrival, command: command.command, point, link: self.link() },
            answer,
            feedback,
            resolvers,
            command,
            prim: if live { T3iCommander::Live } else { T3iCommander::Still },
            line,
            advance: if line == T3iLine::Free && live { self.advance(arrival, &command) } else { None },
        }
    }

    /// The queue is emptied when the link is lost.
    fn receive_bytes<Data: ?Sized>(&mut self, inputs: &Inputs<'_, Data>) -> (HostEvent, Reported) {
        let devices = &inputs.external.devices;
        self.host.set_silence_limit(devices.link_patience.unwrap_or(SILENCE_LIMIT_TICKS));
        // The torn frame is tested first: its port is not ready either, but this fault is more specific.
        let torn = if devices.link_unsent { self.host.unsent() } else { HostEvent::None };
        let event = self.host.receive(&devices.link_rx, devices.link_ready).max(torn);
        match event {
            HostEvent::Started => {
                self.position = Position::reported(self.host.position(), &T3);
                self.track.begin(self.position.plate);
                self.reported = 0;
                self.empty();
            }
            HostEvent::Lost => self.empty(),
            HostEvent::None | HostEvent::Acknowledged => {}
        }
        (event, self.place())
    }

    fn followed<Data: ?Sized>(&mut self, resolvers: &WireFrame, inputs: &Inputs<'_, Data>) -> Followed {
        let devices = &inputs.external.devices;
        self.reported = self.reported.saturating_add(1).min(GRACE_TICKS);
        let known = devices.resolvers.valid && self.host.is_running();
        let here = resolvers.to_frame().ok().filter(|_| known);
        let lag = devices.robot_lag.unwrap_or(track::LAG_MS);
        let distance = here.and_then(|here| self.track.distance(&here, lag, TICK_MS, &T3));
        self.deviation = hundredths(distance.unwrap_or(0.0));
        match distance {
            None => Followed::Unknown,
            Some(inches) if inches <= track::LIMIT_INCHES => Followed::Near,
            Some(_) => Followed::Far,
        }
    }

    /// The last reported position, compared with the commanded path.
    fn place(&self) -> Reported {
        let reported = self.host.position();
        let near = |sent: &SentWords| {
            let (last, before) = (Plate { words: sent.last }, Plate { words: sent.before });
            reported.is_between(&before, &last, NEAR_COUNTS)
        };
        if self.sent.as_ref().is_some_and(near) { Reported::Near } else { Reported::Far }
    }

    fn point(&self, command: &T3iCommand) -> Point {
        if command.number != successor(self.receiver.echo) {
            Point::Gap
        } else if !self.has_room() {
            Point::Full
        } else if has_words(&command.frame, &self.position.plate) {
            Point::Next
        } else {
            Point::Unsendable
        }
    }

    fn link(&self) -> T3iLink {
        match self.host.fault() {
            _ if self.following == Following::OffPath => T3iLink::Failed,
            LinkFault::None if self.host.is_running() => T3iLink::Running,
            LinkFault::None => T3iLink::Starting,
            _ => T3iLink::Failed,
        }
    }

    /// The next step within the limits to the oldest point, or to a new one if the queue is empty.
    fn advance(&self, arrival: Arrival, command: &T3iCommand) -> Option<Step> {
        let new =
            Some(&command.frame).filter(|_| arrival == Arrival::New && command.command == T3iVerb::Point);
        let goal = self.first().or(new)?.to_frame().ok()?;
        step(&self.position, &goal, &T3, &self.limits).ok()
    }

    /// The state variables of the command's table, once RECEIVE has decided.
    pub(super) fn situation(&self, seen: &StateVariables) -> Situation {
        Situation {
            trouble: if self.following == Following::OffPath {
                Trouble::OffPath
            } else if self.host.fault() != LinkFault::None {
                Trouble::Fault
            } else if self.receive == ReceiveStep::Refusing {
                Trouble::Refusal
            } else {
                Trouble::None
            },
            line: seen.line,
            prim: seen.prim,
            queue: match self.queued {
                0 => PointQueue::Empty,
                1 => PointQueue::One,
                _ => PointQueue::More,
            },
            way: if seen.advance.is_some() { NextPosition::Sendable } else { NextPosition::Unsendable },
        }
    }
}

/// True if the frame is valid and words on the line can express its end plate.
fn has_words(frame: &WireFrame, near: &Plate) -> bool {
    frame.to_frame().is_ok_and(|tool| Plate::from_tool(&tool, &T3, near).is_ok())
}
