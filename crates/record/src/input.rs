//! What the run gives to its log: at the start, in each tick, and at the end.

use std::{
    collections::BTreeMap,
    time::{SystemTime, UNIX_EPOCH},
};

use rcs_core::tick::Tick;
use taskdata::load::Source;

use crate::{error::RecordError, proto::foxglove::Transform};

/// Links of the cell at most.
pub const MAX_LINKS: usize = 64;
/// Joints of the cell at most.
pub const MAX_JOINTS: usize = 16;

/// What time tick 0 of a log has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Epoch {
    /// The beginning of the day on which the manual's system was finished, 1987-12-16: for runs in fast
    /// clock, whose logs are to be the same bytes whenever they are written.
    Fixed,
    /// Nanoseconds since 1970: for runs in real time.
    At(u64),
}

impl Epoch {
    /// Now.
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

/// A file that travels in the log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Attachment {
    /// Name with slashes. What begins with [`Attachment::TASK_DATA`] is the task data of the run.
    pub name: String,
    /// What it is: `text/plain`, `application/toml`, `application/xml`.
    pub media_type: String,
    /// The bytes.
    pub data: Vec<u8>,
}

impl Attachment {
    /// Directory of the task data among the attachments.
    pub const TASK_DATA: &'static str = "taskdata/";
    /// Name of the job.
    pub const JOB: &'static str = "job";
    /// Name of the cell description.
    pub const CELL: &'static str = "cell.toml";
    /// Name of the description of the cell for viewers.
    pub const URDF: &'static str = "cell.urdf";
    /// Name of the description of the byte images.
    pub const LAYOUT: &'static str = "layout.txt";

    /// A text file.
    #[must_use]
    pub fn text(name: &str, text: &str) -> Self {
        Self { name: name.into(), media_type: "text/plain".into(), data: text.as_bytes().into() }
    }

    /// The task data of a run, in the order in which it was loaded: record numbers depend on it.
    #[must_use]
    pub fn task_data(sources: &[Source]) -> Vec<Self> {
        sources
            .iter()
            .map(|source| Self::text(&format!("{}{}", Self::TASK_DATA, source.name), &source.text))
            .collect()
    }
}

/// A link of the cell: a frame that moves, and the frame that it is given in.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Link {
    /// Name, as in the URDF.
    pub name: String,
    /// Name of the parent in the URDF; `world` for what stands or moves freely.
    pub parent: String,
}

/// The cell as viewers need it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CellModel {
    /// Geometry of all links.
    pub urdf: String,
    /// Links in the order of [`CellFrame::transforms`]; a parent stands before its children.
    pub links: Vec<Link>,
    /// Names of the joints in the order of [`CellFrame::joints`].
    pub joints: Vec<String>,
}

impl CellModel {
    /// A model whose links are given in world coordinates and whose parents are read from the URDF: the
    /// parent link of the joint whose child the link is.
    #[must_use]
    pub fn new(urdf: String, links: &[String], joints: Vec<String>) -> Self {
        let parents = urdf_parents(&urdf);
        let links = links.iter().map(|name| {
            let parent = parents.get(name.as_str()).copied().unwrap_or(WORLD);
            Link { name: name.clone(), parent: parent.to_owned() }
        });
        Self { links: links.collect(), joints, urdf }
    }

    /// Refuses a cell that a [`CellFrame`] cannot carry.
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

/// The frame that everything else is given in.
pub const WORLD: &str = "world";

/// Parent of each child link, from the `joint` elements of a URDF.
fn urdf_parents(urdf: &str) -> BTreeMap<&str, &str> {
    let link = |joint: &'_ str, element: &str| -> Option<(usize, usize)> {
        let after = joint.find(element)? + element.len();
        let open = after + joint.get(after..)?.find("link=\"")? + "link=\"".len();
        Some((open, open + joint.get(open..)?.find('"')?))
    };
    let joint_elements =
        urdf.split("<joint").skip(1).map(|rest| rest.split("</joint>").next().unwrap_or(rest));
    joint_elements
        .filter_map(|joint| {
            let (parent, child) = (link(joint, "<parent")?, link(joint, "<child")?);
            Some((joint.get(child.0..child.1)?, joint.get(parent.0..parent.1)?))
        })
        .collect()
}

/// Where everything in the cell is in one tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellFrame {
    /// The tick.
    pub tick: Tick,
    /// Places of the links in world coordinates, in the order of [`CellModel::links`].
    pub transforms: [Transform; MAX_LINKS],
    /// Positions of the joints, radians or metres, in the order of [`CellModel::joints`].
    pub joints: [f64; MAX_JOINTS],
}

impl CellFrame {
    /// A frame in which nothing has moved yet.
    #[must_use]
    pub const fn new(tick: Tick) -> Self {
        Self { tick, transforms: [Transform::IDENTITY; MAX_LINKS], joints: [0.0; MAX_JOINTS] }
    }

    /// A frame from lists; what is beyond the limits is left out.
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

/// What a log is told before the first tick.
#[derive(Clone, Debug)]
pub struct Setup {
    /// Time of tick 0.
    pub epoch: Epoch,
    /// What the metadata say of the run: version, seed, command line, job, configuration digest, real-time
    /// verdict. The layout version is added.
    pub run: BTreeMap<String, String>,
    /// Task data, job, cell description. URDF and layout are added.
    pub attachments: Vec<Attachment>,
    /// The cell; none with a real robot.
    pub cell: Option<CellModel>,
}

impl Default for Setup {
    fn default() -> Self {
        Self { epoch: Epoch::Fixed, run: BTreeMap::new(), attachments: Vec::new(), cell: None }
    }
}

/// What a log is told after the last tick.
#[derive(Clone, Debug, Default)]
pub struct End {
    /// Digest of all output buffers of all ticks.
    pub digest: Option<u64>,
    /// How the job ended, one line.
    pub result: String,
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
    fn parents_come_from_the_urdf() {
        let urdf = r#"<robot name="cell"><link name="base"/><link name="arm"/>
            <joint name="j" type="revolute"><parent link="base"/><child link="arm"/></joint>
            <joint name="broken"><parent link="base"/></joint></robot>"#;
        let model = CellModel::new(urdf.into(), &["base".into(), "arm".into(), "part".into()], Vec::new());
        let parents: Vec<&str> = model.links.iter().map(|link| link.parent.as_str()).collect();
        assert_eq!(parents, ["world", "base", "world"]);
    }

    #[test]
    fn a_cell_that_is_too_large_is_refused() {
        let links: Vec<String> = (0..=MAX_LINKS).map(|number| format!("link-{number}")).collect();
        let error = CellModel::new(String::new(), &links, Vec::new()).check().unwrap_err();
        assert_eq!(error.to_string(), "a cell of at most 64 links was expected, this one has 65");
    }
}
