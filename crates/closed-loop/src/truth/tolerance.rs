//! Tolerances of the judge. docs/cell.md "What the judge allows" gives the reason of each.

/// Greatest distance of the robot's tool frame from a goal, in: 0.02 by the controller's own limit, and 0.02 for the
/// words of the link, the hundredths of poses and the resolvers.
pub const THERE_INCHES: f64 = 0.04;
/// The same for the orientation, degrees.
pub const THERE_DEGREES: f64 = 0.15;
/// Greatest distance from a part found by the camera, in: adds its second picture and its answer.
pub const SEEN_INCHES: f64 = 0.06;
/// The same for the orientation, degrees.
pub const SEEN_DEGREES: f64 = 0.35;
/// Greatest offset of a held part along the fingers from the place of its grip, in: the permitted difference of task
/// data and cell for a nest.
pub const GRIP_INCHES: f64 = 0.25;
/// Greatest lack of a commanded opening, in: converters and hundredths of an order.
pub const OPENING_INCHES: f64 = 0.05;
/// Greatest distance of two bodies in contact, in: sink of contacts and deflection of the fingers' springs.
pub const TOUCH_INCHES: f64 = 0.03;
/// Greatest distance of the robot from a commanded point at rest, in: the lag of the servos in the last ticks of a
/// ramp of 10 in/s², 80 ms and three ticks at 0.8 in/s.
pub const STOP_INCHES: f64 = 0.20;
/// Widths with a smaller difference are equal for the fingers, in.
pub const WIDTH_INCHES: f64 = 0.10;
/// Distance of the servos behind the commanded point at the greatest speed of the link, in: 14 in/s for 80 ms of lag
/// and the three ticks from Prim to the arm.
pub const LAG_INCHES: f64 = 14.0 * (0.080 + 3.0 * 0.040);
