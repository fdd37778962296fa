//! The pedestal's own system (II.2, IV.5): its three processes, their common memory, and its ends of the mailboxes.
//!
//! ```text
//!   command, sensor words --> | pedestal |
//!                             |  /    \  | --> statuses of pedestal, gripper and table, orders to the devices
//!                             | hand table
//! ```
//!
//! A step is a tick of the controller: the pedestal runs once per received pulse, with its own cycle count. When it
//! connects, it adopts the number of the command in the mailbox without executing it (IX.1: numbers are synchronized),
//! and reports *restarted* for it, because the command may have been abandoned while the connection was down. A newly
//! started pedestal distinguishes two cases by the number:
//!
//! | command number | meaning                                   | hand and table                                            |
//! |----------------|-------------------------------------------|-----------------------------------------------------------|
//! | 0              | the system is booted                      | calibrate at once (IV.5.1 steps 7 and 10)                 |
//! | another        | this one replaces one that was killed     | stay unchanged, since a part may be held, and calibrate   |
//! |                |                                           | before the first command that moves them                  |

use interfaces::{
    CommonMemory, ExternalInputs,
    grip::GripCommand,
    pedestal::{PedestalCommand, TableCommand},
    process::{Inputs, Process},
};
use levels::pedestal::{Hand, Pedestal, Table};
use rcs_core::tick::Tick;

use super::{
    cell::{OrdersLayout, SensorsLayout},
    command::{self, CommandLayout},
    gripper::GripperLayout,
    status::{Status, Verdict},
    table::TableLayout,
};
use crate::{
    layout::LayoutError,
    mailbox::{Mailbox, PEDESTAL_GRIPPER_STATUS, PEDESTAL_ORDERS, PEDESTAL_STATUS, PEDESTAL_TABLE_STATUS},
};

/// Command number for hand and table of a replacement pedestal. They have not executed the present command.
const FIRST_COMMAND: u32 = 1;

pub struct System {
    pedestal: Pedestal,
    hand: Hand,
    table: Table,
    memory: Box<CommonMemory>,
    external: Box<ExternalInputs>,
    tick: Tick,
    read: u16, // of the command mailbox, read last
    refused: Option<(Verdict, LayoutError)>,
    joining: bool, // until the number in the command mailbox is adopted
    outgoing: [Mailbox; 4],
}

impl Default for System {
    fn default() -> Self {
        let places = [PEDESTAL_STATUS, PEDESTAL_GRIPPER_STATUS, PEDESTAL_TABLE_STATUS, PEDESTAL_ORDERS];
        Self {
            pedestal: Pedestal::default(),
            hand: Hand::default(),
            table: Table::default(),
            memory: Box::default(),
            external: Box::default(),
            tick: Tick::BEFORE_START,
            read: 0,
            refused: None,
            joining: true,
            outgoing: places.map(Mailbox::initialized),
        }
    }
}

impl System {
    /// Call at a new connection: the command in the mailbox must not be executed.
    pub const fn join(&mut self) {
        (self.read, self.joining) = (0, true);
    }

    /// One tick. If the mailboxes cannot be decoded, no process is stepped, and the status has the reason.
    pub fn step(&mut self, command_box: &Mailbox, sensors_box: &Mailbox) {
        if command_box.mailgram() == 0 || sensors_box.mailgram() == 0 {
            return;
        }
        self.read_command(command_box);
        if self.read_sensors(sensors_box) && !self.joining {
            self.run();
        }
        self.write();
    }

    #[must_use]
    pub const fn outgoing(&self) -> &[Mailbox; 4] {
        &self.outgoing
    }

    #[must_use]
    pub const fn memory(&self) -> &CommonMemory {
        &self.memory
    }

    #[must_use]
    pub const fn command(&self) -> &PedestalCommand {
        &self.memory.subtask.pedestal
    }

    #[must_use]
    pub fn refusal(&self) -> Option<&LayoutError> {
        self.refused.as_ref().map(|(_, why)| why)
    }

    fn read_command(&mut self, mailbox: &Mailbox) {
        if mailbox.mailgram() == self.read {
            return;
        }
        self.read = mailbox.mailgram();
        self.refused = None;
        let (number, command) = match CommandLayout::decode(mailbox.data()) {
            Ok(command) => (Some(command.number), command),
            Err(error) => {
                self.refused = Some((Verdict::NoCommand, error));
                // The pedestal process refuses an unknown command, and echoes its number.
                let number = command::number(mailbox.data());
                (number, PedestalCommand { number: number.unwrap_or_default(), ..Default::default() })
            }
        };
        if let Some(number) = number {
            self.memory.subtask.pedestal = command;
            if self.joining {
                self.adopt(number);
            }
        }
    }

    /// Adopts the number in the mailbox as the number of a finished command.
    fn adopt(&mut self, number: u32) {
        self.joining = false;
        let mut state = *Process::<()>::state(&self.pedestal);
        state.execution.wake();
        Process::<()>::restore(&mut self.pedestal, state);
        if number != 0 && self.tick == Tick::BEFORE_START {
            self.memory.pedestal.hand = GripCommand { number: FIRST_COMMAND, ..GripCommand::default() };
            self.memory.pedestal.table = TableCommand { number: FIRST_COMMAND, ..TableCommand::default() };
        }
    }

    fn read_sensors(&mut self, mailbox: &Mailbox) -> bool {
        let sensors = SensorsLayout::decode(mailbox.data());
        if matches!(self.refused, Some((Verdict::NoSensors, _))) {
            self.refused = None;
        }
        match sensors {
            Ok(sensors) => self.external.devices.pedestal = sensors,
            Err(error) => self.refused = Some((Verdict::NoSensors, error)),
        }
        sensors.is_ok()
    }

    /// Each process reads the buffers of the previous tick.
    fn run(&mut self) {
        self.tick = self.tick.next();
        let before = *self.memory;
        let inputs = Inputs { tick: self.tick, memory: &before, external: &self.external, data: &() };
        self.pedestal.step(&inputs, &mut self.memory.pedestal);
        self.hand.step(&inputs, &mut self.memory.hand);
        self.table.step(&inputs, &mut self.memory.table);
    }

    fn write(&mut self) {
        let CommonMemory { pedestal, hand, table, .. } = &*self.memory;
        let refused = self.refused.as_ref();
        let why = refused.map(|(_, why)| why.to_string()).unwrap_or_default();
        let status = Status {
            status: pedestal.status,
            header: pedestal.header,
            mailgram_echo: self.read,
            verdict: refused.map_or(Verdict::Taken, |(verdict, _)| *verdict),
            reason: &why,
        };
        let [to_subtask, of_gripper, of_table, orders] = &mut self.outgoing;
        put(to_subtask, &status.encode());
        put(of_gripper, &GripperLayout::encode(&(*hand, pedestal.hand)));
        put(of_table, &TableLayout::encode(&(*table, pedestal.table)));
        put(orders, &OrdersLayout::encode(&(hand.valves, table.motor)));
    }
}

fn put(mailbox: &mut Mailbox, data: &[u8]) {
    if mailbox.data() != data {
        let _ = mailbox.write(data); // the layouts are shorter than the mailboxes; a test checks this
    }
}
