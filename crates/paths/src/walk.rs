//! Plans a command's path: goals and via points, with E-move's routes and Prim's times.

use geometry::{
    frame::Frame,
    kinematics::{HOME_JOINTS, JOINT_NAMES, T3},
    pose::Pose,
    units::{Length, inches},
};
use interfaces::{
    Reason,
    emove::{EmoveCommand, EmoveVerb, GoneTo, ObjectGrip, RobotPlace},
};
use levels::{
    emove::{
        motion::route::{EmoveGoal, LegGoal, Planning, Route},
        robot_place::is_same_pose,
        tables::{Action, Records, records::records},
    },
    places::robot_at,
};
use rcs_core::{
    name::Name16,
    table::{Decision, Verdict},
    tick::TICK_S,
};
use taskdata::{
    files::{EndEffId, Location, PoseId, Target, TaskData, TrajParaId, VisionId},
    load::{
        Store,
        guarded::{Beginning, relative_move_named},
    },
};

use crate::{
    entries::Point,
    flight::time,
    plan::{Leg, Phase, described},
    steps::Step,
};

/// Text of LOCATE-OBJ if the position of the object is unknown.
const LOCATE: &str = "LOCATE-OBJ: taken to be found in the middle of its place";
const DEPARTURE: u32 = u32::MAX - 1; // numbers of E-move's variable records in a route: start and goal
const GOAL: u32 = u32::MAX;

#[derive(Clone, Debug)]
pub struct Walk<'a> {
    pub(crate) store: &'a Store,
    pub(crate) data: TaskData<'a>,
    place: RobotPlace,
    found: Option<Frame>, // from vision, for the next motion
}

impl<'a> Walk<'a> {
    #[must_use]
    pub fn new(store: &'a Store, start: &Location) -> Self {
        Self::at(store, robot_at(GoneTo::Location, start, &start.frame))
    }

    #[must_use]
    pub fn at(store: &'a Store, place: RobotPlace) -> Self {
        Self { store, data: store.view(), place, found: None }
    }

    pub fn load(&mut self, store: &'a Store) {
        (self.store, self.data) = (store, store.view());
    }

    #[must_use]
    pub const fn place(&self) -> &RobotPlace {
        &self.place
    }

