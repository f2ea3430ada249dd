//! Atomic output: all files of a command appear complete, or none does.

use std::{
    collections::BTreeMap,
    fs,
    io::{self, Write},
    path::{Path, PathBuf},
};

use isochore_mesh::{
    TriMesh,
    io::{self as mesh_io, WriteError},
};
use tempfile::TempDir;

use crate::{command_error::CommandError, interrupt::Interrupt};

/// Files that are written to temporary folders, the drafts, and moved to their targets by
/// [`commit`](Self::commit).
///
/// Dropping it without a commit removes the drafts and leaves all targets unchanged.
#[derive(Debug)]
pub(crate) struct Staging {
    interrupt: Interrupt,
    /// Temporary folder by the folder that contains it.
    temporary: BTreeMap<PathBuf, TempDir>,
    files: Vec<Staged>,
    new_folders: Vec<PathBuf>,
}

#[derive(Debug)]
struct Staged {
    /// Temporary path.
    draft: PathBuf,
    /// Path as the user named it.
    target: PathBuf,
    /// Path to replace: `target` behind its symbolic links.
    place: PathBuf,
}

impl Staging {
    pub(crate) fn new(interrupt: &Interrupt) -> Self {
        Self { interrupt: interrupt.clone(), temporary: BTreeMap::new(), files: Vec::new(), new_folders: Vec::new() }
    }

    /// Adds a folder, which [`commit`](Self::commit) creates if it is missing.
    ///
    /// # Errors
    /// The parent folder is missing, or the path exists and is not a folder.
    pub(crate) fn add_folder(&mut self, folder: &Path) -> Result<(), CommandError> {
        if !folder.exists() {
            self.temporary_folder(parent(folder))?;
            self.new_folders.push(folder.to_owned());
        } else if !folder.is_dir() {
            return Err(CommandError::file(folder, "is not a folder; choose another name"));
        }
        Ok(())
    }

    /// Adds the file `target`. Returns the path of its draft.
    ///
    /// # Errors
    /// `target` is a circle of symbolic links. The folder of `target` is missing or cannot be written,
    /// `target` exists and is not a regular file, or it was added before.
    pub(crate) fn add_file(&mut self, target: &Path) -> Result<PathBuf, CommandError> {
        let place = mesh_io::follow_links(target).map_err(|error| CommandError::cannot("write", target, &error))?;
        if self.files.iter().any(|staged| staged.place == place) {
            return Err(CommandError::file(target, "two outputs have this path; rename one"));
        }
        if fs::metadata(target).is_ok_and(|metadata| !metadata.is_file()) {
            return Err(CommandError::file(target, "is not a regular file; choose another name"));
        }
        // The draft must be in the file system of the place, so that it can be moved there.
        let folder = parent(&place);
        let folder = if self.new_folders.iter().any(|new| new == folder) { parent(folder) } else { folder };
        // The draft keeps the name, because its extension selects the format.
        let name = target.file_name().ok_or_else(|| CommandError::file(target, "the path has no file name"))?;
        let index = self.files.len().to_string();
        let slot = self.temporary_folder(folder)?.join(index);
        fs::create_dir(&slot).map_err(|error| CommandError::cannot("write", target, &error))?;
        let draft = slot.join(name);
        self.files.push(Staged { draft: draft.clone(), target: target.to_owned(), place });
        Ok(draft)
    }

    /// Writes the bytes of a draft.
    ///
    /// # Errors
    /// The system cannot write the file, for example because the disk is full. The error names the
    /// target.
    pub(crate) fn write(&self, draft: &Path, bytes: &[u8]) -> Result<(), CommandError> {
        let write = || {
            let mut file = fs::File::create(draft)?;
            file.write_all(bytes)?;
            file.sync_all()
        };
        write().map_err(|error| CommandError::cannot("write", self.target_of(draft), &error))
    }

