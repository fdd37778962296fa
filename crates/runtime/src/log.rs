//! Writes the log of a run: set-up, one frame of the cell per tick, events, and the tick itself.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::Path,
};

use ::egm::Pose;
use depc::fault::{Counts, FaultKind};
use executive::alloc::Section;
use interfaces::{
    CommonMemory, ExternalInputs,
    device::{Picture, VisionRequest, VisionResponse, VisionStatus},
};
use levels::ladder::LadderState;
use os_io::shell;
use plant::{Cell, camera::Subject, clearance::Contact, convert::metres, description::Camera, part_link};
use rcs_core::{digest::Digest, tick::Tick};
use record::{
    Attachment, CellFrame, CellModel, End, Epoch, Link, LogFile, Model, Name, OperatorLine, Pace,
    RecordError, Recorder, Shown, Summary, Timing, Touch, Transform, explanation, views::View,
};
use taskdata::load::{
    Source, Store,
    job::{Drum, Job, Step, Workstation},
};

use crate::{
    config::{ClockKind, RobotKind, RunConfig},
    egm::FRAMES,
    event::Event,
    live::{Beginning, Live, Words},
    operator::first_words,
    result::FailureResult,
    setup::{EXTENSION, Setup},
};

pub const FAULTS: &str = "faults.toml"; // name of the fault plan among the attachments
/// Directory, among the attachments, of the files that the job can load during the run.
pub const LOADS: &str = "loads/";

pub const DATA: &str = "data"; // key of the metadata: origin of the task data, and the number of files
pub const RETRY: &str = "retry"; // key: number of times that a command is repeated after an error
pub const OUTSIDE: &str = "outside";
pub const DATA_BASE: &str = "data_base_in"; // key: file of the Data System's items
pub const IN_MEMORY: &str = "memory"; // its value if the items are only in memory
pub const STAND_BY: &str = "stand_by"; // key: the job waited for an operator before its first line
/// Metadata key: the run also executes commands that use records with errors.
pub const UNCHECKED: &str = "unchecked";
pub const FIELD: &str = "field"; // key: the couplers of the run, as `--field` names them
pub const MAPPING: &str = "field.toml"; // attachment: the mapping of emulated couplers
pub const TICKS: &str = "ticks";

/// A log that is being written, and the data for drawing the cell.
pub struct Log {
    recorder: Recorder,
    links: Vec<String>, // names of the moving links, in the order of the log
    faults: Counts,     // number of faults on the line so far, and their kinds in the last tick
    kinds: Vec<&'static str>,
    vision: Vision,
    /// The data that the live view sends to a browser; `None` without a live view, and after they were taken.
    beginning: Option<Beginning>,
    touches: Vec<Touch>, // the contacts of the last tick
}

struct Vision {
    camera: Camera,
    request: VisionRequest,
    answer: VisionResponse,
    taken: u32, // number of the request for which a picture was taken
    seen: Option<Vec<Subject>>,
}

impl Vision {
    fn new(camera: &Camera) -> Self {
        let (request, answer) = (VisionRequest::default(), VisionResponse::default());
        Self { camera: camera.clone(), request, answer, taken: 0, seen: None }
    }

    /// Take a picture for a new request. Returns the drawing of the last picture when its request has been answered, or
    /// when the next request replaces it: an answer often leads to the next request in the same tick.
    fn look(&mut self, cell: &Cell) -> Option<Vec<u8>> {
        let VisionRequest { number, picture, .. } = self.request;
        let is_new = number != self.taken && picture != Picture::None;
        let is_answered = self.answer.echo == self.taken && self.answer.status != VisionStatus::Busy;
        let seen = self.seen.take_if(|_| is_answered || is_new);
        if is_new {
            self.taken = number;
            self.seen = Some(cell.picture());
        }
        let busy = VisionResponse { status: VisionStatus::Busy, ..VisionResponse::default() };
        let answer = if is_answered { &self.answer } else { &busy };
        Some(plant::look::camera::draw(&self.camera, &seen?, answer))
    }
}

