//! Words of the devices as numbers.

use crate::device::{MotorOrder, VisionResponse};

/// A word of the inputs or outputs of the devices.
pub enum Word<'a> {
    /// 0 or 1.
    Flag(&'a mut bool),
    /// The bits of a byte under a mask.
    Bits(&'a mut u8, u8),
    /// An unsigned number of two bytes.
    Short(&'a mut u16),
    /// A signed number of two bytes.
    Signed(&'a mut i16),
    /// An unsigned number of four bytes.
    Long(&'a mut u32),
    /// A signed number of four bytes.
    Count(&'a mut i32),
    /// An order to the rotary table: 0 none, 1 turn, 2 set the counter, 3 stop.
    Order(&'a mut MotorOrder),
    /// The answer of the vision system: 1; writing 0 removes it.
    Answer(&'a mut VisionResponse),
}

/// The orders to the rotary table by number.
const ORDERS: [MotorOrder; 4] =
    [MotorOrder::None, MotorOrder::Turn, MotorOrder::SetCounter, MotorOrder::Stop];

impl Word<'_> {
    /// Its value.
    #[must_use]
    pub fn read(&self) -> i64 {
        match self {
            Self::Flag(on) => (**on).into(),
            Self::Bits(byte, mask) => (**byte & mask).wrapping_shr(mask.trailing_zeros()).into(),
            Self::Short(number) => (**number).into(),
            Self::Signed(number) => (**number).into(),
            Self::Long(number) => (**number).into(),
            Self::Count(number) => (**number).into(),
            Self::Order(order) => {
                (0..).zip(ORDERS).find(|(_, one)| one == *order).map_or(0, |(code, _)| code)
            }
            Self::Answer(_) => 1,
        }
    }

    /// Set it to the nearest value of its type.
    pub fn write(self, value: i64) {
        match self {
            Self::Flag(on) => *on = value != 0,
            Self::Bits(byte, mask) => {
                let bits = u8::try_from(value.clamp(0, u8::MAX.into())).unwrap_or(u8::MAX);
                *byte = *byte & !mask | bits.wrapping_shl(mask.trailing_zeros()) & mask;
            }
            Self::Short(number) => *number = value.clamp(0, u16::MAX.into()).try_into().unwrap_or(u16::MAX),
            Self::Signed(number) => {
                *number = value.clamp(i16::MIN.into(), i16::MAX.into()).try_into().unwrap_or(i16::MAX);
            }
            Self::Long(number) => *number = value.clamp(0, u32::MAX.into()).try_into().unwrap_or(u32::MAX),
            Self::Count(number) => {
                *number = value.clamp(i32::MIN.into(), i32::MAX.into()).try_into().unwrap_or(i32::MAX);
            }
            Self::Order(order) => {
                let found = (0..).zip(ORDERS).find(|(code, _)| *code == value);
                *order = found.map_or(MotorOrder::None, |(_, order)| order);
            }
            Self::Answer(answer) if value == 0 => *answer = VisionResponse::default(),
            Self::Answer(_) => {}
        }
    }
}
