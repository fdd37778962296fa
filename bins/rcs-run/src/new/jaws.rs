//! Chooses the step of the vise for a new part: an existing step, or a new step in the jaws.
//!
//! A step is a notch in both jaws, from the front to its back and down to its ledge. A part fits if it is stable before
//! it is pushed to the back, projects far enough to be pushed, and is wider than the gap between the ledges. A new step
//! is deeper than all others and ends above their ledges.

use plant::description::{Vise, ViseProgram};

/// Length by which a part must project from its step so that the fingers can push it to the back, in.
const PUSHED: f64 = 0.05;
/// Distance of the middle of a part behind the front edge of its ledge, before it is pushed, in.
const STANDS: f64 = 0.03;
const NEAREST: f64 = 0.02; // least distance of a part from the back where it is released, in
const ROUNDING: f64 = 1e-6; // rounding error of the cell description, in
const CLOSED: f64 = 0.05; // least gap of the jaws when they close on a part, in
pub const GRIPPED: f64 = 0.50; // least height of a part above the jaws for the fingers, in
pub const LEDGE: f64 = 0.04; // least width of a part on each ledge, in
const STRIP: f64 = 0.02; // least width of a ledge, in
/// A new step is deeper than the deepest step by this, in.
const DEEPER: f64 = 0.10;
const HIGHER: f64 = 0.6;
const LOWEST: f64 = -0.30;

/// Requirements of a part for a step, in.
pub struct StepNeeds {
    /// Height of the blank in the orientation in which it enters the vise.
    pub height: f64,
    /// Least height of the parts that are pushed to the back, if any.
    pub pushed: Option<f64>,
    /// Length by which the blank projects in front.
    pub out: f64,
    /// Distance before the back where the part is released.
    pub behind: f64,
    /// Width of the blank, and of the narrowest machined part.
    pub width: f64,
    pub narrowest: f64,
    /// Length, which is vertical in the vise.
    pub length: f64,
    /// Height of the lower edge of the fingers above the jaws.
    pub fingers: f64,
    /// Openings of the vise beyond the width: partial and wide.
    pub partial: f64,
    pub open: f64,
    /// True if the part must stand on the ledges of the open vise.
    pub stands_in_open: bool,
}

pub struct Chosen {
    pub program: ViseProgram,
    pub is_new: bool,
    pub behind: f64, // distance before the back where the part is released, in
}

/// The first step that fits: the step of the like part, another step, or a new step. The error has one line per step.
pub fn choose(
    vise: &Vise,
    like: &ViseProgram,
    name: &str,
    wanted: &StepNeeds,
) -> Result<Chosen, Vec<String>> {
    let others = vise.program.iter().filter(|other| other.name != like.name);
    let mut reasons: Vec<String> = Vec::new();
    for step in std::iter::once(like).chain(others) {
        match wanted.program(vise, step, name) {
            Ok((program, behind)) => return Ok(Chosen { program, is_new: false, behind }),
            Err(why) if !reasons.iter().any(|known| known.ends_with(&why)) => {
                reasons.push(format!("step {}: {why}", step.name));
            }
            Err(_) => {}
        }
    }
    match wanted.cut(vise, like).and_then(|step| wanted.program(vise, &step, name)) {
        Ok((program, behind)) => Ok(Chosen { program, is_new: true, behind }),
        Err(why) => {
            reasons.push(format!("a new step: {why}"));
            Err(reasons)
        }
    }
}

impl StepNeeds {
    /// The range for the back of a step whose ledge begins at `front`. Fails with a message if no back fits.
    fn backs(&self, front: f64) -> Result<[f64; 2], String> {
        let least = front + STANDS + NEAREST.min(self.behind) + self.height / 2.0;
        let most = self.pushed.map_or(self.height, |height| height - PUSHED);
        (least <= most).then_some([least, most]).ok_or_else(|| {
            let height = self.height;
            format!("a part {height:.3} in high that stands on its ledge does not come out far enough to be pushed")
        })
    }

    /// The program of a step for the part, and the distance before its back where the part is released.
    fn program(&self, vise: &Vise, step: &ViseProgram, name: &str) -> Result<(ViseProgram, f64), String> {
        let front = front(vise, step).ok_or("deeper steps leave it no ledge")?;
        let [least, most] = self.backs(front)?;
        if step.back < least - ROUNDING || step.back > most + ROUNDING {
            return Err(format!(
                "its back is at {:.2} in, and a part {:.3} in high needs one from {least:.2} to {most:.2} in",
                step.back, self.height
            ));
        }
        let behind = self.behind.min(step.back - front - STANDS - self.height / 2.0);
        let narrow = 2.0 * step.depth + CLOSED;
        if self.narrowest < narrow {
            let width = self.narrowest;
            return Err(format!(
                "it takes parts {narrow:.2} in wide or wider, and this one has {width:.3} in"
            ));
        }
        let gripped = step.ledge + self.length - self.fingers;
        if gripped < GRIPPED {
            return Err(format!(
                "a part {:.2} in long extends {:.2} in above the jaws, and the fingers need {:.2} in",
                self.length,
                step.ledge + self.length,
                self.fingers + GRIPPED
            ));
        }
        let on_ledges = 2.0 * (step.depth - LEDGE);
        let open = if self.stands_in_open { self.open.min(on_ledges) } else { self.open };
        if open < self.partial {
            return Err(format!(
                "the open vise lets a part {:.3} in wide fall between its ledges",
                self.width
            ));
        }
        let [_, thick, _] = vise.jaw;
        let [_, end] = vise.body_y;
        let outside = self.width + open - 2.0 * step.depth + thick;
        if outside > end {
            let widest = self.width - (outside - end);
            return Err(format!(
                "the jaws open for parts up to {widest:.2} in, and this one is {:.2} in wide",
                self.width
            ));
        }
        let program = ViseProgram {
            name: name.to_owned(),
            opening_open: rounded(self.width + open),
            opening_partial: rounded(self.width + self.partial),
            ..step.clone()
        };
        Ok((program, behind))
    }

