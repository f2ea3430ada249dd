//! Points of a file that need not fit into memory.

mod error;
mod layout;
mod text_points;

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};

use glam::DVec3;

pub use error::PointStreamError;

use ply_rs_bw::ply::Encoding;

use super::ply::read_points;
use layout::{Kind, Layout};

/// The points of a PLY or NumPy file, read and written chunk by chunk; everything else in the file is passed through as it is.
///
/// Of PLY, binary in both byte orders or text, the points are the vertices: their other properties, other elements, comments and
/// the types of the numbers stay. Of NumPy (`.npy`) they are the rows of an array N×3 of single or double precision in C order.
/// Memory is taken for one chunk.
///
/// What comes before the points, the chunks, and what comes after are to be copied in this order:
///
/// ```
/// # use glam::DVec3;
/// # use isochore_mesh::io::PointStream;
/// # let folder = tempfile::tempdir()?;
/// # let path = folder.path().join("points.ply");
/// # let header = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
/// # std::fs::write(&path, format!("{header}0 0 0\n1 2 0.5\n"))?;
/// let mut stream = PointStream::open(&path)?;
/// let mut raised = Vec::new();
/// stream.copy_before(&mut raised)?;
/// let mut points = Vec::new();
/// while stream.read_chunk(1000, &mut points)? {
///     points.iter_mut().for_each(|point| *point += DVec3::Z);
///     stream.write_chunk(&points, &mut raised)?;
/// }
/// stream.copy_after(&mut raised)?;
/// assert!(raised.ends_with(b"0 0 1\n1 2 1.5\n"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct PointStream {
    path: PathBuf,
    input: BufReader<File>,
    layout: Layout,
    /// Points read so far.
    read: u64,
    /// Where the last chunk begins, and what comes next: in bytes, of text in lines.
    chunk_start: u64,
    position: u64,
    /// The last chunk as it stood in the file.
    chunk: Vec<u8>,
    /// What a chunk becomes on its way out.
    out: Vec<u8>,
}

