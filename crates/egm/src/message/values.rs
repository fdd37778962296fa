//! Repeated doubles: `EgmJoints`, `EgmCartesianSpeed`, `EgmTestSignals`, forces.

use crate::{
    Error,
    wire::{Field, Reader, Value, Writer},
};

/// Greatest number of values in a repeated field: six joints, six external joints, six forces, twelve test signals.
pub const MOST_VALUES: usize = 16;

/// Up to [`MOST_VALUES`] doubles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Values {
    values: [f64; MOST_VALUES],
    length: usize,
}

impl Values {
    /// The first values of `values`, as many as fit.
    #[must_use]
    pub fn of(values: &[f64]) -> Self {
        let mut all = Self::default();
        let fits = |value: &&f64| all.push(**value).is_ok();
        let _ = values.iter().take_while(fits).count();
        all
    }

    /// The values.
    #[must_use]
    pub fn as_slice(&self) -> &[f64] {
        self.values.get(..self.length).unwrap_or(&self.values)
    }

    fn push(&mut self, value: f64) -> Result<(), Error> {
        let slot = self.values.get_mut(self.length).ok_or(Error::TooMany { most: MOST_VALUES })?;
        *slot = value;
        self.length = self.length.saturating_add(1);
        Ok(())
    }

    /// Takes a single value or packed values.
    pub(super) fn take(&mut self, field: &Field<'_>) -> Result<(), Error> {
        if let Value::Bytes(packed) = field.value {
            let mut packed = Reader::new(packed);
            while let Some(value) = packed.next_double()? {
                self.push(value)?;
            }
            return Ok(());
        }
        self.push(field.double()?)
    }

    pub(super) fn merge(&mut self, number: u32, mut fields: Reader<'_>) -> Result<(), Error> {
        while let Some(field) = fields.next_field()? {
            if field.number == number {
                self.take(&field)?;
            }
        }
        Ok(())
    }

    /// Writes each value with its own key, because `egm.proto` is proto2 and not packed.
    pub(super) fn write(&self, number: u32, writer: &mut Writer<'_>) -> Result<(), Error> {
        self.as_slice().iter().rev().try_for_each(|value| writer.double(number, *value))
    }
}
