//! The result of a link test: counts, latencies, and the verdict.

use std::{fmt, time::Duration};

use executive::serial::{SerialCounts, SerialSettings};
use interfaces::t3i::LinkCounters;
use os_io::text::amount;
use rcs_core::tick::TICK_MS;
use serde::Serialize;

const IN_TIME: Duration = Duration::from_millis(TICK_MS); // longest latency of an ACK that is in time
const GOOD: f64 = 0.95; // least share of frames acknowledged in time for `good`
const USABLE: f64 = 0.90; // least share for `usable`
/// Largest share of frames without an answer for `good`. 10 restarts in 10 s lose the link (docs/design/link.md
/// "Recovery"). At this share, one in a million runs of 250 frames loses it.
const LOST_GOOD: f64 = 0.005;
/// Largest share for `usable`: 10 of 250 frames are lost in one run of 5000.
const LOST_USABLE: f64 = 0.01;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// At least 0.95 of the frames in time and at most 0.005 lost, and the port never disappeared.
    Good,
    /// At least 0.90 of the frames in time, and at most 0.01 lost.
    Usable,
    /// Fewer frames in time, or more lost.
    NotUsable,
    /// The robot never reported a position, or the link was down at the end.
    NoLink,
}

impl Verdict {
    fn of(connected: bool, in_time: f64, lost: f64, breaks: u32) -> Self {
        if !connected {
            Self::NoLink
        } else if in_time >= GOOD && lost <= LOST_GOOD && breaks == 0 {
            Self::Good
        } else if in_time >= USABLE && lost <= LOST_USABLE {
            Self::Usable
        } else {
            Self::NotUsable
        }
    }

    const fn text(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Usable => "usable",
            Self::NotUsable => "not usable",
            Self::NoLink => "no link",
        }
    }
}

/// Time from a data command to the byte of its ACK, ms.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Latency {
    pub min: f64,
    pub median: f64,
    pub max: f64,
}

impl Latency {
    fn of(latencies: &mut [Duration]) -> Option<Self> {
        latencies.sort_unstable();
        let ms = |latency: &Duration| latency.as_secs_f64() * 1000.0;
        Some(Self {
            min: ms(latencies.first()?),
            median: ms(latencies.get(latencies.len() / 2)?),
            max: ms(latencies.last()?),
        })
    }
}

/// The result. The names of the fields are those of the JSON object.
#[derive(Clone, Debug, Serialize)]
pub struct Tally {
    pub port: String,
    pub modem_lines: bool,
    pub connected: bool,
    /// Number of starts of the link, that is of accepted reports.
    pub starts: u32,
    pub sent: u32,
    pub acknowledged: u32,
    /// Data commands acknowledged within a tick.
    pub in_time: usize,
    /// Data commands refused with a NAK.
    pub refused: u32,
    /// Data commands without an answer.
    pub lost: u32,
    pub restarts: u32,
    pub checksum_errors: u32,
    /// Number of times that the port disappeared.
    pub port_lost: u32,
    /// Share of the data commands that were acknowledged in time.
    pub share_in_time: f64,
    /// Share of the data commands without an answer; each costs a restart of the link.
    pub share_lost: f64,
    pub ack_ms: Option<Latency>,
    pub verdict: Verdict,
}

#[derive(Clone, Copy, Debug)]
pub struct Observed {
    pub modem_lines: bool,
    pub connected: bool,
    pub starts: u32,
}

impl Tally {
    #[must_use]
    pub fn new(
        settings: &SerialSettings,
        observed: Observed,
        counters: &LinkCounters,
        serial: SerialCounts,
        latencies: &mut [Duration],
    ) -> Self {
        let Observed { modem_lines, connected, starts } = observed;
        let (sent, acknowledged, refused) = (counters.frames, counters.acknowledged, counters.naks);
        let in_time = latencies.iter().filter(|latency| **latency <= IN_TIME).count();
        let share = |count: f64| if sent == 0 { 0.0 } else { count / f64::from(sent) };
        let lost = sent.saturating_sub(acknowledged).saturating_sub(refused);
        let (share_in_time, share_lost) = (share(in_time as f64), share(f64::from(lost)));
        Self {
            port: settings.path.display().to_string(),
            modem_lines,
            connected,
            starts,
            sent,
            acknowledged,
            in_time,
            refused,
            lost,
            restarts: counters.restarts,
            checksum_errors: counters.checksum_errors,
            port_lost: serial.losses,
            share_in_time,
            share_lost,
            ack_ms: Latency::of(latencies),
            verdict: Verdict::of(connected && sent > 0, share_in_time, share_lost, serial.losses),
        }
    }

