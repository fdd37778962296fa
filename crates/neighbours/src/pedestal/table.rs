//! The status of the rotary table for Diagnostics (IX.3). CHOSEN: the manual only mentions the table process.

use interfaces::{TableOutputs, pedestal::TableCommand};

use super::{STEP, WORD, row, set_row, set_table, table};
use crate::layout::{Chars, Coded, Flag, Given, I32, Spelled, U16, U32};

/// Outputs of the table process, without the order to its motor, and its command.
pub type TableAndCommand = (TableOutputs, TableCommand);

crate::layout! {
    /// The status of the table.
    TableLayout: TableAndCommand = "a status of the table";
    "incr-cmnd#-echo"  (0.status.echo)        U32,            "number of the command that `status` reports";
    "status"           (0.status.report)      Spelled<WORD>,  "executing, done, can't-do, error; also idle";
    "status-code"      (0.status.reason)      Coded<4>,       "why the command failed, 0 if it did not";
    "calibrated"       (0.status.calibrated)  Flag,           "1: the counter was set at the + limit";
    "table-position"   [|s| s.0.status.position.unwrap_or_default(),
                        |s, found| s.0.status.position = Some(found)]  I32, "0.1 degree; 0 if it is not known";
    "table#"  [|s| table(&s.0.header), |s, found| set_table(&mut s.0.header, found)]  U16,
        "decision table of the table process, 0 for none";
    "row#"    [|s| row(&s.0.header), |s, found| set_row(&mut s.0.header, found)]  U16,
        "its row that fired";
    "step"             (0.header.step)        Given<Chars<STEP>>,  "step of its command after that row, blank for none";
    "incr-cmnd#"       (1.number)             U32,            "number of the command from the pedestal process, 0 for none";
    "command"          (1.command)            Spelled<WORD>,  "PAUSE, CALIBRATE, TURN; blank for none";
    "table-angle"      (1.angle)              I32,            "0.1 degree, absolute";
    "angle-known"      [|s| s.0.status.position.is_some(), set_angle_known]  Flag, "1: `table-position` is an angle";
    "limit-known"      [|s| s.0.at_limit.is_some(), |s, known: bool| s.0.at_limit = known.then_some(0)]  Flag,
        "1: `at-limit` is a reading";
    "at-limit"         [|s| s.0.at_limit.unwrap_or_default(), set_at_limit]  U16,
        "potentiometer of the table at the + limit, counts; 0 if it is not known";
}

fn set_angle_known(read: &mut TableAndCommand, known: bool) {
    if !known {
        read.0.status.position = None;
    }
}

fn set_at_limit(read: &mut TableAndCommand, counts: u16) {
    if let Some(at_limit) = &mut read.0.at_limit {
        *at_limit = counts;
    }
}
