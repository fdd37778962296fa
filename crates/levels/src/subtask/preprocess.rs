use geometry::pose::Pose;
use interfaces::{
    StatusReport,
    emove::{EmoveStatus, EmoveVerb, Holding},
    pedestal::{PedestalReport, PedestalVerb},
    process::Inputs,
    subtask::{SubtaskCommand, SubtaskVerb},
};
use rcs_core::handshake::Lower;
use taskdata::files::TaskData;

use super::{
    aims::{Aims, SubtaskAim},
    goals::proof,
    manual::{manual, robot_there},
    pedestal_hand::{hand, pedestal_hand, turn},
    state::State,
    tables::{
        GripHeld, Interlock, Leaving, Named, PedestalData, Request, Situation, StateVariables, Subordinates,
        SubtaskDrum, SubtaskExchange, SubtaskGripper, SubtaskPedestal, SubtaskRecipient, SubtaskRobot,
        SubtaskVision, Where, by_hand::RobotAtPedestal,
    },
};
use crate::{
    execution::{Asked, Work},
    halt::{Above, Below, BoxState, Intake, Kind, Replaced},
    held::Held,
    places::{Missing, pose_of},
};

impl State {
    pub(super) fn sense(&mut self, inputs: &Inputs<'_, TaskData<'_>>) -> StateVariables {
        let command = &inputs.memory.task.subtask;
        self.adopt(inputs);
        let (emove, pedestal) = (self.emove(inputs), self.pedestal(inputs));
        self.sense_hand(&inputs.memory.pedestal.status, pedestal);
        let (arrival, asked) = self.execution.observe(inputs.tick, command.number);
        let request = if asked == Asked::Now { self.look_up(command, inputs) } else { Request::default() };
        let situation = self.situation(command, inputs);
        StateVariables {
            arrival,
            asked,
            replaced: replaced(command, emove, pedestal, inputs),
            verb: command.command,
            request,
            interlock: Interlock {
                asked,
                pedestal: pedestal_hand(&inputs.memory.pedestal.status),
                verb: command.command,
                gripper: situation.gripper,
                robot: leaving(inputs),
            },
            manual: manual(
                &inputs.external.operator.pedestal.unwrap_or_default(),
                inputs.tick,
                inputs.memory,
                inputs.data,
            ),
            subordinates: Subordinates { ordered: self.ordered, emove, pedestal },
            proof: proof(command, &situation, &inputs.memory.emove.status, &inputs.memory.pedestal.status),
            situation,
        }
    }

    /// Before the first command after a start, adopt the output buffers from before it.
    fn adopt(&mut self, inputs: &Inputs<'_, TaskData<'_>>) {
        let (tick, memory, written) = (inputs.tick, inputs.memory, &inputs.memory.subtask);
        self.emove.start_from(tick, written.emove.number, memory.emove.status.echo);
        self.pedestal.start_from(tick, written.pedestal.number, memory.pedestal.status.echo);
        if !self.execution.receiver.started {
            self.regrip = written.regrip;
            self.last_pose = written.poses.iter().filter_map(|pose| pose.number).max().unwrap_or_default();
        }
    }

