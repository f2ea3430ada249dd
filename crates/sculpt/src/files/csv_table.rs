//! Tables of numbers in comma-separated files.

use std::path::{Path, PathBuf};

/// Rows of numbers, all of the same length, from a file of comma-separated values.
#[derive(Debug, Clone)]
pub struct CsvTable {
    path: PathBuf,
    rows: Vec<Vec<f64>>,
    /// Line of each row in the file, counted from 1.
    lines: Vec<u64>,
}

/// A table that cannot be read or used.
#[derive(Debug, thiserror::Error)]
pub enum CsvError {
    /// The file is missing or cannot be read.
    #[error("{}: cannot read: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The error of the system.
        source: std::io::Error,
    },
    /// A row or a cell is invalid.
    #[error("{}: {problem}", path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// The problem, with the row and the column.
        problem: String,
    },
}

impl CsvError {
    /// The file.
    pub fn path(&self) -> &Path {
        let (Self::Io { path, .. } | Self::Invalid { path, .. }) = self;
        path
    }

    fn invalid(path: &Path, problem: impl ToString) -> Self {
        Self::Invalid { path: path.to_owned(), problem: problem.to_string() }
    }
}

impl CsvTable {
    /// Reads the file at `path`. Every row has the same number of columns, one of
    /// `allowed_columns`.
    ///
    /// The first row is a header if it contains only text. Empty lines and lines that begin
    /// with `#` are skipped.
    ///
    /// # Errors
    /// [`CsvError`], if the file cannot be read, has no rows, a cell is not a finite number, or a
    /// row has a different number of columns. The error names row and column.
    pub fn read(path: &Path, allowed_columns: &[usize]) -> Result<Self, CsvError> {
        let bytes = std::fs::read(path).map_err(|source| CsvError::Io { path: path.to_owned(), source })?;
        Self::parse(path, &bytes, allowed_columns)
    }

    /// Parses `bytes`. Errors call them `path`.
    ///
    /// # Errors
    /// As for [`read`](Self::read), except [`CsvError::Io`].
    pub fn parse(path: &Path, bytes: &[u8], allowed_columns: &[usize]) -> Result<Self, CsvError> {
        // Spreadsheets begin their files with a byte order mark.
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_reader(bytes);
        let mut table = Self { path: path.to_owned(), rows: Vec::new(), lines: Vec::new() };
        let mut is_first = true;
        for record in reader.records() {
            let record = record.map_err(|error| CsvError::invalid(path, error))?;
            let line = record.position().map_or(0, csv::Position::line);
            let is_header = is_first && record.iter().all(|cell| cell.parse::<f64>().is_err());
            is_first = false;
            if is_header {
                continue;
            }
            let row =
                parse_row(&record).map_err(|problem| CsvError::invalid(path, format!("row {line}, {problem}")))?;
            table.check_columns(&row, line, allowed_columns)?;
            table.rows.push(row);
            table.lines.push(line);
        }
        if table.rows.is_empty() {
            return Err(CsvError::invalid(path, "the file has no row of numbers"));
        }
        Ok(table)
    }

    fn check_columns(&self, row: &[f64], line: u64, allowed: &[usize]) -> Result<(), CsvError> {
        let count = row.len();
        if !allowed.contains(&count) {
            let allowed: Vec<String> = allowed.iter().map(usize::to_string).collect();
            let allowed = allowed.join(" or ");
            return Err(CsvError::invalid(&self.path, format!("row {line} has {count} columns; expected {allowed}")));
        }
        match self.rows.first() {
            Some(first) if first.len() != count => Err(CsvError::invalid(
                &self.path,
                format!("row {line} has {count} columns, but row {} has {}", self.lines[0], first.len()),
            )),
            _ => Ok(()),
        }
    }

    /// The rows, at least one.
    pub fn rows(&self) -> &[Vec<f64>] {
        &self.rows
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.rows[0].len()
    }

    /// An error about the row with this index.
    pub fn error(&self, index: usize, problem: impl std::fmt::Display) -> CsvError {
        CsvError::invalid(&self.path, format!("row {}: {problem}", self.line(index)))
    }

    /// An error about the rows with these indices.
    pub fn error_between(&self, first: usize, second: usize, problem: impl std::fmt::Display) -> CsvError {
        CsvError::invalid(&self.path, format!("rows {} and {}: {problem}", self.line(first), self.line(second)))
    }

    /// An error about the whole table.
    pub fn error_in_file(&self, problem: impl std::fmt::Display) -> CsvError {
        CsvError::invalid(&self.path, problem)
    }

    /// Line of the row with this index; beyond the end, that of the last row.
    fn line(&self, index: usize) -> u64 {
        self.lines[index.min(self.lines.len() - 1)]
    }
}

fn parse_row(record: &csv::StringRecord) -> Result<Vec<f64>, String> {
    record
        .iter()
        .enumerate()
        .map(|(index, cell)| match cell.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(number),
            Ok(number) => Err(format!("column {}: {number} is not a finite number", index + 1)),
            Err(_) => Err(format!("column {}: `{cell}` is not a number", index + 1)),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<CsvTable, String> {
        CsvTable::parse(Path::new("a.csv"), text.as_bytes(), &[3, 6]).map_err(|error| error.to_string())
    }

    #[test]
    fn skips_headers_comments_and_byte_order_marks() {
        for text in ["1,2,3\n4,5,6\n", "x,y,z\n1, 2 ,3\n# four\n4,5,6", "\u{feff}1,2,3\r\n\r\n4,5,6\r\n"] {
            let table = parse(text).unwrap();
            assert_eq!(table.rows, [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]], "{text}");
        }
    }

    #[test]
    fn errors_name_row_and_column() {
        for (text, words) in [
            ("1,2,3\n4,5,six\n", "a.csv: row 2, column 3: `six` is not a number"),
            ("1,2,x\n", "a.csv: row 1, column 3: `x` is not a number"),
            ("x,y,z\n1,NaN,3\n", "a.csv: row 2, column 2: NaN is not a finite number"),
            ("1,2,3\n4,5,1e999\n", "a.csv: row 2, column 3: inf is not a finite number"),
            ("1,2,3\n4,5,\n", "a.csv: row 2, column 3: `` is not a number"),
            ("1,2\n", "a.csv: row 1 has 2 columns; expected 3 or 6"),
            ("1,2,3\n1,2,3,4,5,6\n", "a.csv: row 2 has 6 columns, but row 1 has 3"),
            ("x,y,z\n", "a.csv: the file has no row of numbers"),
            ("", "a.csv: the file has no row of numbers"),
        ] {
            assert_eq!(parse(text).unwrap_err(), words);
        }
    }
}
