use interfaces::{
    device::JawValves,
    jaws::{JawsReport, JawsVerb},
};
use rcs_core::{Plain, tick::Tick};

use super::tables::Step;
use crate::execution::Execution;

pub(super) const WINDOW: usize = 4; // readings: equal within a tolerance at rest

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    pub execution: Execution,
    pub step: Step,
    pub verb: JawsVerb,            // a copy: the buffer of a restarted commander is empty
    pub since: Tick,               // arrival of the command
    pub size: Option<i32>,         // 0.01 in, from the last command that had one
    pub found: Option<JawsReport>, // position of the fingers at the end of the command
    /// Potentiometer counts, the newest first, if the gripper was attached in the previous tick.
    pub window: Option<[u16; WINDOW]>,
    /// Ticks for which closing air has pressed on something, up to [`super::preprocess::PRESSED_TICKS`].
    pub gripping_ticks: u8,
    pub attached_ticks: u8,
    pub valves: JawValves,
    pub air_ticks: u8, // ticks since the last change of the valves
}
