//! The simulated cell: robot controller, arm, gripper, trays, vise, camera and parts, in rapier.
//!
//! [`Cell::step`] takes the controller's outputs of one tick and returns its inputs of the next; in between,
//! the cell advances by exactly 40 ms. Other actions of an operator, a job or a test go through
//! [`Cell::workstation`]; [`Cell::events`] returns errors and events.
//!
//! # How the arm and the grip are modelled, and why
//!
//! The linkbar job has gaps of 0.04 to 0.08 in. At rest the arm must be within 0.01 in, contacts may penetrate by 0.1
//! mm, a grip may creep by 0.1 mm but must slide at the limit of friction, and the linkbar should run at 50, better
//! 200, times real time with one core for physics.
//!
//! | | multibody arm, motors | chosen: kinematic arm, sprung fingers |
//! |---|---|---|
//! | arm at rest, from its command | 0.35 mrad at 1.6e5/s², 0.05 at 1e6/s² | 0 (servo lag in closed form) |
//! | arm while moving | 5.6 to 7.3 mrad off the path | on the path, 80 ms behind |
//! | grip by contact friction, one minute | slides by millimetres | below 0.001 mm, limits kept |
//! | blank pressed to the notch with 30 lb | - | penetrates by 0.06 mm |
//! | one core, tick of 40 ms | 760 us, 52 x real time | 110 to 185 us, 215 to 360 x |
//!
//! (Left: measured with rapier 0.36 at 16 sub-steps, a six-joint arm and a gripped part of 8 kg; right: `--example
//! figures`, 16 sub-steps.) So:
//!
//! * joints follow their servos exactly ([`arm`]); the T3 controller commands them: start-up, emergency stops, inverse
//!   kinematics, limits and the link ([`t3`]);
//! * without hydraulic pressure each joint is a damper that yields to the weights of links, gripper and part
//!   ([`linkage`]) and to contacts; the shot pin stops the shoulder, and the arm jumps back when the pressure returns.
//!   Contacts of the sagging arm are reported when it is at rest ([`cell::SagReport`]);
//! * the hand is a kinematic body at the tool frame, the fingers are attached by springs with the stiffness of arm,
//!   wrist and fingers ([`gripper`]): every contact of the robot has a finite force;
//! * a part between two pads is held by springs with limits ([`hold`]): below friction nothing creeps, beyond it the
//!   part slides ([`friction`]), under no force it falls;
//! * a clamped part moves with the jaws of the vise ([`vise`]), and a crash forces it out;
//! * a gripper is on the robot or in its holster ([`holster`]); the locking ring decides which, or drops it
//!   ([`quick_change`]);
//! * the force sensor reads the forces of the springs of fingers and hold ([`force`]); the tool drum pushes back along
//!   its axis and holds a tool as the vise does a part ([`drum`]);
//! * parts on trays, ledge and floor are rigid bodies of rapier, with contacts stiff enough for gaps of a millimetre.
//!
//! [`scene`] and [`look`] describe the cell for viewers, and [`fault`] injects faults into the data between the
//! cell and the controller.

#![forbid(unsafe_code)]

pub mod arm;
pub mod bodies;
pub mod camera;
pub mod cell;
mod changer;
pub mod clearance;
pub mod convert;
pub mod description;
pub mod drum;
pub mod fault;
pub mod finger;
pub mod fingerprint;
pub mod force;
pub mod friction;
mod grasp;
pub mod gripper;
mod hand;
pub mod hold;
pub mod holster;
mod ideal;
pub mod image;
pub mod jaws;
pub mod joystick;
pub mod linkage;
pub mod look;
mod named;
pub mod noise;
pub mod part;
pub mod pedestal;
pub mod quick_change;
mod resolver_box;
pub mod room;
pub mod scene;
pub mod sensor;
pub mod solid;
pub mod squeeze;
pub mod swept;
pub mod t3;
pub mod vise;
mod world;

pub use cell::{
    Cell, CellError, CellEvent, Half, Holders, LinkPose, Placement, RestoreError, RingState, SagReport,
    SaveError, WorkstationAction, WorkstationError, devices, part_link,
};
pub use description::CellDescription;
pub use ideal::Ideal;
pub use interfaces::station::{BoxAction, BoxButton, EStop, Key, ResolverKey, TableKey};
pub use joystick::Joystick;
pub use part::PartState;
pub use pedestal::TablePanel;
pub use t3::Cut;
