//! `EgmFeedBack` and `EgmPlanned`: present and planned position of the robot. Both have the same fields.

use super::{Values, WirePose};
use crate::{
    Error,
    wire::{Reader, Writer},
};

/// `EgmFeedBack` or `EgmPlanned`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Joint angles, degrees.
    pub joints: Option<Values>,
    /// Pose of the tool in the work object.
    pub cartesian: Option<WirePose>,
    /// External joints, degrees.
    pub external: Option<Values>,
    /// Time of the sample.
    pub time: Option<Clock>,
    /// Time of the sample with ns resolution.
    pub timestamp: Option<Timestamp>,
}

/// `EgmClock`: time since 1970.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Clock {
    /// Seconds; required.
    pub sec: Option<u64>,
    /// Microseconds; required.
    pub usec: Option<u64>,
}

/// `EgmTimestamp`: time since 1970, as in PTP.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Timestamp {
    /// Seconds.
    pub sec: Option<u64>,
    /// Nanoseconds.
    pub nsec: Option<u64>,
}

fn merge_pair(
    first: &mut Option<u64>,
    second: &mut Option<u64>,
    mut fields: Reader<'_>,
) -> Result<(), Error> {
    while let Some(field) = fields.next_field()? {
        match field.number {
            1 => *first = Some(field.uint64()?),
            2 => *second = Some(field.uint64()?),
            _ => {}
        }
    }
    Ok(())
}

fn write_pair(number: u32, pair: [Option<u64>; 2], writer: &mut Writer<'_>) -> Result<(), Error> {
    let [first, second] = pair;
    writer.message(number, |writer| {
        second.map_or(Ok(()), |value| writer.uint(2, value))?;
        first.map_or(Ok(()), |value| writer.uint(1, value))
    })
}

impl Motion {
    /// A motion that contains only a pose.
    #[must_use]
    pub fn at(pose: WirePose) -> Self {
        Self { cartesian: Some(pose), ..Self::default() }
    }

    pub(super) fn merge(&mut self, mut fields: Reader<'_>) -> Result<(), Error> {
        while let Some(field) = fields.next_field()? {
            match field.number {
                1 => self.joints.get_or_insert_default().merge(1, field.message()?)?,
                2 => self.cartesian.get_or_insert_default().merge(field.message()?)?,
                3 => self.external.get_or_insert_default().merge(1, field.message()?)?,
                4 => {
                    let time = self.time.get_or_insert_default();
                    merge_pair(&mut time.sec, &mut time.usec, field.message()?)?;
                }
                5 => {
                    let time = self.timestamp.get_or_insert_default();
                    merge_pair(&mut time.sec, &mut time.nsec, field.message()?)?;
                }
                _ => {}
            }
        }
        Ok(())
    }

    pub(super) fn check(&self) -> Result<(), Error> {
        self.cartesian.map_or(Ok(()), |cartesian| cartesian.check())?;
        match self.time {
            Some(Clock { sec: None, .. } | Clock { usec: None, .. }) => {
                Err(Error::Missing { field: "time.sec, usec" })
            }
            _ => Ok(()),
        }
    }

    pub(super) fn write(&self, writer: &mut Writer<'_>) -> Result<(), Error> {
        if let Some(Timestamp { sec, nsec }) = self.timestamp {
            write_pair(5, [sec, nsec], writer)?;
        }
        if let Some(Clock { sec, usec }) = self.time {
            write_pair(4, [sec, usec], writer)?;
        }
        if let Some(external) = &self.external {
            writer.message(3, |writer| external.write(1, writer))?;
        }
        if let Some(cartesian) = &self.cartesian {
            writer.message(2, |writer| cartesian.write(writer))?;
        }
        self.joints.as_ref().map_or(Ok(()), |joints| writer.message(1, |writer| joints.write(1, writer)))
    }
}
