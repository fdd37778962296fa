//! The control processes, each registered once.
//!
//! [`for_each_process!`](crate::for_each_process!) is the only list. It generates [`ProcessId`] and [`CommonMemory`],
//! and determines the order in which all code iterates over the processes.

use rcs_core::{
    Plain,
    handshake::{Answer, Lower},
};

use crate::{Header, Reason, Unconfirmed, t3i::LinkFault};

/// Pass the list of processes to a macro. An entry contains:
///
/// * the identifier, which is also the name of its type in `levels::processes`, and the manual's name;
/// * `buffers`: its field of common memory, and the type of its output buffers;
/// * `failure`: the status field with the reason of a failure;
/// * `board`: the number of the board on which it runs (IV.2.2);
/// * `commander`: its superior and the buffer with the superior's command; empty for Task;
/// * `reads`: prefixes of the external inputs that it reads, as named in `ExternalInputs`.
#[macro_export]
macro_rules! for_each_process {
    ($with:ident) => {
        $with! {
            /// Task (V.4).
            Task "Task" {
                buffers: task, $crate::TaskOutputs;
                failure: reason;
                board: 6;
                commander: ;
                reads: ["data_base", "operator.db_done"];
            }
            /// Subtask (V.3).
            Subtask "Subtask" {
                buffers: subtask, $crate::SubtaskOutputs;
                failure: reason;
                board: 6;
                commander: Task, task.subtask;
                reads: ["devices.quick_change", "pedestal.answers"];
            }
            /// E-move (V.2).
            Emove "E-move" {
                buffers: emove, $crate::EmoveOutputs;
                failure: reason;
                board: 2;
                commander: Subtask, subtask.emove;
                reads: [
                    "devices.vision", "devices.holsters", "devices.quick_change", "devices.grip.beams",
                    "operator.robot_init"
                ];
            }
            /// Prim (V.1).
            Prim "Prim" {
                buffers: prim, $crate::PrimOutputs;
                failure: reason;
                board: 2;
                commander: Emove, emove.prim;
                reads: ["devices.force.valid", "devices.holsters", "devices.grip.beams", "devices.joystick"];
            }
            /// T3 Interface (VI.1).
            T3i "T3 Interface" {
                buffers: t3i, $crate::T3iOutputs;
                failure: fault;
                board: 4;
                commander: Prim, prim.t3i;
                reads: [
                    "devices.link_ready", "devices.link_rx.length", "devices.link_unsent",
                    "devices.link_patience", "devices.robot_lag", "devices.resolvers.valid"
                ];
            }
            /// Quick Change (VI.2).
            QuickChange "Quick Change" {
                buffers: quick_change, $crate::QuickChangeOutputs;
                failure: reason;
                board: 8;
                commander: Emove, emove.quick_change;
                reads: ["devices.quick_change", "devices.holsters"];
            }
            /// Grip (VI.3).
            Grip "Grip" {
                buffers: grip, $crate::GripOutputs;
                failure: reason;
                board: 8;
                commander: Emove, emove.grip;
                reads: ["devices.grip"];
            }
            /// V-Grip (VI.4).
            VGrip "V-Grip" {
                buffers: v_grip, $crate::JawsOutputs;
                failure: reason;
                board: 8;
                commander: Emove, emove.v_grip;
                reads: ["devices.grip", "devices.quick_change"];
            }
            /// Tool-Grip (VI.5).
            ToolGrip "Tool-Grip" {
                buffers: tool_grip, $crate::JawsOutputs;
                failure: reason;
                board: 8;
                commander: Emove, emove.tool_grip;
                reads: ["devices.grip", "devices.quick_change"];
            }
            /// Active Pedestal (VI.7).
            Pedestal "Active Pedestal" {
                buffers: pedestal, $crate::PedestalOutputs;
                failure: reason;
                board: 8;
                commander: Subtask, subtask.pedestal;
                reads: ["devices.pedestal"];
            }
            /// Hand of the pedestal.
            Hand "Pedestal Hand" {
                buffers: hand, $crate::GripOutputs;
                failure: reason;
                board: 8;
                commander: Pedestal, pedestal.hand;
                reads: [
                    "devices.pedestal.potentiometer", "devices.pedestal.strain_left",
                    "devices.pedestal.strain_right"
                ];
            }
            /// Rotary table of the pedestal.
            RotaryTable "Rotary Table" {
                buffers: table, $crate::TableOutputs;
                failure: reason;
                board: 8;
                commander: Pedestal, pedestal.table;
                reads: [
                    "devices.pedestal.table_potentiometer", "devices.pedestal.limit_plus",
                    "devices.pedestal.limit_minus", "devices.pedestal.motor_moving",
                    "devices.pedestal.motor_counter"
                ];
            }
        }
    };
}

