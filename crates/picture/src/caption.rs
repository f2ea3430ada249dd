//! Captions, set in a font that the program carries within itself.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

/// How captions of a picture are set.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Type {
    height: RasterHeight,
}

impl Type {
    /// The type size that suits a panel of `width` pixels.
    pub(crate) fn for_width(width: usize) -> Self {
        let height = match width {
            0..=359 => RasterHeight::Size16,
            360..=639 => RasterHeight::Size20,
            640..=1199 => RasterHeight::Size24,
            _ => RasterHeight::Size32,
        };
        Self { height }
    }

    /// Room that `caption` takes up, in pixels; zero for none.
    pub(crate) fn room(self, caption: &str) -> usize {
        if caption.is_empty() { 0 } else { caption.lines().count() * self.height.val() + self.height.val() }
    }

    /// Calls `ink(column, row, share)` for every pixel of the centered caption; lines too long are cut short.
    pub(crate) fn set(self, caption: &str, width: usize, mut ink: impl FnMut(usize, usize, f64)) {
        let advance = get_raster_width(FontWeight::Regular, self.height);
        let fitting = width / advance;
        for (line_number, line) in caption.lines().enumerate() {
            let letters: Vec<char> = line.chars().take(fitting).collect();
            let left = (width - letters.len() * advance) / 2;
            let top = line_number * self.height.val() + self.height.val() / 4;
            for (place, &letter) in letters.iter().enumerate() {
                let Some(glyph) = get_raster(letter, FontWeight::Regular, self.height)
                    .or_else(|| get_raster('?', FontWeight::Regular, self.height))
                else {
                    continue;
                };
                for (row, shares) in glyph.rows().enumerate() {
                    for (column, &share) in shares.iter().enumerate() {
                        ink(left + place * advance + column, top + row, f64::from(share) / 255.0);
                    }
                }
            }
        }
    }
}
