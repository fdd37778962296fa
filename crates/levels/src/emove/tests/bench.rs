//! A bench of E-move with doubles of its neighbours. The test acts as Subtask.

use std::sync::OnceLock;

use geometry::{frame::Frame, pose::Pose};
use interfaces::{
    CommonMemory, EmoveOutputs, Reason, StatusReport,
    emove::{EmoveCommand, EmoveVerb, Holding},
    location::Site,
    pose_range,
};
use rcs_core::name::Name16;
use taskdata::{
    files::{EndEffId, TaskData, VisionId},
    load::{Source, Store},
};

use super::{
    doubles::{Cell, DeliveryFault},
    together::Real,
};
use crate::{
    bench::{self, Tested},
    emove::Emove,
};

pub fn data() -> TaskData<'static> {
    static STORE: OnceLock<Store> = OnceLock::new();
    let store = STORE.get_or_init(|| {
        // More location points than one pause searches.
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

pub fn given(id: u8) -> Option<u8> {
    (id != 0).then_some(id)
}

pub fn frame_of(location: &str) -> Frame {
    let id = data().locpt_named(&Name16::clipped(location)).expect("a location point");
    data().locpt(id).expect("its record").frame
}

pub fn moved(frame: Frame, movetables: &[&str]) -> Frame {
    movetables.iter().fold(frame, |frame, name| {
        let id = data().movetable_named(&Name16::clipped(name)).expect("a movetable");
        data().moved(&frame, id)
    })
}

pub type Bench = bench::Bench<Emove, Cell, TaskData<'static>>;

/// A command of Subtask: verb, object, grip, location and gripper.
pub type EmoveLine = (EmoveVerb, &'static str, i32, &'static str, u8);

pub type End = (StatusReport, Reason);

impl<'d> Tested<TaskData<'d>> for Emove {
    type Order = EmoveLine;
    type End = End;
    const LONGEST: u64 = 1000;

    /// Location and records of the object are looked up as by Subtask.
    fn order(memory: &mut CommonMemory, (verb, object, grip, location, gripper): EmoveLine, number: u32) {
        let (object, place) = (Name16::clipped(object), Name16::clipped(location));
        let data = data();
        let mut command = EmoveCommand {
            number,
            command: verb,
            object: Some(object).filter(|object| !object.is_empty()),
            grip,
            object_parameters: data.object(&object, grip).map_or(EndEffId::NULL, |(id, _)| id),
            end_effector_id: given(gripper),
            ..EmoveCommand::default()
        };
        if let Some((id, locpt)) = data.locpt_named(&place).and_then(|id| Some((id, data.locpt(id)?))) {
            let pose = &mut memory.subtask.poses[0];
            pose.number = Some(pose_range::next(pose_range::SUBTASK, pose.number.unwrap_or_default()));
            pose.pose = Pose::from_frame(&locpt.frame);
            command.site = Site::point(locpt.name, id);
            command.pose = pose.number;
            command.object_vision =
                data.view(&object, &command.site.place()).map_or(VisionId::NULL, |(id, _)| id);
        }
        memory.subtask.emove = command;
    }

    fn end(outputs: &EmoveOutputs) -> Option<End> {
        let status = outputs.status;
        (status.report != StatusReport::Executing).then_some((status.report, status.reason))
    }
}

impl Bench {
    /// A robot at a location with a gripper; the other grippers are in their holsters.
    pub fn new(location: &str, gripper: u8) -> Self {
        Self::of(location, gripper, None)
    }

    pub fn real(location: &str, gripper: u8) -> Self {
        let mut bench = Self::of(location, gripper, Some(Real::new(gripper != 0)));
        assert_eq!(bench.pause(), DONE);
        bench
    }

    fn of(location: &str, gripper: u8, real: Option<Real>) -> Self {
        let mut bench = Self::with(Cell::new(frame_of(location), gripper, real), data());
        bench.wait(2);
        bench
    }

    /// After E-PAUSE: the link is up, and the robot's place is known.
    pub fn ready(location: &str, gripper: u8) -> Self {
        let mut bench = Self::new(location, gripper);
        assert_eq!(bench.pause(), DONE);
        // In a holster or at the tool drum, more than one place is possible.
        let plain = !location.starts_with("HOLSTER") && location != "TOOL-TRNS";
        assert_eq!(bench.at(), if plain { location } else { "" });
        bench.world.log.clear();
        bench
    }

    /// Send a command after E-move has read, through its neighbours, the changes of the test.
    pub fn command(
        &mut self,
        verb: EmoveVerb,
        object: &'static str,
        grip: i32,
        location: &'static str,
        gripper: u8,
    ) {
        self.begin((verb, object, grip, location, gripper));
    }

    pub fn begin(&mut self, line: EmoveLine) {
        self.wait(2);
        self.send(line);
    }

    pub fn run(
        &mut self,
        verb: EmoveVerb,
        object: &'static str,
        grip: i32,
        location: &'static str,
        gripper: u8,
    ) -> End {
        self.world.log.clear();
        self.command(verb, object, grip, location, gripper);
        self.finish()
    }

    pub fn perform(&mut self, (verb, object, grip, location, gripper): EmoveLine) -> End {
        self.run(verb, object, grip, location, gripper)
    }

    /// Perform a line. Returns the smallest distance of the robot from each frame, in.
    pub fn pass<const N: usize>(&mut self, line: EmoveLine, frames: [Frame; N]) -> [f64; N] {
        let mut nearest = [f64::INFINITY; N];
        self.world.log.clear();
        self.begin(line);
        loop {
            let end = Emove::end(&self.step());
            for (nearest, frame) in nearest.iter_mut().zip(&frames) {
                *nearest = nearest.min(self.world.frame.distance(frame).inches);
            }
            if let Some(end) = end {
                assert_eq!(end, DONE, "{:?}", self.world.log);
                return nearest;
            }
        }
    }

    pub fn pause(&mut self) -> End {
        self.run(EmoveVerb::Pause, "", 0, "", 0)
    }

    /// Sends PAUSE at once. Returns the number of motions commanded to Prim before.
    pub fn stop(&mut self) -> usize {
        assert_eq!(self.execute(PAUSE), DONE, "{:?}", self.world.log);
        let motions = self.motions().len();
        self.world.log.clear();
        motions
    }

    /// Keeps the output buffers of E-move.
    pub fn restart_and_finish(&mut self) {
        self.restart();
        assert_eq!(self.finish(), error(Reason::Restarted));
    }

    pub fn lead(&mut self, does: impl FnOnce(&mut Self)) {
        self.world.joystick = true;
        self.wait(5);
        does(self);
        self.wait(5);
        self.world.joystick = false;
        self.wait(8);
    }

    pub fn assert_stands(&mut self) {
        let there = self.world.frame;
        self.wait(8);
        assert!(self.off(&there) < 0.01, "the robot moves: {:?}", self.world.log);
    }

    /// A parts gripper with an object between its fingers that E-move cannot name.
    pub fn with_unknown(location: &str, size: i32) -> Self {
        let mut bench = Self::new(location, 1);
        (bench.world.grip.opening, bench.world.object) = (size, Some(size));
        bench.forget_empty();
        assert_eq!(bench.memory.emove.status.held, Holding::Something);
        bench
    }

    pub fn forget_empty(&mut self) {
        self.wait(3);
        self.restart();
        self.memory.emove.estimates.empty = false;
        assert_eq!(self.pause(), DONE);
    }

    pub fn motions(&self) -> Vec<String> {
        let motions = ["GO-THRU", "GOTO-PT", "GO-UNTIL", "DELTA-MOVE"];
        let is_motion = |text: &&String| motions.iter().any(|motion| text.starts_with(motion));
        self.world.log.iter().filter(is_motion).cloned().collect()
    }

    pub fn during(&self, line: EmoveLine) -> impl Iterator<Item = Self> {
        let mut bench = self.clone();
        bench.world.log.clear();
        bench.send(line);
        bench.at_every_tick()
    }

    /// Make commands fail whose text contains a word.
    pub fn spoil(&mut self, word: &'static str, mishap: DeliveryFault) -> &mut Self {
        self.world.mishaps.push((word, mishap));
        self
    }

    pub fn hold(&mut self, object: &'static str, size: i32, gripper: u8) {
        self.world.object = Some(size);
        assert_eq!(self.run(EmoveVerb::GraspObj, object, 1, "", gripper), DONE);
        assert_eq!(self.held(), object);
    }

    pub fn log(&self) -> Vec<&str> {
        self.world.log.iter().map(String::as_str).collect()
    }

    pub fn until_logged(&mut self, word: &str) {
        self.until(|bench| bench.world.log.iter().any(|text| text.contains(word)));
    }

    pub fn off(&self, frame: &Frame) -> f64 {
        self.world.frame.distance(frame).path()
    }

    /// The location of the robot; empty if it is at none.
    pub fn at(&self) -> String {
        self.memory.emove.status.at.unwrap_or_default().site.location.to_string()
    }

    pub fn held(&self) -> String {
        self.memory.emove.status.held.object().unwrap_or_default().to_string()
    }
}

/// Commands that move the robot, its fingers or a tool, except exchanges and RELEASE.
pub const ORDINARY: &[EmoveLine] = &[
    (EmoveVerb::MovToLoc, "", 0, "HOME", 1),
    (EmoveVerb::MovToObj, "BLOCK", 1, "BENCH", 1),
    (EmoveVerb::MovObjTo, "BLOCK", 1, "BENCH", 1),
    (EmoveVerb::MovToVu, "BLOCK", 1, "BENCH", 1),
    (EmoveVerb::MovToHol, "GRIPPER-1", 1, "HOLSTER-R", 1),
    (EmoveVerb::Withdraw, "", 0, "BENCH", 1),
    (EmoveVerb::LocateObj, "BLOCK", 1, "BENCH", 1),
    (EmoveVerb::GraspObj, "BLOCK", 1, "BENCH", 1),
    (EmoveVerb::InsertTool, "CUTTER", 1, "TOOL-TRNS", 1),
    (EmoveVerb::ReleaseTool, "CUTTER", 1, "TOOL-TRNS", 1),
    (EmoveVerb::AcquireTool, "CUTTER", 1, "TOOL-TRNS", 1),
    (EmoveVerb::RemoveTool, "CUTTER", 1, "TOOL-TRNS", 1),
];

fn at_holster(verb: EmoveVerb, grip: i32, gripper: u8) -> EmoveLine {
    let (object, holster) =
        [("GRIPPER-1", "HOLSTER-R"), ("GRIPPER-2", "HOLSTER-L"), ("GRIPPER-3", "HOLSTER-C")]
            [usize::from(gripper) - 1];
    (verb, object, grip, holster, gripper)
}

pub fn attach(gripper: u8) -> EmoveLine {
    at_holster(EmoveVerb::QcAttach, 2, gripper)
}

pub fn detach(gripper: u8) -> EmoveLine {
    at_holster(EmoveVerb::QcDetach, 1, gripper)
}

/// The robot brings a gripper to its holster (grip 1), or comes bare to fetch it (grip 2).
pub fn to_holster(grip: i32, gripper: u8) -> EmoveLine {
    at_holster(EmoveVerb::MovToHol, grip, gripper)
}

pub const PAUSE: EmoveLine = (EmoveVerb::Pause, "", 0, "", 0);

/// Interruptions of a command before it is sent again.
pub const INTERRUPTIONS: &[fn(&mut Bench)] = &[
    |bench| assert_eq!(bench.execute(PAUSE), DONE, "{:?}", bench.world.log),
    |bench| {
        bench.restart_and_finish();
        assert_eq!(bench.execute(PAUSE), DONE, "{:?}", bench.world.log);
    },
];

pub const DONE: End = (StatusReport::Done, Reason::None);

pub const fn error(reason: Reason) -> End {
    (StatusReport::Error, reason)
}