macro_rules! register {
    ($(
        #[doc = $doc:literal]
        $id:ident $text:literal {
            buffers: $field:ident, $outputs:ty;
            failure: $failure:ident;
            board: $board:literal;
            commander: $($commander:ident, $above:ident . $command:ident)?;
            reads: $reads:expr;
        }
    )+) => {
        /// The control processes in the order of [`CommonMemory`] and the digest.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Plain)]
        pub enum ProcessId { $( #[doc = $doc] #[text = $text] $id, )+ }

        impl ProcessId {
            /// Number of its board (IV.2.2).
            #[must_use]
            pub const fn board(self) -> u8 {
                match self { $( Self::$id => $board, )+ }
            }

            /// Its superior; none for Task, which the workstation controller commands.
            #[must_use]
            pub const fn commander(self) -> Option<Self> {
                const fn only<const N: usize>(commander: [ProcessId; N]) -> Option<ProcessId> {
                    match commander.as_slice() {
                        [commander] => Some(*commander),
                        _ => None,
                    }
                }
                match self { $( Self::$id => only([$( Self::$commander )?]), )+ }
            }

            /// Prefixes of the external inputs that it reads, as named in `ExternalInputs`.
            #[must_use]
            pub const fn reads(self) -> &'static [&'static str] {
                match self { $( Self::$id => &$reads, )+ }
            }

            /// Its field of common memory.
            #[must_use]
            pub const fn field(self) -> &'static str {
                match self { $( Self::$id => stringify!($field), )+ }
            }
        }

        /// Common memory (II.2.4): the output buffers of all processes, in the order of the digest.
        #[derive(Clone, Copy, Debug, PartialEq, Plain)]
        pub struct CommonMemory { $( #[doc = $doc] pub $field: $outputs, )+ }

        impl CommonMemory {
            /// The header of a process's outputs.
            #[must_use]
            pub const fn header(&self, process: ProcessId) -> &Header {
                match process { $( ProcessId::$id => &self.$field.header, )+ }
            }

            /// The status of a process.
            #[must_use]
            pub fn said(&self, process: ProcessId) -> CommonStatus {
                match process { $( ProcessId::$id => {
                    let status = &self.$field.status;
                    CommonStatus {
                        report: status.report.text(),
                        lower: status.report.lower(),
                        fault: Fault::from(status.$failure),
                        unconfirmed: self.unconfirmed(process),
                    }
                } )+ }
            }

            /// Number of the superior's command to a process; none for Task.
            #[must_use]
            pub fn command_number(&self, process: ProcessId) -> Option<u32> {
                match process { $( ProcessId::$id => [ $( self.$above.$command.number )? ].first().copied(), )+ }
            }

            /// Pass the command of a process as text to `show`; not for Task.
            pub fn show_command<T>(
                &self,
                process: ProcessId,
                show: impl FnOnce(&dyn core::fmt::Display) -> T,
            ) -> Option<T> {
                match process { $( ProcessId::$id => {
                    let command: Option<&dyn core::fmt::Display> = None;
                    $( let command: Option<&dyn core::fmt::Display> =
                        command.or(Some(&self.$above.$command)); )?
                    command.map(show)
                } )+ }
            }

            /// The mutable header of a process's outputs.
            #[must_use]
            pub const fn header_mut(&mut self, process: ProcessId) -> &mut Header {
                match process { $( ProcessId::$id => &mut self.$field.header, )+ }
            }
        }
    };
}
for_each_process!(register);

impl CommonMemory {
    /// Part of the goal that no sensor confirms, from the status of a process.
    const fn unconfirmed(&self, process: ProcessId) -> Unconfirmed {
        match process {
            ProcessId::Task => self.task.status.unconfirmed,
            ProcessId::Subtask => self.subtask.status.unconfirmed,
            ProcessId::Emove => self.emove.status.unconfirmed,
            ProcessId::Prim
            | ProcessId::T3i
            | ProcessId::QuickChange
            | ProcessId::Grip
            | ProcessId::VGrip
            | ProcessId::ToolGrip
            | ProcessId::Pedestal
            | ProcessId::Hand
            | ProcessId::RotaryTable => Unconfirmed::None,
        }
    }
}

macro_rules! answers {
    ($( $outputs:ty ),+) => { $(
        impl Answer for $outputs {
            fn header(&self) -> &Header {
                &self.header
            }

            fn echo(&self) -> u32 {
                self.status.echo
            }

            fn report(&self) -> Lower {
                self.status.report.lower()
            }
        }
    )+ };
}
answers!(
    crate::SubtaskOutputs,
    crate::EmoveOutputs,
    crate::PrimOutputs,
    crate::QuickChangeOutputs,
    crate::GripOutputs,
    crate::JawsOutputs,
    crate::PedestalOutputs,
    crate::TableOutputs
);

/// The status of a process, independent of its type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CommonStatus {
    /// The report as text.
    pub report: &'static str,
    /// The report as a state variable of the superior.
    pub lower: Lower,
    /// Reason of a failure.
    pub fault: Fault,
    /// Part of the goal that no sensor confirms.
    pub unconfirmed: Unconfirmed,
}

/// Why a process failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// A reason of most processes.
    Reason(Reason),
    /// A fault of T3 Interface.
    Link(LinkFault),
}

