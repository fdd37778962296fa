//! The path of the tool point so far, as a line: `/trail`.

use std::{
    collections::VecDeque,
    io::{Seek, Write},
};

use mcap::McapResult;

use crate::{
    channels::Output,
    input::{CellFrame, CellModel},
    proto::{
        foxglove::Transform,
        scene::{self, Colour, Entity, Primitive},
    },
};

pub const TRAIL: &str = "/trail";

const TOOL: &str = "quick_change"; // the link whose origin is the tool point
const STEP: u64 = 10; // ticks from one point to the next
const MESSAGE: u64 = 25; // ticks from one message to the next: a second, so that a reader soon finds one
const POINTS: usize = 50; // points of the line, for 20 seconds
const NEAR: f64 = 0.002; // least distance of a new point from the last one, m
const THICKNESS: f64 = 0.006;
const COLOUR: Colour = [0.95, 0.20, 0.45, 0.9];

pub struct Trail {
    channel: u16,
    /// The tool point's link and its chain of parents, in the order of [`CellModel::links`].
    chain: Vec<usize>,
    points: VecDeque<[f64; 3]>,
    longer: bool,
}

impl Trail {
    pub fn open<W: Write + Seek>(output: &mut Output<W>, model: &CellModel) -> McapResult<Self> {
        let channel = output.protobuf(TRAIL, scene::SCENE_UPDATE, &scene::descriptor())?;
        let mut chain = Vec::new();
        let mut name = TOOL;
        for _ in &model.links {
            let mut links = model.links.iter().enumerate();
            let Some((at, link)) = links.find(|(_, link)| link.name == name) else { break };
            chain.push(at);
            name = &link.parent;
        }
        Ok(Self { channel, chain, points: VecDeque::new(), longer: false })
    }

    /// The tool point of a frame, world, metres; `None` in a cell without one.
    pub fn tool_point(&self, frame: &CellFrame) -> Option<[f64; 3]> {
        let places = self.chain.iter().filter_map(|at| frame.transforms.get(*at));
        let point = places.fold([0.0; 3], |point, place| moved(place, point));
        (!self.chain.is_empty()).then_some(point)
    }

    /// Add the tool point of a frame, and write the line once per second if it has become longer.
    pub fn note<W: Write + Seek>(&mut self, output: &mut Output<W>, frame: &CellFrame) -> McapResult<()> {
        let point = self.tool_point(frame).filter(|_| frame.tick.0.is_multiple_of(STEP));
        if let Some(point) = point {
            let apart = |last: &[f64; 3]| last.iter().zip(point).any(|(a, b)| (a - b).abs() > NEAR);
            if self.points.back().is_none_or(apart) {
                self.points.push_back(point.map(|metres| (metres * 1000.0).round() / 1000.0));
                if self.points.len() > POINTS {
                    self.points.pop_front();
                }
                self.longer = self.points.len() > 1;
            }
        }
        if self.longer && frame.tick.0.is_multiple_of(MESSAGE) {
            self.longer = false;
            let mut data = Vec::new();
            let primitive = Primitive::Line(self.points.make_contiguous(), THICKNESS, COLOUR);
            let entity = Entity::new("trail", "world", primitive);
            scene::put_entity(output.epoch.of(frame.tick), &entity, &mut data);
            output.put(self.channel, frame.tick, &data)?;
        }
        Ok(())
    }
}

fn moved(place: &Transform, [x, y, z]: [f64; 3]) -> [f64; 3] {
    let [a, b, c, w] = place.rotation;
    let (s, t, u) = (b * z - c * y + w * x, c * x - a * z + w * y, a * y - b * x + w * z);
    let [left, ahead, up] = place.position;
    [left + x + 2.0 * (b * u - c * t), ahead + y + 2.0 * (c * s - a * u), up + z + 2.0 * (a * t - b * s)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn point_is_rotated_and_then_translated() {
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let place = Transform { position: [1.0, 2.0, 3.0], rotation: [0.0, 0.0, half, half] };
        let there = moved(&place, [2.0, 0.0, 0.5]);
        assert!(there.iter().zip([1.0, 4.0, 3.5]).all(|(a, b)| (a - b).abs() < 1e-12), "{there:?}");
    }
}
