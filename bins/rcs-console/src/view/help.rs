//! The help page.

use ratatui::text::Line;

use super::Look;
use crate::rcs_console::model::Tone;

/// The keys and their effects.
const KEYS: [(&str, &str); 16] = [
    ("1 ... 7", "screens: ladder, process, link, cell, terminal, panels, procedures"),
    ("j k, arrows, PgUp PgDn", "choose a process; scroll"),
    ("Enter, Esc", "the process under the cursor; back to the ladder"),
    ("Tab, w, v, s", "screen 2: pane, watch, what is watched, source; v on 4: drawing"),
    ("/", "show only lines with a text; Esc shows all again"),
    ("p", "freeze the picture; the run goes on"),
    ("[ ]  { }  Home End", "a tick, a second, first and last tick"),
    ("g", "go to a tick by its number"),
    ("n N", "next, previous change; on screen 2 of that process"),
    ("t T", "next, previous trouble: a failure or a warning"),
    ("c", "to the first cause of the last failure"),
    ("a", "acknowledge the alarm in the line above the keys"),
    ("o", "open the log of this run, at the first cause"),
    ("Enter y s u r", "on screen 7: do a step, it is so, leave out, take back, anew"),
    (":, Tab; Space h F1", "screen 5: a line, board; --operate: stop, hold, E-stop"),
    ("q, Control-C", "quit; the run is not affected"),
];

/// The marks and their meaning.
const MARKS: &str = " !! trouble   * gripper on the robot   - not stepped, or lost   > new";

/// The lines of the page.
pub fn lines(look: Look) -> Vec<Line<'static>> {
    let keys = KEYS.iter().map(|(key, does)| look.line(Tone::Plain, format!(" {key:<24} {does}")));
    let words = [
        MARKS,
        " A row with seconds behind it fired that long ago; ~ marks a row that nearly fired.",
        " Without --operate this program only reads: no key changes the run.",
    ];
    keys.chain(words.map(|text| look.line(Tone::Plain, text))).collect()
}
