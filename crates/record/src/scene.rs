//! The moving cell: `/tf`, `/joint_states` and `/robot_description`.
//!
//! Links travel relative to their parents in the URDF, so that a description and its transforms can never
//! contradict each other in a viewer, and so that a link that only turns repeats its position.

use std::io::{Seek, Write};

use mcap::McapResult;

use crate::{
    channels::Output,
    input::{CellFrame, CellModel, WORLD},
    proto::{
        foxglove::{self, Transform},
        ros,
    },
};

/// Steps of a metre, and of the unit of a quaternion, in the log: 1 µm and 1 µrad are finer than any picture,
/// and the zeros behind them compress.
const STEP: f64 = 1_048_576.0;

/// Encoding of the definitions of ROS 2 messages, and of the messages.
const ROS2: (&str, &str) = ("ros2msg", "cdr");

/// The channels of a cell.
pub struct Scene {
    model: CellModel,
    /// Position of each link's parent in the model; none for the world.
    parents: Vec<Option<usize>>,
    transforms: u16,
    joints: u16,
    description: u16,
    described: bool,
    last: Vec<Option<Transform>>,
    last_joints: Vec<f64>,
}

impl Scene {
    /// Open the channels of a cell.
    pub fn open<W: Write + Seek>(output: &mut Output<W>, model: CellModel) -> McapResult<Self> {
        let descriptors = foxglove::frame_transforms_descriptor();
        let transforms = output.protobuf("/tf", foxglove::FRAME_TRANSFORMS, &descriptors)?;
        let definition = ros::JOINT_STATE_DEFINITION.as_bytes();
        let joints = output.channel("/joint_states", ros::JOINT_STATE, ROS2.0, definition, ROS2.1)?;
        let definition = ros::STRING_DEFINITION.as_bytes();
        let description = output.channel("/robot_description", ros::STRING, ROS2.0, definition, ROS2.1)?;
        let position = |name: &str| model.links.iter().position(|link| link.name == name);
        let parents = model.links.iter().map(|link| position(&link.parent)).collect();
        let last = vec![None; model.links.len()];
        let (described, last_joints) = (false, Vec::new());
        Ok(Self { model, parents, transforms, joints, description, described, last, last_joints })
    }

    /// Write what moved since the frame before, or everything.
    pub fn write<W: Write + Seek>(
        &mut self,
        output: &mut Output<W>,
        frame: &CellFrame,
        all: bool,
    ) -> McapResult<()> {
        let mut data = Vec::new();
        if !self.described {
            ros::string(&self.model.urdf, &mut data);
            output.put(self.description, frame.tick, &data)?;
            self.described = true;
        }
        let time = output.epoch.of(frame.tick);
        data.clear();
        self.put_transforms(time, frame, all, &mut data);
        if !data.is_empty() {
            output.put(self.transforms, frame.tick, &data)?;
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

    fn put_transforms(&mut self, time: u64, frame: &CellFrame, all: bool, data: &mut Vec<u8>) {
        let links = self.model.links.iter().zip(&self.parents).zip(&frame.transforms);
        for (((link, parent), place), last) in links.zip(&mut self.last) {
            let parent_place = parent.and_then(|parent| frame.transforms.get(parent));
            let parent_name = if parent_place.is_some() { link.parent.as_str() } else { WORLD };
            let relative = rounded(&parent_place.map_or(*place, |parent| relative_to(parent, place)));
            if all || *last != Some(relative) {
                foxglove::put_transform(time, parent_name, &link.name, &relative, data);
                *last = Some(relative);
            }
        }
    }
}

/// The place `inner`, given in the world, as seen from `outer`.
fn relative_to(outer: &Transform, inner: &Transform) -> Transform {
    let [x, y, z, w] = outer.rotation;
    let inverse = [-x, -y, -z, w];
    let difference = [0, 1, 2].map(|axis| axis_of(&inner.position, axis) - axis_of(&outer.position, axis));
    Transform { position: rotate(inverse, difference), rotation: multiply(inverse, inner.rotation) }
}

fn axis_of(vector: &[f64; 3], axis: usize) -> f64 {
    vector.get(axis).copied().unwrap_or_default()
}

fn multiply([ax, ay, az, aw]: [f64; 4], [bx, by, bz, bw]: [f64; 4]) -> [f64; 4] {
    [
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    ]
}

fn rotate(rotation: [f64; 4], [x, y, z]: [f64; 3]) -> [f64; 3] {
    let [qx, qy, qz, qw] = rotation;
    let [x, y, z, _] = multiply(multiply(rotation, [x, y, z, 0.0]), [-qx, -qy, -qz, qw]);
    [x, y, z]
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
    use std::f64::consts::FRAC_1_SQRT_2;

    #[test]
    fn a_link_is_seen_from_its_parent() {
        // The parent stands at x = 1 and looks along y; the link is one metre ahead of it.
        let quarter = [0.0, 0.0, FRAC_1_SQRT_2, FRAC_1_SQRT_2];
        let parent = Transform { position: [1.0, 0.0, 0.0], rotation: quarter };
        let link = Transform { position: [1.0, 1.0, 0.5], rotation: quarter };
        let seen = rounded(&relative_to(&parent, &link));
        assert_eq!(seen, Transform { position: [1.0, 0.0, 0.5], ..Transform::IDENTITY });
    }

    #[test]
    fn one_sign_of_a_quaternion_is_written() {
        let there = Transform { rotation: [0.6, 0.0, 0.0, -0.8], ..Transform::IDENTITY };
        let here = Transform { rotation: [-0.6, 0.0, 0.0, 0.8], ..Transform::IDENTITY };
        assert_eq!(rounded(&there), rounded(&here));
    }
}
