//! A drawing of the cell in characters, from above and from the side, with the bodies nearest to the robot.

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

const LEAST_LINES: usize = 13; // least number of lines of a view; a smaller terminal scrolls
const LEAST: f64 = 6.0; // a smaller body is marked only by its name, in
const LARGEST: f64 = 200.0; // a larger body is not drawn, in
const NEAR: f64 = 24.0; // range around the arm within which near bodies are searched, in
const NAMED: usize = 3; // number of near bodies that are named

pub struct Drawing {
    room: Room,
    blocks: Vec<(String, [f64; 3], [f64; 3])>, // Name, lowest and highest corner of each body, in
}

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

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Size {
    columns: usize,
    lines: usize,
}

type Place = (isize, isize);

/// A sheet of characters, and the part of the world that it shows.
struct Sheet {
    signs: Vec<Vec<char>>,
    taken: Vec<Vec<bool>>, // true for characters of labels, marks and the arm, which no label may cover
    legend: Vec<String>,   // letters of the bodies whose names have no room
    low: (f64, f64),
    inches: f64, // inches per column; a line is twice as high
}

fn extent(points: &[(f64, f64)]) -> ((f64, f64), (f64, f64)) {
    let fold = |with: fn(f64, f64) -> f64, from: f64| {
        points.iter().fold((from, from), |found, point| (with(found.0, point.0), with(found.1, point.1)))
    };
    (fold(f64::min, f64::MAX), fold(f64::max, f64::MIN))
}

/// Inches per column, so that the points fit.
fn scale(points: &[(f64, f64)], size: Size) -> f64 {
    let (low, high) = extent(points);
    let last = |count: usize| count.saturating_sub(1).max(1) as f64;
    ((high.0 - low.0) / last(size.columns)).max((high.1 - low.1) / last(size.lines) / 2.0).max(0.1)
}

impl Sheet {
    fn new(points: &[(f64, f64)], size: Size, inches: f64) -> Self {
        let (low, high) = extent(points);
        let needed = ((high.1 - low.1) / (2.0 * inches)).round() as usize + 1;
        let lines = size.lines.min(needed);
        Self {
            signs: vec![vec![' '; size.columns]; lines],
            taken: vec![vec![false; size.columns]; lines],
            legend: Vec::new(),
            low,
            inches,
        }
    }

    fn place(&self, (x, y): (f64, f64)) -> Place {
        let column = ((x - self.low.0) / self.inches).round() as isize;
        let line = ((y - self.low.1) / (2.0 * self.inches)).round() as isize;
        (column, isize::try_from(self.signs.len()).unwrap_or(isize::MAX) - 1 - line)
    }

    fn put(&mut self, (column, line): Place, text: &str, takes: bool) {
        for (at, sign) in (column..).zip(text.chars()) {
            if let Some((x, y)) = self.inside((at, line)) {
                self.signs[y][x] = sign;
                self.taken[y][x] |= takes;
            }
        }
    }

    /// The indexes of a place; `None` outside the sheet.
    fn inside(&self, (column, line): Place) -> Option<(usize, usize)> {
        let (x, y) = (usize::try_from(column).ok()?, usize::try_from(line).ok()?);
        (y < self.signs.len() && x < self.signs[y].len()).then_some((x, y))
    }

    fn block(&mut self, (left, bottom): Place, (right, top): Place) {
        let width = usize::try_from(right - left + 1).unwrap_or(0);
        let border = |ends: [char; 2]| match width {
            0 | 1 => ends[0].to_string(),
            width => format!("{}{}{}", ends[0], "─".repeat(width - 2), ends[1]),
        };
        self.put((left, bottom), &border(['└', '┘']), false);
        for line in top + 1..bottom {
            self.put((left, line), "│", false);
            self.put((right, line), "│", false);
        }
        self.put((left, top), &border(['┌', '┐']), false);
    }

