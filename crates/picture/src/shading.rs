//! Shading: a key light from the upper left, a headlight, sky light, and ambient obscurance.

use std::sync::LazyLock;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use crate::camera::{Projected, View};
use crate::error::PictureError;
use crate::fragments::{Fragment, Fragments};
use crate::normals::corner_normals;
use crate::panel::{Body, Paint, Panel};

/// Direction toward the key light, in view coordinates.
const KEY: DVec3 = DVec3::new(-0.62, 0.62, 0.48);
/// Intensities of the lights; those from above and below are linear RGB.
const KEY_LIGHT: f64 = 0.95;
const HEAD_LIGHT: f64 = 0.27;
const SKY_LIGHT: DVec3 = DVec3::new(0.36, 0.39, 0.44);
const GROUND_LIGHT: DVec3 = DVec3::new(0.17, 0.14, 0.13);

/// Intensity of the highlight, and of the sheen at grazing angles.
const GLOSS: f64 = 0.10;
const SHEEN: f64 = 0.03;

/// Color of the inside of a surface, visible through holes, for every paint.
const INSIDE: Vec3 = Vec3::new(0.22, 0.26, 0.34);

/// Radius of the search for occluders, relative to the subject's radius. Larger: shade spreads over
/// flat areas. Smaller: wide hollows stay bright.
const HOLLOW_REACH: f64 = 0.14;
/// Points probed around each pixel. More cost time; fewer show bands.
const HOLLOW_PROBES: usize = 40;
/// Strength of the shade in hollows.
const HOLLOW_SHADE: f64 = 1.5;
/// Sine of the smallest elevation above the tangent plane that counts. Smaller: facets become
/// visible. Larger: shallow dents stay bright.
const SMALLEST_RISE: f64 = 0.12;

/// All bodies of a panel as one list of triangles, with normals and colors at their corners.
pub(crate) struct Surface {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    normals: Vec<[Vec3; 3]>,
    colors: Vec<[Vec3; 3]>,
}

impl Surface {
    /// Collects the bodies of `panel`, which has number `index`.
    pub(crate) fn of(index: usize, panel: &Panel, crease_angle: f64) -> Result<Self, PictureError> {
        let mut surface = Self { positions: vec![], triangles: vec![], normals: vec![], colors: vec![] };
        for (number, body) in panel.bodies.iter().enumerate() {
            check(index, number, body)?;
            surface.append(body, crease_angle);
        }
        Ok(surface)
    }

    fn append(&mut self, body: &Body, crease_angle: f64) {
        let mesh = body.mesh.as_ref();
        let normals = corner_normals(mesh, crease_angle);
        let start = self.positions.len() as u32;
        for ((index, triangle), normals) in mesh.triangles.iter().enumerate().zip(normals) {
            if !triangle.iter().all(|&vertex| mesh.positions[vertex as usize].is_finite()) {
                continue;
            }
            self.triangles.push(triangle.map(|vertex| start + vertex));
            self.normals.push(normals.map(|normal| normal.as_vec3()));
            self.colors.push(match body.paint {
                Paint::Uniform(color) => [color.as_vec3(); 3],
                Paint::Vertices(colors) => triangle.map(|vertex| colors[vertex as usize].as_vec3()),
                Paint::Triangles(colors) => [colors[index].as_vec3(); 3],
            });
        }
        self.positions.extend_from_slice(&mesh.positions);
    }

    /// Positions of all triangle corners.
    pub(crate) fn used_positions(&self) -> impl Iterator<Item = DVec3> + Clone {
        self.triangles.as_flattened().iter().map(|&vertex| self.positions[vertex as usize])
    }
}

/// Checks that all indices of a body are valid and that it has one color per element.
fn check(panel: usize, number: usize, body: &Body) -> Result<(), PictureError> {
    let mesh = body.mesh.as_ref();
    for (triangle, vertices) in mesh.triangles.iter().enumerate() {
        if let Some(&vertex) = vertices.iter().find(|&&vertex| vertex as usize >= mesh.positions.len()) {
            return Err(PictureError::Index { panel, body: number, triangle, vertex });
        }
    }
    let (colors, elements) = match body.paint {
        Paint::Uniform(_) => return Ok(()),
        Paint::Vertices(colors) => (colors.len(), mesh.positions.len()),
        Paint::Triangles(colors) => (colors.len(), mesh.triangles.len()),
    };
    if colors == elements { Ok(()) } else { Err(PictureError::Colors { panel, body: number, colors, elements }) }
}

