//! `--station NAME`: the whole simulated cell behind the protocols of a real one.
//!
//! ```text
//!   rcs-run ──Modbus TCP──► a server per device of the mapping ──┐ every 20 ms: outputs to the cell, half
//!           ──EGM (UDP)───► robot, in its own thread ────────────┤ a tick of the cell, sensors to registers
//!           ──vision──────► camera, in its own thread ───────────┘
//! ```
//!
//! The cell advances when its outputs have been read, and its sensors are in the registers at once. A controller writes
//! 1 ms and reads 32 ms after its slots begin, so a step of the cell is always in between, and the station adds no
//! tick of delay. Lines of standard input are actions of a person at the cell: lines of a job without `**`.

mod camera;
mod pace;
mod robot;

use std::{
    collections::VecDeque,
    io,
    path::Path,
    sync::{
        atomic::{AtomicBool, Ordering},
        mpsc::Receiver,
    },
};

use closed_loop::{devices, workstation::orders};
use couplers::{Emulated, InWords, OutWords, Plan};
use depc::Plate;
use diagnostics::FIELDS;
use executive::{
    field::{Clients, Station as Server},
    realtime::{self, CELL_PRIORITY, FIELD_PRIORITY},
};
use field::{Device, Mapping, Presence};
use geometry::kinematics::T3;
use interfaces::{DeviceOutputs, point::Group};
use os_io::{stdout_line, text::amount};
use plant::{Cell, CellDescription, CellEvent, Half, WorkstationAction, description::CELL, devices::Devices};
use rcs_core::Plain as _;
use taskdata::load::{Store, job};

use self::{
    camera::Camera,
    pace::{Pace, STEPS_PER_TICK},
    robot::Robot,
};
use crate::{cli::Cli, emulate::typed};

const HELP: &str = "tray UNIT SECTOR OBJECT [X Y ANGLE]   put a part into a tray; also vise and drum lines\n\
                    estop      press the emergency stop: safety circuit open, robot stopped\n\
                    release    release it; motors and start let the robot run again\n\
                    motors, start, stop                   the EGM robot's buttons\n\
                    cut DEVICE, join DEVICE               cut the cable to a coupler, or join it\n\
                    restart DEVICE                        switch a coupler off and on\n\
                    status     connections, outputs, devices, parts and punctuality\n\
                    quit       end the program";

struct Coupler {
    name: String,
    plan: Plan,
    server: Server,
    clients: Clients,
    fallbacks: u32,
}

pub struct Station {
    mapping: Mapping,
    couplers: Vec<Coupler>,
    cell: Cell,
    devices: Devices,
    store: Store,
    robot: Option<Robot>,
    camera: Option<Camera>,
    plate: Plate,
    outputs: Vec<i64>,
    sensors: Vec<i64>,
    delayed: VecDeque<Vec<InWords>>, // images that have not reached the couplers yet, oldest first
    delay: usize,                    // their number
    half: Half,
    pace: Pace,
}

impl Station {
    pub fn new(cli: &Cli, mapping: &Path) -> Result<Self, String> {
        let path = FIELDS.find(mapping, &cli.data).map_err(|error| error.to_string())?;
        let mapping = runtime::field::read(&path).map_err(|error| refused_mapping(&error))?;
        let description = CellDescription::load(&cli.data.join(CELL)).map_err(|error| error.to_string())?;
        let cell = Cell::new(&description, cli.seed).map_err(|error| error.to_string())?;
        let devices = devices::simulated(&mapping, &description)
            .map_err(|error| format!("{}: {error}", path.display()))?;
        let (store, _) = Store::load_with_faults(&cli.data);
        let couplers = mapping.devices.iter().map(Coupler::open).collect::<Result<Vec<_>, _>>()?;
        let robot = cli.egm_robot.as_ref().map(|options| Robot::start(options, &cli.data)).transpose()?;
        let camera = cli.vision.clone().map(Camera::start).transpose()?;
        let mut station = Self {
            mapping,
            couplers,
            cell,
            devices,
            store,
            robot,
            camera,
            plate: Plate::default(),
            outputs: Vec::new(),
            sensors: Vec::new(),
            delayed: VecDeque::new(),
            delay: usize::from(cli.delay) * usize::from(STEPS_PER_TICK),
            half: Half::First,
            pace: Pace::new(),
        };
        station.outputs = vec![0; station.mapping.outputs.len()];
        station.show(&station.cell.inputs());
        Ok(station)
    }

