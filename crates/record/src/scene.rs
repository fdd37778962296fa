//! The moving cell: `/tf`, `/tf_static`, `/joint_states`, `/robot_description`, `/meshes`, `/names`, `/trail`,
//! `/contacts` and `/camera`.
//!
//! Links are given relative to their parents, so that description and transforms always agree.

use std::io::{Seek, Write};

use mcap::McapResult;
use rcs_core::tick::Tick;

use crate::{
    channels::Output,
    contacts,
    input::{CellFrame, CellModel, Touch},
    proto::{
        foxglove::{self, Transform},
        ros,
        scene::{self, Colour, Entity, Primitive},
    },
    trail::Trail,
};

/// 8 µm and 8 µrad are finer than any picture, and compress well. Exact inputs are on `/replay`.
const STEP: f64 = 131_072.0;

pub const TF: &str = "/tf";
pub const TF_STATIC: &str = "/tf_static";

pub const MESHES: &str = "/meshes"; // one message at the start of the log
pub const NAMES: &str = "/names"; // one message at the start of the log

pub const CAMERA: &str = "/camera";

/// A frame at the tool point with the axes of the world, so that a view attached to it does not turn.
const TOOL_POINT: &str = "tool_point";
const WORLD: &str = "world"; // the frame of fixed bodies

const CAMERA_LINK: &str = "quick_change";
const LETTERS: f64 = 0.10; // height of the letters of a name, metres
/// Their colour: viewers draw dark letters on a light background.
const INK: Colour = [0.09, 0.12, 0.14, 1.0];

/// Encoding of the definitions of ROS 2 messages, and of the messages.
const ROS2: (&str, &str) = ("ros2msg", "cdr");

pub struct Scene {
    model: CellModel,
    moving: u16,
    fixed: u16,
    joints: u16,
    description: u16,
    meshes: u16,
    names: u16,
    camera: u16,
    contacts: u16,
    trail: Trail,
    described: bool,
    last: Vec<Option<Transform>>,
    last_tool: Option<Transform>,
    last_joints: Vec<f64>,
}

impl Scene {
    pub fn open<W: Write + Seek>(output: &mut Output<W>, model: CellModel) -> McapResult<Self> {
        let descriptors = foxglove::frame_transforms_descriptor();
        let moving = output.protobuf(TF, foxglove::FRAME_TRANSFORMS, &descriptors)?;
        let fixed = output.protobuf(TF_STATIC, foxglove::FRAME_TRANSFORMS, &descriptors)?;
        let definition = ros::JOINT_STATE_DEFINITION.as_bytes();
        let joints = output.channel("/joint_states", ros::JOINT_STATE, ROS2.0, definition, ROS2.1)?;
        let definition = ros::STRING_DEFINITION.as_bytes();
        let description = output.channel("/robot_description", ros::STRING, ROS2.0, definition, ROS2.1)?;
        let drawn = scene::descriptor();
        let meshes = output.protobuf(MESHES, scene::SCENE_UPDATE, &drawn)?;
        let names = output.protobuf(NAMES, scene::SCENE_UPDATE, &drawn)?;
        let image = foxglove::compressed_image_descriptor();
        let camera = output.protobuf(CAMERA, foxglove::COMPRESSED_IMAGE, &image)?;
        let contacts = output.protobuf(contacts::CONTACTS, scene::SCENE_UPDATE, &drawn)?;
        let trail = Trail::open(output, &model)?;
        let last = vec![None; model.links.len()];
        let (described, last_tool, last_joints) = (false, None, Vec::new());
        Ok(Self {
            model,
            moving,
            fixed,
            joints,
            description,
            meshes,
            names,
            camera,
            contacts,
            trail,
            described,
            last,
            last_tool,
            last_joints,
        })
    }

