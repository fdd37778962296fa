//! The answer to a request for a claim, as text. It is `real` or `fast`, the clock of the run. As an error it is
//! `refused TEXT` with the run's reason, or `absent TEXT` without a run: a later request may succeed.

use std::fmt;

use neighbours::line::ClockKind;

use crate::sample::plain;

const REFUSED: &str = "refused ";
const ABSENT: &str = "absent ";

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Refusal {
    Refused(String),
    Absent(String), // there is no run, or no gateway
}

impl Refusal {
    #[must_use]
    pub const fn clock_word(clock: ClockKind) -> &'static str {
        match clock {
            ClockKind::Real => "real",
            ClockKind::Fast => "fast",
        }
    }

    /// The clock in an answer. Fails if it is not a clock.
    pub fn clock(answer: &[u8]) -> Result<ClockKind, Self> {
        match answer {
            b"real" => Ok(ClockKind::Real),
            b"fast" => Ok(ClockKind::Fast),
            other => Err(Self::Refused(format!(
                "expected real or fast from the gateway, found {:?}",
                plain(other)
            ))),
        }
    }

    #[must_use]
    pub fn encode(&self) -> String {
        match self {
            Self::Refused(text) => format!("{REFUSED}{text}"),
            Self::Absent(text) => format!("{ABSENT}{text}"),
        }
    }

    /// The refusal in an answer; `None` if the answer is not a gateway's, such as Zenoh's report of a timeout.
    #[must_use]
    pub fn decode(bytes: &[u8]) -> Option<Self> {
        let text = plain(bytes);
        let absent = text.strip_prefix(ABSENT).map(|text| Self::Absent(text.to_owned()));
        absent.or_else(|| text.strip_prefix(REFUSED).map(|text| Self::Refused(text.to_owned())))
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Refused(text) | Self::Absent(text) => f.write_str(text),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_decode_as_encoded() {
        for refusal in [Refusal::Refused("no".into()), Refusal::Absent("no run".into())] {
            assert_eq!(Refusal::decode(refusal.encode().as_bytes()), Some(refusal));
        }
        assert_eq!(Refusal::decode(b"refused a\x1b[2J"), Some(Refusal::Refused("a?[2J".into())));
        assert_eq!(Refusal::decode(b"Timeout"), None);
        assert_eq!(Refusal::clock(b"fast"), Ok(ClockKind::Fast));
        assert!(Refusal::clock(b"slow").is_err());
    }
}
