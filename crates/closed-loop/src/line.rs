//! The line to the simulated robot controller, and its faults.

use depc::fault::{Counts, Direction, FaultKind, Injector, Plan, Rule};
use interfaces::{DeviceInputs, DeviceOutputs};
use plant::Cell;
use rcs_core::tick::Tick;

/// Delay of a late answer, ticks: longer than the host's answer timeout of three ticks.
const LATE: u16 = 5;

#[derive(Clone, Copy, Debug, Default)]
pub struct RobotLine {
    plan: Option<Injector>,
    armed: Option<FaultKind>,
    answer: Option<Injector>, // applies the fault to the last affected answer
}

impl RobotLine {
    /// Start a fault plan now. Returns false, without a change, if the line already has a plan.
    pub fn apply_faults(&mut self, plan: &Plan) -> bool {
        let free = self.plan.is_none();
        if free {
            self.replace_plan(plan);
        }
        free
    }

    pub fn replace_plan(&mut self, plan: &Plan) {
        self.plan = Some(Injector::new(plan));
    }

    /// Apply a fault to the next answer of the robot controller.
    pub const fn spoil_answer(&mut self, kind: FaultKind) {
        self.armed = Some(kind);
    }

    /// Cut the cable after tick `now`: no byte arrives, and the DTR of the other end is off.
    pub fn cut(&mut self, now: Tick) {
        let mut plan = Plan::new(0);
        for kind in [FaultKind::Drop, FaultKind::CtsLow] {
            let _ = plan.add(Rule::new(kind).window(now.0.saturating_add(1), u64::MAX));
        }
        self.replace_plan(&plan);
    }

    /// Discard the faults that are over after tick `now`. Call it only if no others follow.
    pub fn forget_past(&mut self, now: Tick) {
        self.plan.take_if(|injector| injector.is_over(now));
        self.answer.take_if(|injector| injector.is_over(now));
    }

    /// Number of injected faults in both directions; `None` without a plan.
    #[must_use]
    pub fn faults(&self) -> Option<Counts> {
        self.plan.as_ref().map(Injector::total)
    }

    /// Advance the cell by a tick, with the bytes of the line. Returns the device words of the next tick.
    pub(crate) fn advance(&mut self, tick: Tick, cell: &mut Cell, outputs: &DeviceOutputs) -> DeviceInputs {
        let mut inputs = match &mut self.plan {
            None => cell.step(outputs),
            Some(injector) => cell.step_behind(injector, tick, outputs),
        };
        self.strike(tick, &inputs);
        if let Some(injector) = &mut self.answer {
            (inputs.link_rx, inputs.link_ready) =
                injector.carry(Direction::ToHost, tick, &inputs.link_rx, inputs.link_ready);
        }
        inputs
    }

    /// Apply an armed fault in this tick if bytes have arrived.
    fn strike(&mut self, tick: Tick, inputs: &DeviceInputs) {
        let Some(kind) = self.armed.filter(|_| inputs.link_rx.length > 0) else { return };
        self.armed = None;
        let rule = Rule::new(kind).at(tick.0).only(Direction::ToHost);
        let rule = if kind == FaultKind::Delay { rule.ticks(LATE) } else { rule };
        let mut plan = Plan::new(tick.0);
        // A plan with a single rule accepts every rule for one tick.
        if plan.add(rule).is_ok() {
            self.answer = Some(Injector::new(&plan));
        }
    }
}
