//! A user-defined field that swirls a ball of space about its center. Measures its flux, the
//! Jacobian of its flow map and the change of volume of a mesh.

#![expect(clippy::print_stdout, reason = "the measurements are the result")]

use std::{error::Error, sync::Arc};

use glam::DVec3;
use isochore_examples::{relative_flux, save_mesh};
use isochore_field::{
    DeformOptions, Field, FieldBlock, FieldStroke, NO_CORE, SteadyField, Stroke, WeightedPotential, deform,
};
use isochore_mesh::{Aabb, LANES, NoProgress, PointBlock, primitives};

const CENTER: DVec3 = DVec3::Z;
const RADIUS: f64 = 0.8;
const ANGULAR: DVec3 = DVec3::new(2.0, 0.0, 0.0);

/// V = curl(s P) with P = −½|x|² ω, the potential of a rigid rotation, and the falloff
/// s = (1 − |x|²/R²)³.
#[derive(Debug, Clone)]
struct Swirl;

impl Field for Swirl {
    fn evaluate_into(&self, points: &PointBlock, out: &mut FieldBlock) {
        for lane in 0..LANES {
            let x = points.get(lane) - CENTER;
            let base = (1.0 - x.length_squared() / RADIUS.powi(2)).max(0.0);
            // V = s curl P + ∇s × P, and curl P = ω × x.
            let product = WeightedPotential {
                weight: base.powi(3),
                gradient: -6.0 * base.powi(2) / RADIUS.powi(2) * x,
                potential: -0.5 * x.length_squared() * ANGULAR,
                curl: ANGULAR.cross(x),
            };
            out.set_inside(lane, product, NO_CORE);
        }
    }
    fn bounds(&self) -> Aabb {
        Aabb { min: CENTER - RADIUS, max: CENTER + RADIUS }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let flux = relative_flux(|point| Swirl.velocity(point), DVec3::new(0.3, 0.2, 0.9), 0.5);
    println!("net flux through a sphere: {flux:.1e} of the absolute flux");

    let sphere = primitives::icosphere(1.0, 4);
    // The field does not change with time. Its speed is at most that of the rotation at the edge.
    let field = SteadyField { field: Swirl, core_speed: ANGULAR.length() * RADIUS, feature_size: RADIUS };
    let stroke = Stroke::Field(FieldStroke::new(vec![Arc::new(field)], 0.125)?);
    // Without the volume lock, the measurements show the flow alone.
    let options = DeformOptions { lock: false, ..DeformOptions::default() };
    let deformed = deform(&sphere, &[stroke], &options, &NoProgress)?;
    let jacobian = deformed.receipt.strokes[0].jacobian.ok_or("the stroke has no Jacobian")?;
    println!("Jacobian of the flow map: between {:.9} and {:.9}", jacobian.min, jacobian.max);
    println!("relative change of volume: {:+.1e}", deformed.mesh.volume() / sphere.volume() - 1.0);
    save_mesh("custom_field", &deformed.mesh)
}
