//! Checks the cell before a step: the part to grasp is there, jaws and drum are open for a carried part, and a released
//! part has support.

use geometry::units::Length;
use interfaces::emove::EmoveVerb;
use plant::{
    description::Kind,
    room::{Layout, Placed},
};

use crate::{finding::Finding, state::State, steps::Step};

const DROP: f64 = 0.5; // greatest fall of a released part, in (ASSUMED; shipped data: at most 0.15)

impl State<'_> {
    /// The problem that prevents a step with a free path.
    pub(crate) fn hindrance(&self, step: &Step) -> Option<Finding> {
        match *step {
            Step::Go { .. } => self.in_jaws(),
            Step::Relative { name: "REM-OUT", .. } => self.in_drum(),
            Step::Fingers { verb: EmoveVerb::GraspObj, object: Some(object), .. } => {
                let there =
                    self.nearest(&object, &self.robot.tool()).is_some() || self.lacking.contains(&object);
                (!there).then(|| {
                    finding(
                        format!("GRASP-OBJ {object}: no {object} is there"),
                        "a line `** tray LOCATION SECTOR OBJECT` brings a part, `** machine BLANK PART LOCATION` makes it \
                         another",
                    )
                })
            }
            Step::Fingers { verb: EmoveVerb::Release, .. } => self.in_the_air(),
            Step::GraspTool => self.tool_in_drum().is_none().then(|| {
                finding(
                    "the fingers close on a tool in the drum: no tool is there".to_owned(),
                    "a line `** drum tool TOOL` puts one there",
                )
            }),
            _ => None,
        }
    }

    fn carried(&self) -> Option<Placed> {
        let held = self.layout.held.as_ref()?;
        Some(Placed { frame: self.robot.tool().compose(&held.frame), ..held.clone() })
    }

    /// The vise still holds the part.
    fn in_jaws(&self) -> Option<Finding> {
        let part = self.carried()?;
        let (_, closed) = self.room.vise_seat(self.layout.program, &part)?;
        let name = part.kind.name.clone();
        let layout = Layout { parts: vec![part], ..self.layout.clone() };
        (self.layout.jaws <= closed && self.room.in_vise(&layout).is_some()).then(|| {
            finding(
                format!("the closed jaws of the vise hold {name}, which the robot carries away"),
                "a line `** vise open LOCATION` before it",
            )
        })
    }

    /// The drum still grips the tool.
    fn in_drum(&self) -> Option<Finding> {
        self.drum_grips.then(|| {
            finding(
                "the drum grips the tool that the robot takes out".to_owned(),
                "a line `** drum release` before it",
            )
        })
    }

    /// The released part has no support.
    fn in_the_air(&self) -> Option<Finding> {
        let part = self.carried().filter(|part| self.room.nest_seat(part).is_none())?;
        let mut movers = self.room.movers(&self.layout, self.robot.joints());
        movers.retain(|body| body.kind == Kind::HeldPart);
        let near = self.room.look(&movers, &self.room.devices(&self.layout), DROP);
        near.is_empty().then(|| {
            let name = &part.kind.name;
            finding(
                format!("RELEASE {name}: nothing is within {} of {name}, which falls", Length(DROP)),
                "send it to a tray, a vise, a nest or the pedestal",
            )
        })
    }
}

fn finding(message: String, help: &str) -> Finding {
    let key = format!("path.place {message}");
    Finding {
        code: "path.place",
        error: true,
        line: 0,
        message,
        help: Some(help.to_owned()),
        data: Vec::new(),
        key,
        depth: 0.0,
    }
}
