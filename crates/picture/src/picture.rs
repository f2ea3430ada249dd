//! Layout of the panels in a picture, and the pixels of the result.

use glam::DVec3;
use rayon::prelude::*;

use crate::camera::{Camera, View};
use crate::caption::Type;
use crate::error::PictureError;
use crate::panel::Panel;
use crate::shading::{Shading, Surface};

/// Largest width and height of a picture, pixels. Larger: a typing error requests all memory.
/// Smaller: posters are rejected.
const LARGEST_SIDE: usize = 16_384;
/// Largest number of samples of a picture, with the same trade-off.
const MOST_SAMPLES: usize = 200_000_000;

/// Linear RGB of the background at the top and at the bottom of each panel.
const BACKGROUND: [DVec3; 2] = [DVec3::new(0.93, 0.94, 0.95), DVec3::new(0.70, 0.72, 0.75)];
/// Linear RGB behind captions and between panels.
const PAPER: DVec3 = DVec3::new(0.93, 0.94, 0.95);
/// Linear RGB of caption text.
const INK: DVec3 = DVec3::new(0.03, 0.035, 0.045);

/// Size and quality of a picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Width of the whole picture, pixels.
    pub width: usize,
    /// Height of the whole picture, pixels, captions included.
    pub height: usize,
    /// Samples per pixel, in each direction.
    pub samples: usize,
    /// Angle in degrees: an edge is shaded as a crease if its two faces differ by more than this.
    pub crease_angle: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self { width: 1600, height: 860, samples: 3, crease_angle: 55.0 }
    }
}

/// A rendered picture: sRGB pixels, row by row from the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    width: usize,
    height: usize,
    pixels: Vec<[u8; 3]>,
}

impl Picture {
    /// Width, pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height, pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The pixels, row by row from the top, sRGB.
    pub fn pixels(&self) -> &[[u8; 3]] {
        &self.pixels
    }

    /// Encodes the picture as a PNG file.
    pub fn to_png(&self) -> Vec<u8> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        encoder
            .write_header()
            .and_then(|mut writer| writer.write_image_data(self.pixels.as_flattened()))
            .expect("the size is valid, and writing to memory cannot fail");
        file
    }
}

/// Renders `panels` side by side with one camera.
///
/// Triangles are skipped if a coordinate is not finite, if their area is zero, or if they are
/// behind the eye.
///
/// # Errors
/// - [`PictureError::Size`] if the picture is empty or too large.
/// - [`PictureError::Panels`] if `panels` is empty or the panels do not fit.
/// - [`PictureError::Index`] if a triangle uses a vertex that does not exist.
/// - [`PictureError::Colors`] if a list of colors does not have one color per element.
///
/// # Examples
/// ```
/// use isochore_mesh::primitives;
/// use isochore_picture::{Body, Camera, Options, Panel, render};
///
/// let (before, after) = (primitives::icosphere(1.0, 2), primitives::icosphere(1.2, 2));
/// let panels = [Panel::new("before").with(Body::new(&before)), Panel::new("after").with(Body::new(&after))];
/// let options = Options { width: 160, height: 90, ..Options::default() };
/// let picture = render(&panels, &Camera::default(), &options)?;
/// assert_eq!(picture.pixels().len(), 160 * 90);
/// # Ok::<(), isochore_picture::PictureError>(())
/// ```
pub fn render(panels: &[Panel], camera: &Camera, options: &Options) -> Result<Picture, PictureError> {
    let layout = Layout::of(panels, options)?;
    let surfaces = panels
        .iter()
        .enumerate()
        .map(|(index, panel)| Surface::of(index, panel, options.crease_angle))
        .collect::<Result<Vec<_>, _>>()?;

    let everything = surfaces.iter().flat_map(Surface::used_positions);
    let aspect = layout.panel_width as f64 / layout.panel_height as f64;
    let view = match camera.bounds {
        Some(bounds) => View::fit(camera, bounds.corners().into_iter(), aspect),
        None => View::fit(camera, everything, aspect),
    };

    let mut picture = Picture {
        width: options.width,
        height: options.height,
        pixels: vec![to_srgb(PAPER); options.width * options.height],
    };
    let rendered: Vec<Vec<DVec3>> = surfaces
        .par_iter()
        .map(|surface| {
            let size = [layout.panel_width, layout.panel_height];
            Shading::new(surface, &view, size, options.samples).pixels(&backdrop)
        })
        .collect();
    for (index, (panel, colors)) in panels.iter().zip(rendered).enumerate() {
        layout.copy_pixels(index, &colors, &mut picture);
        layout.write_caption(index, &panel.caption, &mut picture);
    }
    Ok(picture)
}

