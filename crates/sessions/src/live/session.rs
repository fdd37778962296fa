//! The session of one client, without I/O: its requests and the resulting actions.
//!
//! An invalid message is answered with a status and has no other effect. Too many disconnect the client.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde_json::{Value, json};

use crate::live::{
    commands::{Knob, SERVICES, Service, Token},
    feed::PAST_S,
    protocol::{self, Parameter, Request, ServiceCall, StatusLevel, Subscription},
};

pub const SUBSCRIPTIONS: usize = 512; // greatest number of subscriptions of a client
pub const MISTAKES: u32 = 32; // number of invalid messages after which a client is disconnected
pub const VELOCITY: &str = "/operator/velocity"; // the parameter for the velocity knob, 0 to 1000
/// The parameter for the token. Its value shows only whether the token was accepted.
pub const TOKEN: &str = "/operator/token";
/// The parameter for this client's access to the run: [`ACCESS_WORDS`].
pub const ACCESS: &str = "/operator/access";
/// The values of [`ACCESS`]: no requests are accepted; requests require the token; the client has given the token.
pub const ACCESS_WORDS: [&str; 3] = ["none", "token", "granted"];
/// The parameter for the name under which the run knows the client as an operator.
pub const NAME: &str = "/viewer/name";
/// The parameter for the seconds of the past with which a subscription begins, 0 to [`PAST_S`].
pub const PAST: &str = "/viewer/past";
const FULL: u16 = 1000;
const QUOTED: usize = 60; // number of characters of a client's message that the answer quotes
const NO_REQUESTS: &str =
    "this run accepts no requests of viewers: it needs --clock real and an operator (docs/operator.md)";
const ONLY_VIEWER: &str =
    "the gateway has admitted this person as a viewer: rcs-gateway person sets the role";
const NO_TOKEN: &str = "the token that the run has printed was expected";

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Action {
    Text(String),
    Bytes(Vec<u8>),
    /// Send the messages of a channel, beginning with the newest one, or with the past.
    Subscribe {
        channel: u16,
        subscription: u32,
        past_s: u64,
    },
    /// Stop sending the messages of a channel.
    Unsubscribe {
        channel: u16,
    },
    /// Send a request to the run, and pass its answer to [`Session::answered`].
    Ask {
        line: String,
        reply: Reply,
    },
    Close(String), // disconnect the client, with this reason
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reply {
    Call { service: u32, call: u32 },
    Knob { velocity: u16, id: Option<String> },
}

#[derive(Clone, Debug, Default)]
pub enum Requests {
    #[default]
    Closed, // the run accepts none
    OnlyViewer,   // the gateway has admitted a person who may only watch
    Token(Token), // a request must contain the token
    Granted,      // the gateway has admitted a person who may operate
}

impl Requests {
    #[must_use]
    pub const fn are_offered(&self) -> bool {
        matches!(self, Self::Token(_) | Self::Granted)
    }

    /// Checks that the run accepts requests of a client with this token.
    fn check(&self, is_token: impl FnOnce(&Token) -> bool) -> Result<(), &'static str> {
        match self {
            Self::Closed => Err(NO_REQUESTS),
            Self::OnlyViewer => Err(ONLY_VIEWER),
            Self::Token(token) if !is_token(token) => Err(NO_TOKEN),
            Self::Token(_) | Self::Granted => Ok(()),
        }
    }
}

#[derive(Clone, Debug, Default)]
pub struct Rights {
    pub knob: Option<Knob>,
    pub requests: Requests,
    pub name: String, // the name under which the run knows the client as an operator
}

#[derive(Debug, Default)]
pub struct Session {
    rights: Rights,
    subscriptions: BTreeMap<u32, u16>, // channels by the client's subscription numbers
    has_token: bool,                   // the client has set the token as a parameter
    past_s: u64,                       // seconds of the past with which a subscription begins
    knob: Option<u16>, // the last sent knob position; `None` if the client has not subscribed to it
    mistakes: u32,
}

