use interfaces::quick_change::{QuickChangeVerb, RingPosition};
use rcs_core::{Plain, tick::Tick};

use super::tables::Step;
use crate::execution::Execution;

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct State {
    pub execution: Execution,
    pub step: Step,
    pub command: QuickChangeVerb, // a copy: the buffer of a restarted commander is empty
    pub since: Tick,              // arrival of the command
    pub ring: RingPosition,       // the valid reading
    pub reading: RingPosition,    // the sensor reading of this tick
    pub reading_ticks: u8,        // ticks with the same reading
    pub end_effector_id: Option<u8>, // the last legal `endeff-id#` of a mated gripper
    pub illegal_ticks: u8,        // ticks with an illegal id
}
