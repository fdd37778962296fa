//! The line of keys at the bottom.

use crate::rcs_console::{
    model::{Model, Prompt, Screen, terminal::editor::Editor},
    source::State,
};

use super::text::fit;

/// The keys of the present screen. While this console operates a run, the keys that stop the robot come first.
pub fn line(model: &Model, state: State, width: usize) -> String {
    let takes_requests = model.operates() && !matches!(state, State::Over | State::Log);
    let is_typing =
        model.prompt.is_some() || model.terminal.editor.is_some() && model.screen == Screen::Terminal;
    let stops: &[&str] = match (takes_requests, is_typing) {
        (false, _) => &[],
        (true, true) => &["F1=E-stop", "Esc, Space=stop"],
        (true, false) if model.joystick().velocity == 0 => &["Space=GO", "F1=E-stop"],
        (true, false) => &["Space=stop", "F1=E-stop"],
    };
    let mut line = String::new();
    for key in stops.iter().chain(keys(model, state, takes_requests)) {
        if line.chars().count() + 2 + key.chars().count() < width {
            let gap = if line.is_empty() { " " } else { "  " };
            line = line + gap + key;
        }
    }
    fit(&line, width)
}

/// The keys of a screen, the most important first.
fn keys(model: &Model, state: State, takes_requests: bool) -> &'static [&'static str] {
    if model.help {
        return &["any other key goes back"];
    }
    if model.taking_over().is_some() {
        return &["Enter=wait", "P=PAUSE now", "Esc=no", "h=hold Prim"];
    }
    match (&model.prompt, &model.terminal.editor) {
        (Some(Prompt::Request(_)), _) => return &["Enter=send", "Tab=complete", "Up Down=earlier"],
        (Some(_), _) => return &["Enter", "Esc"],
        (None, Some(editor)) if model.screen == Screen::Terminal => {
            return if Editor::shows_change(editor) {
                &["Enter=write and load it", "Esc=back to the text"]
            } else {
                &["arrows, letters=edit", "F2=check, show the change", "Esc=leave it as it was"]
            };
        }
        (None, _) => {}
    }
    match (model.screen, takes_requests) {
        (Screen::Ladder, _) => match state {
            State::Over => &["o=log at the cause", "Enter=process", "j k=choose", "q=quit"],
            State::Log => {
                &["c=cause", "Enter=process", "j k=choose", "[ ] { }=tick, second", "t=trouble", "n=change"]
            }
            _ => &["Enter=process", "j k=choose", ":=request", "p=freeze", "a=ack", "[ ]=tick", "t=trouble"],
        },
        (Screen::Process, _) => &[
            "Esc=back",
            "Tab=pane",
            "j k=scroll",
            "[ ]=tick",
            "n N=change",
            "/=filter",
            "s=source",
            "w v=watch",
        ],
        (Screen::Terminal, true) => &["letters, :=a line", "^C=stop board", "Tab=board", "Esc=back"],
        (Screen::Terminal, false) => &["Esc=back", ":=words", "Tab=board", "j k=scroll"],
        (Screen::Panels, true) => &["j k Enter=keys", "- +=knob", "s=jog", ":=request", "Esc=back"],
        (Screen::Panels, false) => &["Esc=back"],
        (Screen::Procedures, _) if !model.procedures.is_open => &["j k=choose", "Enter=open", "Esc=back"],
        (Screen::Procedures, true) => {
            &["Enter=do it", "y=confirm", "s=leave out", "Esc=list", "u=take back", "r=again"]
        }
        (Screen::Procedures, false) => {
            &["Esc=list", "j k=step", "y=confirm", "s=leave out", "u=take back", "r=again"]
        }
        (Screen::Cell, _) => {
            &["Esc=back", "v=drawing, values", "j k=scroll", "[ ] { }=tick, second", "t c", "n=change"]
        }
        (Screen::Link, _) => {
            &["Esc=back", "v=points", "j k=scroll", "[ ] { }=tick, second", "c=cause", "t n", "g=tick"]
        }
        (Screen::Points, _) => {
            &["Esc=back", "v=link", "/=names", "j k=scroll", "[ ] { }=tick, second", "t=trouble", "g=tick"]
        }
    }
}
