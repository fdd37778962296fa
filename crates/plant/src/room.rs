//! The cell for the path check: positions of all bodies, without physics and time. [`Room::look`] sets the robot to
//! joint angles and returns its contacts, with the bodies and the clearance check of a run.

use geometry::{
    frame::{Frame, Vector as Inches},
    kinematics::{Joints, T3},
};

use crate::{
    bodies,
    clearance::{Body, Clearance, Contact},
    convert::to_pose,
    description::{CellDescription, Gripper, Mounted, PartType},
    holster::{Holster, holsters},
    part::{nearest_square, sizes_along},
    pedestal::hand_frame,
    scene::{furniture, vise_frame},
    vise::Jaws,
};

const GRIPPERS: [&str; 3] = ["parts_gripper", "v_gripper", "tool_gripper"];
/// Greatest distance between the centre of a part in a nest and the centre of the seat, in.
const IN_NEST: f64 = 1.0;
/// Step in which a part is lowered, in, and number of times that the last step is halved.
const STEP: f64 = 0.02;
const HALVES: u32 = 8;

#[derive(Clone, Debug, PartialEq)]
pub struct Placed {
    pub kind: PartType,
    /// Its frame, in: in the tool frame if the robot holds it, else in the world.
    pub frame: Frame,
}

/// Positions of all objects that a job moves. Openings in inches, the table angle in degrees.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    pub gripper: Option<u8>, // end effector id
    /// End effector id of a gripper in its holster with which the robot is engaged, if any. It is then not an obstacle.
    pub engaged: Option<u8>,
    pub opening: f64,
    pub held: Option<Placed>,
    pub parts: Vec<Placed>,
    pub program: usize, // from 0
    pub jaws: f64,      // between their inner faces
    pub table: f64,
    pub hand: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clamped {
    Part(usize), // by its index
    Held,
}

#[derive(Debug)]
pub struct Room {
    cell: CellDescription,
    standing: Vec<Body>,
    holsters: [Holster; 3],
}

impl Room {
    #[must_use]
    pub fn new(cell: &CellDescription) -> Self {
        Self {
            standing: bodies::standing(cell, &furniture(cell)),
            holsters: holsters(cell),
            cell: cell.clone(),
        }
    }

    #[must_use]
    pub const fn cell(&self) -> &CellDescription {
        &self.cell
    }

    #[must_use]
    pub fn at_start(&self) -> Layout {
        let gripper = match self.cell.quick_change.mounted {
            Mounted::None => None,
            Mounted::Parts => Some(1),
            Mounted::V => Some(2),
            Mounted::Tool => Some(3),
        };
        let table = &self.cell.pedestal.table;
        Layout {
            gripper,
            engaged: None,
            opening: gripper.and_then(|id| self.gripper(id)).map_or(0.0, |gripper| gripper.initial_opening),
            held: None,
            parts: Vec::new(),
            program: 0,
            jaws: self.jaws(0, Jaws::Open),
            table: table.angle(table.start),
            hand: self.cell.pedestal.hand.initial_opening,
        }
    }

    #[must_use]
    pub fn worn(&self, layout: &Layout) -> Option<&Gripper> {
        self.gripper(layout.gripper?)
    }

    #[must_use]
    pub fn gripper(&self, id: u8) -> Option<&Gripper> {
        let grippers = &self.cell.gripper;
        [&grippers.parts, &grippers.v, &grippers.tool].get(usize::from(id).checked_sub(1)?).copied()
    }

    /// Distance of the inner faces of the vise's jaws in a program, in.
    #[must_use]
    pub fn jaws(&self, program: usize, jaws: Jaws) -> f64 {
        self.cell.vise.program.get(program).map_or(0.0, |program| jaws.gap(program))
    }

    /// The seat in the vise of a part near it: its frame, and the distance of the jaws when closed on it, in.
    #[must_use]
    pub fn vise_seat(&self, program: usize, part: &Placed) -> Option<(Frame, f64)> {
        let program = self.cell.vise.program.get(program)?;
        let vise = vise_frame(&self.cell.vise);
        let here = vise.inverse().compose(&part.frame);
        let size = sizes_along(&here, &part.kind);
        let seat = Frame { position: program.seat(&size), ..nearest_square(&here) };
        Some((vise.compose(&seat), size.y - 2.0 * program.depth))
    }

