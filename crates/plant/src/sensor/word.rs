//! Words of the devices as numbers.

use interfaces::device::VisionResponse;

/// A word of the inputs or outputs of the devices.
pub enum Word<'a> {
    /// 0 or 1.
    Flag(&'a mut bool),
    /// The bits of a byte under a mask.
    Bits(&'a mut u8, u8),
    /// A number of two bytes.
    Short(&'a mut u16),
    /// A number of four bytes.
    Long(&'a mut u32),
    /// The answer of the vision system: 1; writing 0 removes it.
    Answer(&'a mut VisionResponse),
}

impl Word<'_> {
    /// Its value.
    #[must_use]
    pub fn read(&self) -> i64 {
        match self {
            Self::Flag(on) => (**on).into(),
            Self::Bits(byte, mask) => ((**byte & mask) >> mask.trailing_zeros()).into(),
            Self::Short(number) => (**number).into(),
            Self::Long(number) => (**number).into(),
            Self::Answer(_) => 1,
        }
    }

    /// Set it to a value within its range.
    pub fn write(self, value: i64) {
        match self {
            Self::Flag(on) => *on = value != 0,
            Self::Bits(byte, mask) => *byte = *byte & !mask | (value as u8) << mask.trailing_zeros() & mask,
            Self::Short(number) => *number = value as u16,
            Self::Long(number) => *number = value as u32,
            Self::Answer(answer) if value == 0 => *answer = VisionResponse::default(),
            Self::Answer(_) => {}
        }
    }
}
