//! The space swept by moving bodies.

use rapier3d_f64::prelude::{Aabb, BoundingVolume};

use crate::{clearance::Body, convert::metres};

/// Bounding boxes of bodies over a motion, one per body and leg.
#[derive(Clone, Debug, Default)]
pub struct Swept(Vec<Aabb>);

impl Swept {
    /// Begin a leg with the positions of the bodies.
    pub fn begin(&mut self, bodies: &[Body]) {
        self.0.extend(bodies.iter().map(|body| body.aabb));
    }

    /// Add the next positions of the same bodies.
    pub fn add(&mut self, bodies: &[Body]) {
        let first = self.0.len().saturating_sub(bodies.len());
        for (swept, body) in self.0.iter_mut().skip(first).zip(bodies) {
            swept.merge(&body.aabb);
        }
    }

    /// True if a body may have been nearer to the moving bodies than `margin` inches.
    #[must_use]
    pub fn passes(&self, body: &Body, margin: f64) -> bool {
        let around = body.aabb.loosened(metres(margin));
        self.0.iter().any(|swept| swept.intersects(&around))
    }
}
