//! The T3 controller: the DEPC function at one end, the joint servos at the other.
//!
//! What goes over the line is [`depc::controller`]; here is the robot that it moves: closed-form inverse kinematics, joint
//! limits and the wrist singularity, then a command for the servos. The robot's program is one DEPC function, begun when
//! the cell starts (A 2.1, ASSUMED); the pushbuttons of the panel can be pressed through [`Button`].

use depc::{
    Limits, Plate,
    controller::{Controller, ControllerInputs, ControllerState, JointProblem, Robot, Warning, joints_for},
};
use rcs_core::{
    frame::Frame,
    interface::device::LinkBytes,
    kinematics::{Joints, T3},
};
use serde::{Deserialize, Serialize};

/// Pushbuttons and switches of the controller's panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Button {
    /// Cycle start: the program comes to the DEPC function.
    Start,
    /// ENTER: the answer to a warning that begins DEPC again.
    Enter,
    /// CANCEL: the answer that ends DEPC.
    Cancel,
    /// Interrupt.
    Interrupt,
    /// Hold, on or off.
    Hold(bool),
}

/// The T3 controller.
#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct T3Controller {
    #[serde(with = "crate::image::record")]
    depc: Controller,
    servos: Servos,
    #[serde(with = "crate::image::record")]
    panel: ControllerInputs,
}

/// What one tick of the controller gives.
#[derive(Clone, Copy, Debug)]
pub struct T3Tick {
    /// Bytes to the host.
    pub tx: LinkBytes,
    /// The robot's DTR, the host's CTS.
    pub dtr: bool,
    /// Joint angles that the servos reach for by the end of the tick, radians.
    pub command: Joints,
    /// A warning that has come up in this tick.
    pub warning: Option<Warning>,
}

/// Why the arm cannot be led to a position by hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DriveError {
    /// The position does not fit into the words of the controller.
    #[error("the position is beyond the controller's coordinates of 327.67 in")]
    OutOfRange,
    /// The joints cannot take it.
    #[error("the arm cannot take the position: {0:?}")]
    Joints(JointProblem),
}

#[derive(Clone, Debug, Deserialize, Serialize)]
struct Servos {
    #[serde(with = "crate::image::record")]
    plate: Plate,
    joints: Joints,
}

impl Robot for Servos {
    fn present(&self) -> Plate {
        self.plate
    }

    fn move_to(&mut self, goal: &Plate) -> Result<(), JointProblem> {
        self.joints = joints_for(&T3, goal, &self.joints)?;
        self.plate = *goal;
        Ok(())
    }
}

impl T3Controller {
    /// A controller whose arm stands at the given joint angles, and whose program is about to begin.
    ///
    /// # Errors
    /// [`DriveError::OutOfRange`] if the end plate is beyond the words of the line.
    pub fn new(start: &Joints) -> Result<Self, DriveError> {
        let plate = Plate::from_frame(&T3.forward_plate(start), &Plate::default())
            .map_err(|_| DriveError::OutOfRange)?;
        let panel = ControllerInputs { board: true, cts: true, start: true, ..ControllerInputs::default() };
        Ok(Self { depc: Controller::new(Limits::NBS), servos: Servos { plate, joints: *start }, panel })
    }

    /// One tick: `rx` has come from the host.
    pub fn step(&mut self, rx: &LinkBytes) -> T3Tick {
        let before = self.depc.warning();
        let inputs = ControllerInputs { rx: *rx, ..self.panel };
        let out = self.depc.step(&inputs, &mut self.servos);
        self.panel.start = false;
        self.panel.enter = false;
        self.panel.cancel = false;
        self.panel.interrupt = false;
        let now = self.depc.warning();
        let warning = (now != before && now != Warning::None).then_some(now);
        T3Tick { tx: out.tx, dtr: out.dtr, command: self.servos.joints, warning }
    }

    /// Press a button; it counts in the next tick.
    pub fn press(&mut self, button: Button) {
        match button {
            Button::Start => self.panel.start = true,
            Button::Enter => self.panel.enter = true,
            Button::Cancel => self.panel.cancel = true,
            Button::Interrupt => self.panel.interrupt = true,
            Button::Hold(on) => self.panel.hold = on,
        }
    }

    /// The host's DTR, as the line shows it to the controller.
    pub fn set_host_ready(&mut self, ready: bool) {
        self.panel.cts = ready;
    }

    /// State of the DEPC function.
    #[must_use]
    pub fn state(&self) -> ControllerState {
        self.depc.state()
    }

    /// Lead the arm to an end-plate frame (inches, world) as the teach pendant does, past the line and its limits of speed.
    ///
    /// # Errors
    /// [`DriveError`]; the command stays as it was.
    pub fn drive(&mut self, plate: &Frame) -> Result<(), DriveError> {
        let words = Plate::from_frame(plate, &self.servos.plate).map_err(|_| DriveError::OutOfRange)?;
        self.servos.move_to(&words).map_err(DriveError::Joints)
    }

    /// Take over the position of another controller that has the robot: joint angles that the servos reach for, radians.
    ///
    /// # Errors
    /// [`JointProblem`] if this arm cannot take the position; the command stays as it was.
    pub fn follow(&mut self, plate: &Plate) -> Result<Joints, JointProblem> {
        self.servos.move_to(plate)?;
        Ok(self.servos.joints)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rcs_core::kinematics::HOME_JOINTS;

    #[test]
    fn the_first_tick_reports_home_as_worked_out() {
        let mut t3 = T3Controller::new(&HOME_JOINTS).unwrap();
        let tick = t3.step(&LinkBytes::default());
        // Report of A 2.3: FF FF 03, the twelve bytes, the checksum.
        let tx = tick.tx.as_slice();
        assert_eq!(&tx[..3], &[0xFF, 0xFF, 0x03]);
        assert_eq!(tx.len(), 16);
        assert!(tick.dtr);
        assert_eq!(t3.state(), ControllerState::Running);
    }

    #[test]
    fn a_lost_host_is_a_warning_once() {
        let mut t3 = T3Controller::new(&HOME_JOINTS).unwrap();
        t3.step(&LinkBytes::default());
        t3.set_host_ready(false);
        assert_eq!(t3.step(&LinkBytes::default()).warning, Some(Warning::CtsLow));
        assert_eq!(t3.step(&LinkBytes::default()).warning, None);
    }

    #[test]
    fn a_position_behind_the_arm_is_refused() {
        let mut t3 = T3Controller::new(&HOME_JOINTS).unwrap();
        let mut far = T3.forward_plate(&HOME_JOINTS);
        far.position.z = 200.0;
        assert_eq!(t3.drive(&far), Err(DriveError::Joints(JointProblem::Joint)));
        far.position.z = 400.0;
        assert_eq!(t3.drive(&far), Err(DriveError::OutOfRange));
    }
}
