//! The ladder as boxes with lines between them, as in VI.6.2, on a terminal that has room for them.

use interfaces::ProcessId;
use ratatui::{
    style::Modifier,
    text::{Line, Span},
};

use super::{Look, text::fit};
use crate::rcs_console::model::{
    Tone,
    ladder::{self, Item},
};

/// Smallest terminal for boxes: columns, and lines of the body.
pub const LEAST: (usize, usize) = (120, 35);
/// Columns of a box, including its borders.
const WIDTH: usize = 38;
/// Column of the line between levels.
const JOINT: usize = 24;
/// Columns between two boxes.
const GAP: usize = 2;
/// Lines of a box, including its borders.
const HEIGHT: usize = 4;
/// Lines of all boxes.
pub const LINES: usize = 7 * HEIGHT;

/// Position of each box: column and line of boxes, and line of the left box to which it is connected.
const PLACES: [(Item, usize, usize, usize); 16] = [
    (Item::Workstation, 0, 0, 0),
    (Item::Process(ProcessId::Task), 0, 1, 1),
    (Item::Process(ProcessId::Subtask), 0, 2, 2),
    (Item::Process(ProcessId::Emove), 0, 3, 3),
    (Item::Process(ProcessId::Prim), 0, 4, 4),
    (Item::Process(ProcessId::T3i), 0, 5, 5),
    (Item::Robot, 0, 6, 6),
    (Item::DataSystem, 1, 1, 1),
    (Item::Process(ProcessId::Pedestal), 1, 2, 2),
    (Item::Process(ProcessId::Hand), 2, 2, 2),
    (Item::Process(ProcessId::RotaryTable), 2, 1, 2),
    (Item::Vision, 1, 3, 3),
    (Item::Process(ProcessId::QuickChange), 1, 4, 3),
    (Item::Process(ProcessId::Grip), 1, 5, 3),
    (Item::Process(ProcessId::VGrip), 1, 6, 3),
    (Item::Process(ProcessId::ToolGrip), 2, 6, 6),
];

/// Characters with their emphasis.
struct Grid(Vec<Vec<(char, Tone, bool)>>);

impl Grid {
    fn put(&mut self, x: usize, y: usize, text: &str, tone: Tone, chosen: bool) {
        let Some(row) = self.0.get_mut(y) else { return };
        for (cell, sign) in row.iter_mut().skip(x).zip(text.chars()) {
            *cell = (sign, tone, chosen);
        }
    }

    fn lines(self, look: Look) -> Vec<Line<'static>> {
        let line = |row: Vec<(char, Tone, bool)>| {
            let runs = row.chunk_by(|one, other| (one.1, one.2) == (other.1, other.2));
            let spans = runs.map(|run| {
                let text: String = run.iter().map(|(sign, ..)| *sign).collect();
                let (_, tone, chosen) = run.first().copied().unwrap_or_default();
                let style = look.style(tone);
                let style = if chosen { style.add_modifier(Modifier::REVERSED) } else { style };
                Span::styled(look.signs(text), style)
            });
            Line::from(spans.collect::<Vec<_>>())
        };
        self.0.into_iter().map(line).collect()
    }
}

/// Draw the boxes, with a mark on that of the process under the cursor.
pub fn lines(ladder: &[ladder::Line], chosen: ProcessId, look: Look, width: usize) -> Vec<Line<'static>> {
    let mut grid = Grid(vec![vec![(' ', Tone::Plain, false); width]; LINES]);
    for (item, column, row, left) in PLACES {
        let Some(line) = ladder.iter().find(|line| line.item == item) else { continue };
        let (x, y) = (column * (WIDTH + GAP), row * HEIGHT);
        draw(&mut grid, (x, y), line, item == Item::Process(chosen));
        if column > 0 {
            connect(&mut grid, x, y + 1, left * HEIGHT + 1);
        } else if row > 0 {
            grid.put(x + JOINT, y, "┴", Tone::Plain, false);
            grid.put(x + JOINT, y - 1, "┬", Tone::Plain, false);
        }
    }
    grid.lines(look)
}

fn draw(grid: &mut Grid, (x, y): (usize, usize), line: &ladder::Line, chosen: bool) {
    let inside = WIDTH - 2;
    let mark = match (line.mark.trouble, line.mark.on, line.mark.absent, line.mark.changed) {
        (true, ..) => "!!",
        (_, true, ..) => "* ",
        (_, _, true, _) => "- ",
        (.., true) => "> ",
        _ => "",
    };
    let cause = if line.mark.cause { " <= CAUSE" } else { "" };
    // The line to the box above begins after the name.
    let name = fit(&format!("{mark}{}{cause}", line.name), JOINT - 4);
    let title = format!("─ {} ", name.trim_end());
    let border = format!("┌{title}{}┐", "─".repeat(inside.saturating_sub(title.chars().count())));
    let numbered = |text: &str, number: Option<u32>| {
        let number = number.map_or_else(String::new, |number| number.to_string());
        format!("│{} {number:>5}│", fit(text, inside - 6))
    };
    let said =
        if line.item == Item::Robot { line.status.clone() } else { format!("{}  {}", line.status, line.row) };
    let tone = line.mark.tone();
    grid.put(x, y, &border, tone, chosen);
    grid.put(x, y + 1, &numbered(&line.command, line.number), tone, chosen);
    grid.put(x, y + 2, &numbered(&said, line.echo), tone, chosen);
    grid.put(x, y + 3, &format!("└{}┘", "─".repeat(inside)), tone, chosen);
}

/// Draw a line from the left box to the one at `x`.
fn connect(grid: &mut Grid, x: usize, y: usize, from: usize) {
    let gap = x - GAP;
    let (top, bottom) = (y.min(from), y.max(from));
    for at in top..=bottom {
        let sign = if at == from || at == y { "├" } else { "│" };
        grid.put(gap, at, sign, Tone::Plain, false);
    }
    grid.put(gap, from, if top == bottom { "─" } else { "┤" }, Tone::Plain, false);
    grid.put(gap + 1, y, "─", Tone::Plain, false);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_box_stands_on_another_and_all_fit() {
        let places: Vec<_> = PLACES.iter().map(|(_, column, row, _)| (*column, *row)).collect();
        for (at, place) in places.iter().enumerate() {
            assert!(!places[..at].contains(place), "{place:?}");
            assert!(place.0 * (WIDTH + GAP) + WIDTH <= LEAST.0 && place.1 * HEIGHT < LINES);
        }
    }
}