    /// Index of the part in the vise: its middle is within the jaws.
    #[must_use]
    pub fn in_vise(&self, layout: &Layout) -> Option<usize> {
        let vise = vise_frame(&self.cell.vise).inverse();
        let [into, thick, height] = self.cell.vise.jaw;
        layout.parts.iter().position(|part| {
            let at = vise.compose(&part.frame).position;
            (-1.0..into).contains(&at.x)
                && (-thick..layout.jaws + thick).contains(&at.y)
                && (-height..height).contains(&at.z)
        })
    }

    /// Close the jaws on the part between them. A part held by nothing else moves to its seat. Returns the part in the
    /// jaws.
    pub fn clamp(&self, layout: &mut Layout, tool: &Frame) -> Option<Clamped> {
        layout.jaws = self.jaws(layout.program, Jaws::Open);
        let index = self.in_vise(layout);
        let held =
            layout.held.as_ref().map(|held| Placed { frame: tool.compose(&held.frame), ..held.clone() });
        let held_in_vise =
            |held: &Placed| self.in_vise(&Layout { parts: vec![held.clone()], ..layout.clone() }).is_some();
        let held = held.filter(|held| index.is_none() && held_in_vise(held));
        layout.jaws = self.jaws(layout.program, Jaws::Closed);
        if let Some((index, part)) = index.and_then(|index| Some((index, layout.parts.get_mut(index)?))) {
            (part.frame, layout.jaws) = self.vise_seat(layout.program, part)?;
            return Some(Clamped::Part(index));
        }
        (_, layout.jaws) = self.vise_seat(layout.program, &held?)?;
        Some(Clamped::Held)
    }

    /// The seat of the nest that contains a part, if any.
    #[must_use]
    pub fn nest_seat(&self, part: &Placed) -> Option<Frame> {
        let nests = self.cell.nest.iter().filter(|nest| nest.takes(&part.kind)).map(|nest| nest.frame());
        nests.into_iter().find(|seat| (seat.position - part.frame.position).norm() < IN_NEST)
    }

    #[must_use]
    pub fn in_the_way(&self, part: &Placed, layout: &Layout) -> Option<String> {
        let part = bodies::part(&part.kind, &to_pose(&part.frame));
        let devices = self.devices(layout);
        let other = self.standing.iter().chain(&devices).find(|other| part.overlaps(other))?;
        Some(other.name.to_string())
    }

    /// Final frame of a part lowered from `above` along `down`. `None` if it touches a body at the start, or none
    /// within `deepest` in.
    #[must_use]
    pub fn let_down(&self, kind: &PartType, above: &Frame, down: &Inches, deepest: f64) -> Option<Frame> {
        let at = |deep: f64| Frame { position: above.position + down * deep, ..*above };
        let touches = |deep: &f64| {
            let body = bodies::held(kind, &to_pose(&at(*deep)));
            self.look(&[body], &[], 0.0).iter().any(Contact::touches)
        };
        let steps = std::iter::successors(Some(0.0), |deep| Some(deep + STEP));
        let first = steps.take_while(|deep| *deep <= deepest).find(touches).filter(|deep| *deep > 0.0)?;
        let (mut free, mut met) = (first - STEP, first);
        for _ in 0..HALVES {
            let middle = 0.5 * (free + met);
            *(if touches(&middle) { &mut met } else { &mut free }) = middle;
        }
        Some(at(free))
    }

    /// Frame of a part in the pedestal's hand after the table has turned to an angle, degrees.
    #[must_use]
    pub fn turned(&self, layout: &Layout, to: f64, frame: &Frame) -> Frame {
        let [before, after] = [layout.table, to].map(|angle| hand_frame(&self.cell.pedestal, angle));
        after.compose(&before.inverse().compose(frame))
    }

    #[must_use]
    pub fn devices(&self, layout: &Layout) -> Vec<Body> {
        let jaw = vise_frame(&self.cell.vise).shifted(Inches::new(0.0, layout.jaws, 0.0));
        let mut devices = bodies::movable_jaw(&self.cell, &jaw);
        for (id, (name, holster)) in (1..).zip(GRIPPERS.into_iter().zip(&self.holsters)) {
            let stored = self.gripper(id).filter(|_| ![layout.gripper, layout.engaged].contains(&Some(id)));
            let at = to_pose(&holster.gripper(&holster.seated()));
            devices.extend(stored.into_iter().flat_map(|one| bodies::stored(&self.cell, one, name, &at)));
        }
        let hand = hand_frame(&self.cell.pedestal, layout.table);
        devices.extend(bodies::pedestal(&self.cell, &hand, layout.hand));
        devices.extend(layout.parts.iter().map(|part| bodies::part(&part.kind, &to_pose(&part.frame))));
        devices
    }

