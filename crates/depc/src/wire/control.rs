//! The one-byte frames: the host's commands without data, and the controller's responses (A 2.3).

/// A command of the host without data and checksum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// End the DEPC function and continue with the next programmed point.
    Cancel,
    /// Report the position again and wait for a command.
    Restart,
}

impl Control {
    /// The byte on the line.
    #[must_use]
    pub const fn byte(self) -> u8 {
        match self {
            Self::Cancel => 0x18,
            Self::Restart => 0x05,
        }
    }

    /// The command of a byte, if it is one.
    #[must_use]
    pub const fn from_byte(byte: u8) -> Option<Self> {
        match byte {
            0x18 => Some(Self::Cancel),
            0x05 => Some(Self::Restart),
            _ => None,
        }
    }
}

/// The controller's answer to a command; it has no number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Response {
    /// The command is understood.
    Ack,
    /// The command is not understood; send it again.
    Nak,
}

impl Response {
    /// The byte on the line.
    #[must_use]
    pub const fn byte(self) -> u8 {
        match self {
            Self::Ack => 0x06,
            Self::Nak => 0x15,
        }
    }

    /// The response of a byte, if it is one.
    #[must_use]
    pub const fn from_byte(byte: u8) -> Option<Self> {
        match byte {
            0x06 => Some(Self::Ack),
            0x15 => Some(Self::Nak),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_those_of_the_appendix() {
        assert_eq!([Control::Cancel.byte(), Control::Restart.byte()], [0x18, 0x05]);
        assert_eq!([Response::Ack.byte(), Response::Nak.byte()], [0x06, 0x15]);
    }

    #[test]
    fn no_other_byte_is_a_command_or_a_response() {
        for byte in 0..=u8::MAX {
            assert_eq!(
                Control::from_byte(byte).map(Control::byte),
                [0x18, 0x05].contains(&byte).then_some(byte)
            );
            assert_eq!(
                Response::from_byte(byte).map(Response::byte),
                [0x06, 0x15].contains(&byte).then_some(byte)
            );
        }
    }
}
