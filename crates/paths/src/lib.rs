//! Checks the robot's paths before it moves: whether the robot can follow the path of a command, a job or a stored
//! route, and what it touches.
//!
//! ```text
//!   steps     the steps that Task and Subtask make of a command (V.3, V.4)
//!   walk      the path of each step: E-move's own route, point by point
//!   flight    the motion through the points: Prim's motion, the limits of the link, the joints of the T3, its servos
//!   survey    contacts and clearances of arm, gripper and held part on the way: the bodies and permits of a run
//!   known     cache of the flights that were checked
//!   state     the state of the cell, and how steps change it
//!   holster   what a change of the gripper needs of the task data
//!   presence  what must be true in the cell before a step
//!   judge     a phase checked forward and back: its findings, and a via point that helps
//!   job       the lines of a job in order, with the positions of the parts and the held part
//!   stored    each segment of the stored trajectories
//!   uses      the records of the task data that a command uses
//! ```
//!
//! This crate starts no program, reads no clock and simulates no forces. [`job::NOT_CHECKED`] lists what a walk cannot
//! check.

#![forbid(unsafe_code)]

mod entries;
pub mod finding;
pub mod flight;
pub mod holster;
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
pub mod uses;
pub mod walk;