#[derive(Deserialize)]
struct Payload {
    #[serde(default)]
    token: String,
    #[serde(default)]
    line: String,
}

impl Session {
    #[must_use]
    pub fn new(rights: Rights) -> Self {
        Self { rights, ..Self::default() }
    }

    /// The first message to the client, which advertises services.
    #[must_use]
    pub fn services(&self) -> Option<String> {
        self.rights.requests.are_offered().then_some(())?;
        let services: Vec<Value> =
            (1..).zip(SERVICES).map(|(number, service)| service.advertised(number)).collect();
        Some(protocol::advertise_services(&services))
    }

    /// Handles a text message. `is_known` returns true if a channel with the given number exists.
    pub fn text(&mut self, text: &str, is_known: impl Fn(u16) -> bool) -> Vec<Action> {
        match serde_json::from_str(text) {
            Ok(Request::Subscribe { subscriptions }) => {
                subscriptions.into_iter().flat_map(|wanted| self.subscribe(wanted, &is_known)).collect()
            }
            Ok(Request::Unsubscribe { subscription_ids }) => {
                subscription_ids.into_iter().flat_map(|id| self.unsubscribe(id)).collect()
            }
            Ok(Request::GetParameters { parameter_names, id }) => {
                vec![Action::Text(self.parameters(&parameter_names, id.as_deref()))]
            }
            Ok(Request::SetParameters { parameters, id }) => self.set(&parameters, id.as_deref()),
            Ok(Request::SubscribeParameterUpdates { parameter_names }) => {
                if is_wanted(&parameter_names, VELOCITY) {
                    self.knob = self.rights.knob.as_ref().map(Knob::get);
                }
                Vec::new()
            }
            Ok(Request::UnsubscribeParameterUpdates { parameter_names }) => {
                self.knob = self.knob.filter(|_| !is_wanted(&parameter_names, VELOCITY));
                Vec::new()
            }
            Err(error) => self.wrong(&format!("{error}, in {}", quoted(text))),
        }
    }

    pub fn binary(&mut self, bytes: &[u8]) -> Vec<Action> {
        match (ServiceCall::read(bytes), bytes.first()) {
            (Some(call), _) => self.call(&call),
            (None, Some(code)) => {
                self.wrong(&format!("a call of a service was expected; found operation code {code}"))
            }
            (None, None) => self.wrong("a call of a service was expected; found no byte"),
        }
    }

    #[must_use]
    pub fn answered(&mut self, reply: Reply, verdict: Result<String, String>) -> Vec<Action> {
        match (reply, verdict) {
            (Reply::Call { service, call }, Ok(answer)) => {
                vec![Action::Bytes(protocol::service_response(service, call, &json!({ "answer": answer })))]
            }
            (Reply::Call { service, call }, Err(why)) => {
                vec![Action::Text(protocol::service_failure(service, call, &why))]
            }
            (Reply::Knob { velocity, id: Some(id) }, Ok(_)) => {
                let value = json!(velocity);
                let parameter = Parameter { name: VELOCITY.to_owned(), value };
                vec![Action::Text(protocol::parameter_values(&[parameter], Some(&id)))]
            }
            (Reply::Knob { id: None, .. }, Ok(_)) => Vec::new(),
            (Reply::Knob { velocity, .. }, Err(why)) => {
                let why = format!("the velocity knob was not turned to {velocity}: {why}");
                vec![Action::Text(protocol::status(StatusLevel::Error, &why, None))]
            }
        }
    }

    /// The message to send if the knob has moved since the last one.
    pub fn knob(&mut self) -> Option<String> {
        let (seen, now) = (self.knob?, self.rights.knob.as_ref()?.get());
        self.knob = Some(now);
        (seen != now).then(|| self.parameters(&[VELOCITY.to_owned()], None))
    }

