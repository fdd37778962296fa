//! Layouts byte by byte, and the pedestal's system.

use interfaces::{
    Decided, GripOutputs, Header, Reason, TableOutputs,
    device::{GripValves, MotorCommand, MotorOrder, PedestalSensors},
    grip::{Calibration, Felt, GripCommand, GripReport, GripStatus, GripVerb, Scale},
    pedestal::{
        PedestalCommand, PedestalReport, PedestalStatus, PedestalVerb, TableCommand, TableStatus, TableVerb,
    },
};
use proptest::prelude::*;
use rcs_core::{name::Name16, tick::Tick};

use super::{
    PedestalError, System,
    cell::{OrdersLayout, SensorsLayout},
    command::{self, CommandLayout},
    gripper::GripperLayout,
    status::{Status, StatusLayout, Verdict},
    table::TableLayout,
};
use crate::mailbox::{
    HEAD, Mailbox, PEDESTAL_COMMAND, PEDESTAL_GRIPPER_STATUS, PEDESTAL_ORDERS, PEDESTAL_SENSORS,
    PEDESTAL_STATUS, PEDESTAL_TABLE_STATUS,
};

fn flip(number: u32) -> PedestalCommand {
    PedestalCommand {
        cycle: Tick(0x0102),
        number,
        command: PedestalVerb::Flip,
        grasp_size: 60,
        grasp_force: 30,
        table_angle: -1835,
    }
}

fn row() -> Header {
    let decided = Some(Decided { table: 3, row: 9 });
    Header { decided, step: Some(Name16::clipped("letting-go")), ..Header::default() }
}

#[test]
fn command_fields_are_at_their_bytes() {
    let expected = [
        &b"\x02\x01\x00\x00\x00\x00\x00\x00"[..],
        b"\x07\x00\x00\x00FLIP      ",
        b"\x3C\x00\x00\x00\x1E\x00\x00\x00\xD5\xF8\xFF\xFF",
    ]
    .concat();
    assert_eq!(CommandLayout::encode(&flip(7)), &expected[..]);
    assert_eq!(CommandLayout::decode(&expected), Ok(flip(7)));
    assert_eq!(command::number(&expected[..12]), Some(7));
    assert_eq!(command::number(&expected[..11]), None);
}

#[test]
fn a_status_is_at_its_bytes() {
    let status = PedestalStatus {
        cycle_echo: Tick(0x0102),
        echo: 7,
        report: PedestalReport::CannotDo,
        reason: Reason::TableLimit,
        grip_size: 250,
        grip_force: -1,
        table_position: Some(-200),
        felt: Felt::Something,
        gripped: true,
    };
    let sent = Status { status, header: row(), mailgram_echo: 4, verdict: Verdict::NoCommand, reason: "why" };
    let expected = [
        &b"\x02\x01\x00\x00\x00\x00\x00\x00\x07\x00\x00\x00can't-do  "[..],
        &[Reason::TableLimit.code(), 0, 0, 0],
        b"\xFA\x00\x00\x00\xFF\xFF\xFF\xFF\x38\xFF\xFF\xFF",
        b"\x03\x00\x09\x00letting-go      \x04\x00\x01\x00",
        format!("{:160}", "why").as_bytes(),
        b"\x01\x00\x02\x00\x01\x00",
    ]
    .concat();
    assert_eq!(sent.encode(), &expected[..]);
    assert_eq!(Status::decode(&expected), Ok(sent));
}