impl Log {
    /// Begin a log. Fails if the file cannot be written.
    pub fn start(file: LogFile, config: &RunConfig, setup: &Setup) -> Result<Self, RecordError> {
        let tap = setup.live.as_ref().map(Live::tap);
        let coming: Vec<&str> = setup.job.steps.iter().filter_map(|line| delivered(&line.step)).collect();
        let later = (1..).take(coming.len()).map(|id| ("world", part_link(id)));
        let here = setup.cell.links().into_iter().map(|link| (link.parent, link.name));
        let is_egm = matches!(config.robot.kind, RobotKind::Egm(_));
        let outside = FRAMES.into_iter().filter(|_| is_egm).map(|name| ("world", name.to_owned()));
        let links = here.chain(later).chain(outside);
        let links = links.map(|(parent, name)| Link { name, parent: parent.to_owned() });
        let fixed = setup.cell.fixed_links().into_iter().map(|link| {
            let place = transform(&link);
            (Link { name: link.name, parent: link.parent.to_owned() }, place)
        });
        let joints = setup.cell.joint_states().into_iter().map(|(name, _)| name.to_owned());
        let scene = setup.cell.scene(&coming);
        let model = CellModel {
            urdf: scene.urdf(),
            models: scene.models().into_iter().map(model).collect(),
            names: scene.labels().into_iter().map(name).collect(),
            links: links.collect(),
            fixed: fixed.collect(),
            joints: joints.collect(),
        };
        let links = model.links.iter().map(|link| link.name.clone()).collect();
        let mut attachments = attachments(setup);
        let (pace, epoch) = match config.clock {
            ClockKind::Fast => (Pace::Wait, Epoch::Fixed),
            ClockKind::Real => (Pace::Drop, Epoch::now()),
        };
        let run = metadata(config, setup, &attachments);
        let beginning = tap.is_some().then(|| Beginning {
            attachments: attachments.clone(),
            epoch,
            words: words(&setup.store),
        });
        // The configuration does not depend on these attachments.
        attachments.extend(explanation::attachments());
        let start = record::Setup { epoch, run, attachments, cell: Some(model) };
        let recorder = Recorder::start_in(file, pace, start, tap, config.log_limit)?;
        Ok(Self {
            recorder,
            links,
            faults: Counts::default(),
            kinds: Vec::new(),
            vision: Vision::new(&setup.description.camera),
            beginning,
            touches: Vec::new(),
        })
    }

    /// The data that the live view sends to a browser; `None` without a live view, and after the first call.
    pub const fn take_beginning(&mut self) -> Option<Beginning> {
        self.beginning.take()
    }

    /// Logs the cell that the controller reads, with the [`FRAMES`] of EGM. Call it before [`Log::tick`].
    pub fn cell(&mut self, tick: Tick, cell: &Cell, frames: Option<[Pose; 2]>) {
        let mut places = vec![Transform::IDENTITY; self.links.len()];
        let mut put = |name: &str, place: Transform| {
            if let Some(at) = self.links.iter().position(|known| known == name) {
                places[at] = place;
            }
        };
        cell.links().iter().for_each(|link| put(&link.name, transform(link)));
        for (name, pose) in FRAMES.into_iter().zip(frames.into_iter().flatten()) {
            let [w, x, y, z] = pose.orientation;
            let position = pose.position.map(|mm| mm / 1000.0);
            put(name, Transform { position, rotation: [x, y, z, w] });
        }
        let joints = cell.joint_states().into_iter().map(|(_, value)| value);
        self.recorder.cell(&CellFrame::of(tick, places, joints).with_digest(cell.digest()));
        if let Some(png) = self.vision.look(cell) {
            self.recorder.show(tick, Shown::Picture(png));
        }
    }

    /// Log the contacts in `tick`, with the prohibited ones marked. Call it before [`Log::tick`].
    pub fn contacts(&mut self, tick: Tick, contacts: &[Contact], collides: impl Fn(&Contact) -> bool) {
        let touching = contacts.iter().filter(|contact| contact.touches());
        let touches: Vec<_> = touching.map(|contact| touch(contact, collides(contact))).collect();
        if touches != self.touches {
            self.recorder.show(tick, Shown::Touches(touches.clone()));
            self.touches = touches;
        }
    }

