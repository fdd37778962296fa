//! Disturbances of the cell by a person between two commands, drawn by campaigns of confirmations (`--truth`).

use std::fmt;

use geometry::frame::{Frame, Vector};
use interfaces::device::KNOB_FULL;
use plant::{BoxAction, BoxButton, Cell, Placement, WorkstationAction, WorkstationError};

/// Velocity of the joystick box with its knob at the maximum, in/s.
const BOX_SPEED: f64 = levels::prim::manual::SPEED;
const SECONDS: f64 = 1.0; // time in which a person moves the robot a short way, s
const FASTEST: f64 = 0.5; // greatest share of the box's velocity
/// Least share of the box's velocity. A slower robot would not stop at the intended position.
const SLOWEST: f64 = 0.02;

#[derive(Clone, Debug, PartialEq)]
pub enum DisturbanceKind {
    /// The joystick leads the robot by this vector, world, 0.01 in.
    Jog([i32; 3]),
    Take(usize),
    /// A person moves a part by this vector, world, 0.01 in.
    Move(usize, [i32; 2]),
    Swap(usize, String),
    /// A person puts a part into a sector (0 for none) of a tray or a nest, or into the drum.
    Add(String, String, u16),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Follow {
    /// PAUSE, and the interrupted command again.
    Same,
    /// PAUSE, and the next command of the job.
    Next,
    /// The previous, finished command again, and then the interrupted one.
    Again,
}

impl Follow {
    pub const ALL: [(Self, &'static str); 3] =
        [(Self::Same, ""), (Self::Next, ":next"), (Self::Again, ":again")];

    pub fn text(self) -> &'static str {
        Self::ALL.iter().find(|(one, _)| *one == self).map_or("", |(_, text)| text)
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Disturbance {
    pub what: DisturbanceKind,
    pub then: Follow,
}

/// Names of the kinds, in the order of their words.
pub const WORDS: [&str; 5] = ["jog", "take", "move", "swap", "add"];

impl DisturbanceKind {
    #[must_use]
    pub const fn word(&self) -> &'static str {
        match self {
            Self::Jog(_) => WORDS[0],
            Self::Take(_) => WORDS[1],
            Self::Move(..) => WORDS[2],
            Self::Swap(..) => WORDS[3],
            Self::Add(..) => WORDS[4],
        }
    }
}

/// `jog:30:0:-5`, `take:1`, `move:1:40:0`, `swap:1:SHAFT`, `add:SHAFT:UNIT_2:7`; with `:next` or `:again` if another
/// command follows.
impl fmt::Display for Disturbance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.what.word())?;
        match &self.what {
            DisturbanceKind::Jog([x, y, z]) => write!(f, ":{x}:{y}:{z}"),
            DisturbanceKind::Take(part) => write!(f, ":{part}"),
            DisturbanceKind::Move(part, [x, y]) => write!(f, ":{part}:{x}:{y}"),
            DisturbanceKind::Swap(part, kind) => write!(f, ":{part}:{kind}"),
            DisturbanceKind::Add(kind, place, sector) => write!(f, ":{kind}:{place}:{sector}"),
        }?;
        f.write_str(self.then.text())
    }
}

impl Disturbance {
    #[must_use]
    pub fn named(text: &str) -> Option<Self> {
        let ends = |(then, end): &(Follow, &str)| Some((text.strip_suffix(end)?, *then));
        let (text, then) = Follow::ALL[1..].iter().find_map(ends).unwrap_or((text, Follow::Same));
        let words: Vec<&str> = text.split(':').collect();
        let number = |word: &str| word.parse().ok();
        let what = match words[..] {
            ["jog", x, y, z] => DisturbanceKind::Jog([number(x)?, number(y)?, number(z)?]),
            ["take", part] => DisturbanceKind::Take(part.parse().ok()?),
            ["move", part, x, y] => DisturbanceKind::Move(part.parse().ok()?, [number(x)?, number(y)?]),
            ["swap", part, kind] => DisturbanceKind::Swap(part.parse().ok()?, kind.to_owned()),
            ["add", kind, place, sector] => {
                DisturbanceKind::Add(kind.to_owned(), place.to_owned(), sector.parse().ok()?)
            }
            _ => return None,
        };
        Some(Self { what, then })
    }
}

fn inches([x, y, z]: [i32; 3]) -> Vector {
    Vector::new(f64::from(x), f64::from(y), f64::from(z)) / 100.0
}

/// A motion of the robot by hand: first along X and Y with the stick, then along Z with the buttons.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lead {
    start: Option<Vector>,
    way: Vector,
    upward: bool, // along Z, after X and Y
    idle: u32,    // ticks without progress
    done: f64,
}

const IDLE: u32 = 50; // ticks without progress after which a person gives up, as at a limit of the arm

impl Lead {
    /// Move the robot by a vector, 0.01 in.
    #[must_use]
    pub fn by(hundredths: [i32; 3]) -> Self {
        Self { start: None, way: inches(hundredths), upward: false, idle: 0, done: 0.0 }
    }

    /// Move the robot back over the same way.
    #[must_use]
    pub fn back(hundredths: [i32; 3]) -> Self {
        Self::by(hundredths.map(|one| -one))
    }

    #[must_use]
    pub fn knob(&self) -> u16 {
        let share = (self.way.norm() / SECONDS / BOX_SPEED).clamp(SLOWEST, FASTEST);
        (share * f64::from(KNOB_FULL)) as u16
    }

