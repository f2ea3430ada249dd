//! Captions, typeset with an embedded bitmap font.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// Type size of the captions of a picture.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Type {
    height: RasterHeight,
}

impl Type {
    /// Chooses the type size for a panel of `width` pixels.
    pub(crate) fn for_width(width: usize) -> Self {
        let height = match width {
            0..=359 => RasterHeight::Size16,
            360..=639 => RasterHeight::Size20,
            640..=1199 => RasterHeight::Size24,
            _ => RasterHeight::Size32,
        };
        Self { height }
    }

    /// Height of `caption` with its margins, in pixels. Zero if it is empty.
    pub(crate) fn height_of(self, caption: &str) -> usize {
        if caption.is_empty() { 0 } else { caption.lines().count() * self.height.val() + self.height.val() }
    }

    /// Calls `ink(column, row, coverage)` for every pixel of the centered caption, with a coverage
    /// from 0 to 1. Lines that are too long are truncated.
    pub(crate) fn set(self, caption: &str, width: usize, mut ink: impl FnMut(usize, usize, f64)) {
        let advance = get_raster_width(FontWeight::Regular, self.height);
        let letters_per_line = width / advance;
        for (line_number, line) in caption.lines().enumerate() {
            let letters: Vec<char> = line.chars().take(letters_per_line).collect();
            let left = (width - letters.len() * advance) / 2;
            let top = line_number * self.height.val() + self.height.val() / 4;
            for (index, &letter) in letters.iter().enumerate() {
                let Some(glyph) = get_raster(letter, FontWeight::Regular, self.height)
                    .or_else(|| get_raster('?', FontWeight::Regular, self.height))
                else {
                    continue;
                };
                for (row, coverages) in glyph.rows().enumerate() {
                    for (column, &coverage) in coverages.iter().enumerate() {
                        ink(left + index * advance + column, top + row, f64::from(coverage) / 255.0);
                    }
                }
            }
        }
    }
}
