//! The vision system as a device (V.2.1 LOCATE-OBJ, VII.7.6).

use rcs_core::Plain;

/// Picture requested from the vision system (V.2.1 LOCATE-OBJ).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Plain)]
pub enum Picture {
    /// No picture.
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
    /// The request is executing.
    Busy,
    /// Done; the values are valid.
    Done,
    /// The picture contains no object.
    NothingSeen,
    /// The picture contains an object other than the requested one.
    NotRecognised,
}

/// Answer of the vision system, in the axes of the place under the camera (as if the view movetable were undone): X
/// along the optical axis away from the camera, Y the tool's Y, Z = X x Y.
#[derive(Clone, Copy, Debug, PartialEq, Plain)]
pub struct VisionResponse {
    /// Number of the answered request.
    pub echo: u32,
    /// Result of the request.
    pub status: VisionStatus,
    /// Centroid from the optical axis along Y, 0.01 in.
    pub y: i32,
    /// Centroid from the optical axis along Z, 0.01 in.
    pub z: i32,
    /// Right-hand roll about X, 0.01 degree, -9000 < angle <= 9000, that aligns the tool's Y with the dimension to
    /// grip across.
    pub angle: i32,
    /// Vision id of the recognised object, if any.
    pub recognised: Option<u16>,
}
