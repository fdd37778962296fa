//! Tests inputs one at a time: a person works each sensor, and says in which state it is.
//!
//! The person's statement, not only a change, is compared with the reading: an inverted input changes, too. A point
//! that does not change while another one does is connected to the wrong terminal, or has a wrong address.

use std::{
    io,
    sync::atomic::{AtomicBool, Ordering},
};

use field::InPoint;
use os_io::stderr_line;

use super::{
    Bench, PERIOD,
    expected::{self, Work},
    person::{Person, Typed, prompt},
    probes::{NOISE, Probes, Reading, has_changed},
    tally::{InputTally, Verdict},
};

const SETTLING: u32 = 3; // exchanges from the person's answer to the reading

/// A state of a sensor that a person is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Asked {
    On,
    Off,
    Highest,
    Lowest,
    Changed,
}

impl Asked {
    const fn text(self) -> &'static str {
        match self {
            Self::On => "switch it on",
            Self::Off => "switch it off",
            Self::Highest => "bring it to its highest value",
            Self::Lowest => "bring it to its lowest value",
            Self::Changed => "change it",
        }
    }
}

/// How a person answered.
enum Answer {
    Done,
    Skip,
    Quit,
}

pub struct Wiggle<'a> {
    pub bench: &'a Bench,
    pub probes: &'a mut Probes,
    pub person: &'a Person,
    pub stop: &'a AtomicBool,
    pub noise: Vec<i64>, // of each input of the mapping at rest
}

impl Wiggle<'_> {
    /// Asks for each of the inputs, and gives it a verdict.
    pub fn test(&mut self, tallies: &mut [InputTally]) -> io::Result<()> {
        let count = tallies.len();
        let mut previous = None;
        let mut is_over = false;
        for (number, tally) in tallies.iter_mut().enumerate() {
            if is_over {
                tally.verdict = Verdict::Skipped;
                continue;
            }
            let points = &self.bench.mapping.inputs;
            let Some(index) = points.iter().position(|point| point.name == tally.name) else { continue };
            let place = format!("{} of {count}", number + 1);
            is_over = self.work(index, previous, &place, tally)?;
            if is_over {
                tally.verdict = Verdict::Skipped;
            }
            stderr_line!("    {}", tally.outcome());
            previous = Some(index);
        }
        Ok(())
    }

    /// Returns true if the person wants to end the test. The return of the `previous` sensor to rest is ignored.
    fn work(
        &mut self,
        index: usize,
        previous: Option<usize>,
        place: &str,
        tally: &mut InputTally,
    ) -> io::Result<bool> {
        let point = &self.bench.mapping.inputs[index];
        let work = expected::work(point);
        let before = self.settled();
        let states: &[Asked] = match work {
            Work::Switch => &[Asked::On, Asked::Off],
            Work::Range(_) => &[Asked::Highest, Asked::Lowest],
            Work::Change => &[Asked::Changed],
        };
        let mut found = Vec::new();
        let mut elsewhere = Vec::new();
        for asked in states {
            match self.ask(index, *asked, place)? {
                Answer::Done => {}
                Answer::Skip => {
                    tally.verdict = Verdict::Skipped;
                    return Ok(false);
                }
                Answer::Quit => return Ok(true),
            }
            let now = self.settled();
            found.push(now[index].map_or(0, Reading::value));
            now[index].into_iter().for_each(|reading| tally.add(reading));
            let others = (0..now.len()).filter(|other| *other != index && Some(*other) != previous);
            let points = &self.bench.mapping.inputs;
            elsewhere.extend(others.filter(|other| {
                has_changed(&points[*other], self.noise[*other], before[*other], now[*other])
            }));
            // A switch that was off and is on has had both states.
            if work == Work::Switch && before[index].map(Reading::value) == Some(0) && found == [1] {
                break;
            }
        }
        let first = before[index].map_or(0, Reading::value);
        let (verdict, note) = match work {
            Work::Switch => (switched(first, &found), String::new()),
            Work::Range(limits) => moved(point, first, &found, self.noise[index], &limits),
            Work::Change if found != [first] => (Verdict::Good, String::new()),
            Work::Change => (Verdict::NoChange, String::new()),
        };
        let was_broken = tally.verdict == Verdict::BrokenWire;
        (tally.verdict, tally.note) = (verdict, note);
        if verdict == Verdict::NoChange && was_broken {
            tally.verdict = Verdict::BrokenWire;
        } else if verdict == Verdict::NoChange {
            elsewhere.sort_unstable();
            elsewhere.dedup();
            let names: Vec<&str> =
                elsewhere.iter().map(|other| self.bench.mapping.inputs[*other].name.as_str()).collect();
            tally.note = if names.is_empty() {
                format!("always {first}")
            } else {
                tally.verdict = Verdict::Elsewhere;
                format!("{} changed", names.join(", "))
            };
        }
        Ok(false)
    }

    fn ask(&mut self, index: usize, asked: Asked, place: &str) -> io::Result<Answer> {
        let name = &self.bench.mapping.inputs[index].name;
        let shown =
            |reading: Option<Reading>| reading.map_or_else(String::new, |one| one.value().to_string());
        let text = format!("{place}: {name}: {}, then press Enter (s skips, q ends)", asked.text());
        let is_terminal = io::IsTerminal::is_terminal(&io::stderr());
        let mut last = shown(self.probes.read(&self.bench.mapping)[index]);
        prompt(&format!("{text}: {last} "))?;
        loop {
            match self.person.typed_within(PERIOD) {
                Typed::Line(line) if line == "s" => return Ok(Answer::Skip),
                Typed::Line(line) if line == "q" => return Ok(Answer::Quit),
                Typed::Line(_) => return Ok(Answer::Done),
                Typed::Ended => return Ok(Answer::Quit),
                Typed::Nothing if self.stop.load(Ordering::Relaxed) => return Ok(Answer::Quit),
                Typed::Nothing => {}
            }
            self.probes.exchange();
            let now = shown(self.probes.read(&self.bench.mapping)[index]);
            if is_terminal && now != last {
                // The value changes in place, and what was longer is erased.
                prompt(&format!("\r{text}: {now}\u{1b}[K "))?;
                last = now;
            }
        }
    }

    fn settled(&mut self) -> Vec<Option<Reading>> {
        for _ in 0..SETTLING {
            self.probes.exchange();
            std::thread::sleep(PERIOD);
        }
        self.probes.read(&self.bench.mapping)
    }
}

