//! Velocity arrows on a section through a field: red inside the tool, blue outside, green for the
//! motion of the tool (figures 11.2 to 11.5 and the upper half of 12.6 of Zheng's thesis). Arrows
//! of a free-form tool are colored by speed (figure 12.1).

use std::error::Error;

use glam::DVec3;
use isochore_examples::{save_picture, scale_color, scene};
use isochore_field::{Field, FieldBlock, Stroke};
use isochore_mesh::{Aabb, LANES, PointBlock};
use isochore_picture::{Body, Camera, Options, Panel};

const RED: DVec3 = DVec3::new(0.75, 0.03, 0.02);
const BLUE: DVec3 = DVec3::new(0.03, 0.10, 0.65);
const GREEN: DVec3 = DVec3::new(0.02, 0.45, 0.04);

/// Number of arrows along the longer side of a section.
const ARROWS: f64 = 42.0;

/// Speed, as a fraction of the largest, below which no arrow is drawn. Larger hides the outer
/// field; smaller draws dots.
const SLOWEST: f64 = 0.02;

/// Number of colors for speeds.
const COLORS: usize = 12;

/// A field on a plane through the center of its support.
struct Figure {
    name: &'static str,
    recipe: &'static str,
    /// Index of the motion between two keys.
    leg: usize,
    time: f64,
    /// Normal of the section, toward the viewer.
    normal: DVec3,
    colors: Colors,
}

#[derive(Clone, Copy, PartialEq)]
enum Colors {
    BySide,
    BySpeed,
}

const FIGURES: [Figure; 6] = [
    Figure {
        name: "field_sphere",
        recipe: "sphere",
        leg: 0,
        time: 0.5,
        normal: DVec3::new(2.0, 1.0, 0.0),
        colors: Colors::BySide,
    },
    Figure {
        name: "field_strip_along",
        recipe: "strip_along",
        leg: 0,
        time: 0.5,
        normal: DVec3::new(1.0, -2.0, 0.0),
        colors: Colors::BySide,
    },
    Figure {
        name: "field_strip_across",
        recipe: "strip_across",
        leg: 0,
        time: 0.5,
        normal: DVec3::X,
        colors: Colors::BySide,
    },
    Figure { name: "field_ring", recipe: "ring", leg: 0, time: 0.5, normal: DVec3::NEG_Y, colors: Colors::BySide },
    Figure { name: "field_knight", recipe: "knight", leg: 0, time: 0.5, normal: DVec3::NEG_Y, colors: Colors::BySpeed },
    Figure { name: "field_rod", recipe: "rod", leg: 1, time: 0.5, normal: DVec3::Z, colors: Colors::BySide },
];

fn main() -> Result<(), Box<dyn Error>> {
    for figure in &FIGURES {
        draw(figure)?;
    }
    Ok(())
}

fn draw(figure: &Figure) -> Result<(), Box<dyn Error>> {
    let scene = scene(figure.recipe)?;
    let fields = match &scene.strokes[0] {
        Stroke::Move(stroke) => stroke.fields(),
        Stroke::Field(stroke) => stroke.fields().cloned().collect(),
        _ => return Err("a twist or bend acts on all of space and has no section".into()),
    };
    let field = fields[figure.leg].at(figure.time);
    let normal = figure.normal.normalize();
    let spacing = spacing(field.bounds(), normal);
    let samples = section(&*field, normal, spacing);
    let fastest = samples.iter().map(|sample| sample.velocity.length()).fold(0.0, f64::max);
    let arrow = |sample: &Sample| {
        let half = 0.65 * spacing / fastest * sample.velocity;
        (sample.point - half, sample.point + half)
    };
    let seen = || samples.iter().filter(|sample| sample.velocity.length() > SLOWEST * fastest);
    let body = |color: DVec3, is_included: &dyn Fn(&Sample) -> bool| {
        let arrows: Vec<_> = seen().filter(|sample| is_included(sample)).map(arrow).collect();
        Body::arrows(&arrows, 0.06 * spacing, color)
    };
    let caption = format!("largest speed: {:.3} of the speed of the tool", fastest / core_speed(&samples));
    let mut panel = Panel::new(caption);
    match figure.colors {
        Colors::BySide => {
            panel = panel.with(body(RED, &|sample| sample.is_inside)).with(body(BLUE, &|sample| !sample.is_inside));
            if let Some((center, motion)) = motion(&samples, normal) {
                let size = ARROWS * spacing;
                let start = center + 0.02 * size * normal;
                let arrow = [(start, start + 0.3 * size * motion)];
                panel = panel.with(Body::arrows(&arrow, 0.008 * size, GREEN));
            }
        }
        Colors::BySpeed => {
            for color in 0..COLORS {
                let class = |sample: &Sample| (COLORS as f64 * sample.velocity.length() / fastest) as usize;
                let is_in_class = |sample: &Sample| class(sample).min(COLORS - 1) == color;
                panel = panel.with(body(scale_color(color as f64 / (COLORS - 1) as f64), &is_in_class));
            }
        }
    }
    let options = Options { width: 1100, height: 900, ..Options::default() };
    save_picture(figure.name, &[panel], &Camera { direction: normal, ..Camera::default() }, &options)
}

struct Sample {
    point: DVec3,
    velocity: DVec3,
    is_inside: bool,
}

/// Distance between arrows on the plane through the center of `bounds`.
fn spacing(bounds: Aabb, normal: DVec3) -> f64 {
    let (across, up) = normal.any_orthonormal_pair();
    [across, up].map(|axis| axis.abs().dot(bounds.size())).into_iter().fold(0.0, f64::max) / ARROWS
}

/// Samples of the field, where it is nonzero, on a grid in the plane through the center of its
/// support.
fn section(field: &dyn Field, normal: DVec3, spacing: f64) -> Vec<Sample> {
    let bounds = field.bounds();
    let reach = (0.5 * bounds.size().length() / spacing).ceil() as i32;
    let (across, up) = normal.any_orthonormal_pair();
    let points: Vec<DVec3> = (-reach..=reach)
        .flat_map(|i| (-reach..=reach).map(move |j| spacing * (f64::from(i) * across + f64::from(j) * up)))
        .map(|offset| bounds.center() + offset)
        .collect();
    let mut samples = Vec::new();
    for points in points.chunks(LANES) {
        let mut block = FieldBlock::ZERO;
        field.evaluate_into(&PointBlock::gather(points), &mut block);
        for (lane, &point) in points.iter().enumerate() {
            let velocity = block.velocity.get(lane);
            if velocity != DVec3::ZERO {
                samples.push(Sample { point, velocity, is_inside: block.weight.value[lane] == 1.0 });
            }
        }
    }
    samples
}

/// Largest speed inside the tool.
fn core_speed(samples: &[Sample]) -> f64 {
    samples.iter().filter(|sample| sample.is_inside).map(|sample| sample.velocity.length()).fold(0.0, f64::max)
}

/// Center of the tool in the section and its mean direction of motion. `None` if the tool only
/// rotates or moves along the normal.
fn motion(samples: &[Sample], normal: DVec3) -> Option<(DVec3, DVec3)> {
    let (mut center, mut velocity, mut count) = (DVec3::ZERO, DVec3::ZERO, 0.0);
    for sample in samples.iter().filter(|sample| sample.is_inside) {
        center += sample.point;
        velocity += sample.velocity.reject_from_normalized(normal);
        count += 1.0;
    }
    let count = f64::max(count, 1.0);
    (velocity.length() > 0.1 * count * core_speed(samples)).then(|| (center / count, velocity.normalize()))
}
