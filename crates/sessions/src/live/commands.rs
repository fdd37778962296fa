//! Requests of a viewer to a run: requests of an operator as services, and the velocity knob as a parameter.
//!
//! A request is a line for the run's operator socket ([`crate::operator`]), and is checked like those of a console. It
//! requires the token that the run has printed.

use std::{
    path::PathBuf,
    sync::{
        Arc,
        atomic::{AtomicU16, Ordering},
    },
};

use serde_json::{Value, json};

/// The velocity knob in the controller's units, 0 to 1000.
#[derive(Clone, Debug, Default)]
pub struct Knob(Arc<AtomicU16>);

impl Knob {
    /// Set the position of the knob, without waiting.
    pub fn set(&self, velocity: u16) {
        self.0.store(velocity, Ordering::Relaxed);
    }

    #[must_use]
    pub fn get(&self) -> u16 {
        self.0.load(Ordering::Relaxed)
    }
}

#[derive(Clone, Debug)]
pub struct Access {
    pub socket: PathBuf,
    pub token: Token,
}

/// A secret of the run. Its `Debug` text does not show it.
#[derive(Clone)]
pub struct Token(String);

impl Token {
    /// A new token of 128 random bits.
    pub fn random() -> Result<Self, crate::live::NoRandom> {
        crate::live::protocol::random_word().map(Self)
    }

    /// The token as text, to show to the operator.
    #[must_use]
    pub fn reveal(&self) -> &str {
        &self.0
    }

    /// Returns true for the right token. The comparison takes the same time for every token of this length.
    #[must_use]
    pub fn is(&self, given: &str) -> bool {
        let differences = self.0.bytes().zip(given.bytes()).map(|(own, given)| own ^ given);
        self.0.len() == given.len() && differences.fold(0, |all, difference| all | difference) == 0
    }
}

impl std::fmt::Debug for Token {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Token(..)")
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Service {
    pub name: &'static str,
    /// The line for the run; `None` if the viewer supplies it.
    pub line: Option<&'static str>,
}

/// The services. A service's number is its position in the list, from 1.
pub const SERVICES: [Service; 9] = [
    Service { name: "/operator/status", line: Some("status") },
    Service { name: "/operator/stop", line: Some("stop") },
    Service { name: "/operator/go", line: Some("go") },
    Service { name: "/operator/pause", line: Some("PAUSE") },
    Service { name: "/operator/job_wait", line: Some("job wait") },
    Service { name: "/operator/job_go", line: Some("job go") },
    Service { name: "/operator/job_skip", line: Some("job skip") },
    Service { name: "/operator/leave", line: Some("leave") },
    Service { name: "/operator/request", line: None },
];

impl Service {
    #[must_use]
    pub fn of(number: u32) -> Option<Self> {
        let place = usize::try_from(number).ok()?.checked_sub(1)?;
        SERVICES.get(place).copied()
    }

    /// The advertisement of the service, with JSON schemas of request and response.
    #[must_use]
    pub fn advertised(self, number: u32) -> Value {
        let text = |what: &str| json!({ "type": "string", "description": what });
        let token = text("the token that the run has printed");
        let line = || text("a request of an operator, such as PAUSE or job go");
        let (properties, required) = match self.line {
            Some(_) => (json!({ "token": token }), json!(["token"])),
            None => (json!({ "token": token, "line": line() }), json!(["token", "line"])),
        };
        let request = json!({ "type": "object", "properties": properties, "required": required });
        let answer = json!({ "answer": text("the tick in which it was carried out, and a text") });
        let response = json!({ "type": "object", "properties": answer, "required": ["answer"] });
        let schema = |name: &str, schema: &Value| {
            json!({
                "encoding": "json",
                "schemaName": name,
                "schemaEncoding": "jsonschema",
                "schema": schema.to_string(),
            })
        };
        let kind = if self.line.is_none() { "rcs.OperatorRequest" } else { "rcs.OperatorWord" };
        json!({
            "id": number,
            "name": self.name,
            "type": kind,
            "request": schema(&format!("{kind}_Request"), &request),
            "response": schema(&format!("{kind}_Response"), &response),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn token_is_compared_and_not_printed() {
        let token = Token::random().unwrap();
        let text = token.reveal().to_owned();
        assert_eq!(text.len(), 32);
        assert!(token.is(&text));
        for wrong in [
            "",
            &text[1..],
            &format!("{text}0"),
            &text.to_uppercase().replace(|c: char| c.is_ascii_digit(), "x"),
        ] {
            assert!(!token.is(wrong), "{wrong}");
        }
        assert!(!Token::random().unwrap().is(&text));
        assert!(!format!("{token:?}").contains(&text));
    }

    #[test]
    fn services_have_numbers_names_and_schemas_in_json() {
        assert_eq!(Service::of(0), None);
        assert_eq!(Service::of(10), None);
        for (number, service) in (1..).zip(SERVICES) {
            assert_eq!(Service::of(number), Some(service));
            let advertised = service.advertised(number);
            assert_eq!((&advertised["id"], &advertised["name"]), (&json!(number), &json!(service.name)));
            for part in ["request", "response"] {
                let schema: Value =
                    serde_json::from_str(advertised[part]["schema"].as_str().unwrap()).unwrap();
                assert_eq!(
                    (&schema["type"], &advertised[part]["encoding"]),
                    (&json!("object"), &json!("json"))
                );
            }
        }
    }
}
