//! Skin influences as tables with one row per vertex, as in most other software.

use super::VertexAttributes;

/// Joints and weights of all vertices, row by row. Entries that a vertex does not use have weight
/// zero.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SkinTable {
    /// Entries per row: the largest number of influences of any vertex.
    pub per_vertex: usize,
    /// Joint indices.
    pub joints: Vec<u32>,
    /// Weights. Each row sums to one, or to zero if no joint moves the vertex.
    pub weights: Vec<f64>,
}

/// Errors when setting a skin.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SkinError {
    /// The tables do not have one row per vertex.
    #[error(
        "there are {joints} joints and {weights} weights for {vertices} vertices with {per_vertex} influences each"
    )]
    Count {
        /// Joints given.
        joints: usize,
        /// Weights given.
        weights: usize,
        /// Vertices of the mesh.
        vertices: usize,
        /// Influences of each.
        per_vertex: usize,
    },
    /// A weight is negative or not finite.
    #[error("the skin of vertex {vertex} has the weight {weight}, which must be finite and not negative")]
    Weight {
        /// Index of the vertex.
        vertex: usize,
        /// Its weight.
        weight: f64,
    },
}

impl VertexAttributes {
    /// The skin as tables, which are empty without a skin.
    pub fn skin_table(&self) -> SkinTable {
        let per_vertex = self.skin.iter().map(Vec::len).max().unwrap_or(0);
        let entries = self
            .skin
            .iter()
            .flat_map(|influences| (0..per_vertex).map(|column| influences.get(column).copied().unwrap_or_default()));
        let (joints, weights) = entries.unzip();
        SkinTable { per_vertex, joints, weights }
    }

    /// Sets the skin of `vertices` vertices from tables of `per_vertex` columns. Weights are
    /// divided by the sum of their row. Influences of weight zero are dropped.
    ///
    /// # Errors
    /// [`SkinError`] if the tables do not have one row per vertex, or if a weight is negative or
    /// not finite. The skin is then unchanged.
    ///
    /// ```
    /// use isochore_mesh::VertexAttributes;
    ///
    /// let mut vertex = VertexAttributes::default();
    /// vertex.set_skin_table(2, 2, &[0, 1, 1, 0], &[3.0, 1.0, 0.5, 0.0])?;
    /// assert_eq!(vertex.skin, [vec![(0, 0.75), (1, 0.25)], vec![(1, 1.0)]]);
    /// assert_eq!(vertex.skin_table().weights, [0.75, 0.25, 1.0, 0.0]);
    /// # Ok::<(), isochore_mesh::SkinError>(())
    /// ```
    pub fn set_skin_table(
        &mut self,
        vertices: usize,
        per_vertex: usize,
        joints: &[u32],
        weights: &[f64],
    ) -> Result<(), SkinError> {
        let (expected, given) = (vertices.checked_mul(per_vertex), [joints.len(), weights.len()]);
        if per_vertex == 0 || given.map(Some) != [expected; 2] {
            return Err(SkinError::Count { joints: given[0], weights: given[1], vertices, per_vertex });
        }
        let rows = joints.chunks_exact(per_vertex).zip(weights.chunks_exact(per_vertex)).enumerate();
        self.skin =
            rows.map(|(vertex, (joints, weights))| influences(vertex, joints, weights)).collect::<Result<_, _>>()?;
        Ok(())
    }
}

fn influences(vertex: usize, joints: &[u32], weights: &[f64]) -> Result<Vec<(u32, f64)>, SkinError> {
    if let Some(&weight) = weights.iter().find(|weight| !(weight.is_finite() && **weight >= 0.0)) {
        return Err(SkinError::Weight { vertex, weight });
    }
    // Scale down weights whose sum overflows.
    let scale = if weights.iter().sum::<f64>().is_finite() { 1.0 } else { f64::MAX };
    let total: f64 = weights.iter().map(|weight| weight / scale).sum();
    let used = joints.iter().zip(weights).filter(|(_, weight)| **weight > 0.0);
    Ok(used.map(|(&joint, &weight)| (joint, weight / scale / total)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_normalized() {
        let mut vertex = VertexAttributes::default();
        vertex.set_skin_table(3, 2, &[7, 1, 2, 9, 4, 5], &[1.0, 3.0, 0.5, 0.0, 0.0, 0.0]).unwrap();
        assert_eq!(vertex.skin, [vec![(7, 0.25), (1, 0.75)], vec![(2, 1.0)], vec![]]);
        let table = vertex.skin_table();
        assert_eq!(table.per_vertex, 2);
        assert_eq!(table.joints, [7, 1, 2, 0, 0, 0]);
        assert_eq!(table.weights, [0.25, 0.75, 1.0, 0.0, 0.0, 0.0]);
        assert_eq!(VertexAttributes::default().skin_table(), SkinTable::default());
    }

    #[test]
    fn largest_weights_do_not_overflow() {
        let mut vertex = VertexAttributes::default();
        vertex.set_skin_table(1, 2, &[0, 1], &[f64::MAX, f64::MAX]).unwrap();
        assert_eq!(vertex.skin, [vec![(0, 0.5), (1, 0.5)]]);
    }

    #[test]
    fn rejects_invalid_tables() {
        let mut vertex = VertexAttributes { skin: vec![vec![(3, 1.0)]], ..Default::default() };
        let mut refuse = |per_vertex, joints: &[u32], weights: &[f64]| {
            let error = vertex.set_skin_table(1, per_vertex, joints, weights).unwrap_err();
            assert_eq!(vertex.skin, [vec![(3, 1.0)]]);
            error
        };
        assert_eq!(refuse(1, &[0], &[-1.0]), SkinError::Weight { vertex: 0, weight: -1.0 });
        assert!(matches!(refuse(1, &[0], &[f64::NAN]), SkinError::Weight { vertex: 0, .. }));
        assert!(matches!(refuse(2, &[0], &[1.0]), SkinError::Count { joints: 1, weights: 1, .. }));
        assert!(matches!(refuse(0, &[], &[]), SkinError::Count { .. }));
        assert!(matches!(refuse(usize::MAX, &[0], &[1.0]), SkinError::Count { .. }));
    }
}
