//! Machining: a part at its place, clamped in the vise or in a nest, is replaced by the part that machining makes of
//! it.

use geometry::frame::{Frame, Vector as Inches, rotation_vector};

use super::{Cell, WorkstationError, order::Machine};
use crate::{
    description::{PartType, Shape, Tolerance},
    part::{Part, nearest_square, sizes_along},
};

/// Greatest distance of a part from its seat in the vise (ASSUMED).
pub(crate) const SEATED: Tolerance = Tolerance { inches: 0.03, degrees: 1.0 };
const IN_NEST: f64 = 1.0; // greatest distance of a part in a nest from its seat, in

impl Cell {
    /// Machine the part at `location`. Fails with [`WorkstationError`] if another part is there, or the part is not at
    /// its seat.
    pub(super) fn machine(&mut self, from: &str, to: &str, location: &str) -> Result<(), WorkstationError> {
        let next = self.description.kind(to)?.clone();
        let nest = match self.description.machine_at(location, from)? {
            Machine::Vise => return self.machine_in_vise(from, &next),
            Machine::Nest(nest) => nest,
        };
        let (seat, allowed) = (nest.frame(), nest.machining.unwrap_or(SEATED));
        self.machine_in_nest(from, &next, &seat, allowed, location)
    }

    fn machine_in_vise(&mut self, from: &str, next: &PartType) -> Result<(), WorkstationError> {
        let not_clamped = || WorkstationError::NotClamped { expected: from.into() };
        let clamped = self.vise.clamped.ok_or_else(not_clamped)?;
        let (index, step) = (clamped.part, clamped.step);
        let part = &self.parts[index];
        check_part(from, &part.kind, next)?;
        check_seat(&part.kind, self.vise_error(part), SEATED)?;
        let here = self.vise.frame().inverse().compose(&part.frame(&self.world));
        let side = front(&here);
        if next.other_side && part.machined.contains(&side) {
            return Err(WorkstationError::SameSide { part: from.into() });
        }
        let along = |kind: &PartType| sizes_along(&here, kind);
        let shift = self.vise.seat(step, &along(next)) - self.vise.seat(step, &along(&part.kind));
        let shift = here.rotation.inverse() * shift;
        self.unclamp();
        self.parts[index].become_kind(&mut self.world, next, shift);
        self.parts[index].machined.push(side);
        if let Some(squeeze) = self.between_jaws_of(index, step) {
            let gap = self.vise.stop(step, squeeze.width);
            self.vise.follow(&mut self.world, gap);
            let middle = self.vise.fixed_face(step) + squeeze.width / 2.0;
            self.clamp(index, step, &squeeze, middle);
        }
        Ok(())
    }

    /// In a nest the machine holds the part itself, and releases it afterwards.
    fn machine_in_nest(
        &mut self,
        from: &str,
        next: &PartType,
        seat: &Frame,
        allowed: Tolerance,
        location: &str,
    ) -> Result<(), WorkstationError> {
        let away = |part: &Part| (part.frame(&self.world).position - seat.position).norm();
        let nearest = (0..self.parts.len())
            .filter(|index| away(&self.parts[*index]) < IN_NEST)
            .min_by(|a, b| away(&self.parts[*a]).total_cmp(&away(&self.parts[*b])));
        let nothing = || WorkstationError::NothingThere { expected: from.into(), location: location.into() };
        let index = nearest.ok_or_else(nothing)?;
        let part = &self.parts[index];
        check_part(from, &part.kind, next)?;
        if self.is_held_or_clamped(index) {
            return Err(WorkstationError::InHand { part: from.into() });
        }
        let here = seat.inverse().compose(&part.frame(&self.world));
        check_seat(&part.kind, (here.position.norm(), askew(&here, part.kind.shape)), allowed)?;
        self.parts[index].become_kind(&mut self.world, next, Inches::zeros());
        Ok(())
    }

    /// Distance of a part in the vise from its seat: inches of its middle, radians to the nearest equivalent axes.
    pub(super) fn vise_error(&self, part: &Part) -> (f64, f64) {
        let here = self.vise.frame().inverse().compose(&part.frame(&self.world));
        let seat = self.vise.seat(self.vise.present_step(), &sizes_along(&here, &part.kind));
        ((here.position - seat).norm(), askew(&here, Shape::Box))
    }
}

pub(crate) fn check_part(from: &str, part: &PartType, next: &PartType) -> Result<(), WorkstationError> {
    if part.name != from {
        return Err(WorkstationError::WrongPart { expected: from.into(), found: part.name.clone() });
    }
    next.is_made_of(part)
}

pub(crate) fn check_seat(
    part: &PartType,
    (distance, angle): (f64, f64),
    allowed: Tolerance,
) -> Result<(), WorkstationError> {
    let degrees = angle.to_degrees();
    if distance <= allowed.inches && degrees <= allowed.degrees {
        return Ok(());
    }
    Err(WorkstationError::NotSeated { part: part.name.clone(), distance, degrees, allowed })
}

/// Angle of a part from the nearest attitude that is equivalent to that of its seat, radians.
pub(crate) fn askew(here: &Frame, shape: Shape) -> f64 {
    let off = |axis: Inches, own: Inches| libm::acos(axis.dot(&own).abs().min(1.0));
    match shape {
        Shape::Box => {
            let square = nearest_square(here);
            rotation_vector(&(here.rotation * square.rotation.inverse())).norm()
        }
        Shape::CylinderX => off(here.x(), Inches::x()),
        Shape::CylinderZ => off(here.z(), Inches::z()),
    }
}

/// The side of a part that faces the front of the vise, as a unit vector along one of the part's axes.
fn front(here: &Frame) -> [i8; 3] {
    let out = nearest_square(here).rotation.inverse() * -Inches::x();
    let sign = |along: f64| {
        if along > 0.5 {
            1
        } else if along < -0.5 {
            -1
        } else {
            0
        }
    };
    [sign(out.x), sign(out.y), sign(out.z)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reversed_part_shows_its_other_side() {
        let at = |along_x: f64| {
            let rotation = geometry::frame::rotation_from_x_y(&Inches::new(along_x, 0.03, 0.0), &Inches::z());
            front(&Frame { position: Inches::zeros(), rotation: rotation.unwrap() })
        };
        assert_eq!((at(1.0), at(-1.0)), ([-1, 0, 0], [1, 0, 0]));
    }

    #[test]
    fn cylinder_orientation_ignores_rotation_about_its_axis() {
        use geometry::frame::rotation_by;
        let at = |turn: Inches| Frame { position: Inches::zeros(), rotation: rotation_by(&turn) };
        assert!(askew(&at(Inches::new(0.0, 0.0, 1.0)), Shape::CylinderZ) < 1e-7);
        assert!(askew(&at(Inches::new(core::f64::consts::PI, 0.0, 0.0)), Shape::CylinderZ) < 1e-7);
        assert!((askew(&at(Inches::new(0.1, 0.0, 0.0)), Shape::CylinderZ) - 0.1).abs() < 1e-9);
        assert!((askew(&at(Inches::new(0.0, 0.0, 0.1)), Shape::CylinderX) - 0.1).abs() < 1e-9);
        assert!(
            (askew(&at(Inches::new(0.0, 0.0, 1.7)), Shape::Box) - (1.7 - core::f64::consts::FRAC_PI_2)).abs()
                < 1e-9
        );
    }
}
