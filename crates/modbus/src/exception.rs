//! Exception codes: why a server refuses a request (AP 7).

use core::fmt;

/// Why a server refuses a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exception {
    /// 1: the server does not support the function.
    IllegalFunction,
    /// 2: the server does not have all of the addresses.
    IllegalDataAddress,
    /// 3: a quantity, a value or the length of the request is not allowed.
    IllegalDataValue,
    /// 4: the server failed while it carried out the request.
    ServerDeviceFailure,
    /// 5: the server has accepted the request and needs a long time for it.
    Acknowledge,
    /// 6: the server is busy with another request.
    ServerDeviceBusy,
    /// 8: the file record failed its parity check.
    MemoryParityError,
    /// 10: the gateway has no path to the device.
    GatewayPathUnavailable,
    /// 11: the device behind the gateway does not answer.
    GatewayTargetFailed,
    /// A code that the specification does not define.
    Other(u8),
}

impl Exception {
    /// The exception with a code.
    #[must_use]
    pub const fn from_code(code: u8) -> Self {
        match code {
            1 => Self::IllegalFunction,
            2 => Self::IllegalDataAddress,
            3 => Self::IllegalDataValue,
            4 => Self::ServerDeviceFailure,
            5 => Self::Acknowledge,
            6 => Self::ServerDeviceBusy,
            8 => Self::MemoryParityError,
            10 => Self::GatewayPathUnavailable,
            11 => Self::GatewayTargetFailed,
            other => Self::Other(other),
        }
    }

    /// The code on the wire.
    #[must_use]
    pub const fn code(self) -> u8 {
        match self {
            Self::IllegalFunction => 1,
            Self::IllegalDataAddress => 2,
            Self::IllegalDataValue => 3,
            Self::ServerDeviceFailure => 4,
            Self::Acknowledge => 5,
            Self::ServerDeviceBusy => 6,
            Self::MemoryParityError => 8,
            Self::GatewayPathUnavailable => 10,
            Self::GatewayTargetFailed => 11,
            Self::Other(code) => code,
        }
    }
}

/// `exception 2: the server does not have these addresses`.
impl fmt::Display for Exception {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let meaning = match self {
            Self::IllegalFunction => "the server does not support the function",
            Self::IllegalDataAddress => "the server does not have these addresses",
            Self::IllegalDataValue => "the server does not allow the quantity or the value",
            Self::ServerDeviceFailure => "the server failed to carry out the request",
            Self::Acknowledge => "the server needs a long time for the request",
            Self::ServerDeviceBusy => "the server is busy",
            Self::MemoryParityError => "the memory of the server has a parity error",
            Self::GatewayPathUnavailable => "the gateway has no path to the device; check the unit number",
            Self::GatewayTargetFailed => {
                "the device behind the gateway does not answer; check the unit number"
            }
            Self::Other(_) => "a code that the specification does not define",
        };
        write!(f, "exception {}: {meaning}", self.code())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_written_as_they_are_read() {
        for code in 0..=u8::MAX {
            assert_eq!(Exception::from_code(code).code(), code);
        }
        assert_eq!(Exception::from_code(2), Exception::IllegalDataAddress);
        assert_eq!(Exception::from_code(7), Exception::Other(7));
    }
}
