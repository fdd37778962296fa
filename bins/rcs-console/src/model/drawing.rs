//! A drawing of the cell in characters, from above and from the side: its bodies, the arm at the resolvers' angles, and
//! the bodies nearest to the robot.

use std::path::Path;

use geometry::{
    frame::Vector,
    kinematics::{Joints, T3},
    units::Length,
};
use plant::{
    CellDescription,
    clearance::Contact,
    description::Kind,
    room::{Layout, Room},
    scene::{Block, furniture},
};

use super::{Section, Text, Tone};

/// Columns and lines of a drawing.
const SIZE: (usize, usize) = (76, 15);
/// A smaller body is only marked by its name, in.
const LEAST: f64 = 6.0;
/// A larger body is not drawn, in.
const LARGEST: f64 = 200.0;
/// Range around the arm within which near bodies are searched, in.
const NEAR: f64 = 24.0;
/// Number of near bodies that are named.
const NAMED: usize = 3;

/// The bodies of a cell description.
pub struct Drawing {
    room: Room,
    /// Name, lowest and highest corner, in.
    blocks: Vec<(String, [f64; 3], [f64; 3])>,
}

/// Direction of view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// From above: X to the right, Y up.
    Above,
    /// From the side: X to the right, Z up.
    Side,
}

impl Side {
    fn of(self, [x, y, z]: [f64; 3]) -> (f64, f64) {
        match self {
            Self::Above => (x, y),
            Self::Side => (x, z),
        }
    }
}

/// A sheet of characters, and the part of the world that it shows.
struct Sheet {
    signs: Vec<Vec<char>>,
    low: (f64, f64),
    /// Inches per column and per line.
    scale: (f64, f64),
}

impl Sheet {
    fn around(points: &[(f64, f64)]) -> Self {
        let fold = |with: fn(f64, f64) -> f64, from: f64| {
            points.iter().fold((from, from), |found, point| (with(found.0, point.0), with(found.1, point.1)))
        };
        let (low, high) = (fold(f64::min, f64::MAX), fold(f64::max, f64::MIN));
        let (columns, lines) = (SIZE.0 as f64 - 1.0, SIZE.1 as f64 - 1.0);
        // A character is twice as high as wide.
        let inches = ((high.0 - low.0) / columns).max((high.1 - low.1) / lines / 2.0).max(0.1);
        Self { signs: vec![vec![' '; SIZE.0]; SIZE.1], low, scale: (inches, 2.0 * inches) }
    }

    fn place(&self, (x, y): (f64, f64)) -> (isize, isize) {
        let column = ((x - self.low.0) / self.scale.0).round() as isize;
        let line = ((y - self.low.1) / self.scale.1).round() as isize;
        (column, SIZE.1 as isize - 1 - line)
    }

    fn put(&mut self, (column, line): (isize, isize), text: &str) {
        let Some(row) = usize::try_from(line).ok().and_then(|line| self.signs.get_mut(line)) else { return };
        for (at, sign) in (column..).zip(text.chars()) {
            if let Some(place) = usize::try_from(at).ok().and_then(|at| row.get_mut(at)) {
                *place = sign;
            }
        }
    }

    /// Draw the outline of a block, with its name in the upper border.
    fn block(&mut self, name: &str, low: (f64, f64), high: (f64, f64)) {
        let ((left, bottom), (right, top)) = (self.place(low), self.place(high));
        let width = usize::try_from(right - left + 1).unwrap_or(0);
        let border = |ends: [char; 2]| match width {
            0 | 1 => ends[0].to_string(),
            width => format!("{}{}{}", ends[0], "─".repeat(width - 2), ends[1]),
        };
        self.put((left, bottom), &border(['└', '┘']));
        for line in top + 1..bottom {
            self.put((left, line), "│");
            self.put((right, line), "│");
        }
        self.put((left, top), &border(['┌', '┐']));
        let shown: String = name.chars().take(width.saturating_sub(2).max(3)).collect();
        self.put((left + 1, top), &shown);
    }

    /// Draw a straight line between two points.
    fn line(&mut self, from: (f64, f64), to: (f64, f64)) {
        let (from, to) = (self.place(from), self.place(to));
        let steps = (to.0 - from.0).abs().max((to.1 - from.1).abs()).max(1);
        for step in 0..=steps {
            let between = |a: isize, b: isize| a + (b - a) * step / steps;
            self.put((between(from.0, to.0), between(from.1, to.1)), "·");
        }
    }

    fn lines(self) -> Vec<Text> {
        self.signs
            .into_iter()
            .map(|row| Text::plain(format!(" {}", String::from_iter(row).trim_end())))
            .collect()
    }
}

impl Drawing {
    /// Read the cell from the text of a description.
    ///
    /// # Errors
    /// The errors of the description.
    pub fn of(text: &str) -> Result<Self, String> {
        CellDescription::from_toml(text).map(|cell| Self::of_cell(&cell)).map_err(|error| error.to_string())
    }

