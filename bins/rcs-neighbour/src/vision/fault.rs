//! Faults that the vision system plays, at pictures that are told by their number: the same every time.

use std::{ops::RangeInclusive, str::FromStr};

use interfaces::device::{VisionResponse, VisionStatus};
use neighbours::vision::{Areas, Ready};

/// What goes wrong with a picture. `off` and `camera-blind` are words of fault files as well (data/README.md).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// It is not answered.
    Off,
    /// Nothing is seen.
    CameraBlind,
    /// What is seen is not recognised.
    NotRecognised,
    /// Another object is recognised than the one that was asked for.
    AnotherObject,
    /// The answer echoes another request.
    AnotherEcho,
    /// The answer stands where `vision-ready-input` says "not ready".
    InputNotReady,
    /// From this picture on `vision-ready-output` says "not ready".
    OutputNotReady,
    /// The answer has a status that there is not.
    Garbled,
    /// The answer ends too early.
    Truncated,
    /// The centroid is far outside of the picture.
    Outside,
    /// The angle is beyond a quarter turn.
    Turned,
    /// The connection is cut in the middle of the work, and made again.
    Gone,
}

impl Kind {
    /// All, with the words on the command line.
    pub const ALL: [(&'static str, Self); 12] = [
        ("off", Self::Off),
        ("camera-blind", Self::CameraBlind),
        ("not-recognised", Self::NotRecognised),
        ("another-object", Self::AnotherObject),
        ("another-echo", Self::AnotherEcho),
        ("input-not-ready", Self::InputNotReady),
        ("output-not-ready", Self::OutputNotReady),
        ("garbled", Self::Garbled),
        ("truncated", Self::Truncated),
        ("outside", Self::Outside),
        ("turned", Self::Turned),
        ("gone", Self::Gone),
    ];

    /// What becomes of an answer; the bytes of the mailbox, `None` if nothing is written.
    pub fn spoil(self, areas: Areas) -> Option<Areas> {
        let response = areas.response;
        let done = response.status == VisionStatus::Done;
        let with = |response: VisionResponse| Some(Areas { response, ..areas });
        match self {
            Self::Off => None,
            Self::NotRecognised if done => {
                with(VisionResponse { status: VisionStatus::NotRecognised, recognised: None, ..response })
            }
            Self::AnotherObject if done => {
                with(VisionResponse { recognised: response.recognised.map(|id| id + 1), ..response })
            }
            Self::AnotherEcho => with(VisionResponse { echo: response.echo + 1, ..response }),
            Self::InputNotReady => Some(Areas { input: Ready::NotReady, ..areas }),
            Self::OutputNotReady => Some(Areas { output: Ready::NotReady, ..areas }),
            Self::Outside if done => with(VisionResponse { y: 30_000, ..response }),
            Self::Turned if done => with(VisionResponse { angle: 27_000, ..response }),
            _ => Some(areas),
        }
    }

    /// What becomes of the bytes of an answer.
    pub fn garble(self, bytes: &mut Vec<u8>) {
        match self {
            // The low byte of the status.
            Self::Garbled => bytes[8] = 99,
            Self::Truncated => bytes.truncate(14),
            _ => {}
        }
    }
}

/// A fault, and the pictures that have it: `N:KIND` or `N-M:KIND`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Numbers of the pictures that this process is asked for, from 1.
    pub pictures: RangeInclusive<u32>,
    /// What goes wrong.
    pub kind: Kind,
}

/// A text that is no fault.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FaultError {
    /// No pictures.
    #[error("N:KIND or N-M:KIND was expected, with pictures counted from 1, found {0}")]
    Pictures(String),
    /// No kind of fault.
    #[error("{} was expected, found {found}", Kind::ALL.map(|(word, _)| word).join(" or "))]
    Kind {
        /// The text.
        found: String,
    },
}

impl FromStr for Fault {
    type Err = FaultError;

    fn from_str(text: &str) -> Result<Self, FaultError> {
        let wrong = || FaultError::Pictures(text.to_owned());
        let (pictures, word) = text.split_once(':').ok_or_else(wrong)?;
        let (first, last) = pictures.split_once('-').unwrap_or((pictures, pictures));
        let number = |text: &str| text.parse::<u32>().map_err(|_| wrong());
        let (first, last) = (number(first)?, number(last)?);
        if first == 0 || last < first {
            return Err(wrong());
        }
        let kind = Kind::ALL.into_iter().find(|(known, _)| *known == word);
        let (_, kind) = kind.ok_or_else(|| FaultError::Kind { found: word.to_owned() })?;
        Ok(Self { pictures: first..=last, kind })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_are_pictures_and_a_kind() {
        assert_eq!("3:off".parse(), Ok(Fault { pictures: 3..=3, kind: Kind::Off }));
        assert_eq!("2-4:gone".parse(), Ok(Fault { pictures: 2..=4, kind: Kind::Gone }));
        for wrong in ["", "off", ":off", "0:off", "4-2:off", "-1:off", "1-:off", "x:off"] {
            assert_eq!(wrong.parse::<Fault>(), Err(FaultError::Pictures(wrong.to_owned())), "{wrong}");
        }
        let unknown = "1:tired".parse::<Fault>().unwrap_err().to_string();
        assert!(
            unknown.starts_with("off or camera-blind or ") && unknown.ends_with("found tired"),
            "{unknown}"
        );
    }

    #[test]
    fn each_kind_spoils_what_it_says_and_nothing_else() {
        let response = VisionResponse {
            echo: 4,
            status: VisionStatus::Done,
            y: 10,
            z: -5,
            angle: 300,
            recognised: Some(17),
        };
        let areas = Areas { input: Ready::Ready, output: Ready::Ready, response };
        for (word, kind) in Kind::ALL {
            let spoiled = kind.spoil(areas);
            let mut bytes = spoiled.unwrap_or(areas).encode().unwrap().to_vec();
            kind.garble(&mut bytes);
            let same = spoiled == Some(areas) && bytes == areas.encode().unwrap();
            // The two that are made elsewhere: no light, no line.
            assert_eq!(same, matches!(kind, Kind::CameraBlind | Kind::Gone), "{word}");
        }
    }
}
