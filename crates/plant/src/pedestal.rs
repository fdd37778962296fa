//! The Active Pedestal (II.1.2.3, III.9, III.10): a hand like the parts gripper, pointing up, on a table that
//! a step motor turns.
//!
//! Three angles, all in degrees and positive to the left seen from above (ASSUMED):
//!
//! * the *counter* of the motor's controller: steps since it was last set, the only angle that the pedestal's
//!   controller has. It is not valid before it was set at the + limit;
//! * the *motor angle*: the counter after a calibration by IV.1 step 3. The motor stops at once at a switch;
//! * the *table angle*: the angle of the hand. In VII.7.4 a motor angle of 183.5 flips a part by 180, so the gear ratio
//!   is not exactly one (ASSUMED); the two are equal where the fingers move across the radial line.

mod panel;

use geometry::frame::{Frame, Vector as Inches, rotation_from_x_y};
use interfaces::device::{GripSensors, MotorCommand, MotorOrder, PedestalSensors, TABLE_STEPS_PER_TENTH};
use rapier3d_f64::prelude::*;
use serde::{Deserialize, Serialize};

pub use self::panel::{TablePanel, TableRefusal};
use crate::{
    convert::to_pose,
    description::{Pedestal as Description, RotaryTable},
    gripper::Gripper,
    noise::Noise,
    scene::HAND,
    sensor::Analog,
};

const STEPS_PER_DEGREE: f64 = TABLE_STEPS_PER_TENTH as f64 * 10.0; // motor steps per degree
const ON_STEP: f64 = 1e-6; // distance within which the motor has reached its goal, steps

#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Table {
    description: RotaryTable,
    position: f64,
    goal: f64, // position at which it stops, steps
    speed: f64,
    offset: f64,
    echo: u32,
    panel: TablePanel,
}

impl Table {
    /// A table at the start position of its description, with the counter at 0.
    #[must_use]
    pub fn new(description: &RotaryTable) -> Self {
        let position = libm::round(description.start * STEPS_PER_DEGREE);
        Self {
            description: description.clone(),
            position,
            goal: position,
            speed: 0.0,
            offset: -position,
            echo: 0,
            panel: TablePanel::READY,
        }
    }

    /// Once per tick: accept an order with a new number.
    pub fn order(&mut self, command: &MotorCommand) {
        if !self.attend(command.number) || command.number == 0 || command.number == self.echo {
            return;
        }
        self.echo = command.number;
        let here = libm::round(self.position);
        let steps = f64::from(command.steps);
        match command.order {
            MotorOrder::None => {}
            MotorOrder::Turn => self.goal = here + steps,
            MotorOrder::SetCounter => self.offset = steps - here,
            MotorOrder::Stop => self.ramp_down(),
        }
    }

    fn ramp_down(&mut self) {
        self.goal = libm::round(self.position + self.stopping_way());
    }

    /// Stopping distance from the present speed, steps, signed.
    fn stopping_way(&self) -> f64 {
        self.speed * self.speed.abs() / (2.0 * self.ramp())
    }

    fn ramp(&self) -> f64 {
        self.description.acceleration * STEPS_PER_DEGREE
    }

    /// Turn for `dt` seconds: accelerate to speed, and decelerate in time to stop at the goal.
    pub fn advance(&mut self, dt: f64) {
        let left = self.goal - self.position;
        let change = self.ramp() * dt;
        // The greatest speed from which the motor can still stop at the goal after one more step at that speed.
        let slowing = libm::sqrt(change * change / 4.0 + 2.0 * self.ramp() * left.abs()) - change / 2.0;
        let greatest = slowing.min(self.description.speed * STEPS_PER_DEGREE);
        self.speed = (greatest.copysign(left)).clamp(self.speed - change, self.speed + change);
        if (left - self.speed * dt) * left <= 0.0 || left.abs() < ON_STEP {
            self.position = self.goal;
            self.speed = 0.0;
        } else {
            self.position += self.speed * dt;
        }
        let [minus, plus] = self.description.limits.map(|limit| libm::round(limit * STEPS_PER_DEGREE));
        let blocked =
            (self.position >= plus && self.goal > plus) || (self.position <= minus && self.goal < minus);
        if blocked {
            self.position = self.position.clamp(minus, plus);
            self.goal = self.position;
            self.speed = 0.0;
        }
    }

    fn at_plus(&self) -> bool {
        self.position >= self.description.limits[1] * STEPS_PER_DEGREE
    }

    fn at_minus(&self) -> bool {
        self.position <= self.description.limits[0] * STEPS_PER_DEGREE
    }

