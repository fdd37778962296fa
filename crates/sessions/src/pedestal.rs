//! The controller's side of a pedestal in another process: the mailboxes of Subtask and Diagnostics (IX.3).
//!
//! Once per tick it sends the command of Subtask and receives the statuses, as an input of the next tick. Common memory
//! shows the processes whether the pedestal answers or is lost:
//!
//! | event                                              | common memory                                                   |
//! |----------------------------------------------------|-----------------------------------------------------------------|
//! | it is connected and has written a status           | its buffers, with the stamp of the tick                         |
//! | on the 40 ms grid its status has not arrived       | its last buffers, republished until the echo, 2 s at most       |
//! | it is not connected, or writes invalid data        | its last buffers with their old stamp: it is lost               |

use interfaces::{OutsidePedestal, device::PedestalSensors, pedestal::PedestalCommand};
use rcs_core::tick::Tick;

use crate::network::{ClockKind, Endpoint, NetEvent};
use neighbours::mailbox::{
    MailboxError, PEDESTAL_COMMAND, PEDESTAL_GRIPPER_STATUS, PEDESTAL_ORDERS, PEDESTAL_SENSORS,
    PEDESTAL_STATUS, PEDESTAL_TABLE_STATUS, Place,
};
use neighbours::pedestal::{
    PedestalError,
    cell::{OrdersLayout, SensorsLayout},
    command::CommandLayout,
    gripper::GripperLayout,
    status::{Status, Verdict},
    table::TableLayout,
};

/// Time limit for the echo of a command on the 40 ms grid: 2 s. In fast clock every tick waits for the answer.
const ECHO_TICKS: u64 = 50;

#[derive(Debug)]
#[non_exhaustive]
pub enum Remark {
    Network(NetEvent),
    Refuses(String),
    /// The pedestal's status cannot be decoded, which is treated as no answer.
    Garbled(Place, PedestalError),
    /// The pedestal is connected but does not echo a command.
    Silent(u32),
    Unsent(MailboxError),
}

impl Remark {
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Self::Network(event) => event.code(),
            Self::Refuses(_) => "pedestal.refuses",
            Self::Garbled(..) => "pedestal.garbled",
            Self::Silent(_) => "pedestal.silent",
            Self::Unsent(_) => "pedestal.unsent",
        }
    }
}

impl std::fmt::Display for Remark {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Network(event) => event.fmt(f),
            Self::Refuses(why) => write!(f, "the Active Pedestal refuses what was sent to it: {why}"),
            Self::Garbled(place, why) => {
                write!(f, "{place} cannot be read, the Active Pedestal is treated as not answering: {why}")
            }
            Self::Silent(number) => {
                write!(f, "the Active Pedestal has not echoed command {number} for {ECHO_TICKS} ticks")
            }
            Self::Unsent(why) => write!(f, "the Active Pedestal cannot be sent its command: {why}"),
        }
    }
}

/// The controller's side. It allocates only for remarks.
pub struct Agent {
    endpoint: Endpoint,
    sent: OutsidePedestal,
    refused: (Verdict, u16), // the pedestal's last verdict, and the mailgram number to which it refers
    garbled: Option<Place>,  // the unreadable mailbox, if any
    waiting: Option<Tick>,   // tick since which the echo of the last command is missing
    silent: bool,
    remarks: Vec<Remark>,
}

impl Agent {
    #[must_use]
    pub fn new(endpoint: Endpoint) -> Self {
        Self {
            endpoint,
            sent: OutsidePedestal { elsewhere: true, ..OutsidePedestal::default() },
            refused: (Verdict::Taken, 0),
            garbled: None,
            waiting: None,
            silent: false,
            remarks: Vec::new(),
        }
    }

    /// The input from the pedestal for the next tick.
    #[must_use]
    pub const fn sent(&self) -> &OutsidePedestal {
        &self.sent
    }

    /// Takes the remarks since the last call.
    pub fn remarks(&mut self) -> Vec<Remark> {
        std::mem::take(&mut self.remarks)
    }

