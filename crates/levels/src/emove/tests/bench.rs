//! E-move with doubles of its neighbours, tick by tick. The test is Subtask.

use std::sync::OnceLock;

use geometry::{frame::Frame, pose::Pose};
use interfaces::{
    CommonMemory, ExternalInputs, Reason, StatusReport,
    emove::{EmoveCommand, EmoveVerb},
    location::Site,
    pose_range,
    prim::JoystickGrip,
    process::{Inputs, Process},
};
use rcs_core::{handshake::successor, name::Name16, tick::Tick};
use taskdata::{
    files::{EndEffId, TaskData, VisionId},
    load::{Source, Store},
};

use super::{
    doubles::{Grip, Jaws, Mishap, Prim, Ring, Vision, World},
    together::Real,
};
use crate::{coverage, emove::Emove};

/// The task data of the tests.
pub fn data() -> TaskData<'static> {
    static STORE: OnceLock<Store> = OnceLock::new();
    let store = STORE.get_or_init(|| {
        // More location points than are looked at while Prim pauses.
        let many: String = (0..720)
            .map(|n| {
                let block = if n % 15 == 0 {
                    format!("BLOCK# {} OFFSET 21000\n", 700 + n / 15)
                } else {
                    String::new()
                };
                format!("{block}  -pt-  POINT-{n}  VIA-1  ...\n")
            })
            .collect();
        let text = include_str!("cell.blk").to_owned() + &many;
        let source = Source { name: "cell.blk".to_owned(), text: text.into() };
        match Store::from_sources(vec![source]) {
            Ok((store, _)) => store,
            Err(report) => panic!("{report}"),
        }
    });
    store.view()
}

/// An end effector id as records have it; 0 is none.
pub fn given(id: u8) -> Option<u8> {
    (id != 0).then_some(id)
}

/// The frame of a location point.
pub fn frame_of(location: &str) -> Frame {
    let id = data().locpt_named(&Name16::clipped(location)).expect("a location point");
    data().locpt(id).expect("its record").frame
}

/// A frame with movetables applied, one after the other.
pub fn moved(frame: Frame, movetables: &[&str]) -> Frame {
    movetables.iter().fold(frame, |frame, name| {
        let id = data().movetable_named(&Name16::clipped(name)).expect("a movetable");
        data().moved(&frame, id)
    })
}

#[derive(Clone)]
pub struct Bench {
    pub process: Emove,
    pub memory: CommonMemory,
    pub external: ExternalInputs,
    pub tick: Tick,
    pub world: World,
    pub prim: Prim,
    pub ring: Ring,
    pub grip: Grip,
    pub v_grip: Jaws,
    pub tool_grip: Jaws,
    pub vision: Vision,
    /// The real processes, instead of the doubles of Quick Change and the grippers.
    pub real: Option<Real>,
    pub data: TaskData<'static>,
    /// Processes that have died.
    pub dead: Vec<&'static str>,
}

impl Bench {
    /// A cell whose robot stands at a location with a gripper; the other grippers are in their holsters.
    pub fn new(location: &str, gripper: u8) -> Self {
        Self::with(location, gripper, None)
    }

    /// The same with the real processes.
    pub fn with(location: &str, gripper: u8, real: Option<Real>) -> Self {
        let mut resident = [1, 2, 3];
        let mut holsters = [0b1111; 3];
        if gripper != 0 {
            let which = usize::from(gripper) - 1;
            (resident[which], holsters[which]) = (0, 0);
        }
        let mut bench = Self {
            process: Emove::default(),
            memory: CommonMemory::default(),
            external: ExternalInputs::default(),
            tick: Tick::BEFORE_START,
            world: World {
                frame: frame_of(location),
                mated: gripper,
                resident,
                holsters,
                locked: gripper != 0,
                object: None,
                joystick: false,
                button: JoystickGrip::None,
                mishaps: Vec::new(),
                log: Vec::new(),
                answers: Vec::new(),
                claims: Vec::new(),
            },
            prim: Prim::default(),
            ring: Ring::default(),
            grip: Grip::default(),
            v_grip: Jaws::new((50, 350)),
            tool_grip: Jaws::new((100, 400)),
            vision: Vision::default(),
            real,
            data: data(),
            dead: Vec::new(),
        };
        bench.step();
        bench.step();
        bench
    }

    /// The same after E-PAUSE: the link runs, and it is known where the robot is.
    pub fn ready(location: &str, gripper: u8) -> Self {
        let mut bench = Self::new(location, gripper);
        assert_eq!(bench.pause(), DONE);
        // A robot in a holster or at the tool drum may be there in more than one way.
        let plain = !location.starts_with("HOLSTER") && location != "TOOL-TRNS";
        let found = bench.memory.emove.status.at.unwrap_or_default().site.location;
        assert_eq!(found.as_str(), if plain { location } else { "" });
        bench.world.log.clear();
        bench
    }

