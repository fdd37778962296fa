//! What a run tells its log, its viewers and its operators.

use interfaces::CommonMemory;
use plant::CellEvent;
use rcs_core::tick::Tick;
use record::Level;

use super::Run;
use crate::{contacts::Commands, egm::EgmPort};

/// How much a line of the log about an event matters: what went wrong in the world is an error.
const fn gravity(event: &CellEvent) -> Level {
    match event {
        CellEvent::Warning(_) | CellEvent::ViseStuck => Level::Error,
        event if event.is_harm() => Level::Error,
        _ => Level::Warning,
    }
}

/// Who a line of the log about an event comes from: what was planned is told apart from what came of it.
const fn source(event: &CellEvent) -> &'static str {
    match event {
        CellEvent::FaultBegins { .. } | CellEvent::FaultEnds { .. } => "fault",
        _ => "cell",
    }
}

impl Run {
    /// Tell the log of the next tick's cell, and of what happened in it.
    pub(super) fn show_cell(&mut self) {
        let tick = self.runner.tick().next();
        let Some(log) = &mut self.log else { return self.fresh.clear() };
        for (level, source, event) in self.fresh.drain(..) {
            log.note(tick, level, source, &event);
        }
        if let Some(counts) = self.robot.faults() {
            log.faults(tick, counts);
        }
        log.contacts(tick, self.workstation.cell.contacts(), |contact| self.check.is_collision(contact));
        log.cell(tick, &self.workstation.cell, self.robot.egm().map(EgmPort::frames));
    }

    /// Show programs outside the cell as a tick has left it. A robot elsewhere has none.
    pub(super) fn publish_cell(&mut self, tick: Tick) {
        let publisher = self.runner.publisher().filter(|_| !self.robot.is_elsewhere());
        if let Some(publisher) = publisher {
            let job = (self.job.steps.len(), self.neighbours.begun_steps());
            let cell = &self.workstation.cell;
            publisher.show_cell(self.view.look(tick, cell, self.warning.as_ref(), job, &self.pace));
        }
    }

    /// Say what the line to the robot suffers, as soon as it is something else.
    pub(super) fn watch_link(&mut self, tick: Tick, memory: &CommonMemory) {
        if memory.t3i.status.link_running {
            self.first_patience = None;
        }
        let before = std::mem::replace(&mut self.trouble, memory.t3i.status.trouble());
        if let Some(trouble) = self.trouble.filter(|_| self.trouble != before) {
            self.observer.message(&format!("{tick}: {trouble}"));
            self.events.push(tick, trouble);
        }
    }

    /// The job has begun to wait: who looks at the program or its log is told, too.
    pub(super) fn tell_operators(&mut self, tick: Tick) {
        let Some(news) = self.neighbours.operator_news() else { return };
        self.observer.message(&format!("tick {tick}: {news}"));
        if let Some(log) = &mut self.log {
            log.note(tick.next(), Level::Warning, "operator", &news);
        }
        self.events.push(tick, &news);
    }

    /// What has happened in the cell in a tick, for the log, for the page and for the verdict.
    pub(super) fn observe(&mut self, tick: Tick, commands: Commands) {
        // The check decides which contacts are worth a line.
        let events = self.workstation.events(tick).into_iter();
        let events = events.filter(|event| !matches!(event, CellEvent::Contact(_)));
        let events: Vec<_> = events.collect();
        let shown = |event: &CellEvent| matches!(event, CellEvent::Warning(_)).then(|| event.to_string());
        if let Some(warning) = events.iter().find_map(shown) {
            self.warning = Some((tick, warning));
        }
        self.fresh = events.iter().map(|event| (gravity(event), source(event), event.to_string())).collect();
        let lines = self.check.look(tick, self.workstation.cell.contacts(), commands);
        self.fresh.extend(lines.into_iter().map(|line| (Level::Error, "cell", line)));
        self.workstation.cell.watch_clearance(self.check.margin());
        for (_, _, event) in &self.fresh {
            self.events.push(tick, event);
        }
    }

    /// What neighbours say beside their mailboxes is an event of the run; Task learns no more than their statuses tell.
    pub(super) fn note_neighbours(&mut self, tick: Tick) {
        for (level, source, text) in self.neighbours.notes() {
            if let Some(log) = &mut self.log {
                log.note(tick, level, source, &text);
            }
            self.events.push(tick, &text);
        }
    }
}
