//! The command buffer of Figure IX.2, byte by byte.
//!
//! A reconfiguration command has 28 bytes, a DML command 240. Tagged fields are nested; their lengths differ:
//!
//! ```text
//!   at   bytes                variable                         28 bytes    240 bytes
//!    0   A0 82 hh ll          DSCindc, DSClen: rest            00 18       00 EC
//!    4   B0 0A                CMDindc: ten bytes
//!    6     nn nn              command-id#
//!    8     H_ROBOT .          client
//!   16   30 82 hh ll          TRNSindc, TRNSlen                00 08       00 DC
//!   20     tt 00              TYPEindc, TYPElen
//!   22     50 04              TRNSIDindc: four bytes
//!   24       TR nn nn         trans-id, trans-id#
//!   28     04 82 00 D0        DMLindc, DMLlen: 208             -           yes
//!   32       106 + 102 bytes  the DML string, see STRING       -           yes
//! ```
//!
//! The manual gives the values of the 28-byte command, and says that DSClen, TRNSlen and TYPEindc change for a DML
//! command. The lengths are counted. CHOSEN: TYPEindc 0x55 (its initial value) is ABORT, 0x56 INITIATE, 0x57 STARTUP,
//! 0x58 DML; trans-id# is the number of an update, or 0 for none. A repeated update with the same number is not
//! executed again. Numbers are low byte first, lengths of the protocol high byte first.

use std::ops::Range;

use interfaces::{DataBaseCommand, data_base::DataBaseVerb};
use rcs_core::name::{Name10, Name16};

pub const RECONFIGURATION: usize = 28; // bytes
pub const DML: usize = 240; // bytes
pub const STRING_AT: usize = 32;
pub const CLIENT: &[u8; 8] = b"H_ROBOT "; // this controller
pub const IN_HAND: &str = "H_ROBOT"; // `STORAGE-POS` and `DEVICE` of a held item
/// `DEVICE` of all places except the robot's hand (CHOSEN: the manual names no devices).
pub const WORKSTATION: &str = "HWS";
pub const ITEM_TYPE: &str = "PART"; // of all items (CHOSEN: Task does not know types)
pub const MAX_SECTOR: i32 = 35; // one character: 0 to 9, then A to Z (CHOSEN beyond 9)