#[test]
fn diagnostics_statuses_have_their_byte_layout() {
    let hand = GripOutputs {
        header: row(),
        status: GripStatus {
            echo: 2,
            report: GripReport::Serror,
            reason: Reason::GripTimeout,
            initialized: true,
            position: 1,
            left_force: 2,
            right_force: 3,
            velocity: -4,
            finger_height: 5,
            valves: 0x81,
            felt: Felt::Nothing,
        },
        calibration: Some(Calibration {
            potentiometer: Scale { zero: 1.0, gain: 2.0 },
            left: Scale { zero: -1.0, gain: 0.5 },
            right: Scale { zero: 0.0, gain: -2.0 },
        }),
        valves: GripValves::default(),
    };
    let order = GripCommand {
        number: 3,
        command: GripVerb::CloseGrip,
        force: 30,
        position: 60,
        velocity: 0,
        end_effector_id: None,
    };
    let expected = [
        &b"\x02\x00\x00\x00serror    "[..],
        &[Reason::GripTimeout.code(), 0, 0, 0, 1, 0],
        b"\x01\x00\x00\x00\x02\x00\x00\x00\x03\x00\x00\x00\xFC\xFF\xFF\xFF\x05\x00\x00\x00\x81\x00",
        b"\x03\x00\x09\x00letting-go      \x03\x00\x00\x00CLOSE-GRIP",
        b"\x1E\x00\x00\x00\x3C\x00\x00\x00\x00\x00\x00\x00\x00\x00\x01\x00\x01\x00",
        b"\x00\x00\x00\x00\x00\x00\xF0\x3F\x00\x00\x00\x00\x00\x00\x00\x40",
        b"\x00\x00\x00\x00\x00\x00\xF0\xBF\x00\x00\x00\x00\x00\x00\xE0\x3F",
        b"\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\x00\xC0",
    ]
    .concat();
    assert_eq!(GripperLayout::encode(&(hand, order)), &expected[..]);
    assert_eq!(GripperLayout::decode(&expected), Ok((hand, order)));
    let turned = TableOutputs {
        header: row(),
        status: TableStatus {
            echo: 5,
            report: PedestalReport::Executing,
            reason: Reason::None,
            calibrated: true,
            position: Some(-200),
        },
        at_limit: Some(0x0F01),
        motor: MotorCommand::default(),
    };
    let turn = TableCommand { number: 5, command: TableVerb::Turn, angle: -2035 };
    let expected = [
        &b"\x05\x00\x00\x00executing \x00\x00\x00\x00\x01\x00\x38\xFF\xFF\xFF\x03\x00\x09\x00letting-go      "[..],
        b"\x05\x00\x00\x00TURN      \x0D\xF8\xFF\xFF\x01\x00\x01\x00\x01\x0F",
    ]
    .concat();
    assert_eq!(TableLayout::encode(&(turned, turn)), &expected[..]);
    assert_eq!(TableLayout::decode(&expected), Ok((turned, turn)));
}

#[test]
fn device_words_have_their_byte_layout() {
    let sensors = PedestalSensors {
        potentiometer: 0x0102,
        strain_left: 3,
        strain_right: 4,
        table_potentiometer: 5,
        limit_plus: true,
        limit_minus: false,
        motor_echo: 6,
        motor_moving: true,
        motor_counter: -7,
    };
    let expected =
        b"\x02\x01\x03\x00\x04\x00\x05\x00\x01\x00\x00\x00\x06\x00\x00\x00\x01\x00\xF9\xFF\xFF\xFF";
    assert_eq!(&SensorsLayout::encode(&sensors), expected);
    assert_eq!(SensorsLayout::decode(expected), Ok(sensors));
    let (valves, motor) =
        (GripValves { bits: 0x42 }, MotorCommand { number: 6, order: MotorOrder::SetCounter, steps: -2000 });
    let expected = b"\x42\x00\x06\x00\x00\x00set-counter \x30\xF8\xFF\xFF";
    assert_eq!(&OrdersLayout::encode(&(valves, motor)), expected);
    assert_eq!(OrdersLayout::decode(expected), Ok((valves, motor)));
}

#[test]
fn invalid_layouts_are_reported() {
    let said = |error: PedestalError| error.to_string();
    assert_eq!(
        said(CommandLayout::decode(&[0; 33]).unwrap_err().into()),
        "a command of 34 bytes was expected, found 33"
    );
    let mut bytes = CommandLayout::encode(&flip(7));
    bytes[12..16].copy_from_slice(b"FLOP");
    assert_eq!(said(CommandLayout::decode(&bytes).unwrap_err().into()), "FLOP is not a word of command");
    bytes[13] = 0x9C;
    assert!(
        said(CommandLayout::decode(&bytes).unwrap_err().into()).ends_with("for command, found 9C at byte 13")
    );
    let mut bytes = Status::default().encode();
    bytes[22..24].copy_from_slice(&[0xFF, 1]);
    assert_eq!(said(Status::decode(&bytes).unwrap_err()), "511 is not a code of status-code");
    let idle = PedestalStatus { echo: 7, ..PedestalStatus::default() };
    let idle = Status { status: idle, ..Status::default() }.encode();
    assert_eq!(
        said(Status::decode(&idle).unwrap_err()),
        "executing, done, can't-do or error was expected for the command 7, found idle"
    );
    let mut bytes = SensorsLayout::encode(&PedestalSensors::default());
    bytes[8] = 2;
    assert_eq!(said(SensorsLayout::decode(&bytes).unwrap_err().into()), "2 is not a code of limit+");
}