/// The shading of one panel.
pub(crate) struct Shading<'a> {
    surface: &'a Surface,
    view: &'a View,
    projected: Vec<Projected>,
    fragments: Fragments,
    width: usize,
    height: usize,
    samples: usize,
}

/// A visible point of the surface, in view coordinates.
struct SurfacePoint {
    position: DVec3,
    normal: DVec3,
    color: DVec3,
}

impl<'a> Shading<'a> {
    /// Determines the visible points of `surface` in a panel of `width` by `height` pixels.
    pub(crate) fn new(surface: &'a Surface, view: &'a View, [width, height]: [usize; 2], samples: usize) -> Self {
        let projected: Vec<Projected> = surface.positions.par_iter().map(|&position| view.project(position)).collect();
        let fragments = Fragments::draw(view, &projected, &surface.triangles, [width * samples, height * samples]);
        Self { surface, view, projected, fragments, width, height, samples }
    }

    /// Linear RGB of the pixels, row by row from the top. `background` gives the background color
    /// at a relative height, from 0 at the top to 1 at the bottom.
    pub(crate) fn pixels(&self, background: &(dyn Fn(f64) -> DVec3 + Sync)) -> Vec<DVec3> {
        let rows: Vec<Vec<DVec3>> = (0..self.height)
            .into_par_iter()
            .map(|row| {
                let background = background((row as f64 + 0.5) / self.height as f64);
                (0..self.width).map(|column| self.pixel(column, row, background)).collect()
            })
            .collect();
        rows.concat()
    }

    fn pixel(&self, column: usize, row: usize, background: DVec3) -> DVec3 {
        let mut sum = DVec3::ZERO;
        // Hollows are wider than a pixel, so one search serves all samples of the pixel.
        let mut openness = None;
        for sample_row in row * self.samples..(row + 1) * self.samples {
            for sample_column in column * self.samples..(column + 1) * self.samples {
                sum += match self.point(sample_column, sample_row) {
                    Some(point) => {
                        let openness =
                            *openness.get_or_insert_with(|| self.openness(sample_column, sample_row, &point));
                        light(&point, openness)
                    }
                    None => background,
                };
            }
        }
        sum / (self.samples * self.samples) as f64
    }

    fn fragment(&self, column: usize, row: usize) -> Option<Fragment> {
        self.fragments.row(row)[column]
    }

    /// Barycentric weights of a fragment on the surface: those on the picture plane, divided by
    /// depth.
    fn weights_in_space(&self, fragment: &Fragment) -> [f64; 3] {
        let triangle = self.surface.triangles[fragment.triangle as usize];
        let weights: [f64; 3] = std::array::from_fn(|i| {
            f64::from(fragment.weights[i].max(0.0)) / self.projected[triangle[i] as usize].depth
        });
        let sum = weights[0] + weights[1] + weights[2];
        weights.map(|weight| weight / sum)
    }

    fn point(&self, column: usize, row: usize) -> Option<SurfacePoint> {
        let fragment = self.fragment(column, row)?;
        let weights = self.weights_in_space(&fragment);
        let index = fragment.triangle as usize;
        let mix = |values: &[Vec3; 3]| {
            values.iter().zip(weights).fold(DVec3::ZERO, |sum, (value, weight)| sum + weight * value.as_dvec3())
        };
        let position = self.position(column, row, &fragment);
        let normal = self.view.turned(mix(&self.surface.normals[index])).normalize_or(DVec3::Z);
        let [a, b, c] =
            self.surface.triangles[index].map(|vertex| self.view.local(self.surface.positions[vertex as usize]));
        let seen_from_outside = (b - a).cross(c - a).dot(position) <= 0.0;
        Some(if seen_from_outside {
            SurfacePoint { position, normal, color: mix(&self.surface.colors[index]) }
        } else {
            SurfacePoint { position, normal: -normal, color: INSIDE.as_dvec3() }
        })
    }