    /// The control to hold in the next tick; `None` if the robot has arrived.
    pub fn step(&mut self, cell: &Cell) -> Option<BoxAction> {
        let at = cell.t3().arm().tool().position;
        let moved = at - *self.start.get_or_insert(at);
        loop {
            let leg = if self.upward {
                Vector::new(0.0, 0.0, self.way.z)
            } else {
                Vector::new(self.way.x, self.way.y, 0.0)
            };
            let length = leg.norm();
            let done = if length > 0.0 { moved.dot(&leg) / length } else { 0.0 };
            self.idle = if done > self.done + 1e-4 { 0 } else { self.idle + 1 };
            self.done = self.done.max(done);
            // The robot continues for about a fifth of a second when the control is released.
            let coast = 0.15 * BOX_SPEED * f64::from(self.knob()) / f64::from(KNOB_FULL);
            if done + coast.min(length / 2.0) < length && self.idle < IDLE {
                return Some(self.control(&leg));
            }
            if self.upward {
                return None;
            }
            (self.upward, self.idle, self.done) = (true, 0, f64::NEG_INFINITY);
        }
    }

    fn control(&self, leg: &Vector) -> BoxAction {
        if self.upward {
            return BoxAction::Press(if leg.z > 0.0 { BoxButton::Up } else { BoxButton::Down }, 1);
        }
        let share = |along: f64| (along / leg.norm() * f64::from(KNOB_FULL)) as i16;
        BoxAction::Stick { x: share(leg.x), y: share(leg.y), ticks: 1 }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub enum Undo {
    Put(String, Frame),
    Back(u32, Frame),
    Remove(u32),
}

fn free(cell: &Cell) -> Vec<u32> {
    let had =
        |id: u32| cell.holders(id).is_none_or(|holders| holders.robot || holders.pedestal || holders.vise);
    cell.parts().into_iter().map(|part| part.id).filter(|id| !had(*id)).collect()
}

/// Change the cell. Returns the numbers of the changed parts, and the step that undoes the change. On error, the cell
/// is unchanged.
pub fn change(cell: &mut Cell, what: &DisturbanceKind) -> Result<(Vec<u32>, Vec<Undo>), String> {
    let said = |error: WorkstationError| error.to_string();
    let chosen = |cell: &Cell, number: usize| {
        let parts = free(cell);
        let id = number.checked_sub(1).and_then(|index| parts.get(index % parts.len().max(1))).copied();
        let id = id.ok_or_else(|| "no part lies free in the cell".to_owned())?;
        let frame = cell.part_frame(id).ok_or_else(|| "the part has no frame".to_owned())?;
        let name = cell.part_kind(id).map_or_else(String::new, |kind| kind.name.clone());
        Ok::<_, String>((id, frame, name))
    };
    match what {
        DisturbanceKind::Jog(_) => Ok((Vec::new(), Vec::new())),
        DisturbanceKind::Take(part) => {
            let (id, frame, name) = chosen(cell, *part)?;
            cell.take_part(id).map_err(said)?;
            Ok((vec![id], vec![Undo::Put(name, frame)]))
        }
        DisturbanceKind::Move(part, [x, y]) => {
            let (id, frame, _) = chosen(cell, *part)?;
            let moved = Frame { position: frame.position + inches([*x, *y, 0]), ..frame };
            cell.move_part(id, &moved).map_err(said)?;
            Ok((vec![id], vec![Undo::Back(id, frame)]))
        }
        DisturbanceKind::Swap(part, kind) => {
            let (id, frame, name) = chosen(cell, *part)?;
            cell.take_part(id).map_err(said)?;
            let height = |name: &str| cell.description().part(name).map_or(0.0, |kind| kind.size[0] / 2.0);
            let up = Vector::new(0.0, 0.0, height(kind) - height(&name));
            let raised = Frame { position: frame.position + up, ..frame };
            let new = cell.next_part_number();
            let put = |part: &str, frame: Frame| WorkstationAction::Put { part: part.to_owned(), frame };
            if cell.workstation(&put(kind, raised)).is_err() {
                // The new part does not fit, so the old one returns. It gets another number.
                cell.workstation(&put(&name, frame)).map_err(said)?;
                return Ok((vec![id, new], Vec::new()));
            }
            Ok((vec![id, new], vec![Undo::Remove(new), Undo::Put(name, frame)]))
        }
        DisturbanceKind::Add(kind, place, sector) => {
            let new = cell.next_part_number();
            let action = if *place == cell.description().drum.location {
                WorkstationAction::DrumTool { part: kind.clone() }
            } else {
                WorkstationAction::Place {
                    part: kind.clone(),
                    unit: place.clone(),
                    sector: *sector,
                    placement: Placement::At { x: 0.0, y: 0.0, angle: 0.0 },
                }
            };
            cell.workstation(&action).map_err(said)?;
            Ok((vec![new], vec![Undo::Remove(new)]))
        }
    }
}

/// Undo a change. Returns the number of the part. Fails for example if the robot has taken the part.
pub fn undo(cell: &mut Cell, step: &Undo) -> Result<u32, String> {
    let said = |error: WorkstationError| error.to_string();
    match step {
        Undo::Put(kind, frame) => {
            let new = cell.next_part_number();
            let put = WorkstationAction::Put { part: kind.clone(), frame: *frame };
            cell.workstation(&put).map_err(said)?;
            Ok(new)
        }
        Undo::Back(id, frame) => cell.move_part(*id, frame).map_err(said).map(|()| *id),
        Undo::Remove(id) => cell.take_part(*id).map_err(said).map(|()| *id),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn disturbance_name_parses_back() {
        for text in
            ["jog:30:0:-5", "take:1:next", "move:2:-40:7:again", "swap:1:SHAFT", "add:DRILL-2:TOOL-TRNS:0"]
        {
            assert_eq!(Disturbance::named(text).map(|one| one.to_string()).as_deref(), Some(text));
        }
        for text in ["jog:1:2", "take:x", "hop:1", "swap:1", "jog"] {
            assert_eq!(Disturbance::named(text), None, "{text}");
        }
    }
}