    /// Log a state of the run that is valid from `tick` on. Call it before [`Log::tick`] of that tick.
    pub fn view(&mut self, tick: Tick, view: View) {
        self.recorder.show(tick, Shown::View(view));
    }

    /// Log an event. Call it before [`Log::tick`] of the same tick.
    pub fn event(&mut self, tick: Tick, event: &Event) {
        self.recorder.note(tick, event.level(), event.source(), event.code(), &event.to_string());
    }

    /// Log an operator's request. Call it before [`Log::tick`] of the first tick with its effect.
    pub fn operator(&mut self, line: OperatorLine) {
        self.recorder.operator(line);
    }

    /// Log the faults of the line when their kinds change. Call it before [`Log::tick`] of the same tick.
    pub fn faults(&mut self, tick: Tick, counts: Counts) {
        let fresh = FaultKind::ALL.iter().filter(|kind| counts.of(**kind) > self.faults.of(**kind));
        let kinds: Vec<&'static str> = fresh.map(|kind| kind.text()).collect();
        if !kinds.is_empty() && kinds != self.kinds {
            self.event(tick, &Event::LineFaults(kinds.clone()));
        }
        (self.faults, self.kinds) = (counts, kinds);
    }

    /// Logs a new generation of task data from `tick` on, with its blocks. Call it before [`Log::tick`] of that tick.
    pub fn reload(&mut self, tick: Tick, generation: u32, source: &Source) {
        for file in Attachment::reload(generation, std::slice::from_ref(source)) {
            self.recorder.attach(tick, file);
        }
        self.event(tick, &Event::Loaded { generation, name: source.name.clone() });
    }

    /// Logs a job that replaces the rest of the previous one from `tick` on. Call it before [`Log::tick`].
    pub fn played(&mut self, tick: Tick, number: u32, job: &Job) {
        let source = Source { name: format!("{}.{EXTENSION}", job.name), text: job.source().text.clone() };
        self.recorder.attach(tick, Attachment::played(number, &source));
    }

    /// Attach the first failure and its consequences, at the end of a run.
    pub fn failure(&mut self, tick: Tick, failure: &FailureResult) {
        // JSON can represent all its text and numbers.
        let data = serde_json::to_vec(failure).unwrap_or_default();
        let (name, media_type) = (explanation::FAILURE.to_owned(), "application/json".to_owned());
        self.recorder.attach(tick, Attachment { name, media_type, data });
    }

    /// Call it before [`Log::tick`] of the same tick. Omit it in fast clock, where equal runs must have equal logs.
    pub const fn timing(&mut self, controller_ns: u64, skipped: u64) {
        self.recorder.timing(Timing { controller_ns, skipped });
    }

    /// Log a tick. This is part of the tick itself: its allocations are counted.
    pub fn tick(
        &mut self,
        tick: Tick,
        external: &ExternalInputs,
        memory: &CommonMemory,
        state: impl FnOnce() -> LadderState,
    ) {
        (self.vision.request, self.vision.answer) = (memory.emove.vision, external.devices.vision);
        let _section = Section::enter();
        self.recorder.tick(tick, external, memory, state);
    }

    /// End the log. Errors: the [`RecordError`] that ended the log before the end of the run.
    pub fn finish(
        self,
        digest: Digest,
        result: String,
        facts: BTreeMap<String, String>,
    ) -> Result<Summary, RecordError> {
        self.recorder.finish(End { digest: Some(digest.value()), result, facts })
    }
}

fn transform(link: &plant::LinkPose) -> Transform {
    Transform { position: link.position, rotation: link.rotation }
}

/// Rounded to 0.01 in, depth to 0.001 in, so that small vibrations cause no new message.
fn touch(contact: &Contact, collides: bool) -> Touch {
    let Contact { mover, obstacle, depth, at, .. } = contact;
    let rounded = |inches: f64, steps: f64| (inches * steps).round() / steps;
    let (mover, obstacle) = (mover.clone(), obstacle.clone());
    Touch {
        mover,
        obstacle,
        point: at.map(|inches| rounded(inches, 100.0)),
        depth: rounded(*depth, 1000.0),
        collides,
    }
}

