//! A run with a device in simulated time.

use couplers::{Emulated, Kind, MS, Mode, Orders, Plan, Simulated, State};

use super::common::{CLAMP, CLOCK, TICK, VALVE, words};

/// A run with a device: two exchanges per tick, 1 ms after its beginning and 8 ms before the next one.
pub struct Run {
    pub device: Simulated,
    pub now: u64,
    pub orders: Orders,
    /// The run writes new orders in each tick.
    pub is_alive: bool,
}

impl Run {
    /// A coupler with four input registers and two output registers, whatever the plan needs.
    pub fn of(plan: Plan) -> Self {
        let kind = plan.kind;
        let coupler = if kind == Kind::Values { Emulated::of(&plan) } else { Emulated::new(kind, 1, 4, 2) };
        let device = Simulated::new(plan, coupler, 15).expect("a sound plan");
        let orders = Orders { tick: 0, mode: Mode::Run, go: 0, words: words(VALVE | CLAMP) };
        Self { device, now: 0, orders, is_alive: true }
    }

    /// A run whose device has been set up and written.
    pub fn running(plan: Plan) -> Self {
        let mut run = Self::of(plan);
        run.ticks(5);
        assert_eq!((run.state(), run.outputs()), (State::Running, VALVE | CLAMP));
        run
    }

    pub fn tick(&mut self) {
        if self.is_alive {
            self.orders.tick += 1;
            self.orders.words.words[CLOCK] = u16::try_from(self.orders.tick).expect("a short run");
        }
        for offset in [1, 32] {
            self.device.exchange(self.now + offset * MS, &self.orders);
        }
        self.now += TICK;
        self.device.coupler_mut().advance(self.now);
    }

    pub fn ticks(&mut self, count: u64) {
        for _ in 0..count {
            self.tick();
        }
    }

    pub fn cut_for(&mut self, ticks: u64) {
        self.device.cut(true);
        self.ticks(ticks);
        self.device.cut(false);
    }

    pub fn state(&self) -> State {
        self.device.report().state
    }

    pub fn outputs(&self) -> u16 {
        self.device.coupler().outputs()[0]
    }
}
