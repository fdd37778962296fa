//! Names of runs.

use std::{fmt, str::FromStr};

/// Greatest length of a run's name, characters. The path of an event's socket contains it, and Linux limits such a path
/// to 107 bytes.
pub const RUN_NAME_MAX: usize = 28;

/// A text that is not a valid name of a run.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "a run's name has 1 to {RUN_NAME_MAX} letters, digits, dots, hyphens or underscores, {0:?} is not one"
)]
pub struct NameError(pub String);

/// Name of a run: letters, digits, dots, hyphens and underscores.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct RunName(String);

impl RunName {
    /// A name that no other living run of this machine has: the job and this process id. Characters of the job that are
    /// not valid in a name become hyphens.
    #[must_use]
    pub fn unique(job: &str) -> Self {
        let suffix = format!("-{}", std::process::id());
        let room = RUN_NAME_MAX - suffix.len();
        let job: String =
            job.chars().take(room).map(|c| if is_name_character(c) { c } else { '-' }).collect();
        Self(job + &suffix)
    }

    /// The name as text.
    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

fn is_name_character(c: char) -> bool {
    c.is_ascii_alphanumeric() || "-_.".contains(c)
}

impl FromStr for RunName {
    type Err = NameError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let good = (1..=RUN_NAME_MAX).contains(&text.len())
            && text.chars().all(is_name_character)
            && text.starts_with(|c: char| c.is_ascii_alphanumeric());
        if good { Ok(Self(text.to_owned())) } else { Err(NameError(text.to_owned())) }
    }
}

impl fmt::Display for RunName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_checked() {
        assert!("linkbar-17".parse::<RunName>().is_ok());
        for bad in ["", "a/b", "..", "-x", "ab cd", &"x".repeat(RUN_NAME_MAX + 1)] {
            assert!(matches!(bad.parse::<RunName>(), Err(NameError(_))), "{bad:?}");
        }
        let long = RunName::unique(&"job with blanks ".repeat(5));
        assert!(long.as_str().len() <= RUN_NAME_MAX && long.as_str().parse::<RunName>().is_ok(), "{long}");
    }
}
