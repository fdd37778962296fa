//! The Data System's database, and keepers that may wait for the disk and the network.
//!
//! A tick must not wait for either: [`Threaded`] is a keeper on a thread, with the database in this process ([`Store`])
//! or with a server in another one ([`Agent`]).

mod agent;
mod alone;
#[cfg(test)]
mod books;
mod outbox;
mod store;
#[cfg(test)]
mod tests;
mod thread;

use neighbours::data_system::ANSWER_TICKS;

pub use agent::{Agent, Remark};
pub use outbox::{Outbox, OutboxError};
pub use store::{Store, StoreError, Visit};
pub use thread::{Pace, Threaded};

pub type DataSystem = neighbours::data_system::DataSystem<Threaded>;

/// A Data System with a database in this process, which answers a command after at least `answer_ticks` ticks.
#[must_use]
pub fn here(store: Store, answer_ticks: u64, pace: Pace) -> DataSystem {
    DataSystem::new(Threaded::here(store, pace), answer_ticks)
}

/// A Data System in another process. In a run that waits for its neighbours, its answers take as many ticks as the
/// answers of a server in this process.
#[must_use]
pub fn elsewhere(agent: Agent, pace: Pace) -> DataSystem {
    let ticks = if pace == Pace::Wait { ANSWER_TICKS } else { 0 };
    DataSystem::new(Threaded::elsewhere(agent, pace), ticks)
}
