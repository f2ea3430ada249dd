//! The pictures of the guide, and the table of what their recipes measured.

use std::{
    fmt::Write as _,
    fs::{self, File},
    io::{BufReader, BufWriter},
    path::Path,
    process::Command,
};

use serde_json::Value;

use crate::{
    marked_table::Markers,
    shell::{TaskResult, cargo, run, target, workspace},
};

/// Choices that the guide explains, each with a recipe that shows a mistake and one that cures it.
const CHOICES: [&str; 5] = ["tool", "support", "profile", "step", "refinement"];

/// Recipes of `data/recipes` whose previews the documents show as they are.
const PREVIEWS: [&str; 2] = ["coin", "strip_along"];

/// Height of the strip with captions below the pictures of a preview, in pixels.
const CAPTIONS: usize = 48;

/// Runs the recipes and writes the pictures into `docs/src/images`, and the table into the page on choosing parameters.
pub(crate) fn draw_all() -> TaskResult {
    run(&mut cargo(&["build", "--release", "--locked", "--quiet", "--package", "isochore-cli"]))?;
    let images = workspace().join("docs/src/images");
    let scratch = target().join("guide-pictures");
    fs::create_dir_all(&images)?;
    fs::create_dir_all(&scratch)?;
    for name in PREVIEWS {
        preview(&workspace().join(format!("data/recipes/{name}.toml")), name, &scratch)?;
        Picture::read(&scratch.join(name))?.half_size().write(&images.join(name))?;
    }
    let mut table = String::from(
        "| recipe | triangles | evaluations of the field | volume change before lock | crossing triangles |\n|---|---:|---:|---:|---:|\n",
    );
    for choice in CHOICES {
        let sides = ["mistake", "cure"].map(|side| format!("{choice}-{side}"));
        for name in &sides {
            preview(&workspace().join(format!("docs/recipes/{name}.toml")), name, &scratch)?;
            writeln!(table, "{}", row(name, &scratch)?)?;
        }
        let [mistake, cure] = sides.map(|name| Picture::read(&scratch.join(name)));
        mistake?.right_half().beside(&cure?.right_half()).half_size().write(&images.join(choice))?;
    }
    Markers::new("choices", "cargo xtask pictures")
        .write_into(&workspace().join("docs/src/choosing.md"), table.trim_end())
}

/// Runs a recipe, which leaves `NAME.png` and `NAME.json` in the folder.
fn preview(recipe: &Path, name: &str, folder: &Path) -> TaskResult {
    let [mesh, report, picture] = ["ply", "json", "png"].map(|extension| folder.join(name).with_extension(extension));
    let mut command = Command::new(target().join("release/isochore"));
    command.arg("run").arg(recipe).arg("--quiet").arg("--output").arg(mesh).arg("--report").arg(report);
    run(command.arg("--set").arg(format!("output.preview={:?}", picture.display().to_string())))
}

fn row(name: &str, folder: &Path) -> TaskResult<String> {
    let report: Value = serde_json::from_slice(&fs::read(folder.join(name).with_extension("json"))?)?;
    let evaluations: u64 =
        report["strokes"].as_array().into_iter().flatten().filter_map(|stroke| stroke["evaluations"].as_u64()).sum();
    let change = report["volume_change_before_lock"].as_f64().ok_or("the target is closed")?;
    let after = &report["after"];
    Ok(format!(
        "| `{name}` | {} | {evaluations} | {change:+.1e} | {} |",
        after["triangles"], after["self_intersecting_triangles"]
    ))
}

/// A picture of 8-bit red, green and blue.
struct Picture {
    width: usize,
    height: usize,
    pixels: Vec<[u8; 3]>,
}

impl Picture {
    /// Reads a file without its extension in `path`.
    fn read(path: &Path) -> TaskResult<Self> {
        let mut reader = png::Decoder::new(BufReader::new(File::open(path.with_extension("png"))?)).read_info()?;
        let mut bytes = vec![0; reader.output_buffer_size().ok_or("the picture is too large")?];
        let info = reader.next_frame(&mut bytes)?;
        let channels = info.color_type.samples();
        let pixels = bytes[..info.buffer_size()].chunks_exact(channels).map(|pixel| [pixel[0], pixel[1], pixel[2]]);
        Ok(Self { width: info.width as usize, height: info.height as usize, pixels: pixels.collect() })
    }

    /// The picture after the deformation, without its caption.
    fn right_half(&self) -> Self {
        let (width, height) = (self.width / 2, self.height - CAPTIONS);
        let row = |y: usize| &self.pixels[y * self.width + self.width - width..(y + 1) * self.width];
        Self { width, height, pixels: (0..height).flat_map(row).copied().collect() }
    }

    fn beside(&self, right: &Self) -> Self {
        let rows = self.pixels.chunks(self.width).zip(right.pixels.chunks(right.width));
        let pixels = rows.flat_map(|(left, right)| left.iter().chain(right)).copied().collect();
        Self { width: self.width + right.width, height: self.height, pixels }
    }

    /// Half as wide and high; every pixel is the mean of four.
    fn half_size(&self) -> Self {
        let (width, height) = (self.width / 2, self.height / 2);
        let mean = |index: usize| {
            let corner = 2 * (index / width) * self.width + 2 * (index % width);
            let four = [0, 1, self.width, self.width + 1].map(|offset| self.pixels[corner + offset]);
            std::array::from_fn(|channel| (four.iter().map(|pixel| u16::from(pixel[channel])).sum::<u16>() / 4) as u8)
        };
        Self { width, height, pixels: (0..width * height).map(mean).collect() }
    }

    fn write(&self, path: &Path) -> TaskResult {
        let file = BufWriter::new(File::create(path.with_extension("png"))?);
        let mut encoder = png::Encoder::new(file, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_compression(png::Compression::High);
        Ok(encoder.write_header()?.write_image_data(self.pixels.as_flattened())?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_joined_and_averaged() {
        let gray = |value: u8| [value; 3];
        let height = CAPTIONS + 2;
        let pixels = (0..height).flat_map(|_| [gray(0), gray(0), gray(10), gray(20)]).collect();
        let right = Picture { width: 4, height, pixels }.right_half();
        assert_eq!((right.width, right.height), (2, 2));
        let joined = right.beside(&right);
        assert_eq!(joined.pixels[..4], [gray(10), gray(20), gray(10), gray(20)]);
        assert_eq!(joined.half_size().pixels, [gray(15), gray(15)]);
    }
}
