//! Loads of coefficient rows, 16 bytes at a time, and their transposition into lanes.
//!
//! Only this part differs between targets. It only moves numbers, so results have the same bits on
//! all targets.

#![expect(unsafe_code, reason = "vector loads and shuffles, which the compiler does not find by itself")]

use crate::LANES;

/// Four numbers for each lane.
pub(super) type Quad = [[f32; LANES]; 4];

/// Transposition of rows into lanes.
pub(super) trait Columns {
    /// Loads, for each lane, the four coefficients from `starts[lane] + offset` on.
    ///
    /// # Safety
    /// `starts[lane] + offset + 4` must not exceed the number of coefficients for any lane, and the
    /// machine must have the features that the implementation requires.
    unsafe fn load(coefficients: &[f32], starts: &[u32; LANES], offset: usize, columns: &mut Quad);
}

/// Portable implementation.
#[cfg(any(test, not(target_arch = "x86_64")))]
pub(super) struct Plain;

#[cfg(any(test, not(target_arch = "x86_64")))]
impl Columns for Plain {
    #[inline(always)]
    unsafe fn load(coefficients: &[f32], starts: &[u32; LANES], offset: usize, columns: &mut Quad) {
        for lane in 0..LANES {
            let start = starts[lane] as usize + offset;
            // SAFETY: the caller ensures the range.
            let row = unsafe { coefficients.get_unchecked(start..start + 4) };
            for i in 0..4 {
                columns[i][lane] = row[i];
            }
        }
    }
}

#[cfg(target_arch = "x86_64")]
pub(super) use x86::{Avx, Avx512, Sse};

#[cfg(target_arch = "x86_64")]
mod x86 {
    use std::arch::x86_64::*;

    use super::{Columns, Quad};
    use crate::LANES;

    /// Loads the row of `lane`.
    ///
    /// # Safety
    /// See [`Columns::load`].
    #[inline(always)]
    unsafe fn row(coefficients: &[f32], starts: &[u32; LANES], offset: usize, lane: usize) -> __m128 {
        // SAFETY: the caller ensures the range. The load needs no alignment, and every x86-64 CPU
        // has it.
        unsafe { _mm_loadu_ps(coefficients.as_ptr().add(starts[lane] as usize + offset)) }
    }

    /// Transposes 4 lanes at a time; every x86-64 CPU has SSE.
    pub(in super::super) struct Sse;

    impl Columns for Sse {
        #[inline(always)]
        unsafe fn load(coefficients: &[f32], starts: &[u32; LANES], offset: usize, columns: &mut Quad) {
            for first in (0..LANES).step_by(4) {
                // SAFETY: the caller ensures the range of the loads; `first + 4` lanes fit into a
                // column.
                unsafe {
                    let row = |lane| row(coefficients, starts, offset, first + lane);
                    let (mut a, mut b, mut c, mut d) = (row(0), row(1), row(2), row(3));
                    _MM_TRANSPOSE4_PS(&mut a, &mut b, &mut c, &mut d);
                    for (column, lanes) in columns.iter_mut().zip([a, b, c, d]) {
                        _mm_storeu_ps(column.as_mut_ptr().add(first), lanes);
                    }
                }
            }
        }
    }

    /// Transposes 8 lanes at a time; requires AVX.
    pub(in super::super) struct Avx;

    impl Columns for Avx {
        #[inline(always)]
        unsafe fn load(coefficients: &[f32], starts: &[u32; LANES], offset: usize, columns: &mut Quad) {
            for first in (0..LANES).step_by(8) {
                // SAFETY: the caller ensures the range of the loads and AVX; `first + 8` lanes fit
                // into a column.
                unsafe {
                    let row = |lane| row(coefficients, starts, offset, first + lane);
                    let rows = |lane| _mm256_insertf128_ps::<1>(_mm256_castps128_ps256(row(lane)), row(lane + 4));
                    let (a, b, c, d) = (rows(0), rows(1), rows(2), rows(3));
                    // Transpose the 4 × 4 blocks: interleave numbers of two rows, then pairs of
                    // numbers.
                    let low = [_mm256_unpacklo_ps(a, b), _mm256_unpacklo_ps(c, d)].map(|x| _mm256_castps_pd(x));
                    let high = [_mm256_unpackhi_ps(a, b), _mm256_unpackhi_ps(c, d)].map(|x| _mm256_castps_pd(x));
                    let turned = [
                        _mm256_unpacklo_pd(low[0], low[1]),
                        _mm256_unpackhi_pd(low[0], low[1]),
                        _mm256_unpacklo_pd(high[0], high[1]),
                        _mm256_unpackhi_pd(high[0], high[1]),
                    ];
                    for (column, lanes) in columns.iter_mut().zip(turned) {
                        _mm256_storeu_ps(column.as_mut_ptr().add(first), _mm256_castpd_ps(lanes));
                    }
                }
            }
        }
    }

    /// Transposes 16 lanes at a time; requires AVX-512F.
    pub(in super::super) struct Avx512;

    impl Columns for Avx512 {
        #[inline(always)]
        unsafe fn load(coefficients: &[f32], starts: &[u32; LANES], offset: usize, columns: &mut Quad) {
            // SAFETY: the caller ensures the range of the loads and AVX-512F; a column has 16
            // lanes.
            unsafe {
                let row = |lane| row(coefficients, starts, offset, lane);
                let rows = |lane| {
                    let rows = _mm512_insertf32x4::<1>(_mm512_castps128_ps512(row(lane)), row(lane + 4));
                    _mm512_insertf32x4::<3>(_mm512_insertf32x4::<2>(rows, row(lane + 8)), row(lane + 12))
                };
                let (a, b, c, d) = (rows(0), rows(1), rows(2), rows(3));
                // Transpose the 4 × 4 blocks: interleave numbers of two rows, then pairs of
                // numbers.
                let low = [_mm512_unpacklo_ps(a, b), _mm512_unpacklo_ps(c, d)].map(|x| _mm512_castps_pd(x));
                let high = [_mm512_unpackhi_ps(a, b), _mm512_unpackhi_ps(c, d)].map(|x| _mm512_castps_pd(x));
                let turned = [
                    _mm512_unpacklo_pd(low[0], low[1]),
                    _mm512_unpackhi_pd(low[0], low[1]),
                    _mm512_unpacklo_pd(high[0], high[1]),
                    _mm512_unpackhi_pd(high[0], high[1]),
                ];
                for (column, lanes) in columns.iter_mut().zip(turned) {
                    _mm512_storeu_ps(column.as_mut_ptr(), _mm512_castpd_ps(lanes));
                }
            }
        }
    }
}
