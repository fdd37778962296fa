//! The updates that the Data System has not accepted (IV.4.2, IX.2; docs/design/recovery.md "Database"). No header
//! names the rows.

use interfaces::data_base::Connection;
use rcs_core::{Actions, Plain, Variables, decision_table};

use super::item::Notice;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Pending {
    /// No pending update.
    None,
    /// One.
    One,
    /// Two: the queue is full.
    Two,
}

/// An event that changes the queue.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Event {
    /// Nothing happens in this tick.
    None,
    /// The last command to the Data System, which contains the first update, is done.
    Accepted,
    /// A new update.
    New,
    /// SHUTDOWN: the Data System is disconnected.
    Discard,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Actions)]
pub enum QueueChange {
    /// No change.
    Keep,
    /// Remove the first update; the second one becomes the first.
    RemoveFirst,
    /// The new update becomes the first.
    StoreFirst,
    /// The new update becomes the second, and replaces the old second one.
    StoreSecond,
    /// Remove all updates.
    Clear,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct Change {
    /// The event.
    pub event: Event,
    /// The pending updates before it.
    pub pending: Pending,
}

#[derive(Clone, Copy, Debug, Variables)]
pub struct Unsent {
    /// The pending updates.
    pub pending: Pending,
    /// The connection of the Data System.
    pub connection: Connection,
    /// The update of the current command.
    pub due: Notice,
}

decision_table! {
    /// QUEUE: the pending updates. A full queue keeps the oldest one, which may have been sent, and the newest one,
    /// which has the object's place now.
    pub QUEUE: fn queue(self::Change) -> self::QueueChange {
        1: event: None                     => Keep;
        2: event: Accepted                 => RemoveFirst;
        3: event: New, pending: None       => StoreFirst;
        4: event: New, pending: One | Two  => StoreSecond;
        5: event: Discard                  => Clear;
    }
}

decision_table! {
    /// UPDATE: the update in the next order to the Data System. Pending updates are sent first, also at the end of a
    /// STARTUP.
    pub UPDATE: fn update(self::Unsent) -> super::Update {
        1: pending: One | Two, connection: Open | Opening  => Pending;
        2: connection: Open, due: Send                     => Due;
        3: otherwise                                       => None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The model is a queue of any length, of which Task keeps the oldest and the newest update.
    #[test]
    fn full_queue_keeps_the_oldest_and_the_newest_update() {
        let (mut kept, mut model) = ([None; 2], Vec::new());
        let events =
            [Event::New, Event::New, Event::New, Event::None, Event::Accepted, Event::New, Event::Accepted];
        for (number, event) in
            events.into_iter().cycle().take(70).chain([Event::New, Event::Discard]).enumerate()
        {
            let pending = match kept.iter().flatten().count() {
                0 => Pending::None,
                1 => Pending::One,
                _ => Pending::Two,
            };
            match event {
                Event::None => {}
                Event::New => model.push(number),
                Event::Accepted => drop(model.remove(0)),
                Event::Discard => model.clear(),
            }
            if model.len() > 2 {
                model.remove(1);
            }
            kept = match (queue((), &Change { event, pending }).action, kept) {
                (QueueChange::Keep, kept) => kept,
                (QueueChange::RemoveFirst, [_, second]) => [second, None],
                (QueueChange::StoreFirst, [first, _]) => {
                    assert_eq!(first, None);
                    [Some(number), None]
                }
                (QueueChange::StoreSecond, [first, _]) => [first, Some(number)],
                (QueueChange::Clear, _) => [None; 2],
            };
            assert_eq!(kept.into_iter().flatten().collect::<Vec<_>>(), model, "{number}: {event:?}");
        }
        assert_eq!(kept, [None; 2]);
    }
}
