//! Continuation of a tool command that was interrupted at the drum.

use rcs_core::{Actions, Plain, Variables, decision_table};

use crate::execution::Outcome;

/// Where the robot is at the drum of the command, if a tool command was interrupted there, by the resolvers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum AtDrum {
    /// Nowhere there, or no tool command was interrupted.
    Off,
    /// Before it: neither a held tool nor the fingers touch anything, unless the place in the drum is not
    /// free.
    Before,
    /// On the way in: a held tool may touch the drum.
    Entering,
    /// Where a held tool is in its place, and empty fingers are around one.
    Inside,
    /// Between there and the strike plate: the fingers are half around the tool in the drum.
    Sliding,
    /// To the right of the tool, clear of it, at the strike plate or before it.
    Clear,
}

/// The bias of the force sensor: the reading that counts as no force (V.1.1 CAL-SENSOR).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Bias {
    /// None was taken, or the sensor has been without power since.
    Missing,
    /// It was taken at the drum, where the fingers or the tool may have touched something.
    AtDrum,
    /// It was taken at TOOL-SAFE, where nothing is touched.
    AtSafe,
}

/// What the fingers have in the drum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveTool {
    /// They have closed on a tool, and nothing has moved it since.
    Grasped,
    /// They have not.
    Loose,
}

/// The state variables.
#[derive(Clone, Copy, Debug, Variables)]
pub struct AtTheDrum {
    /// Where the robot is at the drum.
    pub at: AtDrum,
    /// What its fingers have there.
    pub tool: EmoveTool,
    /// How far the current command has come.
    pub outcome: Outcome,
}

/// What is believed of the robot at the drum.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum Belief {
    /// It is half way there still.
    Keep,
    /// It has left.
    Leave,
    /// It stands there with the fingers around the tool.
    Stand,
}

decision_table! {
    /// DRUM: a robot that has been taken away from the drum, as by the joystick box, is no longer half way
    /// there. One whose fingers have closed on a tool in the drum stands there, also if the command did not
    /// come to that. Preprocess consults it while a tool command is half done; no header names its rows.
    pub DRUM: fn drum(self::AtTheDrum) -> self::Belief {
        1: at: Off                                                             => Leave;
        2: at: Inside, tool: Grasped, outcome: Idle | Done | Error | Joystick  => Stand;
        3: at: Inside, tool: Grasped, outcome: Executing                       => Keep;
        4: at: Inside, tool: Loose                                             => Keep;
        5: at: Before | Entering | Sliding | Clear                             => Keep;
    }
}
