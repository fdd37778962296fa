//! The joystick box moves the robot (III.3.3) by a velocity instead of a goal.
//!
//! Stick and buttons command a velocity in the coordinates of the frame switch. It is stored in world coordinates,
//! with a limited change ([`ACCELERATION`]). So a sudden stick motion, a switch that is turned off and a rotation of
//! the tool frame all cause ramps. Another frame takes effect only at rest.
//!
//! A rotation does not move its centre: the tool point, or the wrist point, 30.00 in from it (VII.2 `wo`). Its
//! velocity is measured at the lever [`INCHES_PER_RADIAN`], or at the tool point if that is farther from the
//! centre. So all frames have the same limits in inches of path.

use geometry::{
    frame::{Frame, INCHES_PER_RADIAN, Vector, norm, rotation_by, rotation_from_x_y},
    pose::POINT_DISTANCE,
};
use interfaces::device::{JoystickBox, KNOB_FULL, joystick_frame};
use rcs_core::{Plain, tick::TICK_S};

/// Greatest path velocity, in/s, with stick and velocity knob at their ends. ASSUMED.
pub const SPEED: f64 = 5.0;
/// Greatest path acceleration, in/s². ASSUMED: that of a free path (VIII.10).
pub const ACCELERATION: f64 = 10.0;
/// Acceleration of a ramp, in/s². The rest, 5² / 30, is for a tool point that swings about the wrist at [`SPEED`].
const RAMP: f64 = 9.0;
/// Smaller deflections are treated as 0: potentiometers do not return to 0 exactly. ASSUMED.
const PLAY: f64 = 0.03;

/// Coordinates of manual motions (III.3.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Coordinates {
    /// No frame switch is on, or more than one.
    None,
    /// Switch f: translations in world coordinates.
    World,
    /// Switch h: translations in tool coordinates.
    Tool,
    /// Switch j: pitch and yaw about the tool point.
    #[text = "tool origin"]
    ToolOrigin,
    /// Switch k: pitch and yaw about the wrist point.
    #[text = "wrist origin"]
    WristOrigin,
}

impl Coordinates {
    #[must_use]
    pub const fn of(joystick: &JoystickBox) -> Self {
        match joystick.frame {
            joystick_frame::WORLD => Self::World,
            joystick_frame::TOOL => Self::Tool,
            joystick_frame::TOOL_ORIGIN => Self::ToolOrigin,
            joystick_frame::WRIST_ORIGIN => Self::WristOrigin,
            _ => Self::None,
        }
    }

    /// Distance from the tool point back to the centre of rotation, inches.
    const fn behind(self) -> f64 {
        match self {
            Self::WristOrigin => POINT_DISTANCE,
            Self::None | Self::World | Self::Tool | Self::ToolOrigin => 0.0,
        }
    }

    /// Path per radian, in.
    const fn lever(self) -> f64 {
        INCHES_PER_RADIAN.max(self.behind())
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct PrimManual {
    pub engaged: bool, // the joystick box controls the robot in this tick
    pub coordinates: Coordinates,
    pub translate: [f64; 3], // share of SPEED, along the axes of `coordinates`
    /// A share of [`SPEED`] at the lever, about the axes of the tool.
    pub rotate: [f64; 3],
    pub linear: [f64; 3],  // in/s, world
    pub angular: [f64; 3], // rad/s about the centre, world
}

fn buttons(plus: bool, minus: bool) -> f64 {
    f64::from(i8::from(plus).saturating_sub(i8::from(minus)))
}

/// A share from -1 to 1: 0 within the play, linear beyond it.
fn deflection(counts: i16) -> f64 {
    let share = f64::from(counts).abs() / f64::from(KNOB_FULL);
    let beyond = ((share - PLAY) / (1.0 - PLAY)).clamp(0.0, 1.0);
    if counts < 0 { -beyond } else { beyond }
}

#[must_use]
pub fn is_moved(joystick: &JoystickBox) -> bool {
    let pressed = [joystick.up, joystick.down, joystick.roll_plus, joystick.roll_minus];
    deflection(joystick.x) != 0.0 || deflection(joystick.y) != 0.0 || pressed.contains(&true)
}

fn within_one(v: Vector) -> Vector {
    let length = norm(&v);
    if length > 1.0 { v / length } else { v }
}

fn towards(from: [f64; 3], to: &Vector, most: f64) -> Vector {
    let from = Vector::from(from);
    let change = to - from;
    let length = norm(&change);
    if length > most { from + change * (most / length) } else { *to }
}

impl PrimManual {
    pub fn release(&mut self) {
        self.engaged = false;
        (self.translate, self.rotate) = ([0.0; 3], [0.0; 3]);
    }

    /// Stick and buttons have no effect while a motion in other coordinates ramps down.
    pub fn ask(&mut self, joystick: &JoystickBox) {
        self.engaged = true;
        let coordinates = Coordinates::of(joystick);
        if self.has_speed() && coordinates != self.coordinates {
            return;
        }
        self.coordinates = coordinates;
        let (x, y) = (deflection(joystick.x), deflection(joystick.y));
        let roll = buttons(joystick.roll_plus, joystick.roll_minus);
        let (translate, rotate) = match coordinates {
            Coordinates::World | Coordinates::Tool => {
                (Vector::new(x, y, buttons(joystick.up, joystick.down)), Vector::new(roll, 0.0, 0.0))
            }
            Coordinates::ToolOrigin | Coordinates::WristOrigin => (Vector::zeros(), Vector::new(roll, x, y)),
            Coordinates::None => (Vector::zeros(), Vector::zeros()),
        };
        self.translate = within_one(translate).into();
        self.rotate = within_one(rotate).into();
    }

    fn has_speed(&self) -> bool {
        self.linear != [0.0; 3] || self.angular != [0.0; 3]
    }

    #[must_use]
    pub fn is_moving(&self) -> bool {
        self.has_speed() || self.translate != [0.0; 3] || self.rotate != [0.0; 3]
    }

    /// Advance by a tick and return the new frame; `knob` is the velocity knob, 0 to 1000.
    pub fn step(&mut self, frame: &Frame, knob: u16) -> Frame {
        let speed = SPEED * f64::from(knob.min(KNOB_FULL)) / f64::from(KNOB_FULL);
        let lever = self.coordinates.lever();
        let asked = Vector::from(self.translate) * speed;
        let linear = if self.coordinates == Coordinates::Tool { frame.rotation * asked } else { asked };
        let angular = frame.rotation * Vector::from(self.rotate) * (speed / lever);
        let linear = towards(self.linear, &linear, RAMP * TICK_S);
        let angular = towards(self.angular, &angular, RAMP * TICK_S / lever);
        let mean = |before: [f64; 3], after: &Vector| (Vector::from(before) + after) * (TICK_S / 2.0);
        let (moved, turned) = (mean(self.linear, &linear), rotation_by(&mean(self.angular, &angular)));
        (self.linear, self.angular) = (linear.into(), angular.into());
        let centre = Vector::new(-self.coordinates.behind(), 0.0, 0.0);
        let turned = turned * frame.rotation;
        // Rounding errors of thousands of products accumulate, so the matrix is made a rotation again.
        let (x, y) = (turned.matrix().column(0).into_owned(), turned.matrix().column(1).into_owned());
        let rotation = rotation_from_x_y(&x, &y).unwrap_or(turned);
        Frame { position: frame.shifted(centre).position + moved, rotation }.shifted(-centre)
    }
}
