//! `EgmCartesian`, `EgmQuaternion`, `EgmEuler` and `EgmPose`.

use crate::{
    Error, Pose, pose,
    wire::{Reader, Writer},
};

/// `EgmCartesian`: a position, mm.
pub type Cartesian = Numbers<3>;
/// `EgmQuaternion`: u0 = w, u1 = x, u2 = y, u3 = z.
pub type Orientation = Numbers<4>;
/// `EgmEuler`: rotations about x, y, z, degrees.
pub type Euler = Numbers<3>;

/// A message of `N` required doubles, fields 1 to `N`. Missing values are `None`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Numbers<const N: usize>([Option<f64>; N]);

impl<const N: usize> Default for Numbers<N> {
    fn default() -> Self {
        Self([None; N])
    }
}

impl<const N: usize> Numbers<N> {
    /// A message with all numbers.
    #[must_use]
    pub fn new(values: [f64; N]) -> Self {
        Self(values.map(Some))
    }

    /// The values; 0 for a missing one, which a decoded message never has.
    #[must_use]
    pub fn values(&self) -> [f64; N] {
        self.0.map(Option::unwrap_or_default)
    }

    fn merge(&mut self, mut fields: Reader<'_>) -> Result<(), Error> {
        while let Some(field) = fields.next_field()? {
            for (number, slot) in (1..).zip(&mut self.0) {
                if field.number == number {
                    *slot = Some(field.double()?);
                }
            }
        }
        Ok(())
    }

    fn check(&self, field: &'static str) -> Result<(), Error> {
        if self.0.iter().all(Option::is_some) { Ok(()) } else { Err(Error::Missing { field }) }
    }

    fn write(&self, writer: &mut Writer<'_>) -> Result<(), Error> {
        let numbered = (1..).zip(&self.0);
        let mut reversed: [Option<(u32, f64)>; N] = [None; N];
        for (slot, (number, value)) in reversed.iter_mut().rev().zip(numbered) {
            *slot = value.map(|value| (number, value));
        }
        reversed.iter().flatten().try_for_each(|(number, value)| writer.double(*number, *value))
    }
}

/// `EgmPose`: position and orientation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WirePose {
    /// Position, mm.
    pub pos: Option<Cartesian>,
    /// Orientation as a quaternion.
    pub orient: Option<Orientation>,
    /// Orientation as Euler angles; they take precedence over the quaternion.
    pub euler: Option<Euler>,
}

impl WirePose {
    /// A message with position and quaternion of a pose.
    #[must_use]
    pub fn of(pose: &Pose) -> Self {
        let (pos, orient) = (Cartesian::new(pose.position), Orientation::new(pose.orientation));
        Self { pos: Some(pos), orient: Some(orient), euler: None }
    }

    /// The pose, if complete and finite. Errors: [`Error::Missing`] or [`Error::NotAPose`].
    pub fn pose(&self) -> Result<Pose, Error> {
        let position = self.pos.ok_or(Error::Missing { field: "cartesian.pos" })?.values();
        let orientation = match (self.euler, self.orient) {
            (Some(euler), _) => pose::from_euler(euler.values()),
            (None, Some(orient)) => orient.values(),
            (None, None) => return Err(Error::Missing { field: "cartesian.orient" }),
        };
        Pose::new(position, orientation)
    }

    pub(super) fn merge(&mut self, mut fields: Reader<'_>) -> Result<(), Error> {
        while let Some(field) = fields.next_field()? {
            match field.number {
                1 => self.pos.get_or_insert_default().merge(field.message()?)?,
                2 => self.orient.get_or_insert_default().merge(field.message()?)?,
                3 => self.euler.get_or_insert_default().merge(field.message()?)?,
                _ => {}
            }
        }
        Ok(())
    }

    pub(super) fn check(&self) -> Result<(), Error> {
        self.pos.map_or(Ok(()), |pos| pos.check("pos.x, y, z"))?;
        self.orient.map_or(Ok(()), |orient| orient.check("orient.u0 to u3"))?;
        self.euler.map_or(Ok(()), |euler| euler.check("euler.x, y, z"))
    }

    pub(super) fn write(&self, writer: &mut Writer<'_>) -> Result<(), Error> {
        if let Some(euler) = &self.euler {
            writer.message(3, |writer| euler.write(writer))?;
        }
        if let Some(orient) = &self.orient {
            writer.message(2, |writer| orient.write(writer))?;
        }
        self.pos.as_ref().map_or(Ok(()), |pos| writer.message(1, |writer| pos.write(writer)))
    }
}