    #[must_use]
    pub fn moving(&self) -> bool {
        self.position != self.goal
    }

    #[must_use]
    pub fn motor_angle(&self) -> f64 {
        self.position / STEPS_PER_DEGREE
    }

    #[must_use]
    pub fn angle(&self) -> f64 {
        self.description.angle(self.motor_angle())
    }

    fn counter(&self) -> i32 {
        libm::round(self.position + self.offset) as i32
    }

    pub fn sensors(&self, hand: GripSensors, noise: &mut Noise) -> PedestalSensors {
        PedestalSensors {
            potentiometer: hand.potentiometer,
            strain_left: hand.strain_left,
            strain_right: hand.strain_right,
            table_potentiometer: self.potentiometer(noise),
            limit_plus: self.at_plus(),
            limit_minus: self.at_minus(),
            motor_echo: self.echo,
            motor_moving: self.moving(),
            motor_counter: self.counter(),
        }
    }

    fn potentiometer(&self, noise: &mut Noise) -> u16 {
        let table = &self.description;
        let (offset, scale) = (table.potentiometer_offset, table.potentiometer_scale);
        Analog { offset, scale, noise: table.noise }.counts(self.angle(), noise)
    }
}

impl RotaryTable {
    /// Table angle at a motor angle, both in degrees.
    #[must_use]
    pub fn angle(&self, motor: f64) -> f64 {
        let [turn, table] = self.flip;
        self.square + (motor - self.square) * table / turn
    }
}

#[derive(Clone, Debug, Deserialize, Serialize)]
pub struct Pedestal {
    /// The hand; its tool frame has X up, Y across the fingers.
    pub hand: Gripper,
    pub table: Table,
    description: Description,
}

impl Pedestal {
    pub fn new(world: &mut PhysicsWorld, description: &Description) -> Self {
        let table = Table::new(&description.table);
        let tool = to_pose(&hand_frame(description, table.angle()));
        let hand = Gripper::new(world, &description.hand, description.stiffness, &tool, HAND);
        hand.let_fingers_sleep(world);
        Self { hand, table, description: description.clone() }
    }

    /// The frame of the fingertips: X up, Y across the fingers; world, in.
    #[must_use]
    pub fn frame(&self) -> Frame {
        hand_frame(&self.description, self.table.angle())
    }

    /// The frame of the fingertips while the fingers move across the radial line.
    #[must_use]
    pub fn square_frame(&self) -> Frame {
        hand_frame(&self.description, self.description.table.square)
    }

    /// Turn the table for `dt` seconds, and the hand with it.
    pub fn turn(&mut self, world: &mut PhysicsWorld, dt: f64) {
        if !self.table.moving() {
            self.hand.stand(world);
            return;
        }
        self.table.advance(dt);
        self.hand.lead(world, &to_pose(&self.frame()));
    }

    pub fn sensors(&self, noise: &mut Noise) -> PedestalSensors {
        let grip = self.hand.sensors(noise, 0);
        self.table.sensors(grip, noise)
    }
}

