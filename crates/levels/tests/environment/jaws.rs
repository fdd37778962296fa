use interfaces::device::JawValves;
use levels::jaws::{JawsKind, POTENTIOMETER_OFFSET, POTENTIOMETER_SCALE};
use rcs_core::tick::TICK_S;

/// Fingers of V-Grip or Tool-Grip, which air moves at one speed, with a potentiometer.
#[derive(Clone, Debug)]
pub struct Fingers {
    pub opening: f64,
    pub ends: (f64, f64),
    pub speed: f64,          // in/s
    pub object: Option<f64>, // width of an object between the fingers, in
    pub noise: u16,          // greatest noise, counts
    random: u32,
}

impl Fingers {
    pub fn new<K: JawsKind>(opening: f64) -> Self {
        let ends = (K::PARAMETERS.closed, K::PARAMETERS.opened);
        Self { opening, ends, speed: 3.0, object: None, noise: 1, random: 1987 }
    }

    pub fn advance(&mut self, air: JawValves) {
        let way = match (air.open, air.close) {
            (true, false) => self.speed * TICK_S,
            (false, true) => -self.speed * TICK_S,
            _ => return,
        };
        let least = self.object.filter(|size| *size <= self.opening).unwrap_or(self.ends.0);
        self.opening = (self.opening + way).clamp(least, self.ends.1);
    }

    pub fn counts(&mut self) -> u16 {
        self.random = self.random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let noise = f64::from(self.random >> 16) / 65_536.0 * 2.0 - 1.0;
        (POTENTIOMETER_OFFSET + POTENTIOMETER_SCALE * self.opening + f64::from(self.noise) * noise).round()
            as u16
    }
}
