use super::NotSensed;

#[derive(Clone, Debug, PartialEq)]
pub struct Untruth {
    /// The actual state, as a sentence without a full stop.
    pub text: String,
    /// The reason why no sensor could show it; `None` if the confirmation is false.
    pub not_sensed: Option<NotSensed>,
}

impl Untruth {
    /// An untruth that a sensor could have shown.
    pub const fn is_false(text: String) -> Self {
        Self { text, not_sensed: None }
    }
}

pub fn expect(condition: bool, text: impl FnOnce() -> String) -> Result<(), Untruth> {
    if condition { Ok(()) } else { Err(Untruth::is_false(text())) }
}
