use geometry::frame::{INCHES_PER_RADIAN, Rotation, rotation_vector};
use interfaces::device::ForceSensor;
use rcs_core::tick::TICK_S;

use super::{guarded::stopping_path, *};
use crate::{
    coverage::silent,
    prim::{manual::ACCELERATION, tables::TABLES},
};

const VELOCITY: f64 = 10.0; // in/s, the greatest of all parameter sets
const JERK: f64 = 250.0; // in/s³, the least of all parameter sets

struct Watch {
    number: u32,
    frames: [Frame; 3],
    /// Frame and speed at the trip of the current guarded move.
    trip: Option<(u32, Frame, f64)>,
}

impl Watch {
    fn new(rig: &Rig) -> Self {
        Self { number: rig.memory.prim.t3i.number, frames: [rig.commanded(); 3], trip: None }
    }

    fn speed(&self) -> f64 {
        self.frames[1].distance(&self.frames[2]).path() / TICK_S
    }

    /// A checked tick of the rig. Time is counted in points: the path stops while no point is sent.
    fn step(&mut self, rig: &mut Rig) -> Result<(), String> {
        let before = rig.commanded();
        rig.step();
        let (header, command) = (rig.memory.prim.header, rig.memory.prim.status.echo);
        // The condition, or a faulty sensor.
        let decided = header.decided.unwrap();
        let table = TABLES[usize::from(decided.table) - 1].name;
        if matches!((table, decided.row), ("GO-UNTIL" | "GO-WHILE", 1 | 2)) && !rig.at_rest() {
            self.trip.get_or_insert((command, before, self.speed()));
        }
        if rig.memory.prim.t3i.number == self.number {
            return Ok(());
        }
        self.number = rig.memory.prim.t3i.number;
        self.frames.rotate_left(1);
        self.frames[2] = rig.commanded();
        self.check()?;
        match self.trip {
            Some((of, at, speed)) if of == command => {
                let (beyond, path) =
                    (at.distance(&self.frames[2]).path(), stopping_path(speed, ACCELERATION, JERK));
                if beyond > path + 1e-9 {
                    Err(format!("{beyond} in beyond the trip, not {path}"))
                } else {
                    Ok(())
                }
            }
            _ => {
                self.trip = None;
                Ok(())
            }
        }
    }

    fn check(&self) -> Result<(), String> {
        let rate = |a: &Frame, b: &Frame| {
            let turn: Rotation = b.rotation * a.rotation.inverse();
            ((b.position - a.position) / TICK_S, rotation_vector(&turn) * (INCHES_PER_RADIAN / TICK_S))
        };
        let [a, b, c] = &self.frames;
        let (before, now) = (rate(a, b), rate(b, c));
        for (what, value, limit) in [
            ("velocity", norm(&now.0), VELOCITY),
            ("angular velocity", norm(&now.1), VELOCITY),
            ("acceleration", norm(&(now.0 - before.0)) / TICK_S, ACCELERATION),
            ("angular acceleration", norm(&(now.1 - before.1)) / TICK_S, ACCELERATION),
        ] {
            // Rotation vectors are exact to about 1e-9 rad.
            if value > limit * (1.0 + 1e-9) + 1e-4 {
                return Err(format!("{what} {value} over {limit}"));
            }
        }
        Ok(())
    }
}

impl Rig {
    fn below(&mut self, n: u64) -> u64 {
        self.world.stalled();
        (self.world.noise >> 11) % n
    }