    /// The reason why the link is not usable, as a sentence; `None` if it is usable.
    #[must_use]
    pub fn failure(&self) -> Option<String> {
        let port = &self.port;
        match self.verdict {
            Verdict::Good | Verdict::Usable => None,
            Verdict::NotUsable => Some(format!(
                "the link at {port} is not usable: {} of {} acknowledged in time, {USABLE} of them needed; \
                 {} lost, {LOST_USABLE} of them allowed",
                self.in_time,
                amount(self.sent, "frame"),
                self.lost
            )),
            Verdict::NoLink if self.starts == 0 => Some(format!(
                "no link at {port}: the robot controller has not reported its position, after {}",
                amount(self.restarts, "re-start command")
            )),
            Verdict::NoLink => Some(format!("no link at {port}: it ran, and was lost")),
        }
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let modem = if self.modem_lines { "with modem lines" } else { "without modem lines" };
        writeln!(f, "port       {} {modem}, lost {}", self.port, amount(self.port_lost, "time"))?;
        writeln!(
            f,
            "link       {}, {}, {}",
            amount(self.starts, "start"),
            amount(self.restarts, "re-start command"),
            amount(self.checksum_errors, "checksum error")
        )?;
        writeln!(
            f,
            "frames     {} sent, {} acknowledged ({} within {TICK_MS} ms), {} refused (NAK), {} lost",
            self.sent, self.acknowledged, self.in_time, self.refused, self.lost
        )?;
        match self.ack_ms {
            Some(Latency { min, median, max }) => {
                writeln!(f, "ACK after  {min:.1} ms at least, {median:.1} median, {max:.1} at most")?;
            }
            None => writeln!(f, "ACK after  -")?,
        }
        writeln!(
            f,
            "verdict    {} ({:.3} in time, {:.3} lost)",
            self.verdict.text(),
            self.share_in_time,
            self.share_lost
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tally(frames: u32, acknowledged: u32, late: usize) -> Tally {
        let counters = LinkCounters { frames, acknowledged, naks: 1, ..LinkCounters::default() };
        let mut latencies: Vec<Duration> = (0..acknowledged as usize)
            .map(|n| Duration::from_millis(if n < late { 41 } else { 20 }))
            .collect();
        let observed = Observed { modem_lines: false, connected: true, starts: 1 };
        let settings = SerialSettings::new("/dev/x");
        Tally::new(&settings, observed, &counters, SerialCounts::default(), &mut latencies)
    }

    #[test]
    fn verdict_follows_the_share_in_time() {
        for (late, verdict) in [
            (0, Verdict::Good),
            (4, Verdict::Good),
            (5, Verdict::Usable),
            (9, Verdict::Usable),
            (10, Verdict::NotUsable),
        ] {
            let tally = tally(100, 99, late);
            assert_eq!(tally.lost, 0, "the one without an ACK was refused");
            assert_eq!(tally.verdict, verdict, "{tally}");
            assert_eq!(tally.failure().is_some(), verdict == Verdict::NotUsable);
        }
        assert_eq!(Verdict::of(false, 1.0, 0.0, 0), Verdict::NoLink);
        assert_eq!(tally(0, 0, 0).verdict, Verdict::NoLink);
    }

    #[test]
    fn line_with_lost_answers_is_not_good() {
        for (acknowledged, verdict) in [
            (998, Verdict::Good),
            (994, Verdict::Good),
            (993, Verdict::Usable),
            (989, Verdict::Usable),
            (988, Verdict::NotUsable),
            (960, Verdict::NotUsable),
        ] {
            let tally = tally(1000, acknowledged, 0);
            assert_eq!(tally.verdict, verdict, "{tally}");
        }
        assert_eq!(
            Verdict::of(true, 1.0, 0.0, 1),
            Verdict::Usable,
            "the port was away: the run would have ended"
        );
    }

    #[test]
    fn every_frame_is_acknowledged_refused_or_lost() {
        let tally = tally(100, 90, 1);
        assert_eq!((tally.refused, tally.lost, tally.in_time), (1, 9, 89));
        let latency = tally.ack_ms.unwrap();
        assert_eq!((latency.min, latency.median, latency.max), (20.0, 20.0, 41.0));
    }
}
