//! What the page shows, taken from a log tick by tick.

use std::path::Path;

use executive::failure;
use levels::ladder::Ladder;
use rcs_core::{
    interface::CommonMemory,
    pose::WireFrame,
    tick::{TICK_S, Tick},
};
use record::{Log, proto::foxglove::Level};

use crate::{
    Error,
    story::{Chronicle, Moment, walk},
};

/// Levels whose commands have a lane in the timeline: positions in the ladder's list of processes, Task to Prim.
pub const LANES: usize = 4;

/// A stretch of ticks in which a level had the same command.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretch {
    /// First tick.
    pub from: u64,
    /// Last tick.
    pub to: u64,
    /// The command, as people write it; empty for none.
    pub text: String,
}

/// A run as the page shows it. All series have one value a tick.
#[derive(Default)]
pub struct Run {
    /// Number of each tick.
    pub ticks: Vec<u64>,
    /// Names of the lanes, and their stretches.
    pub lanes: Vec<(&'static str, Vec<Stretch>)>,
    /// Speed of the commanded tool point, in/s.
    pub speed: Vec<f64>,
    /// Turning of the commanded tool frame, rad/s.
    pub turning: Vec<f64>,
    /// Tool point commanded to the robot, inches.
    pub path: Vec<[f64; 3]>,
    /// Opening of the parts gripper, in.
    pub opening: Vec<f64>,
    /// Greater force of its fingers, lb.
    pub force: Vec<f64>,
    /// NAKs, time-outs, checksum errors and re-starts that the tick added.
    pub link_faults: Vec<u32>,
    /// Commands and the failure.
    pub chronicle: Chronicle,
    /// Warnings and errors of the log.
    pub lines: Vec<(Tick, Level, String, String)>,
}

/// Read a log.
pub fn gather(log: &Log, path: &Path) -> Result<Run, Error> {
    let names = Ladder::processes().iter().take(LANES).map(|process| (process.name, Vec::new()));
    let mut run = Run { lanes: names.collect(), ..Run::default() };
    walk(log, path, |moment| {
        run.note(moment);
        true
    })?;
    if run.ticks.is_empty() {
        return Err(Error::Empty(path.to_owned()));
    }
    let worth = |level| matches!(level, Level::Warning | Level::Error);
    run.lines = log
        .lines()
        .filter(|line| worth(line.level))
        .map(|line| (line.tick, line.level, line.source, line.text))
        .collect();
    Ok(run)
}

impl Run {
    fn note(&mut self, moment: &Moment) {
        self.chronicle.note(moment);
        self.ticks.push(moment.tick.0);
        for (index, (_, lane)) in self.lanes.iter_mut().enumerate() {
            let text = failure::command(index, &moment.external.hws, &moment.after);
            extend(lane, moment.tick.0, text);
        }
        let (speed, turning) = motion(&moment.before, &moment.after);
        self.speed.push(speed);
        self.turning.push(turning);
        let frame = &moment.after.t3i.status.frame_feedback;
        self.path.push(frame.tool.map(|hundredths| f64::from(hundredths) / 100.0));
        let grip = &moment.after.grip.status;
        self.opening.push(f64::from(grip.position) / 100.0);
        self.force.push(f64::from(grip.left_force.max(grip.right_force)));
        let counters = |memory: &CommonMemory| {
            let link = &memory.t3i.status.counters;
            link.naks
                .saturating_add(link.timeouts)
                .saturating_add(link.checksum_errors)
                .saturating_add(link.restarts)
        };
        self.link_faults.push(counters(&moment.after).saturating_sub(counters(&moment.before)));
    }
}

/// Lengthen the last stretch of a lane, or begin a new one.
fn extend(lane: &mut Vec<Stretch>, tick: u64, text: String) {
    match lane.last_mut() {
        Some(last) if last.text == text => last.to = tick,
        _ => lane.push(Stretch { from: tick, to: tick, text }),
    }
}

/// Speed in in/s and turning in rad/s between two commanded frames; 0 until there are two.
fn motion(before: &CommonMemory, after: &CommonMemory) -> (f64, f64) {
    let known = |frame: &WireFrame| (*frame != WireFrame::default()).then(|| frame.to_frame().ok()).flatten();
    let (was, is) = (&before.t3i.status, &after.t3i.status);
    if !(was.link_running && is.link_running) {
        return (0.0, 0.0);
    }
    match (known(&was.frame_feedback), known(&is.frame_feedback)) {
        (Some(a), Some(b)) => {
            let distance = a.distance(&b);
            (distance.inches / TICK_S, distance.radians / TICK_S)
        }
        _ => (0.0, 0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lane_has_one_stretch_a_command() {
        let mut lane = Vec::new();
        for (tick, text) in [(1, ""), (2, "MOVE"), (3, "MOVE"), (4, "PAUSE")] {
            extend(&mut lane, tick, text.to_owned());
        }
        let texts: Vec<_> = lane.iter().map(|s| (s.from, s.to, s.text.as_str())).collect();
        assert_eq!(texts, [(1, 1, ""), (2, 3, "MOVE"), (4, 4, "PAUSE")]);
    }

    #[test]
    fn nothing_moves_without_a_link() {
        assert_eq!(motion(&CommonMemory::default(), &CommonMemory::default()), (0.0, 0.0));
    }
}
