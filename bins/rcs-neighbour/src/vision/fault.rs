//! Faults that the vision system simulates, selected by picture number and therefore repeatable.

use std::{ops::RangeInclusive, str::FromStr};

use interfaces::device::{VisionResponse, VisionStatus};
use neighbours::vision::{Areas, Ready};

/// A fault of one picture. `off` and `camera-blind` are also words of fault files (data/README.md).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Off,
    CameraBlind,
    /// The camera sees an object, and recognition fails.
    NotRecognised,
    /// Vision recognises another object than the requested one.
    AnotherObject,
    AnotherEcho,
    /// The answer comes while `vision-ready-input` is "not ready".
    InputNotReady,
    /// From this picture on, `vision-ready-output` is "not ready".
    OutputNotReady,
    /// The answer has an undefined status value.
    Garbled,
    Truncated,
    /// The centroid is far outside the picture.
    Outside,
    /// The angle is 270 degrees, beyond a quarter turn.
    Turned,
    /// The connection is closed before the answer, and opened again.
    Gone,
}

impl Kind {
    /// All kinds with their words on the command line.
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

    /// Applies the fault to an answer: the areas to write into the mailbox, or `None` to write nothing.
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

    /// Applies the fault to the bytes of an answer.
    pub fn garble(self, bytes: &mut Vec<u8>) {
        match self {
            // Low byte of the status.
            Self::Garbled => bytes[8] = 99,
            Self::Truncated => bytes.truncate(14),
            _ => {}
        }
    }
}

/// A fault, and the pictures that have it: `N:KIND` or `N-M:KIND`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fault {
    /// Numbers of the affected pictures, counted from 1 over all runs.
    pub pictures: RangeInclusive<u32>,
    pub kind: Kind,
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FaultError {
    /// The numbers of the pictures are missing or wrong.
    #[error("N:KIND or N-M:KIND was expected, with pictures counted from 1, found {0}")]
    Pictures(String),
    /// The kind of the fault is unknown.
    #[error("{} was expected, found {found}", Kind::ALL.map(|(word, _)| word).join(" or "))]
    Kind { found: String },
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
    fn each_kind_of_fault_has_only_its_own_effect() {
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
            // The faults that are made elsewhere: camera blind, connection closed.
            assert_eq!(same, matches!(kind, Kind::CameraBlind | Kind::Gone), "{word}");
        }
    }
}