#[test]
fn every_layout_fits_its_mailbox() {
    let layouts = [
        (PEDESTAL_COMMAND, CommandLayout::BYTES),
        (PEDESTAL_STATUS, StatusLayout::BYTES),
        (PEDESTAL_GRIPPER_STATUS, GripperLayout::BYTES),
        (PEDESTAL_TABLE_STATUS, TableLayout::BYTES),
        (PEDESTAL_SENSORS, SensorsLayout::BYTES),
        (PEDESTAL_ORDERS, OrdersLayout::BYTES),
    ];
    for (place, bytes) in layouts {
        assert!(HEAD + bytes <= place.size, "{place}");
    }
}

proptest! {
    #[test]
    fn no_bytes_panic(bytes in prop::collection::vec(any::<u8>(), 0..260)) {
        let _ = CommandLayout::decode(&bytes);
        let _ = command::number(&bytes);
        let _ = Status::decode(&bytes);
        let _ = GripperLayout::decode(&bytes);
        let _ = TableLayout::decode(&bytes);
        let _ = SensorsLayout::decode(&bytes);
        let _ = OrdersLayout::decode(&bytes);
    }

    /// Changes one byte of a valid command. If the result can be decoded, encoding it gives the same bytes.
    #[test]
    fn accepted_command_encodes_to_the_same_bytes(at in any::<prop::sample::Index>(), byte in any::<u8>()) {
        let mut bytes = CommandLayout::encode(&flip(7));
        let at = at.index(bytes.len());
        bytes[at] = byte;
        if let Ok(taken) = CommandLayout::decode(&bytes) {
            // Zeros are also accepted as padding of a text.
            let blank = bytes.map(|byte| if byte == 0 { b' ' } else { byte });
            prop_assert_eq!(CommandLayout::encode(&taken).map(|byte| if byte == 0 { b' ' } else { byte }), blank);
        }
    }

    /// The pedestal continues, and its output can be decoded, with arbitrary data and processes that join at any time.
    #[test]
    fn arbitrary_mailgrams_do_not_stop_the_pedestal(
        events in prop::collection::vec((0_u8..6, prop::collection::vec(any::<u8>(), 0..40)), 1..60),
    ) {
        let mut bench = Bench::default();
        for (kind, bytes) in events {
            match kind {
                0 => bench.command_box.write(&bytes).unwrap(),
                1 => bench.sensors_box.write(&bytes).unwrap(),
                2 => bench.sense(&PedestalSensors::default()),
                3 => bench.command(&flip(u32::from(bytes.len() as u8))),
                4 => bench.system.join(),
                _ => {}
            }
            bench.tick();
            if bench.system.outgoing()[0].mailgram() != 0 {
                prop_assert!(Status::decode(bench.system.outgoing()[0].data()).is_ok());
                prop_assert!(GripperLayout::decode(bench.system.outgoing()[1].data()).is_ok());
                prop_assert!(TableLayout::decode(bench.system.outgoing()[2].data()).is_ok());
                prop_assert!(OrdersLayout::decode(bench.system.outgoing()[3].data()).is_ok());
            }
        }
    }
}

struct Bench {
    system: System,
    command_box: Mailbox,
    sensors_box: Mailbox,
}

impl Default for Bench {
    fn default() -> Self {
        Self {
            system: System::default(),
            command_box: Mailbox::initialized(PEDESTAL_COMMAND),
            sensors_box: Mailbox::initialized(PEDESTAL_SENSORS),
        }
    }
}

impl Bench {
    fn joining(number: u32) -> Self {
        let mut bench = Self::default();
        bench.command(&PedestalCommand { number, ..flip(number) });
        bench.sense(&PedestalSensors { potentiometer: 2000, ..PedestalSensors::default() });
        bench
    }

    fn command(&mut self, command: &PedestalCommand) {
        self.command_box.write(&CommandLayout::encode(command)).unwrap();
    }

    fn sense(&mut self, sensors: &PedestalSensors) {
        self.sensors_box.write(&SensorsLayout::encode(sensors)).unwrap();
    }

