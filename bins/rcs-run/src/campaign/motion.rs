//! Detects when everything is at rest: the robot, the fingers of its gripper, the Active Pedestal.

use geometry::{frame::Rotation, kinematics::Joints};
use rcs_core::tick::Tick;

use super::{branch::Branch, verdict::Verdict};

/// Ticks without motion after which all devices are at rest: 12 s. The controller never waits so long between motions.
const STILL: u64 = 300;
/// Ticks within which all devices must come to rest: five minutes, the time limit of a command.
const LIMIT: u64 = 7500;
/// Motion per tick below which a joint is at rest, radians.
const ANGLE: f64 = 2e-6;
const OPENING: f64 = 1e-4; // motion per tick below which a finger is at rest, in

#[derive(Clone, Debug)]
struct Posture {
    /// Joints of the robot, rad; `None` if it has sagged without pressure, where it creeps for minutes.
    joints: Option<Joints>,
    table: Rotation,
    openings: [f64; 4], // openings of the robot's gripper and of the pedestal's hand, in
}

impl Posture {
    fn of(branch: &Branch<'_>) -> Self {
        let cell = &branch.closed.workstation.cell;
        let (fingers, hand) = (cell.fingers(), cell.pedestal_fingers());
        Self {
            joints: (!cell.t3().arm().has_sagged()).then(|| cell.joints()),
            table: cell.pedestal().rotation,
            openings: [fingers.0, fingers.1, hand.0, hand.1],
        }
    }

    fn is_like(&self, other: &Self) -> bool {
        let near = |(one, other): (&f64, &f64), most| (one - other).abs() <= most;
        let joints = match (&self.joints, &other.joints) {
            (Some(one), Some(other)) => one.iter().zip(other).all(|pair| near(pair, ANGLE)),
            (one, other) => one.is_none() == other.is_none(),
        };
        let openings = self.openings.iter().zip(&other.openings).all(|pair| near(pair, OPENING));
        joints && openings && (self.table.matrix() - other.table.matrix()).amax() <= ANGLE
    }
}

pub struct Motion {
    posture: Posture,
    began: Tick,
    now: Tick,
    last: Tick, // the last tick in which something moved
}

impl Motion {
    /// Start at a stop, which happens after the present tick.
    #[must_use]
    pub fn from_now(branch: &Branch<'_>) -> Self {
        let began = branch.at();
        Self { posture: Posture::of(branch), began, now: began, last: began }
    }

    #[must_use]
    pub fn has_just_begun(&self) -> bool {
        self.now == self.began
    }

    pub fn look(&mut self, branch: &Branch<'_>) {
        let posture = Posture::of(branch);
        self.now = branch.at();
        if !posture.is_like(&self.posture) {
            self.last = self.now;
        }
        self.posture = posture;
    }

    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.last.since(self.began)
    }

    /// The verdict, as soon as the branch can be judged. `commanded` is that of the worst harm.
    #[must_use]
    pub fn verdict(&self, commanded: Option<bool>) -> Option<Verdict> {
        let (still, all) = (self.now.since(self.last), self.now.since(self.began));
        match commanded {
            Some(true) => Some(Verdict::Hurt),
            _ if still < STILL && all < LIMIT => None,
            _ if still < STILL => Some(Verdict::Stranded),
            Some(false) => Some(Verdict::Apart),
            None => Some(Verdict::Done),
        }
    }
}
