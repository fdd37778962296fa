//! Placing of parts, and reports of their positions.

use geometry::frame::{Frame, Vector as Inches, rotation_by};

use super::{Cell, Placement, WorkstationError, order::TargetPlace};
use crate::{
    bodies,
    convert::{inches, to_pose},
    description::{CellDescription, PartType},
    hand::Hand,
    noise::Noise,
    part::{Part, PartState},
};

/// Greatest height above a tray's floor at which a part is in the tray, in (ASSUMED: tall tools).
const IN_TRAY: f64 = 10.0;
/// Greatest distance between the centre of a part in a nest and the centre of the seat, in.
const IN_NEST: f64 = 1.0;
const DROP: f64 = 0.002; // a part is put down this far above the surface on which it comes to rest, in

impl CellDescription {
    /// The frame, world, in, of a part delivered into a sector: offset by `x` and `y` (in) from its place and turned by
    /// `angle` (degrees). A part that has nests goes only into a nest.
    pub fn delivered(
        &self,
        kind: &PartType,
        unit: &str,
        sector: u16,
        [x, y, angle]: [f64; 3],
    ) -> Result<Frame, WorkstationError> {
        let (place, up) = match self.spot(kind, unit, sector)? {
            TargetPlace::Nest(nest) => (nest.frame(), DROP),
            TargetPlace::Sector(place) => (place, kind.size[0] / 2.0 + DROP),
        };
        let turned = place.turned(&rotation_by(&Inches::new(angle.to_radians(), 0.0, 0.0)));
        Ok(Frame { position: turned.position + Inches::new(x, y, up), ..turned })
    }

    /// The frame of a part that is put down in a sector; `noise` draws a random place. Fails with [`WorkstationError`]
    /// if the unit has no such place.
    pub(crate) fn placed(
        &self,
        kind: &PartType,
        unit: &str,
        sector: u16,
        placement: &Placement,
        noise: &mut Noise,
    ) -> Result<Frame, WorkstationError> {
        let aside = match (*placement, self.spot(kind, unit, sector)?) {
            (Placement::At { x, y, angle }, _) => [x, y, angle],
            (Placement::Random, TargetPlace::Nest(_)) => [0.0; 3],
            (Placement::Random, TargetPlace::Sector(_)) => {
                let greatest = self.tray_shape.random_offset;
                [noise.within(greatest), noise.within(greatest), noise.within(180.0)]
            }
        };
        self.delivered(kind, unit, sector, aside)
    }
}

impl Cell {
    pub(super) fn place_frame(
        &mut self,
        kind: &PartType,
        unit: &str,
        sector: u16,
        placement: &Placement,
    ) -> Result<Frame, WorkstationError> {
        self.description.placed(kind, unit, sector, placement, &mut self.placement_noise)
    }

    /// Put a part into a sector, with the errors of delivery from the fault plan.
    pub(super) fn deliver(
        &mut self,
        part: &str,
        unit: &str,
        sector: u16,
        placement: &Placement,
    ) -> Result<(), WorkstationError> {
        let meant = self.description.kind(part)?.clone();
        let (delivery, changes) = self.faults.delivery(part);
        self.tell(changes);
        let kind =
            delivery.instead.as_deref().map_or(Ok(meant), |other| self.description.kind(other).cloned())?;
        let place = self.place_frame(&kind, unit, sector, placement)?;
        if delivery.missing {
            return Ok(());
        }
        let [x, y] = delivery.aside;
        let turned = place.turned(&rotation_by(&Inches::new(delivery.angle.to_radians(), 0.0, 0.0)));
        self.put(&kind, &Frame { position: turned.position + Inches::new(x, y, 0.0), ..turned })
    }

    pub(super) fn put(&mut self, kind: &PartType, frame: &Frame) -> Result<(), WorkstationError> {
        if let Some(by) = self.in_the_way(kind, frame, None) {
            return Err(WorkstationError::Occupied { part: kind.name.clone(), by });
        }
        let part = Part::new(&mut self.world, self.next_part, kind, frame);
        self.next_part += 1;
        self.parts.push(part);
        Ok(())
    }

    pub(super) fn in_the_way(&self, kind: &PartType, frame: &Frame, but: Option<u32>) -> Option<String> {
        let part = bodies::part(kind, &to_pose(frame));
        let jaw = self.jaw_bodies();
        let furniture = self.obstacles.iter().chain(&jaw).find(|obstacle| part.overlaps(obstacle));
        let parts = self.parts.iter().filter(|other| Some(other.id) != but);
        let parts =
            || parts.clone().find(|one| part.overlaps(&bodies::part(&one.kind, &one.pose(&self.world))));
        furniture
            .map(|obstacle| obstacle.name.to_string())
            .or_else(|| parts().map(|other| other.kind.name.clone()))
    }

    pub(super) fn part_state(&self, index: usize) -> PartState {
        let part = &self.parts[index];
        let frame = part.frame(&self.world);
        let (location, sector, error) = self.locate(index, part, &frame);
        PartState {
            id: part.id,
            name: part.kind.name.clone(),
            location,
            sector,
            held: self.is_held(index),
            clamped: self.is_clamped(index),
            position: frame.position.into(),
            error,
        }
    }

    fn locate(&self, index: usize, part: &Part, frame: &Frame) -> (String, u16, Option<f64>) {
        let at = frame.position;
        if self.is_in_drum(index) {
            return (self.drum_location().into(), 0, self.drum_error(index));
        }
        if self.is_held(index) && !self.is_clamped(index) {
            return ("gripper".into(), 0, None);
        }
        if self.is_held_by(Hand::Pedestal, index) {
            return (self.description.pedestal.location.clone(), 0, None);
        }
        for nest in self.description.nest.iter().filter(|nest| nest.takes(&part.kind)) {
            let away = (at - nest.frame().position).norm();
            if away < IN_NEST {
                return (nest.location.clone(), nest.sector, Some(away));
            }
        }
        for tray in &self.description.tray {
            let shape = &self.description.tray_shape;
            let [x, y] = tray.centre;
            let inside = (at.x - x).abs() < shape.inside / 2.0 && (at.y - y).abs() < shape.inside / 2.0;
            if inside && (tray.floor..tray.floor + IN_TRAY).contains(&at.z) {
                let away = |centre: &[f64; 2]| libm::hypot(at.x - centre[0], at.y - centre[1]);
                let nearest = (1_u16..).zip(&tray.sectors).min_by(|a, b| away(a.1).total_cmp(&away(b.1)));
                return match nearest {
                    Some((sector, centre)) => (tray.unit.clone(), sector, Some(away(centre))),
                    None => (tray.unit.clone(), 0, None),
                };
            }
        }
        if self.vise.contains(&self.vise.frame().inverse().compose(frame).position) {
            return (self.vise.location().into(), 0, Some(self.vise_error(part).0));
        }
        let lowest = self
            .furniture
            .iter()
            .map(|block| block.frame.position.z + block.size.z / 2.0)
            .fold(0.0, f64::min);
        let on_floor = at.z < lowest + inches(part.radius()) + 0.1;
        (if on_floor { "floor" } else { "elsewhere" }.into(), 0, None)
    }
}
