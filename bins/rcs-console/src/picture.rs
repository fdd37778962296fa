//! The data of one tick that the screens show.

use closed_loop::failure;
use interfaces::{CommonMemory, ExternalInputs, Fault, ProcessId};
use rcs_core::tick::{TICK_S, Tick};

#[derive(Clone)]
pub struct Picture {
    pub tick: Tick,
    pub external: ExternalInputs,
    pub memory: CommonMemory,
    /// Times of the tick; `None` in a log of a run in fast clock.
    pub timing: Option<Timing>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Timing {
    pub controller_ns: u64, // ns
    /// Number of skipped slots of the 40 ms grid since the start of the run.
    pub skipped: u64,
    /// Heap allocations of the controller since the start, if known.
    pub allocations: Option<u64>,
}

impl Picture {
    /// Seconds since the start of the run.
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.tick.0 as f64 * TICK_S
    }

    #[must_use]
    pub fn command(&self, process: ProcessId) -> String {
        failure::command(process, &self.external.hws, &self.memory)
    }

    #[must_use]
    pub fn command_number(&self, process: ProcessId) -> u32 {
        self.memory.command_number(process).unwrap_or(self.external.hws.number)
    }

    /// The reason why a process failed, if it did.
    #[must_use]
    pub fn fault(&self, process: ProcessId) -> Option<Fault> {
        Some(self.memory.said(process).fault).filter(|fault| !fault.is_none())
    }

    /// The reason why a process was not executed in this tick, if it was not.
    #[must_use]
    pub fn absence(&self, process: ProcessId) -> Option<Absence> {
        let header = self.memory.header(process);
        let elsewhere = is_of_pedestal(process) && self.external.pedestal.elsewhere;
        match (header.stamp == self.tick, header.republished) {
            (false, _) => Some(Absence::Lost),
            (true, true) if self.external.operator.is_stopped(process.board()) => Some(Absence::Stopped),
            (true, true) if is_gripper(process) => Some(Absence::Dormant),
            (true, true) => Some(Absence::Held),
            (true, false) => elsewhere.then_some(Absence::Elsewhere),
        }
    }
}

/// Reason why a process was not executed in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Absence {
    /// Its gripper is not on the robot (II.2.3).
    Dormant,
    /// Its switch on the joystick box is on, or the screen shows a recorded pose (III.3.3).
    Held,
    /// Its board is stopped, or receives no pulse (IV.2.6).
    Stopped,
    /// It has not written its buffers in this tick.
    Lost,
    Elsewhere,
}

impl Absence {
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Dormant => "dormant",
            Self::Held => "held",
            Self::Stopped => "stopped",
            Self::Lost => "lost",
            Self::Elsewhere => "elsewhere",
        }
    }
}

const fn is_gripper(process: ProcessId) -> bool {
    matches!(process, ProcessId::Grip | ProcessId::VGrip | ProcessId::ToolGrip)
}

const fn is_of_pedestal(process: ProcessId) -> bool {
    matches!(process, ProcessId::Pedestal | ProcessId::Hand | ProcessId::RotaryTable)
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::operator::board_bit;

    #[test]
    fn absent_process_has_one_reason() {
        let mut picture = Picture {
            tick: Tick(9),
            external: ExternalInputs::default(),
            memory: CommonMemory::default(),
            timing: None,
        };
        for process in ProcessId::ALL {
            picture.memory.header_mut(*process).stamp = Tick(9);
        }
        picture.memory.header_mut(ProcessId::VGrip).republished = true;
        picture.memory.header_mut(ProcessId::Prim).republished = true;
        picture.memory.header_mut(ProcessId::Task).stamp = Tick(8);
        picture.external.pedestal.elsewhere = true;
        let absences: Vec<_> =
            [ProcessId::Emove, ProcessId::VGrip, ProcessId::Prim, ProcessId::Task, ProcessId::Hand]
                .map(|process| picture.absence(process).map(Absence::text))
                .into();
        assert_eq!(absences, [None, Some("dormant"), Some("held"), Some("lost"), Some("elsewhere")]);
        picture.external.operator.stopped = board_bit(2);
        assert_eq!(picture.absence(ProcessId::Prim).map(Absence::text), Some("stopped"));
        assert_eq!(picture.absence(ProcessId::Emove), None, "it was executed");
    }
}
