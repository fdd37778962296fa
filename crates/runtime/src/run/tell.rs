//! Sends information to the log, the viewers and the operators of a run.

use closed_loop::{
    Settled,
    account::{self, Kind},
    failure::Failure,
    field::Field,
};
use interfaces::CommonMemory;
use neighbours::{data_system::DataSystem, workstation::player::Hwsc};
use plant::{CellEvent, t3::RobotEvent};
use rcs_core::tick::Tick;
use record::journal::{self, HEARTBEAT};

use super::Run;
use crate::{
    config::ClockKind,
    egm::EgmPort,
    event::Event,
    field::view_of_run,
    live::Live,
    resume,
    views::{ViewContext, commander, job_state},
};

impl Run {
    pub(crate) fn log_event(&mut self, tick: Tick, event: &Event) {
        self.observer.event(tick, event);
        if let Some(log) = &mut self.log {
            log.event(tick, event);
        }
    }

    pub(super) fn show_cell(&mut self) {
        let tick = self.closed.tick().next();
        let Some(log) = &mut self.log else { return self.fresh.clear() };
        for event in self.fresh.drain(..) {
            log.event(tick, &event);
        }
        if let Some(counts) = self.closed.line().faults() {
            log.faults(tick, counts);
        }
        let (cell, check) = (&self.closed.workstation.cell, self.closed.contacts());
        log.contacts(tick, cell.contacts(), |contact| check.is_collision(contact));
        log.cell(tick, cell, self.robot.egm().map(EgmPort::frames));
        self.show_state();
    }

    pub(super) fn show_state(&mut self) {
        let Some(log) = &mut self.log else { return };
        let tick = self.closed.tick();
        let around = ViewContext {
            tick,
            memory: self.closed.memory(),
            neighbours: &self.neighbours,
            operator: &self.operator,
            job: &self.job.name,
            played: self.loads.played,
            waits: self.waits.as_ref(),
            cell: &self.closed.workstation.cell,
            has_controller: !self.robot.is_elsewhere(),
            warning: self.warning.as_ref(),
            field: self.closed.workstation.field.as_deref().map(Field::desk),
        };
        self.viewed.look(&around, |view| log.view(tick.next(), view));
    }

    /// Publish the cell after a tick to other programs. A run with a robot at a port publishes none.
    pub(super) fn publish_cell(&mut self, tick: Tick) {
        if self.robot.is_elsewhere() {
            return;
        }
        let (cell, memory) = (&self.closed.workstation.cell, self.closed.memory());
        let sank = |event: &Event| matches!(event, Event::Cell(CellEvent::Robot(RobotEvent::Sinks(_))));
        let robot = (cell, self.warning.as_ref(), self.fresh.iter().any(sank));
        let (neighbours, operator, waits) = (&self.neighbours, &self.operator, self.waits.as_ref());
        self.runner.show_cell(|| {
            let (job, by) = (job_state(neighbours, waits), commander(neighbours, operator, memory));
            self.view.look(tick, robot, (&job, &by), &self.pace)
        });
    }

    /// Publish the couplers and their points after a tick to other programs.
    pub(super) fn publish_field(&mut self, tick: Tick) {
        // The words of the couplers are newer than the inputs of this tick.
        let inputs = self.closed.inputs();
        if let Some(desk) = self.closed.workstation.field.as_deref().map(Field::desk) {
            self.runner.show_field(|| view_of_run(tick, desk, inputs));
        }
    }

    /// The end of a command shows that the cause of an earlier stop is gone.
    pub(super) fn note_work(&mut self, tick: Tick, memory: &CommonMemory) {
        let before = std::mem::replace(&mut self.task, memory.task.status);
        if account::has_worked(&before, &memory.task.status) {
            self.alarms.worked(tick);
        }
    }

    pub(super) fn watch_link(&mut self, tick: Tick, memory: &CommonMemory) {
        if memory.t3i.status.link_running {
            (self.first_silence_limit, self.is_unreported) = (None, false);
        }
        let before = std::mem::replace(&mut self.trouble, memory.t3i.status.trouble());
        if let Some(trouble) = self.trouble.filter(|_| self.trouble != before) {
            self.observer.message(&format!("{tick}: {trouble}"));
            let event = Event::Link(trouble);
            self.observer.event(tick, &event);
            self.events.push(tick, &event);
        }
    }

    /// If the job has begun to wait, report it to operators, terminal and log.
    pub(super) fn publish_news(&mut self, tick: Tick) {
        let Some(reason) = self.neighbours.operator_news() else { return };
        self.waits = Some(reason.clone());
        let event = Event::Waits(reason);
        self.observer.message(&format!("tick {tick}: {event}"));
        self.log_event(tick.next(), &event);
        self.events.push(tick, &event);
    }

