use ratatui::text::Line;

use super::Look;
use crate::rcs_console::model::{Model, Tone};

/// Keys of every console, and their effects.
const KEYS: [(&str, &str); 10] = [
    ("1 ... 7", "screens, from every screen; 2: the process at the cursor"),
    ("j k, arrows", "choose, scroll; PgUp PgDn by a page; Enter opens, Esc goes back"),
    ("[ ]  { }  g", "one tick, one second back or forward; a tick by its number"),
    ("Home End  ^L ^Z", "first tick, last tick; draw again; suspend until `fg`"),
    ("n N   t T", "next, previous change (on 2: of it); next, previous failure"),
    ("c   o", "first cause of the failure; log of an ended run at its cause"),
    ("p   a", "freeze the picture, the run continues; acknowledge the alarm"),
    ("on 2", "Tab=pane  /=filter  s=source  w=watch a field  v=watched fields"),
    ("on 3", "v=the points of field I/O and their couplers; /=filter"),
    ("on 4, 7", "v=drawing; Enter=do y=confirm s=leave out u=take back r=again"),
];
const OPERATOR: [(&str, &str); 5] = [
    ("Space", "velocity knob to 0: the robot ramps to rest; again: back"),
    ("h", "hold Prim; again: release it (not on 5)"),
    ("F1 or !, twice", "the E-stop near the terminals: the arm sinks"),
    (":", "a request; on 5 also with a letter, and ^C stops the board"),
    ("on 6", "box, panels and all requests: their keys are listed there"),
];
const SIGNS: [&str; 2] = [
    " >> running  || paused  [] stopped  XX E-stop  !! fault  LOG [ ]: recorded",
    " !! failure  * gripper on the robot  - not stepped  > changed  ~ nearly fired",
];

pub fn lines(model: &Model, look: Look) -> Vec<Line<'static>> {
    let quit = match (model.ends_run, model.operates()) {
        (true, _) => "ENDS THE RUN: the robot ramps to rest first",
        (false, true) => "quit; the run continues, motion by hand ends",
        (false, false) => "quit; the run is not affected",
    };
    let operator =
        if model.operates() { &OPERATOR[..] } else { &[("--operate", "also stops and commands a run")] };
    let quit = ("q, ^C", quit);
    let keys = KEYS.iter().chain(operator).chain([&quit]);
    let keys = keys.map(|(key, does)| format!(" {key:<15} {does}"));
    keys.chain(SIGNS.map(str::to_owned)).map(|text| look.line(Tone::Plain, text)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rcs_console::{
        model::{Operating, Screen},
        view::{FRAME, LEAST},
    };

    #[test]
    fn help_fits_the_smallest_terminal() {
        let look = Look { colour: false, ascii: true };
        for operating in [None, Some(Operating::default())] {
            for ends_run in [false, true] {
                let model = Model { operating: operating.clone(), ends_run, ..Model::new(Screen::Ladder) };
                let lines = lines(&model, look);
                assert!(lines.len() <= usize::from(LEAST.1) - FRAME, "{} lines", lines.len());
                for line in &lines {
                    assert!(line.width() <= usize::from(LEAST.0), "{line}");
                }
                assert_eq!(ends_run, lines.iter().any(|line| line.to_string().contains("ENDS THE RUN")));
            }
        }
    }
}
