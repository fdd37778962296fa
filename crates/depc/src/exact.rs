//! The unrounded frames: Prim's commands before rounding to 0.01 in and 0.01 degree. A robot with a higher resolution
//! needs the frame from which a position on the line was rounded. This module keeps Prim's last frames, each with the
//! buffer that T3I received, and finds the one whose buffer gives the words. Without a match (a scaled-back point, a
//! reported position), the words determine the frame.

use geometry::{
    frame::{Frame, Vector},
    kinematics::Arm,
    pose::WireFrame,
};

use crate::Plate;

const MOST_FRAMES: usize = 8; // the queue of T3I, one in transit to it, one on the line

#[derive(Clone, Copy, Debug, PartialEq)]
struct Kept {
    wire: WireFrame, // rounded, as in the buffer of T3I
    exact: Frame,    // from Prim
    used: bool,      // it was returned before
}

/// Prim's last frames.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExactFrames {
    frames: [Option<Kept>; MOST_FRAMES], // newest first
}

impl Default for ExactFrames {
    fn default() -> Self {
        Self { frames: [None; MOST_FRAMES] }
    }
}

impl ExactFrames {
    /// Stores a tool frame `exact` (inches, world) that T3I received as `wire`, unless `wire` is not its rounding.
    pub fn offer(&mut self, wire: &WireFrame, exact: &Frame) {
        let newest = self.frames.iter().flatten().next();
        let known = newest.is_some_and(|newest| newest.wire == *wire && newest.exact == *exact);
        if WireFrame::from_frame(exact) == *wire && !known {
            self.frames.rotate_right(1);
            if let Some(newest) = self.frames.first_mut() {
                *newest = Some(Kept { wire: *wire, exact: *exact, used: false });
            }
        }
    }

    /// The unrounded end-plate frame (inches, world) of a position. If no frame has these words, the frame of the words
    /// themselves. Positions arrive in the order of the frames, so older frames are dropped. A repeated position gives
    /// the next frame with the same words.
    pub fn plate_frame(&mut self, words: &Plate, arm: &Arm) -> Frame {
        let gives = |wire: &WireFrame| {
            let tool = wire.to_frame().ok();
            tool.and_then(|tool| Plate::from_tool(&tool, arm, words).ok())
                .is_some_and(|plate| plate.same(words))
        };
        let fits = |kept: &Option<Kept>| kept.is_some_and(|kept| gives(&kept.wire));
        let unused = |kept: &Option<Kept>| kept.is_some_and(|kept| !kept.used);
        let at = self.frames.iter().rposition(|kept| unused(kept) && fits(kept));
        let Some(at) = at.or_else(|| self.frames.iter().rposition(fits)) else { return words.to_frame() };
        self.frames.iter_mut().skip(at.saturating_add(1)).for_each(|older| *older = None);
        match self.frames.get_mut(at) {
            Some(Some(kept)) => {
                kept.used = true;
                kept.exact.shifted(Vector::new(-arm.plate_to_tool, 0.0, 0.0))
            }
            _ => words.to_frame(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::{
        frame::rotation_by,
        kinematics::{HOME_JOINTS, T3},
    };

    fn tool(part: f64) -> Frame {
        let home = T3.forward(&HOME_JOINTS);
        Frame {
            position: home.position + Vector::new(0.123_456, -0.234_567, 0.345_678) * part,
            rotation: rotation_by(&Vector::new(0.01, 0.02, -0.03)) * home.rotation,
        }
    }

    fn words(tool: &Frame) -> Plate {
        let home = Plate::from_frame(&T3.forward_plate(&HOME_JOINTS), &Plate::default()).unwrap();
        Plate::from_tool(&WireFrame::from_frame(tool).to_frame().unwrap(), &T3, &home).unwrap()
    }

    #[test]
    fn words_give_the_frame_before_rounding() {
        let mut exact = ExactFrames::default();
        for part in 1..=6 {
            let tool = tool(f64::from(part));
            exact.offer(&WireFrame::from_frame(&tool), &tool);
        }
        for part in 1..=6 {
            let tool = tool(f64::from(part));
            let found = exact.plate_frame(&words(&tool), &T3);
            let off = found.shifted(Vector::new(T3.plate_to_tool, 0.0, 0.0)).distance(&tool);
            assert!(off.inches < 1e-12 && off.radians < 1e-12, "{off:?}");
        }
    }

    #[test]
    fn equal_words_give_successive_frames() {
        let mut exact = ExactFrames::default();
        let near = [tool(1.0), tool(1.000_1), tool(1.000_2)];
        near.iter().for_each(|tool| exact.offer(&WireFrame::from_frame(tool), tool));
        let words = words(&near[0]);
        let mut next = || exact.plate_frame(&words, &T3).shifted(Vector::new(T3.plate_to_tool, 0.0, 0.0));
        for tool in near.iter().chain([&near[2]]) {
            assert!(next().distance(tool).inches < 1e-12);
        }
    }

    #[test]
    fn repeated_frame_replaces_no_other_frame() {
        let mut exact = ExactFrames::default();
        for part in [1.0, 2.0].into_iter().chain([2.0; MOST_FRAMES]) {
            exact.offer(&WireFrame::from_frame(&tool(part)), &tool(part));
        }
        let found =
            exact.plate_frame(&words(&tool(1.0)), &T3).shifted(Vector::new(T3.plate_to_tool, 0.0, 0.0));
        assert!(found.distance(&tool(1.0)).inches < 1e-12);
    }

    #[test]
    fn other_words_are_their_own_frame_and_excess_bytes_are_dropped() {
        let mut exact = ExactFrames::default();
        exact.offer(&WireFrame::from_frame(&tool(1.0)), &tool(3.0));
        let words = words(&tool(1.0));
        assert_eq!(exact.plate_frame(&words, &T3), words.to_frame());
        for part in 1..=20 {
            exact.offer(&WireFrame::from_frame(&tool(f64::from(part))), &tool(f64::from(part)));
        }
        assert_eq!(exact.plate_frame(&words, &T3), words.to_frame(), "too long ago");
    }
}
