//! The moving cell: `/tf`, `/tf_static`, `/joint_states` and `/robot_description`; and `/cell`, the digest of everything in it.
//!
//! Links travel relative to their parents in the URDF, so that a description and its transforms can never
//! contradict each other in a viewer, and so that a link that only turns repeats its position.

use std::io::{Seek, Write};

use mcap::McapResult;
use prost_types::field_descriptor_proto::Type;
use rcs_core::tick::Tick;

use crate::{
    channels::Output,
    input::{CellFrame, CellModel},
    proto::{
        descriptor::{self, encode_set, field, file},
        foxglove::{self, Transform},
        ros, wire,
    },
};

/// Topic of the digests of the cell.
pub const CELL_TOPIC: &str = "/cell";
/// Field number of the digest in its message.
pub const DIGEST: u32 = 1;

/// Steps of a metre, and of the unit of a quaternion, in the log: 1 µm and 1 µrad are finer than any picture,
/// and the zeros behind them compress.
const STEP: f64 = 1_048_576.0;

/// Encoding of the definitions of ROS 2 messages, and of the messages.
const ROS2: (&str, &str) = ("ros2msg", "cdr");

/// The channels of a cell.
pub struct Scene {
    model: CellModel,
    digests: u16,
    moving: u16,
    fixed: u16,
    joints: u16,
    description: u16,
    described: bool,
    last: Vec<Option<Transform>>,
    last_joints: Vec<f64>,
}

impl Scene {
    /// Open the channels of a cell.
    pub fn open<W: Write + Seek>(output: &mut Output<W>, model: CellModel) -> McapResult<Self> {
        let digests = output.protobuf(CELL_TOPIC, "rcs.CellTick", &cell_descriptor())?;
        let descriptors = foxglove::frame_transforms_descriptor();
        let moving = output.protobuf("/tf", foxglove::FRAME_TRANSFORMS, &descriptors)?;
        let fixed = output.protobuf("/tf_static", foxglove::FRAME_TRANSFORMS, &descriptors)?;
        let definition = ros::JOINT_STATE_DEFINITION.as_bytes();
        let joints = output.channel("/joint_states", ros::JOINT_STATE, ROS2.0, definition, ROS2.1)?;
        let definition = ros::STRING_DEFINITION.as_bytes();
        let description = output.channel("/robot_description", ros::STRING, ROS2.0, definition, ROS2.1)?;
        let last = vec![None; model.links.len()];
        let (described, last_joints) = (false, Vec::new());
        Ok(Self { model, digests, moving, fixed, joints, description, described, last, last_joints })
    }

    /// Write what moved since the frame before, or everything that moves; before the first frame also what
    /// does not.
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
        if let Some(digest) = frame.digest {
            wire::fixed64(DIGEST, digest, &mut data);
            output.put(self.digests, frame.tick, &data)?;
            data.clear();
        }
        for ((link, place), last) in self.model.links.iter().zip(&frame.transforms).zip(&mut self.last) {
            let place = rounded(place);
            if all || *last != Some(place) {
                foxglove::put_transform(time, &link.parent, &link.name, &place, &mut data);
                *last = Some(place);
            }
        }
        if !data.is_empty() {
            output.put(self.moving, frame.tick, &data)?;
        }
        let joints = frame.joints.get(..self.model.joints.len()).unwrap_or_default();
        if all || joints != self.last_joints {
            data.clear();
            ros::joint_state(time, &self.model.joints, joints, &mut data);
            output.put(self.joints, frame.tick, &data)?;
            self.last_joints = joints.to_vec();
        }
        Ok(())
    }

    /// What is true for the whole log.
    fn describe<W: Write + Seek>(&self, output: &mut Output<W>, tick: Tick) -> McapResult<()> {
        let mut data = Vec::new();
        ros::string(&self.model.urdf, &mut data);
        output.put(self.description, tick, &data)?;
        data.clear();
        let time = output.epoch.of(tick);
        for (link, place) in &self.model.fixed {
            foxglove::put_transform(time, &link.parent, &link.name, &rounded(place), &mut data);
        }
        output.put(self.fixed, tick, &data)
    }
}

fn cell_descriptor() -> Vec<u8> {
    let number = i32::try_from(DIGEST).unwrap_or(i32::MAX);
    let message = descriptor::message("CellTick", vec![field("digest", number, Type::Fixed64)]);
    encode_set(vec![file("rcs_cell.proto", descriptor::PACKAGE, &[], vec![message])])
}

fn rounded(transform: &Transform) -> Transform {
    // Adding zero turns -0.0 into 0.0: a sign that flickers around zero is no movement.
    let round = |value: f64| (value * STEP).round() / STEP + 0.0;
    // Both signs of a quaternion are the same orientation; one of them is written.
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
    fn what_is_finer_than_a_step_is_no_movement() {
        let place = Transform { position: [1.0, -1e-9, 0.0], ..Transform::IDENTITY };
        let moved = Transform { position: [1.0 + 1e-7, 1e-9, 0.0], ..Transform::IDENTITY };
        assert_eq!(rounded(&place), rounded(&moved));
        assert!(rounded(&place).position[1].is_sign_positive());
    }
}
