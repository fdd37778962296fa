//! The sensors of the ideal cell, and its camera.

use geometry::frame::{Frame, Vector as Inches};
use interfaces::device::{DeviceInputs, ForceSensor, GripSensors, LinkBytes, Resolvers, VisionRequest};
use rcs_core::name::Name10;

use super::{Ideal, grasping::Fingers};
use crate::{
    camera::{Face, Subject},
    convert::to_pose,
    description::{Camera, CellDescription, SensorModels},
    force, grasp,
    hand::{Hand, ROBOT_HANDS},
    sensor::resolver,
    solid::Solid,
};

impl CellDescription {
    /// The same cell with exact sensors that answer at once, and a camera that never fails.
    #[must_use]
    pub fn without_noise(&self) -> Self {
        let mut cell = self.clone();
        for gripper in [&mut cell.gripper.parts, &mut cell.gripper.v, &mut cell.gripper.tool] {
            gripper.sensors.noise = 0.0;
        }
        cell.pedestal.hand.sensors.noise = 0.0;
        cell.pedestal.table.noise = 0.0;
        cell.gripper.force.noise = 0.0;
        cell.camera = Camera {
            flood_noise: 0.0,
            precise_noise: 0.0,
            angle_noise: 0.0,
            shape_noise: 0.0,
            failure: 0.0,
            ..cell.camera
        };
        let SensorModels { proximity_hysteresis, ring_hysteresis, .. } = cell.sensors;
        cell.sensors = SensorModels { proximity_hysteresis, ring_hysteresis, ..SensorModels::default() };
        cell
    }
}

impl Ideal {
    pub(super) fn look(&mut self, request: &VisionRequest) {
        if !self.analysis.wants_picture(request) {
            return;
        }
        let camera = self.optics.frame(&self.tool());
        let subjects = self.parts.iter().map(|part| {
            let here = camera.inverse().compose(&part.frame);
            let face = Face::of(&here, &Inches::from(part.kind.size));
            Subject::new(face, part.kind.reflectance, |point| self.optics.has_in_view(&point))
        });
        let seen: Vec<_> = subjects.filter(|subject| subject.raster() != 0).collect();
        self.analysis.expose(request, &seen, self.room.cell().seen_as(request.object_id));
    }

    pub(super) fn sense(&mut self, link_rx: LinkBytes, link_ready: bool) -> DeviceInputs {
        let (grip, force) = self.sense_gripper();
        let hand = self.read(Hand::Pedestal, 0);
        let noise = &mut self.noise;
        let tool = self.t3.arm().tool();
        let grippers =
            ROBOT_HANDS.map(|hand| self.changer.frame(hand, &tool).unwrap_or_else(Frame::identity));
        let counts = self.t3.arm().joints().map(|angle| resolver::counts(angle, 0.0, noise));
        let mut inputs = DeviceInputs {
            link_rx,
            link_ready,
            resolvers: Resolvers { counts, valid: true },
            grip,
            force,
            quick_change: self.changer.sensors(self.room.cell().sensors.ring_hysteresis),
            holsters: self.changer.holster_sensors(self.room.cell(), &grippers),
            joystick: self.joystick.read(),
            vision: self.analysis.answer(),
            pedestal: self.table.sensors(hand, noise),
            clamping: self.clamped.map(|_| Name10::clipped(&self.room.cell().vise.location)),
            ..DeviceInputs::default()
        };
        self.resolver_box.show(&mut inputs.resolvers);
        inputs
    }

    /// Sensors of the mated gripper, as in the cell.
    fn sense_gripper(&mut self) -> (GripSensors, ForceSensor) {
        let Some(hand) = self.changer.mated() else { return Default::default() };
        let tool = self.tool();
        let air = &self.fingers(hand).air;
        let beams = if hand == Hand::Parts {
            let parts = self
                .parts
                .iter()
                .map(|part| (to_pose(&tool.inverse().compose(&part.frame)), Solid::of(&part.kind).half()));
            grasp::broken_beams(air.opening(), parts)
        } else {
            0
        };
        let grip = self.read(hand, beams);
        if hand != Hand::Tool {
            return (grip, ForceSensor::default());
        }
        let load = self.load_at_drum(&tool);
        let down = tool.rotation.inverse() * -Inches::z();
        (grip, force::read(&self.room.cell().gripper.force, &load, &down, &mut self.noise))
    }

    fn read(&mut self, hand: Hand, beams: u8) -> GripSensors {
        let Self { room, fingers, noise, .. } = self;
        hand.description(room.cell()).read(&Fingers::of(fingers, hand).air, noise, beams)
    }
}
