use std::{error::Error, ops::Range, path::Path};

use plotters::prelude::*;

use crate::series::Series;

/// Width and height in pixels.
const SIZE: (u32, u32) = (1120, 620);

/// Width of the legend at the right, in pixels.
const LEGEND_WIDTH: u32 = 390;

/// Height of a row of the legend, in pixels.
const LEGEND_ROW: i32 = 28;

/// Palette of Okabe and Ito, which is also distinct for color-blind readers. Yellow is omitted,
/// because it is hard to see on white.
const COLORS: [RGBColor; 7] = [
    RGBColor(0, 0, 0),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 158, 115),
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(204, 121, 167),
];

/// CPU time by size, on logarithmic scales.
#[derive(Debug)]
pub(crate) struct Plot<'a> {
    pub(crate) title: &'a str,
    /// Unit of the sizes.
    pub(crate) size: &'a str,
    pub(crate) series: &'a [Series],
}

impl Plot<'_> {
    /// Writes an SVG file.
    pub(crate) fn write(&self, path: &Path) -> Result<(), Box<dyn Error>> {
        let root = SVGBackend::new(path, SIZE).into_drawing_area();
        root.fill(&WHITE)?;
        let (left, right) = root.split_horizontally(SIZE.0 - LEGEND_WIDTH);
        let points = || self.series.iter().flat_map(|series| &series.points);
        let sizes = around(points().map(|&(size, _)| size as f64));
        let seconds = around(points().map(|&(_, seconds)| seconds));
        let mut chart = ChartBuilder::on(&left)
            .caption(self.title, ("sans-serif", 18))
            .margin(12)
            .x_label_area_size(50)
            .y_label_area_size(80)
            .build_cartesian_2d(sizes.log_scale(), seconds.log_scale())?;
        chart
            .configure_mesh()
            .x_desc(self.size)
            .y_desc("CPU seconds on one core")
            .x_label_formatter(&tick)
            .y_label_formatter(&tick)
            .label_style(("sans-serif", 14))
            .draw()?;
        right.draw(&Text::new("Slope in parentheses; 1 means linear.", (0, 20), ("sans-serif", 14)))?;
        for (index, series) in self.series.iter().enumerate() {
            let points = series.points.iter().map(|&(size, seconds)| (size as f64, seconds));
            let line = COLORS[index % COLORS.len()].stroke_width(2);
            chart.draw_series(LineSeries::new(points.clone(), line))?;
            chart.draw_series(points.map(|point| marker(index, point)))?;
            let row = LEGEND_ROW * (index as i32 + 2);
            right.draw(&PathElement::new([(0, row), (30, row)], line))?;
            right.draw(&marker(index, (15, row)))?;
            let text = format!("{} ({:.2})", series.stage, series.slope());
            right.draw(&Text::new(text, (38, row - 8), ("sans-serif", 14)))?;
        }
        root.present()?;
        Ok(())
    }
}

/// Marker of a series: a dot for the first use of a color, a ring for the second.
fn marker<At>(index: usize, at: At) -> Circle<At, i32> {
    let color = COLORS[index % COLORS.len()];
    Circle::new(at, 4, if index < COLORS.len() { color.filled() } else { color.stroke_width(2) })
}

/// Range of whole powers of ten that contains the numbers.
fn around(numbers: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = numbers.fold((f64::INFINITY, 0.0), |(low, high), number| (number.min(low), number.max(high)));
    libm::exp10(libm::log10(low).floor())..libm::exp10(libm::log10(high).ceil())
}

/// Label of a tick: plain digits from 1 to 1000, otherwise with an exponent.
fn tick(number: &f64) -> String {
    if (1.0..1000.0).contains(number) { format!("{number:.0}") } else { format!("{number:.0e}") }
}
