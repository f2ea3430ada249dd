//! The exact rational patch of a cross-section swept along a Pythagorean-hodograph cubic.
//!
//! Source: Mäurer and Jüttler 1999, equation (42). Correction of its third term: f₃ = ((1 − W²) b −
//! 2W n)/(1 + W²).

use glam::{DVec2, DVec3, DVec4};

use crate::bernstein::{derivative, product, raise, value};
use crate::{PhCubic, RationalRotation};

/// A rational Bézier curve in the normal plane, over [0, 1].
///
/// # Examples
/// ```
/// use std::f64::consts::FRAC_PI_2;
///
/// use glam::DVec2;
/// use isochore_curve::RationalCrossSection;
///
/// let line = RationalCrossSection::polynomial(&[DVec2::ZERO, DVec2::X]);
/// let turned = line.turned(FRAC_PI_2);
/// assert!(turned.control_points[1].truncate().distance(DVec2::Y) < 1e-15);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct RationalCrossSection {
    /// Homogeneous control points (w c₂, w c₃, w). Their number is one more than the degree.
    pub control_points: Vec<DVec3>,
}

impl RationalCrossSection {
    /// Creates a polynomial cross-section from control points with coordinates along r and s.
    pub fn polynomial(control_points: &[DVec2]) -> Self {
        Self { control_points: control_points.iter().map(|point| point.extend(1.0)).collect() }
    }

    /// Rotates the cross-section by `angle` radians about the spine.
    pub fn turned(&self, angle: f64) -> Self {
        let (sin, cos) = libm::sincos(angle);
        let control_points =
            self.control_points.iter().map(|p| DVec3::new(p.x * cos - p.y * sin, p.x * sin + p.y * cos, p.z)).collect();
        Self { control_points }
    }
}

/// A rational tensor-product Bézier patch over [0, 1]²: u along the cross-section, v along the
/// spine.
#[derive(Debug, Clone, PartialEq)]
pub struct RationalPatch {
    /// Homogeneous control points (w x, w y, w z, w). The index along v varies fastest.
    pub control_points: Vec<DVec4>,
    /// Degree in u: that of the cross-section.
    pub cross_section_degree: usize,
    /// Degree in v.
    pub spine_degree: usize,
}

/// A point of a surface with its first and second derivatives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceJet {
    /// Position, model units.
    pub position: DVec3,
    /// ∂/∂u.
    pub du: DVec3,
    /// ∂/∂v.
    pub dv: DVec3,
    /// ∂²/∂u².
    pub duu: DVec3,
    /// ∂²/∂u∂v.
    pub duv: DVec3,
    /// ∂²/∂v².
    pub dvv: DVec3,
}

impl SurfaceJet {
    /// Cosine of the angle between the parameter lines (equation 43). Zero if the frame is
    /// rotation-minimizing, and zero if the patch is singular.
    pub fn orthogonality(&self) -> f64 {
        let lengths = self.du.length() * self.dv.length();
        if lengths == 0.0 { 0.0 } else { self.du.dot(self.dv) / lengths }
    }

    /// Gaussian curvature, or `None` if the patch is singular.
    pub fn gaussian_curvature(&self) -> Option<f64> {
        let normal = self.du.cross(self.dv);
        let area = normal.length_squared();
        if area == 0.0 {
            return None;
        }
        let (l, m, n) = (normal.dot(self.duu), normal.dot(self.duv), normal.dot(self.dvv));
        Some((l * n - m * m) / (area * area))
    }
}

impl RationalPatch {
    /// Degree along the spine of a sweep along a Pythagorean-hodograph cubic.
    pub const SPINE_DEGREE: usize = 9;

