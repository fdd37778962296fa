//! The vision system as a device (V.2.1 LOCATE-OBJ, VII.7.6).

use rcs_core::Plain;

/// What the vision system is asked for (V.2.1 LOCATE-OBJ).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Picture {
    /// Nothing.
    None,
    /// Fast flood: approximate centroid.
    FastFlood,
    /// Second picture: centroid, angle, recognition.
    Precise,
}

/// Request to the vision system.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct VisionRequest {
    /// Changes with each request; 0 means none.
    pub number: u32,
    /// Which picture.
    pub picture: Picture,
    /// Vision id of the object (VII.7.6).
    pub object_id: u16,
    /// 1: grip across the widest dimension, 2: across the shortest (VII.7.6).
    pub grip: i16,
    /// Expected range from the image plane to the viewed surface, mm.
    pub range_mm: u16,
    /// Parameter set, 0 first; varied on a retry.
    pub variation: u8,
}

/// Answer of the vision system.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum VisionStatus {
    /// No request yet.
    Idle,
    /// Working on it.
    Busy,
    /// Done: the values are valid.
    Done,
    /// No object in the picture.
    NothingSeen,
    /// An object, but not the one asked for.
    NotRecognised,
}

/// Answer of the vision system, in the axes of the place that the camera looks at (as if the view movetable
/// were undone): X along the optical axis away from the camera, Y the tool's Y, Z = X x Y.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct VisionResponse {
    /// Number of the request that is answered.
    pub echo: u32,
    /// How it went.
    pub status: VisionStatus,
    /// Centroid from the optical axis along Y, 0.01 in.
    pub y: i32,
    /// Centroid from the optical axis along Z, 0.01 in.
    pub z: i32,
    /// Right-hand roll about X, 0.01 degree, -9000 < angle <= 9000, that brings the tool's Y onto the
    /// dimension to grip across.
    pub angle: i32,
    /// Vision id of what was recognised, if anything was.
    pub recognised: Option<u16>,
}
