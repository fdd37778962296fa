//! The command of the workstation controller, byte by byte (V.4.2).
//!
//! ```text
//!   at  bytes  variable              holds
//!    0    4    cmdf<w                of the network; not read
//!    4    2    cmd-length<w          not used by the manual. CHOSEN: 0, or the bytes of the command, 126
//!    6    2    command-#-in          1 to 65535, then 1 again
//!    8   12    time-stamp-status<w   not read
//!   20   16    "command-16"          TRANSFER, MOVE, ...
//!   36   16    "obj"                 blank for none
//!   52   16    "obj-serial-#"        blank for none
//!   68    2    source-grip-#
//!   70   16    "src-loc-16"          blank for none
//!   86    2    src-sector#           0 for none
//!   88    2    dest-grip-#
//!   90   16    "dest-loc-16"         blank for none
//!  106    2    dest-sector#          0 for none
//!  108   16    "end-at-16"           blank for none
//!  124    2    endatsector#          0 for none
//! ```
//!
//! Integers are signed, of two bytes, low byte first, as those of Figure IX.2; behind a text stand blanks. CHOSEN: zeros do as
//! well behind a text.

use rcs_core::interface::HwsCommand;

use crate::fields::{FieldError, Packer, RangeError, Unpacker, command_number};

/// Bytes of a command.
pub const COMMAND: usize = 126;

/// Why bytes are no command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CommandError {
    /// Another number of bytes.
    #[error("a command of {COMMAND} bytes was expected, found {0}")]
    Size(usize),
    /// Another length in `cmd-length<w`.
    #[error("0 or {COMMAND} was expected for cmd-length<w, found {0}")]
    Length(u16),
    /// A field that cannot be.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// 0 stands for no command.
    #[error("a number from 1 on was expected for command-#-in, found 0")]
    NoNumber,
    /// Nothing is commanded.
    #[error("the name of a command was expected for command-16, found blanks")]
    NoCommand,
}

/// The bytes of a command.
///
/// # Errors
/// [`RangeError`] for a grip or a sector that two bytes cannot hold.
pub fn encode(command: &HwsCommand) -> Result<[u8; COMMAND], RangeError> {
    let mut fields = Packer::<COMMAND>::default();
    fields.text(4, &"");
    fields.word(u16::try_from(COMMAND).unwrap_or_default());
    fields.word(command_number(command.number));
    fields.text(12, &"");
    for name in [command.command, command.object.unwrap_or_default(), command.serial] {
        fields.text(16, &name);
    }
    fields.integer("source-grip-#", command.source_grip)?;
    fields.text(16, &command.source.unwrap_or_default());
    fields.integer("src-sector#", command.source_sector.unwrap_or_default())?;
    fields.integer("dest-grip-#", command.destination_grip)?;
    fields.text(16, &command.destination.unwrap_or_default());
    fields.integer("dest-sector#", command.destination_sector.unwrap_or_default())?;
    fields.text(16, &command.end_at.unwrap_or_default());
    fields.integer("endatsector#", command.end_at_sector.unwrap_or_default())?;
    Ok(fields.finish())
}

/// A field; `None` if it is blank or 0.
fn given<T: Default + PartialEq>(field: T) -> Option<T> {
    Some(field).filter(|field| *field != T::default())
}

/// Read the bytes of a command. What its words mean is for Task to say.
///
/// # Errors
/// [`CommandError`] for the first thing that cannot be.
pub fn decode(bytes: &[u8]) -> Result<HwsCommand, CommandError> {
    if bytes.len() != COMMAND {
        return Err(CommandError::Size(bytes.len()));
    }
    let mut fields = Unpacker::new(bytes);
    fields.raw("cmdf<w", 4)?;
    let length = fields.word("cmd-length<w")?;
    if length != 0 && usize::from(length) != COMMAND {
        return Err(CommandError::Length(length));
    }
    let number = fields.word("command-#-in")?;
    fields.raw("time-stamp-status<w", 12)?;
    let command = HwsCommand {
        number: u32::from(number),
        command: fields.name("command-16")?,
        object: given(fields.name("obj")?),
        serial: fields.name("obj-serial-#")?,
        source_grip: fields.integer("source-grip-#")?,
        source: given(fields.name("src-loc-16")?),
        source_sector: given(fields.integer("src-sector#")?),
        destination_grip: fields.integer("dest-grip-#")?,
        destination: given(fields.name("dest-loc-16")?),
        destination_sector: given(fields.integer("dest-sector#")?),
        end_at: given(fields.name("end-at-16")?),
        end_at_sector: given(fields.integer("endatsector#")?),
    };
    if number == 0 {
        return Err(CommandError::NoNumber);
    }
    if command.command.is_empty() {
        return Err(CommandError::NoCommand);
    }
    Ok(command)
}

