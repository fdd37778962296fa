//! One scene for two engines: a six-joint arm with a gripper and ten parts, as rapier bodies and as an MJCF file.
//!
//! ```text
//! cargo run --release -p plant --example peer_scene -- mjcf PATH     write the scene for MuJoCo
//! cargo run --release -p plant --example peer_scene -- rapier STEP   run it in rapier, steps of STEP seconds
//! cargo run --release -p plant --example peer_scene -- plant         run the cell of this project
//! ```
//! Both engines get the same lengths, masses, friction, gains and references: each joint has a motor with the torque
//! kp (reference - q) - kd q', the references change once in a tick of 40 ms. The arm of the project's own cell is not such
//! an arm: its joints follow their servos in closed form (`plant`'s head comment says why), so the third figure is not a
//! comparison of engines but what this project does with one.
//!
//! All times are those of one core, as Linux counts them for the thread, so that other programs disturb little.

#![expect(clippy::print_stdout, reason = "figures are what it is for")]

#[path = "../../crates/plant/tests/rig/mod.rs"]
mod rig;

use std::fmt::Write as _;

use plant::Cell;
use rapier3d_f64::prelude::*;
use rig::{description, scenes};

/// Simulated seconds of a run.
const SECONDS: f64 = 10.0;
/// A tick of the controller, s.
const TICK: f64 = 0.040;
/// In which the joints go to their swing and back, s.
const PERIOD: f64 = 5.0;
/// Runs; the least time counts.
const RUNS: usize = 5;
const FRICTION: f64 = 0.5;
/// Half the edge of a part, m, and its mass, kg.
const PART: (f64, f64) = (0.0254, 1.0);
/// Motors of the fingers, N/m, N·s/m: the left one stands; the right one presses with a force, N, as a motor with that limit and
/// a reference that it never reaches.
const STAND: [f64; 2] = [1.0e6, 4.0e3];
const PRESS: [f64; 2] = [1.0e5, 1.0e3];
const GRIP: f64 = 300.0;
/// Half sizes of a finger, m, and its mass, kg.
const FINGER: ([f64; 3], f64) = ([0.070, 0.00635, 0.019], 2.0);
/// Top of the table on which the parts lie, m.
const TABLE: f64 = -0.60;

/// A link of the arm: the joint that moves it, and a capsule from the joint to where the next one is.
struct Link {
    name: &'static str,
    /// Where its joint is, m, with the arm at its start; all axes are the world's then.
    at: [f64; 3],
    axis: [f64; 3],
    /// End of the capsule, from the joint.
    to: [f64; 3],
    radius: f64,
    mass: f64,
    /// N·m/rad and N·m·s/rad.
    gains: [f64; 2],
    /// Amplitude of its reference, rad.
    swing: f64,
}

/// The lengths of the T3 (40, 40, 3, 6 in), upper arm 45 degrees up and forearm 45 degrees down; masses and gains are assumed.
const fn links() -> [Link; 6] {
    // 40 in, and its share along each axis at 45 degrees.
    const D: f64 = 1.016 * core::f64::consts::FRAC_1_SQRT_2;
    const Y: [f64; 3] = [0.0, 1.0, 0.0];
    const Z: [f64; 3] = [0.0, 0.0, 1.0];
    const X: [f64; 3] = [1.0, 0.0, 0.0];
    const fn link(
        name: &'static str,
        at: [f64; 3],
        axis: [f64; 3],
        to: [f64; 3],
        [radius, mass, swing]: [f64; 3],
        gains: [f64; 2],
    ) -> Link {
        Link { name, at, axis, to, radius, mass, gains, swing }
    }
    [
        link("base", [0.0; 3], Z, [0.0, 0.0, -0.50], [0.20, 250.0, 0.10], [2.0e6, 1.0e5]),
        link("shoulder", [0.0; 3], Y, [D, 0.0, D], [0.12, 150.0, 0.05], [2.0e6, 1.0e5]),
        link("elbow", [D, 0.0, D], Y, [D, 0.0, -D], [0.10, 100.0, 0.05], [1.0e6, 3.0e4]),
        link("pitch", [2.0 * D, 0.0, 0.0], Y, [0.0762, 0.0, 0.0], [0.06, 15.0, 0.10], [2.0e4, 400.0]),
        link("yaw", [2.0 * D + 0.0762, 0.0, 0.0], Z, [0.1524, 0.0, 0.0], [0.06, 15.0, 0.10], [1.0e4, 200.0]),
        link("roll", [2.0 * D + 0.2286, 0.0, 0.0], X, [0.165, 0.0, 0.0], [0.06, 18.0, 0.20], [2.0e3, 20.0]),
    ]
}

