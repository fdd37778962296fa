//! The state of V-Grip and Tool-Grip.

use interfaces::{
    device::JawValves,
    jaws::{JawsReport, JawsVerb},
};
use rcs_core::{Plain, tick::Tick};

use super::tables::Step;
use crate::execution::Execution;

/// Readings that are kept: fingers that stand still read the same in all of them.
pub(super) const WINDOW: usize = 4;

/// State of V-Grip or Tool-Grip.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    /// The command of E-move and how far it has come.
    pub execution: Execution,
    /// Step of its table.
    pub step: Step,
    /// The current command: a copy, because the buffer of a commander that restarts is empty.
    pub verb: JawsVerb,
    /// When it came.
    pub since: Tick,
    /// `commanded-size` of the last command that had one, 0.01 in.
    pub size: Option<i32>,
    /// Where the current command has found the fingers at its end.
    pub found: Option<JawsReport>,
    /// Potentiometer readings of the last ticks, the newest first, if the gripper was attached in the last
    /// tick.
    pub window: Option<[u16; WINDOW]>,
    /// Ticks for which closing air has stood against something, up to [`super::preprocess::PRESSED_TICKS`].
    pub gripping_ticks: u8,
    /// Ticks for which the gripper has been attached.
    pub attached_ticks: u8,
    /// Air.
    pub valves: JawValves,
    /// Ticks for which the valves have been as they are.
    pub air_ticks: u8,
}
