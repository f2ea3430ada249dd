//! Gauge of a tool's vector potential: the gradient of a polynomial Ψ added to it.
//!
//! ```text
//! V = curl(g(d/R) (A + ∇Ψ)) = g (v + ω×r) + (g′/R) n × (A + ∇Ψ)
//! ```
//!
//! For any Ψ, the field is a curl, its core moves rigidly, and its speed normal to the surface is
//! that of the tool. Only the tangential flow around the tool changes.
//!
//! Source: D. Zheng, *Studies on Motion and Deformation in Graphics*, 2008, section 11.2.5. The
//! thesis chooses two crossed vector fields freely; since a cross product is not a curl, Ψ replaces
//! that choice.

mod fit;
mod polynomial;

#[cfg(test)]
mod tests;

use glam::DVec3;

use crate::fields::rigid_motion::RigidMotion;
pub(crate) use polynomial::Cubic;

/// Polynomials Ψ for the six basis motions: three unit velocities of the center, then three unit
/// angular velocities. Coordinates are relative to the tool's center, in tool axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Gauge {
    motions: [Cubic; 6],
}

impl Gauge {
    /// Ψ = (ω·r) |a×r|²/12 for rotations about the unit vector a through the center.
    ///
    /// This gives the potential of W. von Funck, H. Theisel, H.-P. Seidel, *Vector Field Based
    /// Shape Deformations*, 2006, whose rotation fields are ∇(a·r) × ½∇|a×r|².
    pub(crate) fn of_product(axis: DVec3) -> Self {
        let mut motions = [Cubic::ZERO; 6];
        // (ω·r) |a×r|² = |r|² (ω·r) − (a·r)² (ω·r), linear in ω.
        for (index, omega) in DVec3::AXES.into_iter().enumerate() {
            let all = Cubic::product_of_squares(omega);
            let along = Cubic::product(axis, axis, omega);
            motions[3 + index] = (all - along) * (1.0 / 12.0);
        }
        Self { motions }
    }

    /// Ψ of a motion.
    pub(crate) fn of(&self, motion: &RigidMotion) -> Cubic {
        let rates = motion.linear.to_array().into_iter().chain(motion.angular.to_array());
        self.motions.iter().zip(rates).fold(Cubic::ZERO, |sum, (&cubic, rate)| sum + cubic * rate)
    }
}
