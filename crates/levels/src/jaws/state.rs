use interfaces::{
    device::JawValves,
    jaws::{JawsReport, JawsVerb},
};
use rcs_core::{Plain, tick::Tick};

use super::tables::Step;
use crate::execution::Execution;

/// Stored readings: equal within a tolerance if the fingers are at rest.
pub(super) const WINDOW: usize = 4;

/// State of V-Grip or Tool-Grip.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    /// The command of E-move and its progress.
    pub execution: Execution,
    /// Step of its table.
    pub step: Step,
    /// The current command: a copy, because the buffer of a commander that restarts is empty.
    pub verb: JawsVerb,
    /// When it came.
    pub since: Tick,
    /// `commanded-size` of the last command that had one, 0.01 in.
    pub size: Option<i32>,
    /// Position of the fingers at the end of the current command.
    pub found: Option<JawsReport>,
    /// Potentiometer readings of the last ticks, the newest first, if the gripper was attached in the previous
    /// tick.
    pub window: Option<[u16; WINDOW]>,
    /// Ticks for which closing air has pressed on something, up to [`super::preprocess::PRESSED_TICKS`].
    pub gripping_ticks: u8,
    /// Ticks for which the gripper has been attached.
    pub attached_ticks: u8,
    /// Air.
    pub valves: JawValves,
    /// Ticks since the last change of the valves.
    pub air_ticks: u8,
}
