//! The link screen: the link to the robot, and the times of the ticks.

use depc::warning::Warning;
use executive::memory::cell::LatenessView;
use geometry::pose::WireFrame;
use interfaces::t3i::{LinkFault, T3iStatus};
use os_io::text::amount;
use rcs_core::{Plain, plain::Schema, tick::TICK_S};
use record::{Level, reader::LogLine};

use super::{Section, Text, Tone, frames};
use crate::rcs_console::{picture::Picture, source::Cell, story::Story};

const MESSAGES: usize = 6;
const RESTARTS: usize = 3;
const SOURCES: [&str; 4] = ["T3 Interface", "cell", "fault", "executive"];

#[must_use]
pub fn sections(picture: &Picture, story: &Story, cell: &Cell) -> Vec<Section> {
    vec![
        link(picture),
        times(picture, story, cell),
        restarts(picture, story),
        messages(picture, story),
        positions(&picture.memory.t3i.status),
        codes(),
    ]
}

fn link(picture: &Picture) -> Section {
    let (status, devices) = (&picture.memory.t3i.status, &picture.external.devices);
    let counts = &status.counters;
    let mut lines = vec![
        Text::plain(format!(
            " frames {}   answered {}   without answer {}   NAK {}   repeated {}",
            counts.frames, counts.acknowledged, counts.timeouts, counts.naks, counts.retries
        )),
        Text::plain(format!(
            " re-starts {}   wrong checksum {}   points limited {}",
            counts.restarts, counts.checksum_errors, counts.limited
        )),
    ];
    let told = |way: &str, frames: Vec<String>| {
        let frames = if frames.is_empty() { vec!["nothing".to_owned()] } else { frames };
        frames.into_iter().map(|frame| Text::plain(format!(" {way} {frame}"))).collect::<Vec<_>>()
    };
    lines.extend(told("sent     ", frames::sent(picture.memory.t3i.link_tx.as_slice())));
    lines.extend(told("received ", frames::received(devices.link_rx.as_slice())));
    let cts = if devices.link_ready { "the robot's DTR is on" } else { "the robot's DTR is off" };
    let rest = if devices.link_unsent { "bytes of the last tick wait" } else { "nothing left unsent" };
    lines.push(Text::plain(format!(" line      {cts}, {rest}")));
    if status.fault != LinkFault::None {
        lines.push(Text::new(Tone::Trouble, format!("!! {}", status.fault.text())));
    }
    if let Some(trouble) = status.trouble() {
        lines.push(Text::new(Tone::Trouble, format!("!! {trouble}")));
    }
    let state = if status.link_running { "runs" } else { "does not run" };
    Section::new(format!("DEPC link: {state}, {}", status.report), lines)
}

fn positions(status: &T3iStatus) -> Section {
    let row = |name: &str, part: fn(&WireFrame) -> [i32; 3]| {
        let text = |frame: &WireFrame| {
            let [x, y, z] = part(frame);
            format!("{x:>7}{y:>7}{z:>7}")
        };
        let sensed = status.resolver_frame.as_ref().map_or_else(|| "     not believed".to_owned(), text);
        Text::plain(format!(" {name:<14}{}   {sensed}", text(&status.frame_feedback)))
    };
    let check = Text::plain(format!(" the robot is {}", status.check));
    let lines = vec![
        Text::plain("                    acknowledged           resolvers"),
        row("tool point", |frame| frame.tool),
        row("wrist->tool", |frame| frame.wrist_to_tool),
        row("tool->finger", |frame| frame.tool_to_finger),
        check,
    ];
    Section::new("where the robot is, 0.01 in", lines)
}

fn times(picture: &Picture, story: &Story, cell: &Cell) -> Section {
    let Some(timing) = picture.timing else {
        let text = " a run in fast clock records no times, so that equal runs have equal logs";
        return Section::new("time", vec![Text::new(Tone::Faint, text)]);
    };
    let summary = story.times().summary();
    let allocations =
        timing.allocations.map_or_else(|| "not in a log".to_owned(), |allocations| allocations.to_string());
    let skipped = Text::new(
        if timing.skipped > 0 { Tone::Trouble } else { Tone::Plain },
        format!(
            "{}slots skipped {}   heap allocations {allocations}",
            if timing.skipped > 0 { "!! " } else { " " },
            timing.skipped
        ),
    );
    let lines = vec![
        Text::plain(format!(
            " controller {:.1} us in this tick; {} seen: p50 {:.1}  p99 {:.1}  max {:.1} us",
            timing.controller_ns as f64 / 1000.0,
            amount(story.times().count(), "tick"),
            summary.p50,
            summary.p99,
            summary.max
        )),
        skipped,
        lateness(cell),
    ];
    Section::new("time", lines)
}