    fn parameters(&self, names: &[String], id: Option<&str>) -> String {
        let knob = self.rights.knob.as_ref().map(|knob| (VELOCITY, json!(knob.get())));
        let accepted = if self.has_token { "accepted" } else { "" };
        let has_parameter = matches!(self.rights.requests, Requests::Token(_));
        let token = has_parameter.then(|| (TOKEN, json!(accepted)));
        let [none, needed, granted] = ACCESS_WORDS;
        let access = match self.rights.requests {
            Requests::Closed | Requests::OnlyViewer => none,
            Requests::Token(_) if !self.has_token => needed,
            Requests::Token(_) | Requests::Granted => granted,
        };
        let own = [(ACCESS, json!(access)), (NAME, json!(self.rights.name)), (PAST, json!(self.past_s))];
        let all = knob.into_iter().chain(token).chain(own).filter(|(name, _)| is_wanted(names, name));
        let parameters: Vec<Parameter> =
            all.map(|(name, value)| Parameter { name: name.to_owned(), value }).collect();
        protocol::parameter_values(&parameters, id)
    }

    fn set(&mut self, parameters: &[Parameter], id: Option<&str>) -> Vec<Action> {
        parameters.iter().flat_map(|parameter| self.set_one(parameter, id)).collect()
    }

    fn set_one(&mut self, Parameter { name, value }: &Parameter, id: Option<&str>) -> Vec<Action> {
        if name == PAST {
            let Some(past_s) = whole(value, PAST_S) else {
                return self.wrong(&format!("{PAST} is a whole number from 0 to {PAST_S}"));
            };
            self.past_s = past_s;
            return id
                .map(|id| Action::Text(self.parameters(&[PAST.to_owned()], Some(id))))
                .into_iter()
                .collect();
        }
        if let Err(why) = self.rights.requests.check(|_| true) {
            return self.wrong(why);
        }
        let is_given = |token: &Token| value.as_str().is_some_and(|given| token.is(given));
        match name.as_str() {
            TOKEN if self.rights.requests.check(is_given).is_ok() => {
                self.has_token = true;
                id.map(|id| Action::Text(self.parameters(&[TOKEN.to_owned()], Some(id))))
                    .into_iter()
                    .collect()
            }
            TOKEN => self.wrong(NO_TOKEN),
            VELOCITY if self.rights.requests.check(|_| self.has_token).is_err() => {
                self.wrong(&format!("{NO_TOKEN}: set it as the parameter {TOKEN} first"))
            }
            VELOCITY => match knob(value) {
                Some(velocity) => {
                    let reply = Reply::Knob { velocity, id: id.map(str::to_owned) };
                    vec![Action::Ask { line: format!("joystick velocity {velocity}"), reply }]
                }
                None => self.wrong(&format!("{VELOCITY} is a whole number from 0 to {FULL}")),
            },
            _ => self.wrong(&format!("{VELOCITY}, {TOKEN} or {PAST} was expected; found {}", quoted(name))),
        }
    }

    fn call(&mut self, asked: &ServiceCall) -> Vec<Action> {
        let (service, call) = (asked.service, asked.call);
        match self.line(asked) {
            Ok(line) => vec![Action::Ask { line, reply: Reply::Call { service, call } }],
            Err(why) => {
                let answer = Action::Text(protocol::service_failure(service, call, &why));
                [answer].into_iter().chain(self.counted(&why)).collect()
            }
        }
    }

