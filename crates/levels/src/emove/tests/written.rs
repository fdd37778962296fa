use interfaces::{
    emove::{EmoveVerb::MovObjTo, Estimates, Holding, Located, ObjectGrip, PlacedObject},
    operator::{Variable, Write},
    process::{Inputs, Process},
};
use rcs_core::name::Name16;

use super::bench::{Bench, DONE};

impl Bench {
    fn put(&mut self, variable: Variable, object: &str, grip: i32) {
        let object = Some(Name16::clipped(object)).filter(|object| !object.is_empty());
        let before = self.memory;
        let inputs =
            Inputs { tick: self.tick.next(), memory: &before, external: &self.external, data: &self.data };
        self.process.write(&Write { variable, object, grip }, &inputs, &mut self.memory.emove);
    }
}

fn held(bench: &Bench) -> Holding {
    bench.memory.emove.status.held
}

fn block() -> Holding {
    Holding::Object(ObjectGrip { object: Name16::clipped("BLOCK"), grip: 1 })
}

#[test]
fn detected_object_adopts_the_written_name() {
    let mut bench = Bench::with_unknown("HOME", 75);
    bench.put(Variable::Held, "BLOCK", 1);
    bench.wait(10);
    assert_eq!(held(&bench), block());
    assert_eq!(bench.run(MovObjTo, "BLOCK", 1, "BENCH", 1), DONE);
    assert_eq!(held(&bench), block());
    bench.put(Variable::Held, "", 0);
    bench.wait(10);
    assert_eq!(held(&bench), Holding::Something, "the object is held without a name");
}

#[test]
fn restarted_emove_adopts_values_written_before_its_first_tick() {
    let mut bench = Bench::with_unknown("HOME", 75);
    bench.restart();
    bench.put(Variable::Held, "BLOCK", 1);
    bench.wait(10);
    assert_eq!(held(&bench), block());
}

#[test]
fn sensors_and_task_data_override_written_values() {
    for (size, object, grip, why) in [
        (40, "BLOCK", 1, "fingers that are closer than the grasp size"),
        (75, "BLOCK", 9, "no such grip"),
        (75, "NO-SUCH", 1, "no such object"),
    ] {
        let mut bench = Bench::with_unknown("HOME", size);
        bench.put(Variable::Held, object, grip);
        bench.wait(10);
        assert_eq!(held(&bench), Holding::Something, "{why}");
    }
    let mut bench = Bench::ready("HOME", 1);
    bench.put(Variable::Held, "BLOCK", 1);
    bench.wait(10);
    assert_eq!(held(&bench), Holding::Nothing, "the fingers are empty");
}

#[test]
fn written_estimates_are_cleared() {
    let mut bench = Bench::ready("HOME", 1);
    let placed = Some(PlacedObject { grip: 1, ..PlacedObject::default() });
    let located = Some(Located::default());
    for variable in [Variable::Placed, Variable::Located] {
        let state = &mut bench.process.state;
        state.adopt(&Estimates { placed, located, ..state.estimates() });
        bench.step();
        bench.put(variable, "", 0);
        let estimates = bench.memory.emove.estimates;
        let kept = (estimates.placed.is_some(), estimates.located.is_some());
        assert_eq!(kept, (variable == Variable::Located, variable == Variable::Placed), "{variable}");
        bench.step();
        assert_eq!(bench.memory.emove.status.placed.is_some(), kept.0, "{variable}");
    }
}
