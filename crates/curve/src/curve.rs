//! Parametric space curves and their differential geometry at a parameter.

use std::fmt::Debug;

use glam::DVec3;

/// A parametric space curve, three times differentiable between its [breaks](Curve::breaks).
///
/// # Examples
/// ```
/// use isochore_curve::{Curve, TrigonometricCurve};
///
/// let helix = TrigonometricCurve::helix(2.0, 0.0, (0.0, 3.0));
/// assert_eq!(helix.domain(), (0.0, 3.0));
/// assert!((helix.jet(1.0).curvature() - 0.5).abs() < 1e-15);
/// ```
pub trait Curve: Debug + Send + Sync {
    /// First and last parameter. The first is smaller than the last.
    fn domain(&self) -> (f64, f64);

    /// Position and derivatives at `parameter`. An implementation that is not defined outside its
    /// domain clamps or wraps the parameter into it.
    fn jet(&self, parameter: f64) -> CurveJet;

    /// Returns true if the curve ends at its first point, with the same tangent.
    fn is_closed(&self) -> bool {
        false
    }

    /// Ascending parameters at which a derivative up to the third is discontinuous, including the
    /// ends of the domain. Quadratures do not integrate across them.
    fn breaks(&self) -> Vec<f64> {
        let (first, last) = self.domain();
        vec![first, last]
    }

    /// Position at `parameter`.
    fn position(&self, parameter: f64) -> DVec3 {
        self.jet(parameter).position
    }
}

impl<C: Curve + ?Sized> Curve for &C {
    fn domain(&self) -> (f64, f64) {
        (**self).domain()
    }

    fn jet(&self, parameter: f64) -> CurveJet {
        (**self).jet(parameter)
    }

    fn is_closed(&self) -> bool {
        (**self).is_closed()
    }

    fn breaks(&self) -> Vec<f64> {
        (**self).breaks()
    }

    fn position(&self, parameter: f64) -> DVec3 {
        (**self).position(parameter)
    }
}

/// Position of a curve and its first three derivatives with respect to the parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveJet {
    /// Position, model units.
    pub position: DVec3,
    /// First derivative.
    pub first: DVec3,
    /// Second derivative.
    pub second: DVec3,
    /// Third derivative.
    pub third: DVec3,
}

impl CurveJet {
    /// Parametric speed |x′|.
    pub fn speed(&self) -> f64 {
        self.first.length()
    }

    /// Unit tangent. Zero at a cusp, where the speed is zero.
    pub fn tangent(&self) -> DVec3 {
        self.first.normalize_or_zero()
    }

    /// Curvature vector κ n, per model unit: derivative of the unit tangent with respect to arc
    /// length. Zero at a cusp.
    pub fn curvature_vector(&self) -> DVec3 {
        let squared_speed = self.first.length_squared();
        if squared_speed == 0.0 {
            return DVec3::ZERO;
        }
        (self.second - self.first * (self.second.dot(self.first) / squared_speed)) / squared_speed
    }

    /// Curvature |x′ × x″| / |x′|³, per model unit, never negative. Zero at a cusp.
    pub fn curvature(&self) -> f64 {
        let speed = self.speed();
        if speed == 0.0 { 0.0 } else { self.first.cross(self.second).length() / (speed * speed * speed) }
    }

    /// Torsion det(x′, x″, x‴) / |x′ × x″|², per model unit, with n′ = −κ t + τ b. Zero if the
    /// curvature is zero, because torsion is then undefined.
    pub fn torsion(&self) -> f64 {
        let binormal = self.first.cross(self.second);
        let squared = binormal.length_squared();
        if squared == 0.0 { 0.0 } else { binormal.dot(self.third) / squared }
    }

    /// Derivative of the unit tangent with respect to the parameter. Zero at a cusp.
    pub fn tangent_derivative(&self) -> DVec3 {
        self.curvature_vector() * self.speed()
    }

    /// Unit principal normal, or `None` if the curvature is zero.
    pub fn normal(&self) -> Option<DVec3> {
        self.curvature_vector().try_normalize()
    }
}

/// Jet of a curve that consists of `segments` (at least one). The parameter is the number of the
/// segment plus the parameter within it.
pub(crate) fn jet_of_segments(segments: &[impl Curve], parameter: f64) -> CurveJet {
    let segment = (parameter.max(0.0) as usize).min(segments.len() - 1);
    segments[segment].jet(parameter - segment as f64)
}

/// Parameters at which the segments of such a curve meet, including its ends.
pub(crate) fn joints(segments: usize) -> Vec<f64> {
    (0..=segments).map(|segment| segment as f64).collect()
}