    /// Writes a mesh to a draft. The extension selects the format.
    ///
    /// # Errors
    /// The mesh does not fit the format, or the system cannot write the file. The error names the
    /// target.
    pub(crate) fn write_mesh(&self, draft: &Path, mesh: &TriMesh) -> Result<(), CommandError> {
        mesh_io::write(draft, mesh).map_err(|error| {
            let path = self.target_of(draft).to_owned();
            match error {
                WriteError::Io { source, .. } => WriteError::Io { path, source },
                WriteError::Invalid { source, .. } => WriteError::Invalid { path, source },
                WriteError::TooLarge { vertex, .. } => WriteError::TooLarge { path, vertex },
                error @ WriteError::UnknownFormat { .. } => error,
            }
            .into()
        })
    }

    /// Target of a draft.
    pub(crate) fn target_of<'a>(&'a self, draft: &'a Path) -> &'a Path {
        self.files.iter().find(|staged| staged.draft == draft).map_or(draft, |staged| &staged.target)
    }

    /// Moves all drafts to their targets. Later interrupts are ignored.
    ///
    /// # Errors
    /// [`CommandError::Interrupted`], or an error of the system. All targets are then unchanged.
    pub(crate) fn commit(self) -> Result<(), CommandError> {
        let mut unfinished = self.interrupt.unfinished();
        if self.interrupt.is_raised() {
            return Err(CommandError::Interrupted);
        }
        let mut undo = Undo::default();
        for folder in &self.new_folders {
            fs::create_dir(folder).map_err(|error| CommandError::cannot("create", folder, &error))?;
            undo.steps.push(Step::RemoveFolder(folder.clone()));
        }
        for Staged { draft, target, place } in &self.files {
            let cannot = |error: io::Error| CommandError::cannot("write", target, &error);
            let mut step = Step::RemoveFile(place.clone());
            if let Ok(metadata) = fs::metadata(place) {
                // Beside the slot of the draft, not in it: there the name could collide with that
                // of the output.
                let kept = parent(draft).with_extension("previous");
                // A link keeps the target in place until it is replaced. Some file systems have no
                // links and need a copy.
                fs::hard_link(place, &kept).or_else(|_| fs::copy(place, &kept).map(drop)).map_err(cannot)?;
                fs::set_permissions(draft, metadata.permissions()).map_err(cannot)?;
                step = Step::Restore { kept, target: place.clone() };
            }
            fs::rename(draft, place).map_err(cannot)?;
            undo.steps.push(step);
        }
        undo.steps.clear();
        unfinished.commit();
        Ok(())
    }

    fn temporary_folder(&mut self, folder: &Path) -> Result<&Path, CommandError> {
        if !self.temporary.contains_key(folder) {
            if !folder.is_dir() {
                let problem =
                    if folder.exists() { "is not a folder" } else { "this folder does not exist; create it first" };
                return Err(CommandError::file(folder, problem));
            }
            let created = tempfile::Builder::new().prefix(".isochore-").tempdir_in(folder);
            let created = created.map_err(|error| CommandError::cannot("write in", folder, &error))?;
            self.interrupt.add_unfinished(created.path());
            self.temporary.insert(folder.to_owned(), created);
        }
        Ok(self.temporary[folder].path())
    }
}

