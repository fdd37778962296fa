//! What the judge remembers of earlier ticks: who has changed a part, and what the robot has released.

use std::collections::BTreeMap;

use geometry::frame::{Frame, Vector};
use interfaces::{StatusReport, emove::EmoveVerb};
use rcs_core::tick::Tick;

use super::Scene;

/// A part that the robot has released.
#[derive(Clone, Copy, Debug)]
pub struct Released {
    /// Its number.
    pub id: u32,
    /// Tick in which the fingers opened.
    pub tick: Tick,
    /// The tool frame of the robot in the last tick of the hold, world, in.
    pub tool: Frame,
    /// The part's frame then, world, in.
    pub part: Frame,
}

/// The earlier ticks.
#[derive(Clone, Debug, Default)]
pub struct History {
    /// Last tick in which a person has changed a part, by its number.
    changed: BTreeMap<u32, Tick>,
    /// Tick in which the workstation has delivered a part, by its number.
    delivered: BTreeMap<u32, Tick>,
    /// The part that the robot held after the last tick, with tool frame and part frame.
    held: Option<(u32, Frame, Frame)>,
    pub(super) released: Option<Released>,
    /// Tick in which the robot has taken the part that it holds.
    taken: Tick,
    /// Tick in which the camera has looked last, and the part's name.
    pub(super) looked: Option<(Tick, String)>,
    /// Number of the LOCATE-OBJ of that look.
    look: u32,
}

impl History {
    pub(super) fn note_changed(&mut self, tick: Tick, parts: impl IntoIterator<Item = u32>) {
        self.changed.extend(parts.into_iter().map(|id| (id, tick)));
    }

    pub(super) fn note_delivered(&mut self, tick: Tick, parts: impl IntoIterator<Item = u32>) {
        self.delivered.extend(parts.into_iter().map(|id| (id, tick)));
    }

    pub(super) fn look(&mut self, scene: &Scene<'_>) {
        let cell = scene.cell;
        let held = cell.held();
        if let Some((id, tool, part)) = self.held
            && held != Some(id)
        {
            self.released = Some(Released { id, tick: scene.tick, tool, part });
        }
        if held != self.held.map(|(id, ..)| id) {
            self.taken = scene.tick;
        }
        let frame = |id: u32| Some((id, cell.t3().arm().tool(), cell.part_frame(id)?));
        self.held = held.and_then(frame);
        let (command, status) = (&scene.memory.subtask.emove, &scene.memory.emove.status);
        let located = command.command == EmoveVerb::LocateObj
            && (status.echo, status.report) == (command.number, StatusReport::Done);
        if let (true, Some(object)) = (located && command.number != self.look, command.object) {
            self.look = command.number;
            self.looked = Some((scene.tick, object.to_string()));
        }
    }

    /// The last part that the robot has released, unless it holds it again.
    pub fn released(&self) -> Option<&Released> {
        self.released.as_ref().filter(|released| self.held.is_none_or(|(id, ..)| id != released.id))
    }

    /// True if a person has changed the part since this tick.
    pub fn is_changed_since(&self, id: u32, tick: Tick) -> bool {
        self.changed.get(&id).is_some_and(|changed| *changed >= tick)
    }

    /// True if a person has changed the part since the robot has released it last.
    pub fn is_changed(&self, id: u32) -> bool {
        let released = self.released.as_ref().filter(|released| released.id == id);
        self.is_changed_since(id, released.map_or(Tick(0), |released| released.tick))
    }

    /// True if a person has changed any part since the robot has taken the one that it holds.
    pub fn is_any_changed_since_grasp(&self) -> bool {
        self.changed.values().any(|changed| *changed >= self.taken)
    }

    /// True if a person has changed any part, or one was delivered, since the camera has looked for an object of this name.
    pub fn is_any_changed_since_look(&self, object: &str) -> bool {
        self.looked.as_ref().filter(|(_, name)| name == object).is_some_and(|(tick, _)| {
            self.changed.values().chain(self.delivered.values()).any(|changed| changed >= tick)
        })
    }
}

/// Distance of two points, in.
pub fn apart(one: &Vector, other: &Vector) -> f64 {
    (one - other).norm()
}