#[cfg(test)]
pub(super) mod tests {
    use proptest::prelude::*;
    use rcs_core::name::Name16;

    use super::*;

    pub fn transfer(number: u32) -> HwsCommand {
        let name = |text| Name16::new(text).unwrap();
        HwsCommand {
            number,
            command: name("TRANSFER"),
            object: Some(name("LINKBAR1")),
            serial: name("17"),
            source_grip: 2,
            source: Some(name("PFIXTURE")),
            source_sector: None,
            destination_grip: -3,
            destination: Some(name("UNIT_1")),
            destination_sector: Some(4),
            end_at: Some(name("SAFE")),
            end_at_sector: None,
        }
    }

    #[test]
    fn every_field_stands_at_its_byte() {
        let expected = [
            &b"    \x7E\x00\x07\x00            "[..],
            b"TRANSFER        LINKBAR1        17              ",
            b"\x02\x00PFIXTURE        \x00\x00",
            b"\xFD\xFFUNIT_1          \x04\x00",
            b"SAFE            \x00\x00",
        ]
        .concat();
        let bytes = encode(&transfer(7)).unwrap();
        assert_eq!(bytes, &expected[..]);
        assert_eq!(decode(&bytes), Ok(transfer(7)));
    }

    #[test]
    fn a_number_beyond_two_bytes_runs_round_and_a_sector_does_not() {
        let bytes = encode(&transfer(65_536)).unwrap();
        assert_eq!(decode(&bytes).map(|command| command.number), Ok(1));
        let far = HwsCommand { source_sector: Some(40_000), ..transfer(1) };
        assert_eq!(encode(&far), Err(RangeError { field: "src-sector#", found: 40_000 }));
    }

    #[test]
    fn what_is_no_command_is_said() {
        let bytes = encode(&transfer(7)).unwrap();
        let spoilt = |at: usize, with: &[u8]| {
            let mut spoilt = bytes;
            spoilt[at..at + with.len()].copy_from_slice(with);
            decode(&spoilt).unwrap_err().to_string()
        };
        assert_eq!(
            decode(&bytes[..125]).unwrap_err().to_string(),
            "a command of 126 bytes was expected, found 125"
        );
        assert_eq!(spoilt(4, &[9, 0]), "0 or 126 was expected for cmd-length<w, found 9");
        assert_eq!(spoilt(6, &[0, 0]), "a number from 1 on was expected for command-#-in, found 0");
        assert_eq!(
            spoilt(20, &[b' '; 16]),
            "the name of a command was expected for command-16, found blanks"
        );
        let said = spoilt(38, &[0xC3]);
        assert!(said.ends_with("for obj, found C3 at byte 38"), "{said}");
    }

    proptest! {
        #[test]
        fn no_bytes_panic_and_what_is_read_can_be_written(bytes in prop::collection::vec(any::<u8>(), COMMAND)) {
            let mut bytes = bytes;
            (bytes[4], bytes[5]) = (0, 0);
            if let Ok(command) = decode(&bytes) {
                prop_assert_eq!(decode(&encode(&command).unwrap()), Ok(command));
            }
        }

        #[test]
        fn one_wrong_byte_is_noticed_or_reaches_a_field(at in 20_usize..COMMAND, byte in any::<u8>()) {
            let good = encode(&transfer(7)).unwrap();
            let mut bytes = good;
            bytes[at] = byte;
            let padding = byte == 0 && good[at] == b' ';
            if bytes != good && !padding && let Ok(command) = decode(&bytes) {
                prop_assert_ne!(command, transfer(7));
            }
        }
    }
}