    fn disturb(&mut self, operator: bool) {
        if self.below(30) == 0 {
            self.external.devices.holsters.right = [0, 3, 15][self.below(3) as usize];
        }
        if self.below(20) == 0 {
            let z = [2048, 2048, 2440, 2460, 4095, 0][self.below(6) as usize];
            self.external.devices.force =
                ForceSensor { x: 2048, y: 2048, z, moment: 2048, valid: self.below(9) > 0 };
        }
        if self.below(40) == 0 {
            self.external.devices.joystick.velocity = [0, 1, 300, 1000, 1000][self.below(5) as usize];
        }
        if operator && self.below(25) == 0 {
            let frame = [0, 0, 1, 1, 2, 4, 8, 8, 3, 0x40][self.below(10) as usize];
            self.frame_switch(frame);
        }
        if operator && self.below(10) == 0 {
            let (x, y) = (self.below(2400) as i16 - 1200, self.below(2400) as i16 - 1200);
            self.stick(x, y);
            let bits = self.below(16);
            let joystick = &mut self.external.devices.joystick;
            (joystick.up, joystick.down) = (bits & 1 != 0, bits & 2 != 0);
            (joystick.roll_plus, joystick.roll_minus) = (bits & 4 != 0, bits & 8 != 0);
        }
    }

    fn random_command(&mut self) {
        let verb = [
            PrimVerb::GoUntil,
            PrimVerb::GoUntil,
            PrimVerb::GoWhile,
            PrimVerb::DeltaMove,
            PrimVerb::CalSensor,
            PrimVerb::Pause,
            PrimVerb::Pause,
        ][self.below(7) as usize];
        let sensor = ["NEAR-R", "SEATED-R", "PUSH-X"][self.below(3) as usize];
        let pose = 1 + self.below(3) as u32;
        self.guard(verb, pose, sensor);
        self.memory.emove.prim.trajectory_parameters = TrajParaId::new([1, 3, 4][self.below(3) as usize]);
    }
}

fn run(seed: u64, operator: bool) -> Result<(), String> {
    let mut rig = Rig::initialized();
    (rig.world.noise, rig.world.stalls) = (seed, seed % 8);
    let mut watch = Watch::new(&rig);
    for number in 0..12 {
        rig.random_command();
        for tick in 0..rig.below(120) {
            rig.disturb(operator);
            watch
                .step(&mut rig)
                .map_err(|text| format!("seed {seed}, command {number}, tick {tick}: {text}"))?;
        }
    }
    // The last command can be ended in every state.
    (rig.external.devices.joystick.velocity, rig.world.stalls) = (1000, 0);
    rig.frame_switch(0);
    rig.command(PrimVerb::GotoPt, 2);
    for _ in 0..2000 {
        watch.step(&mut rig).map_err(|text| format!("seed {seed}, at the end: {text}"))?;
    }
    assert_eq!(rig.report(), PrimReport::Done, "seed {seed}: {:#?}", rig.process.state());
    assert_eq!(rig.world.t3i.output, WireFrame::from_frame(&shifted(10.0, 10.0)));
    Ok(())
}

fn silent_in(scenario: fn()) -> Vec<String> {
    silent::<Prim, TaskData<'_>>(&[scenario])
}

fn runs(operator: bool) {
    (1..=600).for_each(|seed| run(seed, operator).unwrap_or_else(|text| panic!("{text}")));
}

#[test]
fn random_guarded_moves_keep_limits_and_stop_where_they_trip() {
    let silent = silent_in(|| runs(false));
    // The moves tripped, missed and failed.
    for row in ["GO-UNTIL 1", "GO-UNTIL 2", "GO-UNTIL 6", "GO-UNTIL 9"] {
        assert!(!silent.contains(&row.to_owned()), "{row} has not fired");
    }
}

#[test]
fn random_operator_keeps_the_limits() {
    let missing = silent_in(|| runs(true)).into_iter().filter(|row| row.starts_with("PAUSE"));
    let expected = ["PAUSE 1", "PAUSE 2", "PAUSE 3", "PAUSE 4", "PAUSE 5", "PAUSE 6", "PAUSE 8", "PAUSE 12"];
    assert_eq!(
        missing.collect::<Vec<_>>(),
        expected,
        "these rows need a link that fails, a Prim without a position, or a robot that never rests"
    );
}
