//! Tolerances of the judge. docs/cell.md "What the judge allows" gives the reason of each.

/// Greatest distance of the tool frame from a goal: 0.02 by the controller, 0.02 for the words of the link.
pub const THERE_INCHES: f64 = 0.04;
pub const THERE_DEGREES: f64 = 0.15; // the same for the orientation, degrees
/// Greatest distance from a part found by the camera, in: includes the errors of its second picture and answer.
pub const SEEN_INCHES: f64 = 0.06;
pub const SEEN_DEGREES: f64 = 0.35; // the same for the orientation, degrees
/// Greatest offset of a held part along the fingers from the place of its grip, in.
pub const GRIP_INCHES: f64 = 0.25;
/// Greatest amount by which an opening may be too small, in: errors of converters and rounding of commands.
pub const OPENING_INCHES: f64 = 0.05;
/// Greatest distance of two bodies in contact, in: penetration, and deflection of the fingers' springs.
pub const TOUCH_INCHES: f64 = 0.03;
/// Greatest distance from a commanded point at rest: the lag of the servos at the end of a ramp of 10 in/s².
pub const STOP_INCHES: f64 = 0.20;
pub const WIDTH_INCHES: f64 = 0.10; // widths with a smaller difference are equal for the fingers, in
/// Distance of the servos behind the commanded point: 14 in/s for 80 ms of lag and the three ticks from Prim to the
/// arm.
pub const LAG_INCHES: f64 = 14.0 * (0.080 + 3.0 * 0.040);