    fn tick(&mut self) {
        self.system.step(&self.command_box, &self.sensors_box);
    }

    fn status(&self) -> Status<'_> {
        Status::decode(self.system.outgoing()[0].data()).unwrap()
    }

    fn orders(&self) -> (GripValves, MotorCommand) {
        OrdersLayout::decode(self.system.outgoing()[3].data()).unwrap()
    }
}

#[test]
fn only_a_booted_pedestal_calibrates_at_once() {
    let mut booted = Bench::joining(0);
    (0..3).for_each(|_| booted.tick());
    let (valves, motor) = booted.orders();
    assert!(valves.bits != 0 && motor.order == MotorOrder::Turn, "{valves:?} {motor:?}");
    let mut replaced = Bench::joining(7);
    for _ in 0..100 {
        replaced.tick();
        assert_eq!(replaced.orders(), Default::default());
    }
    let PedestalStatus { echo, report, reason, .. } = replaced.status().status;
    assert_eq!((echo, report, reason), (7, PedestalReport::Error, Reason::Restarted));
    // FLIP needs the position of the table. PRE-GRIP determines it, and calibrates the hand first.
    replaced.command(&flip(8));
    replaced.tick();
    assert_eq!(replaced.status().status.reason, Reason::TableAngleUnknown);
    replaced.command(&PedestalCommand {
        command: PedestalVerb::PreGrip,
        grasp_size: 250,
        table_angle: -200,
        ..flip(9)
    });
    (0..3).for_each(|_| replaced.tick());
    assert_eq!(
        (replaced.status().status.echo, replaced.status().status.report),
        (9, PedestalReport::Executing)
    );
    let (valves, motor) = replaced.orders();
    assert!(valves.bits != 0 && motor == MotorCommand::default(), "{valves:?} {motor:?}");
}

#[test]
fn old_mailbox_contents_are_not_executed_after_a_repair() {
    let mut bench = Bench::joining(0);
    bench.tick();
    bench.command(&PedestalCommand { command: PedestalVerb::Release, grasp_size: 250, ..flip(5) });
    bench.system.join();
    bench.tick();
    let PedestalStatus { echo, report, reason, .. } = bench.status().status;
    assert_eq!((echo, report, reason), (5, PedestalReport::Error, Reason::Restarted));
    bench.command(&PedestalCommand { command: PedestalVerb::Pause, ..flip(6) });
    bench.tick();
    assert_eq!((bench.status().status.echo, bench.status().status.report), (6, PedestalReport::Executing));
}

#[test]
fn garbled_command_is_refused_by_its_number() {
    let mut bench = Bench::joining(0);
    bench.tick();
    let mut bytes = CommandLayout::encode(&flip(5));
    bytes[12] = 0x07;
    bench.command_box.write(&bytes).unwrap();
    bench.tick();
    let status = bench.status();
    assert_eq!((status.status.echo, status.status.report), (5, PedestalReport::CannotDo));
    assert_eq!((status.verdict, status.mailgram_echo), (Verdict::NoCommand, 2));
    assert!(status.reason.ends_with("for command, found 07 at byte 12"), "{}", status.reason);
    bench.command_box.write(&bytes[..9]).unwrap();
    bench.tick();
    let status = bench.status();
    assert_eq!((status.status.echo, status.reason), (5, "a command of 34 bytes was expected, found 9"));
    bench.command(&PedestalCommand { command: PedestalVerb::Pause, ..flip(6) });
    bench.tick();
    let status = bench.status();
    assert_eq!((status.status.echo, status.verdict, status.reason), (6, Verdict::Taken, ""));
}

#[test]
fn invalid_sensor_words_stop_the_processes_with_a_reason() {
    let mut bench = Bench::joining(0);
    (0..3).for_each(|_| bench.tick());
    let before = bench.orders();
    bench.sensors_box.write(b"nonsense").unwrap();
    (0..3).for_each(|_| bench.tick());
    assert_eq!(bench.orders(), before);
    assert_eq!(bench.status().verdict, Verdict::NoSensors);
    assert_eq!(bench.status().reason, "a set of sensor words of 22 bytes was expected, found 8");
    bench.sense(&PedestalSensors::default());
    bench.tick();
    assert_eq!((bench.status().verdict, bench.status().reason), (Verdict::Taken, ""));
}
