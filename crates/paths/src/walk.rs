//! Plans the path of the robot through the steps of a command: each goal and each via point, with the routes of E-move
//! and the times of Prim's motion.

use geometry::{
    frame::Frame,
    kinematics::{HOME_JOINTS, JOINT_NAMES, T3},
    pose::Pose,
};
use interfaces::{
    Reason,
    emove::{EmoveCommand, EmoveVerb, GoneTo, ObjectGrip, RobotPlace},
};
use levels::{
    emove::{
        robot_place::place,
        route::{Goal, LegGoal, Planning, Route, THERE_INCHES, THERE_RADIANS, near, same_location},
        tables::{Action, Request, accept::accept},
    },
    execution::Asked,
    places::{place_of, robot_at},
};
use rcs_core::{
    name::Name16,
    table::{Decision, Verdict},
    tick::TICK_S,
};
use taskdata::{
    files::{Location, MovtabId, PathId, PathPoint, PoseId, Target, TaskData, TrajParaId},
    load::{
        At, Store,
        guarded::{Beginning, relative_move_named},
    },
};

use crate::{
    flight::time,
    plan::{Entry, Leg, Phase, described},
    steps::Step,
};

/// Text of LOCATE-OBJ if the position of the object is unknown.
const LOCATE: &str = "LOCATE-OBJ: taken to be found in the middle of its place";
/// Numbers for the variable records of E-move in a route: its start and its goal.
const DEPARTURE: u32 = u32::MAX - 1;
const GOAL: u32 = u32::MAX;

/// State of a walk.
#[derive(Clone, Debug)]
pub struct Walk<'a> {
    store: &'a Store,
    data: TaskData<'a>,
    place: RobotPlace,
    /// The frame of the object that vision has found, for the next motion.
    found: Option<Frame>,
}

impl<'a> Walk<'a> {
    /// Begins at a location without an object.
    #[must_use]
    pub fn new(store: &'a Store, start: &Location) -> Self {
        let place = robot_at(GoneTo::Location, start, &start.frame);
        Self { store, data: store.view(), place, found: None }
    }

    /// Uses other task data from now on.
    pub fn load(&mut self, store: &'a Store) {
        (self.store, self.data) = (store, store.view());
    }

    /// The position of the robot, as E-move keeps it.
    #[must_use]
    pub const fn place(&self) -> &RobotPlace {
        &self.place
    }