    fn cut(&self, vise: &Vise, like: &ViseProgram) -> Result<ViseProgram, String> {
        let highest = vise.program.iter().map(|step| step.ledge).fold(f64::NEG_INFINITY, f64::max);
        let deepest = vise.program.iter().map(|step| step.depth).fold(0.0, f64::max);
        let (ledge, depth) = (hundredth(highest * HIGHER), deepest + DEEPER);
        if ledge > LOWEST {
            return Err(format!("the jaws have no room above the ledge at {highest:.2} in"));
        }
        let step = ViseProgram { back: 0.0, depth, ledge, ..like.clone() };
        let front = front(vise, &step).unwrap_or(0.0);
        let [least, most] = self.backs(front)?;
        let [into, ..] = vise.jaw;
        // Both ends are rounded inwards.
        let (least, most) = (hundredth(least + 0.005), hundredth(most.min(into) - 0.005));
        if least > most {
            return Err(format!(
                "a part {:.3} in high would need a back behind {least:.2} in to stand, and before {most:.2} in to be pushed",
                self.height
            ));
        }
        Ok(ViseProgram { back: hundredth(self.height - self.out).clamp(least, most), ..step })
    }
}

/// Start of a step's ledge, measured from the front, where lower and deeper steps leave depth, if any.
fn front(vise: &Vise, step: &ViseProgram) -> Option<f64> {
    let lower: Vec<_> = vise.program.iter().filter(|other| other.ledge < step.ledge).collect();
    let carries = step.depth - LEDGE;
    let mut depths: Vec<f64> =
        lower.iter().map(|other| other.depth).filter(|depth| *depth < carries).collect();
    depths.extend([0.0, carries]);
    depths.sort_by(f64::total_cmp);
    let strips = depths
        .windows(2)
        .filter(|strip| strip.last().unwrap_or(&0.0) - strip.first().unwrap_or(&0.0) >= STRIP);
    let begins = strips.map(|strip| {
        let cut = lower.iter().filter(|other| Some(&other.depth) > strip.first());
        cut.map(|other| other.back).fold(0.0, f64::max)
    });
    begins.min_by(f64::total_cmp)
}

fn rounded(inches: f64) -> f64 {
    (inches * 1000.0).round() / 1000.0
}

fn hundredth(inches: f64) -> f64 {
    (inches * 100.0).round() / 100.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use plant::CellDescription;

    fn vise() -> Vise {
        CellDescription::from_toml(include_str!("../../../../data/cell.toml")).expect("it is sound").vise
    }

    /// The requirements of a clevis of another size.
    fn clevis(height: f64, width: f64, length: f64) -> StepNeeds {
        StepNeeds {
            height,
            pushed: Some(height - 0.05),
            out: 0.13,
            behind: 0.04,
            width,
            narrowest: width,
            length,
            fingers: 0.25,
            partial: 0.08,
            open: 0.20,
            stands_in_open: false,
        }
    }

    fn chosen(wanted: &StepNeeds) -> Result<Chosen, Vec<String>> {
        let vise = vise();
        let like = vise.program.iter().find(|program| program.name == "CLEVIS").expect("it is there").clone();
        choose(&vise, &like, "NEW", wanted)
    }

    #[test]
    fn clevis_gets_its_own_step() {
        let found = chosen(&clevis(1.73, 2.56, 4.0)).unwrap_or_else(|why| panic!("{why:?}"));
        assert!(!found.is_new);
        let program = found.program;
        assert_eq!((program.back, program.depth, program.ledge), (1.60, 0.10, -1.00));
        assert_eq!((program.opening_open, program.opening_partial), (2.76, 2.64));
    }

    #[test]
    fn lower_part_gets_a_new_step() {
        let found = chosen(&clevis(1.0, 1.5, 3.0)).unwrap_or_else(|why| panic!("{why:?}"));
        assert!(found.is_new);
        let program = found.program;
        assert_eq!((program.back, program.ledge), (0.87, -0.60));
        assert!((program.depth - 0.2625).abs() < 1e-9);
        let mut all = vise();
        let before: Vec<_> = all.program.iter().map(|step| front(&all, step)).collect();
        all.program.push(program);
        assert_eq!(all.program.iter().take(2).map(|step| front(&all, step)).collect::<Vec<_>>(), before);
    }

    #[test]
    fn part_without_a_step_is_refused_with_reasons() {
        let why = |wanted: &StepNeeds| chosen(wanted).err().unwrap_or_default().join("\n");
        assert!(why(&clevis(1.73, 3.5, 4.0)).contains("the jaws open for parts up to 3.00 in"));
        assert!(why(&clevis(1.73, 2.56, 1.0)).contains("extends 0.40 in above the jaws"));
        assert!(why(&clevis(1.0, 0.5, 3.0)).contains("in wide or wider, and this one has 0.500 in"));
    }
}