impl Fault {
    /// True if the process did not fail.
    #[must_use]
    pub const fn is_none(self) -> bool {
        matches!(self, Self::Reason(Reason::None) | Self::Link(LinkFault::None))
    }

    /// The fault as text.
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::Reason(reason) => reason.text(),
            Self::Link(fault) => fault.text(),
        }
    }
}

impl From<Reason> for Fault {
    fn from(reason: Reason) -> Self {
        Self::Reason(reason)
    }
}

impl From<LinkFault> for Fault {
    fn from(fault: LinkFault) -> Self {
        Self::Link(fault)
    }
}

/// Number of processes.
pub const PROCESS_COUNT: usize = ProcessId::ALL.len();

impl ProcessId {
    /// Position in common memory.
    #[must_use]
    pub fn position(self) -> usize {
        usize::from(self.code())
    }

    /// Number of processes above it.
    #[must_use]
    pub fn depth(self) -> usize {
        core::iter::successors(self.commander(), |process| process.commander()).count()
    }

    /// Its subordinates.
    pub fn below(self) -> impl Iterator<Item = Self> {
        Self::ALL.iter().copied().filter(move |process| process.commander() == Some(self))
    }

    /// All processes from the lowest up: each precedes its superior.
    pub fn upward() -> impl Iterator<Item = Self> {
        let at = |depth| Self::ALL.iter().copied().filter(move |process| process.depth() == depth);
        (0..PROCESS_COUNT).rev().flat_map(at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_process_precedes_its_commander_on_the_way_up() {
        let upward: Vec<_> = ProcessId::upward().collect();
        assert_eq!(upward.len(), PROCESS_COUNT);
        for (position, process) in upward.iter().enumerate() {
            let above = process.commander().and_then(|above| upward.iter().position(|other| *other == above));
            assert!(above.is_none_or(|above| above > position), "{process}");
        }
        assert_eq!(upward.first().zip(upward.last()), Some((&ProcessId::T3i, &ProcessId::Task)));
    }

    #[test]
    fn positions_are_those_of_the_buffers() {
        for process in ProcessId::ALL {
            assert_eq!(CommonMemory::STRUCT.fields[process.position()].name, process.field());
        }
        assert_eq!(
            ProcessId::Pedestal.below().collect::<Vec<_>>(),
            [ProcessId::Hand, ProcessId::RotaryTable]
        );
    }
}
