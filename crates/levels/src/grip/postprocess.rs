use geometry::units::{hundredths, rounded};
use interfaces::{
    GripOutputs,
    device::{GripValves, valve},
    grip::{Felt, GripReport, GripStatus},
};
use rcs_core::tick::Tick;

use super::{
    calibration::{Readings, Steady, calibration},
    state::State,
    tables::{Action, AirFlow, Attachment, GripPhase, StateVariables},
};
use crate::execution::Outcome;

const CLOSE_FULLY: u8 = valve::SUPPLY | valve::CLOSE_COARSE | valve::CLOSE_MEDIUM | valve::CLOSE_FINE;
const OPEN_FULLY: u8 = valve::SUPPLY | valve::OPEN_COARSE | valve::OPEN_MEDIUM | valve::OPEN_FINE;
/// The fingers of this gripper move in parallel. ASSUMED.
const FINGER_HEIGHT: i32 = 0;

impl State {
    /// Without the gripper all valves are off.
    pub(super) fn act(&mut self, action: Action, seen: &StateVariables, tick: Tick) {
        match action {
            Action::Begin | Action::Widen => (self.since, self.steady) = (tick, Steady::default()),
            Action::NoteClosed => self.closed = self.take_readings(),
            Action::NoteOpen => self.open = self.take_readings(),
            Action::Calibrate => self.calibrate(),
            Action::CalibrateAndFinish => {
                self.calibrate();
                self.execution.finish();
            }
            Action::Refuse => self.missed = 0,
            Action::Finish | Action::Pause => self.execution.finish(),
            Action::Fail(reason) => self.execution.fail(reason),
            Action::Forget => self.calibration = None,
            Action::Keep
            | Action::Adopt
            | Action::Stop
            | Action::Open(_)
            | Action::Close(_)
            | Action::AwaitFinger
            | Action::CloseFully
            | Action::OpenFully
            | Action::Vent
            | Action::GiveUp => {}
        }
        self.valves = match seen.situation.gripper {
            Attachment::Attached => self.bits(action),
            Attachment::Detached => 0,
        };
    }

    fn bits(&self, action: Action) -> u8 {
        let limit = self.goal.greatest_flow();
        match action {
            Action::Refuse
            | Action::Stop
            | Action::Finish
            | Action::Fail(_)
            | Action::Calibrate
            | Action::CalibrateAndFinish
            | Action::GiveUp
            | Action::Forget => 0,
            Action::Keep | Action::Adopt | Action::Pause => self.valves,
            Action::Open(flow) => match flow.min(limit) {
                AirFlow::Fine => valve::SUPPLY | valve::OPEN_FINE,
                AirFlow::Medium => valve::SUPPLY | valve::OPEN_MEDIUM,
                AirFlow::Coarse => valve::SUPPLY | valve::OPEN_COARSE,
            },
            Action::Close(flow) => close(flow.min(limit)),
            Action::AwaitFinger => close(limit.min(AirFlow::Medium)),
            Action::Begin | Action::CloseFully => CLOSE_FULLY,
            Action::NoteClosed | Action::OpenFully | Action::Widen => OPEN_FULLY,
            Action::NoteOpen | Action::Vent => valve::VENT,
        }
    }

    /// The steady readings at the end of a calibration phase; the next phase starts.
    fn take_readings(&mut self) -> Readings {
        core::mem::take(&mut self.steady).mean()
    }

    fn calibrate(&mut self) {
        let free = self.take_readings();
        self.calibration = Some(calibration(&self.closed, &self.open, &free));
        self.set_empty();
    }

    pub(super) fn report(&self, action: Action, seen: &StateVariables, tick: Tick) -> GripOutputs {
        let execution = &self.execution;
        let report = match execution.outcome {
            Outcome::Idle => GripReport::Idle,
            Outcome::Executing if action == Action::AwaitFinger => GripReport::Paused,
            Outcome::Executing => GripReport::Executing,
            Outcome::Done => GripReport::Done,
            Outcome::Error | Outcome::Joystick => GripReport::Serror,
        };
        let mut status = GripStatus {
            echo: execution.receiver.echo,
            report,
            reason: execution.reason,
            initialized: self.phase == GripPhase::Valid,
            finger_height: FINGER_HEIGHT,
            felt: if self.phase == GripPhase::Valid { self.felt } else { Felt::NotKnown },
            valves: self.valves,
            ..GripStatus::default()
        };
        if seen.situation.gripper == Attachment::Attached {
            status.position = hundredths(seen.measured.mean_opening);
            status.velocity = hundredths(seen.measured.velocity);
            status.left_force = rounded(seen.measured.left);
            status.right_force = rounded(seen.measured.right);
        }
        let step = if self.is_calibrating() { self.phase.text() } else { self.step.text() };
        let known = matches!(self.phase, GripPhase::Valid | GripPhase::Adopting);
        GripOutputs {
            header: execution.rows.header(tick, step),
            status,
            calibration: self.calibration.filter(|_| known),
            valves: GripValves { bits: self.valves },
        }
    }
}

const fn close(flow: AirFlow) -> u8 {
    match flow {
        AirFlow::Fine => valve::SUPPLY | valve::CLOSE_FINE,
        AirFlow::Medium => valve::SUPPLY | valve::CLOSE_MEDIUM,
        AirFlow::Coarse => valve::SUPPLY | valve::CLOSE_COARSE,
    }
}