const FIXED: [(usize, &[u8]); 8] = [
    (0, &[0xA0, 0x82]),
    (4, &[0xB0, 0x0A]),
    (8, CLIENT),
    (16, &[0x30, 0x82]),
    (21, &[0x00]),
    (22, &[0x50, 0x04]),
    (24, b"TR"),
    (28, &[0x04, 0x82, 0x00, 0xD0]),
];
const DSC_LENGTH: usize = 2;
const COMMAND_ID: usize = 6;
const TRANSACTION_LENGTH: usize = 18;
const TYPE: usize = 20;
const TRANSACTION_ID: usize = 26;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Piece {
    Fixed(&'static str, usize), // padded with blanks to the width
    Value(Value, usize),        // padded with blanks to the width
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Value {
    ItemType,
    ItemName,
    Device,
    StoragePosition,
    Sector,
    ItemNumber,
}

/// Blocks 183 (106 bytes) and 184 (102 bytes).
const STRING: [Piece; 29] = [
    Piece::Fixed("UPDATE", 7),
    Piece::Fixed("EQUIP_ITEM_ACTION", 18),
    Piece::Fixed("SET", 4),
    Piece::Fixed("(", 2),
    Piece::Fixed("ITEM_TYPE,", 11),
    Piece::Fixed("ITEM_NAME,", 11),
    Piece::Fixed("DEVICE,", 8),
    Piece::Fixed("STORAGE_POS,", 13),
    Piece::Fixed("SECTOR", 7),
    Piece::Fixed(")", 2),
    Piece::Fixed("=", 2),
    Piece::Fixed("(", 1),
    Piece::Fixed("'", 1),
    Piece::Value(Value::ItemType, 16),
    Piece::Fixed("','", 3),
    Piece::Value(Value::ItemName, 16),
    Piece::Fixed("','", 3),
    Piece::Value(Value::Device, 16),
    Piece::Fixed("','", 3),
    Piece::Value(Value::StoragePosition, 16),
    Piece::Fixed("','", 3),
    Piece::Fixed("SECTOR-", 7),
    Piece::Value(Value::Sector, 1),
    Piece::Fixed("')", 3),
    Piece::Fixed("WHERE", 6),
    Piece::Fixed("ITEM_NBR", 9),
    Piece::Fixed("=", 1),
    Piece::Fixed("'", 1),
    Piece::Value(Value::ItemNumber, 16),
];
const END: u8 = b'\'';

/// TYPEindc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Transaction {
    Abort = 0x55, // in any state
    Initiate = 0x56,
    Startup = 0x57,
    Dml = 0x58,
}

impl Transaction {
    fn of(verb: DataBaseVerb) -> Option<Self> {
        match verb {
            DataBaseVerb::None => None,
            DataBaseVerb::Abort => Some(Self::Abort),
            DataBaseVerb::Initiate => Some(Self::Initiate),
            DataBaseVerb::Startup => Some(Self::Startup),
            DataBaseVerb::Update => Some(Self::Dml),
        }
    }

    fn from_byte(byte: u8) -> Option<Self> {
        [Self::Abort, Self::Initiate, Self::Startup, Self::Dml].into_iter().find(|&t| t as u8 == byte)
    }

    fn length(self) -> usize {
        if self == Self::Dml { DML } else { RECONFIGURATION }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EncodeError {
    #[error("no command")]
    Nothing,
    #[error("the name {0} has an apostrophe, which the DML string cannot hold")]
    Apostrophe(Name16), // would end its field of the string
    #[error("a sector from 0 to {MAX_SECTOR} was expected, found {0}")]
    Sector(i32), // more than one character
}

/// Returns the bytes and their number, without allocation. Fails if a field cannot hold its value.
pub fn encode(command: &DataBaseCommand) -> Result<([u8; DML], usize), EncodeError> {
    let transaction = Transaction::of(command.command).ok_or(EncodeError::Nothing)?;
    let length = transaction.length();
    let mut bytes = [0; DML];
    for (at, value) in FIXED {
        bytes[at..at + value.len()].copy_from_slice(value);
    }
    let id = low_word(command.number).to_le_bytes();
    bytes[COMMAND_ID..COMMAND_ID + 2].copy_from_slice(&id);
    bytes[TYPE] = transaction as u8;
    put_length(&mut bytes, DSC_LENGTH, length);
    put_length(&mut bytes, TRANSACTION_LENGTH, length);
    if transaction == Transaction::Dml {
        put_string(&mut bytes[STRING_AT..], command)?;
    } else {
        bytes[length..].fill(0);
    }
    Ok((bytes, length))
}

pub fn identify(bytes: &mut [u8], command_id: u16) {
    bytes[COMMAND_ID..COMMAND_ID + 2].copy_from_slice(&command_id.to_le_bytes());
}

pub fn number(bytes: &mut [u8; DML], transaction: u16) {
    bytes[TRANSACTION_ID..TRANSACTION_ID + 2].copy_from_slice(&transaction.to_le_bytes());
}

/// The low 16 bits of a command number, which the buffer holds.
#[must_use]
pub fn low_word(number: u32) -> u16 {
    let [low, high, ..] = number.to_le_bytes();
    u16::from_le_bytes([low, high])
}

fn put_length(bytes: &mut [u8; DML], at: usize, command: usize) {
    let follows = u16::try_from(command - at - 2).unwrap_or(u16::MAX);
    bytes[at..at + 2].copy_from_slice(&follows.to_be_bytes());
}

fn put_string(bytes: &mut [u8], command: &DataBaseCommand) -> Result<(), EncodeError> {
    let number = command.sector.unwrap_or_default();
    let sector = u32::try_from(number)
        .ok()
        .and_then(|sector| char::from_digit(sector, 36))
        .ok_or(EncodeError::Sector(number))?
        .to_ascii_uppercase();
    let position = command.position.as_str();
    let device = if position == IN_HAND { IN_HAND } else { WORKSTATION };
    let mut character = [0; 4];
    let sector = &*sector.encode_utf8(&mut character);
    for name in [command.item, command.serial, widened(&command.position)] {
        if name.as_str().contains('\'') {
            return Err(EncodeError::Apostrophe(name));
        }
    }
    bytes.fill(b' ');
    let mut at = 0;
    for piece in STRING {
        let (text, width) = match piece {
            Piece::Fixed(text, width) => (text, width),
            Piece::Value(Value::ItemType, width) => (ITEM_TYPE, width),
            Piece::Value(Value::ItemName, width) => (command.item.as_str(), width),
            Piece::Value(Value::Device, width) => (device, width),
            Piece::Value(Value::StoragePosition, width) => (position, width),
            Piece::Value(Value::Sector, width) => (sector, width),
            Piece::Value(Value::ItemNumber, width) => (command.serial.as_str(), width),
        };
        bytes[at..at + text.len()].copy_from_slice(text.as_bytes());
        at += width;
    }
    bytes[at] = END;
    Ok(())
}

fn widened(name: &Name10) -> Name16 {
    Name16::clipped(name.as_str())
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Received<'a> {
    pub command_id: u16,
    pub client: &'a str, // without trailing blanks
    pub transaction: Transaction,
    pub transaction_id: u16,
    pub statement: &'a str, // DML; empty for a reconfiguration
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DecodeError {
    #[error("a command of {RECONFIGURATION} or {DML} bytes was expected, found {0}")]
    Size(usize), // neither of the two lengths
    #[error("bytes {expected:02X?} were expected at {at}, found {found:02X?}")]
    Protocol {
        at: usize,         // offset, from 0
        expected: Vec<u8>, // bytes of the protocol
        found: Vec<u8>,
    },
    #[error("a transaction type that goes with {size} bytes was expected, found {found:02X}")]
    Transaction {
        size: usize, // of the command, bytes
        found: u8,
    },
    #[error("printable characters were expected from byte {0} on")]
    Text(usize), // not printable ASCII
}

/// The error has the place of the first wrong byte.
pub fn decode(bytes: &[u8]) -> Result<Received<'_>, DecodeError> {
    let size = bytes.len();
    if size != RECONFIGURATION && size != DML {
        return Err(DecodeError::Size(size));
    }
    for (at, expected) in FIXED {
        // The client can be any printable text, and only a DML command has the last field.
        if at != 8 && at < size {
            expect(bytes, at, expected)?;
        }
    }
    for at in [DSC_LENGTH, TRANSACTION_LENGTH] {
        let follows = u16::try_from(size - at - 2).unwrap_or(u16::MAX);
        expect(bytes, at, &follows.to_be_bytes())?;
    }
    let transaction = Transaction::from_byte(bytes[TYPE])
        .filter(|transaction| transaction.length() == size)
        .ok_or(DecodeError::Transaction { size, found: bytes[TYPE] })?;
    let word = |at: usize| u16::from_le_bytes([bytes[at], bytes[at + 1]]);
    Ok(Received {
        command_id: word(COMMAND_ID),
        client: text(bytes, 8..16)?.trim_end(),
        transaction,
        transaction_id: word(TRANSACTION_ID),
        statement: if size == DML { text(bytes, STRING_AT..DML)? } else { "" },
    })
}

fn expect(bytes: &[u8], at: usize, expected: &[u8]) -> Result<(), DecodeError> {
    let found = &bytes[at..at + expected.len()];
    if found == expected {
        return Ok(());
    }
    Err(DecodeError::Protocol { at, expected: expected.to_vec(), found: found.to_vec() })
}

fn text(bytes: &[u8], at: Range<usize>) -> Result<&str, DecodeError> {
    let start = at.start;
    let piece = &bytes[at];
    if let Some(bad) = piece.iter().position(|byte| !(b' '..=b'~').contains(byte)) {
        return Err(DecodeError::Text(start + bad));
    }
    str::from_utf8(piece).map_err(|_| DecodeError::Text(start))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn update(item: &str, serial: &str, position: &str, sector: i32) -> DataBaseCommand {
        DataBaseCommand {
            number: 0x1_0203,
            command: DataBaseVerb::Update,
            item: Name16::new(item).unwrap(),
            serial: Name16::new(serial).unwrap(),
            position: Name10::new(position).unwrap(),
            sector: Some(sector),
        }
    }

    #[test]
    fn string_has_the_lengths_of_its_blocks() {
        let width = |piece: &Piece| match piece {
            Piece::Fixed(text, width) => {
                assert!(text.len() <= *width, "{text}");
                *width
            }
            Piece::Value(_, width) => *width,
        };
        let first: usize = STRING[..15].iter().map(width).sum();
        let second: usize = STRING[15..].iter().map(width).sum::<usize>() + 1;
        assert_eq!((first, second), (106, 102));
        assert_eq!(STRING_AT + first + second, DML);
    }

    #[test]
    fn reconfiguration_command_equals_the_figure() {
        let command =
            DataBaseCommand { number: 2, command: DataBaseVerb::Abort, ..DataBaseCommand::default() };
        let (bytes, length) = encode(&command).unwrap();
        let expected = [
            &[0xA0, 0x82, 0x00, 0x18, 0xB0, 0x0A, 0x02, 0x00][..],
            b"H_ROBOT ",
            &[0x30, 0x82, 0x00, 0x08, 0x55, 0x00, 0x50, 0x04],
            b"TR",
            &[0x00, 0x00],
        ]
        .concat();
        assert_eq!(&bytes[..length], expected);
        assert!(bytes[length..].iter().all(|&byte| byte == 0));
    }

    #[test]
    fn update_equals_the_figure() {
        let (bytes, length) = encode(&update("LINKBAR1", "17", "UNIT_1", 4)).unwrap();
        assert_eq!(length, 240);
        assert_eq!(&bytes[..8], &[0xA0, 0x82, 0x00, 0xEC, 0xB0, 0x0A, 0x03, 0x02]);
        assert_eq!(&bytes[16..21], &[0x30, 0x82, 0x00, 0xDC, 0x58]);
        assert_eq!(&bytes[28..32], &[0x04, 0x82, 0x00, 0xD0]);
        let expected = "UPDATE EQUIP_ITEM_ACTION SET ( ITEM_TYPE, ITEM_NAME, DEVICE, STORAGE_POS, SECTOR ) = \
                        ('PART            ','LINKBAR1        ','HWS             ','UNIT_1          ','SECTOR-4') \
                        WHERE ITEM_NBR ='17              '";
        assert_eq!(str::from_utf8(&bytes[32..]), Ok(expected));
        let received = decode(&bytes).unwrap();
        assert_eq!((received.command_id, received.transaction_id), (0x0203, 0));
        let mut numbered = bytes;
        identify(&mut numbered, 9);
        number(&mut numbered, 0x1234);
        let again = decode(&numbered).unwrap();
        assert_eq!((again.command_id, again.transaction_id, again.statement), (9, 0x1234, expected));
        assert_eq!((received.client, received.transaction), ("H_ROBOT", Transaction::Dml));
        assert_eq!(received.statement, expected);
    }

    #[test]
    fn values_beyond_the_buffer_are_refused() {
        assert_eq!(encode(&DataBaseCommand::default()), Err(EncodeError::Nothing));
        for sector in [-1, 36] {
            assert_eq!(encode(&update("A", "", "B", sector)), Err(EncodeError::Sector(sector)));
        }
        let (bytes, _) = encode(&update("A", "", "B", 35)).unwrap();
        assert!(str::from_utf8(&bytes[32..]).unwrap().contains("'SECTOR-Z'"));
        for command in [update("A'B", "", "C", 1), update("A", "1'", "C", 1), update("A", "", "C'", 1)] {
            let error = encode(&command).unwrap_err();
            assert!(matches!(error, EncodeError::Apostrophe(_)), "{error}");
        }
    }

    #[test]
    fn first_wrong_command_byte_is_named() {
        let (bytes, _) = encode(&update("LINKBAR1", "17", "UNIT_1", 4)).unwrap();
        assert_eq!(decode(&bytes[..239]), Err(DecodeError::Size(239)));
        let spoilt = |at: usize, byte: u8| {
            let mut spoilt = bytes;
            spoilt[at] = byte;
            decode(&spoilt).unwrap_err().to_string()
        };
        assert_eq!(spoilt(1, 0x83), "bytes [A0, 82] were expected at 0, found [A0, 83]");
        assert_eq!(spoilt(3, 0x18), "bytes [00, EC] were expected at 2, found [00, 18]");
        assert_eq!(spoilt(20, 0x55), "a transaction type that goes with 240 bytes was expected, found 55");
        assert_eq!(spoilt(31, 0), "bytes [04, 82, 00, D0] were expected at 28, found [04, 82, 00, 00]");
        assert_eq!(spoilt(100, 0xFF), "printable characters were expected from byte 100 on");
    }

    proptest! {
        #[test]
        fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
            let _ = decode(&bytes);
        }

        #[test]
        fn wrong_byte_is_detected_or_changes_a_value(at in 0_usize..240, byte in any::<u8>()) {
            let (good, _) = encode(&update("LINKBAR1", "17", "UNIT_1", 4)).unwrap();
            let mut bytes = good;
            bytes[at] = byte;
            if bytes != good && let Ok(received) = decode(&bytes) {
                prop_assert_ne!(received, decode(&good).unwrap());
            }
        }
    }
}