    /// Look up the locations that Task does not name, and the pedestal data for FIX-GRIP. Incomplete results are not
    /// stored.
    fn look_up(&mut self, command: &SubtaskCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Request {
        self.ordered = SubtaskRecipient::Nothing;
        let emove = &inputs.memory.emove.status;
        let aims = Aims::new(command, emove.end_effector_id, emove.exchange, inputs.data);
        let ped_para = match command.command {
            SubtaskVerb::FixGrip => {
                command.object.and_then(|object| inputs.data.ped_para(&object)).map(|(_, para)| *para)
            }
            _ => None,
        };
        if let Ok(aims) = aims {
            self.aims = aims;
            self.ped_para = ped_para.unwrap_or_default();
        }
        Request {
            asked: Asked::Now,
            verb: command.command,
            named: named(command),
            pedestal: if ped_para.is_some() { PedestalData::Found } else { PedestalData::Missing },
            missing: aims.err().unwrap_or(Missing::Nothing),
        }
    }

    fn situation(&self, command: &SubtaskCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Situation {
        let (emove, pedestal) = (&inputs.memory.emove.status, &inputs.memory.pedestal.status);
        let held = Held::of(emove.held, command.object);
        // A restarted process has no last pose to compare.
        let is_at = |last: Option<Pose>| last.is_none() || last == location_pose(command, inputs);
        Situation {
            work: Work::Busy,
            held,
            grip: grip_held(emove, command),
            seat: emove.seat,
            vision: vision(emove, is_at(self.located_at), command, inputs.data),
            gripper: match emove.end_effector_id {
                None => SubtaskGripper::None,
                Some(id) if command.end_effector_id.is_none_or(|wanted| wanted == id) => {
                    SubtaskGripper::Right
                }
                Some(_) => SubtaskGripper::Wrong,
            },
            exchange: match emove.exchange {
                None => SubtaskExchange::None,
                Some(id) if command.end_effector_id.is_none_or(|wanted| wanted == id) => {
                    SubtaskExchange::Wanted
                }
                Some(_) => SubtaskExchange::Other,
            },
            station: if is_at(self.gone_to) { station(emove, command) } else { Where::Elsewhere },
            placed: placed(emove, command),
            drum: match emove.at {
                _ if emove.drum => SubtaskDrum::Inside,
                Some(_) => SubtaskDrum::Outside,
                None => SubtaskDrum::Unplaced,
            },
            named: named(command),
            part: self.part(held, pedestal, command),
            table: turn(pedestal, &self.ped_para),
            hand: hand(pedestal, &self.ped_para),
            robot: robot(emove, &self.aims),
        }
    }

    fn emove(&self, inputs: &Inputs<'_, TaskData<'_>>) -> Lower {
        self.emove.status_of(inputs.tick, &inputs.memory.emove)
    }

    fn pedestal(&self, inputs: &Inputs<'_, TaskData<'_>>) -> SubtaskPedestal {
        let pedestal = &inputs.memory.pedestal;
        match self.pedestal.status_of(inputs.tick, pedestal) {
            Lower::Pending | Lower::Executing => SubtaskPedestal::Moving,
            Lower::Done => SubtaskPedestal::Done,
            Lower::Error | Lower::Joystick if pedestal.status.report == PedestalReport::CannotDo => {
                SubtaskPedestal::Cannot
            }
            Lower::Error | Lower::Joystick => SubtaskPedestal::Faulty,
            Lower::Lost => SubtaskPedestal::Silent,
        }
    }
}

fn replaced(
    command: &SubtaskCommand,
    emove: Lower,
    pedestal: SubtaskPedestal,
    inputs: &Inputs<'_, TaskData<'_>>,
) -> Replaced {
    let written = &inputs.memory.subtask;
    let robot = Below::of(emove, written.emove.command == EmoveVerb::Pause);
    let turning = if pedestal == SubtaskPedestal::Moving { Lower::Executing } else { Lower::Done };
    let part = Below::of(turning, written.pedestal.command == PedestalVerb::Pause);
    let on = inputs.memory.emove.status.report == StatusReport::JoystickOn;
    Replaced {
        intake: Intake::Taken,
        kind: if command.command == SubtaskVerb::Pause { Kind::Pause } else { Kind::Other },
        above: Above::of(&inputs.memory.task.header, inputs.tick),
        joystick: if on { BoxState::On } else { BoxState::Off },
        below: robot.and(part),
    }
}

fn grip_held(emove: &EmoveStatus, command: &SubtaskCommand) -> GripHeld {
    match emove.held {
        Holding::Object(held) if Some(held.object) != command.object => GripHeld::Neither,
        Holding::Object(held) if held.grip == command.destination_grip => GripHeld::Destination,
        Holding::Object(held) if held.grip == command.source_grip => GripHeld::Source,
        Holding::Object(_) | Holding::Nothing | Holding::Something | Holding::NotKnown => GripHeld::Neither,
    }
}

pub(super) fn location_pose(command: &SubtaskCommand, inputs: &Inputs<'_, TaskData<'_>>) -> Option<Pose> {
    pose_of(command.pose?, inputs.memory, inputs.data).map(|frame| Pose::from_frame(&frame))
}

/// `is_at` is true if the last pictures were taken at the command's location.
fn vision(emove: &EmoveStatus, is_at: bool, command: &SubtaskCommand, data: &TaskData<'_>) -> SubtaskVision {
    let located = emove.located.is_some_and(|located| {
        is_at && Some(located.object) == command.object && located.site == command.site
    });
    let view = command.object.and_then(|object| data.view(&object, &command.site.place()));
    if !view.is_some_and(|(_, view)| view.enabled) {
        SubtaskVision::NotNeeded
    } else if located {
        SubtaskVision::Done
    } else {
        SubtaskVision::Needed
    }
}
fn station(emove: &EmoveStatus, command: &SubtaskCommand) -> Where {
    match emove.at {
        Some(at) if at.grip == Some(command.source_grip) && at.site == command.site => Where::There,
        _ => Where::Elsewhere,
    }
}
fn placed(emove: &EmoveStatus, command: &SubtaskCommand) -> Where {
    let what = (command.object, command.destination_grip);
    match emove.placed {
        Some(it) if (Some(it.object), it.grip) == what && it.site == command.site => Where::There,
        _ => Where::Elsewhere,
    }
}
fn robot(emove: &EmoveStatus, aims: &Aims) -> SubtaskRobot {
    let Some(at) = emove.at else { return SubtaskRobot::Away };
    let is_at = |aim: &SubtaskAim| aim.site.name().is_some() && at.site == aim.site;
    if is_at(&aims.first) && at.grip == Some(aims.first.grip) {
        SubtaskRobot::First
    } else if is_at(&aims.third) && at.grip == Some(aims.third.grip) {
        SubtaskRobot::Third
    } else if is_at(&aims.second) {
        SubtaskRobot::Safe
    } else {
        SubtaskRobot::Away
    }
}
fn leaving(inputs: &Inputs<'_, TaskData<'_>>) -> Leaving {
    let is_empty = inputs.memory.emove.status.held == Holding::Nothing;
    match robot_there(inputs.memory, inputs.data) {
        RobotAtPedestal::Clear if is_empty => Leaving::Empty,
        RobotAtPedestal::Clear | RobotAtPedestal::Near | RobotAtPedestal::Grips => Leaving::Bound,
    }
}

fn named(command: &SubtaskCommand) -> Named {
    if command.object.is_some() { Named::Object } else { Named::Location }
}