    /// Read the cell of a data directory.
    ///
    /// # Errors
    /// The reason why it cannot be read.
    pub fn load(directory: &Path) -> Result<Self, String> {
        let path = directory.join("cell.toml");
        let cell = CellDescription::load(&path);
        cell.map(|cell| Self::of_cell(&cell)).map_err(|error| format!("{}: {error}", path.display()))
    }

    fn of_cell(cell: &CellDescription) -> Self {
        let around = |block: Block| {
            let [x, y, z]: [f64; 3] = (block.size / 2.0).into();
            let corner = |bits: u8| {
                let sign = |bit: u8, half: f64| if bits >> bit & 1 == 1 { half } else { -half };
                let corner = Vector::new(sign(0, x), sign(1, y), sign(2, z));
                <[f64; 3]>::from(block.frame.position + block.frame.rotation * corner)
            };
            // The bounding box of the body in its orientation.
            let extreme = |with: fn(f64, f64) -> f64| {
                (0..8)
                    .map(corner)
                    .reduce(|one, other| std::array::from_fn(|axis| with(one[axis], other[axis])))
            };
            (block.name, extreme(f64::min).unwrap_or_default(), extreme(f64::max).unwrap_or_default())
        };
        let blocks = furniture(cell).into_iter().map(around);
        // The floor of the hall is larger than the drawing.
        let fits = |(_, low, high): &(String, [f64; 3], [f64; 3])| {
            (0..3).all(|axis| high[axis] - low[axis] < LARGEST)
        };
        Self { room: Room::new(cell), blocks: blocks.filter(fits).collect() }
    }

    /// Draw the cell with the arm at these joint angles.
    #[must_use]
    pub fn sections(&self, joints: &Joints) -> Vec<Section> {
        let mut sections = vec![
            self.view(Side::Above, joints, "from above"),
            self.view(Side::Side, joints, "from the side, along Y"),
        ];
        sections.push(self.nearest(joints));
        sections
    }

    fn view(&self, side: Side, joints: &Joints, title: &str) -> Section {
        let plate: [f64; 3] = T3.forward_plate(joints).position.into();
        let tool: [f64; 3] = T3.forward(joints).position.into();
        let base = [0.0; 3];
        let mut points: Vec<_> = self.blocks.iter().flat_map(|(_, low, high)| [*low, *high]).collect();
        points.extend([base, plate, tool]);
        let mut sheet = Sheet::around(&points.iter().map(|point| side.of(*point)).collect::<Vec<_>>());
        for (name, low, high) in &self.blocks {
            let (low, high) = (side.of(*low), side.of(*high));
            if (high.0 - low.0).max(high.1 - low.1) >= LEAST {
                sheet.block(name, low, high);
            }
        }
        sheet.line(side.of(base), side.of(plate));
        sheet.line(side.of(plate), side.of(tool));
        for (name, point) in [("O", base), ("#", plate), ("X", tool)] {
            let place = sheet.place(side.of(point));
            sheet.put(place, name);
        }
        let inches = sheet.scale.0;
        Section::new(
            format!("{title}; a column is {inches:.1} in; O base, # end plate, X tool point"),
            sheet.lines(),
        )
    }

    fn nearest(&self, joints: &Joints) -> Section {
        let layout: Layout = self.room.at_start();
        let movers = self.room.movers(&layout, joints);
        let mut contacts = self.room.look(&movers, &self.room.devices(&layout), NEAR);
        contacts.retain(|contact: &Contact| contact.touches() || contact.obstacle_kind != Kind::Arm);
        contacts.sort_by(|one, other| other.depth.total_cmp(&one.depth));
        let line = |contact: &Contact| {
            let tone = if contact.touches() { Tone::Trouble } else { Tone::Plain };
            Text::new(tone, format!(" {} to {} {:.1} in", contact.mover, contact.obstacle, -contact.depth))
        };
        let lines: Vec<_> = contacts.iter().take(NAMED).map(line).collect();
        let none = || vec![Text::plain(format!(" nothing within {}", Length(NEAR)))];
        let lines = if lines.is_empty() { none() } else { lines };
        Section::new("nearest to the robot, with the gripper and the parts of the start", lines)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use geometry::kinematics::HOME_JOINTS;

    #[test]
    fn the_arm_and_the_trays_stand_in_both_views() {
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../data");
        let sections = Drawing::load(&data).unwrap().sections(&HOME_JOINTS);
        for section in sections.iter().take(2) {
            let text: String = section.lines.iter().map(|line| format!("{}\n", line.text)).collect();
            for sign in ["O", "#", "X", "UNIT", "·"] {
                assert!(text.contains(sign), "{}: {sign}\n{text}", section.title);
            }
            assert!(section.lines.iter().all(|line| line.text.chars().count() <= 80), "{text}");
        }
        assert!(sections[2].lines[0].text.ends_with(" in"), "{:?}", sections[2]);
        assert!(Drawing::load(Path::new("nowhere")).err().unwrap().contains("cell.toml"));
        assert!(Drawing::of("nonsense").is_err());
    }
}
