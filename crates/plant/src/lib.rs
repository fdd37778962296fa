//! The simulated cell: robot controller, arm, gripper, trays, vise, camera and parts, in rapier.
//!
//! [`Cell::step`] takes what the controller wrote to its devices in a tick and gives what it will read from
//! them in the next; between the two the cell advances by exactly 40 ms. What a person, a job file or a test
//! does beside the robot goes through [`Cell::workstation`]; what happens that should not comes out of
//! [`Cell::events`].
//!
//! # How the arm and the grip are modelled, and why
//!
//! The linkbar job lives on gaps of 0.04 to 0.08 in. At rest the arm must be within 0.01 in, contacts may
//! sink by 0.1 mm, a grip may creep by 0.1 mm and must yet give way at friction, and the linkbar is to run at
//! 50 times real time with one core for physics, better at 200 times.
//!
//! | | multibody arm, motors | chosen: led arm, sprung fingers |
//! |---|---|---|
//! | arm at rest, from its command | 0.35 mrad at 1.6e5/s², 0.05 at 1e6/s² | 0 (servo lag in closed form) |
//! | arm while moving | 5.6 to 7.3 mrad beside the path | on the path, 80 ms behind |
//! | grip by contact friction, one minute | slides by millimetres | below 0.001 mm, limits kept |
//! | blank pressed to the notch with 30 lb | - | sinks by 0.06 mm |
//! | one core, tick of 40 ms | 760 us, 52 x real time | 110 to 185 us, 215 to 360 x |
//!
//! (Left: measured with rapier 0.36 at 16 sub-steps, a six-joint arm and a gripped part of 8 kg; right: `--example
//! figures`, 16 sub-steps.) So:
//!
//! * joints follow their servos exactly ([`arm`]); the T3 controller stands before them: start-up, emergency stops, inverse
//!   kinematics, limits and the link ([`t3`]);
//! * without hydraulic pressure each joint is a damper that gives way to the weights of links, gripper and part
//!   ([`linkage`]) and to what the arm comes to lie on; the shot pin stops the shoulder, and the arm jumps back when the
//!   pressure returns. What the sagging arm has run into is said when it lies still ([`cell::Droop`]);
//! * the hand is a kinematic body at the tool frame, the fingers hang on it by springs that stand for the stiffness of arm,
//!   wrist and fingers ([`gripper`]): everything that the robot touches meets a finite force;
//! * what is between two pads is held by springs with limits ([`hold`]): below friction nothing creeps, beyond it the part
//!   slides ([`friction`]), under no force it falls;
//! * a clamped part is led by the vise ([`vise`]), and forced out of it by a crash;
//! * a gripper is led by the robot or by its holster ([`holster`]); the locking ring decides which, or lets it fall
//!   ([`quick_change`]);
//! * the force sensor reads what the springs of fingers and hold carry ([`force`]); the tool drum pushes back along its axis
//!   and holds a tool as the vise does a part ([`drum`]);
//! * parts on trays, ledge and floor are rapier's, with contacts made stiff enough for gaps of a millimetre.
//!
//! What can go wrong beside is in [`fault`]: it changes what passes between the cell and the controller.

#![forbid(unsafe_code)]
#![warn(missing_docs)]

pub mod arm;
pub mod bodies;
pub mod camera;
pub mod cell;
pub mod clearance;
pub mod convert;
pub mod description;
pub mod drum;
pub mod fault;
pub mod fingerprint;
pub mod force;
pub mod friction;
pub mod gripper;
pub mod hold;
pub mod holster;
pub mod image;
pub mod jaws;
pub mod joystick;
pub mod linkage;
pub mod noise;
pub mod part;
pub mod pedestal;
pub mod quick_change;
pub mod room;
pub mod scene;
pub mod sensor;
pub mod solid;
pub mod squeeze;
pub mod swept;
pub mod t3;
pub mod vise;

pub use cell::{
    Cell, CellError, CellEvent, Droop, Link, Placement, RestoreError, SaveError, WorkstationAction,
    WorkstationError, part_link,
};
pub use description::CellDescription;
pub use joystick::{BoxAction, BoxButton, Joystick};
pub use part::PartState;
pub use t3::{Cut, EStop, Key};