    /// Runs until `quit` or a signal. Fails with a sentence if the robot's socket fails.
    pub fn run(&mut self, stop: &AtomicBool) -> Result<(), String> {
        let listed: Vec<String> = self
            .couplers
            .iter()
            .map(|coupler| format!("{} {}", coupler.name, coupler.server.address()))
            .collect();
        stdout_line!("[station] ready: {}; help lists the commands", listed.join(", "));
        let without: Vec<&str> = self.mapping.groups(Presence::Simulated).map(Group::name).collect();
        if !without.is_empty() {
            stdout_line!("[station] not in the mapping: {}", without.join(", "));
        }
        let lines = typed();
        if let Err(why) = realtime::raise_priority(CELL_PRIORITY) {
            stdout_line!(
                "[station] ordinary priority ({why}): on a busy machine it is late, and the robot leaves its path"
            );
        }
        self.pace = Pace::new();
        while !stop.load(Ordering::Relaxed) {
            if self.obey_all(&lines) {
                break;
            }
            for _ in 0..self.pace.wait() {
                self.step();
            }
            self.pace.end_step();
            self.tell();
            if let Some(error) = self.robot.as_mut().and_then(Robot::failure) {
                return Err(format!("the socket of the robot has failed: {error}"));
            }
        }
        stdout_line!("[station] {}", self.pace);
        Ok(())
    }

    /// Executes the lines that were typed. Returns true for `quit`.
    fn obey_all(&mut self, lines: &Receiver<String>) -> bool {
        while let Ok(line) = lines.try_recv() {
            match self.run_line(line.trim()) {
                Ok(true) => return true,
                Ok(false) => {}
                Err(reason) => stdout_line!("error: {reason}"),
            }
        }
        false
    }

    fn run_line(&mut self, line: &str) -> Result<bool, String> {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            [] => {}
            ["quit"] => return Ok(true),
            ["help"] => stdout_line!("{HELP}"),
            ["status"] => self.report(),
            ["estop"] => {
                self.devices.press_estop(true);
                self.robot_button("estop");
            }
            ["release"] => self.devices.press_estop(false),
            ["motors" | "start" | "stop"] if self.robot.is_some() => self.robot_button(line),
            ["motors" | "start" | "stop"] => return Err("the station has no robot: --egm-robot".to_owned()),
            ["cut", device] => self.coupler(device)?.server.cut(true),
            ["join", device] => self.coupler(device)?.server.cut(false),
            ["restart", device] => self.coupler(device)?.server.restart(),
            _ => {
                let action = job::own_line(line, &self.store).map_err(|error| error.to_string())?;
                let actions: Vec<WorkstationAction> =
                    orders(&action, self.cell.description()).map_err(|error| error.to_string())?;
                for action in actions {
                    self.cell.workstation(&action).map_err(|error| error.to_string())?;
                }
            }
        }
        Ok(false)
    }

    fn robot_button(&self, button: &str) {
        if let Some(robot) = &self.robot {
            robot.press(button);
        }
    }

    fn coupler(&self, name: &str) -> Result<&Coupler, String> {
        let known =
            || self.couplers.iter().map(|coupler| coupler.name.as_str()).collect::<Vec<_>>().join(", ");
        let found = self.couplers.iter().find(|coupler| coupler.name == name);
        found.ok_or_else(|| format!("one of the couplers {} was expected, found {name}", known()))
    }

    /// Advances the cell by half a tick.
    fn step(&mut self) {
        let images: Vec<OutWords> = self.couplers.iter_mut().map(Coupler::outputs).collect();
        let mut outputs = DeviceOutputs::default();
        self.mapping.spread(&images, &mut outputs);
        self.mapping.spread_station(&images, &mut self.outputs);
        if self.half == Half::First {
            // The times of the devices are whole ticks.
            self.devices.follow(&mut self.cell, &self.outputs);
        }
        if let Some(camera) = &self.camera {
            outputs.vision = camera.request();
        }
        let moved = self
            .robot
            .as_ref()
            .and_then(|robot| Plate::from_frame(&T3.forward_plate(&robot.joints()), &self.plate).ok());
        self.plate = moved.unwrap_or(self.plate);
        let inputs = self.cell.step_half_following(self.half, moved.as_ref(), &outputs);
        if let Some(camera) = &self.camera {
            camera.answer(&inputs.vision);
        }
        self.show(&inputs);
        self.half = self.half.next();
    }

    fn show(&mut self, inputs: &interfaces::DeviceInputs) {
        let mut images = vec![InWords::ZERO; self.couplers.len()];
        self.devices.sense(&self.cell, &mut self.sensors);
        self.mapping.sample(inputs, &mut images);
        self.mapping.sample_station(&self.sensors, &mut images);
        self.delayed.push_back(images);
        let arrived = self.delayed.len().checked_sub(self.delay + 1).and_then(|_| self.delayed.pop_front());
        for (coupler, image) in self.couplers.iter().zip(arrived.into_iter().flatten()) {
            coupler.server.with(|emulated| emulated.show(&coupler.plan, &image));
        }
    }

    fn tell(&mut self) {
        for coupler in &mut self.couplers {
            coupler.tell();
        }
        for event in self.cell.events() {
            // The station does not report contacts that a command can permit.
            let is_lamp = matches!(event, CellEvent::Lamps(_) | CellEvent::Warning(_));
            if !is_lamp {
                stdout_line!("[cell] {event}");
            }
        }
        for message in self.devices.messages() {
            stdout_line!("[cell] {message}");
        }
    }

    fn report(&self) {
        for coupler in &self.couplers {
            let Clients { connections, refused, garbled, requests } = coupler.server.clients();
            let (writes, fallbacks) =
                coupler.server.with(|emulated| (emulated.writes(), emulated.fallbacks()));
            stdout_line!(
                "[status] {} at {}: {} now, {refused} refused, {garbled} garbled; {}, {}, watchdog fired {}",
                coupler.name,
                coupler.server.address(),
                amount(connections, "connection"),
                amount(requests, "request"),
                amount(writes, "write"),
                amount(fallbacks, "time")
            );
        }
        let on = self.mapping.outputs.iter().filter(|point| {
            let coupler = self.couplers.get(point.device());
            coupler.is_some_and(|coupler| {
                let image = coupler.server.with(|emulated| emulated.image(&coupler.plan));
                point.get(&image) != point.safe
            })
        });
        let on: Vec<&str> = on.map(|point| point.name.as_str()).collect();
        stdout_line!(
            "[status] outputs on: {}",
            if on.is_empty() { "none".to_owned() } else { on.join(", ") }
        );
        for part in self.cell.parts() {
            stdout_line!("[status] {} in {} {}", part.name, part.location, part.sector);
        }
        stdout_line!("[status] {}", self.pace);
    }
}

