//! Between two ticks: what operators ask for.

use rcs_core::tick::Tick;

use super::Run;
use crate::operator::{A_TICK, Around};

impl Run {
    /// What operators have asked for since the last tick. The next tick is the first to see it.
    pub(super) fn operate(&mut self, tick: Tick) {
        let first = tick.next();
        for _ in 0..A_TICK {
            let Some(input) = self.asked.next(first) else { break };
            let mut around = Around {
                tick,
                memory: self.runner.memory(),
                store: self.generations.current(),
                data: &self.config.data,
                neighbours: &mut self.neighbours,
                workstation: &mut self.workstation,
            };
            let mut verdict = self.operator.carry_out(&input, &mut around);
            if let Some(block) = self.operator.take_load() {
                // A log has no text of what was not loaded.
                verdict = match input.refusal() {
                    Some(why) => Err(why.to_owned()),
                    None => self.load_block(block).map_err(|error| error.to_string()),
                };
                if verdict.is_err() {
                    self.operator.refused();
                }
            }
            let line = input.line(first, &verdict);
            if let Some(difference) = input.answer(first, &verdict) {
                self.observer.message(&format!("tick {first}: {difference}"));
            }
            if let (Some(log), Some(line)) = (&mut self.log, line) {
                log.operator(line);
            }
        }
        self.operator.end_tick();
    }
}
