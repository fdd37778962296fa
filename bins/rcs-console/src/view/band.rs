//! Draws the state band in three lines: state with reason, facts, next step.

use ratatui::{
    style::{Color, Modifier, Style},
    text::{Line, Span},
};

use super::{
    Look,
    text::{fit, rule},
};
use crate::rcs_console::model::{
    Tone,
    band::{Band, Condition},
};

/// Columns of the state. A present state is shown as ` !! FAULT `, a recorded one as ` LOG [!! FAULT] `.
const STATE: usize = 13;

/// The lines of the band. The band of a present state is filled. The band of a log is not filled.
pub fn lines(band: &Band, look: Look, width: usize) -> [Line<'static>; 3] {
    let (shape, word) = (band.condition.shape(), band.condition.word());
    let state =
        if band.is_recorded { format!(" LOG [{shape} {word}] ") } else { format!(" {shape} {word:<8} ") };
    let state = format!("{state:<STATE$}");
    let role = format!(" {} ", band.role);
    let room = width.saturating_sub(state.chars().count() + role.chars().count());
    let style = style(band, look);
    let first = Line::from(vec![
        Span::styled(look.signs(state), style.add_modifier(Modifier::BOLD)),
        Span::styled(look.signs(fit(&band.why, room)), style),
        Span::styled(look.signs(role), style.add_modifier(Modifier::BOLD)),
    ]);
    let mut facts = String::new();
    for fact in &band.facts {
        let gap = if facts.is_empty() { " " } else { "  " };
        if facts.chars().count() + gap.len() + fact.chars().count() <= width {
            facts = facts + gap + fact;
        }
    }
    let facts = look.line(Tone::Plain, fit(&facts, width));
    let next = match band.next.as_str() {
        "" => look.line(Tone::Plain, rule("", width)),
        next => {
            let text = fit(&format!(" next: {next}"), width);
            Line::styled(look.signs(text), Style::default().add_modifier(Modifier::BOLD))
        }
    };
    [first, facts, next]
}

fn style(band: &Band, look: Look) -> Style {
    let style = Style::default();
    let (fill, text) = match band.condition {
        Condition::Running | Condition::Finished => (Color::Green, Color::Black),
        Condition::Paused | Condition::Stopped => (Color::Yellow, Color::Black),
        Condition::EStop | Condition::Fault => (Color::Red, Color::White),
        Condition::Ended | Condition::NoData => (Color::Gray, Color::Black),
    };
    match (band.is_recorded, look.colour) {
        (true, true) => style.fg(fill),
        (true, false) => style,
        (false, true) => style.bg(fill).fg(text),
        (false, false) => style.add_modifier(Modifier::REVERSED),
    }
}
