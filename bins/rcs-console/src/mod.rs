//! The operator's console (IV, VI.6) shows what every control process does and why.
//!
//! ```text
//!  run ---> source::Live ----.
//!                             >-- Picture, Story --> model --> view --> terminal
//!  log ---> source::Recorded -'                        ^
//!                                                     keys
//! ```
//!
//! * [`source`]: gives a [`Picture`](picture::Picture) for a tick, and the [`Story`](story::Story) of all ticks;
//! * [`model`]: the state of the console without a terminal: keys and pictures in, lines and choices out;
//! * [`view`]: the model as a frame of text, on any terminal of at least 80 x 24;
//! * [`terminal`]: keys, signals, and restoring the terminal at the end.
//!
//! * `watch`: saves the watched fields between sessions;
//! * `hand`: the session of an operator with a run, with `--operate`;
//! * `hang_up`: the end of the console if its terminal disappears.
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