/// Middles of the fingers and of the part between them, m.
fn gripped() -> ([[f64; 3]; 2], [f64; 3]) {
    let roll = &links()[5];
    let x = roll.at[0] + roll.to[0] + 0.070;
    let y = PART.0 + FINGER.0[1];
    ([[x, y, 0.0], [x, -y, 0.0]], [x + 0.045, 0.0, 0.0])
}

/// Middles of all ten parts: one in the fingers, five in a stack, four beside it.
fn parts() -> Vec<[f64; 3]> {
    let stacked = (0..5).map(|layer| [1.5, 0.6, TABLE + PART.0 * (1.0 + 2.0 * f64::from(layer))]);
    let spread = (0..4).map(|place| [1.2 + 0.2 * f64::from(place), -0.6, TABLE + PART.0]);
    [gripped().1].into_iter().chain(stacked).chain(spread).collect()
}

/// Reference of a joint in a tick, rad: it begins at rest, and its steps from tick to tick ask for less than the fingers hold.
fn reference(link: &Link, tick: u32) -> f64 {
    link.swing * 0.5 * (1.0 - libm::cos(2.0 * core::f64::consts::PI * f64::from(tick) * TICK / PERIOD))
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["mjcf", path] => std::fs::write(path, mjcf()).expect("the file can be written"),
        ["rapier", step] => run_rapier(step.parse().expect("a step in seconds")),
        ["plant"] => run_plant(),
        _ => panic!("expected `mjcf PATH`, `rapier STEP` or `plant`, found {words:?}"),
    }
}

/// The scene for MuJoCo. Contacts and solver are MuJoCo's defaults.
fn mjcf() -> String {
    let vector = |v: [f64; 3]| format!("{} {} {}", v[0], v[1], v[2]);
    let mut text = format!(
        "<mujoco model=\"peer\">\n<compiler angle=\"radian\"/>\n<option integrator=\"implicitfast\"/>\n\
         <default><geom friction=\"{FRICTION} 0 0\" contype=\"0\" conaffinity=\"0\"/></default>\n<worldbody>\n\
         <geom type=\"box\" pos=\"1.5 0 {}\" size=\"1 1 0.05\" contype=\"1\" conaffinity=\"1\"/>\n",
        TABLE - 0.05
    );
    let mut from = [0.0; 3];
    for link in links() {
        let offset = [0, 1, 2].map(|axis| link.at[axis] - from[axis]);
        from = link.at;
        writeln!(
            text,
            "<body name=\"{0}\" pos=\"{1}\"><joint name=\"{0}\" axis=\"{2}\"/>\
             <geom type=\"capsule\" fromto=\"0 0 0 {3}\" size=\"{4}\" mass=\"{5}\"/>",
            link.name,
            vector(offset),
            vector(link.axis),
            vector(link.to),
            link.radius,
            link.mass
        )
        .expect("a string takes everything");
    }
    for (name, finger) in ["left", "right"].into_iter().zip(gripped().0) {
        let offset = [0, 1, 2].map(|axis| finger[axis] - from[axis]);
        writeln!(
            text,
            "<body name=\"{name}\" pos=\"{}\"><joint name=\"{name}\" type=\"slide\" axis=\"0 1 0\"/>\
             <geom type=\"box\" size=\"{}\" mass=\"{}\" contype=\"1\" conaffinity=\"2\"/></body>",
            vector(offset),
            vector(FINGER.0),
            FINGER.1
        )
        .expect("a string takes everything");
    }
    text.push_str(&"</body>".repeat(links().len()));
    for (number, part) in parts().into_iter().enumerate() {
        writeln!(
            text,
            "\n<body name=\"part_{number}\" pos=\"{}\"><freejoint/><geom type=\"box\" size=\"{1} {1} {1}\" mass=\"{2}\" \
             contype=\"3\" conaffinity=\"3\"/></body>",
            vector(part),
            PART.0,
            PART.1
        )
        .expect("a string takes everything");
    }
    text.push_str("</worldbody>\n<actuator>\n");
    for link in links() {
        let [kp, kd] = link.gains;
        writeln!(text, "<position joint=\"{}\" kp=\"{kp}\" kv=\"{kd}\"/>", link.name)
            .expect("a string takes everything");
    }
    let [[stand, stand_damping], [press, press_damping]] = [STAND, PRESS];
    writeln!(
        text,
        "<position joint=\"left\" kp=\"{stand}\" kv=\"{stand_damping}\"/>\n\
         <position joint=\"right\" kp=\"{press}\" kv=\"{press_damping}\" forcerange=\"-{GRIP} {GRIP}\"/>"
    )
    .expect("a string takes everything");
    text.push_str("</actuator>\n</mujoco>\n");
    text
}