    /// Bodies of the robot at joint angles in radians, with its gripper and the carried part.
    #[must_use]
    pub fn movers(&self, layout: &Layout, joints: &Joints) -> Vec<Body> {
        let tool = T3.forward(joints);
        let mut movers = Vec::from(bodies::arm(&self.cell, joints));
        movers.extend(bodies::quick_change(&self.cell, &tool));
        if let Some(gripper) = self.worn(layout) {
            movers.extend(bodies::worn(&self.cell, gripper, &tool, layout.opening));
        }
        if let Some(held) = &layout.held {
            movers.push(bodies::held(&held.kind, &to_pose(&tool.compose(&held.frame))));
        }
        movers
    }

    /// Contacts of the robot, and bodies nearer than `margin` inches, as in [`crate::Cell::contacts`].
    #[must_use]
    pub fn look(&self, movers: &[Body], devices: &[Body], margin: f64) -> Vec<Contact> {
        let arm = movers.iter().filter(|body| body.kind.is_obstacle());
        let all = self.standing.iter().chain(devices).chain(arm);
        let mut clearance = Clearance::default();
        clearance.watch(margin);
        clearance.check(&self.cell.contact, movers, all);
        clearance.into_contacts()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cell, WorkstationAction};
    use geometry::kinematics::HOME_JOINTS;

    fn cell() -> CellDescription {
        CellDescription::from_toml(include_str!("../../../data/cell.toml")).unwrap()
    }

    #[test]
    fn lowered_part_is_in_its_nest() {
        let description = cell();
        let room = Room::new(&description);
        for nest in &description.nest {
            let (seat, kind) = (nest.frame(), description.part(&nest.parts[0]).unwrap());
            // Parts lie with X down, and are upright in the pocket with Z up.
            let down = if seat.x().z < -0.5 { seat.x() } else { -seat.z() };
            let above = Frame { position: seat.position - down * 4.0, ..seat };
            let stands = room.let_down(kind, &above, &down, 5.0).unwrap();
            let off = (stands.position - seat.position).norm();
            assert!(off < 0.01, "{kind:?} {off}");
            assert!(room.let_down(kind, &above, &down, 3.9).is_none());
            assert!(
                room.let_down(kind, &Frame { position: seat.position + down, ..seat }, &down, 1.0).is_none()
            );
        }
    }

    /// A running cell and the room report the same positions and contacts.
    #[test]
    fn room_and_cell_agree() {
        let description = cell();
        let room = Room::new(&description);
        for joints in [
            HOME_JOINTS,
            [-30.0, 20.0, -40.0, 10.0, 5.0, 20.0].map(f64::to_radians),
            [-170.0, 60.0, -120.0, -30.0, -8.0, 40.0].map(f64::to_radians),
        ] {
            let mut cell = Cell::new(&description, 1).unwrap();
            let part = WorkstationAction::Place {
                part: "LINKBAR1_BH".into(),
                unit: "UNIT_1".into(),
                sector: 4,
                placement: crate::Placement::At { x: 0.0, y: 0.0, angle: 30.0 },
            };
            cell.workstation(&part).unwrap();
            cell.watch_clearance(20.0);
            cell.drive(&T3.forward_plate(&joints)).unwrap();
            for _ in 0..400 {
                cell.step(&Default::default());
            }
            let mut layout = room.at_start();
            let kind = description.part("LINKBAR1_BH").unwrap().clone();
            let frame = cell.part_frame(1).unwrap();
            layout.parts.push(Placed { kind, frame });
            layout.opening = cell.fingers().0;
            let devices = room.devices(&layout);
            let found = room.look(&room.movers(&layout, &cell.joints()), &devices, 20.0);
            let expected = cell.contacts();
            assert!(!expected.is_empty());
            assert_eq!(found.len(), expected.len());
            for (one, other) in found.iter().zip(expected) {
                assert_eq!(one.pair(), other.pair());
                assert!((one.depth - other.depth).abs() < 1e-6, "{one:?} {other:?}");
            }
        }
    }
}