impl Coupler {
    fn open(device: &Device) -> Result<Self, String> {
        let Device { name, address, plan, .. } = device;
        let prepare = || {
            // The station reports missing settings for its own thread. These threads get at most the same ones.
            let _ = realtime::raise_priority(FIELD_PRIORITY);
        };
        let server = Server::open_with(*address, Emulated::of(plan), prepare).map_err(|error| {
            let hint = match error.kind() {
                io::ErrorKind::AddrNotAvailable => {
                    format!(": `ip address add {}/32 dev lo` makes it one of this machine", address.ip())
                }
                io::ErrorKind::AddrInUse => ": is another station running?".to_owned(),
                io::ErrorKind::PermissionDenied => ": ports below 1024 need a privilege".to_owned(),
                _ => String::new(),
            };
            format!("{name}: {error}{hint}")
        })?;
        Ok(Self { name: name.clone(), plan: plan.clone(), server, clients: Clients::default(), fallbacks: 0 })
    }

    fn outputs(&mut self) -> OutWords {
        let plan = &self.plan;
        self.server.with(|emulated| emulated.image(plan))
    }

    fn tell(&mut self) {
        let (name, clients) = (&self.name, self.server.clients());
        if clients.connections != self.clients.connections {
            stdout_line!("[station] {name}: {}", amount(clients.connections, "connection"));
        }
        if clients.refused != self.clients.refused {
            stdout_line!("[station] {name}: a further connection is refused");
        }
        if clients.garbled != self.clients.garbled {
            stdout_line!("[station] {name}: bytes that are not a request; the connection is closed");
        }
        let fallbacks = self.server.with(|emulated| emulated.fallbacks());
        if fallbacks != self.fallbacks {
            stdout_line!("[station] {name}: its watchdog has fired, its outputs are those of its fallback");
        }
        (self.clients, self.fallbacks) = (clients, fallbacks);
    }
}

/// An error of a mapping, with all its findings.
fn refused_mapping(error: &runtime::StartError) -> String {
    if let runtime::StartError::Data { report, .. } = error {
        os_io::console::stderr_drawn(report.render_for_stderr().trim_end());
    }
    error.to_string()
}