/// Positions of the panels in the picture.
struct Layout {
    panel_width: usize,
    panel_height: usize,
    lettering: Type,
}

impl Layout {
    /// Width of the gap between panels, pixels.
    const GAP: usize = 2;

    fn of(panels: &[Panel], options: &Options) -> Result<Self, PictureError> {
        let &Options { width, height, samples, .. } = options;
        let fits = (1..=LARGEST_SIDE).contains(&width)
            && (1..=LARGEST_SIDE).contains(&height)
            && (1..=MOST_SAMPLES / (width * height)).contains(&(samples.saturating_mul(samples)));
        if !fits {
            return Err(PictureError::Size { width, height, samples });
        }
        let do_not_fit = PictureError::Panels { panels: panels.len() };
        let gaps = Self::GAP * panels.len().saturating_sub(1);
        let panel_width = width.saturating_sub(gaps).checked_div(panels.len()).ok_or(do_not_fit.clone())?;
        let lettering = Type::for_width(panel_width);
        let caption_height = panels.iter().map(|panel| lettering.height_of(&panel.caption)).max().unwrap_or(0);
        let panel_height = height.saturating_sub(caption_height);
        if panel_width == 0 || panel_height == 0 {
            return Err(do_not_fit);
        }
        Ok(Self { panel_width, panel_height, lettering })
    }

    /// Column of the left edge of a panel.
    fn left(&self, panel: usize) -> usize {
        panel * (self.panel_width + Self::GAP)
    }

    fn copy_pixels(&self, panel: usize, colors: &[DVec3], picture: &mut Picture) {
        for (row, colors) in colors.chunks_exact(self.panel_width).enumerate() {
            let start = row * picture.width + self.left(panel);
            for (pixel, &color) in picture.pixels[start..start + self.panel_width].iter_mut().zip(colors) {
                *pixel = to_srgb(color);
            }
        }
    }

    fn write_caption(&self, panel: usize, caption: &str, picture: &mut Picture) {
        self.lettering.set(caption, self.panel_width, |column, row, coverage| {
            let (x, y) = (self.left(panel) + column, self.panel_height + row);
            if let Some(pixel) = picture.pixels.get_mut(y * picture.width + x) {
                *pixel = to_srgb(PAPER.lerp(INK, coverage));
            }
        });
    }
}

/// Background color at a relative height, from 0 at the top of the panel to 1 at the bottom.
fn backdrop(height: f64) -> DVec3 {
    BACKGROUND[0].lerp(BACKGROUND[1], height * height)
}

/// Converts linear RGB to sRGB (IEC 61966-2-1).
fn to_srgb(color: DVec3) -> [u8; 3] {
    color.to_array().map(|linear| {
        let linear = linear.clamp(0.0, 1.0);
        let encoded = if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * libm::pow(linear, 1.0 / 2.4) - 0.055 };
        (255.0 * encoded + 0.5) as u8
    })
}

#[cfg(test)]
mod tests {
    use glam::DQuat;
    use isochore_mesh::TriMesh;

    use super::*;
    use crate::{Body, Paint};

    const SMALL: Options = Options { width: 200, height: 100, samples: 2, crease_angle: 55.0 };

