//! Continuation of a tool command that was interrupted at the drum.

use rcs_core::{Actions, Plain, Variables, decision_table};

use crate::execution::Outcome;

/// The robot's position at the drum of the command after an interrupted tool command, by the resolvers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum AtDrum {
    /// Not at the drum, or no tool command was interrupted.
    Off,
    /// Before the drum: neither a held tool nor the fingers have contact, unless the place in the drum is occupied.
    Before,
    /// On the way in: a held tool may touch the drum.
    Entering,
    /// Inside the drum: a held tool is in its place, or empty fingers are around a tool.
    Inside,
    /// Between the tool's place and the strike plate: the fingers are half around the tool.
    Sliding,
    /// To the right of the tool, clear of it, at the strike plate or before it.
    Clear,
}

/// The zero reading of the force sensor (V.1.1 CAL-SENSOR).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Bias {
    /// The sensor was not calibrated, or has lost its power since.
    Missing,
    /// The sensor was calibrated at the drum, where the fingers or the tool may have had contact.
    AtDrum,
    /// The sensor was calibrated at TOOL-SAFE, free of contact.
    AtSafe,
}

/// The tool in the drum, relative to the fingers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum EmoveTool {
    /// The fingers have closed on a tool, and neither has moved since.
    Grasped,
    /// The fingers have not closed on a tool, or one of them has moved.
    Loose,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct AtTheDrum {
    /// The robot's position at the drum.
    pub at: AtDrum,
    /// The tool, relative to the fingers.
    pub tool: EmoveTool,
    /// Progress of the current command.
    pub outcome: Outcome,
}

/// The decision on an unfinished tool command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum DrumDecision {
    /// The tool command is still unfinished.
    Keep,
    /// The robot has left the drum.
    Leave,
    /// The robot is in the drum with the fingers around the tool.
    Stand,
}

decision_table! {
    /// DRUM: a robot moved away from the drum, as by the joystick box, has left its tool command. Fingers that have
    /// closed on a tool in the drum place the robot there, even if the command was interrupted. Preprocess consults
    /// this table while a tool command is unfinished. Headers do not name its rows.
    pub DRUM: fn drum(self::AtTheDrum) -> self::DrumDecision {
        1: at: Off                                                             => Leave;
        2: at: Inside, tool: Grasped, outcome: Idle | Done | Error | Joystick  => Stand;
        3: at: Inside, tool: Grasped, outcome: Executing                       => Keep;
        4: at: Inside, tool: Loose                                             => Keep;
        5: at: Before | Entering | Sliding | Clear                             => Keep;
    }
}
