//! Checks the contacts of the robot. The cell reports contacts; common memory contains the present command. A list in
//! the cell description gives the contacts permitted during each command.
//!
//! A forbidden contact is a failure of the job, but does not end the run: no sensor detects it, and the log must show
//! what follows. The run ends when the arm is deeper than [`DEEPEST`]: a real arm would have stalled.
//!
//! A permitted contact remains permitted until it gets deeper: the next command begins where the last one ended.

use std::{collections::BTreeMap, fmt};

use crate::{account::Kind, failure::Failure};
use geometry::units::Point;
use interfaces::{CommonMemory, StatusReport, emove::EmoveVerb, subtask::SubtaskVerb};
use os_io::text::amount;
use plant::{clearance::Contact, description::Permits};
use rcs_core::tick::Tick;
use serde::Serialize;

pub const DEEPEST: f64 = 1.0; // depth of arm, gripper or fingers in an obstacle that ends the run, in
const MARGIN: f64 = 2.0; // greater distances are not near misses in an ordinary run, in
const FREE: f64 = 0.05; // a permitted contact ends at this distance, in
const DEEPER: f64 = 0.001; // smallest increase of depth that is treated as deeper, in

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Commands {
    /// Empty for none.
    pub emove: &'static str,
    /// Empty for none.
    pub subtask: &'static str,
}

impl From<&CommonMemory> for Commands {
    fn from(memory: &CommonMemory) -> Self {
        let (emove, subtask): (EmoveVerb, SubtaskVerb) =
            (memory.subtask.emove.command, memory.task.subtask.command);
        Self { emove: emove.text(), subtask: subtask.text() }
    }
}

impl Commands {
    /// The commands after another tick. A command that E-move has not accepted yet, or that has failed, moves nothing.
    fn after(self, memory: &CommonMemory) -> Self {
        let (told, status) = (&memory.subtask.emove, &memory.emove.status);
        let taken = status.echo == told.number && status.report != StatusReport::Error;
        if taken { Self::from(memory) } else { self }
    }
}

impl fmt::Display for Commands {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.emove, self.subtask) {
            ("", "") => f.write_str("no command"),
            (one, "") | ("", one) => f.write_str(one),
            (emove, subtask) => write!(f, "{emove} of {subtask}"),
        }
    }
}

/// A forbidden contact. The field names are those of the JSON object.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Collision {
    pub mover: String,
    pub obstacle: String,
    pub depth_in: f64,
    pub position_in: [f64; 3], // position of the greatest depth, world coordinates, in
    pub tick: u64,
    pub ticks: u64,
    #[serde(rename = "command")]
    pub commands: Commands,
    #[serde(skip)]
    is_robot: bool,
}

impl Collision {
    /// True if the robot itself has collided, false for a carried part.
    #[must_use]
    pub const fn is_of_robot(&self) -> bool {
        self.is_robot
    }
}

impl fmt::Display for Collision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { mover, obstacle, depth_in, position_in, commands, .. } = self;
        write!(
            f,
            "{mover} runs into {obstacle}, {depth_in:.3} in deep, at {}, during {commands}",
            Point(*position_in)
        )
    }
}

#[derive(Clone, Debug)]
pub enum ContactEvent {
    Begins(Collision),
    Ends(Collision),
}

impl fmt::Display for ContactEvent {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Begins(collision) => collision.fmt(f),
            Self::Ends(Collision { mover, obstacle, ticks, depth_in, .. }) => {
                write!(
                    f,
                    "{mover} is clear of {obstacle} after {}; it was {depth_in:.3} in deep",
                    amount(*ticks, "tick")
                )
            }
        }
    }
}

/// The smallest distance to an object that must not be touched.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NearMiss {
    pub mover: String,
    pub obstacle: String,
    pub distance_in: f64,
    pub position_in: [f64; 3],
    pub tick: u64,
    #[serde(rename = "command")]
    pub commands: Commands,
}

impl fmt::Display for NearMiss {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { mover, obstacle, distance_in, tick, commands, .. } = self;
        write!(f, "{mover} passes {obstacle} by {distance_in:.3} in at tick {tick}, during {commands}")
    }
}

#[derive(Clone, Copy, Debug)]
struct Allowance {
    depth: f64, // greatest depth while the contact was permitted, in
    free: bool, // true if the objects have separated since then
}

#[derive(Clone, Debug)]
pub struct ContactCheck {
    permits: Permits,
    allowed: BTreeMap<(String, String), Allowance>,
    open: BTreeMap<(String, String), usize>, // collisions in progress: index in `collisions`
    collisions: Vec<Collision>,
    nearest: Option<NearMiss>,
    farthest: f64,      // greater distances are not near misses, in
    commands: Commands, // the commands that move the robot or moved it last
}

