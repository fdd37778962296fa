//! Places at which records were entered: for messages, and to explain the robot's path.

use diagnostics::At;

/// The places of all records, in the order of the record numbers.
#[derive(Clone, Debug, Default)]
pub struct Origins {
    pub poses: Vec<At>,
    pub movetables: Vec<At>,
    pub locpts: Vec<At>,
    /// ARRAY-TABLE: the name in the dimension form.
    pub arrays: Vec<At>,
    pub owners: Vec<At>,
    pub members: Vec<At>,
    pub trajectories: Vec<At>,
    /// OBJ-ASCII-NAMES: the first entry of the object.
    pub objects: Vec<At>,
    /// END-EFF-PARA: object and grip number.
    pub end_effs: Vec<At>,
    pub obj_grips: Vec<At>,
    /// The object location form: the object.
    pub obj_locs: Vec<At>,
    pub ped_paras: Vec<At>,
    /// GRIP-LOC: from the object to the movetable.
    pub grip_locs: Vec<At>,
    /// VISION-PARA: from the object to the movetable.
    pub visions: Vec<At>,
    /// The approach/depart form: from the compiling word to the location.
    pub appr_depts: Vec<At>,
    pub path_points: Vec<At>,
    pub sensors: Vec<At>,
    pub relative_moves: Vec<At>,
}

impl Origins {
    /// True if a record was entered at a place.
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
