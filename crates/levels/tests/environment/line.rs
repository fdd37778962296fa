//! The DEPC line, the robot controller at its other end, and a robot at its commanded position.

use std::collections::VecDeque;

use depc::{
    Limits, Plate,
    controller::{Controller, ControllerInputs, Refusal, Robot, joints_for},
};
use geometry::kinematics::{HOME_JOINTS, Joints, T3};
use interfaces::device::{DeviceInputs, LinkBytes, RESOLVER_COUNTS};

/// A robot that reaches every commanded position at once.
#[derive(Clone)]
pub struct Exact {
    pub joints: Joints,
    pub at: Plate,
}

impl Robot for Exact {
    fn present(&mut self) -> Plate {
        self.at
    }

    fn accept(&mut self, goal: &Plate) -> Result<(), Refusal> {
        self.joints = joints_for(&T3, goal, &self.joints)?;
        self.at = *goal;
        Ok(())
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Answer {
    Comes,
    IsLost,
    IsDamaged,
    /// This answer and all following ones, until the line is empty.
    IsLate(usize),
}

#[derive(Clone)]
pub struct Line {
    pub controller: Controller,
    pub robot: Exact,
    pub connected: bool, // the line carries bytes
    pub hold: bool,
    pub on: bool, // the controller's program runs; otherwise its DTR is off
    pub answer: Answer,
    late: VecDeque<LinkBytes>,
}

pub fn counts(joints: &Joints) -> [u32; 6] {
    joints.map(|angle| {
        let turns = (angle / (2.0 * std::f64::consts::PI)).rem_euclid(1.0);
        (turns * f64::from(RESOLVER_COUNTS)).round() as u32 % RESOLVER_COUNTS
    })
}

impl Line {
    /// A robot at HOME, whose controller starts its program in this tick.
    pub fn new(devices: &mut DeviceInputs) -> Self {
        let at = Plate::from_tool(&T3.forward(&HOME_JOINTS), &T3, &Plate::default()).unwrap();
        let mut line = Self {
            controller: Controller::new(Limits::NBS),
            robot: Exact { joints: HOME_JOINTS, at },
            connected: true,
            hold: false,
            on: true,
            answer: Answer::Comes,
            late: VecDeque::new(),
        };
        devices.resolvers.valid = true;
        line.tick(&LinkBytes::default(), true, devices);
        line
    }

    /// The controller's part of a tick: it receives the frame of T3 Interface; its answer arrives in the next tick.
    pub fn step(&mut self, tx: &LinkBytes, devices: &mut DeviceInputs) {
        self.tick(tx, false, devices);
    }

    fn tick(&mut self, tx: &LinkBytes, start: bool, devices: &mut DeviceInputs) {
        let rx = if self.connected { *tx } else { LinkBytes::default() };
        let inputs =
            ControllerInputs { rx, cts: true, board: true, start, hold: self.hold, ..Default::default() };
        let out = self.controller.step(&inputs, &mut self.robot);
        let arrives = self.connected && self.answer != Answer::IsLost;
        let mut rx = if arrives { out.tx } else { LinkBytes::default() };
        match self.answer {
            Answer::IsDamaged => {
                rx.bytes.iter_mut().take(usize::from(rx.length)).for_each(|byte| *byte ^= 0x40)
            }
            Answer::IsLate(ticks) => self.late.extend(vec![LinkBytes::default(); ticks]),
            Answer::Comes | Answer::IsLost => {}
        }
        if !self.late.is_empty() {
            self.late.push_back(rx);
            rx = self.late.pop_front().unwrap_or_default();
        }
        if self.late.iter().all(|bytes| bytes.length == 0) {
            self.late.clear();
        }
        (devices.link_rx, devices.link_ready) = (rx, out.dtr && self.on);
        devices.resolvers.counts = counts(&self.robot.joints);
    }
}
