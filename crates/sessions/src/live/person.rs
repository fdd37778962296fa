//! A person on the network. `rcs-gateway page` has checked the person's secret, and connects over a Unix socket of this
//! user with two headers: `Rcs-Person` is the name, `Rcs-Role` is `viewer` or `operator`.

use std::str::FromStr;

use tungstenite::http::{HeaderMap, StatusCode};

use crate::{live::http::Refusal, operator::Name};

pub const NAME: &str = "rcs-person"; // header with the name of the person
pub const ROLE: &str = "rcs-role"; // header with the role of the person

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    Viewer,
    Operator, // watch the run, and send requests if the run accepts them
}

impl FromStr for Role {
    type Err = ();

    fn from_str(text: &str) -> Result<Self, ()> {
        match text {
            "viewer" => Ok(Self::Viewer),
            "operator" => Ok(Self::Operator),
            _ => Err(()),
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Person {
    pub name: Name,
    pub role: Role,
}

impl Person {
    /// Fails if a header is missing, repeated or invalid. A connection without a role gets no rights.
    pub fn of(headers: &HeaderMap) -> Result<Self, Refusal> {
        let person = header(headers, NAME).zip(header(headers, ROLE));
        let person = person.map(|(name, role)| Self { name, role });
        person.ok_or_else(|| {
            let why = "a gateway was expected: headers Rcs-Person: NAME and Rcs-Role: viewer or operator\n";
            (StatusCode::BAD_REQUEST, why.to_owned())
        })
    }
}

fn header<T: FromStr>(headers: &HeaderMap, name: &str) -> Option<T> {
    let mut found = headers.get_all(name).iter();
    let value = found.next()?.to_str().ok()?;
    found.next().is_none().then(|| value.parse().ok()).flatten()
}

#[cfg(test)]
mod tests {
    use tungstenite::http::{HeaderName, HeaderValue};

    use super::*;

    fn person(pairs: &[(&'static str, &'static str)]) -> Option<Person> {
        let mut headers = HeaderMap::new();
        for (name, value) in pairs {
            headers.append(HeaderName::from_static(name), HeaderValue::from_static(value));
        }
        Person::of(&headers).ok()
    }

    #[test]
    fn person_needs_one_name_and_one_role() {
        for (word, role) in [("viewer", Role::Viewer), ("operator", Role::Operator)] {
            let expected = Person { name: "anna".parse().unwrap(), role };
            assert_eq!(person(&[(NAME, "anna"), (ROLE, word)]), Some(expected));
        }
        for wrong in [
            &[(NAME, "anna")][..],
            &[(ROLE, "viewer")],
            &[(NAME, "anna"), (ROLE, "Operator")],
            &[(NAME, "a b"), (ROLE, "viewer")],
            &[(NAME, "anna"), (ROLE, "viewer"), (ROLE, "operator")],
            &[(NAME, "anna"), (NAME, "berta"), (ROLE, "operator")],
        ] {
            assert_eq!(person(wrong), None, "{wrong:?}");
        }
    }
}