    /// Between two ticks: send the command and the sensor words that the tick `next` reads, and receive the statuses
    /// for it.
    pub fn exchange(&mut self, next: Tick, command: &PedestalCommand, sensors: &PedestalSensors) {
        self.put(PEDESTAL_COMMAND, &CommandLayout::encode(command));
        self.put(PEDESTAL_SENSORS, &SensorsLayout::encode(sensors));
        let presence = self.endpoint.exchange(next.0);
        self.remarks.extend(std::iter::from_fn(|| self.endpoint.event()).map(Remark::Network));
        if presence.new {
            (self.refused, self.garbled) = ((Verdict::Taken, 0), None);
            (self.waiting, self.silent) = (None, false);
        }
        if !presence.connected {
            self.sent.answers = false;
            return;
        }
        self.sent.answers = match self.receive() {
            Ok(written) => {
                self.garbled = None;
                written && self.is_heard(next, command.number)
            }
            Err((place, why)) => {
                if self.garbled != Some(place) {
                    self.garbled = Some(place);
                    self.remarks.push(Remark::Garbled(place, why));
                }
                false
            }
        };
    }

    fn put(&mut self, place: Place, data: &[u8]) {
        let mailbox = self.endpoint.outgoing(place);
        if mailbox.data() != data
            && let Err(error) = mailbox.write(data)
        {
            self.remarks.push(Remark::Unsent(error));
        }
    }

    /// Reads all four mailboxes of the pedestal, or none. Returns false before its first status. An optional mailbox
    /// may have its initial value.
    fn receive(&mut self) -> Result<bool, (Place, PedestalError)> {
        let endpoint = &self.endpoint;
        let Some(status) = read(endpoint, PEDESTAL_STATUS, Status::decode)? else { return Ok(false) };
        let of_gripper = read(endpoint, PEDESTAL_GRIPPER_STATUS, GripperLayout::decode)?;
        let of_table = read(endpoint, PEDESTAL_TABLE_STATUS, TableLayout::decode)?;
        let orders = read(endpoint, PEDESTAL_ORDERS, OrdersLayout::decode)?;
        let refused = (status.verdict, status.mailgram_echo);
        if refused != self.refused && status.verdict != Verdict::Taken {
            self.remarks.push(Remark::Refuses(status.reason.to_owned()));
        }
        self.refused = refused;
        let OutsidePedestal { pedestal, hand, table, .. } = &mut self.sent;
        (pedestal.header, pedestal.status) = (status.header, status.status);
        (*hand, pedestal.hand) = of_gripper.unwrap_or_default();
        (*table, pedestal.table) = of_table.unwrap_or_default();
        (hand.valves, table.motor) = orders.unwrap_or_default();
        Ok(true)
    }

    /// True if the pedestal echoes the last command or the time limit has not passed.
    fn is_heard(&mut self, next: Tick, number: u32) -> bool {
        if number == 0 || self.sent.pedestal.status.echo == number || self.endpoint.clock() == ClockKind::Fast
        {
            (self.waiting, self.silent) = (None, false);
            return true;
        }
        let since = *self.waiting.get_or_insert(next);
        let patient = next.since(since) <= ECHO_TICKS;
        self.sent.pedestal.header.republished = patient;
        if !patient && !self.silent {
            self.silent = true;
            self.remarks.push(Remark::Silent(number));
        }
        patient
    }
}

/// Decodes a mailbox; `None` if it was not written since its initialization.
fn read<'a, T, E: Into<PedestalError>>(
    endpoint: &'a Endpoint,
    place: Place,
    decode: impl FnOnce(&'a [u8]) -> Result<T, E>,
) -> Result<Option<T>, (Place, PedestalError)> {
    let mailbox = endpoint.incoming(place);
    if mailbox.mailgram() == 0 {
        return Ok(None);
    }
    decode(mailbox.data()).map(Some).map_err(|why| (place, why.into()))
}

#[cfg(test)]
mod tests {
    use interfaces::{
        GripOutputs,
        device::{GripValves, MotorCommand},
        pedestal::{PedestalReport, PedestalStatus, PedestalVerb},
    };

    use super::*;
    use crate::network::{Disconnect, Role, endpoint::tests::TestSession};
    use neighbours::mailbox::Mailbox;

    /// The controller's side on the 40 ms grid, and a pedestal that writes what the test specifies.
    struct Bench {
        session: TestSession, // First, because a dropped endpoint waits for its session
        agent: Agent,
        tick: u64,
        status_box: Mailbox,
    }

    impl Bench {
        fn connected() -> Self {
            let agent = Agent::new(Endpoint::new(Role::Pedestal, ClockKind::Real).unwrap());
            let session = TestSession::begin(&agent.endpoint.handle());
            let status_box = Mailbox::initialized(PEDESTAL_STATUS);
            Self { agent, session, tick: 0, status_box }
        }

        fn write(&mut self, data: &[u8]) {
            self.status_box.write(data).unwrap();
            self.session.deliver(&self.status_box);
        }

        fn report(&mut self, echo: u32, report: PedestalReport) {
            let status = PedestalStatus { echo, report, ..PedestalStatus::default() };
            self.write(&Status { status, ..Status::default() }.encode());
        }

