//! The command of the workstation controller (V.4.2). Blanks pad texts; readers also accept zeros (CHOSEN).

use interfaces::HwsCommand;

use crate::{
    fields::{FieldError, RangeError},
    layout::{At, Chars, Codec, Given, I16, LayoutError, Number, U16, Unused, Width},
};

crate::layout! {
    /// The command of the workstation controller.
    CommandLayout: HwsCommand = "a command";
    "cmdf<w"             ()               Unused<4>,         "not read";
    "cmd-length<w"       ()               Length,            "126, or 0 (CHOSEN; the manual does not use it)";
    "command-#-in"       (number)         Number,            "1 to 65535, then 1 again";
    "time-stamp-status<w"  ()             Unused<12>,        "not read";
    "command-16"         (command)        Chars<16>,
        "TRANSFER, MOVE, POSITION, ACQUIRE, REFIXTURE, PAUSE, ...";
    "obj"                (object)         Given<Chars<16>>,  "blank for none, as all names";
    "obj-serial-#"       (serial)         Chars<16>,         "";
    "source-grip-#"      (source_grip)    I16,               "";
    "src-loc-16"         (source)         Given<Chars<16>>,  "";
    "src-sector#"        (source_sector)  Given<I16>,        "0 for none, as all sectors";
    "dest-grip-#"        (destination_grip)  I16,            "";
    "dest-loc-16"        (destination)    Given<Chars<16>>,  "";
    "dest-sector#"       (destination_sector)  Given<I16>,   "";
    "end-at-16"          (end_at)         Given<Chars<16>>,  "";
    "endatsector#"       (end_at_sector)  Given<I16>,        "";
}

#[derive(Clone, Copy, Debug)]
struct Length; // `cmd-length<w`

impl Width for Length {
    const BYTES: usize = 2;
}

impl Codec<'_, ()> for Length {
    fn put((): &(), to: &mut [u8]) {
        U16::put(&u16::try_from(CommandLayout::BYTES).unwrap_or_default(), to);
    }

    fn take(at: At, from: &[u8]) -> Result<(), FieldError> {
        let found: u16 = U16::take(at, from)?;
        if found == 0 || usize::from(found) == CommandLayout::BYTES {
            return Ok(());
        }
        Err(FieldError::Expected { field: at.field, expected: "0 or 126", found })
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CommandError {
    #[error(transparent)]
    Layout(#[from] LayoutError),
    #[error("a number of at least 1 was expected for command-#-in, found 0")]
    NoNumber, // 0 means no command
    #[error("the name of a command was expected for command-16, found blanks")]
    NoCommand,
}

/// Fails if two bytes cannot hold a grip or a sector.
pub fn encode(command: &HwsCommand) -> Result<[u8; CommandLayout::BYTES], RangeError> {
    CommandLayout::check(command).map(|()| CommandLayout::encode(command))
}

/// The error names the first wrong field. Task checks the words.
pub fn decode(bytes: &[u8]) -> Result<HwsCommand, CommandError> {
    let command = CommandLayout::decode(bytes)?;
    if command.number == 0 {
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
            ..HwsCommand::default()
        }
    }

    #[test]
    fn every_field_is_at_its_byte() {
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
    fn only_the_command_number_wraps_around() {
        let bytes = encode(&transfer(65_536)).unwrap();
        assert_eq!(decode(&bytes).map(|command| command.number), Ok(1));
        let far = HwsCommand { source_sector: Some(40_000), ..transfer(1) };
        assert_eq!(encode(&far), Err(RangeError { field: "src-sector#", found: 40_000 }));
    }

    #[test]
    fn invalid_commands_are_reported() {
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
        assert_eq!(spoilt(6, &[0, 0]), "a number of at least 1 was expected for command-#-in, found 0");
        assert_eq!(
            spoilt(20, &[b' '; 16]),
            "the name of a command was expected for command-16, found blanks"
        );
        let said = spoilt(38, &[0xC3]);
        assert!(said.ends_with("for obj, found C3 at byte 38"), "{said}");
    }

    proptest! {
        #[test]
        fn arbitrary_bytes_do_not_panic_and_valid_ones_can_be_written(bytes in prop::collection::vec(any::<u8>(), CommandLayout::BYTES)) {
            let mut bytes = bytes;
            (bytes[4], bytes[5]) = (0, 0);
            if let Ok(command) = decode(&bytes) {
                prop_assert_eq!(decode(&encode(&command).unwrap()), Ok(command));
            }
        }

        #[test]
        fn wrong_byte_is_detected_or_changes_a_field(at in 20_usize..CommandLayout::BYTES, byte in any::<u8>()) {
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
