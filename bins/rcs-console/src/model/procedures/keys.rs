use super::{Mark, Sight, Track};
use crate::rcs_console::{
    model::{Key, Model, Prompt},
    source::Source,
};

const PAGE: usize = 8;

impl Model {
    pub(in crate::rcs_console::model) fn work_a_procedure(&mut self, key: Key, source: &dyn Source) -> bool {
        if !self.procedures.is_open {
            return self.choose_a_procedure(key);
        }
        let Some(track) = self.procedures.open() else { return false };
        match key {
            Key::Esc => self.procedures.is_open = false,
            Key::Char('j') | Key::Down => track.move_to(track.cursor + 1),
            Key::Char('k') | Key::Up => track.move_to(track.cursor.saturating_sub(1)),
            Key::PageDown => track.move_to(track.cursor + PAGE),
            Key::PageUp => track.move_to(track.cursor.saturating_sub(PAGE)),
            Key::Char('u') => track.take_back(),
            Key::Char('r') => self.procedures.restart(),
            Key::Char('s') => self.prompt = Some(Prompt::Reason(String::new())),
            Key::Char('y') => self.say(source),
            Key::Enter => self.do_a_step(source),
            _ => return false,
        }
        true
    }

    fn choose_a_procedure(&mut self, key: Key) -> bool {
        let (procedures, last) = (&mut self.procedures, super::ALL.len() - 1);
        match key {
            Key::Char('j') | Key::Down => procedures.cursor = (procedures.cursor + 1).min(last),
            Key::Char('k') | Key::Up => procedures.cursor = procedures.cursor.saturating_sub(1),
            Key::PageDown => procedures.cursor = (procedures.cursor + PAGE).min(last),
            Key::PageUp => procedures.cursor = procedures.cursor.saturating_sub(PAGE),
            Key::Enter => procedures.is_open = true,
            _ => return false,
        }
        true
    }

    fn say(&mut self, source: &dyn Source) {
        let Some(picture) = &self.picture else { return };
        let cell = source.cell(picture.tick.0);
        let Some(track) = self.procedures.open() else { return };
        let (Some(step), begun) = (track.step(), track.begun) else { return };
        let sight = Sight { picture, cell: &cell, operating: self.operating.as_ref(), begun };
        if !step.needs_a_word(&sight) {
            self.answer = Some("the console checks this itself; s skips the step".to_owned());
            return;
        }
        let note = note(track, "done");
        track.mark(Mark::Said(picture.tick));
        self.note(note);
    }

    pub(in crate::rcs_console::model) fn leave_out(&mut self, reason: String) {
        let tick = self.picture.as_ref().map_or_else(Default::default, |picture| picture.tick);
        let Some(track) = self.procedures.open() else { return };
        if reason.trim().is_empty() {
            self.answer = Some("a step is left out for a reason: type it".to_owned());
            return;
        }
        let note = note(track, &format!("left out, {}", reason.trim()));
        track.mark(Mark::Skipped(tick, reason.trim().to_owned()));
        self.note(note);
    }

    /// Write a note about the operator's statement to the log of the run, if the run accepts it.
    fn note(&mut self, text: String) {
        if let Some(operating) = &mut self.operating {
            operating.ask(format!("note {text}"));
        }
    }

    fn do_a_step(&mut self, source: &dyn Source) {
        let Some(picture) = &self.picture else { return };
        let cell = source.cell(picture.tick.0);
        let Some(track) = self.procedures.open() else { return };
        let Some(step) = track.step() else { return };
        let Some(operating) = self.operating.as_mut().filter(|operating| operating.lost.is_none()) else {
            self.answer = Some("this console is read-only: start it with --operate to do a step".to_owned());
            return;
        };
        if step.ask.is_empty() {
            self.answer = Some("this step has no request: do it at the machine".to_owned());
        } else if !step.warning.is_empty() && !track.is_warned {
            track.is_warned = true;
            self.answer = Some(format!("WARNING: {}; Enter again confirms", step.warning));
        } else {
            let sight = Sight { picture, cell: &cell, operating: None, begun: track.begun };
            track.ask(&sight, operating.newest()).into_iter().for_each(|line| operating.ask(line));
        }
    }
}

fn note(track: &Track, what: &str) -> String {
    let step = track.step().map_or(("", ""), |step| (step.id, step.text));
    format!("{} {}: {}: {what}", track.procedure.section, step.0, step.1)
}
