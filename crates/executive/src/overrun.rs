//! The reaction to skipped slots of the 40 ms grid.
//!
//! A skipped slot is counted with its cause. The user chooses the further reaction ([`Policy`]). To hold, the velocity
//! knob is set to zero: Prim ramps down on its path (docs/design/motion.md "Knob"), and every grip stays. The knob is
//! logged like any other input, so a replay needs no clock.

use std::{fmt, str::FromStr, time::Duration};

use interfaces::CommonMemory;

use crate::{
    clock::SLOT,
    timing::{Stage, StageTimes},
};
use closed_loop::rest::{AT_LAST, RestWatch};

/// Number of consecutive ticks, one second, that must be on time before a holding robot continues.
pub const PUNCTUAL: u32 = 25;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Policy {
    #[default]
    Count,
    /// If at least this many are skipped in a row, the robot holds until [`PUNCTUAL`] ticks were on time.
    Hold(u64),
    /// If at least this many are skipped in a row, the robot comes to rest and the run ends.
    Stop(u64),
}

impl FromStr for Policy {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let expected = || "count, hold[:SLOTS] or stop[:SLOTS] was expected, SLOTS from 1".to_owned();
        let (word, slots) = match text.split_once(':') {
            None => (text, 1),
            Some((word, slots)) => (word, slots.parse().ok().filter(|n| *n > 0).ok_or_else(expected)?),
        };
        match word {
            "count" if word == text => Ok(Self::Count),
            "hold" => Ok(Self::Hold(slots)),
            "stop" => Ok(Self::Stop(slots)),
            _ => Err(expected()),
        }
    }
}

impl fmt::Display for Policy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Count => f.write_str("count"),
            Self::Hold(1) => f.write_str("hold"),
            Self::Stop(1) => f.write_str("stop"),
            Self::Hold(slots) => write!(f, "hold:{slots}"),
            Self::Stop(slots) => write!(f, "stop:{slots}"),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Overrun {
    pub slots: u64,
    /// The slowest part of the previous tick; `None` if that was in time and the thread was woken too late.
    pub part: Option<Stage>,
    /// Duration of that part, or delay of the wake-up.
    pub taken: Duration,
}