    #[must_use]
    pub const fn store(&self) -> &'a Store {
        self.store
    }

    #[must_use]
    pub const fn data(&self) -> &TaskData<'a> {
        &self.data
    }

    /// LOCATE-OBJ (V.2.1): the camera moves straight over `object`; the next MOV-TO-OBJ uses this frame.
    pub fn find(&mut self, object: &Frame, looked_at: &Frame) -> Phase {
        let mut phase =
            Phase { start: self.place.site.location.to_string(), ..Phase::standing(LOCATE.to_owned()) };
        self.found = Some(*object);
        let Ok(here) = self.place.pose.to_frame() else { return phase };
        // The camera keeps its orientation.
        let over = Frame { position: here.position + object.position - looked_at.position, ..here };
        let view = self.view_stop();
        if let Some(parameters) = view.filter(|_| over.distance(&here).inches > 0.0) {
            phase.from = here;
            let point = Point::new("goal", "over the object".to_owned());
            let leg = self.leg(point, &over, parameters);
            phase.legs = timed(&here, vec![leg]);
            self.place.pose = Pose::from_frame(&over);
        }
        phase
    }

    /// If a step is impossible, the phase has the reason, and the walk continues from the step's location.
    pub fn step(&mut self, step: &Step) -> Phase {
        match *step {
            Step::Go { verb, object, grip, location } => self.go(verb, object, grip, &location),
            Step::Relative { name, location } => self.relative(name, &location),
            Step::Fingers { verb, object, grip } => {
                if let (EmoveVerb::Release, GoneTo::Brought(left)) = (verb, self.place.gone_to) {
                    self.place.gone_to = GoneTo::Object(left);
                }
                self.fingers(verb, object, grip)
            }
            Step::Locate => Phase::standing(LOCATE.to_owned()),
            Step::Pedestal(verb) => Phase::standing(verb.text().to_owned()),
            Step::Engage(id) => Phase::standing(format!("the quick change meets gripper {id}")),
            Step::Leave(id) => Phase::standing(format!("gripper {id} stays in its holster")),
            Step::Take(id) => Phase::standing(format!("gripper {id} is locked on")),
            Step::LetGoTool => Phase::standing("tool gripper OPEN".to_owned()),
            Step::GraspTool => Phase::standing("tool gripper GRASP".to_owned()),
            Step::Other(what) => Phase::standing(what.to_owned()),
        }
    }

    fn fingers(&self, verb: EmoveVerb, object: Option<Name16>, grip: i32) -> Phase {
        let mut phase = Phase::standing(verb.text().to_owned());
        if let Some(object) = object
            && let Some((id, para)) = self.data.object(&object, grip)
        {
            phase.what = match verb {
                EmoveVerb::GraspObj => format!(
                    "GRASP-OBJ {object} with grip {grip:+}: to {} with {} lb",
                    Length(inches(para.grasp_size)),
                    para.grasp_force
                ),
                _ => format!("RELEASE {object}: to {}", Length(inches(para.depart_size))),
            };
            self.entry(&mut phase, "grasp", &self.store.origins().end_effs, id.index());
        }
        phase
    }

    fn go(&mut self, verb: EmoveVerb, object: Option<Name16>, grip: i32, location: &Location) -> Phase {
        let command = self.command(verb, object, grip, location);
        let mut phase = self.moving(described(&command, location));
        self.location_entries(&mut phase, location);
        self.use_object(&mut phase, &command, location);
        let (gone_to, frame) = match self.goal_and_route(&command, location) {
            Ok((goal, route)) => {
                self.route(&mut phase, &command, &goal, route);
                (goal.gone_to, goal.frame)
            }
            Err(planning) => {
                let from =
                    if self.place.site.location.is_empty() { "?" } else { self.place.site.location.as_str() };
                phase.missing = Some(format!("from {from}: {}", refusal(planning).text()));
                let gone_to =
                    object.map_or(GoneTo::Location, |object| GoneTo::Object(ObjectGrip { object, grip }));
                let grips =
                    object.and_then(|object| self.data.grip_movetable(&object, grip, &location.place));
                (gone_to, grips.map_or(location.frame, |by| self.data.moved(&location.frame, by)))
            }
        };
        // E-move departs along its approach with the object, until the fingers release it.
        let gone_to = match gone_to {
            GoneTo::Object(brought) if verb == EmoveVerb::MovObjTo => GoneTo::Brought(brought),
            gone_to => gone_to,
        };
        self.place = robot_at(gone_to, location, &frame);
        if verb != EmoveVerb::MovToVu {
            self.found = None;
        }
        phase
    }

    fn view_stop(&self) -> Option<TrajParaId> {
        let GoneTo::View(ObjectGrip { object, grip }) = self.place.gone_to else { return None };
        let place = self.place.site.place();
        Some(self.data.path(self.data.view_approach(&object, grip, &place)?).last()?.para)
    }

    fn moving(&self, what: String) -> Phase {
        let from = self.place.pose.to_frame().unwrap_or_else(|_| Frame::identity());
        Phase { start: self.place.site.location.to_string(), from, ..Phase::standing(what) }
    }

    fn command(&self, verb: EmoveVerb, object: Option<Name16>, grip: i32, at: &Location) -> EmoveCommand {
        EmoveCommand {
            command: verb,
            object,
            grip,
            object_parameters: object
                .and_then(|object| self.data.object(&object, grip))
                .map_or(EndEffId::NULL, |(id, _)| id),
            object_vision: object
                .and_then(|object| self.data.view(&object, &at.place))
                .map_or(VisionId::NULL, |(id, _)| id),
            site: at.site(),
            ..EmoveCommand::default()
        }
    }

    fn goal_and_route(&self, command: &EmoveCommand, at: &Location) -> Result<(EmoveGoal, Route), Planning> {
        let found = self.found.filter(|_| command.command == EmoveVerb::MovToObj);
        let goal = EmoveGoal::new(command, &found.unwrap_or(at.frame), &self.data)?;
        let to = goal.place(command);
        let mut route = if is_same_pose(&self.place, &to) {
            Route::here(&self.place, &to, goal.opening)
        } else {
            Route { opening: goal.opening, ..Route::between(&self.place, &to, &self.data)? }
        };
        (route.departure, route.goal) = (DEPARTURE, GOAL);
        Ok((goal, route))
    }

    fn route(&self, phase: &mut Phase, command: &EmoveCommand, goal: &EmoveGoal, mut route: Route) {
        let departure = self.place.pose.to_frame().unwrap_or_else(|_| Frame::identity());
        let (depart, between, approach) = (route.depart, route.between, route.approach);
        self.path_entries(phase, command, depart, between, approach);
        let end = self.end_datum(command);
        let mut points = self.points(depart, between, approach, end).into_iter();
        let mut legs = Vec::new();
        while let Some(leg) = route.leg(&self.data) {
            let frame = match leg.at {
                LegGoal::Record { pose, movetable } => {
                    let base = match pose {
                        DEPARTURE => Some(departure),
                        GOAL => Some(goal.frame),
                        number => self.data.pose(PoseId::new(number)).map(|record| record.frame),
                    };
                    base.map(|base| self.data.moved(&base, movetable))
                }
                LegGoal::Computed(frame) => Some(frame),
            };
            let point = points.next().unwrap_or_else(|| Point::new("goal", "goal".to_owned()));
            phase.used.extend(point.at.into_iter().chain(point.datum.as_ref().map(|datum| datum.at)));
            let Some(frame) = frame else { break };
            legs.push(self.leg(point, &frame, leg.parameters));
            route.advance(&self.data);
        }
        phase.legs = timed(&departure, legs);
        phase.opening_in = goal.opening.map(|opening| f64::from(opening) / 100.0);
    }

    fn leg(&self, point: Point, frame: &Frame, para: TrajParaId) -> Leg {
        let Point { part, name: point, at, datum } = point;
        let para = self.data.traj_para(para).copied().unwrap_or_default();
        let joints = T3.inverse(frame, &HOME_JOINTS).map(|joints| T3.margin(&T3.within_limits(&joints)));
        let p = frame.position;
        Leg {
            part,
            point,
            position_in: [p.x, p.y, p.z],
            axis: [frame.x().x, frame.x().y, frame.x().z],
            acc_fac: para.acc_fac,
            vel_max: para.vel_max,
            smooth: para.smooth,
            brk_dst: para.brk_dst,
            ticks: 0,
            joint: joints.ok().and_then(|m| JOINT_NAMES.get(m.joint).copied()),
            margin_deg: joints.ok().map(|m| m.radians.to_degrees()),
            entry: at.map(|at| self.store.place(at)),
            datum,
            frame: *frame,
        }
    }

    fn relative(&mut self, name: &'static str, location: &Location) -> Phase {
        let mut phase = self.moving(format!("{name} at {}", location.name));
        let Some(record) = self.data.relative_move(&Name16::clipped(name), &location.place) else {
            phase.missing = Some(format!("no relative move {name} at {}", location.name));
            return phase;
        };
        let position = self.data.relative_moves.iter().position(|other| std::ptr::eq(other, record));
        let at = position.and_then(|i| self.store.origins().relative_moves.get(i)).copied();
        let here = self.place.pose.to_frame().unwrap_or(location.frame);
        let base = match relative_move_named(name).map(|known| known.from) {
            Some(Beginning::After(_)) => here,
            _ => location.frame,
        };
        let frame = self.data.moved(&base, record.movetable);
        let what = if record.sensor.is_empty() { "move" } else { "until" };
        let name = record.movetable.of(self.data.movetables).map_or("...".to_owned(), |m| m.name.to_string());
        let datum = self.datum(Target::Movetable(record.movetable));
        phase.used.extend(at.into_iter().chain(datum.as_ref().map(|datum| datum.at)));
        self.location_use(&mut phase, location);
        phase.legs = timed(&here, vec![self.leg(Point { part: what, name, at, datum }, &frame, record.para)]);
        if !record.sensor.is_empty() {
            phase.what = format!("{} guarded by {}", phase.what, record.sensor);
            phase.guarded = true;
        }
        self.place = robot_at(GoneTo::Location, location, &frame);
        phase
    }
}

fn refusal(route: Planning) -> Reason {
    match records((), &Records { route, ..Records::default() }) {
        Verdict::Decided(Decision { action: Action::Refuse(reason), .. }) => reason,
        Verdict::Decided(_) | Verdict::Passed(()) => Reason::None,
    }
}

fn timed(start: &Frame, mut legs: Vec<Leg>) -> Vec<Leg> {
    let points: Vec<_> = legs.iter().map(|leg| (leg.frame, leg.parameters())).collect();
    let ticks = time(start, &points);
    legs.truncate(ticks.len());
    legs.iter_mut().zip(ticks).for_each(|(leg, ticks)| leg.ticks = ticks);
    legs
}

#[must_use]
pub fn seconds(ticks: u32) -> f64 {
    f64::from(ticks) * TICK_S
}
