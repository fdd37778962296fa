//! Follows the effects of a job's lines on the trays and the vise of the cell.

use geometry::units::Length;
use interfaces::{HwsCommand, station::ViseOpening};
use plant::{
    CellDescription, Placement, WorkstationAction,
    description::{Fixture, PartType, ViseProgram},
};
use rcs_core::name::{Name10, Name16};
use taskdata::{files::TaskData, load::Workstation};

const ROUNDING: f64 = 1e-6; // tolerance for rounding in the description, in

/// A fixture obstructs the part, whose centre is at most `off` from the middle of the sector.
pub fn occupied(action: &WorkstationAction, cell: &CellDescription) -> Option<String> {
    let WorkstationAction::Place { part, unit, sector, placement } = action else { return None };
    let part = cell.part(part).filter(|part| !cell.nest.iter().any(|nest| nest.takes(part)))?;
    let (off, random) = match placement {
        Placement::Random => ([0.0, 0.0], cell.tray_shape.random_offset),
        Placement::At { x, y, .. } => ([*x, *y], 0.0),
    };
    let (fixture, distance, room) = in_the_way(cell, part, unit, *sector, off, random)?;
    let how = if random > 0.0 { format!(", put down up to {} off,", Length(random)) } else { String::new() };
    Some(format!(
        "{} stands {distance:.2} in from there; {}{how} needs {room:.2} in",
        fixture.name, part.name
    ))
}

/// The nearest fixture on a tray within half the diagonal of a lying part plus its greatest offset.
fn in_the_way<'c>(
    cell: &'c CellDescription,
    part: &PartType,
    unit: &str,
    sector: u16,
    off: [f64; 2],
    random: f64,
) -> Option<(&'c Fixture, f64, f64)> {
    let tray = cell.tray(unit)?;
    let at = tray.sector(sector)?.position;
    let [_, width, length] = part.size;
    let room = width.hypot(length) / 2.0 + random;
    let on_tray = |fixture: &&Fixture| {
        let [_, _, z] = fixture.centre;
        let [_, _, height] = fixture.size;
        z + height / 2.0 > tray.floor
            && z - height / 2.0 < tray.floor + part.size[0]
            && height < cell.tray_shape.inside
    };
    let distance = |fixture: &Fixture| {
        let beside = |along: usize, position: f64| {
            ((position - fixture.centre[along]).abs() - fixture.size[along] / 2.0).max(0.0)
        };
        beside(0, at.x + off[0]).hypot(beside(1, at.y + off[1]))
    };
    let near = cell.fixture.iter().filter(on_tray).map(|fixture| (fixture, distance(fixture), room));
    near.filter(|(_, distance, room)| distance < room).min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Why a command is impossible, the word of its line that causes it, and the remedy.
pub struct Refused {
    pub word: String,
    pub message: String,
    pub help: &'static str,
}

/// The vise and the trays between two lines, as far as known.
pub struct State<'c> {
    cell: &'c CellDescription,
    pub data: TaskData<'c>,
    jaws: Option<Jaws<'c>>,
    in_vise: Option<Name16>, // the object that was put into the vise last
    /// Unit and sector of parts that were put down at random positions.
    random: Vec<(Name10, Option<i32>)>,
}

#[derive(Clone, Copy)]
struct Jaws<'c> {
    program: &'c ViseProgram,
    opening: ViseOpening,
}

impl<'c> State<'c> {
    /// The state at the start of a run: the vise is open in its first program.
    pub fn new(cell: &'c CellDescription, data: TaskData<'c>) -> Self {
        let program = cell.vise.program.first();
        let jaws = program.map(|program| Jaws { program, opening: ViseOpening::Open });
        Self { cell, data, jaws, in_vise: None, random: Vec::new() }
    }

    /// Apply a `**` line. `lost` is true if it takes effect at another time or was refused. Returns why it is
    /// impossible.
    pub fn action(&mut self, action: &Workstation, lost: bool) -> Option<String> {
        let vise = self.cell.vise.location.as_str();
        match action {
            Workstation::Vise { opening, program, .. } => {
                let programs = &self.cell.vise.program;
                let named = |name: &Name16| programs.iter().find(|known| known.name == name.as_str());
                let program = program.as_ref().and_then(named).or(self.jaws.map(|jaws| jaws.program));
                let jaws = program.map(|program| Jaws { program, opening: *opening });
                self.jaws = jaws.filter(|_| !lost);
            }
            Workstation::Tray { location, offset: None, .. } => {
                self.random.push((location.name, location.sector));
            }
            Workstation::Machine { blank, part, location } if location.name.as_str() == vise => {
                let other = self.in_vise.replace(*part).filter(|other| other != blank);
                return other.map(|other| format!("{other} was brought into the vise, not {blank}"));
            }
            _ => {}
        }
        None
    }

    pub fn command(&mut self, command: &HwsCommand) -> Option<Refused> {
        let (verb, object) = (command.command.as_str(), command.object?);
        let part = self.cell.part(object.as_str())?;
        let brings = ["TRANSFER", "MOVE", "REFIXTURE"].contains(&verb);
        let unseen = if brings || verb == "ACQUIRE" { self.unseen(command, part) } else { None };
        let vise = self.cell.vise.location.as_str();
        let to_vise = command.destination.filter(|name| brings && name.as_str() == vise);
        let (None, Some(destination)) = (&unseen, to_vise) else { return unseen };
        self.in_vise = Some(object);
        let message = self.jaws?.refuse(part)?;
        self.jaws = None;
        let help = "a line `** vise open|partial LOCATION PROGRAM` before it opens the vise for the part";
        Some(Refused { word: destination.to_string(), message, help })
    }

    /// A part at a random position must be located by the camera. Parts with nests lie in them.
    fn unseen(&self, command: &HwsCommand, part: &PartType) -> Option<Refused> {
        let (object, source) = (command.object?, command.source?);
        let location = self.data.resolve_location(&source, command.source_sector, Some(&object)).ok()?;
        let random = self.random.contains(&(location.name, location.sector));
        let seen = self.data.view(&object, &location.place).is_some_and(|(_, view)| view.enabled);
        let nested = self.cell.nest.iter().any(|nest| nest.takes(part));
        let sector = location.sector.map_or("in ".to_owned(), |sector| format!("in sector {sector} of "));
        let unit = location.name;
        (random && !seen && !nested).then(|| Refused {
            word: source.to_string(),
            message: format!("{object} lies anywhere {sector}{unit}, and no view finds it there"),
            help: "add a view with en 1 (-vu-, VII.7.6), or write x, y and angle at the end of the ** tray line",
        })
    }
}

impl Jaws<'_> {
    /// Why a part cannot be inserted: no side of it fits between the clamping faces without falling through.
    fn refuse(&self, part: &PartType) -> Option<String> {
        let (opening, how) = match self.opening {
            ViseOpening::Close => {
                return Some(format!("the vise is closed when {} arrives", part.name));
            }
            ViseOpening::Open => (self.program.opening_open, "open"),
            ViseOpening::Partial => (self.program.opening_partial, "partially closed"),
        };
        let inner = opening - 2.0 * self.program.depth;
        let fits = part.size.iter().any(|side| (inner - ROUNDING..=opening + ROUNDING).contains(side));
        let [x, y, z] = part.size;
        (!fits).then(|| {
            format!(
                "the program {} takes parts {inner:.3} to {opening:.3} in wide when {how}; {} is {x:.2} x {y:.2} x {z:.2} in",
                self.program.name, part.name
            )
        })
    }
}