impl fmt::Display for Overrun {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let slots = if self.slots == 1 { "slot" } else { "slots" };
        write!(f, "{} {slots} of 40 ms skipped: ", self.slots)?;
        let ms = self.taken.as_secs_f64() * 1000.0;
        match self.part {
            None => write!(f, "woken up {ms:.1} ms late"),
            Some(part) => write!(f, "{part} took {ms:.1} ms"),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Reaction {
    None,
    /// The robot holds; number of ticks on time so far.
    Holding {
        punctual: u32,
    },
    Stopping {
        because: Overrun,
        ticks: u32,
    },
}

pub struct Overruns {
    policy: Policy,
    waking: u64,
    parts: Vec<(Stage, u64)>,
    reaction: Reaction,
    rest: RestWatch,
}

impl Overruns {
    #[must_use]
    pub fn new(policy: Policy) -> Self {
        Self {
            policy,
            waking: 0,
            parts: Stage::all().map(|part| (part, 0)).collect(),
            reaction: Reaction::None,
            rest: RestWatch::default(),
        }
    }

    /// Call at the beginning of a tick, with the skipped slots before it, the times of the previous tick, and the delay
    /// of the wake-up.
    pub fn observe(&mut self, slots: u64, stage_times: &StageTimes, late: Duration) -> Option<Overrun> {
        if slots == 0 {
            if let Reaction::Holding { punctual } = &mut self.reaction {
                *punctual += 1;
                if *punctual >= PUNCTUAL {
                    self.reaction = Reaction::None;
                }
            }
            return None;
        }
        let (part, taken, tick) = stage_times.worst();
        let overrun = if Duration::from_nanos(tick) >= SLOT {
            if let Some((_, count)) = self.parts.iter_mut().find(|(other, _)| *other == part) {
                *count += slots;
            }
            Overrun { slots, part: Some(part), taken: Duration::from_nanos(taken) }
        } else {
            self.waking += slots;
            // A thread that woke too late for its slot has waited for a later one, and may be on time for that.
            let missed = SLOT * u32::try_from(slots).unwrap_or(u32::MAX);
            Overrun { slots, part: None, taken: if late < SLOT { missed + late } else { late } }
        };
        self.react(overrun);
        Some(overrun)
    }

    fn react(&mut self, because: Overrun) {
        match (self.policy, self.reaction) {
            (Policy::Hold(least), _) if because.slots >= least => {
                self.reaction = Reaction::Holding { punctual: 0 };
            }
            // Fewer skipped slots than the policy's limit are still not on time.
            (Policy::Hold(_), Reaction::Holding { .. }) => {
                self.reaction = Reaction::Holding { punctual: 0 };
            }
            (Policy::Stop(least), Reaction::None) if because.slots >= least => {
                self.reaction = Reaction::Stopping { because, ticks: 0 };
            }
            _ => {}
        }
    }

    #[must_use]
    pub const fn knob(&self, knob: u16) -> u16 {
        match self.reaction {
            Reaction::None => knob,
            Reaction::Holding { .. } | Reaction::Stopping { .. } => 0,
        }
    }

    /// True if the robot holds, or comes to rest, because of an overrun.
    #[must_use]
    pub const fn is_holding(&self) -> bool {
        !matches!(self.reaction, Reaction::None)
    }

    /// Call at the end of a tick: returns the overrun for which the run ends now, because the robot is at rest.
    pub fn ends(&mut self, memory: &CommonMemory) -> Option<Overrun> {
        self.rest.observe(memory);
        let Reaction::Stopping { because, ticks } = &mut self.reaction else { return None };
        *ticks += 1;
        (self.rest.is_at_rest() || *ticks >= AT_LAST).then_some(*because)
    }

    /// Number of skipped slots by cause, if any: `None` for a late wake-up by the system.
    pub fn by_part(&self) -> impl Iterator<Item = (Option<Stage>, u64)> {
        let parts = self.parts.iter().map(|(part, count)| (Some(*part), *count));
        std::iter::once((None, self.waking)).chain(parts).filter(|(_, count)| *count > 0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use closed_loop::rest::AT_REST;
    use std::thread;

    const LATE: Duration = Duration::from_millis(95);

    /// Stage times of a tick in which the cell took `cell`.
    fn stage_times(cell: Duration) -> StageTimes {
        let mut stage_times = StageTimes::default();
        stage_times.begin();
        stage_times.mark(Stage::Inputs);
        thread::sleep(cell);
        stage_times.mark(Stage::Cell);
        stage_times
    }

    fn punctual(overruns: &mut Overruns, ticks: u32) {
        let stage_times = StageTimes::default();
        (0..ticks).for_each(|_| assert_eq!(overruns.observe(0, &stage_times, Duration::ZERO), None));
    }

    #[test]
    fn a_policy_is_a_word_with_a_number() {
        for (text, policy) in [
            ("count", Policy::Count),
            ("hold", Policy::Hold(1)),
            ("hold:3", Policy::Hold(3)),
            ("stop", Policy::Stop(1)),
            ("stop:25", Policy::Stop(25)),
        ] {
            assert_eq!((text.parse(), policy.to_string()), (Ok(policy), text.to_owned()));
        }
        for wrong in ["", "counts", "count:1", "hold:", "hold:0", "stop:-1", "stop:x"] {
            let error = wrong.parse::<Policy>().expect_err(wrong);
            assert!(error.starts_with("count, hold[:SLOTS] or stop[:SLOTS]"), "{error}");
        }
    }

    #[test]
    fn overrun_has_the_longest_part_or_the_system_as_cause() {
        let mut overruns = Overruns::new(Policy::Count);
        let (slow, quick) = (stage_times(Duration::from_millis(41)), stage_times(Duration::ZERO));
        let overrun = overruns.observe(2, &slow, LATE).expect("slots were skipped");
        assert_eq!((overrun.slots, overrun.part), (2, Some(Stage::Cell)));
        assert!(overrun.taken >= Duration::from_millis(41), "{overrun}");
        let taken = overrun.taken.as_secs_f64() * 1e3;
        assert_eq!(overrun.to_string(), format!("2 slots of 40 ms skipped: cell took {taken:.1} ms"));
        let overrun = overruns.observe(1, &quick, LATE).expect("a slot was skipped");
        assert_eq!(overrun.to_string(), "1 slot of 40 ms skipped: woken up 95.0 ms late");
        let punctual = overruns.observe(1, &quick, Duration::ZERO).expect("a slot was skipped");
        assert_eq!(
            punctual.to_string(),
            "1 slot of 40 ms skipped: woken up 40.0 ms late",
            "for the slot after"
        );
        overruns.observe(3, &slow, LATE);
        assert_eq!(overruns.by_part().collect::<Vec<_>>(), [(None, 2), (Some(Stage::Cell), 5)]);
        assert_eq!((overruns.knob(700), overruns.is_holding()), (700, false));
    }

    #[test]
    fn the_robot_holds_until_a_second_was_punctual() {
        let mut overruns = Overruns::new(Policy::Hold(2));
        let quick = stage_times(Duration::ZERO);
        overruns.observe(1, &quick, LATE);
        assert_eq!(overruns.knob(700), 700, "one slot is not yet enough");
        overruns.observe(2, &quick, LATE);
        assert_eq!(overruns.knob(700), 0);
        punctual(&mut overruns, PUNCTUAL - 1);
        assert_eq!(overruns.knob(700), 0);
        overruns.observe(1, &quick, LATE);
        punctual(&mut overruns, PUNCTUAL - 1);
        assert!(overruns.is_holding(), "the second begins again with every skipped slot");
        punctual(&mut overruns, 1);
        assert_eq!(overruns.knob(700), 700);
        assert_eq!(overruns.ends(&CommonMemory::default()), None);
    }

    #[test]
    fn a_run_is_stopped_when_the_robot_is_at_rest() {
        let mut overruns = Overruns::new(Policy::Stop(1));
        let mut memory = CommonMemory::default();
        (0..50).for_each(|_| assert_eq!(overruns.ends(&memory), None, "nothing was skipped"));
        let because = overruns.observe(4, &stage_times(Duration::ZERO), LATE);
        assert_eq!(overruns.knob(1000), 0);
        for moving in 1..30 {
            memory.prim.t3i.frame.tool[0] = moving;
            assert_eq!(overruns.ends(&memory), None);
        }
        (1..AT_REST).for_each(|_| assert_eq!(overruns.ends(&memory), None));
        overruns.observe(1, &stage_times(Duration::ZERO), LATE);
        assert_eq!(overruns.ends(&memory), because, "the first overrun is the reason");
    }

    #[test]
    fn run_ends_although_the_robot_never_rests() {
        let mut overruns = Overruns::new(Policy::Stop(1));
        overruns.observe(1, &stage_times(Duration::ZERO), LATE);
        let ticks = (0..1000).find(|&tick| {
            let mut memory = CommonMemory::default();
            memory.prim.t3i.frame.tool[0] = tick % 2 + 1;
            overruns.ends(&memory).is_some()
        });
        assert_eq!(ticks, Some(AT_LAST.cast_signed() - 1));
    }
}