    pub fn step(&mut self) {
        self.tick = self.tick.next();
        let before = self.memory;
        let after = &mut self.memory;
        let data = self.data;
        let alive = |name| !self.dead.contains(&name);
        if alive("Subtask") {
            after.subtask.header.stamp = self.tick;
        }
        if alive("E-move") {
            let inputs = Inputs { tick: self.tick, memory: &before, external: &self.external, data: &data };
            self.process.step(&inputs, &mut after.emove);
        }
        if alive("Prim") {
            after.prim = self.prim.step(self.tick, &before, &data, &mut self.world);
            if self.prim.by_steps {
                self.world.feel_holsters(["HOLSTER-R", "HOLSTER-L", "HOLSTER-C"].map(frame_of));
            }
        }
        if let Some(real) = &mut self.real {
            real.step(self.tick, &before, &mut self.external, &data, &mut self.world, after);
            self.vision.step(&before, &mut self.external, &mut self.world);
            self.note_row();
            return;
        }
        if alive("Quick Change") {
            after.quick_change = self.ring.step(self.tick, &before, &mut self.world);
        }
        if alive("gripper") {
            after.grip = self.grip.step(self.tick, &before, &mut self.world);
            let (asleep, to) = (before.emove.dormant, &before.emove);
            let world = &mut self.world;
            after.v_grip = self.v_grip.step(self.tick, asleep.v_grip, &to.v_grip, &before.v_grip, world);
            after.tool_grip =
                self.tool_grip.step(self.tick, asleep.tool_grip, &to.tool_grip, &before.tool_grip, world);
        }
        if alive("vision") {
            self.vision.step(&before, &mut self.external, &mut self.world);
        }
        self.note_row();
    }

    fn note_row(&self) {
        coverage::note(<Emove as Process<TaskData<'_>>>::NAME, &self.memory.emove.header);
    }

    pub fn steps(&mut self, ticks: u32) {
        (0..ticks).for_each(|_| self.step());
    }

    /// Write a command; its location and the records of the object are looked up as Subtask would.
    pub fn command(&mut self, verb: EmoveVerb, object: &str, grip: i32, location: &str, gripper: u8) {
        // What the test has changed is seen by the neighbours, and then by E-move.
        self.steps(2);
        self.write(verb, object, grip, location, gripper);
    }

    /// Write a command, at once.
    pub fn write(&mut self, verb: EmoveVerb, object: &str, grip: i32, location: &str, gripper: u8) {
        let object = Name16::clipped(object);
        let place = Name16::clipped(location);
        let data = data();
        let found = data.locpt_named(&place).and_then(|id| Some((id, data.locpt(id)?)));
        let pose = &mut self.memory.subtask.poses[0];
        let mut command = EmoveCommand {
            number: successor(self.memory.subtask.emove.number),
            command: verb,
            object: Some(object).filter(|object| !object.is_empty()),
            grip,
            object_parameters: data.object(&object, grip).map_or(EndEffId::NULL, |(id, _)| id),
            end_effector_id: given(gripper),
            ..EmoveCommand::default()
        };
        if let Some((id, locpt)) = found {
            pose.number = Some(pose_range::next(pose_range::SUBTASK, pose.number.unwrap_or_default()));
            pose.pose = Pose::from_frame(&locpt.frame);
            command.site = Site::point(locpt.name, id);
            command.pose = pose.number;
            command.object_vision =
                data.view(&object, &command.site.place()).map_or(VisionId::NULL, |(id, _)| id);
        }
        self.memory.subtask.emove = command;
    }

    /// Run until the command has ended.
    pub fn finish(&mut self) -> (StatusReport, Reason) {
        for _ in 0..1000 {
            self.step();
            let status = self.memory.emove.status;
            if status.echo == self.memory.subtask.emove.number && status.report != StatusReport::Executing {
                return (status.report, status.reason);
            }
        }
        panic!("never over: {:#?} {:?}", self.process.state().execution, self.world.log);
    }

    /// Command and run until it has ended.
    pub fn run(
        &mut self,
        verb: EmoveVerb,
        object: &str,
        grip: i32,
        location: &str,
        gripper: u8,
    ) -> (StatusReport, Reason) {
        self.world.log.clear();
        self.command(verb, object, grip, location, gripper);
        self.finish()
    }

    pub fn pause(&mut self) -> (StatusReport, Reason) {
        self.run(EmoveVerb::Pause, "", 0, "", 0)
    }

    /// The motions that Prim was told of.
    pub fn motions(&self) -> Vec<String> {
        let motions = ["GO-THRU", "GOTO-PT", "GO-UNTIL", "DELTA-MOVE"];
        let is_motion = |text: &&String| motions.iter().any(|motion| text.starts_with(motion));
        self.world.log.iter().filter(is_motion).cloned().collect()
    }

    /// Give a command and try something in a copy of the cell at every tick of it.
    pub fn at_every_tick(
        &mut self,
        (verb, object, grip, location, gripper): (EmoveVerb, &str, i32, &str, u8),
        mut attempt: impl FnMut(&mut Self),
    ) {
        self.world.log.clear();
        self.write(verb, object, grip, location, gripper);
        for _ in 0..1000 {
            self.step();
            attempt(&mut self.clone());
            let status = self.memory.emove.status;
            if status.echo == self.memory.subtask.emove.number && status.report != StatusReport::Executing {
                return;
            }
        }
        panic!("never over: {:#?} {:?}", self.process.state().execution, self.world.log);
    }

    /// Let something go wrong in the command whose text contains a word.
    pub fn spoil(&mut self, word: &'static str, mishap: Mishap) -> &mut Self {
        self.world.mishaps.push((word, mishap));
        self
    }

    /// The gripper finds an object of a size and holds it.
    pub fn hold(&mut self, object: &str, size: i32, gripper: u8) {
        self.world.object = Some(size);
        assert_eq!(self.run(EmoveVerb::GraspObj, object, 1, "", gripper), DONE);
        assert_eq!(self.memory.emove.status.held.object().unwrap_or_default().as_str(), object);
    }

    pub fn log(&self) -> Vec<&str> {
        self.world.log.iter().map(String::as_str).collect()
    }

    /// How far the robot is from a frame.
    pub fn off(&self, frame: &Frame) -> f64 {
        self.world.frame.distance(frame).path()
    }
}

pub const DONE: (StatusReport, Reason) = (StatusReport::Done, Reason::None);

pub const fn error(reason: Reason) -> (StatusReport, Reason) {
    (StatusReport::Error, reason)
}
