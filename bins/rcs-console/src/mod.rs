//! The operator's console (IV, VI.6) shows what every control process does and why.
//!
//! ```text
//!  run ---> source::Live ----.
//!                             >-- Picture, Story --> model --> view --> terminal
//!  log ---> source::Recorded -'                        ^
//!                                                     keys
//! ```
//!
//! [`source`] gives a [`Picture`](picture::Picture) for a tick, and the [`Story`](story::Story) of all ticks. [`model`]
//! is the state of the console without a terminal, [`view`] draws it on at least 80 x 24, [`terminal`] reads keys.
//!
//! Without `--operate` the console only reads. A run never waits for the console.

#![forbid(unsafe_code)]

pub mod cli;
pub mod error;
mod hand;
mod hang_up;
pub mod model;
pub mod once;
pub mod picture;
mod redraw;
mod search;
pub mod source;
pub mod story;
pub mod terminal;
pub mod view;
mod watch;
