//! The sensors of the cell: pictures of the camera on request, all others once per tick.

use geometry::frame::{Frame, Vector as Inches};
use interfaces::device::{
    DeviceInputs, DeviceOutputs, ForceSensor, GripSensors, LinkBytes, Resolvers, VisionResponse,
};
use rapier3d_f64::prelude::*;
use rcs_core::name::Name10;

use super::Cell;
use crate::{
    camera::{Face, Subject},
    convert::{to_metres, to_pose},
    force,
    hand::Hand,
    noise::{Noise, Stream},
    part::Part,
    sensor::resolver,
};

/// Links of the arm that can be between the camera on its wrist and a part.
const ARM_IN_VIEW: [&str; 2] = ["upper_arm", "forearm"];

impl Cell {
    /// Let another process analyse the pictures: [`Cell::picture`] gives them, [`Cell::hear_vision`] takes the answers.
    #[must_use]
    pub fn with_vision_elsewhere(mut self) -> Self {
        self.vision_elsewhere = true;
        self
    }

    pub fn reseed(&mut self, seed: u64) {
        self.gripper_noise = Noise::new(seed, Stream::Gripper);
        self.pedestal_noise = Noise::new(seed, Stream::Pedestal);
        self.force_noise = Noise::new(seed, Stream::Force);
        self.placement_noise = Noise::new(seed, Stream::Placement);
        self.resolver_noise = Noise::new(seed, Stream::Resolvers);
        self.analysis.reseed(seed);
    }

    pub(super) fn look(&mut self, outputs: &DeviceOutputs) {
        if self.vision_elsewhere || !self.analysis.wants_picture(&outputs.vision) {
            return;
        }
        let seen = self.picture();
        let expected = self.description.seen_as(outputs.vision.object_id);
        self.analysis.expose(&outputs.vision, &seen, expected);
    }

    #[must_use]
    pub fn picture(&self) -> Vec<Subject> {
        if self.faults.camera_blind() {
            return Vec::new();
        }
        let frame = self.optics.frame(&self.tool());
        self.subjects(&frame).into_iter().filter(|subject| subject.raster() != 0).collect()
    }

    /// Pass on the answer of a vision system in another process, if its cable is connected.
    pub fn hear_vision(&mut self, response: &VisionResponse) {
        self.inputs.vision = *response;
        self.faults.vision(&mut self.inputs);
    }

    /// The visible points of each part for a camera at a frame (world, in).
    fn subjects(&self, camera: &Frame) -> Vec<Subject> {
        let lens = to_pose(camera).translation;
        let arm: Vec<_> =
            self.arm_bodies().into_iter().filter(|link| ARM_IN_VIEW.contains(&&*link.name)).collect();
        let sees = |part: &Part, point: Inches| {
            if !self.optics.has_in_view(&point) {
                return false;
            }
            let ray = Ray::new(lens, to_pose(camera).transform_point(to_metres(&point)) - lens);
            let nearest = self.world.cast_ray(&ray, 1.01, true, QueryFilter::default());
            nearest.is_some_and(|(collider, _)| collider == part.collider)
                && !arm.iter().any(|link| link.shape.intersects_ray(&link.pose, &ray, 1.0))
        };
        let near = self.parts.iter().map(|part| {
            let here = camera.inverse().compose(&part.frame(&self.world));
            let face = Face::of(&here, &Inches::from(part.kind.size));
            Subject::new(face, part.kind.reflectance, |point| sees(part, point))
        });
        near.collect()
    }

    pub(super) fn sense(&mut self, link_rx: LinkBytes, link_ready: bool) -> DeviceInputs {
        let mut inputs = DeviceInputs { link_rx, link_ready, ..self.read_sensors() };
        inputs.vision =
            if self.vision_elsewhere { VisionResponse::default() } else { self.analysis.answer() };
        self.dead_times.hold_back(&mut inputs);
        self.show_faults(&mut inputs);
        inputs
    }

    /// The sensors within a tick. The camera, and sensors with a dead time, change only with the tick.
    pub(super) fn sense_between(&mut self) -> DeviceInputs {
        let mut inputs = self.read_sensors();
        inputs.vision = self.inputs.vision;
        self.dead_times.keep(&self.inputs, &mut inputs);
        self.show_faults(&mut inputs);
        inputs
    }

    fn show_faults(&mut self, inputs: &mut DeviceInputs) {
        self.faults.inputs(inputs);
        self.resolver_box.show(&mut inputs.resolvers);
    }

    fn read_sensors(&mut self) -> DeviceInputs {
        let (grip, force) = self.sense_gripper();
        let resolver_noise = self.description.sensors.resolver_noise;
        let counts = self
            .t3
            .arm()
            .joints()
            .map(|angle| resolver::counts(angle, resolver_noise, &mut self.resolver_noise));
        DeviceInputs {
            resolvers: Resolvers { counts, valid: true },
            grip,
            force,
            quick_change: self.changer.sensors(self.description.sensors.ring_hysteresis),
            holsters: self.holster_sensors(),
            joystick: self.joystick.read(),
            pedestal: self.pedestal.sensors(&mut self.pedestal_noise),
            clamping: self.vise.clamped.map(|_| Name10::clipped(self.vise.location())),
            ..DeviceInputs::default()
        }
    }

    /// Sensors of the mated gripper. Only the parts gripper has beam breaks and strain gages, only the tool gripper has
    /// force gages (III.3.6 to III.3.8).
    fn sense_gripper(&mut self) -> (GripSensors, ForceSensor) {
        let Some(hand) = self.changer.mated() else { return Default::default() };
        let beams = if hand == Hand::Parts { self.broken_beams() } else { 0 };
        let gripper = hand.slot().map_or(&self.pedestal.hand, |slot| &self.grippers[slot]);
        let grip = gripper.sensors(&mut self.gripper_noise, beams);
        let force = if hand == Hand::Tool {
            let down = self.world.bodies[gripper.hand()].rotation().inverse() * -Vector::Z;
            let load = gripper.load(&self.world);
            let gages = &self.description.gripper.force;
            force::read(gages, &load, &Inches::new(down.x, down.y, down.z), &mut self.force_noise)
        } else {
            ForceSensor::default()
        };
        (grip, force)
    }
}