fn model(model: plant::look::Model) -> Model {
    Model { glb: model.glb(), name: model.name, frame: model.frame }
}

fn name(label: plant::look::Label) -> Name {
    Name { text: label.text, frame: label.frame.to_owned(), position: label.position.map(metres) }
}

/// The part that a step puts into the cell.
fn delivered(step: &Step) -> Option<&str> {
    match step {
        Step::Workstation(Workstation::Tray { object, .. } | Workstation::Drum(Drum::Tool(object))) => {
            Some(object.as_str())
        }
        _ => None,
    }
}

fn words(store: &Store) -> Words {
    let data = store.view();
    let objects = data.objects.iter().map(|object| object.name.to_string());
    let owners = data.owners.iter().map(|owner| owner.name.to_string());
    let points = data.locpts.iter().map(|point| point.name.to_string());
    let names: BTreeSet<String> = objects.chain(owners).chain(points).collect();
    Words { first: first_words(), names: names.into_iter().collect() }
}

/// All files that a replay or a repetition of the run needs: task data, job, cell description, fault plan.
fn attachments(setup: &Setup) -> Vec<Attachment> {
    let sources = setup.store.sources().iter();
    let data = sources
        .map(|source| Attachment::text(&format!("{}{}", Attachment::TASK_DATA, source.name), &source.text));
    let mut all: Vec<Attachment> = data.collect();
    all.push(Attachment::text(Attachment::JOB, &setup.job.source().text));
    all.push(Attachment::text(Attachment::CELL, &setup.description_text));
    let loads = setup.job.reloads.iter().map(|reload| &reload.source);
    all.extend(loads.map(|source| Attachment::text(&format!("{LOADS}{}", source.name), &source.text)));
    if !setup.mapping_text.is_empty() {
        all.push(Attachment::text(MAPPING, &setup.mapping_text));
    }
    if !setup.faults_text.is_empty() {
        all.push(Attachment::text(FAULTS, &setup.faults_text));
    }
    all
}

/// Metadata of the run. Two equal runs have equal metadata.
fn metadata(config: &RunConfig, setup: &Setup, attachments: &[Attachment]) -> BTreeMap<String, String> {
    let mut configuration = Digest::new();
    for attachment in attachments {
        configuration.add(attachment.name.as_bytes());
        configuration.add(&attachment.data);
    }
    let faults = config.faults.as_deref().and_then(Path::file_name);
    let faults = faults.map(|name| name.to_string_lossy().into_owned());
    let command_line = std::env::args_os().map(shell::word).collect::<Vec<_>>().join(" ");
    let outside: Vec<String> = config.outside.iter().map(ToString::to_string).collect();
    let items = if config.database.is_some() { "file" } else { IN_MEMORY };
    let entries = [
        ("program", "rcs-run".to_owned()),
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("commit", crate::COMMIT.to_owned()),
        ("command_line", command_line),
        ("job", setup.job.name.clone()),
        (DATA, setup.data.to_string()),
        ("seed", config.seed.to_string()),
        ("clock", config.clock.text().to_owned()),
        ("robot", config.robot.to_string()),
        ("boards", config.boards.text().to_owned()),
        ("configuration_digest", configuration.to_string()),
        ("faults", faults.unwrap_or_else(|| "none".to_owned())),
        (RETRY, config.retry.to_string()),
        (OUTSIDE, outside.join(",")),
        (DATA_BASE, items.to_owned()),
    ];
    let own = entries.into_iter().map(|(key, value)| (key.to_owned(), value));
    let limit = config.ticks.map(|ticks| (TICKS.to_owned(), ticks.to_string()));
    let stand_by = config.stand_by.then(|| (STAND_BY.to_owned(), "yes".to_owned()));
    let unchecked = config.unchecked.then(|| (UNCHECKED.to_owned(), "yes".to_owned()));
    let field = config.field.as_ref().map(|field| (FIELD.to_owned(), field.to_string()));
    own.chain(field).chain(limit).chain(stand_by).chain(unchecked).chain(config.remarks.clone()).collect()
}