    pub fn write<W: Write + Seek>(
        &mut self,
        output: &mut Output<W>,
        frame: &CellFrame,
        all: bool,
    ) -> McapResult<()> {
        if !self.described {
            self.describe(output, frame.tick)?;
            self.described = true;
        }
        let time = output.epoch.of(frame.tick);
        let mut data = Vec::new();
        for ((link, place), last) in self.model.links.iter().zip(&frame.transforms).zip(&mut self.last) {
            let place = rounded(place);
            if all || *last != Some(place) {
                foxglove::put_transform(time, &link.parent, &link.name, &place, &mut data);
                *last = Some(place);
            }
        }
        if let Some(position) = self.trail.tool_point(frame) {
            let place = rounded(&Transform { position, ..Transform::IDENTITY });
            if all || self.last_tool != Some(place) {
                foxglove::put_transform(time, WORLD, TOOL_POINT, &place, &mut data);
                self.last_tool = Some(place);
            }
        }
        if !data.is_empty() {
            output.put(self.moving, frame.tick, &data)?;
        }
        self.trail.note(output, frame)?;
        let joints: Vec<f64> =
            frame.joints.iter().take(self.model.joints.len()).copied().map(round).collect();
        if all || joints != self.last_joints {
            data.clear();
            ros::joint_state(time, &self.model.joints, &joints, &mut data);
            output.put(self.joints, frame.tick, &data)?;
            self.last_joints = joints;
        }
        Ok(())
    }

    pub fn picture<W: Write + Seek>(&self, output: &mut Output<W>, tick: Tick, png: &[u8]) -> McapResult<()> {
        let mut data = Vec::new();
        foxglove::put_png(output.epoch.of(tick), CAMERA_LINK, png, &mut data);
        output.put(self.camera, tick, &data)
    }

    pub fn touches<W: Write + Seek>(
        &self,
        output: &mut Output<W>,
        tick: Tick,
        touches: &[Touch],
    ) -> McapResult<()> {
        let mut data = Vec::new();
        contacts::put_marks(output.epoch.of(tick), touches, &mut data);
        output.put(self.contacts, tick, &data)
    }

    fn describe<W: Write + Seek>(&self, output: &mut Output<W>, tick: Tick) -> McapResult<()> {
        let mut data = Vec::new();
        ros::string(&self.model.urdf, &mut data);
        output.put(self.description, tick, &data)?;
        data.clear();
        let time = output.epoch.of(tick);
        for (link, place) in &self.model.fixed {
            foxglove::put_transform(time, &link.parent, &link.name, &rounded(place), &mut data);
        }
        output.put(self.fixed, tick, &data)?;
        data.clear();
        for model in &self.model.models {
            let primitive = Primitive::Model(&model.glb);
            scene::put_entity(time, &Entity::new(&model.name, &model.frame, primitive), &mut data);
        }
        output.put(self.meshes, tick, &data)?;
        data.clear();
        for name in &self.model.names {
            let primitive = Primitive::Text(&name.text, name.position, LETTERS, INK);
            scene::put_entity(time, &Entity::new(&name.text, &name.frame, primitive), &mut data);
        }
        output.put(self.names, tick, &data)
    }
}

/// Adding zero turns -0.0 into 0.0, because a change of sign at zero is not a movement.
fn round(value: f64) -> f64 {
    (value * STEP).round() / STEP + 0.0
}

fn rounded(transform: &Transform) -> Transform {
    // Both signs of a quaternion are the same orientation, so only one of them is written.
    let sign = if transform.rotation[3] < 0.0 { -1.0 } else { 1.0 };
    Transform {
        position: transform.position.map(round),
        rotation: transform.rotation.map(|value| round(value * sign)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_sign_of_a_quaternion_is_written() {
        let there = Transform { rotation: [0.6, 0.0, 0.0, -0.8], ..Transform::IDENTITY };
        let here = Transform { rotation: [-0.6, 0.0, 0.0, 0.8], ..Transform::IDENTITY };
        assert_eq!(rounded(&there), rounded(&here));
    }

    #[test]
    fn change_below_a_step_is_not_a_movement() {
        let place = Transform { position: [1.0, -1e-9, 0.0], ..Transform::IDENTITY };
        let moved = Transform { position: [1.0 + 1e-7, 1e-9, 0.0], ..Transform::IDENTITY };
        assert_eq!(rounded(&place), rounded(&moved));
        assert!(rounded(&place).position[1].is_sign_positive());
    }
}
