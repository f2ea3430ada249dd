//! Buffers for a renderer, and the ranges that have changed.

/// Elements per page. Changes are reported in whole pages. Larger sends unchanged elements; smaller
/// makes more ranges.
const PAGE: usize = 256;

/// Pages separated by at most this number of pages are merged into one range. Larger sends
/// unchanged elements; smaller makes more ranges.
const GAP: u32 = 2;

/// Buffers for a renderer, in place, with one entry per *render vertex*: a vertex as seen by the
/// triangles on one side of a seam or hard edge. The first render vertices are the vertices of the
/// mesh as opened, in order. If a vertex has several render vertices, the others follow later.
///
/// A removed triangle remains as three indices of zero, which draw nothing. A removed vertex
/// remains but is not drawn. Later strokes reuse these entries, except those of vertices of the
/// mesh as opened, so the buffers do not grow with the number of strokes.
#[derive(Debug, Clone, Copy)]
pub struct RenderBuffers<'a> {
    /// Increases whenever a buffer has moved in memory. Earlier addresses are then stale.
    pub generation: u64,
    /// Positions, model units.
    pub positions: &'a [[f32; 3]],
    /// Unit normals; zero if all triangles of the vertex have zero area.
    pub normals: &'a [[f32; 3]],
    /// Sets of texture coordinates.
    pub uvs: &'a [Vec<[f32; 2]>],
    /// Linear RGBA; empty if the mesh has no colors.
    pub colors: &'a [[f32; 4]],
    /// Three render vertices per triangle, counter-clockwise seen from outside.
    pub indices: &'a [[u32; 3]],
}

/// The elements `start..end`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DirtyRange {
    /// First element.
    pub start: u32,
    /// One past the last element.
    pub end: u32,
}

/// Ranges of the buffers that have changed since the last call of
/// [`take_changes`](super::Session::take_changes).
///
/// To update copies of the buffers, resize them to the lengths of the buffers, then copy the
/// ranges.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Changes {
    /// The generation of the buffers, as in [`RenderBuffers`].
    pub generation: u64,
    /// Changed positions.
    pub positions: Vec<DirtyRange>,
    /// Changed normals.
    pub normals: Vec<DirtyRange>,
    /// Changed texture coordinates of all sets, colors, and [origins](super::Session::origin_of).
    pub attributes: Vec<DirtyRange>,
    /// Changed indices, counted in triangles.
    pub indices: Vec<DirtyRange>,
}

/// Changes of the buffers since they were last reported.
#[derive(Debug, Clone, Default)]
pub(super) struct DirtyBuffers {
    pub(super) generation: u64,
    pub(super) addresses: Vec<usize>,
    pub(super) positions: DirtyPages,
    pub(super) normals: DirtyPages,
    pub(super) attributes: DirtyPages,
    pub(super) indices: DirtyPages,
}

/// Set of changed pages.
#[derive(Debug, Clone, Default)]
pub(super) struct DirtyPages {
    is_dirty: Vec<bool>,
    pages: Vec<u32>,
}

impl DirtyPages {
    #[inline]
    pub(super) fn mark(&mut self, index: u32) {
        let page = index as usize / PAGE;
        if page >= self.is_dirty.len() {
            self.is_dirty.resize(page + 1, false);
        }
        if !self.is_dirty[page] {
            self.is_dirty[page] = true;
            self.pages.push(page as u32);
        }
    }

    /// Marks `start..end`.
    pub(super) fn mark_range(&mut self, start: usize, end: usize) {
        (start..end).step_by(PAGE).chain((start < end).then(|| end - 1)).for_each(|index| self.mark(index as u32));
    }

    /// Returns the ranges below `length` in ascending order, and clears the set.
    pub(super) fn take(&mut self, length: usize) -> Vec<DirtyRange> {
        self.pages.sort_unstable();
        let mut ranges: Vec<DirtyRange> = Vec::new();
        for page in self.pages.drain(..) {
            self.is_dirty[page as usize] = false;
            let start = page * PAGE as u32;
            let end = (start + PAGE as u32).min(length as u32);
            match ranges.last_mut() {
                _ if start >= end => {}
                Some(last) if start <= last.end + GAP * PAGE as u32 => last.end = end,
                _ => ranges.push(DirtyRange { start, end }),
            }
        }
        ranges
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_cover_the_marks_and_merge_near_pages() {
        let mut pages = DirtyPages::default();
        [5000, 3, 4, 700, 299].into_iter().for_each(|index| pages.mark(index));
        pages.mark_range(9000, 9700);
        let ranges = pages.take(9650);
        assert_eq!(ranges.iter().map(|r| [r.start, r.end]).collect::<Vec<_>>(), [[0, 768], [4864, 5120], [8960, 9650]]);
        assert_eq!(pages.take(9650), []);
        pages.mark(100);
        assert_eq!(pages.take(0), []);
    }
}
