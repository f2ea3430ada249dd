//! Merging vertices that files split at seams.

use crate::TriMesh;
use crate::position_table::{PositionTable, with_repeated_hash};

impl TriMesh {
    /// Merges all vertices at equal positions. This undoes the vertex splits of file formats.
    ///
    /// Vertices keep the order of their first occurrence. Vertex colors that differ at one position
    /// move to the corners. If skin influences differ, the first ones are kept. Triangles that
    /// collapse are dropped, which does not change the surface.
    ///
    /// # Panics
    /// If an index is out of range.
    ///
    /// ```
    /// use isochore_mesh::{TriMesh, primitives};
    ///
    /// let ball = primitives::icosphere(1.0, 1);
    /// // Three separate vertices for every triangle.
    /// let positions = (0..80).flat_map(|triangle| ball.corners(triangle)).collect();
    /// let soup = TriMesh::new(positions, (0..80).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect());
    /// assert!(!soup.check().is_closed());
    /// assert!(soup.welded().check().is_closed());
    /// ```
    pub fn welded(self) -> TriMesh {
        self.welded_where(|_| true)
    }

    /// Merges boundary vertices at equal positions.
    ///
    /// Unlike [`welded`](Self::welded), it does not join closed surfaces that touch at separate
    /// vertices.
    ///
    /// # Panics
    /// If an index is out of range.
    pub fn welded_at_boundary(self) -> TriMesh {
        match vertices_at_boundary(&self.triangles, self.positions.len()) {
            Some(at_boundary) => self.welded_where(|vertex| at_boundary[vertex]),
            None => self,
        }
    }

    fn welded_where(mut self, is_candidate: impl Fn(usize) -> bool) -> TriMesh {
        let candidates = (0..self.positions.len()).filter(|&vertex| is_candidate(vertex)).map(|vertex| vertex as u32);
        let suspects = with_repeated_hash(&self.positions, candidates);
        let position_of = |vertex: u32| self.positions[vertex as usize];
        let mut table = PositionTable::with_capacity(suspects.len());
        let find = |&vertex: &u32| table.find_or_insert(position_of(vertex), vertex, position_of);
        let firsts: Vec<u32> = suspects.iter().map(find).collect();
        if firsts == suspects {
            return self;
        }
        // Maps each vertex to the first vertex at its position, and from the loop on to its new
        // index.
        let mut merged: Vec<u32> = (0..self.positions.len() as u32).collect();
        suspects.iter().zip(firsts).for_each(|(&vertex, first)| merged[vertex as usize] = first);
        let mut kept: Vec<u32> = Vec::with_capacity(merged.len());
        for vertex in 0..merged.len() {
            let first = merged[vertex] as usize;
            if first == vertex {
                merged[vertex] = kept.len() as u32;
                kept.push(vertex as u32);
            } else {
                merged[vertex] = merged[first];
            }
        }
        self.move_differing_colors_to_corners(&merged, &kept);
        self.keep_vertices(&kept);
        for triangle in &mut self.triangles {
            *triangle = triangle.map(|vertex| merged[vertex as usize]);
        }
        self.drop_collapsed_triangles();
        self
    }

    fn move_differing_colors_to_corners(&mut self, merged: &[u32], kept: &[u32]) {
        let colors = &self.vertex.colors;
        let first = |vertex: usize| kept[merged[vertex] as usize] as usize;
        if (0..colors.len()).any(|vertex| colors[vertex] != colors[first(vertex)]) {
            self.corner.colors = self.triangles.iter().map(|t| t.map(|vertex| colors[vertex as usize])).collect();
            self.vertex.colors.clear();
        }
    }

    fn keep_vertices(&mut self, kept: &[u32]) {
        fn keep<T: Clone>(values: &mut Vec<T>, kept: &[u32]) {
            if !values.is_empty() {
                *values = kept.iter().map(|&vertex| values[vertex as usize].clone()).collect();
            }
        }
        keep(&mut self.positions, kept);
        keep(&mut self.vertex.colors, kept);
        keep(&mut self.vertex.skin, kept);
    }

    /// Removes triangles that use a vertex twice, with their attributes.
    fn drop_collapsed_triangles(&mut self) {
        let collapsed: Vec<bool> = self.triangles.iter().map(|&[a, b, c]| a == b || b == c || c == a).collect();
        if !collapsed.contains(&true) {
            return;
        }
        fn drop_where<T>(values: &mut Vec<T>, dropped: &[bool]) {
            let mut dropped = dropped.iter();
            values.retain(|_| !dropped.next().is_some_and(|&dropped| dropped));
        }
        drop_where(&mut self.triangles, &collapsed);
        drop_where(&mut self.triangle_materials, &collapsed);
        self.corner.uvs.iter_mut().for_each(|set| drop_where(set, &collapsed));
        drop_where(&mut self.corner.normals, &collapsed);
        drop_where(&mut self.corner.colors, &collapsed);
    }
}

/// Flags the vertices of edges with only one triangle. `None` without such an edge.
fn vertices_at_boundary(triangles: &[[u32; 3]], vertices: usize) -> Option<Vec<bool>> {
    // Counting sort of all edges by their smaller vertex.
    let sides = || triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).map(|(a, b)| (a.min(b), a.max(b)));
    let mut ends = vec![0_u32; vertices + 1];
    sides().for_each(|(smaller, _)| ends[smaller as usize + 1] += 1);
    (0..vertices).for_each(|vertex| ends[vertex + 1] += ends[vertex]);
    let mut others = vec![0_u32; 3 * triangles.len()];
    for (smaller, larger) in sides() {
        let next = &mut ends[smaller as usize];
        others[*next as usize] = larger;
        *next += 1;
    }
    // After the sort, `ends` holds the end of each vertex's group.
    let mut at_boundary = Vec::new();
    let mut start = 0;
    for (vertex, &end) in ends[..vertices].iter().enumerate() {
        let group = &mut others[start..end as usize];
        start = end as usize;
        group.sort_unstable();
        for edge in group.chunk_by(|a, b| a == b).filter(|edge| edge.len() == 1) {
            at_boundary.resize(vertices, false);
            at_boundary[vertex] = true;
            at_boundary[edge[0] as usize] = true;
        }
    }
    (!at_boundary.is_empty()).then_some(at_boundary)
}
