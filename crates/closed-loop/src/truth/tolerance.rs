//! Tolerances of the judge. docs/cell.md "What the judge allows" gives the reason of each.

/// Greatest distance of the robot's tool frame from a goal, in: 0.02 within which the controller counts it as there,
/// and 0.02 for the words of the link, the hundredths of poses and the resolvers.
pub const THERE_INCHES: f64 = 0.04;
/// The same for the orientation, degrees.
pub const THERE_DEGREES: f64 = 0.15;
/// The same from a part that the camera has found, in: its second picture and answer in addition.
pub const SEEN_INCHES: f64 = 0.06;
/// The same for the orientation, degrees.
pub const SEEN_DEGREES: f64 = 0.35;
/// Greatest distance of a part in the fingers, along the fingers, from where its grip has it, in: what agreement of
/// task data and cell allows for a nest.
pub const GRIP_INCHES: f64 = 0.25;
/// Fingers may be narrower than asked by this much, in: the converters and the hundredths of an order.
pub const OPENING_INCHES: f64 = 0.05;
/// Greatest distance of two bodies that touch, in: sink of contacts and deflection of the fingers' springs.
pub const TOUCH_INCHES: f64 = 0.03;
/// The robot may be this far behind a commanded point that stands, in: the lag of the servos in the last ticks of a ramp
/// of 10 in/s², 80 ms and three ticks at 0.8 in/s.
pub const STOP_INCHES: f64 = 0.20;
/// Parts whose widths differ by less than this have the same width for the fingers, in.
pub const WIDTH_INCHES: f64 = 0.10;
/// The way that the robot's servos are behind its commanded point at the greatest speed of the link, in: 14 in/s for
/// 80 ms of lag, and for the three ticks from Prim to the arm.
pub const LAG_INCHES: f64 = 14.0 * (0.080 + 3.0 * 0.040);