fn lateness(cell: &Cell) -> Text {
    match cell {
        Cell::Shown(view) => {
            let LatenessView { last, p50, p99, max } = view.lateness;
            Text::plain(format!(
                " begins late {last:.1} us in this tick; p50 {p50:.1}  p99 {p99:.1}  max {max:.1} us"
            ))
        }
        Cell::NotPublished | Cell::Recorded(_) => {
            Text::new(Tone::Faint, " how late a tick began is not shown here; rcs-run prints it at the end")
        }
    }
}

fn restarts(picture: &Picture, story: &Story) -> Section {
    let restarts = story.restarts(picture.tick.0);
    let lines: Vec<Text> = restarts
        .iter()
        .rev()
        .take(RESTARTS)
        .map(|restart| {
            Text::plain(format!(" {:>7} {:>9.2} s  {}", restart.tick, at(restart.tick), restart.reason))
        })
        .collect();
    let none = vec![Text::new(Tone::Faint, " none that was seen")];
    Section::new("re-starts of the link, newest first", if lines.is_empty() { none } else { lines })
}

fn messages(picture: &Picture, story: &Story) -> Section {
    let about = |line: &&LogLine| SOURCES.contains(&line.source.as_str()) || line.level >= Level::Warning;
    let lines: Vec<Text> =
        story.lines(picture.tick.0).iter().rev().filter(about).take(MESSAGES).map(message).collect();
    let none = vec![Text::new(Tone::Faint, " none")];
    Section::new("messages, newest first", if lines.is_empty() { none } else { lines })
}

#[must_use]
pub fn message(line: &LogLine) -> Text {
    let (mark, tone) = if line.level >= Level::Warning { ("!!", Tone::Trouble) } else { ("  ", Tone::Plain) };
    let LogLine { tick, source, text, .. } = line;
    Text::new(tone, format!("{mark}{:>6} {:>9.2} s  {source}: {text}", tick.0, at(tick.0)))
}

fn at(tick: u64) -> f64 {
    tick as f64 * TICK_S
}

fn codes() -> Section {
    let Schema::Enum(warnings) = Warning::SCHEMA else { return Section::default() };
    let lines = warnings.variants.iter().filter(|warning| !warning.text.is_empty());
    let lines = lines.map(|warning| Text::plain(format!(" {:<9} {}", warning.text, warning.doc)));
    Section::new("codes on the screen of the robot controller (A 2.3)", lines.collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use interfaces::{CommonMemory, ExternalInputs};
    use rcs_core::tick::Tick;

    use crate::rcs_console::picture::Timing;

    fn picture() -> Picture {
        let (external, memory) = (ExternalInputs::default(), CommonMemory::default());
        Picture { tick: Tick(5), external, memory, timing: None }
    }

    fn all(picture: &Picture, story: &Story) -> String {
        let sections = sections(picture, story, &Cell::NotPublished);
        let lines = sections.iter().flat_map(|section| section.lines.iter().map(|line| line.text.as_str()));
        lines.collect::<Vec<_>>().join("\n")
    }

    #[test]
    fn link_fault_is_listed_with_possible_causes() {
        let mut picture = picture();
        assert!(!all(&picture, &Story::new(9)).contains("!!"));
        picture.memory.t3i.status.fault = LinkFault::NotResponding;
        picture.memory.t3i.status.silent = true;
        let text = all(&picture, &Story::new(9));
        assert!(
            text.contains("!! not responding") && text.contains("!! the robot controller does not answer")
        );
    }

    #[test]
    fn times_cover_all_ticks() {
        let mut picture = picture();
        assert!(all(&picture, &Story::new(9)).contains("records no times"));
        let mut story = Story::new(9);
        for controller_ns in [2_000, 6_000] {
            picture.timing = Some(Timing { controller_ns, skipped: 2, allocations: Some(0) });
            story.note(&picture, &picture);
        }
        let text = all(&picture, &story);
        assert!(text.contains("controller 6.0 us in this tick; 2 ticks seen"), "{text}");
        assert!(text.contains("!! slots skipped 2   heap allocations 0"), "{text}");
    }

    #[test]
    fn every_code_has_its_words() {
        let lines = codes().lines;
        assert!(
            lines.iter().any(|line| line.text == " WD6       Joint limit reached (joint 6)."),
            "{lines:?}"
        );
        assert!(lines.iter().any(|line| line.text.starts_with(" P05 ")));
    }
}
