//! Names of runs.

use std::{fmt, fs, str::FromStr};

/// Characters. The path of an event's socket contains the name, and Linux limits such a path to 107 bytes.
pub const RUN_NAME_MAX: usize = 28;

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "a run's name has 1 to {RUN_NAME_MAX} letters, digits, dots, hyphens or underscores, {0:?} is not one"
)]
pub struct NameError(pub String);

/// Name of a run: letters, digits, dots, hyphens and underscores.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct RunName(String);

impl RunName {
    /// The job, this process id, and in a container the number of its PID namespace. Invalid characters become hyphens.
    #[must_use]
    pub fn unique(job: &str) -> Self {
        let namespace = namespace().map_or_else(String::new, |number| format!(".{number}"));
        let job: String = job.chars().map(|c| if is_name_character(c) { c } else { '-' }).collect();
        Self::with_end(&job, &format!("-{}{namespace}", std::process::id()))
    }

    /// This name with a number, for another run of the same process.
    #[must_use]
    pub fn numbered(&self, number: u32) -> Self {
        let (job, end) = self.0.rsplit_once('-').unwrap_or((&self.0, ""));
        Self::with_end(job, &format!("-{end}.{number}"))
    }

    fn with_end(job: &str, end: &str) -> Self {
        let room = RUN_NAME_MAX.saturating_sub(end.len());
        Self(job.chars().take(room).collect::<String>() + end)
    }

    #[must_use]
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

/// Inode of the machine's PID namespace, `PROC_PID_INIT_INO` of Linux. Other namespaces have greater numbers.
const OF_MACHINE: u32 = 0xEFFF_FFFC;

/// Number of the PID namespace of this process; `None` for that of the machine, or without `/proc`.
fn namespace() -> Option<u32> {
    let link = fs::read_link("/proc/self/ns/pid").ok()?;
    let number: u32 = link.to_str()?.strip_prefix("pid:[")?.strip_suffix(']')?.parse().ok()?;
    Some(number.wrapping_sub(OF_MACHINE)).filter(|number| *number != 0)
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
        let other = long.numbered(99);
        assert!(other != long && other.as_str().parse::<RunName>().is_ok(), "{other}");
        assert_eq!(
            other.as_str().rsplit_once('-').unwrap().1,
            format!("{}.99", long.as_str().rsplit_once('-').unwrap().1)
        );
    }
}
