use super::NotSensed;

#[derive(Clone, Debug, PartialEq)]
pub struct Contradiction {
    /// The actual state, as a sentence without a full stop.
    pub text: String,
    /// The reason why no sensor could show it; `None` if the confirmation is false.
    pub not_sensed: Option<NotSensed>,
}

impl Contradiction {
    /// A contradiction that a sensor could have shown.
    pub const fn sensed(text: String) -> Self {
        Self { text, not_sensed: None }
    }
}

pub fn expect(condition: bool, text: impl FnOnce() -> String) -> Result<(), Contradiction> {
    if condition { Ok(()) } else { Err(Contradiction::sensed(text())) }
}