impl PointStream {
    /// Opens the file at `path` and reads its header.
    ///
    /// # Errors
    /// [`PointStreamError`]: no such file, or its format or the types of its numbers cannot be streamed.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, PointStreamError> {
        let path = path.as_ref();
        let file = File::open(path).map_err(|source| PointStreamError::read(path, source))?;
        let mut input = BufReader::with_capacity(1 << 20, file);
        let layout = Layout::read(path, &mut input)?;
        let position = layout.start();
        let path = path.to_owned();
        Ok(Self { path, input, layout, read: 0, chunk_start: 0, position, chunk: Vec::new(), out: Vec::new() })
    }

    /// Number of points that the header announces.
    pub fn count(&self) -> u64 {
        self.layout.count
    }

    /// Copies the header and what comes between it and the points. To be called once, before all chunks.
    ///
    /// # Errors
    /// [`PointStreamError`]: the file is truncated, or the system failed.
    pub fn copy_before(&mut self, writer: &mut dyn Write) -> Result<(), PointStreamError> {
        writer.write_all(&self.layout.header).map_err(PointStreamError::Write)?;
        match self.layout.kind {
            Kind::Binary { bytes_before, .. } => {
                let mut left = bytes_before;
                while left > 0 {
                    let buffered =
                        self.input.fill_buf().map_err(|source| PointStreamError::read(&self.path, source))?;
                    let length = buffered.len().min(usize::try_from(left).unwrap_or(usize::MAX));
                    if length == 0 {
                        return Err(self.truncated());
                    }
                    writer.write_all(&buffered[..length]).map_err(PointStreamError::Write)?;
                    self.input.consume(length);
                    left -= length as u64;
                }
            }
            Kind::Text { lines_before, .. } => {
                for _ in 0..lines_before {
                    self.chunk.clear();
                    self.read_line()?;
                    writer.write_all(&self.chunk).map_err(PointStreamError::Write)?;
                    self.position += 1;
                }
                return Ok(());
            }
        }
        self.position = self.layout.first_point();
        Ok(())
    }

    /// Replaces `points` by the next ones, `most` at most; false and none where there are no more.
    ///
    /// # Errors
    /// [`PointStreamError`]: the file is truncated, a coordinate is no finite number, or the system failed.
    pub fn read_chunk(&mut self, most: usize, points: &mut Vec<DVec3>) -> Result<bool, PointStreamError> {
        points.clear();
        let count = usize::try_from(self.count() - self.read).unwrap_or(usize::MAX).min(most.max(1));
        self.chunk_start = self.position;
        self.chunk.clear();
        match self.layout.kind {
            Kind::Binary { size, .. } => {
                let length = (count * size) as u64;
                let read = (&mut self.input).take(length).read_to_end(&mut self.chunk);
                read.map_err(|source| PointStreamError::read(&self.path, source))?;
                self.position += self.chunk.len() as u64;
                if (self.chunk.len() as u64) < length {
                    return Err(self.truncated());
                }
            }
            Kind::Text { .. } => {
                for _ in 0..count {
                    self.read_line()?;
                    self.position += 1;
                }
            }
        }
        self.layout.vertices.count = count;
        read_points(&self.layout.ply, &self.layout.vertices, &self.chunk, points).map_err(|(index, problem)| {
            let place = match self.layout.kind {
                Kind::Binary { size, .. } => format!("at byte {}", self.chunk_start + (index * size) as u64),
                Kind::Text { .. } => format!("on line {}", self.chunk_start + index as u64 + 1),
            };
            PointStreamError::Point { path: self.path.clone(), point: self.read + index as u64, place, problem }
        })?;
        self.read += points.len() as u64;
        Ok(!points.is_empty())
    }

    /// Writes the last chunk with its points replaced by `points`, rounded to the type that the file has for them.
    ///
    /// # Errors
    /// [`PointStreamError`]: a point is not finite in that type, or the system failed.
    ///
    /// # Panics
    /// If there are not as many points as in the last chunk.
    pub fn write_chunk(&mut self, points: &[DVec3], writer: &mut dyn Write) -> Result<(), PointStreamError> {
        let is_single = self.layout.is_single_precision();
        let is_finite = |point: &DVec3| if is_single { point.as_vec3().is_finite() } else { point.is_finite() };
        if let Some(bad) = points.iter().position(|point| !is_finite(point)) {
            let point = self.read - (points.len() - bad) as u64;
            return Err(PointStreamError::TooLarge { path: self.path.clone(), point });
        }
        let bytes = match self.layout.kind {
            Kind::Binary { size, offsets, .. } => {
                let is_big = self.layout.ply.encoding == Encoding::BinaryBigEndian;
                assert_eq!(points.len() * size, self.chunk.len(), "as many points as were read");
                for (record, point) in self.chunk.chunks_exact_mut(size).zip(points) {
                    for (at, coordinate) in offsets.into_iter().zip(point.to_array()) {
                        encode(coordinate, is_single, is_big, &mut record[at..]);
                    }
                }
                &self.chunk
            }
            Kind::Text { columns, .. } => {
                self.out.clear();
                let mut lines = self.chunk.split_inclusive(|&byte| byte == b'\n');
                for point in points {
                    let line = lines.next().expect("as many points as were read");
                    text_points::write_point(line, columns, *point, is_single, &mut self.out);
                }
                &self.out
            }
        };
        writer.write_all(bytes).map_err(PointStreamError::Write)
    }

    /// Copies what comes after the points, to the end of the file.
    ///
    /// # Errors
    /// [`PointStreamError`]: the system failed.
    pub fn copy_after(&mut self, writer: &mut dyn Write) -> Result<(), PointStreamError> {
        loop {
            let buffered = self.input.fill_buf().map_err(|source| PointStreamError::read(&self.path, source))?;
            let length = buffered.len();
            if length == 0 {
                return Ok(());
            }
            writer.write_all(buffered).map_err(PointStreamError::Write)?;
            self.input.consume(length);
        }
    }

    /// Adds the next line to the chunk.
    fn read_line(&mut self) -> Result<(), PointStreamError> {
        let start = self.chunk.len();
        let read = self.input.read_until(b'\n', &mut self.chunk);
        read.map_err(|source| PointStreamError::read(&self.path, source))?;
        if self.chunk.len() == start { Err(self.truncated()) } else { Ok(()) }
    }

    fn truncated(&self) -> PointStreamError {
        let place = match self.layout.kind {
            Kind::Binary { .. } => format!("byte {}", self.position),
            Kind::Text { .. } => format!("line {}", self.position),
        };
        PointStreamError::Truncated { path: self.path.clone(), announced: self.count(), place }
    }
}

/// Writes `value` over the number at the beginning of `bytes`.
fn encode(value: f64, is_single: bool, is_big: bool, bytes: &mut [u8]) {
    let single = value as f32;
    match (is_single, is_big) {
        (true, false) => bytes[..4].copy_from_slice(&single.to_le_bytes()),
        (true, true) => bytes[..4].copy_from_slice(&single.to_be_bytes()),
        (false, false) => bytes[..8].copy_from_slice(&value.to_le_bytes()),
        (false, true) => bytes[..8].copy_from_slice(&value.to_be_bytes()),
    }
}

/// Reads up to and with the line that begins with `end`, or `most` bytes.
fn read_header(input: &mut impl BufRead, end: &[u8], most: usize) -> io::Result<Vec<u8>> {
    let mut header = Vec::new();
    loop {
        let start = header.len();
        input.by_ref().take((most - start) as u64).read_until(b'\n', &mut header)?;
        if header.len() == start || header.len() >= most || header[start..].trim_ascii() == end {
            return Ok(header);
        }
    }
}
