//! The messages for clients: channels, the newest message of each, the last minute of messages, and a queue per client.
//!
//! A client that subscribes receives the newest message of the channel at once, with the present time. For transforms
//! it receives the newest ones of all links. A client that has requested the past instead receives the state at its
//! beginning, and all later messages with their times.

use std::{
    collections::{BTreeMap, VecDeque},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use record::{Tap, names::REPLAY, tap::Channel};

use crate::live::{
    frames::{self, Frames},
    protocol,
};

pub const QUEUE: usize = 4096;
/// Greatest number of bytes in a client's queue; a single longer message is accepted.
pub const QUEUE_BYTES: usize = 8 << 20;

/// The past kept for clients that connect later, seconds of the run.
pub const PAST_S: u64 = 60;
/// Greatest number of bytes of the past, three times that of the linkbar. Above it, channels keep a shorter past.
pub const PAST_BYTES: usize = 16 << 20;

const NS_PER_S: u64 = 1_000_000_000;

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The channels and messages of a run or a log. Clones share the same feed.
#[derive(Clone, Debug, Default)]
pub struct Feed(Arc<Mutex<Inner>>);

#[derive(Debug, Default)]
struct Inner {
    channels: BTreeMap<u16, Known>,
    past_bytes: usize, // number of bytes in the pasts of all channels
    now: u64,          // time of the newest message, ns
    queues: Vec<Arc<Queue>>,
    is_over: bool,
}

#[derive(Debug)]
struct Known {
    advertised: String,
    newest: Newest,
    past: Past,
}

#[derive(Debug)]
struct Past {
    messages: VecDeque<(u64, Arc<[u8]>)>, // messages with their times, ns, the oldest first
    before: Newest,                       // the newest data before these messages
    /// True if no past is kept, because the messages are differences, which need all earlier messages.
    is_off: bool,
}

impl Past {
    /// Add a message, and remove those that are too old or exceed the space.
    fn add(&mut self, time: u64, data: &Arc<[u8]>, bytes: &mut usize) {
        if self.is_off {
            return;
        }
        self.messages.push_back((time, Arc::clone(data)));
        *bytes = bytes.saturating_add(data.len());
        let oldest = time.saturating_sub(PAST_S * NS_PER_S);
        while self.messages.front().is_some_and(|(time, _)| *time < oldest) || *bytes > PAST_BYTES {
            let Some((_, data)) = self.messages.pop_front() else { break };
            *bytes = bytes.saturating_sub(data.len());
            self.before.take(&data);
        }
    }

    /// The state at a time, and the messages from that time on.
    fn since(&self, start: u64) -> (Newest, impl Iterator<Item = &(u64, Arc<[u8]>)>) {
        let mut state = self.before.clone();
        let mut later = self.messages.iter().peekable();
        while let Some((_, data)) = later.next_if(|(time, _)| *time < start) {
            state.take(data);
        }
        (state, later)
    }
}

/// The newest data of a channel, which a new subscriber receives.
#[derive(Clone, Debug)]
enum Newest {
    Nothing,
    Message(Arc<[u8]>),
    Frames(Frames),
}

impl Newest {
    fn of(channel: &Channel<'_>) -> Self {
        if channel.schema_name == frames::SCHEMA { Self::Frames(Frames::default()) } else { Self::Nothing }
    }

    fn take(&mut self, data: &Arc<[u8]>) {
        match self {
            Self::Frames(frames) => frames.add(data),
            newest => *newest = Self::Message(Arc::clone(data)),
        }
    }

    fn message(&self) -> Option<Arc<[u8]>> {
        match self {
            Self::Nothing => None,
            Self::Message(data) => Some(Arc::clone(data)),
            Self::Frames(frames) => Some(frames.message().into()).filter(|data: &Arc<[u8]>| !data.is_empty()),
        }
    }
}

impl Feed {
    /// The tap to which the log writes. Dropping it ends the feed.
    #[must_use]
    pub fn tap(&self) -> Box<dyn Tap> {
        Box::new(Tapped(self.clone()))
    }

    /// Adds a client. Returns its queue and the first channels to advertise to it.
    #[must_use]
    pub fn join(&self) -> (Arc<Queue>, String) {
        let mut inner = lock(&self.0);
        let queue = Arc::new(Queue::default());
        lock(&queue.0).is_over = inner.is_over;
        inner.queues.push(Arc::clone(&queue));
        (queue, protocol::advertise(inner.channels.values().map(|known| known.advertised.as_str())))
    }

    pub fn leave(&self, queue: &Arc<Queue>) {
        lock(&self.0).queues.retain(|known| !Arc::ptr_eq(known, queue));
    }

    #[must_use]
    pub fn has(&self, channel: u16) -> bool {
        lock(&self.0).channels.contains_key(&channel)
    }

    /// Sends the messages of a channel to a client, beginning with the newest one, or with the state `past_s` ago.
    pub fn subscribe(&self, queue: &Queue, channel: u16, subscription: u32, past_s: u64) {
        let inner = lock(&self.0);
        let mut waiting = lock(&queue.0);
        waiting.subscriptions.insert(channel, subscription);
        let Some(known) = inner.channels.get(&channel) else { return };
        let mut push = |time: u64, data: Arc<[u8]>| {
            waiting.first.push_back(Item::Message { subscription, time, data });
        };
        if past_s == 0 || known.past.is_off {
            if let Some(data) = known.newest.message() {
                push(inner.now, data);
            }
            return;
        }
        let start = inner.now.saturating_sub(past_s.min(PAST_S) * NS_PER_S);
        let (state, later) = known.past.since(start);
        if let Some(data) = state.message() {
            push(start, data);
        }
        later.for_each(|(time, data)| push(*time, Arc::clone(data)));
    }

    #[must_use]
    pub fn viewers(&self) -> usize {
        lock(&self.0).queues.len()
    }

    #[must_use]
    pub fn is_watched(&self) -> bool {
        lock(&self.0).queues.iter().any(|queue| !lock(&queue.0).subscriptions.is_empty())
    }

    #[must_use]
    pub fn is_over(&self) -> bool {
        lock(&self.0).is_over
    }

    pub fn finish(&self) {
        let mut inner = lock(&self.0);
        inner.is_over = true;
        inner.queues.iter().for_each(|queue| lock(&queue.0).is_over = true);
    }
}

struct Tapped(Feed);

impl Tap for Tapped {
    fn channel(&mut self, id: u16, channel: &Channel<'_>) {
        let advertised = protocol::channel(id, channel);
        let mut inner = lock(&self.0.0);
        // The next log of a run has the same channels.
        if inner.channels.get(&id).is_some_and(|known| known.advertised == advertised) {
            return;
        }
        let text: Arc<str> = protocol::advertise([advertised.as_str()].into_iter()).into();
        for queue in &inner.queues {
            lock(&queue.0).first.push_back(Item::Text(Arc::clone(&text)));
        }
        let is_off = channel.topic == REPLAY;
        let past = Past { messages: VecDeque::new(), before: Newest::of(channel), is_off };
        inner.channels.insert(id, Known { advertised, newest: Newest::of(channel), past });
    }

    fn message(&mut self, channel: u16, time: u64, data: &[u8]) {
        let data: Arc<[u8]> = data.into();
        let mut guard = lock(&self.0.0);
        let inner = &mut *guard;
        let is_new = time > inner.now;
        inner.now = inner.now.max(time);
        let Some(known) = inner.channels.get_mut(&channel) else { return };
        known.newest.take(&data);
        known.past.add(time, &data, &mut inner.past_bytes);
        for queue in &inner.queues {
            let mut waiting = lock(&queue.0);
            if is_new {
                waiting.push(Item::Time(time));
            }
            if let Some(subscription) = waiting.subscriptions.get(&channel).copied() {
                waiting.push(Item::Message { subscription, time, data: Arc::clone(&data) });
            }
        }
    }

    fn tick(&mut self, time: u64) {
        let mut inner = lock(&self.0.0);
        if time > inner.now {
            inner.now = time;
            inner.queues.iter().for_each(|queue| lock(&queue.0).push(Item::Time(time)));
        }
    }
}

impl Drop for Tapped {
    fn drop(&mut self) {
        self.0.finish();
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Item {
    Text(Arc<str>),
    /// The present time, ns.
    Time(u64),
    Message {
        subscription: u32, // the client's number of the subscription
        time: u64,         // ns
        data: Arc<[u8]>,   // the message as in the log
    },
}

impl Item {
    fn bytes(&self) -> usize {
        match self {
            Self::Message { data, .. } => data.len(),
            Self::Text(_) | Self::Time(_) => 0,
        }
    }

    fn is_of(&self, wanted: u32) -> bool {
        matches!(self, Self::Message { subscription, .. } if *subscription == wanted)
    }
}

#[derive(Debug, Default)]
pub struct Queue(Mutex<Waiting>);

#[derive(Debug, Default)]
struct Waiting {
    subscriptions: BTreeMap<u16, u32>, // the client's subscription numbers by channel
    /// Items that are never dropped: new channels, and the first messages of each subscription.
    first: VecDeque<Item>,
    later: VecDeque<Item>, // items that can be dropped, the oldest first
    bytes: usize,          // number of bytes in `later`
    dropped: u64,
    is_over: bool,
}

impl Waiting {
    fn push(&mut self, item: Item) {
        let bytes = item.bytes();
        while self.later.len() >= QUEUE || (self.bytes > 0 && self.bytes.saturating_add(bytes) > QUEUE_BYTES)
        {
            let Some(oldest) = self.later.pop_front() else { break };
            self.bytes = self.bytes.saturating_sub(oldest.bytes());
            self.dropped = self.dropped.saturating_add(u64::from(matches!(oldest, Item::Message { .. })));
        }
        self.bytes = self.bytes.saturating_add(bytes);
        self.later.push_back(item);
    }
}

impl Queue {
    #[must_use]
    pub fn pop(&self) -> Option<Item> {
        let mut waiting = lock(&self.0);
        let item = waiting.first.pop_front();
        item.or_else(|| {
            let item = waiting.later.pop_front()?;
            waiting.bytes = waiting.bytes.saturating_sub(item.bytes());
            Some(item)
        })
    }

    /// Stops sending the messages of a channel, and removes them from the queue.
    pub fn unsubscribe(&self, channel: u16) {
        let mut waiting = lock(&self.0);
        let Some(subscription) = waiting.subscriptions.remove(&channel) else { return };
        waiting.first.retain(|item| !item.is_of(subscription));
        waiting.later.retain(|item| !item.is_of(subscription));
        waiting.bytes = waiting.later.iter().map(Item::bytes).sum();
    }

    #[must_use]
    pub fn dropped(&self) -> u64 {
        lock(&self.0).dropped
    }

    #[must_use]
    pub fn is_over(&self) -> bool {
        let waiting = lock(&self.0);
        waiting.is_over && waiting.first.is_empty() && waiting.later.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: Channel<'static> = Channel {
        topic: "/robot_description",
        encoding: "cdr",
        schema_name: "std_msgs/msg/String",
        schema_encoding: "ros2msg",
        schema: b"string data",
    };

    fn all(queue: &Queue) -> Vec<Item> {
        std::iter::from_fn(|| queue.pop()).collect()
    }

    fn message(subscription: u32, time: u64, data: &[u8]) -> Item {
        Item::Message { subscription, time, data: data.into() }
    }

    #[test]
    fn subscriber_gets_the_newest_message_at_once() {
        let feed = Feed::default();
        let mut tap = feed.tap();
        tap.channel(1, &TEXT);
        tap.channel(2, &Channel { topic: "/other", ..TEXT });
        tap.message(1, 10, b"once");
        tap.message(2, 50, b"later");
        let (queue, channels) = feed.join();
        assert!(channels.contains("/robot_description") && channels.contains("/other"), "{channels}");
        assert!(!feed.is_watched());
        feed.subscribe(&queue, 1, 7, 0);
        assert!(feed.is_watched());
        assert_eq!(all(&queue), [message(7, 50, b"once")]);
        tap.message(2, 90, b"not subscribed");
        tap.message(1, 90, b"again");
        assert_eq!(all(&queue), [Item::Time(90), message(7, 90, b"again")]);
        tap.channel(3, &TEXT);
        assert!(matches!(&all(&queue)[..], [Item::Text(text)] if text.contains("\"id\":3")));
        queue.unsubscribe(1);
        tap.message(1, 90, b"gone");
        tap.tick(90);
        assert_eq!(all(&queue), []);
        tap.tick(130);
        assert_eq!(all(&queue), [Item::Time(130)], "a tick without messages has a time, too");
        drop(tap);
        assert!(queue.is_over());
        assert!(feed.join().0.is_over());
    }

    #[test]
    fn full_queue_drops_the_oldest_repeatable_message() {
        let feed = Feed::default();
        let mut tap = feed.tap();
        tap.channel(1, &TEXT);
        tap.channel(2, &TEXT);
        tap.message(1, 1, b"once");
        let (queue, _) = feed.join();
        feed.subscribe(&queue, 1, 1, 0);
        feed.subscribe(&queue, 2, 2, 0);
        for number in 0..u64::try_from(QUEUE).unwrap() + 100 {
            tap.message(2, 1, &number.to_le_bytes());
        }
        assert_eq!(queue.dropped(), 100);
        let left = all(&queue);
        assert_eq!((left.len(), &left[0]), (QUEUE + 1, &message(1, 1, b"once")));
        assert_eq!(left[1], message(2, 1, &100_u64.to_le_bytes()));
        let large = vec![0; QUEUE_BYTES / 4];
        (0..6).for_each(|_| tap.message(2, 1, &large));
        assert_eq!((queue.dropped(), all(&queue).len()), (102, 4));
        let huge = vec![0; QUEUE_BYTES * 2];
        tap.message(2, 1, &large);
        tap.message(2, 1, &huge);
        assert_eq!((queue.dropped(), all(&queue).len()), (103, 1));
    }

    const S: u64 = NS_PER_S;

    #[test]
    fn late_client_gets_the_earlier_state_and_later_messages() {
        let feed = Feed::default();
        let mut tap = feed.tap();
        tap.channel(1, &TEXT);
        tap.channel(2, &Channel { topic: REPLAY, ..TEXT });
        for second in 0..=100_u8 {
            tap.message(1, u64::from(second) * S, &[second]);
            tap.message(2, u64::from(second) * S, &[second]);
        }
        let (queue, _) = feed.join();
        feed.subscribe(&queue, 1, 7, 2);
        let expected = [(98, 97), (98, 98), (99, 99), (100, 100)];
        assert_eq!(all(&queue), expected.map(|(time, data): (u64, u8)| message(7, time * S, &[data])));
        feed.subscribe(&queue, 1, 8, u64::MAX);
        let found = all(&queue);
        assert_eq!((found.len(), &found[0]), (62, &message(8, 40 * S, &[39])), "a minute is kept");
        feed.subscribe(&queue, 2, 9, 60);
        assert_eq!(all(&queue), [message(9, 100 * S, &[100])], "differences are of no use");
    }

    #[test]
    fn past_is_bounded_in_bytes_and_keeps_its_first_state() {
        let feed = Feed::default();
        let mut tap = feed.tap();
        tap.channel(1, &TEXT);
        let large = vec![0; PAST_BYTES / 4];
        (0..10).for_each(|second| tap.message(1, second * S, &large));
        let (queue, _) = feed.join();
        feed.subscribe(&queue, 1, 7, 60);
        assert_eq!(all(&queue).len(), 5, "four messages, and the state before them");
        assert!(lock(&feed.0).past_bytes <= PAST_BYTES);
    }
}
