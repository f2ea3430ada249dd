//! Reading numbers from buffers.
//!
//! The iterators of the `gltf` library trust offsets and counts, and panic if those are wrong.

use ::gltf::json::Accessor;
use ::gltf::json::accessor::ComponentType;
use ::gltf::json::validation::Checked;

use super::document::{Document, malformed};
use crate::huge_pages::in_huge_pages;
use crate::io::ParseError;

/// Largest number of elements of an accessor without a buffer view. With a larger value a file of a
/// few bytes could demand all memory; a smaller one refuses sparse accessors of large meshes.
const MAX_IMPLICIT_COUNT: usize = 1 << 26;

/// Bytes of the largest element, a 4×4 matrix.
const MAX_ELEMENT_SIZE: usize = 64;

/// Elements in a buffer view, as announced by the document.
struct Announced {
    view: usize,
    offset: u64,
    count: u64,
}

/// The bytes of an accessor's elements.
struct Layout<'a> {
    bytes: &'a [u8],
    stride: usize,
    count: usize,
}

impl Document<'_> {
    /// Number of components of an accessor's elements.
    pub(super) fn components(&self, index: usize) -> Result<usize, ParseError> {
        match self.accessor(index)?.type_ {
            Checked::Valid(kind) => Ok(kind.multiplicity()),
            Checked::Invalid => Err(malformed(format!("accessor {index} has an unknown type"))),
        }
    }

    /// The results of `make` for elements of `N` components each. Normalized integers become
    /// fractions.
    pub(super) fn vectors<T: Clone, const N: usize>(
        &self,
        index: usize,
        make: impl Fn([f64; N]) -> T,
    ) -> Result<Vec<T>, ParseError> {
        let is_normalized = self.accessor(index)?.normalized;
        let component = self.component(index)?.0;
        self.expect_components(index, N)?;
        // The common case: packed floats need no check of the component type for every number.
        if component == ComponentType::F32
            && let Some(bytes) = self.packed(index, 4 * N)?
        {
            let vectors = bytes.as_chunks().0.as_chunks::<N>().0;
            let mut results = in_huge_pages(Vec::with_capacity(vectors.len()));
            results.extend(vectors.iter().map(|vector| make(vector.map(single))));
            return Ok(results);
        }
        self.elements(index, N, |bytes| {
            let size = component.size();
            make(std::array::from_fn(|i| number(component, is_normalized, &bytes[i * size..])))
        })
    }

    /// Unsigned integers in groups of `N`. An incomplete last group is dropped.
    pub(super) fn indices<const N: usize>(&self, index: usize) -> Result<Vec<[u32; N]>, ParseError> {
        let component = match self.component(index)? {
            (component @ (ComponentType::U8 | ComponentType::U16 | ComponentType::U32), _) => component,
            _ => return Err(malformed(format!("accessor {index} should hold unsigned integers"))),
        };
        self.expect_components(index, 1)?;
        if component == ComponentType::U32
            && let Some(bytes) = self.packed(index, 4)?
        {
            let groups = bytes.as_chunks().0.as_chunks::<N>().0;
            let mut indices = in_huge_pages(Vec::with_capacity(groups.len()));
            indices.extend(groups.iter().map(|group| group.map(u32::from_le_bytes)));
            return Ok(indices);
        }
        let numbers: Vec<u32> = self.elements(index, 1, |bytes| number(component, false, bytes) as u32)?;
        Ok(numbers.as_chunks().0.to_vec())
    }

    /// The bytes of all elements of this size, or `None` if they are not contiguous or the accessor
    /// is sparse.
    fn packed(&self, index: usize, size: usize) -> Result<Option<&[u8]>, ParseError> {
        let accessor = self.accessor(index)?;
        let (Some(view), None) = (accessor.buffer_view, &accessor.sparse) else { return Ok(None) };
        let layout = self.accessor_layout(index, accessor, view.value(), size)?;
        Ok((layout.stride == size).then(|| &layout.bytes[..size * layout.count]))
    }

    /// The results of `make` for the bytes of each element of `components` components. An accessor
    /// without a buffer view consists of zeros.
    fn elements<T: Clone>(
        &self,
        index: usize,
        components: usize,
        make: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<T>, ParseError> {
        let accessor = self.accessor(index)?;
        let size = components * self.component(index)?.1;
        let mut elements: Vec<T> = match accessor.buffer_view {
            Some(view) => {
                let layout = self.accessor_layout(index, accessor, view.value(), size)?;
                let mut elements = Vec::with_capacity(layout.count);
                for i in 0..layout.count {
                    elements.push(make(&layout.bytes[i * layout.stride..][..size]));
                }
                elements
            }
            None => match usize::try_from(accessor.count.0) {
                Ok(count) if count <= MAX_IMPLICIT_COUNT => vec![make(&[0; MAX_ELEMENT_SIZE][..size]); count],
                _ => return Err(malformed(format!("accessor {index} has too many elements without data"))),
            },
        };
        if let Some(sparse) = &accessor.sparse {
            let Checked::Valid(kind) = sparse.indices.component_type else {
                return Err(malformed(format!("accessor {index} has sparse indices of an unknown type")));
            };
            let index_size = kind.0.size();
            let count = sparse.count.0;
            let (view, offset) = (sparse.indices.buffer_view.value(), sparse.indices.byte_offset.0);
            let indices = self.layout(index, Announced { view, offset, count }, index_size)?;
            let (view, offset) = (sparse.values.buffer_view.value(), sparse.values.byte_offset.0);
            let values = self.layout(index, Announced { view, offset, count }, size)?;
            for i in 0..indices.count {
                let target = number(kind.0, false, &indices.bytes[i * indices.stride..]) as usize;
                let slot = elements.get_mut(target);
                *slot.ok_or_else(|| malformed(format!("accessor {index} has a sparse index out of range")))? =
                    make(&values.bytes[i * values.stride..][..size]);
            }
        }
        Ok(elements)
    }

    fn expect_components(&self, index: usize, components: usize) -> Result<(), ParseError> {
        if self.components(index)? == components {
            Ok(())
        } else {
            Err(malformed(format!("accessor {index} should have {components} components")))
        }
    }

    /// The bytes of the elements of an accessor with a buffer view.
    fn accessor_layout(
        &self,
        index: usize,
        accessor: &Accessor,
        view: usize,
        size: usize,
    ) -> Result<Layout<'_>, ParseError> {
        let offset = accessor.byte_offset.map_or(0, |offset| offset.0);
        self.layout(index, Announced { view, offset, count: accessor.count.0 }, size)
    }

    fn accessor(&self, index: usize) -> Result<&Accessor, ParseError> {
        self.root.accessors.get(index).ok_or_else(|| malformed(format!("accessor {index} does not exist")))
    }

    fn component(&self, index: usize) -> Result<(ComponentType, usize), ParseError> {
        match self.accessor(index)?.component_type {
            Checked::Valid(kind) => Ok((kind.0, kind.0.size())),
            Checked::Invalid => Err(malformed(format!("accessor {index} has an unknown component type"))),
        }
    }

    /// Checks that all elements are inside their buffer view.
    fn layout(&self, accessor: usize, announced: Announced, size: usize) -> Result<Layout<'_>, ParseError> {
        let Announced { view, offset, count } = announced;
        let (bytes, stride) = self.view(view)?;
        let stride = stride.unwrap_or(size);
        let beyond = || malformed(format!("accessor {accessor} reaches beyond buffer view {view}"));
        let bytes = usize::try_from(offset).ok().and_then(|offset| bytes.get(offset..)).ok_or_else(beyond)?;
        let count = usize::try_from(count).map_err(|_| beyond())?;
        let Some(last) = count.checked_sub(1) else {
            return Ok(Layout { bytes: &[], stride, count });
        };
        // With a stride of zero, a few bytes could serve as any number of elements.
        let end = last.checked_mul(stride).and_then(|start| start.checked_add(size));
        match end {
            Some(end) if end <= bytes.len() && stride >= size => Ok(Layout { bytes, stride, count }),
            _ => Err(beyond()),
        }
    }
}

fn single(bytes: [u8; 4]) -> f64 {
    f64::from(f32::from_le_bytes(bytes))
}

fn unsigned(bytes: &[u8]) -> u32 {
    u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]])
}

fn number(component: ComponentType, is_normalized: bool, bytes: &[u8]) -> f64 {
    let (value, full) = match component {
        ComponentType::I8 => (f64::from(bytes[0] as i8), f64::from(i8::MAX)),
        ComponentType::U8 => (f64::from(bytes[0]), f64::from(u8::MAX)),
        ComponentType::I16 => (f64::from(i16::from_le_bytes([bytes[0], bytes[1]])), f64::from(i16::MAX)),
        ComponentType::U16 => (f64::from(u16::from_le_bytes([bytes[0], bytes[1]])), f64::from(u16::MAX)),
        ComponentType::U32 => (f64::from(unsigned(bytes)), f64::from(u32::MAX)),
        ComponentType::F32 => return single([bytes[0], bytes[1], bytes[2], bytes[3]]),
    };
    if is_normalized { (value / full).max(-1.0) } else { value }
}
