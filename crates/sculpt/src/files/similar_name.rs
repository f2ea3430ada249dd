//! Suggestions for misspelled names of files.

use std::{
    cmp::Ordering,
    ffi::OsStr,
    fs,
    path::{Path, PathBuf},
};

use crate::recipe::similarity;

/// A name that may be meant by `name`, the recipe's name of the missing file at `path`: that of the
/// file in the same folder whose stem is most similar. Only files with the same extension, or that
/// `is_readable`, are considered.
pub(super) fn similar_name(name: &str, path: &Path, is_readable: fn(&Path) -> bool) -> Option<String> {
    let folder = path.parent()?;
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let mut candidates: Vec<PathBuf> = fs::read_dir(folder)
        .ok()?
        .filter_map(|entry| Some(PathBuf::from(entry.ok()?.file_name())))
        .filter(|candidate| candidate.extension() == path.extension() || is_readable(candidate))
        .collect();
    // The order of a listing depends on the file system.
    candidates.sort_unstable();
    let rank = |candidate: &PathBuf| {
        let similarity = similarity(stem(path)?, stem(candidate)?)?;
        Some((similarity, candidate.extension() == path.extension()))
    };
    let ranked = candidates.iter().filter_map(|candidate| Some((rank(candidate)?, candidate.to_str()?)));
    let (_, nearest) = ranked.max_by(|(a, _), (b, _)| compare(a, b))?;
    // Keeps the folder as the recipe spells it.
    let folder = name.rfind(['/', std::path::MAIN_SEPARATOR]).map_or("", |end| &name[..=end]);
    Some(format!("{folder}{nearest}"))
}

/// Compares similarities, then whether the extensions are equal.
fn compare(a: &(f64, bool), b: &(f64, bool)) -> Ordering {
    a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
}

fn stem(path: &Path) -> Option<&str> {
    path.file_stem().and_then(OsStr::to_str)
}
