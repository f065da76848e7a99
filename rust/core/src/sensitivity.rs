//! What may be asked of the derivatives of a response.
//!
//! Every unknown of the line enters its dynamic stiffness K linearly, so `dH = -u_s' dK u_f`: the motion by a unit
//! force at the sensor and the motion by the force itself give every derivative (adjoint; Fox and Kapoor 1968 for
//! modes). No solve beside those two is needed, whatever the number of parameters.

use crate::{
    error::CoreError,
    line::{Body, Line},
};

/// Derivatives wanted beside the response. Responses are between the request's forces: a sensor whose responses are to
/// be derived is among them.
#[derive(Debug, Clone, Copy)]
pub struct Sensitivity<'a> {
    /// Group of each joint, by which its contribution is summed; `None` if it belongs to none.
    pub groups: &'a [Option<usize>],
    /// Weight of each joint in its group: its stiffness per unit of the group's parameter.
    pub weights: &'a [f64],
    /// Number of groups.
    pub n_groups: usize,
    /// Whether by bending stiffness, shear stiffness, mass and rotary inertia of every beam and shaft, of which a shaft
    /// has the second and third, and by every point mass. Sections that differ over a stretch move in proportion.
    pub bodies: bool,
    /// Forces whose places stand for the sensors.
    pub sensors: &'a [usize],
    /// Forces that load.
    pub forces: &'a [usize],
    /// Whether the extension of every joint by a unit tension in itself is wanted.
    pub own: bool,
}

/// Derivatives by a beam: bending stiffness, shear stiffness, mass and rotary inertia per length.
pub const OF_A_BEAM: usize = 4;

impl Sensitivity<'_> {
    /// Numbers of derivatives per frequency: parameters x sensors x forces.
    pub fn len(&self, line: &Line) -> usize {
        self.parameters(line) * self.pairs()
    }

    /// Whether no derivative is wanted.
    pub fn is_empty(&self, line: &Line) -> bool {
        self.len(line) == 0
    }

    /// Sensors times forces.
    pub fn pairs(&self) -> usize {
        self.sensors.len() * self.forces.len()
    }

    /// Number of parameters: groups, then those of the bodies in order.
    pub fn parameters(&self, line: &Line) -> usize {
        self.n_groups + if self.bodies { Self::first_of_each(line).1 } else { 0 }
    }

    /// Index of each body's first parameter, counted from that of the first body, and the number of all.
    pub fn first_of_each(line: &Line) -> (Vec<usize>, usize) {
        let mut next = 0;
        let first = line.bodies.iter().map(|body| {
            let mine = next;
            next += if matches!(body, Body::Mass(_)) { 1 } else { OF_A_BEAM };
            mine
        });
        (first.collect(), next)
    }

    /// Checks what is asked against the line.
    ///
    /// # Errors
    /// `Invalid` saying what does not fit.
    pub fn check(&self, line: &Line, forces: usize) -> Result<(), CoreError> {
        let bad = |what: String| Err(CoreError::Invalid(what));
        let joints = line.joints.len();
        if self.groups.len() != joints || self.weights.len() != joints {
            let (g, w) = (self.groups.len(), self.weights.len());
            return bad(format!("{g} groups and {w} weights for {joints} joints"));
        }
        if let Some(i) = self.groups.iter().position(|g| g.is_some_and(|g| g >= self.n_groups)) {
            return bad(format!("joint {i} is in a group that is none of the {}", self.n_groups));
        }
        if let Some(i) = self.weights.iter().position(|w| !w.is_finite()) {
            return bad(format!("the weight of joint {i} is not finite"));
        }
        match self.sensors.iter().chain(self.forces).find(|i| **i >= forces) {
            Some(i) => bad(format!("there is no force {i} to derive a response of")),
            None => Ok(()),
        }
    }
}
