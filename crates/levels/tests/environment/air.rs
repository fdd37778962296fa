use interfaces::device::{ADC_FULL_SCALE, GripSensors, valve};
use rcs_core::tick::TICK_S;

/// Speeds of the flow valves, in/s, opening positive.
const FLOWS: [(u8, f64); 6] = [
    (valve::OPEN_FINE, 0.25),
    (valve::OPEN_MEDIUM, 1.0),
    (valve::OPEN_COARSE, 4.0),
    (valve::CLOSE_FINE, -0.25),
    (valve::CLOSE_MEDIUM, -1.0),
    (valve::CLOSE_COARSE, -4.0),
];
const COMPRESSIBILITY: f64 = 100.0; // lb on a blocked finger per inch that it would have moved
/// Force on the first finger while it pushes the object towards the second, lb.
const PUSH: f64 = 4.0;

#[derive(Clone, Copy, Debug)]
pub struct Object {
    pub size: f64,       // opening at which both fingers touch, in
    pub off_centre: f64, // in, by which one finger touches earlier than the other
}

#[derive(Clone, Debug)]
pub struct Gripper {
    pub opening: f64,
    pub force: f64, // true force of each finger, lb
    pub object: Option<Object>,
    pub noise: u16,                // greatest noise, counts
    pub potentiometer: (f64, f64), // counts at 0, counts per inch
    pub strain: [(f64, f64); 2],   // counts at 0, counts per pound
    pub late: bool,                // valves act one tick late
    pub without_air: bool,         // valves have no effect
    pub patterns: Vec<u8>,         // valve patterns in order, without repetitions
    pending: u8,
    random: u64,
}

impl Gripper {
    pub fn new(opening: f64, seed: u64) -> Self {
        Self {
            opening,
            force: 0.0,
            object: None,
            noise: 1,
            potentiometer: (205.0, 700.0),
            strain: [(310.0, 40.5), (287.0, 39.2)],
            late: false,
            without_air: false,
            patterns: Vec::new(),
            pending: 0,
            random: seed.wrapping_mul(2).wrapping_add(1),
        }
    }

    pub fn advance(&mut self, bits: u8) {
        if self.patterns.last() != Some(&bits) {
            self.patterns.push(bits);
        }
        if self.without_air {
            return;
        }
        let bits = if self.late { core::mem::replace(&mut self.pending, bits) } else { bits };
        let stop = self.object.map_or(0.10, |object| object.size.max(0.10));
        // Trapped air moves the fingers on when their object is removed.
        let gap = (self.opening - stop).max(0.0).min(self.force / COMPRESSIBILITY);
        self.opening -= gap;
        self.force -= gap * COMPRESSIBILITY;
        if bits & valve::VENT != 0 {
            self.force = 0.0;
        }
        if bits & valve::SUPPLY == 0 {
            return;
        }
        let way: f64 = FLOWS.iter().filter(|(bit, _)| bits & bit != 0).map(|(_, flow)| flow * TICK_S).sum();
        if way < 0.0 {
            let free = (-way).min((self.opening - stop).max(0.0));
            self.opening -= free;
            self.force = (self.force + (-way - free) * COMPRESSIBILITY).min(80.0);
        } else {
            let relieved = self.force.min(way * COMPRESSIBILITY);
            self.force -= relieved;
            self.opening = (self.opening + way - relieved / COMPRESSIBILITY).min(5.0);
        }
    }

    pub fn sensors(&mut self) -> GripSensors {
        let [left, right] = match self.object {
            Some(Object { size, off_centre }) if self.opening > size && self.opening <= size + off_centre => {
                [PUSH, 0.0]
            }
            _ => [self.force; 2],
        };
        let opening = self.opening;
        let (potentiometer, strain) = (self.potentiometer, self.strain);
        GripSensors {
            potentiometer: self.counts(potentiometer, opening),
            strain_left: self.counts(strain[0], left),
            strain_right: self.counts(strain[1], right),
            beams: 0,
        }
    }

    fn counts(&mut self, (zero, scale): (f64, f64), value: f64) -> u16 {
        // Marsaglia's xorshift: 64 bits, never 0.
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        let range = 2 * u64::from(self.noise) + 1;
        let noise = (self.random >> 20) % range;
        (zero + scale * value + noise as f64 - f64::from(self.noise))
            .round()
            .clamp(0.0, f64::from(ADC_FULL_SCALE)) as u16
    }
}
