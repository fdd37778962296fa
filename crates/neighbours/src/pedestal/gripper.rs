//! The status of the gripper for Diagnostics (IX.3). CHOSEN: it is nearly identical to the parts gripper (III.9.2), so
//! the variables are those of Grip (VI.3.2), status before command.

use interfaces::{
    GripOutputs,
    grip::{Calibration, GripCommand},
};

use super::{STEP, WORD, row, set_row, set_table, table};
use crate::layout::{Chars, Coded, Flag, Given, I32, Spelled, U16, U32, U64};

/// Outputs of the hand process, without the order to its valves, and its command.
pub type HandAndCommand = (GripOutputs, GripCommand);

crate::layout! {
    /// The status of the gripper.
    GripperLayout: HandAndCommand = "a status of the gripper";
    "incr-cmnd#-echo"  (0.status.echo)         U32,            "number of the command that `status` reports";
    "status"           (0.status.report)       Spelled<WORD>,  "executing, done, paused, serror; also idle";
    "status-code"      (0.status.reason)       Coded<4>,       "why the command failed, 0 if it did not";
    "initialized-?"    (0.status.initialized)  Flag,           "1: its sensors are calibrated";
    "pos"              (0.status.position)     I32,            "0.01 in";
    "l-force"          (0.status.left_force)   I32,            "lb";
    "r-force"          (0.status.right_force)  I32,            "lb";
    "vel"              (0.status.velocity)     I32,            "0.01 in/s";
    "finger-hgt"       (0.status.finger_height)  I32,          "0.01 in";
    "grip"             (0.status.valves)       U16,            "command bits to the eight air valves";
    "table#"  [|s| table(&s.0.header), |s, found| set_table(&mut s.0.header, found)]  U16,
        "decision table of the hand process, 0 for none";
    "row#"    [|s| row(&s.0.header), |s, found| set_row(&mut s.0.header, found)]  U16,
        "its row that fired";
    "step"             (0.header.step)         Given<Chars<STEP>>,  "step of its command after that row, blank for none";
    "incr-cmnd#"       (1.number)              U32,            "number of the command from the pedestal process, 0 for none";
    "command"          (1.command)             Spelled<WORD>,  "PAUSE, OPEN-GRIP, CLOSE-GRIP, POSITION, UP-INIT";
    "force"            (1.force)               I32,            "lb";
    "position"         (1.position)            I32,            "0.01 in";
    "velocity"         (1.velocity)            I32,            "0.01 in/s; 0 is full speed";
    "end-effector"     (1.end_effector_id)     Given<U16>,     "0: not on a quick change";
    "felt"             (0.status.felt)         Coded<2>,
        "contents of the fingers: 0 not known, 1 empty, 2 not empty";
    "scales-known"  [|s| s.0.calibration.is_some(),
                     |s, known: bool| s.0.calibration = known.then(Calibration::default)]  Flag,
        "1: the numbers below are those of a calibration";
    "zero of pos"      [|s| scales(s).potentiometer.zero, |s, found| set(s, |c| c.potentiometer.zero = found)]  U64,
        "counts at opening 0, as the bits of a 64-bit floating-point number";
    "gain of pos"      [|s| scales(s).potentiometer.gain, |s, found| set(s, |c| c.potentiometer.gain = found)]  U64,
        "inches per count, likewise";
    "zero of l-force"  [|s| scales(s).left.zero, |s, found| set(s, |c| c.left.zero = found)]  U64,
        "counts of the left strain gage at no force";
    "gain of l-force"  [|s| scales(s).left.gain, |s, found| set(s, |c| c.left.gain = found)]  U64,
        "pounds per count";
    "zero of r-force"  [|s| scales(s).right.zero, |s, found| set(s, |c| c.right.zero = found)]  U64,
        "counts of the right strain gage at no force";
    "gain of r-force"  [|s| scales(s).right.gain, |s, found| set(s, |c| c.right.gain = found)]  U64,
        "pounds per count";
}

fn scales(sent: &HandAndCommand) -> Calibration {
    sent.0.calibration.unwrap_or_default()
}

fn set(read: &mut HandAndCommand, set: impl FnOnce(&mut Calibration)) {
    if let Some(calibration) = &mut read.0.calibration {
        set(calibration);
    }
}
