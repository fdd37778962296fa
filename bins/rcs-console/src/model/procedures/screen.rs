//! The procedure screen as lines: the list, or the steps of the open procedure.

use super::{ALL, Ask, Progress, Step, Track, condition::Sight, progress::Mark};
use crate::rcs_console::model::{Section, Text, Tone};

const INDENT: &str = "              "; // columns before the text of a step

/// The list, or the open procedure.
#[must_use]
pub fn sections(progress: &Progress, sight: &Sight<'_>) -> Vec<Section> {
    match progress.tracks.get(progress.cursor) {
        Some(track) if progress.is_open => vec![steps(track, sight)],
        _ => vec![list(progress)],
    }
}

fn list(progress: &Progress) -> Section {
    let line = |(at, track): (usize, &Track)| {
        let (mark, tone) = if at == progress.cursor { ('>', Tone::Marked) } else { (' ', Tone::Plain) };
        let done = track.marks.iter().filter(|mark| mark.is_set()).count();
        let of = match done {
            0 => format!("steps: {}", track.marks.len()),
            done => format!("{done} of {}", track.marks.len()),
        };
        let procedure = track.procedure;
        Text::new(tone, format!(" {mark} {:<10}{:<53}{of:>11}", procedure.section, procedure.title))
    };
    let lines = progress.tracks.iter().enumerate().map(line).collect();
    Section { at: progress.cursor, ..Section::new(format!("procedures, {}", ALL.len()), lines) }
}

fn steps(track: &Track, sight: &Sight<'_>) -> Section {
    let sight = Sight { begun: track.begun, ..*sight };
    let mut lines = Vec::new();
    let mut at = 0;
    for (index, (step, mark)) in track.procedure.steps.iter().zip(&track.marks).enumerate() {
        let chosen = index == track.cursor;
        let cursor = if chosen { '>' } else { ' ' };
        let tone = match (chosen, mark) {
            (true, _) => Tone::Marked,
            (false, Mark::NotThere | Mark::Skipped(..)) => Tone::Faint,
            _ => Tone::Plain,
        };
        lines.push(Text::new(tone, format!("{cursor} {:<5} {:<4}  {}", mark.word(), step.id, step.text)));
        if chosen {
            at = lines.len();
            lines.extend(details(step, mark, &sight));
        }
    }
    let title = format!("{} ({})", track.procedure.title, track.procedure.section);
    Section { title, lines, at }
}

fn details(step: &Step, mark: &Mark, sight: &Sight<'_>) -> Vec<Text> {
    let mut lines: Vec<Text> = step.show.lines(sight);
    let mut say = |tone, text: String| lines.push(Text::new(tone, text));
    if !step.how.is_empty() {
        say(Tone::Plain, step.how.to_owned());
    }
    if !step.warning.is_empty() && !mark.is_set() {
        say(Tone::Trouble, format!("WARNING: {}", step.warning));
    }
    let asked: Vec<_> = step
        .ask
        .iter()
        .map(|ask| match ask {
            Ask::Line(line) => *line,
            Ask::ReleaseEStops => "release each E-stop that is in",
        })
        .collect();
    if !asked.is_empty() {
        say(Tone::Faint, format!("Enter asks for: {}", asked.join("; ")));
    }
    match mark {
        Mark::Open if step.needs_a_word(sight) => {
            say(Tone::Faint, "the console cannot check this: y confirms it".to_owned());
        }
        Mark::Said(tick) => say(Tone::Faint, format!("confirmed in tick {tick}")),
        Mark::Done(tick) => say(Tone::Faint, format!("done in tick {tick}")),
        Mark::Skipped(tick, reason) => say(Tone::Faint, format!("left out in tick {tick}: {reason}")),
        Mark::NotThere => say(Tone::Faint, "the simulated cell does not have this".to_owned()),
        Mark::Open | Mark::Seen => {}
    }
    lines.into_iter().map(|Text { tone, text }| Text::new(tone, format!("{INDENT}{text}"))).collect()
}