/// The hand at a table angle in degrees: at `square` its Y is perpendicular to the radial line. World, in.
#[must_use]
pub fn hand_frame(description: &Description, angle: f64) -> Frame {
    let across = description.azimuth + 90.0 + angle - description.table.square;
    let (sine, cosine) = (libm::sin(across.to_radians()), libm::cos(across.to_radians()));
    let position = Inches::from(description.position);
    rotation_from_x_y(&Inches::z(), &Inches::new(cosine, sine, 0.0))
        .map_or_else(|| Frame { position, ..Frame::identity() }, |rotation| Frame { position, rotation })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::CellDescription;

    fn table() -> Table {
        let cell = CellDescription::from_toml(include_str!("../../../data/cell.toml")).unwrap();
        Table::new(&cell.pedestal.table)
    }

    fn order(table: &mut Table, order: MotorOrder, steps: i32) {
        let number = table.echo + 1;
        table.order(&MotorCommand { number, order, steps });
    }

    fn run(table: &mut Table) -> f64 {
        for step in 0..100_000 {
            if !table.moving() {
                return f64::from(step) * 0.0025;
            }
            table.advance(0.0025);
        }
        panic!("the table does not stop: {table:?}");
    }

    #[test]
    fn table_turn_takes_time_and_ends_on_its_step() {
        let mut table = table();
        let start = table.motor_angle();
        order(&mut table, MotorOrder::Turn, -4_321);
        assert_eq!(table.echo, 1);
        let seconds = run(&mut table);
        assert!((table.motor_angle() - start + 43.21).abs() < 1e-9, "{}", table.motor_angle());
        let least = 43.21 / table.description.speed;
        assert!(seconds > least && seconds < least + 2.0, "{seconds} s for 43.21 degrees");
        assert_eq!(table.counter(), -4_321, "the counter began at 0");
    }

    #[test]
    fn repeated_number_is_one_order() {
        let mut table = table();
        let command = MotorCommand { number: 7, order: MotorOrder::Turn, steps: 100 };
        table.order(&command);
        run(&mut table);
        table.order(&command);
        assert!(!table.moving() && table.counter() == 100);
        table.order(&MotorCommand { number: 0, ..command });
        assert_eq!(table.echo, 7, "0 is not an order");
    }

    #[test]
    fn limit_switches_stop_the_motor_but_permit_the_return() {
        let mut table = table();
        order(&mut table, MotorOrder::Turn, 1_000_000);
        run(&mut table);
        assert!(table.at_plus() && !table.at_minus());
        assert_eq!(table.motor_angle(), 0.0, "it stops on the step of the switch");
        order(&mut table, MotorOrder::SetCounter, 0);
        assert_eq!(table.counter(), 0);
        order(&mut table, MotorOrder::Turn, 500);
        run(&mut table);
        assert_eq!(table.counter(), 0, "not beyond the switch");
        order(&mut table, MotorOrder::Turn, -1_000_000);
        run(&mut table);
        assert!(table.at_minus() && !table.at_plus());
        order(&mut table, MotorOrder::Turn, 1_000);
        run(&mut table);
        assert!(!table.at_minus());
    }

    #[test]
    fn motor_angle_of_183_5_turns_the_table_by_180() {
        let mut table = table();
        let here = table.angle();
        order(&mut table, MotorOrder::Turn, -18_350);
        run(&mut table);
        assert!((here - table.angle() - 180.0).abs() < 1e-9);
        let left = libm::round((-213.5 - table.motor_angle()) * 100.0) as i32;
        order(&mut table, MotorOrder::Turn, left);
        run(&mut table);
        assert!((table.angle() + 213.5).abs() < 1e-9, "here the two agree: {}", table.angle());
    }

    #[test]
    fn stopped_table_ramps_down() {
        let mut table = table();
        order(&mut table, MotorOrder::Turn, -10_000);
        (0..400).for_each(|_| table.advance(0.0025));
        let (at, speed) = (table.motor_angle(), table.speed);
        order(&mut table, MotorOrder::Stop, 0);
        run(&mut table);
        let way = (at - table.motor_angle()).abs();
        let least = speed * speed / (2.0 * table.ramp()) / STEPS_PER_DEGREE;
        assert!(speed < 0.0 && (way - least).abs() < 0.1, "{way} degrees, {least} expected");
    }

    fn standing() -> (PhysicsWorld, Pedestal) {
        let cell = CellDescription::from_toml(include_str!("../../../data/cell.toml")).unwrap();
        let mut world = crate::cell::physics(&cell);
        let pedestal = Pedestal::new(&mut world, &cell.pedestal);
        (world, pedestal)
    }

    #[test]
    fn resting_fingers_sleep_until_air_or_table_moves_them() {
        let (mut world, mut pedestal) = standing();
        let dt = world.integration_parameters.dt;
        let asleep = |world: &PhysicsWorld, pedestal: &Pedestal| {
            pedestal.hand.finger_bodies().map(|body| world.bodies[body].is_sleeping())
        };
        let rest = |world: &mut PhysicsWorld, pedestal: &mut Pedestal| {
            for _ in 0..800 {
                pedestal.turn(world, dt);
                pedestal.hand.move_fingers(world);
                world.step();
            }
        };
        rest(&mut world, &mut pedestal);
        assert_eq!(asleep(&world, &pedestal), [true; 2]);
        pedestal.table.order(&MotorCommand { number: 1, order: MotorOrder::Turn, steps: 400 });
        pedestal.turn(&mut world, dt);
        world.step();
        assert_eq!(asleep(&world, &pedestal), [false; 2], "the table turns");
        rest(&mut world, &mut pedestal);
        assert_eq!(asleep(&world, &pedestal), [true; 2]);
        let before = crate::gripper::body_opening(&world, &pedestal.hand);
        pedestal.hand.air.spread(2.0);
        rest(&mut world, &mut pedestal);
        assert_eq!(asleep(&world, &pedestal), [true; 2]);
        let opened = crate::gripper::body_opening(&world, &pedestal.hand) - before;
        assert!((opened - (2.0 - 0.1)).abs() < 1e-6, "{opened}");
    }
}