/// Parent folder of a path; `.` for a bare name.
fn parent(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Steps of a commit. Dropping it reverts them in reverse order, unless it was cleared.
#[derive(Debug, Default)]
struct Undo {
    steps: Vec<Step>,
}

#[derive(Debug)]
enum Step {
    RemoveFolder(PathBuf),
    RemoveFile(PathBuf),
    Restore { kept: PathBuf, target: PathBuf },
}

impl Drop for Undo {
    fn drop(&mut self) {
        for step in self.steps.drain(..).rev() {
            // If a step cannot be reverted, the earlier ones still can.
            let _ = match step {
                Step::RemoveFolder(folder) => fs::remove_dir(folder),
                Step::RemoveFile(file) => fs::remove_file(file),
                Step::Restore { kept, target } => fs::rename(kept, target),
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = entries.collect();
        names.sort();
        names
    }

    #[test]
    fn leaves_targets_unchanged_without_a_commit() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("a.txt");
        fs::write(&target, "old").unwrap();
        let mut staging = Staging::new(&Interrupt::default());
        let draft = staging.add_file(&target).unwrap();
        staging.write(&draft, b"new").unwrap();
        assert_eq!(fs::read(&target).unwrap(), b"old");
        drop(staging);
        assert_eq!(names(folder.path()), ["a.txt"]);
        assert_eq!(fs::read(&target).unwrap(), b"old");
    }

    #[test]
    fn commits_files_and_creates_folders() {
        let folder = tempfile::tempdir().unwrap();
        let mut staging = Staging::new(&Interrupt::default());
        let frames = folder.path().join("frames");
        staging.add_folder(&frames).unwrap();
        for target in [folder.path().join("a.txt"), frames.join("b.txt")] {
            let draft = staging.add_file(&target).unwrap();
            staging.write(&draft, b"new").unwrap();
        }
        staging.commit().unwrap();
        assert_eq!(names(folder.path()), ["a.txt", "frames"]);
        assert_eq!(names(&frames), ["b.txt"]);
    }

    #[cfg(unix)]
    #[test]
    fn writes_through_symbolic_links() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let inner = folder.path().join("inner");
        fs::create_dir(&inner).unwrap();
        fs::write(inner.join("old.txt"), "old").unwrap();
        // To a file, to another link, and to a file that does not exist yet.
        symlink("inner/old.txt", folder.path().join("a.txt")).unwrap();
        symlink(folder.path().join("inner/new.txt"), folder.path().join("b.txt")).unwrap();
        symlink("b.txt", folder.path().join("c.txt")).unwrap();
        let mut staging = Staging::new(&Interrupt::default());
        for name in ["a.txt", "c.txt"] {
            let draft = staging.add_file(&folder.path().join(name)).unwrap();
            staging.write(&draft, b"new").unwrap();
        }
        assert!(staging.add_file(&folder.path().join("b.txt")).is_err(), "the same file as c.txt");
        staging.commit().unwrap();
        for name in ["a.txt", "b.txt", "c.txt"] {
            assert!(fs::symlink_metadata(folder.path().join(name)).unwrap().is_symlink(), "{name}");
            assert_eq!(fs::read(folder.path().join(name)).unwrap(), b"new", "{name}");
        }
        assert_eq!(names(&inner), ["new.txt", "old.txt"]);
        symlink("circle.txt", folder.path().join("circle.txt")).unwrap();
        let mut staging = Staging::new(&Interrupt::default());
        assert!(staging.add_file(&folder.path().join("circle.txt")).is_err());
    }

    #[test]
    fn replaces_a_file_of_any_name() {
        let folder = tempfile::tempdir().unwrap();
        // The backup of the previous file must not collide with the draft.
        for name in ["a", "a.txt", ".previous", "a.previous", "0.previous"] {
            let target = folder.path().join(name);
            fs::write(&target, "old").unwrap();
            let mut staging = Staging::new(&Interrupt::default());
            let draft = staging.add_file(&target).unwrap();
            staging.write(&draft, b"new").unwrap();
            staging.commit().unwrap();
            assert_eq!(fs::read(&target).unwrap(), b"new", "{name}");
        }
    }

    #[test]
    fn restores_targets_after_a_failure() {
        let folder = tempfile::tempdir().unwrap();
        let [first, second] = ["a.txt", "b.txt"].map(|name| folder.path().join(name));
        fs::write(&first, "old").unwrap();
        let mut staging = Staging::new(&Interrupt::default());
        let draft = staging.add_file(&first).unwrap();
        staging.write(&draft, b"new").unwrap();
        // The second draft is never written, so moving it fails.
        staging.add_file(&second).unwrap();
        assert!(staging.commit().is_err());
        assert_eq!(names(folder.path()), ["a.txt"]);
        assert_eq!(fs::read(&first).unwrap(), b"old");
    }

    #[test]
    fn rejects_unusable_targets() {
        let folder = tempfile::tempdir().unwrap();
        let mut staging = Staging::new(&Interrupt::default());
        assert!(staging.add_file(folder.path()).is_err(), "a folder");
        assert!(staging.add_file(&folder.path().join("missing/a.txt")).is_err());
        let target = folder.path().join("a.txt");
        staging.add_file(&target).unwrap();
        assert!(staging.add_file(&target).is_err(), "twice");
    }
}
