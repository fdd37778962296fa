//! Properties of the machine that affect real time: kernel, preemption, clock frequency governor.

use std::{fmt, fs};

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Machine {
    /// Release of the kernel, or the reason why it is unknown.
    pub kernel: String,
    pub preempt_rt: bool, // full preemption
    /// Frequency governors of the cores, without duplicates; empty if the machine has none.
    pub governors: Vec<String>,
}

impl Machine {
    /// Examine this machine. Properties that cannot be read are left out.
    #[must_use]
    pub fn look() -> Self {
        let read = |path: &str| fs::read_to_string(path).map(|text| text.trim().to_owned()).ok();
        let cores = fs::read_dir("/sys/devices/system/cpu").into_iter().flatten().flatten();
        let mut governors: Vec<String> = cores
            .filter_map(|core| fs::read_to_string(core.path().join("cpufreq/scaling_governor")).ok())
            .map(|governor| governor.trim().to_owned())
            .collect();
        governors.sort_unstable();
        governors.dedup();
        Self {
            kernel: read("/proc/sys/kernel/osrelease").unwrap_or_else(|| "unknown".to_owned()),
            preempt_rt: read("/sys/kernel/realtime").as_deref() == Some("1"),
            governors,
        }
    }
}

impl fmt::Display for Machine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let preemption = if self.preempt_rt { "PREEMPT_RT" } else { "not PREEMPT_RT" };
        write!(f, "kernel {} ({preemption}), ", self.kernel)?;
        if self.governors.is_empty() {
            f.write_str("no frequency governor")
        } else {
            write!(f, "frequency governor {}", self.governors.join(", "))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_machine_is_described_in_one_line() {
        let mut machine =
            Machine { kernel: "6.1.0-rt".into(), preempt_rt: true, governors: vec!["performance".into()] };
        assert_eq!(machine.to_string(), "kernel 6.1.0-rt (PREEMPT_RT), frequency governor performance");
        machine.governors.clear();
        machine.preempt_rt = false;
        assert_eq!(machine.to_string(), "kernel 6.1.0-rt (not PREEMPT_RT), no frequency governor");
    }

    #[test]
    fn this_machine_has_a_kernel() {
        assert_ne!(Machine::look().kernel, "unknown");
    }
}
