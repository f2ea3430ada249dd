//! Packets of neighboring grid nodes, one node per lane.

use super::lanes::{LANES, Lanes};

/// Points in the unit frame, with the nearest triangles found so far.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub(super) struct Packet {
    pub(super) x: Lanes,
    pub(super) y: Lanes,
    pub(super) z: Lanes,
    /// Squared distances.
    pub(super) squared: Lanes,
    /// Nearest triangles, in leaf order; [`NOTHING`] if all are beyond the range of the search.
    pub(super) slot: [u32; LANES],
}

/// Slot that marks the absence of a triangle.
pub(super) const NOTHING: u32 = u32::MAX;

impl Packet {
    /// Whether any of these squared distances is below the current minimum of its lane.
    #[inline(always)]
    pub(super) fn may_improve(&self, squared: &Lanes) -> bool {
        let mut nearer = 0;
        for i in 0..LANES {
            nearer |= u32::from(squared[i] < self.squared[i]);
        }
        nearer != 0
    }
}