    /// Write the name of a block where it covers neither a name nor a mark. Without room, write a letter, which the
    /// legend explains.
    fn label(&mut self, name: &str, (left, bottom): Place, (right, top): Place) {
        let length = isize::try_from(name.chars().count()).unwrap_or(isize::MAX);
        let within = (top..=bottom).filter(|_| length < right - left).map(|line| ((left + 1, line), false));
        let outside = [
            (left, top - 1),
            (left, bottom + 1),
            (right + 2, (top + bottom) / 2),
            (left - 1 - length, (top + bottom) / 2),
        ];
        let outside = outside.into_iter().map(|place| (place, true));
        let free = within.chain(outside).find(|(place, blank)| self.is_free(*place, length, *blank));
        if let Some((place, _)) = free {
            return self.put(place, name, true);
        }
        let letter = ('a'..='z').nth(self.legend.len()).unwrap_or('?');
        let places =
            (top - 1..=bottom + 1).flat_map(|line| (left - 1..=right + 1).map(move |column| (column, line)));
        let mut places = places.filter(|place| self.is_free(*place, 1, false));
        if let Some(place) = places.next() {
            self.put(place, &letter.to_string(), true);
            self.legend.push(format!("{letter} {name}"));
        }
    }

    /// True if a text fits there with a free column on both sides. With `blank`, it must also cover no outline.
    fn is_free(&self, (column, line): Place, length: isize, blank: bool) -> bool {
        let is_clear = |at: isize| match self.inside((at, line)) {
            Some((x, y)) => !self.taken[y][x],
            None => true,
        };
        let is_blank = |at: isize| self.inside((at, line)).is_some_and(|(x, y)| self.signs[y][x] == ' ');
        (column..column + length).all(|at| self.inside((at, line)).is_some() && (!blank || is_blank(at)))
            && (column - 1..=column + length).all(is_clear)
    }

    fn line(&mut self, from: (f64, f64), to: (f64, f64)) {
        let (from, to) = (self.place(from), self.place(to));
        let steps = (to.0 - from.0).abs().max((to.1 - from.1).abs()).max(1);
        for step in 0..=steps {
            let between = |a: isize, b: isize| a + (b - a) * step / steps;
            self.put((between(from.0, to.0), between(from.1, to.1)), "·", true);
        }
    }

    /// The lines of the drawing, and the legend of its letters.
    fn finished(self) -> (Vec<String>, String) {
        let lines = self.signs.into_iter().map(|row| String::from_iter(row).trim_end().to_owned());
        (lines.collect(), self.legend.join("  "))
    }
}

/// Name of the object to which a body belongs: a tray has a floor and walls, a holster has cheeks and a foot.
fn whole(block: &Block) -> String {
    match block.kind {
        Kind::Tray | Kind::Holster => block.name.splitn(3, '_').take(2).collect::<Vec<_>>().join("_"),
        Kind::Vise => "vise".to_owned(),
        Kind::Drum => "strike_plate".to_owned(),
        _ => block.name.clone(),
    }
}

fn each(with: fn(f64, f64) -> f64, one: [f64; 3], other: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|axis| with(one[axis], other[axis]))
}

impl Drawing {
    pub fn of(text: &str) -> Result<Self, String> {
        CellDescription::from_toml(text).map(|cell| Self::of_cell(&cell)).map_err(|error| error.to_string())
    }

    pub fn load(directory: &Path) -> Result<Self, String> {
        let path = directory.join("cell.toml");
        let cell = CellDescription::load(&path);
        cell.map(|cell| Self::of_cell(&cell)).map_err(|error| format!("{}: {error}", path.display()))
    }