    fn position(&self, column: usize, row: usize, fragment: &Fragment) -> DVec3 {
        let triangle = self.surface.triangles[fragment.triangle as usize];
        let nearness = (0..3)
            .fold(0.0, |sum, i| sum + f64::from(fragment.weights[i]) / self.projected[triangle[i] as usize].depth);
        let plane = [
            2.0 * (column as f64 + 0.5) / self.fragments.width as f64 - 1.0,
            1.0 - 2.0 * (row as f64 + 0.5) / self.fragments.height as f64,
        ];
        self.view.unproject(plane, 1.0 / nearness)
    }

    /// Openness of the sky above a visible point, from 0 to 1.
    ///
    /// Probes the surface at points on a spiral around the pixel and sums how far each rises above
    /// the tangent plane.
    ///
    /// Source: M. McGuire et al., The Alchemy screen-space ambient obscurance algorithm, 2011.
    /// Deviation: a fixed spiral replaces the random directions, so no noise has to be filtered.
    fn openness(&self, column: usize, row: usize, point: &SurfacePoint) -> f64 {
        let reach = HOLLOW_REACH * self.view.radius;
        let reach_in_samples = self.view.fraction_of_height(reach, -point.position.z) * self.fragments.height as f64;
        let mut closed = 0.0;
        for (direction, distance) in SPIRAL.iter() {
            let x = column as f64 + reach_in_samples * distance * direction[0];
            let y = row as f64 + reach_in_samples * distance * direction[1];
            if x < 0.0 || y < 0.0 || x >= self.fragments.width as f64 || y >= self.fragments.height as f64 {
                continue;
            }
            let (x, y) = (x as usize, y as usize);
            if let Some(fragment) = self.fragment(x, y) {
                let toward = self.position(x, y, &fragment) - point.position;
                let length = toward.length().max(1e-9 * reach);
                let rise = (toward.dot(point.normal) / length - SMALLEST_RISE).max(0.0);
                let fade = (1.0 - length * length / (reach * reach)).max(0.0);
                closed += rise * fade;
            }
        }
        (1.0 - HOLLOW_SHADE * closed * 2.0 / HOLLOW_PROBES as f64).clamp(0.0, 1.0)
    }
}

/// Directions and relative distances of the probes, each covering an equal area of a disk.
static SPIRAL: LazyLock<Vec<([f64; 2], f64)>> = LazyLock::new(|| {
    let golden_angle = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    (0..HOLLOW_PROBES)
        .map(|probe| {
            let (sine, cosine) = libm::sincos(golden_angle * probe as f64);
            ([cosine, sine], ((probe as f64 + 0.5) / HOLLOW_PROBES as f64).sqrt())
        })
        .collect()
});

/// Linear RGB of a visible point with the given openness of the sky, from 0 to 1.
fn light(point: &SurfacePoint, openness: f64) -> DVec3 {
    let toward_eye = -point.position.normalize();
    let key = KEY.normalize();
    let facing_key = point.normal.dot(key).max(0.0);
    let facing_eye = point.normal.dot(toward_eye).max(0.0);

    let sky = GROUND_LIGHT.lerp(SKY_LIGHT, 0.5 + 0.5 * point.normal.y);
    // Hollows receive no sky light but part of the directed light, because their walls reflect it.
    let directed = 0.45 + 0.55 * openness;
    let matte = sky * openness + DVec3::splat(directed * (KEY_LIGHT * facing_key + HEAD_LIGHT * facing_eye));

    let half = (key + toward_eye).normalize();
    let highlight = GLOSS * squared_times(point.normal.dot(half).max(0.0), 5);
    let sheen = SHEEN * openness * squared_times(1.0 - facing_eye, 2);
    point.color * matte + DVec3::splat(openness * highlight + sheen)
}

/// Squares `value` repeatedly, `times` times.
fn squared_times(value: f64, times: usize) -> f64 {
    (0..times).fold(value, |value, _| value * value)
}
