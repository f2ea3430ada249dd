//! What a renderer draws, and which parts of it have changed.

/// Elements in a page: changes are told by whole pages. Larger sends what has not changed; smaller makes more ranges.
const PAGE: usize = 256;

/// Pages apart by this number or fewer are told as one range, so that ranges stay few.
const GAP: u32 = 2;

/// Buffers for a renderer, in place: one entry a *render vertex*, which is a vertex as the triangles on one side of a seam or a
/// hard edge see it. Render vertex i is vertex i of the mesh as opened as long as there are that many; where vertices have several
/// render vertices, the others follow.
///
/// What is removed leaves a hole: a triangle stays as three times index zero, which draws nothing; a vertex is not drawn any more.
/// Later strokes fill the holes, but for those of vertices of the mesh as opened, so that buffers do not grow with each stroke.
#[derive(Debug, Clone, Copy)]
pub struct RenderBuffers<'a> {
    /// Grows whenever a buffer has moved in memory, so that addresses taken before are stale.
    pub generation: u64,
    /// Positions, model units.
    pub positions: &'a [[f32; 3]],
    /// Unit normals; zero where no triangle has any area.
    pub normals: &'a [[f32; 3]],
    /// Sets of texture coordinates.
    pub uvs: &'a [Vec<[f32; 2]>],
    /// Linear RGBA; empty where the mesh has no colors.
    pub colors: &'a [[f32; 4]],
    /// Three render vertices a triangle, counter-clockwise seen from outside.
    pub indices: &'a [[u32; 3]],
}

/// Elements from `start` to before `end`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct DirtyRange {
    /// The first element.
    pub start: u32,
    /// The element after the last.
    pub end: u32,
}

/// What has changed in the buffers since they were last asked for.
///
/// First give your copies the lengths of the buffers, then copy the ranges: the copies are then equal to the buffers.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Changes {
    /// The generation of the buffers, as in [`RenderBuffers`].
    pub generation: u64,
    /// Of positions.
    pub positions: Vec<DirtyRange>,
    /// Of normals.
    pub normals: Vec<DirtyRange>,
    /// Of all sets of texture coordinates and of colors, and of where render vertices [come from](super::Session::origin_of).
    pub attributes: Vec<DirtyRange>,
    /// Of indices, in triangles.
    pub indices: Vec<DirtyRange>,
}

/// Pages that have changed.
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

    /// Marks all from `start` to before `end`.
    pub(super) fn mark_range(&mut self, start: usize, end: usize) {
        (start..end).step_by(PAGE).chain((start < end).then(|| end - 1)).for_each(|index| self.mark(index as u32));
    }

    /// The ranges below `length`, in order, and forgets them.
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
    fn ranges_hold_what_was_marked_and_are_few() {
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
