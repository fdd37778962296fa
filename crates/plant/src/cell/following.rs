//! A cell whose arm follows a robot outside the simulation.

use depc::Plate;
use interfaces::device::{DeviceInputs, DeviceOutputs, LinkBytes};

use super::{Cell, CellEvent};

/// Halves of a tick in [`Cell::step_half_following`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Half {
    First,
    Second,
}

impl Half {
    /// The half that follows.
    #[must_use]
    pub const fn next(self) -> Self {
        match self {
            Self::First => Self::Second,
            Self::Second => Self::First,
        }
    }
}

impl Cell {
    /// [`Cell::step`] for a robot outside the simulation: the simulated arm, and with it the cell, follows `position`,
    /// which the robot has acknowledged, if any. The simulated T3 controller is not used: the caller sends
    /// `outputs.link_tx` to the robot and fills in its answer (`link_rx` and `link_ready` are returned empty).
    ///
    /// The arm is limited to the speeds of its servos, so that a distant first position causes a motion and not a
    /// jump. At an unreachable position it does not move and reports a [`CellEvent::CannotFollow`].
    pub fn step_following(&mut self, position: Option<&Plate>, outputs: &DeviceOutputs) -> DeviceInputs {
        let outputs = &self.begin_tick(outputs);
        self.follow(position, 1.0);
        self.advance(outputs);
        self.inputs = self.sense(LinkBytes::default(), false);
        self.inputs
    }

    /// Half a tick of [`Cell::step_following`], for a cell in real time: outputs act, and sensors show, after 20 ms
    /// instead of 40. Faults, dead times and pictures still count whole ticks.
    pub fn step_half_following(
        &mut self,
        half: Half,
        position: Option<&Plate>,
        outputs: &DeviceOutputs,
    ) -> DeviceInputs {
        let outputs = &match half {
            Half::First => self.begin_tick(outputs),
            Half::Second => self.faults.outputs(outputs),
        };
        self.follow(position, 0.5);
        let whole = self.description.physics.substeps;
        match half {
            Half::First => {
                self.advance_bodies(outputs, whole / 2);
                self.inputs = self.sense_between();
            }
            Half::Second => {
                self.advance_bodies(outputs, whole - whole / 2);
                self.end_tick(outputs);
                self.inputs = self.sense(LinkBytes::default(), false);
            }
        }
        self.inputs
    }

    fn follow(&mut self, position: Option<&Plate>, periods: f64) {
        let followed = position.map_or(Ok(()), |plate| self.t3.follow(plate, periods));
        if let Err(problem) = followed
            && !self.stays_behind
        {
            self.events.push(CellEvent::CannotFollow(problem));
        }
        self.stays_behind = followed.is_err();
    }
}