        /// Returns whether the pedestal answers, and whether its outputs are republished.
        fn tick(&mut self, number: u32) -> (bool, bool) {
            self.tick += 1;
            let command =
                PedestalCommand { number, command: PedestalVerb::Flip, ..PedestalCommand::default() };
            self.agent.exchange(Tick(self.tick), &command, &PedestalSensors::default());
            (self.agent.sent().answers, self.agent.sent().pedestal.header.republished)
        }

        fn remarks(&mut self) -> Vec<String> {
            let remarks = self.agent.remarks().into_iter();
            remarks.filter(|remark| !matches!(remark, Remark::Network(_))).map(|r| r.to_string()).collect()
        }
    }

    #[test]
    fn last_status_is_republished_until_the_time_limit() {
        let mut bench = Bench::connected();
        assert_eq!(bench.tick(0), (false, false), "it has written nothing yet");
        bench.report(0, PedestalReport::Idle);
        assert_eq!(bench.tick(0), (true, false));
        for waited in 0..=ECHO_TICKS {
            assert_eq!(bench.tick(4), (true, true), "after {waited} ticks");
        }
        assert_eq!(bench.remarks(), [""; 0]);
        assert!(!bench.tick(4).0);
        assert!(!bench.tick(4).0);
        assert_eq!(bench.remarks(), ["the Active Pedestal has not echoed command 4 for 50 ticks"]);
        bench.report(4, PedestalReport::Executing);
        assert_eq!(bench.tick(4), (true, false));
        assert_eq!(bench.agent.sent().pedestal.status.report, PedestalReport::Executing);
        assert_eq!(bench.tick(5), (true, true), "the next command has its own time limit");
    }

    #[test]
    fn garbled_pedestal_data_are_ignored() {
        let mut bench = Bench::connected();
        let hand = GripOutputs::default();
        let mut orders = Mailbox::initialized(PEDESTAL_ORDERS);
        let valves = GripValves { bits: 0x81 };
        orders.write(&OrdersLayout::encode(&(valves, MotorCommand::default()))).unwrap();
        let mut of_gripper = Mailbox::initialized(PEDESTAL_GRIPPER_STATUS);
        of_gripper.write(&GripperLayout::encode(&(hand, Default::default()))).unwrap();
        bench.session.deliver(&orders);
        bench.session.deliver(&of_gripper);
        bench.report(4, PedestalReport::Executing);
        assert_eq!(bench.tick(4), (true, false));
        of_gripper.write(b"closed").unwrap();
        bench.session.deliver(&of_gripper);
        bench.report(4, PedestalReport::Done);
        assert!(!bench.tick(4).0 && !bench.tick(4).0);
        let sent = *bench.agent.sent();
        assert_eq!((sent.pedestal.status.report, sent.hand.valves), (PedestalReport::Executing, valves));
        assert_eq!(
            bench.remarks(),
            [
                "mailbox Pedestal Gripper to RCS Status at F5600 cannot be read, the Active Pedestal is treated as not \
              answering: a status of the gripper of 142 bytes was expected, found 6"
            ]
        );
        of_gripper.write(&GripperLayout::encode(&(hand, Default::default()))).unwrap();
        bench.session.deliver(&of_gripper);
        assert_eq!(bench.tick(4), (true, false));
        assert_eq!(bench.agent.sent().pedestal.status.report, PedestalReport::Done);
    }

    #[test]
    fn refusal_of_the_pedestal_is_reported_once() {
        let mut bench = Bench::connected();
        for grip_size in 0..3 {
            let status = PedestalStatus { grip_size, ..PedestalStatus::default() };
            let (verdict, reason) = (Verdict::NoCommand, "no command at all");
            bench.write(&Status { status, verdict, mailgram_echo: 3, reason, ..Status::default() }.encode());
            assert!(bench.tick(0).0);
        }
        assert_eq!(bench.remarks(), ["the Active Pedestal refuses what was sent to it: no command at all"]);
    }

    #[test]
    fn disconnected_pedestal_is_lost_and_keeps_its_orders() {
        let mut bench = Bench::connected();
        bench.report(4, PedestalReport::Executing);
        assert_eq!(bench.tick(4), (true, false));
        let handle = bench.agent.endpoint.handle();
        handle.detach(Disconnect::Lost("the cable was cut".to_owned()));
        assert!(!bench.tick(4).0);
        assert_eq!(bench.agent.sent().pedestal.status.echo, 4);
        assert!(bench.agent.sent().elsewhere);
    }
}
