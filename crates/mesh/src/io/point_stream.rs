//! Points of a file that need not fit into memory, processed chunk by chunk.

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

/// The points of a PLY or NumPy file, read and written chunk by chunk. The rest of the file is
/// copied unchanged.
///
/// - PLY, text or binary in either byte order: the points are the vertices. Their other properties,
///   other elements, comments and number types are kept.
/// - NumPy (`.npy`): the points are the rows of an N×3 array of single or double precision in C
///   order.
///
/// Memory use is proportional to one chunk. Copy the part before the points, then the chunks, then
/// the rest:
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
    /// Start of the last chunk and of the next one: in bytes, or in lines of a text file.
    chunk_start: u64,
    position: u64,
    /// The bytes of the last chunk.
    chunk: Vec<u8>,
    /// The text that replaces a chunk.
    out: Vec<u8>,
}

impl PointStream {
    /// Opens the file at `path` and reads its header.
    ///
    /// # Errors
    /// [`PointStreamError`] if the file cannot be read, or if its format or number types cannot be
    /// streamed.
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

    /// Copies the header and everything between it and the points. Call it once, before all chunks.
    ///
    /// # Errors
    /// [`PointStreamError`] if the file is truncated, or if reading or writing fails.
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

    /// Replaces `points` by the next points, at most `most` of them. Returns `false` at the end of
    /// the points.
    ///
    /// # Errors
    /// [`PointStreamError`] if the file is truncated, a coordinate is not a finite number, or
    /// reading fails.
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
            let location = match self.layout.kind {
                Kind::Binary { size, .. } => format!("at byte {}", self.chunk_start + (index * size) as u64),
                Kind::Text { .. } => format!("on line {}", self.chunk_start + index as u64 + 1),
            };
            PointStreamError::Point { path: self.path.clone(), point: self.read + index as u64, location, problem }
        })?;
        self.read += points.len() as u64;
        Ok(!points.is_empty())
    }

    /// Writes the last chunk with its points replaced by `points`, rounded to the number type of
    /// the file.
    ///
    /// # Errors
    /// [`PointStreamError`] if a point is not finite in that type, or if writing fails.
    ///
    /// # Panics
    /// If the number of points differs from that of the last chunk.
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

    /// Copies everything after the points.
    ///
    /// # Errors
    /// [`PointStreamError`] if reading or writing fails.
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

    /// Appends the next line to the chunk.
    fn read_line(&mut self) -> Result<(), PointStreamError> {
        let start = self.chunk.len();
        let read = self.input.read_until(b'\n', &mut self.chunk);
        read.map_err(|source| PointStreamError::read(&self.path, source))?;
        if self.chunk.len() == start { Err(self.truncated()) } else { Ok(()) }
    }

    fn truncated(&self) -> PointStreamError {
        let end = match self.layout.kind {
            Kind::Binary { .. } => format!("byte {}", self.position),
            Kind::Text { .. } => format!("line {}", self.position),
        };
        PointStreamError::Truncated { path: self.path.clone(), announced: self.count(), end }
    }
}

/// Overwrites the number at the start of `bytes` with `value`.
fn encode(value: f64, is_single: bool, is_big: bool, bytes: &mut [u8]) {
    let single = value as f32;
    match (is_single, is_big) {
        (true, false) => bytes[..4].copy_from_slice(&single.to_le_bytes()),
        (true, true) => bytes[..4].copy_from_slice(&single.to_be_bytes()),
        (false, false) => bytes[..8].copy_from_slice(&value.to_le_bytes()),
        (false, true) => bytes[..8].copy_from_slice(&value.to_be_bytes()),
    }
}

/// Reads up to and including the line `end`, but at most `most` bytes.
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
