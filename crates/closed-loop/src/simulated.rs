//! The simulated cell as a world: its line, and the judges of contacts, places and confirmations.

use std::sync::Arc;

use couplers::{Orders, Report};
use depc::Plate;
use interfaces::{DeviceInputs, DeviceOutputs, device::LinkBytes};
use plant::{Cell, CellEvent};
use rcs_core::tick::Tick;
use taskdata::load::{Store, job::Reload};

use crate::{
    ClosedLoop, RobotLine, Turn, World,
    contacts::{Commands, ContactCheck, ContactEvent},
    field::{Field, FieldController, FieldEvent},
    truth::{Confirmation, Scene, TruthCheck, placement::PlacementCheck},
    workstation::SimulatedWorkstation,
};

#[derive(Debug, Default)]
pub struct Settled {
    /// Events of the cell, without permitted contacts; forbidden ones are in `contacts`.
    pub events: Vec<CellEvent>,
    pub contacts: Vec<ContactEvent>, // collisions that have begun or ended
    pub untrue: Vec<Confirmation>,   // false confirmations
    pub field: Vec<FieldEvent>,      // events of the couplers between controller and cell
}

#[derive(Clone)]
pub struct Checks {
    line: RobotLine,
    contacts: ContactCheck,
    placement: PlacementCheck,
    truth: TruthCheck,
}

impl World for SimulatedWorkstation {
    type Checks = Checks;
    type Settled = Settled;

    fn checks(&self) -> Checks {
        let description = self.cell.description();
        Checks {
            line: RobotLine::default(),
            contacts: ContactCheck::new(description.contact.clone()),
            placement: PlacementCheck::new(description),
            truth: TruthCheck::default(),
        }
    }

    fn inputs(&self) -> DeviceInputs {
        let mut inputs = self.cell.inputs();
        if let Some(field) = &self.field {
            field.desk().apply(&mut inputs);
        }
        inputs
    }

    fn settle(&mut self, checks: &mut Checks, turn: &Turn<'_>) -> (DeviceInputs, Settled) {
        let &Turn { tick, hws, memory, data, outputs, moved } = turn;
        let commands = checks.contacts.commands(memory);
        if let Some(field) = self.field.as_deref_mut() {
            field.desk_mut().note_commands(memory);
        }
        let (inputs, mut settled) = advance(self, checks, tick, commands, outputs, moved);
        let Checks { placement, truth, .. } = checks;
        placement.look(tick, hws, &memory.task.status, self.cell.description(), &self.cell.parts());
        if self.is_whole() {
            truth.note_delivered(tick, self.delivered());
            settled.untrue = truth.look(&Scene { tick, hws, memory, data, cell: &self.cell });
        }
        (inputs, settled)
    }

    fn loads(&mut self) -> Vec<u32> {
        self.take_loads()
    }
}

fn advance(
    workstation: &mut SimulatedWorkstation,
    Checks { line, contacts, .. }: &mut Checks,
    tick: Tick,
    commands: Commands,
    outputs: &DeviceOutputs,
    moved: Option<&Plate>,
) -> (DeviceInputs, Settled) {
    let is_elsewhere = workstation.is_robot_elsewhere();
    let cell = &mut workstation.cell;
    let mut outputs = *outputs;
    if let Some(Field::Simulated(field)) = workstation.field.as_deref_mut() {
        outputs = field.write(tick, &outputs, |device| cell.is_device_cut(device));
        field.move_devices(cell);
    }
    let mut inputs = match is_elsewhere {
        true => cell.step_following(moved, &outputs),
        false => line.advance(tick, cell, &outputs),
    };
    match workstation.field.as_deref_mut() {
        Some(Field::Simulated(field)) => {
            field.sense_devices(&workstation.cell);
            inputs = field.read(tick, &inputs);
        }
        Some(Field::External(desk)) => {
            desk.apply(&mut inputs);
            desk.note_changes(&inputs);
        }
        None => {}
    }
    let mut events = workstation.events(tick);
    // The check selects the contacts that are events.
    events.retain(|event| !matches!(event, CellEvent::Contact(_)));
    let begun = contacts.look(tick, workstation.cell.contacts(), commands);
    workstation.cell.watch_clearance(contacts.margin());
    let field = workstation.field.as_mut().map(|field| field.desk_mut().take_events()).unwrap_or_default();
    (inputs, Settled { events, contacts: begun, untrue: Vec::new(), field })
}

impl<L> ClosedLoop<L> {
    #[must_use]
    pub fn new(levels: L, store: Arc<Store>, reloads: Arc<Vec<Reload>>, cell: Cell) -> Self {
        Self::in_world(levels, store, reloads, SimulatedWorkstation::new(cell))
    }

    #[must_use]
    pub fn with_field(mut self, field: Field) -> Self {
        self.workstation.field = Some(Box::new(field));
        self.inputs = self.workstation.inputs();
        self
    }

    /// Orders of the last tick, in the order of the devices. Does not allocate.
    pub fn coupler_orders(&mut self) -> impl Iterator<Item = &Orders> {
        let (tick, outputs) = (self.course.tick(), self.outputs());
        let memory = self.course.memory();
        let desk = match self.workstation.field.as_deref_mut() {
            Some(Field::External(desk)) => {
                desk.note_commands(memory);
                desk.order(tick, &outputs);
                Some(&*desk)
            }
            _ => None,
        };
        desk.into_iter().flat_map(FieldController::orders)
    }

    /// The reports of the couplers at `now`, ns, determine the inputs of the tick. Does not allocate.
    pub fn observe_couplers(&mut self, now: u64, reports: impl Iterator<Item = Report>) {
        if let Some(Field::External(desk)) = self.workstation.field.as_deref_mut() {
            desk.observe(now, reports);
            desk.apply(&mut self.inputs);
        }
    }

    /// Skip the distances to objects that the robot does not touch, which saves time.
    #[must_use]
    pub fn without_near_misses(mut self) -> Self {
        self.checks.contacts = self.checks.contacts.without_near_misses();
        self
    }

    /// Advance the cell in `tick` without the controller: the robot gets no frame, and the valves keep their state.
    pub fn coast(&mut self, tick: Tick, moved: Option<&Plate>) -> Settled {
        let outputs = DeviceOutputs { link_tx: LinkBytes::default(), ..self.memory().device_outputs() };
        let Self { course, workstation, checks, .. } = self;
        let commands = checks.contacts.commands(course.memory());
        let settled;
        (self.inputs, settled) = advance(workstation, checks, tick, commands, &outputs, moved);
        settled
    }

    /// Attributes contacts to the command in the buffers. The present contacts are not reported again.
    pub fn note_resumed(&mut self) {
        let contacts = &mut self.checks.contacts;
        contacts.commands(self.course.memory());
        contacts.permit(self.workstation.cell.contacts());
    }

    /// Note that an operator has changed these parts after the last tick.
    pub fn note_changed(&mut self, parts: Vec<u32>) {
        self.checks.truth.note_changed(self.course.tick().next(), parts);
    }

    #[must_use]
    pub const fn line(&self) -> &RobotLine {
        &self.checks.line
    }

    pub const fn line_mut(&mut self) -> &mut RobotLine {
        &mut self.checks.line
    }

    #[must_use]
    pub const fn contacts(&self) -> &ContactCheck {
        &self.checks.contacts
    }

    #[must_use]
    pub const fn placement(&self) -> &PlacementCheck {
        &self.checks.placement
    }

    #[must_use]
    pub const fn truth(&self) -> &TruthCheck {
        &self.checks.truth
    }
}