/// The verdict of a switch: its value at first, after it was switched on, and after it was switched off, if asked.
fn switched(first: i64, found: &[i64]) -> Verdict {
    match (first, found) {
        (0, [1]) | (_, [1, 0]) => Verdict::Good,
        (0, [0, 1]) | (1, [0, _]) => Verdict::Inverted,
        _ => Verdict::NoChange,
    }
}

/// The verdict of an analog input, with a note: its counts at first, at its highest and at its lowest value.
fn moved(
    point: &InPoint,
    first: i64,
    found: &[i64],
    noise: i64,
    limits: &expected::Limits,
) -> (Verdict, String) {
    let &[highest, lowest] = found else { return (Verdict::NoChange, String::new()) };
    let range = format!("{lowest} to {highest} counts");
    let least = noise.max(NOISE);
    if highest.abs_diff(lowest) <= least.unsigned_abs() {
        return (Verdict::NoChange, String::new());
    }
    if lowest - highest >= limits.span {
        return (Verdict::Inverted, range);
    }
    if highest - lowest < limits.span {
        return (Verdict::WrongScale, format!("{range}, a change of {} was expected", limits.span));
    }
    let checked = [(limits.lowest, lowest), (limits.highest, highest), (expected::at_rest(point), first)];
    let wrong = checked
        .into_iter()
        .find_map(|(near, value)| near.filter(|near| !near.contains(value)).zip(Some(value)));
    match wrong {
        Some((near, value)) => {
            let expected = format!("{value} counts, {} within {} were expected", near.value, near.tolerance);
            (Verdict::WrongScale, expected)
        }
        None => (Verdict::Good, String::new()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statement_of_the_person_decides_about_a_switch() {
        for (first, found, verdict) in [
            (0, &[1][..], Verdict::Good),
            (1, &[1, 0], Verdict::Good),
            (1, &[0, 0], Verdict::Inverted),
            (1, &[0, 1], Verdict::Inverted),
            (0, &[0, 1], Verdict::Inverted),
            (0, &[0, 0], Verdict::NoChange),
            (1, &[1, 1], Verdict::NoChange),
        ] {
            assert_eq!(switched(first, found), verdict, "{first} {found:?}");
        }
    }
}