    /// A unit square centered at the origin that faces the default camera.
    fn square() -> TriMesh {
        let turn = DQuat::from_rotation_arc(DVec3::Z, Camera::default().direction.normalize());
        TriMesh {
            positions: [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5)]
                .map(|(x, y)| turn * DVec3::new(x, y, 0.0))
                .to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..TriMesh::default()
        }
    }

    #[test]
    fn nearer_body_hides_the_farther_one_in_either_order() {
        let far = square();
        let mut near = square();
        for position in &mut near.positions {
            *position = 0.2 * *position + Camera::default().direction.normalize();
        }
        let [green, red] = [DVec3::Y, DVec3::X].map(Paint::Uniform);
        let bodies = [Body::new(&far).with_paint(green), Body::new(&near).with_paint(red)];
        for order in [[0, 1], [1, 0]] {
            let panel = order.iter().fold(Panel::new(""), |panel, &body| panel.with(bodies[body].clone()));
            let picture = render(&[panel], &Camera::default(), &SMALL).unwrap();
            let [r, g, _] = picture.pixels()[50 * 200 + 100];
            assert!(r > 100 && g < r / 2, "{order:?}: {r} {g}");
        }
    }

    #[test]
    fn panels_use_one_camera() {
        let small = square();
        let mut large = square();
        large.positions.iter_mut().for_each(|position| *position *= 10.0);
        let panels = [Panel::new("").with(Body::new(&small)), Panel::new("").with(Body::new(&large))];
        let picture = render(&panels, &Camera::default(), &SMALL).unwrap();
        let covered = |from: usize, to: usize| {
            let is_clay = |pixel: &[u8; 3]| pixel[0] > pixel[2].saturating_add(20);
            (0..100).map(|y| picture.pixels()[y * 200 + from..y * 200 + to].iter().filter(|p| is_clay(p)).count()).sum()
        };
        let (small, large): (usize, usize) = (covered(0, 99), covered(101, 200));
        // The area ratio is 100. The small square covers about 8 x 8 pixels, each edge uncertain by
        // one pixel.
        assert!(large > 60 * small && large < 160 * small, "{small} {large}");
    }

    #[test]
    fn picture_does_not_depend_on_the_number_of_threads() {
        let mesh = square();
        let panels = [Panel::new("before").with(Body::new(&mesh)), Panel::new("after\n50 %").with(Body::new(&mesh))];
        let files = [1, 2, 8].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| render(&panels, &Camera::default(), &SMALL).unwrap().to_png())
        });
        assert!(files[0] == files[1] && files[0] == files[2]);
    }

    #[test]
    fn caption_is_written_below_the_panel() {
        let picture = render(&[Panel::new("caption")], &Camera::default(), &SMALL).unwrap();
        let darkest = |rows: std::ops::Range<usize>| {
            picture.pixels()[rows.start * 200..rows.end * 200].iter().map(|pixel| pixel[0]).min().unwrap()
        };
        assert!(darkest(70..100) < 100);
        assert!(darkest(0..68) > 150);
    }

    #[test]
    fn errors_name_the_invalid_input() {
        let mut mesh = square();
        let camera = Camera::default();
        let none = Options { width: 0, ..SMALL };
        assert!(matches!(render(&[], &camera, &none), Err(PictureError::Size { width: 0, .. })));
        assert!(matches!(render(&[], &camera, &SMALL), Err(PictureError::Panels { panels: 0 })));
        let huge = Options { samples: usize::MAX, ..SMALL };
        assert!(matches!(render(&[Panel::default()], &camera, &huge), Err(PictureError::Size { .. })));

        let colors = [DVec3::ONE; 3];
        let painted = Panel::default().with(Body::new(&mesh).with_paint(Paint::Vertices(&colors)));
        let expected = PictureError::Colors { panel: 0, body: 0, colors: 3, elements: 4 };
        assert_eq!(render(&[painted], &camera, &SMALL), Err(expected));

        mesh.triangles[1][2] = 9;
        let broken = Panel::default().with(Body::new(&mesh));
        let expected = PictureError::Index { panel: 0, body: 0, triangle: 1, vertex: 9 };
        assert_eq!(render(&[broken], &camera, &SMALL), Err(expected));
    }

    #[test]
    fn extreme_coordinates_do_not_panic() {
        let huge = f64::MAX;
        let odd = [DVec3::NAN, DVec3::splat(f64::INFINITY), DVec3::splat(huge), DVec3::splat(-huge), DVec3::ZERO];
        for a in odd {
            for b in odd {
                let mut mesh = square();
                mesh.positions[0] = a;
                mesh.positions[3] = b;
                let panel = Panel::default().with(Body::new(&mesh));
                render(&[panel], &Camera::default(), &SMALL).unwrap();
                let camera = Camera { direction: a, up: b, field_of_view: a.x, ..Camera::default() };
                render(&[Panel::default().with(Body::new(&square()))], &camera, &SMALL).unwrap();
            }
        }
    }
}
