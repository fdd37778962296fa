//! Messages of `foxglove.websocket.v1` and `foxglove.sdk.v1`, which are the same for the parts used here.
//!
//! Text is JSON with a field `op`; binary messages begin with an operation code, little-endian. Source: Foxglove
//! WebSocket protocol v1, `docs/spec.md` of github.com/foxglove/ws-protocol.

use std::collections::BTreeMap;

use data_encoding::{BASE64, HEXLOWER};
use record::tap::Channel;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

pub const SUBPROTOCOLS: [&str; 2] = ["foxglove.sdk.v1", "foxglove.websocket.v1"]; // the preferred one first
/// Binary schema encodings, which JSON contains as base64.
const BINARY_SCHEMAS: [&str; 2] = ["protobuf", "flatbuffer"];

mod to_client {
    pub const MESSAGE: u8 = 0x01;
    pub const TIME: u8 = 0x02;
    pub const SERVICE_RESPONSE: u8 = 0x03;
}

mod from_client {
    pub const SERVICE_REQUEST: u8 = 0x02;
}

#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "op", rename_all = "camelCase")]
pub enum Request {
    Subscribe {
        subscriptions: Vec<Subscription>,
    },
    #[serde(rename_all = "camelCase")]
    Unsubscribe {
        subscription_ids: Vec<u32>, // the client's numbers of the subscriptions
    },
    #[serde(rename_all = "camelCase")]
    GetParameters {
        parameter_names: Vec<String>, // names of the parameters; an empty list means all
        id: Option<String>,
    },
    SetParameters {
        parameters: Vec<Parameter>, // the parameters with their new values
        id: Option<String>,
    },
    #[serde(rename_all = "camelCase")]
    SubscribeParameterUpdates {
        parameter_names: Vec<String>, // names of the parameters; an empty list means all
    },
    #[serde(rename_all = "camelCase")]
    UnsubscribeParameterUpdates {
        parameter_names: Vec<String>, // names of the parameters; an empty list means all
    },
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Parameter {
    pub name: String,
    #[serde(default)]
    pub value: Value, // null if the parameter has none
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ServiceCall {
    pub service: u32,
    pub call: u32, // the client's number
    pub encoding: String,
    pub payload: Vec<u8>,
}

impl ServiceCall {
    /// Decodes a binary message; `None` if it is not a service call.
    #[must_use]
    pub fn read(bytes: &[u8]) -> Option<Self> {
        let (code, mut rest) = bytes.split_first()?;
        let mut number = || {
            let (number, left) = rest.split_first_chunk::<4>()?;
            rest = left;
            Some(u32::from_le_bytes(*number))
        };
        let (service, call, length) = (number()?, number()?, number()?);
        let (encoding, payload) = rest.split_at_checked(usize::try_from(length).ok()?)?;
        let encoding = String::from_utf8_lossy(encoding).into_owned();
        (*code == from_client::SERVICE_REQUEST).then(|| Self {
            service,
            call,
            encoding,
            payload: payload.to_vec(),
        })
    }
}

/// The binary message that answers a service call.
#[must_use]
pub fn service_response(service: u32, call: u32, payload: &Value) -> Vec<u8> {
    const ENCODING: &[u8; 4] = b"json";
    let mut bytes = vec![to_client::SERVICE_RESPONSE];
    bytes.extend(service.to_le_bytes());
    bytes.extend(call.to_le_bytes());
    bytes.extend(4_u32.to_le_bytes());
    bytes.extend(ENCODING);
    bytes.extend(payload.to_string().into_bytes());
    bytes
}

#[must_use]
pub fn service_failure(service: u32, call: u32, why: &str) -> String {
    json!({ "op": "serviceCallFailure", "serviceId": service, "callId": call, "message": why }).to_string()
}

#[must_use]
pub fn advertise_services(services: &[Value]) -> String {
    json!({ "op": "advertiseServices", "services": services }).to_string()
}

#[must_use]
pub fn parameter_values(parameters: &[Parameter], id: Option<&str>) -> String {
    match id {
        Some(id) => json!({ "op": "parameterValues", "parameters": parameters, "id": id }),
        None => json!({ "op": "parameterValues", "parameters": parameters }),
    }
    .to_string()
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Subscription {
    pub id: u32, // the client's number
    pub channel_id: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StatusLevel {
    Warning,
    Error,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the system gives no random numbers: {0}")]
pub struct NoRandom(#[from] getrandom::Error);

/// A word of 128 random bits, in hexadecimal.
pub fn random_word() -> Result<String, NoRandom> {
    let mut bits = [0; 16];
    getrandom::fill(&mut bits)?;
    Ok(HEXLOWER.encode(&bits))
}

/// Facts about the server, for the first message to a client.
#[derive(Clone, Debug, Default, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct ServerInfo {
    pub name: String, // shown by the viewer
    pub capabilities: Vec<&'static str>,
    pub supported_encodings: Vec<&'static str>,
    pub metadata: BTreeMap<String, String>,
    pub session_id: String, // different for each run
}

impl ServerInfo {
    /// Facts with a new session identifier. Fails with [`NoRandom`] if the operating system supplies no random numbers.
    pub fn new() -> Result<Self, NoRandom> {
        Ok(Self { session_id: random_word()?, ..Self::default() })
    }

    #[must_use]
    pub fn encode(&self) -> String {
        let mut message = json!(self);
        if let Some(fields) = message.as_object_mut() {
            fields.insert("op".to_owned(), json!("serverInfo"));
        }
        message.to_string()
    }
}

/// A channel as JSON, for [`advertise`].
#[must_use]
pub fn channel(id: u16, channel: &Channel<'_>) -> String {
    let schema = if BINARY_SCHEMAS.contains(&channel.schema_encoding) {
        BASE64.encode(channel.schema)
    } else {
        String::from_utf8_lossy(channel.schema).into_owned()
    };
    json!({
        "id": id,
        "topic": channel.topic,
        "encoding": channel.encoding,
        "schemaName": channel.schema_name,
        "schemaEncoding": channel.schema_encoding,
        "schema": schema,
    })
    .to_string()
}

#[must_use]
pub fn advertise<'a>(channels: impl Iterator<Item = &'a str>) -> String {
    let channels: Vec<&str> = channels.collect();
    format!(r#"{{"op":"advertise","channels":[{}]}}"#, channels.join(","))
}

/// A status message, which the viewer shows. A later status with the same `id` replaces it.
#[must_use]
pub fn status(level: StatusLevel, message: &str, id: Option<&str>) -> String {
    let level = match level {
        StatusLevel::Warning => 1,
        StatusLevel::Error => 2,
    };
    match id {
        Some(id) => json!({ "op": "status", "level": level, "message": message, "id": id }),
        None => json!({ "op": "status", "level": level, "message": message }),
    }
    .to_string()
}

/// The binary message with data of a subscribed channel; `time` is in ns.
#[must_use]
pub fn message(subscription: u32, time: u64, data: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(data.len().saturating_add(13));
    bytes.push(to_client::MESSAGE);
    bytes.extend(subscription.to_le_bytes());
    bytes.extend(time.to_le_bytes());
    bytes.extend(data);
    bytes
}

/// The binary message with the present time of the run, ns.
#[must_use]
pub fn time(time: u64) -> Vec<u8> {
    let mut bytes = vec![to_client::TIME];
    bytes.extend(time.to_le_bytes());
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;

    #[test]
    fn binary_messages_are_little_endian_after_their_code() {
        assert_eq!(message(0x0102, 3, &[9, 8]), [1, 2, 1, 0, 0, 3, 0, 0, 0, 0, 0, 0, 0, 9, 8]);
        assert_eq!(time(258), [2, 2, 1, 0, 0, 0, 0, 0, 0]);
    }

    #[test]
    fn service_call_is_parsed_and_answered() {
        let call = [&[2, 7, 0, 0, 0, 9, 1, 0, 0, 4, 0, 0, 0][..], b"json{}"].concat();
        let expected =
            ServiceCall { service: 7, call: 265, encoding: "json".into(), payload: b"{}".to_vec() };
        assert_eq!(ServiceCall::read(&call), Some(expected));
        for wrong in [&call[..12], &call[..16], &[], &[2], &[1; 20], &[2; 20]] {
            assert_eq!(ServiceCall::read(wrong), None, "{wrong:?}");
        }
        let answer = service_response(7, 265, &json!({}));
        assert_eq!(answer, [&[3, 7, 0, 0, 0, 9, 1, 0, 0, 4, 0, 0, 0][..], b"json{}"].concat());
    }

    #[test]
    fn binary_schemas_are_in_base64() {
        let of = |schema_encoding, schema| {
            let text = channel(
                7,
                &Channel { topic: "/tf", encoding: "e", schema_name: "s", schema_encoding, schema },
            );
            serde_json::from_str::<Value>(&text).unwrap()
        };
        assert_eq!(of("protobuf", &[0, 255])["schema"], "AP8=");
        assert_eq!(of("ros2msg", b"string data")["schema"], "string data");
        assert_eq!(of("ros2msg", b"")["id"], 7);
    }

    #[test]
    fn server_info_and_advertise_follow_the_protocol() {
        let info = ServerInfo { name: "linkbar".into(), capabilities: vec!["time"], ..Default::default() };
        let read: Value = serde_json::from_str(&info.encode()).unwrap();
        assert_eq!((&read["op"], &read["capabilities"][0]), (&"serverInfo".into(), &"time".into()));
        assert!(read["sessionId"].is_string() && read["supportedEncodings"].is_array());
        let read: Value = serde_json::from_str(&advertise(["{\"id\":1}", "{\"id\":2}"].into_iter())).unwrap();
        assert_eq!(read["channels"][1]["id"], 2);
    }

    #[test]
    fn requests_are_read() {
        let read = |text| serde_json::from_str::<Request>(text).unwrap();
        assert_eq!(
            read(r#"{"op":"subscribe","subscriptions":[{"id":0,"channelId":3}]}"#),
            Request::Subscribe { subscriptions: vec![Subscription { id: 0, channel_id: 3 }] }
        );
        assert_eq!(
            read(r#"{"op":"unsubscribe","subscriptionIds":[0,1]}"#),
            Request::Unsubscribe { subscription_ids: vec![0, 1] }
        );
    }
}
