//! The order of frames to a client: large messages are split into pieces, and a ping follows each piece.
//!
//! The answer to a ping shows that a slow client has read everything before it.

use std::collections::VecDeque;

use tungstenite::{
    Bytes, Message,
    protocol::frame::{
        Frame,
        coding::{Data, OpCode},
    },
};

use crate::live::{
    feed::{Item, Queue},
    protocol,
};

const PIECE: usize = 32 * 1024; // greatest number of bytes of a frame, and between two pings
/// Number of waiting replies after which no more messages of the client are read.
const REPLIES: usize = 16;

#[derive(Debug, Default)]
pub struct Outgoing {
    rest: Option<Bytes>,        // the rest of a partly sent message
    replies: VecDeque<Message>, // messages that precede the queue
    unchecked: usize,           // number of bytes since the last ping
}

impl Outgoing {
    /// Adds a reply. It precedes the messages of the queue.
    pub fn reply(&mut self, message: Message) {
        self.replies.push_back(message);
    }

    /// Returns false if too many replies are waiting, so that the client must read them first.
    #[must_use]
    pub fn takes_replies(&self) -> bool {
        self.replies.len() < REPLIES
    }

    /// Returns true if no message is partly sent or waiting, except in the queue.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rest.is_none() && self.replies.is_empty()
    }

    #[must_use]
    pub const fn is_ping_due(&self) -> bool {
        self.unchecked >= PIECE
    }

    pub const fn pinged(&mut self) {
        self.unchecked = 0;
    }

    pub fn next(&mut self, queue: &Queue) -> Option<Message> {
        if let Some(rest) = self.rest.take() {
            return Some(self.piece(rest, Data::Continue));
        }
        let message = self.replies.pop_front().or_else(|| queue.pop().map(encoded))?;
        Some(match message {
            Message::Binary(bytes) if bytes.len() > PIECE => self.piece(bytes, Data::Binary),
            Message::Text(text) if text.len() > PIECE => self.piece(text.into(), Data::Text),
            small => {
                self.unchecked = self.unchecked.saturating_add(small.len());
                small
            }
        })
    }

    /// The first piece of the bytes; the rest is kept.
    fn piece(&mut self, mut bytes: Bytes, kind: Data) -> Message {
        let piece = bytes.split_to(bytes.len().min(PIECE));
        self.unchecked = self.unchecked.saturating_add(piece.len());
        let is_last = bytes.is_empty();
        self.rest = (!is_last).then_some(bytes);
        Message::Frame(Frame::message(piece, OpCode::Data(kind), is_last))
    }
}

fn encoded(item: Item) -> Message {
    match item {
        Item::Text(text) => Message::text(text.as_ref()),
        Item::Time(time) => Message::binary(protocol::time(time)),
        Item::Message { subscription, time, data } => {
            Message::binary(protocol::message(subscription, time, &data))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_message_is_split_with_a_ping_after_each_piece() {
        let (mut outgoing, queue) = (Outgoing::default(), Queue::default());
        let text = "x".repeat(2 * PIECE + 1);
        outgoing.reply(Message::text(text.as_str()));
        outgoing.reply(Message::text("small"));
        let mut sent = Vec::new();
        for (length, is_last) in [(PIECE, false), (PIECE, false), (1, true)] {
            assert!(!outgoing.is_ping_due());
            let Some(Message::Frame(frame)) = outgoing.next(&queue) else { panic!("a frame was expected") };
            assert_eq!((frame.payload().len(), frame.header().is_final), (length, is_last));
            assert_eq!(outgoing.is_ping_due(), length == PIECE);
            sent.extend_from_slice(frame.payload());
            outgoing.pinged();
        }
        assert_eq!(sent, text.as_bytes());
        assert!(!outgoing.is_empty());
        assert_eq!(outgoing.next(&queue), Some(Message::text("small")));
        assert!(outgoing.is_empty() && outgoing.next(&queue).is_none());
    }

    #[test]
    fn replies_are_bounded() {
        let mut outgoing = Outgoing::default();
        for _ in 0..REPLIES {
            assert!(outgoing.takes_replies());
            outgoing.reply(Message::text("reply"));
        }
        assert!(!outgoing.takes_replies());
    }
}
