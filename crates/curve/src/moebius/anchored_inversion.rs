//! Inversions given by a fixed point instead of their center.

use glam::{DVec3, DVec4};

use crate::CurveJet;
use crate::bernstein::{product, raise};

/// The inversion about a center f that fixes the point `anchor`. The formulas remain valid if f is
/// infinitely far; the inversion is then a reflection in a plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct AnchoredInversion {
    /// Fixed point.
    pub(super) anchor: DVec3,
    /// Unit vector from f to the anchor.
    pub(super) direction: DVec3,
    /// One over the distance from f to the anchor.
    pub(super) nearness: f64,
}

impl AnchoredInversion {
    /// Numerator and denominator of image − anchor, with w = point − anchor.
    fn quotient(&self, w: DVec3) -> (DVec3, f64) {
        let (e, k) = (self.direction, self.nearness);
        let along = e.dot(w);
        let squared = w.dot(w);
        (w - e * (2.0 * along + k * squared), 1.0 + k * (2.0 * along + k * squared))
    }

    /// Image of a point.
    pub(super) fn point(&self, point: DVec3) -> DVec3 {
        let (numerator, denominator) = self.quotient(point - self.anchor);
        self.anchor + numerator / denominator
    }

    /// Applies the normalized differential at `point`: a reflection along the ray from f.
    pub(super) fn vector(&self, point: DVec3, vector: DVec3) -> DVec3 {
        let ray = self.direction + (point - self.anchor) * self.nearness;
        vector - ray * (2.0 * ray.dot(vector) / ray.length_squared())
    }

    /// Image of a point of a curve with its derivatives.
    pub(super) fn jet(&self, jet: &CurveJet) -> CurveJet {
        let (e, k) = (self.direction, self.nearness);
        let w = jet.position - self.anchor;
        // x = n/q with n = w − e m, q = 1 + k m and m = 2 e·w + k w·w. The derivatives follow from
        // the quotient rule.
        let m = [
            2.0 * e.dot(w) + k * w.dot(w),
            2.0 * e.dot(jet.first) + 2.0 * k * w.dot(jet.first),
            2.0 * e.dot(jet.second) + 2.0 * k * (jet.first.dot(jet.first) + w.dot(jet.second)),
            2.0 * e.dot(jet.third) + 2.0 * k * (3.0 * jet.first.dot(jet.second) + w.dot(jet.third)),
        ];
        let q = 1.0 + k * m[0];
        let x0 = (w - e * m[0]) / q;
        let x1 = (jet.first - e * m[1] - x0 * (k * m[1])) / q;
        let x2 = (jet.second - e * m[2] - x1 * (2.0 * k * m[1]) - x0 * (k * m[2])) / q;
        let x3 = (jet.third - e * m[3] - x2 * (3.0 * k * m[1]) - x1 * (3.0 * k * m[2]) - x0 * (k * m[3])) / q;
        CurveJet { position: self.anchor + x0, first: x1, second: x2, third: x3 }
    }

    /// Homogeneous control points (w x, w y, w z, w) of the image of a cubic.
    pub(super) fn control_points(&self, cubic: &[DVec3; 4]) -> [DVec4; 7] {
        let (e, k) = (self.direction, self.nearness);
        let w: Vec<DVec3> = cubic.iter().map(|&point| point - self.anchor).collect();
        let along: Vec<f64> = raise(&w.iter().map(|&w| e.dot(w)).collect::<Vec<_>>(), 3);
        let squared = product(&w, &w, |a, b| a.dot(b));
        let w = raise(&w, 3);
        std::array::from_fn(|i| {
            let weight = 1.0 + k * (2.0 * along[i] + k * squared[i]);
            let offset = w[i] - e * (2.0 * along[i] + k * squared[i]);
            (self.anchor * weight + offset).extend(weight)
        })
    }
}