    /// The line for the run that corresponds to a call, or the reason why the call is refused.
    fn line(&self, asked: &ServiceCall) -> Result<String, String> {
        self.rights.requests.check(|_| true)?;
        let wanted =
            Service::of(asked.service).ok_or_else(|| format!("there is no service {}", asked.service))?;
        if asked.encoding != "json" {
            return Err("a request in JSON was expected".to_owned());
        }
        let payload = serde_json::from_slice(&asked.payload);
        let Payload { token: given, line } =
            payload.map_err(|_| "an object with the field `token` was expected".to_owned())?;
        if self.rights.requests.check(|token| token.is(&given)).is_err() {
            return Err(format!("{NO_TOKEN} in the field `token`"));
        }
        Ok(wanted.line.map_or(line, str::to_owned))
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
            return self.wrong(&format!(
                "channel {channel} is subscribed already: a client subscribes to a channel once"
            ));
        }
        if self.subscriptions.len() >= SUBSCRIPTIONS {
            return self.wrong(&format!("a client has {SUBSCRIPTIONS} subscriptions at most"));
        }
        self.subscriptions.insert(id, channel);
        vec![Action::Subscribe { channel, subscription: id, past_s: self.past_s }]
    }

    fn unsubscribe(&mut self, id: u32) -> Vec<Action> {
        match self.subscriptions.remove(&id) {
            Some(channel) => vec![Action::Unsubscribe { channel }],
            None => self.wrong(&format!("there is no subscription {id}")),
        }
    }

    fn wrong(&mut self, why: &str) -> Vec<Action> {
        let status = Action::Text(protocol::status(StatusLevel::Error, why, None));
        self.counted(why).map_or_else(|| vec![status], |close| vec![close])
    }

    /// Counts an invalid message. Returns the action to disconnect after too many.
    fn counted(&mut self, why: &str) -> Option<Action> {
        self.mistakes = self.mistakes.saturating_add(1);
        let close = || Action::Close(format!("{MISTAKES} wrong messages, at last: {why}"));
        (self.mistakes >= MISTAKES).then(close)
    }
}

/// Returns true if a list of names contains `name`, or is empty.
fn is_wanted(names: &[String], name: &str) -> bool {
    names.is_empty() || names.iter().any(|wanted| wanted == name)
}

fn knob(value: &Value) -> Option<u16> {
    u16::try_from(whole(value, FULL.into())?).ok()
}

/// A whole number up to a limit; viewers may send it as a decimal number.
fn whole(value: &Value, limit: u64) -> Option<u64> {
    let number = value.as_f64()?;
    (0..=limit).find(|whole| *whole as f64 == number)
}

