//! Beliefs that a person writes while E-move is not stepped.

use interfaces::{
    emove::{Beliefs, EmoveVerb::MovObjTo, Holding, Located, ObjectGrip, PlacedObject},
    operator::{Variable, Write},
    process::{Inputs, Process},
};
use rcs_core::name::Name16;

use super::bench::{Bench, DONE};
use crate::emove::Emove;

impl Bench {
    /// Write a value between two ticks.
    fn put(&mut self, variable: Variable, object: &str, grip: i32) {
        let object = Some(Name16::clipped(object)).filter(|object| !object.is_empty());
        let before = self.memory;
        let inputs =
            Inputs { tick: self.tick.next(), memory: &before, external: &self.external, data: &self.data };
        self.process.write(&Write { variable, object, grip }, &inputs, &mut self.memory.emove);
    }

    /// The parts gripper feels something without a name, so wide.
    fn feeling(size: i32) -> Self {
        let mut bench = Self::new("HOME", 1);
        (bench.grip.opening, bench.world.object) = (size, Some(size));
        bench.steps(3);
        bench.process = Emove::default();
        bench.memory.emove.beliefs.empty = false;
        assert_eq!(bench.pause(), DONE);
        assert_eq!(bench.memory.emove.status.held, Holding::Something);
        bench
    }

    fn held(&self) -> Holding {
        self.memory.emove.status.held
    }
}

fn block() -> Holding {
    Holding::Object(ObjectGrip { object: Name16::clipped("BLOCK"), grip: 1 })
}

#[test]
fn what_is_felt_has_the_name_that_is_written() {
    let mut bench = Bench::feeling(75);
    bench.put(Variable::Held, "BLOCK", 1);
    bench.steps(10);
    assert_eq!(bench.held(), block());
    assert_eq!(bench.run(MovObjTo, "BLOCK", 1, "BENCH", 1), DONE);
    assert_eq!(bench.held(), block());
    bench.put(Variable::Held, "", 0);
    bench.steps(10);
    assert_eq!(bench.held(), Holding::Something, "it is held, and has no name");
}

#[test]
fn a_restarted_e_move_adopts_what_was_written_before_its_first_tick() {
    let mut bench = Bench::feeling(75);
    bench.process = Emove::default();
    bench.put(Variable::Held, "BLOCK", 1);
    bench.steps(10);
    assert_eq!(bench.held(), block());
}

#[test]
fn sensors_and_task_data_count_more_than_what_is_written() {
    for (size, object, grip, why) in [
        (40, "BLOCK", 1, "fingers that are closer than the grasp size"),
        (75, "BLOCK", 9, "no such grip"),
        (75, "NO-SUCH", 1, "no such object"),
    ] {
        let mut bench = Bench::feeling(size);
        bench.put(Variable::Held, object, grip);
        bench.steps(10);
        assert_eq!(bench.held(), Holding::Something, "{why}");
    }
    let mut bench = Bench::ready("HOME", 1);
    bench.put(Variable::Held, "BLOCK", 1);
    bench.steps(10);
    assert_eq!(bench.held(), Holding::Nothing, "nothing is felt");
}

#[test]
fn beliefs_are_forgotten() {
    let mut bench = Bench::ready("HOME", 1);
    let placed = Some(PlacedObject { grip: 1, ..PlacedObject::default() });
    let located = Some(Located::default());
    for variable in [Variable::Placed, Variable::Located] {
        let state = &mut bench.process.state;
        state.adopt(&Beliefs { placed, located, ..state.beliefs() });
        bench.step();
        bench.put(variable, "", 0);
        let beliefs = bench.memory.emove.beliefs;
        let kept = (beliefs.placed.is_some(), beliefs.located.is_some());
        assert_eq!(kept, (variable == Variable::Located, variable == Variable::Placed), "{variable}");
        bench.step();
        assert_eq!(bench.memory.emove.status.placed.is_some(), kept.0, "{variable}");
    }
}
