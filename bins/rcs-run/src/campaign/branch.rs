//! A run that can be forked: a [`ClosedLoop`], the mailbox of its commander, and what happened in its last tick.
//!
//! A tick of a [`Branch`] is one of `rcs-run run` with the fast clock and the simulated robot, with the same digest.
//! Any number of copies can continue from a state.

use std::{
    fmt::{self, Write as _},
    sync::Arc,
};

use closed_loop::{
    ClosedLoop, CommandBox, Commander, Present, Settled,
    field::{Field, FieldEvent, SimulatedField},
    truth::Confirmation,
};
use field::Mapping;
use interfaces::{CommonMemory, HwsCommand};
use levels::ladder::LadderState;
use neighbours::data_system::Item;
use plant::{Cell, CellDescription, CellEvent};
use rcs_core::{Plain as _, digest::Digest, tick::Tick};
use runtime::StartError;
use taskdata::load::{Job, Store, job::Reload};

use super::past;
use crate::rcs_run::error::Error;

/// The data that all branches of a campaign share.
pub struct Facility {
    pub store: Arc<Store>,
    pub job: Job,
    /// The task data after each `** load` of the job.
    pub reloads: Arc<Vec<Reload>>,
    pub description: CellDescription,
    pub seed: u64,
    /// The emulated couplers between controller and cell, if any.
    pub mapping: Option<Arc<Mapping>>,
}

impl Facility {
    #[must_use]
    pub fn new(store: Store, mut job: Job, description: CellDescription, seed: u64) -> Self {
        let reloads = Arc::new(std::mem::take(&mut job.reloads));
        Self { store: Arc::new(store), job, reloads, description, seed, mapping: None }
    }

    #[must_use]
    pub fn with_mapping(self, mapping: Option<Mapping>) -> Self {
        Self { mapping: mapping.map(Arc::new), ..self }
    }
}

/// A run between two ticks. Each copy continues from the same state.
#[derive(Clone)]
pub struct Branch<'f> {
    facility: &'f Facility,
    pub closed: ClosedLoop,
    command_box: CommandBox,
    pub events: Vec<CellEvent>,
    pub untrue: Vec<Confirmation>,
    pub field_events: Vec<FieldEvent>,
}

impl<'f> Branch<'f> {
    /// The run before its first tick. Fails with [`Error`] if the cell cannot be built.
    pub fn start(facility: &'f Facility) -> Result<Self, Error> {
        let cell = Cell::new(&facility.description, facility.seed).map_err(StartError::from)?;
        let (store, reloads) = (Arc::clone(&facility.store), Arc::clone(&facility.reloads));
        let field = facility.mapping.as_ref().map(|mapping| {
            SimulatedField::of_cell(Arc::clone(mapping), &facility.description, &cell).map(Field::Simulated)
        });
        let field = field.transpose().map_err(StartError::from)?;
        let closed = ClosedLoop::new(Present::default(), store, reloads, cell).without_near_misses();
        Ok(Self {
            facility,
            closed: match field {
                Some(field) => closed.with_field(field),
                None => closed,
            },
            command_box: CommandBox::default(),
            events: Vec::new(),
            untrue: Vec::new(),
            field_events: Vec::new(),
        })
    }

    pub fn step(&mut self, commander: &mut impl Commander) {
        let (Settled { events, untrue, field, .. }, _) = self.closed.step(&mut self.command_box, commander);
        (self.events, self.untrue, self.field_events) = (events, untrue, field);
    }

    /// The emulated couplers, if any.
    #[must_use]
    pub fn field(&self) -> Option<&SimulatedField> {
        match self.closed.workstation.field.as_deref() {
            Some(Field::Simulated(field)) => Some(field),
            Some(Field::External(_)) | None => None,
        }
    }

    pub fn field_mut(&mut self) -> Option<&mut SimulatedField> {
        match self.closed.workstation.field.as_deref_mut() {
            Some(Field::Simulated(field)) => Some(field),
            Some(Field::External(_)) | None => None,
        }
    }

    #[must_use]
    pub const fn at(&self) -> Tick {
        self.closed.tick()
    }

    #[must_use]
    pub const fn memory(&self) -> &CommonMemory {
        self.closed.memory()
    }

    #[must_use]
    pub fn ladder(&self) -> LadderState {
        self.closed.course().levels().ladder().state()
    }

    #[must_use]
    pub const fn judged(&self) -> u64 {
        self.closed.truth().result().judged
    }

    pub fn items(&mut self) -> Result<Vec<Item>, String> {
        self.closed.books_mut().map_or(Ok(Vec::new()), |books| books.items())
    }

    /// Discard the faults of cell and line that are over. Call it only if no others follow.
    pub fn forget_past_faults(&mut self) {
        let now = self.at();
        self.closed.workstation.cell.forget_past_faults();
        self.closed.line_mut().forget_past(now);
    }

    /// Digest of `beside` and of all state on which the next ticks depend, without the past ([`past`]).
    pub fn state(&self, beside: &impl fmt::Debug) -> Result<Digest, Error> {
        let Self { closed, command_box, .. } = self;
        let cell = closed.workstation.cell.save().map_err(|error| Error::Fork(error.to_string()))?;
        let (gate, levels) = (closed.gate(), closed.course().levels());
        let (mut memory, mut ladder) = (*closed.memory(), self.ladder());
        let command = gate.command();
        past::forget(&mut memory, &mut ladder, self.at());
        for echo in [&mut memory.task.status.echo, &mut ladder.task.execution.receiver.echo] {
            *echo = echo.wrapping_sub(command.number);
        }
        let mut digest = Digest::new();
        digest.add(&cell);
        let mut scratch = vec![0; CommonMemory::SIZE.max(LadderState::SIZE)];
        digest.add_record(&memory, &mut scratch);
        digest.add_record(&ladder, &mut scratch);
        digest.add_record(closed.inputs(), &mut scratch);
        let command = HwsCommand { number: 0, ..*command };
        let mailboxes =
            (command, gate.refused(), gate.unread(command_box.mailbox()), closed.line(), levels.processes());
        let books = closed.books().map(|books| books.state(self.at()));
        let data = (closed.generations().state(), books);
        let all = (mailboxes, data, closed.contacts().state(), closed.workstation.state(), beside);
        let _ = write!(Text(&mut digest), "{all:?}");
        Ok(digest)
    }

    #[must_use]
    pub const fn facility(&self) -> &'f Facility {
        self.facility
    }
}

struct Text<'d>(&'d mut Digest);

impl fmt::Write for Text<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0.add(text.as_bytes());
        Ok(())
    }
}