impl ContactCheck {
    #[must_use]
    pub fn new(permits: Permits) -> Self {
        Self {
            permits,
            allowed: BTreeMap::new(),
            open: BTreeMap::new(),
            collisions: Vec::new(),
            nearest: None,
            farthest: MARGIN,
            commands: Commands::default(),
        }
    }

    #[must_use]
    pub fn without_near_misses(self) -> Self {
        Self { farthest: 0.0, ..self }
    }

    /// Permit the present contacts in a resumed run, because the earlier run has judged them.
    pub fn permit(&mut self, contacts: &[Contact]) {
        for contact in contacts.iter().filter(|contact| contact.touches()) {
            self.allowed.insert(contact.pair(), Allowance { depth: contact.depth, free: false });
        }
    }

    /// The commands to which a tick's contacts are attributed, from common memory after the tick.
    pub fn commands(&mut self, memory: &CommonMemory) -> Commands {
        self.commands = self.commands.after(memory);
        self.commands
    }

    pub fn state(&self) -> impl fmt::Debug {
        (&self.allowed, &self.open, &self.commands)
    }

    /// Distance within which the cell must report pairs, in: that of the nearest miss, and enough for the end of a
    /// contact.
    #[must_use]
    pub fn margin(&self) -> f64 {
        self.least().max(FREE)
    }

    /// The distance, in, below which a pair is the new nearest miss.
    fn least(&self) -> f64 {
        self.nearest.as_ref().map_or(self.farthest, |nearest| nearest.distance_in)
    }

    /// Check contacts and distances after a tick. Returns the collisions that have begun or ended.
    pub fn look(&mut self, tick: Tick, contacts: &[Contact], commands: Commands) -> Vec<ContactEvent> {
        let mut events = Vec::new();
        for contact in contacts {
            if contact.touches() {
                events.extend(self.touch(tick, contact, commands).map(ContactEvent::Begins));
            } else {
                self.near(tick, contact, commands);
            }
        }
        let is = |one: &Contact, pair: &(String, String)| one.mover == pair.0 && one.obstacle == pair.1;
        let near = |pair: &(String, String)| contacts.iter().any(|one| is(one, pair));
        let together =
            |pair: &(String, String)| contacts.iter().any(|one| is(one, pair) && one.depth > -FREE);
        self.allowed.retain(|pair, _| near(pair));
        let over: Vec<_> = self.open.keys().filter(|pair| !together(pair)).cloned().collect();
        for pair in over {
            let Some(collision) = self.open.remove(&pair).and_then(|at| self.collisions.get(at)) else {
                continue;
            };
            events.push(ContactEvent::Ends(collision.clone()));
        }
        events
    }

    #[must_use]
    pub fn is_collision(&self, contact: &Contact) -> bool {
        self.open.contains_key(&contact.pair())
    }

    #[must_use]
    pub fn collisions(&self) -> &[Collision] {
        &self.collisions
    }

    #[must_use]
    pub const fn nearest(&self) -> Option<&NearMiss> {
        self.nearest.as_ref()
    }

    /// True if a collision is so deep that the simulation is meaningless.
    #[must_use]
    pub fn is_stuck(&self) -> bool {
        self.open
            .values()
            .any(|at| self.collisions.get(*at).is_some_and(|one| one.is_robot && one.depth_in > DEEPEST))
    }

    /// The failure of a finished job: the first collision, as later ones may follow from it.
    #[must_use]
    pub fn verdict(&self) -> Option<Failure> {
        let (first, rest) = self.collisions.split_first()?;
        let deepest = rest.iter().map(|one| one.depth_in).fold(0.0, f64::max);
        let more = match rest.len() {
            0 => String::new(),
            1 => format!("; and one contact more, {deepest:.3} in deep"),
            more => format!("; and {more} contacts more, up to {deepest:.3} in deep"),
        };
        let Collision { mover, obstacle, depth_in, position_in, tick, commands, .. } = first;
        let text = format!(
            "the robot ran into {obstacle}: {mover} was {depth_in:.3} in deep at {}, from tick \
             {tick} on, during {commands}{more}",
            Point(*position_in)
        );
        Some(Failure::outside(Tick(*tick), Kind::Collision, "cell", text))
    }

