//! Check of the robot's paths before it moves: the path of a command, a job or a stored route, and whether the robot
//! can follow it.
//!
//! ```text
//!   steps     what Task and Subtask make of a command (V.3, V.4)
//!   walk      where each step leads: E-move's own route, point by point
//!   flight    the points as Prim drives them: its motion, the limits of the link, the joints of the T3, its servos
//!   survey    what arm, gripper and held part touch or pass on the way: the bodies and permits of a run
//!   known     flights that were looked at, for those that come again
//!   state     where everything is, and what a step changes
//!   presence  what has to be where before a step
//!   judge     a phase flown forth and back: what is wrong with it, and the via point that would help
//!   job       the lines of a job one after the other, with what stands where and what is held
//!   stored    each segment of the stored trajectories
//! ```
//!
//! This crate starts no program, reads no clock and simulates no forces. [`job::NOT_CHECKED`] lists what a walk cannot
//! check.

#![forbid(unsafe_code)]

pub mod finding;
pub mod flight;
pub mod job;
pub mod judge;
pub mod known;
pub mod plan;
mod presence;
pub mod stand;
pub mod state;
pub mod steps;
pub mod stored;
pub mod survey;
pub mod walk;