/// The first [`QUOTED`] characters of a client's message, without control characters.
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
    fn channel_is_subscribed_once_and_unsubscribed() {
        let mut session = Session::default();
        let subscribed = [Action::Subscribe { channel: 1, subscription: 7, past_s: 0 }];
        assert_eq!(subscribe(&mut session, 7, 1), subscribed);
        assert!(status_of(&subscribe(&mut session, 7, 2)).contains("subscription 7 is in use"));
        assert!(status_of(&subscribe(&mut session, 8, 1)).contains("channel 1 is subscribed already"));
        let end =
            |session: &mut Session| session.text(r#"{"op":"unsubscribe","subscriptionIds":[7]}"#, |_| true);
        assert_eq!(end(&mut session), [Action::Unsubscribe { channel: 1 }]);
        assert!(status_of(&end(&mut session)).contains("no subscription 7"));
        assert_eq!(subscribe(&mut session, 7, 1).len(), 1);
    }

    #[test]
    fn unknown_channels_are_refused() {
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
    fn too_many_invalid_messages_end_the_session() {
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
    }

    const SECRET: &str = "/operator/token";

    fn with(requests: Requests, knob: &Knob) -> Session {
        Session::new(Rights { knob: Some(knob.clone()), requests, name: String::new() })
    }

    fn permitted() -> (Session, String, Knob) {
        let (token, knob) = (Token::random().unwrap(), Knob::default());
        knob.set(1000);
        let word = token.reveal().to_owned();
        (with(Requests::Token(token), &knob), word, knob)
    }

    fn call(session: &mut Session, service: u32, payload: &Value) -> Vec<Action> {
        let head =
            [2_u32.to_le_bytes()[0]].into_iter().chain(service.to_le_bytes()).chain(5_u32.to_le_bytes());
        let bytes = head.chain(4_u32.to_le_bytes()).chain(*b"json").chain(payload.to_string().into_bytes());
        session.binary(&bytes.collect::<Vec<_>>())
    }

    fn failure_of(actions: &[Action]) -> String {
        let [Action::Text(text)] = actions else { panic!("a failure was expected, found {actions:?}") };
        let failure: Value = serde_json::from_str(text).unwrap();
        assert_eq!((&failure["op"], &failure["callId"]), (&json!("serviceCallFailure"), &json!(5)));
        failure["message"].as_str().unwrap().to_owned()
    }

    #[test]
    fn a_call_needs_the_token() {
        let (mut session, token, _) = permitted();
        assert!(session.services().unwrap().contains("/operator/pause"));
        for payload in [json!({}), json!({ "token": "" }), json!({ "token": "0".repeat(32) })] {
            assert!(failure_of(&call(&mut session, 4, &payload)).contains("in the field `token`"));
        }
        for payload in [json!([1]), json!(null), json!({ "token": 1 })] {
            assert!(failure_of(&call(&mut session, 4, &payload)).contains("an object"), "{payload}");
        }
        assert!(failure_of(&call(&mut session, 99, &json!({ "token": token }))).contains("no service 99"));
        let reply = Reply::Call { service: 4, call: 5 };
        let asked = call(&mut session, 4, &json!({ "token": token, "line": "estop" }));
        assert_eq!(asked, [Action::Ask { line: "PAUSE".into(), reply: reply.clone() }]);
        let asked = call(&mut session, 9, &json!({ "token": token, "line": "job go" }));
        assert!(matches!(&asked[..], [Action::Ask { line, .. }] if line == "job go"));
        assert!(failure_of(&session.answered(reply.clone(), Err("no".into()))).contains("no"));
        let answer = session.answered(reply, Ok("tick 7".into()));
        assert!(
            matches!(&answer[..], [Action::Bytes(bytes)] if bytes.ends_with(b"json{\"answer\":\"tick 7\"}"))
        );
    }

    #[test]
    fn run_without_operators_refuses_calls() {
        let mut session = Session::new(Rights { knob: Some(Knob::default()), ..Rights::default() });
        assert_eq!(session.services(), None);
        assert!(failure_of(&call(&mut session, 4, &json!({ "token": "" }))).contains("accepts no requests"));
        assert!(status_of(&set(&mut session, VELOCITY, json!(5))).contains("accepts no requests"));
    }

    #[test]
    fn person_operates_without_a_token_unless_it_is_a_viewer() {
        let knob = Knob::default();
        let mut operator = with(Requests::Granted, &knob);
        assert!(operator.services().is_some());
        assert_eq!(value_of(&mut operator, ACCESS), "granted");
        let asked = call(&mut operator, 4, &json!({}));
        assert!(matches!(&asked[..], [Action::Ask { line, .. }] if line == "PAUSE"), "{asked:?}");
        let turned = set(&mut operator, VELOCITY, json!(5));
        assert!(matches!(&turned[..], [Action::Ask { .. }]), "{turned:?}");
        let mut viewer = with(Requests::OnlyViewer, &knob);
        assert_eq!(viewer.services(), None);
        assert_eq!(value_of(&mut viewer, ACCESS), "none");
        assert!(failure_of(&call(&mut viewer, 4, &json!({}))).contains("as a viewer"));
        assert!(status_of(&set(&mut viewer, VELOCITY, json!(5))).contains("as a viewer"));
        assert!(status_of(&set(&mut viewer, SECRET, json!("0"))).contains("as a viewer"));
    }

    fn set(session: &mut Session, name: &str, value: Value) -> Vec<Action> {
        let text =
            json!({ "op": "setParameters", "parameters": [{ "name": name, "value": value }], "id": "a" });
        session.text(&text.to_string(), |_| true)
    }

    #[test]
    fn client_with_the_token_sets_the_knob() {
        let (mut session, token, knob) = permitted();
        assert!(status_of(&set(&mut session, VELOCITY, json!(5))).contains("set it as the parameter"));
        assert!(status_of(&set(&mut session, SECRET, json!("wrong"))).contains("the token"));
        assert!(status_of(&set(&mut session, "/x", json!(1))).contains("found /x"));
        let [Action::Text(accepted)] = &set(&mut session, SECRET, json!(token))[..] else { panic!() };
        assert!(accepted.contains("\"accepted\"") && !accepted.contains(&token), "{accepted}");
        let asked = set(&mut session, VELOCITY, json!(500.0));
        let reply = Reply::Knob { velocity: 500, id: Some("a".into()) };
        assert_eq!(asked, [Action::Ask { line: "joystick velocity 500".into(), reply: reply.clone() }]);
        for wrong in [json!(1001), json!(-1), json!(0.5), json!("500"), json!(null)] {
            assert!(status_of(&set(&mut session, VELOCITY, wrong)).contains("from 0 to 1000"));
        }
        let [Action::Text(set)] = &session.answered(reply, Ok(String::new()))[..] else { panic!() };
        assert!(set.contains("500") && set.contains("\"id\":\"a\""), "{set}");
        assert_eq!(session.knob(), None);
        session.text(r#"{"op":"subscribeParameterUpdates","parameterNames":[]}"#, |_| true);
        assert_eq!(session.knob(), None);
        knob.set(500);
        assert!(session.knob().unwrap().contains("500"));
        assert_eq!(session.knob(), None);
        let text = json!({ "op": "getParameters", "parameterNames": [], "id": "b" }).to_string();
        let [Action::Text(values)] = &session.text(&text, |_| true)[..] else { panic!() };
        let values: Value = serde_json::from_str(values).unwrap();
        assert_eq!(values["parameters"][0], json!({ "name": VELOCITY, "value": 500 }));
        session.text(r#"{"op":"unsubscribeParameterUpdates","parameterNames":[]}"#, |_| true);
        knob.set(7);
        assert_eq!(session.knob(), None);
    }

    fn value_of(session: &mut Session, name: &str) -> Value {
        let text = json!({ "op": "getParameters", "parameterNames": [name], "id": "b" }).to_string();
        let [Action::Text(values)] = &session.text(&text, |_| true)[..] else { panic!() };
        serde_json::from_str::<Value>(values).unwrap()["parameters"][0]["value"].clone()
    }

    #[test]
    fn access_parameter_reports_the_permission() {
        let mut watching = Session::new(Rights { name: "viewer-2".into(), ..Rights::default() });
        assert_eq!(value_of(&mut watching, ACCESS), "none");
        assert_eq!(value_of(&mut watching, NAME), "viewer-2");
        let (mut session, token, _) = permitted();
        assert_eq!(value_of(&mut session, ACCESS), "token");
        set(&mut session, SECRET, json!(token));
        assert_eq!(value_of(&mut session, ACCESS), "granted");
    }

    #[test]
    fn client_without_a_token_can_read_the_past() {
        let mut session = Session::default();
        assert_eq!(value_of(&mut session, PAST), 0);
        for wrong in [json!(61), json!(-1), json!(0.5), json!("60"), json!(null)] {
            assert!(status_of(&set(&mut session, PAST, wrong)).contains("from 0 to 60"));
        }
        let [Action::Text(set)] = &set(&mut session, PAST, json!(60.0))[..] else { panic!() };
        assert!(set.contains("60"), "{set}");
        let subscribed = [Action::Subscribe { channel: 1, subscription: 7, past_s: 60 }];
        assert_eq!(subscribe(&mut session, 7, 1), subscribed);
    }

    proptest::proptest! {
        #[test]
        fn no_message_panics(text: String, bytes: Vec<u8>, known: bool) {
            let mut session = Session::default();
            session.text(&text, |_| known);
            session.binary(&bytes);
            let (mut session, _, _) = permitted();
            let call: Vec<u8> = [2].into_iter().chain(bytes).collect();
            session.binary(&call);
        }
    }
}