    /// Process the contact of two objects. Returns a collision that begins.
    fn touch(&mut self, tick: Tick, contact: &Contact, commands: Commands) -> Option<Collision> {
        let pair = contact.pair();
        let limit =
            self.permits.during(contact.mover(), contact.obstacle(), [commands.emove, commands.subtask]);
        if let Some(index) = self.open.get(&pair) {
            let collision = &mut self.collisions[*index];
            collision.ticks += 1;
            if contact.depth > collision.depth_in {
                collision.depth_in = contact.depth;
                collision.position_in = contact.at;
            }
            return None;
        }
        if contact.depth <= limit {
            let known = self.allowed.get(&pair).filter(|known| !known.free);
            let depth = known.map_or(contact.depth, |known| known.depth.max(contact.depth));
            self.allowed.insert(pair, Allowance { depth, free: false });
            return None;
        }
        let known = self.allowed.get(&pair).filter(|known| !known.free);
        if known.is_some_and(|known| contact.depth <= known.depth + DEEPER) {
            return None;
        }
        let collision = Collision {
            mover: contact.mover.clone(),
            obstacle: contact.obstacle.clone(),
            depth_in: contact.depth,
            position_in: contact.at,
            tick: tick.0,
            ticks: 1,
            commands,
            is_robot: contact.mover_kind.is_robot(),
        };
        self.open.insert(pair, self.collisions.len());
        self.collisions.push(collision.clone());
        Some(collision)
    }