    /// The task data.
    #[must_use]
    pub const fn data(&self) -> &TaskData<'a> {
        &self.data
    }

    /// Simulates LOCATE-OBJ (V.2.1) for an object at `object`: the camera moves straight over it, and the next
    /// MOV-TO-OBJ uses this frame.
    pub fn find(&mut self, object: &Frame, looked_at: &Frame) -> Phase {
        let mut phase =
            Phase { start: self.place.location.to_string(), ..Phase::standing(LOCATE.to_owned()) };
        self.found = Some(*object);
        let Ok(here) = self.place.pose.to_frame() else { return phase };
        // The camera keeps its orientation and moves by the distance of the object from the middle of the picture.
        let over = Frame { position: here.position + object.position - looked_at.position, ..here };
        let view = self.view_stop();
        if let Some(parameters) = view.filter(|_| over.distance(&here).inches > 0.0) {
            phase.from = here;
            let leg = self.leg("goal", "over the object".to_owned(), None, &over, parameters);
            phase.legs = timed(&here, vec![leg]);
            self.place.pose = Pose::from_frame(&over);
        }
        phase
    }

    /// Plans a step; the phase contains the reason if it is not possible. The walk then continues from the location of
    /// the step, so that later steps can be checked too.
    pub fn step(&mut self, step: &Step) -> Phase {
        match *step {
            Step::Go { verb, object, grip, location } => self.go(verb, object, grip, &location),
            Step::Relative { name, location } => self.relative(name, &location),
            Step::Fingers { verb, object, grip } => self.fingers(verb, object, grip),
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
                    "GRASP-OBJ {object} with grip {grip:+}: to {} in with {} lb",
                    inches(para.grasp_size),
                    para.grasp_force
                ),
                _ => format!("RELEASE {object}: to {} in", inches(para.depart_size)),
            };
            self.entry(&mut phase, "grasp", &self.store.origins().end_effs, id.index());
        }
        phase
    }

    fn go(&mut self, verb: EmoveVerb, object: Option<Name16>, grip: i32, location: &Location) -> Phase {
        let command = self.command(verb, object, grip, location);
        let mut phase = self.moving(described(&command, location));
        self.location_entries(&mut phase, location);
        let (gone_to, frame) = match self.goal_and_route(&command, location) {
            Ok((goal, route)) => {
                self.route(&mut phase, &command, &goal, route);
                (goal.gone_to, goal.frame)
            }
            Err(planning) => {
                let from = if self.place.location.is_empty() { "?" } else { self.place.location.as_str() };
                phase.missing = Some(format!("from {from}: {}", refusal(verb, planning).text()));
                let gone_to =
                    object.map_or(GoneTo::Location, |object| GoneTo::Object(ObjectGrip { object, grip }));
                let grips =
                    object.and_then(|object| self.data.grip_movetable(&object, grip, &location.place));
                (gone_to, grips.map_or(location.frame, |by| self.data.moved(&location.frame, by)))
            }
        };
        self.place = robot_at(gone_to, location, &frame);
        if verb != EmoveVerb::MovToVu {
            self.found = None;
        }
        phase
    }

    /// Parameters of the last motion to a view point.
    fn view_stop(&self) -> Option<TrajParaId> {
        let GoneTo::View(ObjectGrip { object, grip }) = self.place.gone_to else { return None };
        let place = place_of(self.place.kind, self.place.record, self.place.array);
        Some(self.data.path(self.data.view_approach(&object, grip, &place)?).last()?.para)
    }

    /// A phase that starts at the robot's position.
    fn moving(&self, what: String) -> Phase {
        let from = self.place.pose.to_frame().unwrap_or_else(|_| Frame::identity());
        Phase { start: self.place.location.to_string(), from, ..Phase::standing(what) }
    }

    fn command(&self, verb: EmoveVerb, object: Option<Name16>, grip: i32, at: &Location) -> EmoveCommand {
        EmoveCommand {
            command: verb,
            object,
            grip,
            object_parameters: object
                .and_then(|object| self.data.object(&object, grip))
                .map(|(id, _)| id.number()),
            object_vision: object
                .and_then(|object| self.data.view(&object, &at.place))
                .map(|(id, _)| id.number()),
            location: at.name,
            location_kind: at.place.kind,
            location_record: at.place.locpt.to_option(),
            location_array: at.place.array.to_option(),
            location_sector: at.sector,
            ..EmoveCommand::default()
        }
    }

    fn goal_and_route(&self, command: &EmoveCommand, at: &Location) -> Result<(Goal, Route), Planning> {
        let found = self.found.filter(|_| command.command == EmoveVerb::MovToObj);
        let goal = Goal::new(command, &found.unwrap_or(at.frame), &self.data)?;
        let to = goal.place(command);
        // The walked robot stands where it was sent.
        let mut route = if self.is_at(&to) {
            Route::here(&self.place, &to, goal.opening)
        } else {
            Route { opening: goal.opening, ..Route::between(&self.place, &to, &self.data)? }
        };
        (route.departure, route.goal) = (DEPARTURE, GOAL);
        Ok((goal, route))
    }

    /// Does the robot stand at the pose of a goal, at the same location?
    fn is_at(&self, to: &RobotPlace) -> bool {
        let (Ok(here), Ok(there)) = (self.place.pose.to_frame(), to.pose.to_frame()) else { return false };
        same_location(&place(&self.place), &place(to)) && near(&here, &there, THERE_INCHES, THERE_RADIANS)
    }

    /// Adds the legs of a route with their times, and the entries of the task data that it uses.
    fn route(&self, phase: &mut Phase, command: &EmoveCommand, goal: &Goal, mut route: Route) {
        let departure = self.place.pose.to_frame().unwrap_or_else(|_| Frame::identity());
        let (depart, between, approach) = (route.depart, route.between, route.approach);
        self.path_entries(phase, command, depart, between, approach);
        let mut names = self.names(depart, between, approach).into_iter();
        let mut legs = Vec::new();
        while let Some(leg) = route.leg(&self.data) {
            let frame = match leg.at {
                LegGoal::Record { pose, movetable } => {
                    let base = match pose {
                        DEPARTURE => Some(departure),
                        GOAL => Some(goal.frame),
                        number => self.data.pose(PoseId::new(number)).map(|record| record.frame),
                    };
                    base.map(|base| self.data.moved(&base, MovtabId::from_option(movetable)))
                }
                LegGoal::Computed(frame) => Some(frame),
            };
            let (part, point, at) = names.next().unwrap_or(("goal", "goal".to_owned(), None));
            let Some(frame) = frame else { break };
            legs.push(self.leg(part, point, at, &frame, leg.parameters));
            route.advance(&self.data);
        }
        phase.legs = timed(&departure, legs);
        phase.opening_in = goal.opening.map(|opening| f64::from(opening) / 100.0);
    }

    /// Part, name and entry of each point of a route except the goal.
    fn names(
        &self,
        depart: PathId,
        between: PathId,
        approach: PathId,
    ) -> Vec<(&'static str, String, Option<At>)> {
        let mut names = Vec::new();
        for (part, path) in [("depart", depart), ("trajectory", between), ("approach", approach)] {
            let first = path.of(self.data.paths).and_then(|p| usize::try_from(p.first).ok()).unwrap_or(0);
            for (i, point) in self.data.path(path).iter().enumerate() {
                if point.target != Target::Stop {
                    let at = self.store.origins().path_points.get(first + i).copied();
                    names.push((part, self.point_name(point), at));
                }
            }
        }
        let stop = self.data.path(approach).last().filter(|point| point.target == Target::Stop);
        let at = stop.and_then(|_| {
            let path = approach.of(self.data.paths)?;
            let last = path.first.checked_add(path.count)?.checked_sub(1)?;
            self.store.origins().path_points.get(usize::try_from(last).ok()?).copied()
        });
        names.push(("goal", if stop.is_some() { "stop" } else { "goal" }.to_owned(), at));
        names
    }

    fn point_name(&self, point: &PathPoint) -> String {
        let data = &self.data;
        match point.target {
            Target::Movetable(id) => id.of(data.movetables).map_or("...".to_owned(), |m| m.name.to_string()),
            Target::Pose(id) => data.pose(id).map_or(String::new(), |p| p.name.to_string()),
            Target::LocationPoint(id) => data.locpt(id).map_or(String::new(), |l| l.name.to_string()),
            Target::Stop => "stop".to_owned(),
        }
    }

    fn leg(&self, part: &'static str, point: String, at: Option<At>, frame: &Frame, para: TrajParaId) -> Leg {
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
        let point =
            record.movetable.of(self.data.movetables).map_or("...".to_owned(), |m| m.name.to_string());
        phase.legs = timed(&here, vec![self.leg(what, point, at, &frame, record.para)]);
        if !record.sensor.is_empty() {
            phase.what = format!("{} guarded by {}", phase.what, record.sensor);
            phase.guarded = true;
        }
        self.place = robot_at(GoneTo::Location, location, &frame);
        phase
    }

    fn entry(&self, phase: &mut Phase, what: &'static str, origins: &[At], position: Option<usize>) {
        if let Some(at) = position.and_then(|i| origins.get(i)) {
            phase.entries.push(Entry { what, at: self.store.place(*at) });
        }
    }

    fn location_entries(&self, phase: &mut Phase, location: &Location) {
        let origins = self.store.origins();
        let place = location.place;
        self.entry(phase, "location", &origins.locpts, place.locpt.index());
        self.entry(phase, "array", &origins.arrays, place.array.index());
        let pose = self.data.locpt(place.locpt).and_then(|point| point.pose.index());
        self.entry(phase, "pose", &origins.poses, pose);
    }

    /// Adds the entries of grip, view, depart, trajectory and approach.
    fn path_entries(
        &self,
        phase: &mut Phase,
        command: &EmoveCommand,
        depart: PathId,
        between: PathId,
        approach: PathId,
    ) {
        let (data, origins) = (&self.data, self.store.origins());
        let place = place_of(command.location_kind, command.location_record, command.location_array);
        match command.command {
            EmoveVerb::MovToVu => {
                let view = command
                    .object
                    .and_then(|object| data.view(&object, &place))
                    .and_then(|(id, _)| id.index());
                self.entry(phase, "view", &origins.visions, view);
            }
            EmoveVerb::MovToLoc => {}
            _ => {
                let object = command.object.as_ref();
                let grip = object.and_then(|object| data.grip_loc(object, command.grip, &place));
                self.entry(phase, "grip", &origins.grip_locs, grip.and_then(|id| id.index()));
                let sizes = object
                    .and_then(|object| data.object(object, command.grip))
                    .and_then(|(id, _)| id.index());
                self.entry(phase, "sizes", &origins.end_effs, sizes);
            }
        }
        let directed = |path: PathId| data.appr_depts.iter().position(|r| !path.is_null() && r.path == path);
        self.entry(phase, "depart", &origins.appr_depts, directed(depart));
        let flown = data.trajectories.iter().position(|r| !between.is_null() && r.path == between);
        self.entry(phase, "trajectory", &origins.trajectories, flown);
        self.entry(phase, "approach", &origins.appr_depts, directed(approach));
    }
}

/// The reason with which E-move refuses a command whose path cannot be planned.
fn refusal(verb: EmoveVerb, route: Planning) -> Reason {
    match accept((), &Request { asked: Asked::Now, verb, route, ..Request::default() }) {
        Verdict::Decided(Decision { action: Action::Refuse(reason), .. }) => reason,
        Verdict::Decided(_) | Verdict::Passed(()) => Reason::None,
    }
}

/// Hundredths of an inch as text in inches.
#[must_use]
pub fn inches(hundredths: i32) -> String {
    format!("{:.2}", f64::from(hundredths) / 100.0)
}

/// The legs with the number of ticks of each.
fn timed(start: &Frame, mut legs: Vec<Leg>) -> Vec<Leg> {
    let points: Vec<_> = legs.iter().map(|leg| (leg.frame, leg.parameters())).collect();
    let ticks = time(start, &points);
    legs.truncate(ticks.len());
    legs.iter_mut().zip(ticks).for_each(|(leg, ticks)| leg.ticks = ticks);
    legs
}

/// Converts ticks to seconds.
#[must_use]
pub fn seconds(ticks: u32) -> f64 {
    f64::from(ticks) * TICK_S
}