    fn of_cell(cell: &CellDescription) -> Self {
        let extent = |block: &Block| {
            let [x, y, z]: [f64; 3] = (block.size / 2.0).into();
            let corner = |bits: u8| {
                let sign = |bit: u8, half: f64| if bits >> bit & 1 == 1 { half } else { -half };
                let corner = Vector::new(sign(0, x), sign(1, y), sign(2, z));
                <[f64; 3]>::from(block.frame.position + block.frame.rotation * corner)
            };
            // The bounding box of the body in its orientation.
            let extreme = |with: fn(f64, f64) -> f64| {
                (0..8).map(corner).reduce(|one, other| each(with, one, other)).unwrap_or_default()
            };
            (extreme(f64::min), extreme(f64::max))
        };
        let mut blocks: Vec<(String, [f64; 3], [f64; 3])> = Vec::new();
        for block in furniture(cell) {
            let (name, (low, high)) = (whole(&block), extent(&block));
            match blocks.iter_mut().find(|(known, ..)| *known == name) {
                Some((_, least, most)) => {
                    (*least, *most) = (each(f64::min, *least, low), each(f64::max, *most, high));
                }
                None => blocks.push((name, low, high)),
            }
        }
        // The floor of the hall is larger than the drawing.
        let fits = |(_, low, high): &(String, [f64; 3], [f64; 3])| {
            (0..3).all(|axis| high[axis] - low[axis] < LARGEST)
        };
        Self { room: Room::new(cell), blocks: blocks.into_iter().filter(fits).collect() }
    }

    /// Draw the cell for a terminal of this width and a body of this height, side by side if the views are larger so.
    #[must_use]
    pub fn sections(&self, joints: &Joints, width: usize, room: usize) -> Vec<Section> {
        let nearest = self.nearest(joints);
        // Below the views are the legends of their letters, a title, and the nearest bodies.
        let others = nearest.lines.len() + 3;
        let lines = |views: usize| (room.saturating_sub(others) / views).saturating_sub(1).max(LEAST_LINES);
        let above = Size { columns: width.saturating_sub(2), lines: lines(2) };
        let beside = Size { columns: width.saturating_sub(5) / 2, lines: lines(1) };
        let both = [Side::Above, Side::Side];
        let scale_of = |size: Size| {
            both.map(|side| scale(&self.points(side, joints), size)).into_iter().fold(0.0, f64::max)
        };
        let is_beside = scale_of(beside) < scale_of(above);
        let size = if is_beside { beside } else { above };
        let inches = scale_of(size);
        let [(from_above, above_legend), (from_the_side, side_legend)] =
            both.map(|side| self.view(side, joints, size, inches));
        let title = format!("a column is {inches:.1} in; O base, # end plate, X tool point");
        let section = |title: String, lines: Vec<String>, legends: &[String]| {
            let legends = legends.iter().filter(|legend| !legend.is_empty()).cloned();
            let lines = lines.into_iter().chain(legends);
            Section::new(title, lines.map(|line| Text::verbatim(Tone::Plain, format!(" {line}"))).collect())
        };
        if !is_beside {
            return vec![
                section(format!("from above; {title}"), from_above, &[above_legend]),
                section("from the side, along Y".to_owned(), from_the_side, &[side_legend]),
                nearest,
            ];
        }
        let columns = size.columns;
        let length = from_above.len().max(from_the_side.len());
        let padded = |lines: Vec<String>| lines.into_iter().chain(std::iter::repeat(String::new()));
        let pairs = padded(from_above).zip(padded(from_the_side)).take(length);
        let lines = pairs.map(|(left, right)| format!("{left:<columns$} │ {right}")).collect();
        let of_view = |view: &str, legend: String| match legend.as_str() {
            "" => legend,
            _ => format!("{view}: {legend}"),
        };
        let legends = [of_view("above", above_legend), of_view("side", side_legend)];
        vec![section(format!("from above, and from the side along Y; {title}"), lines, &legends), nearest]
    }

    fn hand(joints: &Joints) -> [[f64; 3]; 2] {
        [T3.forward_plate(joints).position.into(), T3.forward(joints).position.into()]
    }

