//! `EgmRobot`: the message that the robot controller sends in every cycle.

use super::{Header, MessageType, Motion, Values};
use crate::{
    Error, Pose,
    wire::{Field, Reader, Writer},
};

/// `EgmRobot`. Fields 12 to 14 (collision information, data from RAPID, torques) are skipped.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Robot {
    /// Sequence number, time stamp and type.
    pub header: Option<Header>,
    /// Present position of the robot.
    pub feedback: Option<Motion>,
    /// Position planned by the controller.
    pub planned: Option<Motion>,
    /// State of the motors' power.
    pub motor_state: Option<MotorState>,
    /// State of the motion correction.
    pub mci_state: Option<MciState>,
    /// True if the convergence criteria of the RAPID program are met.
    pub mci_convergence_met: Option<bool>,
    /// Test signals.
    pub test_signals: Option<Values>,
    /// State of the RAPID program.
    pub rapid_state: Option<RapidState>,
    /// `measuredForce.fcActive`: true if force control is active.
    pub force_active: Option<bool>,
    /// Forces, N, and torques, Nm.
    pub measured_force: Option<Values>,
    /// Utilization of the robot by the motion, percent; above 100 the motion is only partly executed.
    pub utilization_rate: Option<f64>,
    /// Number of the move instruction.
    pub move_index: Option<u32>,
}

/// An enum, and the message that contains it as its one required field `state`.
macro_rules! state {
    ($(#[$doc:meta])* $name:ident { $($(#[$variant_doc:meta])* $variant:ident = $code:literal,)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub enum $name {
            /// Undefined, or not in the schema.
            #[default]
            Undefined,
            $($(#[$variant_doc])* $variant,)*
        }

        impl $name {
            const fn code(self) -> u64 {
                match self {
                    Self::Undefined => 0,
                    $(Self::$variant => $code,)*
                }
            }

            /// `value` is `None` until the field occurs.
            fn merge(value: &mut Option<Self>, field: &Field<'_>, name: &'static str) -> Result<(), Error> {
                let mut fields = field.message()?;
                while let Some(field) = fields.next_field()? {
                    if field.number == 1 {
                        *value = Some(match field.uint32()? {
                            $($code => Self::$variant,)*
                            _ => Self::Undefined,
                        });
                    }
                }
                // A later occurrence can supply the field, because occurrences are merged.
                if value.is_some() { Ok(()) } else { Err(Error::Missing { field: name }) }
            }

            fn write(self, number: u32, writer: &mut Writer<'_>) -> Result<(), Error> {
                writer.message(number, |writer| writer.uint(1, self.code()))
            }
        }
    };
}

state! {
    /// `EgmMotorState`.
    MotorState {
        /// The motors have power.
        On = 1,
        /// The motors have no power.
        Off = 2,
    }
}

state! {
    /// `EgmMCIState`: the motion correction interface.
    MciState {
        /// The motion correction has stopped with an error.
        Error = 1,
        /// The motion correction is not running.
        Stopped = 2,
        /// The motion correction is running: the robot follows.
        Running = 3,
    }
}

state! {
    /// `EgmRapidCtrlExecState`.
    RapidState {
        /// The program is stopped.
        Stopped = 1,
        /// The program is running.
        Running = 2,
    }
}

impl Robot {
    /// Decodes a datagram. Errors: a wrong type, or a missing required field or sequence number.
    pub fn decode(datagram: &[u8]) -> Result<Self, Error> {
        let mut message = Self::default();
        let mut fields = Reader::new(datagram);
        while let Some(field) = fields.next_field()? {
            message.take(&field)?;
        }
        for motion in [message.feedback, message.planned].into_iter().flatten() {
            motion.check()?;
        }
        Ok(message)
    }

    fn take(&mut self, field: &Field<'_>) -> Result<(), Error> {
        match field.number {
            1 => self.header.get_or_insert_default().merge(field.message()?),
            2 => self.feedback.get_or_insert_default().merge(field.message()?),
            3 => self.planned.get_or_insert_default().merge(field.message()?),
            4 => MotorState::merge(&mut self.motor_state, field, "motorState.state"),
            5 => MciState::merge(&mut self.mci_state, field, "mciState.state"),
            6 => {
                self.mci_convergence_met = Some(field.flag()?);
                Ok(())
            }
            7 => self.test_signals.get_or_insert_default().merge(1, field.message()?),
            8 => RapidState::merge(&mut self.rapid_state, field, "rapidExecState.state"),
            9 => self.take_force(field.message()?),
            10 => {
                self.utilization_rate = Some(field.double()?);
                Ok(())
            }
            11 => {
                self.move_index = Some(field.uint32()?);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    fn take_force(&mut self, mut fields: Reader<'_>) -> Result<(), Error> {
        let forces = self.measured_force.get_or_insert_default();
        while let Some(field) = fields.next_field()? {
            match field.number {
                1 => self.force_active = Some(field.flag()?),
                2 => forces.take(&field)?,
                _ => {}
            }
        }
        Ok(())
    }

    /// Encodes the message at the end of `buffer`; [`super::MOST_BYTES`] are always enough. Errors: [`Error::NoRoom`].
    pub fn encode<'a>(&self, buffer: &'a mut [u8]) -> Result<&'a [u8], Error> {
        let mut writer = Writer::new(buffer);
        self.write(&mut writer)?;
        Ok(writer.finish())
    }

    fn write(&self, writer: &mut Writer<'_>) -> Result<(), Error> {
        self.move_index.map_or(Ok(()), |index| writer.uint(11, index.into()))?;
        self.utilization_rate.map_or(Ok(()), |rate| writer.double(10, rate))?;
        if self.measured_force.is_some() || self.force_active.is_some() {
            writer.message(9, |writer| {
                self.measured_force.map_or(Ok(()), |forces| forces.write(2, writer))?;
                self.force_active.map_or(Ok(()), |active| writer.flag(1, active))
            })?;
        }
        self.rapid_state.map_or(Ok(()), |state| state.write(8, writer))?;
        if let Some(signals) = &self.test_signals {
            writer.message(7, |writer| signals.write(1, writer))?;
        }
        self.mci_convergence_met.map_or(Ok(()), |met| writer.flag(6, met))?;
        self.mci_state.map_or(Ok(()), |state| state.write(5, writer))?;
        self.motor_state.map_or(Ok(()), |state| state.write(4, writer))?;
        for (number, motion) in [(3, &self.planned), (2, &self.feedback)] {
            if let Some(motion) = motion {
                writer.message(number, |writer| motion.write(writer))?;
            }
        }
        self.header.as_ref().map_or(Ok(()), |header| writer.message(1, |writer| header.write(writer)))
    }

    /// Sequence number, and pose of the tool in the work object. Errors: [`Error::Missing`], [`Error::BadType`] (not
    /// from a robot), [`Error::NotAPose`].
    pub fn essentials(&self) -> Result<(u32, Pose), Error> {
        let header = self.header.ok_or(Error::Missing { field: "header" })?;
        let seqno = header.seqno.ok_or(Error::Missing { field: "header.seqno" })?;
        let expected = MessageType::Data;
        if let Some(found) = header.mtype.filter(|found| *found != expected) {
            return Err(Error::BadType { expected: expected.code(), found: found.code() });
        }
        let feedback = self.feedback.ok_or(Error::Missing { field: "feedBack" })?;
        let cartesian = feedback.cartesian.ok_or(Error::Missing { field: "feedBack.cartesian" })?;
        Ok((seqno, cartesian.pose()?))
    }
}
