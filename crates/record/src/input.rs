use std::{
    collections::BTreeMap,
    time::{SystemTime, UNIX_EPOCH},
};

use rcs_core::tick::Tick;
use taskdata::load::Source;

use crate::{
    error::RecordError,
    proto::foxglove::{Level, Link, Transform},
    views::View,
};

pub const MAX_LINKS: usize = 64;
pub const MAX_JOINTS: usize = 16;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Epoch {
    /// The beginning of 1987-12-16, the day on which the manual's system was finished: for runs in fast clock, whose
    /// logs must not depend on the date.
    Fixed,
    /// Nanoseconds since 1970: for runs in real time.
    At(u64),
}

impl Epoch {
    #[must_use]
    pub fn now() -> Self {
        let since_1970 = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        Self::At(u64::try_from(since_1970.as_nanos()).unwrap_or(u64::MAX))
    }

    /// Nanoseconds since 1970 of a tick.
    #[must_use]
    pub const fn of(self, tick: Tick) -> u64 {
        let start = match self {
            Self::Fixed => 566_611_200_000_000_000,
            Self::At(start) => start,
        };
        start.saturating_add(tick.milliseconds().saturating_mul(1_000_000))
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Attachment {
    /// Name with slashes. Names that begin with [`Attachment::TASK_DATA`] are the task data of the run.
    pub name: String,
    pub media_type: String, // `text/plain`, `application/toml`, `application/xml`
    pub data: Vec<u8>,
}

impl Attachment {
    /// Directory of the task data among the attachments.
    pub const TASK_DATA: &'static str = "taskdata/";
    /// Directory of blocks that were loaded during the run: `reload/<generation>/` and the name of the file.
    pub const RELOAD: &'static str = "reload/";
    /// Directory of jobs with which operators replaced the rest of the job: `played/<number>/` and the file's name.
    pub const PLAYED: &'static str = "played/";
    pub const JOB: &'static str = "job";
    pub const CELL: &'static str = "cell.toml";
    /// Name of the description of the cell for viewers.
    pub const URDF: &'static str = "cell.urdf";
    /// Name of the description of the byte images.
    pub const LAYOUT: &'static str = "layout.txt";

    #[must_use]
    pub fn text(name: &str, text: &str) -> Self {
        Self { name: name.into(), media_type: "text/plain".into(), data: text.as_bytes().into() }
    }

    /// The task data of a run, in the order of loading, on which record numbers depend.
    #[must_use]
    pub fn task_data(sources: &[Source]) -> Vec<Self> {
        sources
            .iter()
            .map(|source| Self::text(&format!("{}{}", Self::TASK_DATA, source.name), &source.text))
            .collect()
    }

    /// Blocks that create a new generation of the task data.
    #[must_use]
    pub fn reload(generation: u32, sources: &[Source]) -> Vec<Self> {
        sources
            .iter()
            .map(|source| Self::text(&format!("{}{generation}/{}", Self::RELOAD, source.name), &source.text))
            .collect()
    }

    /// The generation and the source of a [`Attachment::reload`]; `None` for other attachments.
    #[must_use]
    pub fn as_reload(&self) -> Option<(u32, Source)> {
        let (generation, name) = self.name.strip_prefix(Self::RELOAD)?.split_once('/')?;
        Some((generation.parse().ok()?, self.source(name)))
    }

    #[must_use]
    pub fn played(number: u32, job: &Source) -> Self {
        Self::text(&format!("{}{number}/{}", Self::PLAYED, job.name), &job.text)
    }

    /// The number and the source of an [`Attachment::played`]; `None` for other attachments.
    #[must_use]
    pub fn as_played(&self) -> Option<(u32, Source)> {
        let (number, name) = self.name.strip_prefix(Self::PLAYED)?.split_once('/')?;
        Some((number.parse().ok()?, self.source(name)))
    }

    #[must_use]
    pub fn source(&self, name: &str) -> Source {
        Source { name: name.to_owned(), text: String::from_utf8_lossy(&self.data).into_owned().into() }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Model {
    pub name: String,  // unique
    pub frame: String, // with which it moves
    pub glb: Vec<u8>,  // glTF 2.0 in binary form, metres, Y up
}

#[derive(Clone, Debug, PartialEq)]
pub struct Name {
    pub text: String,
    pub frame: String,      // with which it moves
    pub position: [f64; 3], // position in the frame of the link, metres
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellModel {
    pub urdf: String,
    /// The shapes of links and fixed bodies.
    pub models: Vec<Model>,
    pub names: Vec<Name>,
    /// Links that move, in the order of [`CellFrame::transforms`].
    pub links: Vec<Link>,
    /// Fixed links, with their places in their parents. A viewer draws no link without a transform, even with a URDF.
    pub fixed: Vec<(Link, Transform)>,
    pub joints: Vec<String>, // in the order of [`CellFrame::joints`]
}

impl CellModel {
    pub(crate) const fn check(&self) -> Result<(), RecordError> {
        let (links, joints) = (self.links.len(), self.joints.len());
        if links > MAX_LINKS {
            return Err(RecordError::CellTooLarge { what: "links", allowed: MAX_LINKS, found: links });
        }
        if joints > MAX_JOINTS {
            return Err(RecordError::CellTooLarge { what: "joints", allowed: MAX_JOINTS, found: joints });
        }
        Ok(())
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellFrame {
    pub tick: Tick,
    /// Poses of the links in their parents, in the order of [`CellModel::links`].
    pub transforms: [Transform; MAX_LINKS],
    /// Positions of the joints, radians or metres, in the order of [`CellModel::joints`].
    pub joints: [f64; MAX_JOINTS],
    /// Digest of the state of the cell; `None` if it was not computed.
    pub digest: Option<u64>,
}

impl CellFrame {
    #[must_use]
    pub const fn new(tick: Tick) -> Self {
        Self { tick, transforms: [Transform::IDENTITY; MAX_LINKS], joints: [0.0; MAX_JOINTS], digest: None }
    }

    #[must_use]
    pub const fn with_digest(mut self, digest: u64) -> Self {
        self.digest = Some(digest);
        self
    }

    /// A frame from lists. Entries beyond the limits are omitted.
    #[must_use]
    pub fn of(
        tick: Tick,
        transforms: impl IntoIterator<Item = Transform>,
        joints: impl IntoIterator<Item = f64>,
    ) -> Self {
        let mut frame = Self::new(tick);
        frame.transforms.iter_mut().zip(transforms).for_each(|(slot, transform)| *slot = transform);
        frame.joints.iter_mut().zip(joints).for_each(|(slot, joint)| *slot = joint);
        frame
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Touch {
    pub mover: String,
    pub obstacle: String,
    pub point: [f64; 3], // point of deepest penetration, world, inches
    pub depth: f64,      // inches
    /// True if the cell description does not permit the contact.
    pub collides: bool,
}

/// Data for viewers, in addition to the frames of the cell.
#[derive(Clone, Debug, PartialEq)]
pub enum Shown {
    Picture(Vec<u8>),
    Touches(Vec<Touch>),
    View(View),
}

#[derive(Clone, Debug)]
pub struct Setup {
    pub epoch: Epoch, // of tick 0
    /// Version, seed, command line, job, configuration digest, real-time verdict. The layout version is added.
    pub run: BTreeMap<String, String>,
    /// Task data, job, cell description. URDF and layout are added.
    pub attachments: Vec<Attachment>,
    /// The cell; `None` with a real robot.
    pub cell: Option<CellModel>,
}

impl Default for Setup {
    fn default() -> Self {
        Self { epoch: Epoch::Fixed, run: BTreeMap::new(), attachments: Vec::new(), cell: None }
    }
}

#[derive(Clone, Debug, Default)]
pub struct End {
    pub digest: Option<u64>, // of all output buffers of all ticks
    pub result: String,
    /// Further facts of the run: real-time verdict, overruns, faults, places of the parts.
    pub facts: BTreeMap<String, String>,
}

/// Longest text of a note, bytes; a longer one is cut.
pub const NOTE: usize = 192;

#[derive(Clone, Copy)]
pub(crate) struct Note {
    pub(crate) tick: Tick,
    pub(crate) level: Level,
    pub(crate) source: [u8; 16],
    pub(crate) code: &'static str,
    pub(crate) text: [u8; NOTE],
}

/// Number of entries without room in the rings.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Lost {
    /// Number of ticks. The run cannot be replayed across them.
    pub ticks: u64,
    pub frames: u64,
    pub notes: u64,
    /// Files of the run, such as reloads. Without them the run cannot be replayed to the end.
    pub files: u64,
    pub shown: u64, // pictures, lists of contacts, states of the run
    /// Requests of operators. Without them the inputs cannot be replayed.
    pub operators: u64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_have_their_time() {
        assert_eq!(Epoch::Fixed.of(Tick(25)), 566_611_201_000_000_000);
        assert_eq!(Epoch::At(5).of(Tick(1)), 40_000_005);
        assert_eq!(Epoch::At(u64::MAX).of(Tick(1)), u64::MAX);
    }

    #[test]
    fn too_large_cell_is_refused() {
        let link = |number| Link { name: format!("link-{number}"), parent: "world".into() };
        let model = CellModel { links: (0..=MAX_LINKS).map(link).collect(), ..CellModel::default() };
        let error = model.check().unwrap_err();
        assert_eq!(error.to_string(), "a cell of at most 64 links was expected, this one has 65");
    }
}