    /// Collect the events of the cell in a tick, for log, result and verdict.
    pub(super) fn observe(&mut self, tick: Tick, settled: Settled) {
        let Settled { events, contacts, untrue, field } = settled;
        let shown = |event: &CellEvent| matches!(event, CellEvent::Warning(_)).then(|| event.to_string());
        let controller = |text| Some(Failure::outside(tick, Kind::RobotController, "T3", text));
        if let Some(warning) = events.iter().find_map(shown) {
            self.warning = controller(warning);
        }
        self.fresh = events.into_iter().map(Event::Cell).collect();
        if let Some(event) = self.robot.news().map(Event::RobotRefuses) {
            self.warning = controller(event.to_string());
            self.fresh.push(event);
        }
        self.fresh.extend(contacts.into_iter().map(Event::Contact));
        for event in field.into_iter().map(Event::Field) {
            self.observer.message(&format!("tick {tick}: {event}"));
            self.fresh.push(event);
        }
        for event in untrue.into_iter().map(Event::Untrue) {
            self.observer.message(&format!("tick {tick}: {event}"));
            self.fresh.push(event);
        }
        for event in &self.fresh {
            // Contacts and false reports have their own judges, and a warning matters only if it explains a failure.
            let kind = Kind::of_code(event.code());
            let is_alarm =
                matches!(kind, Some(Kind::EmergencyStop | Kind::Power | Kind::Lost | Kind::Device));
            // The end of a coupler's trouble is not an alarm; it withdraws one.
            if is_alarm || matches!(event, Event::Field(_)) {
                self.alarms.line(tick.next(), event.source(), event.code(), &event.to_string());
            }
            self.observer.event(tick, event);
            self.events.push(tick, event);
        }
    }

    /// Hand the knowledge after a tick to the journal, and report its trouble.
    pub(super) fn write_journal(&mut self, tick: Tick) {
        let Some(journal) = &mut self.journal else { return };
        let clock = if self.config.clock == ClockKind::Real { resume::now() } else { 0 };
        let entry = resume::entry(&self.closed, self.neighbours.job(), clock);
        journal.tick(&entry);
        // A robot elsewhere continues without this program, so the model of the other devices must be up to date.
        let causes = resume::causes(&entry);
        let is_changed = self.robot.is_elsewhere() && causes != self.saved;
        if (is_changed || tick.0.is_multiple_of(HEARTBEAT))
            && let Ok(saved) = self.closed.workstation.cell.save()
        {
            journal.save_cell(journal::cell(&entry, &saved));
            self.saved = causes;
        }
        if let Some(trouble) = journal.trouble() {
            if let Some(announced) = self.announced.as_ref().filter(|_| self.ramp.is_none()) {
                let not_written = |why| format!("runs; its journal is not written: {why}");
                announced.say(&trouble.as_ref().map_or_else(|| "runs".to_owned(), not_written));
            }
            self.journal_trouble.clone_from(&trouble);
            let event = Event::Journal(trouble);
            self.observer.message(&format!("tick {tick}: {event}"));
            self.log_event(tick.next(), &event);
            self.events.push(tick, &event);
        }
    }

    /// Until the job of a resumed run continues, report each estimate that the sensors contradict.
    pub(super) fn tell_contradictions(&mut self, tick: Tick) {
        let Some(contradictions) = &mut self.contradictions else { return };
        if !self.neighbours.job().is_some_and(Hwsc::waits_idle) {
            self.contradictions = None;
            return;
        }
        for text in contradictions.look(self.closed.memory()) {
            let event = Event::Resumed(text);
            self.observer.message(&format!("tick {tick}: {event}"));
            self.log_event(tick.next(), &event);
            self.events.push(tick, &event);
        }
    }

    pub(super) fn note_viewers(&mut self, tick: Tick) {
        while let Some(why) = self.live.as_ref().and_then(Live::disconnected) {
            let event = Event::ViewerDisconnected(why);
            self.observer.message(&format!("tick {tick}: {event}"));
            self.log_event(tick.next(), &event);
        }
    }

    /// Report remarks of neighbours outside their mailboxes as events; Task reads only their statuses.
    pub(super) fn note_neighbours(&mut self, tick: Tick) {
        let refusals = self.closed.books_mut().map(DataSystem::refusals).unwrap_or_default();
        let refusals = refusals.into_iter().map(Event::DataBaseRefuses);
        for event in refusals.chain(self.neighbours.events()) {
            self.log_event(tick, &event);
            self.events.push(tick, &event);
        }
    }
}