    fn near(&mut self, tick: Tick, contact: &Contact, commands: Commands) {
        let distance = (-contact.depth).max(0.0);
        if let Some(known) = self.allowed.get_mut(&contact.pair()) {
            known.free |= distance > FREE;
            return;
        }
        if distance >= self.least() || self.permits.at_most(contact.mover(), contact.obstacle()) > 0.0 {
            return;
        }
        self.nearest = Some(NearMiss {
            mover: contact.mover.clone(),
            obstacle: contact.obstacle.clone(),
            distance_in: distance,
            position_in: contact.at,
            tick: tick.0,
            commands,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plant::description::{Kind, Pattern, Permit};

    const MOVE: Commands = Commands { emove: "MOV-TO-LOC", subtask: "GOTO-DEST" };
    const GRASP: Commands = Commands { emove: "GRASP-OBJ", subtask: "GET-OBJECT" };

    /// A check that permits fingers to touch parts, 0.1 in deep, while they grasp.
    fn new_check() -> ContactCheck {
        let pattern = |text: &str| vec![Pattern(text.into())];
        ContactCheck::new(Permits(vec![Permit {
            mover: pattern("fingers"),
            obstacle: pattern("parts"),
            during: vec!["GRASP-OBJ".into()],
            depth: Some(0.1),
            why: "a test".into(),
        }]))
    }

    fn contact(mover: &str, mover_kind: Kind, depth: f64) -> Contact {
        Contact {
            mover: mover.into(),
            mover_kind,
            obstacle: "BAR".into(),
            obstacle_kind: Kind::Part,
            depth,
            at: [1.0, 2.0, 3.0],
            away: [0.0, 0.0, 1.0],
        }
    }

    fn finger(depth: f64) -> [Contact; 1] {
        [contact("left_finger", Kind::Finger, depth)]
    }

    /// Run the check with a finger at these depths, one per tick. Returns the lines of the log.
    fn play(check: &mut ContactCheck, ticks: &[(f64, Commands)]) -> Vec<String> {
        let ticks = (1..).zip(ticks);
        ticks
            .flat_map(|(tick, (depth, commands))| check.look(Tick(tick), &finger(*depth), *commands))
            .map(|event| event.to_string())
            .collect()
    }

    #[test]
    fn a_collision_is_reported_at_its_start_and_at_its_end_with_its_depth() {
        let mut check = new_check();
        let lines = play(&mut check, &[(-0.2, MOVE), (0.3, MOVE), (0.7, MOVE), (0.2, GRASP), (-0.2, MOVE)]);
        assert_eq!(
            lines,
            [
                "left_finger runs into BAR, 0.300 in deep, at (1.00, 2.00, 3.00 in), during MOV-TO-LOC of GOTO-DEST",
                "left_finger is clear of BAR after 3 ticks; it was 0.700 in deep",
            ]
        );
        let [one] = check.collisions() else { panic!("{:?}", check.collisions()) };
        assert_eq!((one.tick, one.ticks, one.depth_in, one.commands), (2, 3, 0.7, MOVE));
        let verdict = check.verdict().unwrap();
        assert_eq!(verdict.tick, Tick(2));
        assert_eq!(
            verdict.text,
            "the robot ran into BAR: left_finger was 0.700 in deep at (1.00, 2.00, 3.00 in), from tick 2 on, during \
             MOV-TO-LOC of GOTO-DEST"
        );
    }

    #[test]
    fn a_refused_command_causes_no_motion() {
        let mut memory = CommonMemory::default();
        memory.task.subtask.command = SubtaskVerb::Position;
        (memory.subtask.emove.command, memory.subtask.emove.number) = (EmoveVerb::MovToObj, 7);
        (memory.emove.status.echo, memory.emove.status.report) = (7, StatusReport::Done);
        let mut check = new_check();
        let seat = check.commands(&memory);
        assert_eq!((seat.emove, seat.subtask), ("MOV-TO-OBJ", ">POSITION"));
        memory.task.subtask.command = SubtaskVerb::GotoDest;
        (memory.subtask.emove.command, memory.subtask.emove.number) = (EmoveVerb::MovToLoc, 8);
        assert_eq!(check.commands(&memory), seat, "E-move has not read it");
        (memory.emove.status.echo, memory.emove.status.report) = (8, StatusReport::Error);
        assert_eq!(check.commands(&memory), seat, "it is refused");
        (memory.subtask.emove.number, memory.emove.status.echo) = (9, 9);
        memory.emove.status.report = StatusReport::Executing;
        assert_eq!(check.commands(&memory), MOVE);
    }

    #[test]
    fn trembling_contact_is_one_collision() {
        let mut check = new_check();
        play(&mut check, &[(0.01, MOVE), (-0.01, MOVE), (0.01, MOVE), (-0.06, MOVE), (0.01, MOVE)]);
        assert_eq!(check.collisions().len(), 2);
        assert!(check.verdict().unwrap().text.ends_with("; and one contact more, 0.010 in deep"));
    }

    #[test]
    fn a_permitted_contact_is_a_collision_only_if_too_deep() {
        let mut permitted = new_check();
        assert!(play(&mut permitted, &[(0.05, GRASP), (0.1, GRASP), (-0.5, GRASP)]).is_empty());
        assert_eq!(permitted.verdict(), None);
        let mut deep = new_check();
        assert_eq!(play(&mut deep, &[(0.05, GRASP), (0.11, GRASP)]).len(), 1);
        let mut other = new_check();
        other.look(Tick(1), &[contact("wrist", Kind::Arm, 0.05)], GRASP);
        assert!(other.verdict().is_some(), "the wrist is not a finger");
    }

    #[test]
    fn next_command_may_start_in_the_contact_of_the_last_command() {
        let mut leaving = new_check();
        assert!(play(&mut leaving, &[(0.08, GRASP), (0.08, MOVE), (0.03, MOVE), (-0.5, MOVE)]).is_empty());
        let mut going_on = new_check();
        assert_eq!(play(&mut going_on, &[(0.03, GRASP), (0.08, MOVE)]).len(), 1, "deeper is not away");
        let mut coming_back = new_check();
        let again = play(&mut coming_back, &[(0.08, GRASP), (-0.06, MOVE), (0.03, MOVE)]);
        assert_eq!(again.len(), 1, "it had come free");
    }

    #[test]
    fn nearest_miss_is_the_smallest_distance_without_contact() {
        let mut check = new_check();
        assert_eq!(check.margin(), MARGIN);
        let mut pass = |tick: u64, distance: f64| {
            check.look(Tick(tick), &[contact("wrist", Kind::Arm, -distance)], MOVE);
            let nearest = check.nearest().map(|nearest| (nearest.distance_in, nearest.tick));
            (nearest, check.margin())
        };
        assert_eq!(pass(1, 0.5), (Some((0.5, 1)), 0.5));
        assert_eq!(pass(2, 0.3), (Some((0.3, 2)), 0.3));
        assert_eq!(pass(3, 0.4), (Some((0.3, 2)), 0.3));
        assert_eq!(pass(4, 0.01), (Some((0.01, 4)), FREE), "the end of a contact is still detected");
        assert_eq!(check.verdict(), None);
        play(&mut check, &[(-0.001, MOVE)]);
        assert_eq!(check.nearest().map(|nearest| nearest.tick), Some(4), "fingers touch parts now and then");
    }

    #[test]
    fn robot_moved_deep_into_an_obstacle_is_stuck() {
        let mut check = new_check();
        check.look(Tick(1), &[contact("BLANK", Kind::HeldPart, 2.0)], MOVE);
        assert!(!check.is_stuck(), "a part gives way");
        check.look(Tick(2), &[contact("wrist", Kind::Arm, 0.9)], MOVE);
        assert!(!check.is_stuck());
        check.look(Tick(3), &[contact("wrist", Kind::Arm, 1.1)], MOVE);
        assert!(check.is_stuck());
    }
}
