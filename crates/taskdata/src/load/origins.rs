//! The places at which records were entered.

use diagnostics::At;

#[derive(Clone, Debug, Default)]
pub struct Origins {
    pub poses: Vec<At>,
    pub movetables: Vec<At>,
    pub locpts: Vec<At>,
    pub arrays: Vec<At>, // the name in the dimension form
    pub owners: Vec<At>,
    pub members: Vec<At>,
    pub trajectories: Vec<At>,
    pub objects: Vec<At>,  // the object's first entry
    pub end_effs: Vec<At>, // object and grip number
    pub obj_grips: Vec<At>,
    pub obj_locs: Vec<At>, // the object
    pub ped_paras: Vec<At>,
    pub grip_locs: Vec<At>,  // from the object to the movetable
    pub visions: Vec<At>,    // from the object to the movetable
    pub appr_depts: Vec<At>, // from the compiling word to the location
    pub path_points: Vec<At>,
    pub sensors: Vec<At>,
    pub relative_moves: Vec<At>,
}

impl Origins {
    #[must_use]
    pub fn contain(&self, at: At) -> bool {
        let all = [
            &self.poses,
            &self.movetables,
            &self.locpts,
            &self.arrays,
            &self.owners,
            &self.members,
            &self.trajectories,
            &self.objects,
            &self.end_effs,
            &self.obj_grips,
            &self.obj_locs,
            &self.ped_paras,
            &self.grip_locs,
            &self.visions,
            &self.appr_depts,
            &self.path_points,
            &self.sensors,
            &self.relative_moves,
        ];
        all.into_iter().any(|places| places.contains(&at))
    }
}
