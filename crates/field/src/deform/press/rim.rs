//! The rim: what is raised around the contact, by how much and where to.
//!
//! A vertex at distance d from the tool, u = d/R, is raised along its normal by the bump 16 u² (1−u)²: not at all where the
//! tool touches and where its support ends. Only the struck side is raised: what hangs together with the contact and whose
//! normal does not turn away from the contact's.

use glam::DVec3;

use super::{Leg, contact::Near};

/// Where vertices go when they are raised.
#[derive(Debug)]
pub(super) struct Rim {
    /// By vertex; the longest is near one.
    pub(super) directions: Vec<DVec3>,
    /// Whether the tool meets the surface from both sides.
    pub(super) is_through: bool,
}

/// Cosine of the angle between a vertex' normal and the contact's at which it is raised fully; it fades to nothing at a right
/// angle. Larger lowers the rim on round bodies; smaller creases the edge between what is raised and what is not.
const FACING: f64 = 0.5;

/// Share of the area dented in a step, seen along the tool's normals, that is struck from the other side than the rest when the
/// tool goes through a sheet. Larger overlooks sheets of uneven thickness; smaller takes rough ground for a sheet.
const FAR_SIDE: f64 = 0.1;

/// No vertex.
const NONE: u32 = u32::MAX;

impl Rim {
    pub(super) fn new(positions: &[DVec3], triangles: &[[u32; 3]], near: &Near, leg: &Leg<'_>) -> Self {
        let mut place = vec![NONE; positions.len()];
        for (index, &vertex) in (0..).zip(&near.vertices) {
            place[vertex as usize] = index;
        }
        let places = |triangle: &[u32; 3]| triangle.map(|vertex| place[vertex as usize]);
        let around = || triangles.iter().filter(|triangle| places(triangle) != [NONE; 3]);

        let mut normals = vec![DVec3::ZERO; near.vertices.len()];
        for triangle in around() {
            let [a, b, c] = triangle.map(|vertex| positions[vertex as usize]);
            let normal = (b - a).cross(c - a);
            places(triangle)
                .into_iter()
                .filter(|&place| place != NONE)
                .for_each(|place| normals[place as usize] += normal);
        }
        let is_contact = |index: usize| near.distances[index].abs() <= leg.rounding;
        let toward = (0..normals.len()).filter(|&index| is_contact(index)).map(|index| normals[index]).sum::<DVec3>();
        let toward = toward.normalize_or_zero();
        let mut areas = [0.0; 2];
        for &index in &near.dented {
            let area = normals[index as usize].dot(near.gradients[index as usize].normalize_or_zero());
            areas[usize::from(area > 0.0)] += area.abs();
        }
        let is_through = areas[0].min(areas[1]) > FAR_SIDE * (areas[0] + areas[1]);
        normals.iter_mut().for_each(|normal| *normal = normal.normalize_or_zero());

        // A tool that is touched all around has no side; then all that hangs together is raised.
        let facing = |index: usize| if toward == DVec3::ZERO { 1.0 } else { normals[index].dot(toward) };
        let support = leg.tool.support();
        let is_eligible: Vec<bool> = (0..normals.len())
            .map(|index| is_contact(index) || (near.distances[index] < support && facing(index) > 0.0))
            .collect();
        let mut parts = Parts::new(normals.len());
        for triangle in around() {
            let [a, b, c] = places(triangle);
            for (a, b) in [(a, b), (b, c), (c, a)] {
                if a != NONE && b != NONE && is_eligible[a as usize] && is_eligible[b as usize] {
                    parts.join(a, b);
                }
            }
        }
        let mut is_struck = vec![false; normals.len()];
        for index in (0..normals.len()).filter(|&index| is_contact(index)) {
            is_struck[parts.root(index as u32) as usize] = true;
        }
        let mut directions = vec![DVec3::ZERO; positions.len()];
        for (index, &vertex) in near.vertices.iter().enumerate() {
            if is_eligible[index] && is_struck[parts.root(index as u32) as usize] {
                let weight = bump(near.distances[index] / support) * fade(facing(index) / FACING);
                directions[vertex as usize] = weight * normals[index];
            }
        }
        Self { directions, is_through }
    }
}

/// 16 u² (1−u)²: one in the middle of the support, flat at both its ends.
fn bump(u: f64) -> f64 {
    let u = u.clamp(0.0, 1.0);
    16.0 * (u * (1.0 - u)) * (u * (1.0 - u))
}

/// From zero at 0 to one at 1, flat at both.
fn fade(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// Sets that grow together; each is named by its smallest member.
struct Parts(Vec<u32>);

impl Parts {
    fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    fn root(&mut self, mut member: u32) -> u32 {
        while self.0[member as usize] != member {
            self.0[member as usize] = self.0[self.0[member as usize] as usize];
            member = self.0[member as usize];
        }
        member
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}