    fn points(&self, side: Side, joints: &Joints) -> Vec<(f64, f64)> {
        let corners = self.blocks.iter().flat_map(|(_, low, high)| [*low, *high]);
        corners.chain([[0.0; 3]]).chain(Self::hand(joints)).map(|point| side.of(point)).collect()
    }

    fn view(&self, side: Side, joints: &Joints, size: Size, inches: f64) -> (Vec<String>, String) {
        let mut sheet = Sheet::new(&self.points(side, joints), size, inches);
        let placed = self.blocks.iter().filter_map(|(name, low, high)| {
            let (low, high) = (side.of(*low), side.of(*high));
            let is_large = (high.0 - low.0).max(high.1 - low.1) >= LEAST;
            is_large.then(|| (name, sheet.place(low), sheet.place(high)))
        });
        let mut placed: Vec<_> = placed.collect();
        for (_, low, high) in &placed {
            sheet.block(*low, *high);
        }
        let base = [0.0; 3];
        let [plate, tool] = Self::hand(joints);
        sheet.line(side.of(base), side.of(plate));
        sheet.line(side.of(plate), side.of(tool));
        for (sign, point) in [("O", base), ("#", plate), ("X", tool)] {
            let place = sheet.place(side.of(point));
            sheet.put(place, sign, true);
        }
        // Names of small bodies are placed first, because they have fewer possible positions.
        placed.sort_by_key(|(_, low, high)| (high.0 - low.0) * (low.1 - high.1));
        for (name, low, high) in placed {
            sheet.label(name, low, high);
        }
        sheet.finished()
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

    fn drawing() -> Drawing {
        Drawing::load(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../data")).unwrap()
    }

    fn text(sections: &[Section]) -> String {
        sections.iter().flat_map(|section| &section.lines).map(|line| format!("{}\n", line.text)).collect()
    }

    #[test]
    fn both_views_show_the_arm_and_every_name_in_full() {
        let drawing = drawing();
        for (width, room) in [(80, 18), (120, 34), (200, 44)] {
            let sections = drawing.sections(&HOME_JOINTS, width, room);
            let text = text(&sections);
            for sign in ["O", "#", "X", "·"] {
                assert!(text.contains(sign), "{sign}\n{text}");
            }
            for (name, low, high) in &drawing.blocks {
                let size = |axis: usize| high[axis] - low[axis];
                let is_drawn = size(0).max(size(1)) >= LEAST && size(0).max(size(2)) >= LEAST;
                assert!(!is_drawn || text.matches(name.as_str()).count() >= 2, "{name} at {width}\n{text}");
            }
            let mut drawn = text
                .lines()
                .filter(|line| ![" a ", " above: ", " side: "].iter().any(|legend| line.starts_with(legend)));
            assert!(drawn.all(|line| line.chars().count() <= width), "{text}");
        }
        assert!(Drawing::load(Path::new("nowhere")).err().unwrap().contains("cell.toml"));
        assert!(Drawing::of("nonsense").is_err());
    }

    #[test]
    fn larger_terminal_gets_larger_drawing() {
        let scale = |width, room| {
            let title = drawing().sections(&HOME_JOINTS, width, room).remove(0).title;
            let rest = title.split_once("a column is ").unwrap().1;
            rest.split_once(" in").unwrap().0.parse::<f64>().unwrap()
        };
        assert!(scale(200, 44) < scale(120, 34) && scale(120, 34) < scale(80, 18));
    }

    #[test]
    fn label_covers_no_other_label() {
        let size = Size { columns: 20, lines: 8 };
        let mut sheet = Sheet::new(&[(0.0, 0.0), (19.0, 14.0)], size, 1.0);
        let (low, high) = ((2, 5), (9, 2));
        sheet.block(low, high);
        for name in ["first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth"] {
            sheet.label(name, low, high);
        }
        let (lines, legend) = sheet.finished();
        let text = lines.join("\n") + &legend;
        for name in ["first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth"] {
            assert!(text.contains(name), "{name}\n{text}");
        }
    }
}