    /// Sweeps `cross_section` along `cubic`. The frame is the Frenet frame rotated by `rotation`.
    /// The degree along the spine is 9.
    ///
    /// At v = 0, the axes of the cross-section are rotated by `initial_angle` from the Frenet
    /// normal and binormal. [`RationalRotation::FRENET`] gives the sweep with the Frenet frame. On
    /// a straight cubic, the constant frame [`PhCubic::frenet_frame`] replaces the Frenet frame.
    pub fn sweep(
        cubic: &PhCubic,
        rotation: &RationalRotation,
        cross_section: &RationalCrossSection,
        initial_angle: f64,
    ) -> Self {
        let cross_section = cross_section.turned(initial_angle - rotation.initial_angle);
        let hodograph = cubic.sides().map(|side| 3.0 * side);
        let speed = cubic.speed_coefficients();
        let [d0, d1, d2] = hodograph;
        let [s0, s1, s2] = speed;
        let (normal, binormal) = if cubic.is_straight() {
            let frame = cubic.frenet_frame(0.0);
            (speed.map(|s| frame.r * s), speed.map(|s| frame.s * s))
        } else {
            // Numerators of normal and binormal over the common denominator σ: σ x″ − σ′ x′ and x′
            // × x″, both divided by 6 L₂ sin θ and of degree two.
            let height = (d0 / s0).cross(d1).length() * 2.0;
            let normal = [2.0 * (s0 * d1 - s1 * d0), s0 * d2 - s2 * d0, 2.0 * (s1 * d2 - s2 * d1)];
            let binormal = [2.0 * d0.cross(d1), d0.cross(d2), 2.0 * d1.cross(d2)];
            (normal.map(|c| c / height), binormal.map(|c| c / height))
        };
        // With W = g/b: (1 − W²)/(1 + W²) = (b² − g²)/(b² + g²) and 2W/(1 + W²) = 2gb/(b² + g²).
        // These are the cosine and sine of the rotation Ω.
        let (g, b) = (rotation.numerator, rotation.denominator);
        let multiply = |a: f64, b: f64| a * b;
        let scale = |a: f64, v: DVec3| v * a;
        let squares = [product(&g, &g, multiply), product(&b, &b, multiply)];
        let sum: Vec<f64> = squares[0].iter().zip(&squares[1]).map(|(g, b)| g + b).collect();
        let difference: Vec<f64> = squares[0].iter().zip(&squares[1]).map(|(g, b)| b - g).collect();
        let twice: Vec<f64> = product(&g, &b, multiply).iter().map(|c| 2.0 * c).collect();
        let combine = |p: Vec<DVec3>, q: Vec<DVec3>, sign: f64| -> Vec<DVec3> {
            raise(&p.iter().zip(&q).map(|(&p, &q)| p + q * sign).collect::<Vec<_>>(), 3)
        };
        let common = product(&sum, &speed, multiply);
        let f2 = combine(product(&difference, &normal, scale), product(&twice, &binormal, scale), 1.0);
        let f3 = combine(product(&difference, &binormal, scale), product(&twice, &normal, scale), -1.0);
        let spine = product(&common, &cubic.control_points(), scale);
        let weights = raise(&common, 3);
        let control_points = cross_section
            .control_points
            .iter()
            .flat_map(|p| {
                let (spine, f2, f3, weights) = (&spine, &f2, &f3, &weights);
                (0..=Self::SPINE_DEGREE)
                    .map(move |k| (spine[k] * p.z + f2[k] * p.x + f3[k] * p.y).extend(weights[k] * p.z))
            })
            .collect();
        Self {
            control_points,
            cross_section_degree: cross_section.control_points.len() - 1,
            spine_degree: Self::SPINE_DEGREE,
        }
    }

    /// Position and derivatives at (u, v).
    pub fn jet(&self, u: f64, v: f64) -> SurfaceJet {
        let rows: Vec<&[DVec4]> = self.control_points.chunks(self.spine_degree + 1).collect();
        let along = |order: usize| -> Vec<DVec4> {
            rows.iter()
                .map(|row| {
                    let mut row = row.to_vec();
                    for _ in 0..order {
                        row = derivative(&row);
                    }
                    value(&row, v)
                })
                .collect()
        };
        let (h0, h1, h2) = (along(0), along(1), along(2));
        let (h, hu, huu) = (value(&h0, u), value(&derivative(&h0), u), value(&derivative(&derivative(&h0)), u));
        let (hv, huv, hvv) = (value(&h1, u), value(&derivative(&h1), u), value(&h2, u));
        // Derivatives of x = n/w by the quotient rule.
        let position = h.truncate() / h.w;
        let du = (hu.truncate() - position * hu.w) / h.w;
        let dv = (hv.truncate() - position * hv.w) / h.w;
        SurfaceJet {
            position,
            du,
            dv,
            duu: (huu.truncate() - 2.0 * du * hu.w - position * huu.w) / h.w,
            duv: (huv.truncate() - du * hv.w - dv * hu.w - position * huv.w) / h.w,
            dvv: (hvv.truncate() - 2.0 * dv * hv.w - position * hvv.w) / h.w,
        }
    }
}
