use interfaces::device::{QuickChangeSensors, QuickChangeValves};

/// The locking ring of the quick change, with its two sensors and the id pins.
#[derive(Clone, Copy, Debug)]
pub struct Ring {
    pub place: f64,       // 0 unlocked, 1 locked
    pub speed: f64,       // share of its travel per tick
    pub jam: Option<f64>, // where it jams
    pub id: u8,
    pub claim: Option<QuickChangeSensors>, // replaces the true readings
}

impl Ring {
    pub const fn at(place: f64) -> Self {
        Self { place, speed: 0.125, jam: None, id: 1, claim: None }
    }

    pub fn turn(&mut self, valves: QuickChangeValves) {
        let way = match (valves.port, valves.lock, valves.unlock) {
            (true, true, false) => self.speed,
            (true, false, true) => -self.speed,
            _ => 0.0,
        };
        let next = (self.place + way).clamp(0.0, 1.0);
        let jammed = self.jam.is_some_and(|at| (at - self.place) * (at - next) < 0.0);
        self.place = if jammed { self.place } else { next };
    }

    pub fn sensors(&self) -> QuickChangeSensors {
        let (locked, unlocked) = (self.place >= 1.0, self.place <= 0.0);
        self.claim.unwrap_or(QuickChangeSensors { locked, unlocked, end_effector_id: self.id })
    }
}

pub const fn mated(is_locked: bool, id: u8) -> QuickChangeSensors {
    let end_effector_id = if is_locked { id } else { 0 };
    QuickChangeSensors { locked: is_locked, unlocked: !is_locked, end_effector_id }
}
