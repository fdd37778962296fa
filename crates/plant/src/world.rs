//! The physics of the cell as one value that can be cloned.

use std::ops::{Deref, DerefMut};

use rapier3d_f64::prelude::{CCDSolver, CollisionPipeline, PhysicsPipeline, PhysicsWorld};
use serde::{Deserialize, Serialize};

/// All bodies, colliders, joints and contacts. A copy, or a restored one, continues bit for bit like the original.
#[derive(Deserialize, Serialize)]
#[serde(transparent)]
pub struct World(PhysicsWorld);

impl From<PhysicsWorld> for World {
    fn from(world: PhysicsWorld) -> Self {
        Self(world)
    }
}

impl Clone for World {
    fn clone(&self) -> Self {
        Self(PhysicsWorld {
            gravity: self.gravity,
            integration_parameters: self.integration_parameters,
            physics_pipeline: PhysicsPipeline::new(),
            collision_pipeline: CollisionPipeline::new(),
            islands: self.islands.clone(),
            broad_phase: self.broad_phase.clone(),
            narrow_phase: self.narrow_phase.clone(),
            bodies: self.bodies.clone(),
            colliders: self.colliders.clone(),
            impulse_joints: self.impulse_joints.clone(),
            multibody_joints: self.multibody_joints.clone(),
            soft_bodies: self.soft_bodies.clone(),
            ccd_solver: CCDSolver::new(),
        })
    }
}

impl Deref for World {
    type Target = PhysicsWorld;

    fn deref(&self) -> &PhysicsWorld {
        &self.0
    }
}

impl DerefMut for World {
    fn deref_mut(&mut self) -> &mut PhysicsWorld {
        &mut self.0
    }
}
