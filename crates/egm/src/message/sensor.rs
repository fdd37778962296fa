//! `EgmSensor`: the answer of the host to the robot.

use super::{Header, MessageType, Motion, Values, WirePose};
use crate::{
    Error, Pose, Twist,
    wire::{Reader, Writer},
};

/// `EgmSensor`. Field 4 (data to RAPID) is skipped.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensor {
    /// Sequence number, time stamp and type.
    pub header: Option<Header>,
    /// Target position of the robot.
    pub planned: Option<Motion>,
    /// Speed of the target.
    pub speed_ref: Option<SpeedRef>,
}

/// `EgmSpeedRef`: speeds of joints and tool.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SpeedRef {
    /// Joint speeds, degrees/s.
    pub joints: Option<Values>,
    /// mm/s along x, y, z, then degrees/s about x, y, z. The order is ASSUMED: `egm.proto` does not define it.
    pub cartesians: Option<Values>,
    /// Speeds of the external joints, degrees/s.
    pub external: Option<Values>,
}

impl SpeedRef {
    /// A message with the speed of the tool.
    #[must_use]
    pub fn of(twist: &Twist) -> Self {
        let ([x, y, z], [a, b, c]) = (twist.linear, twist.angular.map(f64::to_degrees));
        Self { cartesians: Some(Values::of(&[x, y, z, a, b, c])), ..Self::default() }
    }

    /// The speed of the tool; zero if the message does not have six values.
    #[must_use]
    pub fn twist(&self) -> Twist {
        match self.cartesians.as_ref().map(Values::as_slice) {
            Some(&[x, y, z, a, b, c]) => Twist { linear: [x, y, z], angular: [a, b, c].map(f64::to_radians) },
            _ => Twist::default(),
        }
    }

    fn merge(&mut self, mut fields: Reader<'_>) -> Result<(), Error> {
        while let Some(field) = fields.next_field()? {
            match field.number {
                1 => self.joints.get_or_insert_default().merge(1, field.message()?)?,
                2 => self.cartesians.get_or_insert_default().merge(1, field.message()?)?,
                3 => self.external.get_or_insert_default().merge(1, field.message()?)?,
                _ => {}
            }
        }
        Ok(())
    }

    fn write(&self, writer: &mut Writer<'_>) -> Result<(), Error> {
        for (number, values) in [(3, &self.external), (2, &self.cartesians), (1, &self.joints)] {
            if let Some(values) = values {
                writer.message(number, |writer| values.write(1, writer))?;
            }
        }
        Ok(())
    }
}

impl Sensor {
    /// A target pose of the tool, optionally with its speed.
    #[must_use]
    pub fn target(seqno: u32, tm: u32, pose: &Pose, speed: Option<&Twist>) -> Self {
        Self {
            header: Some(Header::new(seqno, tm, MessageType::Correction)),
            planned: Some(Motion::at(WirePose::of(pose))),
            speed_ref: speed.map(SpeedRef::of),
        }
    }

    /// Decodes a datagram. Errors: [`Error`] if the datagram is not a message, or if a required field is missing.
    pub fn decode(datagram: &[u8]) -> Result<Self, Error> {
        let mut message = Self::default();
        let mut fields = Reader::new(datagram);
        while let Some(field) = fields.next_field()? {
            match field.number {
                1 => message.header.get_or_insert_default().merge(field.message()?)?,
                2 => message.planned.get_or_insert_default().merge(field.message()?)?,
                3 => message.speed_ref.get_or_insert_default().merge(field.message()?)?,
                _ => {}
            }
        }
        message.planned.map_or(Ok(()), |planned| planned.check())?;
        Ok(message)
    }

    /// Encodes the message at the end of `buffer`; [`super::MOST_BYTES`] are always enough. Errors: [`Error::NoRoom`].
    pub fn encode<'a>(&self, buffer: &'a mut [u8]) -> Result<&'a [u8], Error> {
        let mut writer = Writer::new(buffer);
        if let Some(speed) = &self.speed_ref {
            writer.message(3, |writer| speed.write(writer))?;
        }
        if let Some(planned) = &self.planned {
            writer.message(2, |writer| planned.write(writer))?;
        }
        if let Some(header) = &self.header {
            writer.message(1, |writer| header.write(writer))?;
        }
        Ok(writer.finish())
    }
}
