//! The files of chapter VII and the look-ups of the control processes.
//!
//! A record number counts from 1, and 0 is the null pointer of the manual's `…-^` variables. A look-up by name, or by
//! object, grip and location, reads one or two cache lines of a perfect hash table for any number of records.
//!
//! * [`records`], [`index`]: records, indexes; their numbers are [`interfaces::record_number`];
//! * [`data`]: [`TaskData`], by number and by name;
//! * [`locations`]: from the location and sector of a command to a frame (VII.3 to VII.5);
//! * [`paths`]: grips, views, approaches, departs and trajectories (VII.6, VII.7).

#![cfg_attr(not(test), deny(clippy::as_conversions, clippy::arithmetic_side_effects))]

pub mod data;
pub mod index;
pub mod locations;
pub mod paths;
pub mod records;
pub mod reference;

pub use data::TaskData;
pub use index::{Index, PlaceIndex};
pub use interfaces::location::Place;
pub use interfaces::record_number::{
    ApprDeptId, ArrayId, EndEffId, GripLocId, LocptId, MovtabId, ObjGripsId, ObjLocId, ObjectId, OwnerId,
    PathId, PedParaId, PoseId, RelativeMoveId, SensorId, TrajId, TrajParaId, VisionId,
};
pub use locations::{Location, LookupError};
pub use records::{
    ApprDept, Array, Direction, EndEffPara, GripLoc, Locpt, Member, MovtabRecord, ObjGrips, ObjLoc, Object,
    Owner, Path, PathPoint, PedPara, PoseRecord, RelativeMove, SensorPara, SensorSource, Target, Traj,
    TrajPara, VisionPara,
};
pub use reference::{RefType, Reference};