/// The scene in rapier, with the stiffness of contacts that the cell has.
struct Scene {
    world: PhysicsWorld,
    joints: Vec<MultibodyJointHandle>,
    parts: Vec<RigidBodyHandle>,
    hand: RigidBodyHandle,
}

/// Membership of what collides, and what it collides with.
const TOUCHING: [Group; 2] = [Group::GROUP_1, Group::GROUP_2];

impl Scene {
    fn new(step: f64) -> Self {
        let mut world = PhysicsWorld::new();
        world.gravity = Vector::new(0.0, 0.0, -9.81);
        let physics = description().physics;
        let softness = SpringCoefficients::new(physics.contact_frequency, physics.contact_damping);
        let parameters = &mut world.integration_parameters;
        parameters.dt = step;
        parameters.num_solver_iterations = physics.solver_iterations;
        (parameters.contact_softness, parameters.static_contact_softness) = (softness, softness);
        parameters.normalized_allowed_linear_error = 1e-5;
        let ground = world.insert_body(RigidBodyBuilder::fixed());
        let table = ColliderBuilder::cuboid(1.0, 1.0, 0.05).translation(Vector::new(1.5, 0.0, TABLE - 0.05));
        let groups = |member, meets| InteractionGroups::new(member, meets, InteractionTestMode::And);
        let [finger_group, part_group] = TOUCHING;
        let table = table.friction(FRICTION).collision_groups(groups(Group::GROUP_3, part_group));
        world.insert_collider(table, Some(ground));
        let (mut joints, mut parent, mut from) = (Vec::new(), ground, Vector::ZERO);
        for link in links() {
            let at = Vector::from_array(link.at);
            let body = world.insert_body(RigidBodyBuilder::dynamic().translation(at).can_sleep(false));
            let capsule = ColliderBuilder::capsule_from_endpoints(
                Vector::ZERO,
                Vector::from_array(link.to),
                link.radius,
            );
            let nothing = groups(Group::empty(), Group::empty());
            world.insert_collider(capsule.mass(link.mass).collision_groups(nothing), Some(body));
            let [kp, kd] = link.gains;
            let joint = RevoluteJointBuilder::new(Vector::from_array(link.axis))
                .local_anchor1(at - from)
                .contacts_enabled(false)
                .motor_model(MotorModel::ForceBased)
                .motor(0.0, 0.0, kp, kd);
            joints.push(world.insert_multibody_joint(parent, body, joint).expect("a chain"));
            (parent, from) = (body, at);
        }
        for (motor, finger) in [(STAND, None), (PRESS, Some(GRIP))].into_iter().zip(gripped().0) {
            let at = Vector::from_array(finger);
            let body = world.insert_body(RigidBodyBuilder::dynamic().translation(at).can_sleep(false));
            let [x, y, z] = FINGER.0;
            let pad = ColliderBuilder::cuboid(x, y, z).mass(FINGER.1).friction(FRICTION);
            world.insert_collider(pad.collision_groups(groups(finger_group, part_group)), Some(body));
            let joint = PrismaticJointBuilder::new(Vector::Y)
                .local_anchor1(at - from)
                .contacts_enabled(false)
                .motor_model(MotorModel::ForceBased);
            let joint = match motor {
                ([stiffness, damping], None) => joint.motor_position(0.0, stiffness, damping),
                ([stiffness, damping], Some(force)) => {
                    joint.motor_position(1.0, stiffness, damping).motor_max_force(force)
                }
            };
            joints.push(world.insert_multibody_joint(parent, body, joint).expect("a chain"));
        }
        let parts = parts().into_iter().map(|at| {
            let body = world.insert_body(RigidBodyBuilder::dynamic().translation(Vector::from_array(at)));
            let cube = ColliderBuilder::cuboid(PART.0, PART.0, PART.0).mass(PART.1).friction(FRICTION);
            world.insert_collider(cube.collision_groups(groups(part_group, Group::ALL)), Some(body));
            body
        });
        let parts = parts.collect();
        Self { world, joints, parts, hand: parent }
    }

