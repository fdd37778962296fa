//! One client: what it may ask for, and what it gets. No I/O.
//!
//! What is wrong is answered with a status and changes nothing; a client that is wrong too often is
//! disconnected.

use std::collections::BTreeMap;

use crate::protocol::{self, Request, StatusLevel, Subscription};

/// Subscriptions at a time.
pub const SUBSCRIPTIONS: usize = 512;
/// Wrong messages after which a client is disconnected.
pub const MISTAKES: u32 = 32;
/// Characters of a client's message that stand in the answer.
const QUOTED: usize = 60;

/// What is to be done for a client.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Action {
    /// Send text.
    Text(String),
    /// Send the messages of a channel, the newest one first.
    Subscribe {
        /// The channel.
        channel: u16,
        /// The client's number for it.
        subscription: u32,
    },
    /// Send no more of them.
    Unsubscribe {
        /// The channel.
        channel: u16,
    },
    /// Disconnect.
    Close(String),
}

/// What a client has asked for so far.
#[derive(Debug, Default)]
pub struct Session {
    /// Channels by the client's numbers.
    subscriptions: BTreeMap<u32, u16>,
    mistakes: u32,
}

impl Session {
    /// A text has come. `is_known` tells whether there is a channel of a number.
    pub fn text(&mut self, text: &str, is_known: impl Fn(u16) -> bool) -> Vec<Action> {
        match serde_json::from_str(text) {
            Ok(Request::Subscribe { subscriptions }) => {
                subscriptions.into_iter().flat_map(|wanted| self.subscribe(wanted, &is_known)).collect()
            }
            Ok(Request::Unsubscribe { subscription_ids }) => {
                subscription_ids.into_iter().flat_map(|id| self.unsubscribe(id)).collect()
            }
            Err(error) => self.wrong(&format!("{error}, in {}", quoted(text))),
        }
    }

    /// Bytes have come.
    pub fn binary(&mut self, bytes: &[u8]) -> Vec<Action> {
        match bytes.first() {
            Some(code) => self.wrong(&format!("a binary message with operation code {code} is not served")),
            None => self.wrong("a binary message has an operation code, this one is empty"),
        }
    }

    fn subscribe(&mut self, wanted: Subscription, is_known: impl Fn(u16) -> bool) -> Vec<Action> {
        let Subscription { id, channel_id } = wanted;
        let known = u16::try_from(channel_id).ok().filter(|channel| is_known(*channel));
        let Some(channel) = known else {
            return self
                .wrong(&format!("there is no channel {channel_id}: subscribe to one that is advertised"));
        };
        if self.subscriptions.contains_key(&id) {
            return self
                .wrong(&format!("subscription {id} is in use: unsubscribe first, or take another id"));
        }
        if self.subscriptions.values().any(|subscribed| *subscribed == channel) {
            return self.wrong(&format!("channel {channel} is subscribed already: once a channel is enough"));
        }
        if self.subscriptions.len() >= SUBSCRIPTIONS {
            return self.wrong(&format!("a client has {SUBSCRIPTIONS} subscriptions at most"));
        }
        self.subscriptions.insert(id, channel);
        vec![Action::Subscribe { channel, subscription: id }]
    }

    fn unsubscribe(&mut self, id: u32) -> Vec<Action> {
        match self.subscriptions.remove(&id) {
            Some(channel) => vec![Action::Unsubscribe { channel }],
            None => self.wrong(&format!("there is no subscription {id}")),
        }
    }

    fn wrong(&mut self, why: &str) -> Vec<Action> {
        self.mistakes = self.mistakes.saturating_add(1);
        match self.mistakes {
            ..MISTAKES => vec![Action::Text(protocol::status(StatusLevel::Error, why, None))],
            MISTAKES => vec![Action::Close(format!("{MISTAKES} wrong messages, at last: {why}"))],
            _ => Vec::new(),
        }
    }
}

/// The beginning of a client's message, without control characters.
fn quoted(text: &str) -> String {
    let plain = |c: char| if c.is_control() { ' ' } else { c };
    let start: String = text.chars().take(QUOTED).map(plain).collect();
    if start.len() < text.len() { format!("{start} ...") } else { start }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::{Value, json};

    fn status_of(actions: &[Action]) -> String {
        let [Action::Text(text)] = actions else { panic!("one status was expected, found {actions:?}") };
        let status: Value = serde_json::from_str(text).unwrap();
        assert_eq!((&status["op"], &status["level"]), (&json!("status"), &json!(2)));
        status["message"].as_str().unwrap().to_owned()
    }

    fn subscribe(session: &mut Session, id: u64, channel: u64) -> Vec<Action> {
        let text = json!({ "op": "subscribe", "subscriptions": [{ "id": id, "channelId": channel }] });
        session.text(&text.to_string(), |channel| (1..=600).contains(&channel))
    }

    #[test]
    fn a_channel_is_subscribed_once_and_let_go() {
        let mut session = Session::default();
        assert_eq!(subscribe(&mut session, 7, 1), [Action::Subscribe { channel: 1, subscription: 7 }]);
        assert!(status_of(&subscribe(&mut session, 7, 2)).contains("subscription 7 is in use"));
        assert!(status_of(&subscribe(&mut session, 8, 1)).contains("channel 1 is subscribed already"));
        let end =
            |session: &mut Session| session.text(r#"{"op":"unsubscribe","subscriptionIds":[7]}"#, |_| true);
        assert_eq!(end(&mut session), [Action::Unsubscribe { channel: 1 }]);
        assert!(status_of(&end(&mut session)).contains("no subscription 7"));
        assert_eq!(subscribe(&mut session, 7, 1).len(), 1);
    }

    #[test]
    fn channels_that_are_not_there_are_refused() {
        let mut session = Session::default();
        for channel in [0, 601, 65_537, u64::MAX] {
            assert!(status_of(&subscribe(&mut session, 1, channel)).contains("there is no channel"));
        }
    }

    #[test]
    fn subscriptions_are_bounded() {
        let mut session = Session::default();
        for number in 1..=512 {
            assert!(matches!(subscribe(&mut session, number, number)[..], [Action::Subscribe { .. }]));
        }
        assert!(status_of(&subscribe(&mut session, 513, 513)).contains("512 subscriptions at most"));
    }

    #[test]
    fn what_is_no_message_is_answered_and_ends_the_session_at_last() {
        let mut session = Session::default();
        let wrong = ["", "{", "[]", "null", r#"{"op":1}"#, r#"{"op":"fly"}"#, "{\"op\":\"subscribe\"}\u{7}"];
        for text in wrong {
            assert!(!status_of(&session.text(text, |_| true)).is_empty(), "{text}");
        }
        status_of(&session.binary(&[]));
        assert!(status_of(&session.binary(&[99, 1])).contains("operation code 99"));
        let deep = "[".repeat(60_000);
        status_of(&session.text(&deep, |_| true));
        let rest = (10..MISTAKES).map(|_| session.binary(&[9])).last().unwrap();
        assert!(matches!(&rest[..], [Action::Close(why)] if why.contains("32 wrong messages")), "{rest:?}");
        assert_eq!(session.binary(&[9]), []);
    }

    proptest::proptest! {
        #[test]
        fn no_message_panics(text: String, bytes: Vec<u8>, known: bool) {
            let mut session = Session::default();
            session.text(&text, |_| known);
            session.binary(&bytes);
        }
    }
}