    fn run(&mut self) {
        let steps = (TICK / self.world.integration_parameters.dt).round() as u32;
        for tick in 1..=(SECONDS / TICK).round() as u32 {
            for (link, joint) in links().iter().zip(&self.joints) {
                if let Some((multibody, id)) = self.world.multibody_joints.get_mut(*joint)
                    && let Some(link_of) = multibody.link_mut(id)
                {
                    let [kp, kd] = link.gains;
                    link_of.joint.data.set_motor(JointAxis::AngX, reference(link, tick), 0.0, kp, kd);
                }
            }
            (0..steps).for_each(|_| self.world.step());
        }
    }

    /// Where the part in the fingers is in the hand, m.
    fn in_hand(&self) -> Vector {
        let hand = self.world.bodies[self.hand].position();
        hand.inverse_transform_point(self.world.bodies[self.parts[0]].translation())
    }
}

fn run_rapier(step: f64) {
    let mut times = Vec::new();
    let mut last = None;
    for _ in 0..RUNS {
        let mut scene = Scene::new(step);
        let before = scene.in_hand();
        let start = seconds();
        scene.run();
        times.push(seconds() - start);
        last = Some((scene.in_hand() - before, scene));
    }
    let Some((slid, scene)) = last else { return };
    let top = scene.world.bodies[scene.parts[5]].translation();
    let sunk = parts()[5][2] - top.z;
    report("rapier", &times, SECONDS, slid.length(), sunk);
}

fn run_plant() {
    let description = description();
    let tape = scenes::clamping(1).tape.expect("the scene is on tape");
    let simulated = tape.beats.len() as f64 * TICK;
    let times: Vec<f64> = (0..RUNS)
        .map(|_| {
            let mut cell = Cell::new(&description, 1).expect("the cell of the project");
            let start = seconds();
            tape.beats.iter().for_each(|beat| beat.play(&mut cell));
            seconds() - start
        })
        .collect();
    let least = times.iter().copied().fold(f64::INFINITY, f64::min);
    println!(
        "{{\"engine\": \"plant\", \"simulated_s\": {simulated}, \"cpu_s\": {times:?}, \"realtime_factor\": {}}}",
        simulated / least
    );
}

fn report(engine: &str, times: &[f64], simulated: f64, slid: f64, sunk: f64) {
    let least = times.iter().copied().fold(f64::INFINITY, f64::min);
    println!(
        "{{\"engine\": \"{engine}\", \"simulated_s\": {simulated}, \"cpu_s\": {times:?}, \"realtime_factor\": {}, \
         \"slid_mm\": {}, \"sunk_mm\": {}}}",
        simulated / least,
        slid * 1e3,
        sunk * 1e3
    );
}

/// Time that this thread has had a core, s.
fn seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").expect("a Linux with schedstat");
    let nanoseconds: f64 =
        text.split(' ').next().and_then(|word| word.parse().ok()).expect("nanoseconds first");
    nanoseconds / 1e9
}
