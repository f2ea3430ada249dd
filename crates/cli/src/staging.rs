//! Outputs that appear all together and whole, or not at all.

use std::{
    collections::BTreeMap,
    fs,
    io::{self, Write},
    path::{Path, PathBuf},
};

use tempfile::TempDir;

use crate::{command_error::CommandError, interrupt::Interrupt};

/// Files being written beside the places where they are to appear.
///
/// Dropped without [`commit`](Self::commit), it leaves everything as it was.
#[derive(Debug)]
pub(crate) struct Staging {
    interrupt: Interrupt,
    /// Temporary folders by the folder that they stand in.
    workshops: BTreeMap<PathBuf, TempDir>,
    files: Vec<Staged>,
    new_folders: Vec<PathBuf>,
}

#[derive(Debug)]
struct Staged {
    /// Where it is written.
    draft: PathBuf,
    /// Where it is to appear.
    target: PathBuf,
}

impl Staging {
    pub(crate) fn new(interrupt: &Interrupt) -> Self {
        Self { interrupt: interrupt.clone(), workshops: BTreeMap::new(), files: Vec::new(), new_folders: Vec::new() }
    }

    /// Promises a folder, which is made on [`commit`](Self::commit) if it is missing.
    ///
    /// # Errors
    /// Where the folder that it stands in is missing, or something else has its name.
    pub(crate) fn add_folder(&mut self, folder: &Path) -> Result<(), CommandError> {
        if !folder.exists() {
            self.workshop(parent(folder))?;
            self.new_folders.push(folder.to_owned());
        } else if !folder.is_dir() {
            return Err(CommandError::file(folder, "is not a folder; choose another name"));
        }
        Ok(())
    }

    /// The place to write the file that is to appear as `target`.
    ///
    /// # Errors
    /// Where its folder is missing or cannot be written, or something else has its name.
    pub(crate) fn add_file(&mut self, target: &Path) -> Result<PathBuf, CommandError> {
        if self.files.iter().any(|staged| staged.target == target) {
            return Err(CommandError::file(target, "two outputs would go to this file; rename one"));
        }
        if fs::metadata(target).is_ok_and(|metadata| !metadata.is_file()) {
            return Err(CommandError::file(target, "is not a regular file; choose another name"));
        }
        let folder = parent(target);
        let folder = if self.new_folders.iter().any(|new| new == folder) { parent(folder) } else { folder };
        // The extension tells the format, and so must stay.
        let name = target.file_name().ok_or_else(|| CommandError::file(target, "names no file"))?;
        let index = self.files.len().to_string();
        let room = self.workshop(folder)?.join(index);
        fs::create_dir(&room).map_err(|error| CommandError::cannot("write", target, &error))?;
        let draft = room.join(name);
        self.files.push(Staged { draft: draft.clone(), target: target.to_owned() });
        Ok(draft)
    }

    /// Writes the bytes of the file that is to appear where `draft` was promised.
    ///
    /// # Errors
    /// Where the disk is full, or the like; the error names the target.
    pub(crate) fn write(&self, draft: &Path, bytes: &[u8]) -> Result<(), CommandError> {
        let write = || {
            let mut file = fs::File::create(draft)?;
            file.write_all(bytes)?;
            file.sync_all()
        };
        write().map_err(|error| CommandError::cannot("write", self.target_of(draft), &error))
    }

    /// The file that is to appear in the end where `draft` is written now.
    pub(crate) fn target_of<'a>(&'a self, draft: &'a Path) -> &'a Path {
        self.files.iter().find(|staged| staged.draft == draft).map_or(draft, |staged| &staged.target)
    }

    /// Puts all files in place. From here on an interrupt comes too late.
    ///
    /// # Errors
    /// [`CommandError::Interrupted`], or what the system says; everything is then as it was.
    pub(crate) fn commit(self) -> Result<(), CommandError> {
        let mut unfinished = self.interrupt.unfinished();
        if self.interrupt.is_raised() {
            return Err(CommandError::Interrupted);
        }
        let mut undo = Undo::default();
        for folder in &self.new_folders {
            fs::create_dir(folder).map_err(|error| CommandError::cannot("make", folder, &error))?;
            undo.steps.push(Step::RemoveFolder(folder.clone()));
        }
        for Staged { draft, target } in &self.files {
            let cannot = |error: io::Error| CommandError::cannot("write", target, &error);
            let mut step = Step::RemoveFile(target.clone());
            if let Ok(metadata) = fs::metadata(target) {
                // Beside the room of the draft: in it, an output may have any name, this one too.
                let kept = parent(draft).with_extension("previous");
                // Linked, not moved, so that there is no moment without a file; copied where there are no links.
                fs::hard_link(target, &kept).or_else(|_| fs::copy(target, &kept).map(drop)).map_err(cannot)?;
                fs::set_permissions(draft, metadata.permissions()).map_err(cannot)?;
                step = Step::Restore { kept, target: target.clone() };
            }
            fs::rename(draft, target).map_err(cannot)?;
            undo.steps.push(step);
        }
        undo.steps.clear();
        unfinished.commit();
        Ok(())
    }

    fn workshop(&mut self, folder: &Path) -> Result<&Path, CommandError> {
        if !self.workshops.contains_key(folder) {
            if !folder.is_dir() {
                let problem =
                    if folder.exists() { "is not a folder" } else { "this folder does not exist; make it first" };
                return Err(CommandError::file(folder, problem));
            }
            let made = tempfile::Builder::new().prefix(".isochore-").tempdir_in(folder);
            let made = made.map_err(|error| CommandError::cannot("write in", folder, &error))?;
            self.interrupt.add_unfinished(made.path());
            self.workshops.insert(folder.to_owned(), made);
        }
        Ok(self.workshops[folder].path())
    }
}

/// The folder of a file, `.` for a bare name.
fn parent(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Takes back what was done, last step first, unless it is emptied before it is dropped.
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
            // A step that fails leaves nothing better to do than the steps before it.
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
    fn nothing_appears_before_commit_and_nothing_stays_without() {
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
    fn commit_puts_all_in_place_and_makes_folders() {
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

    #[test]
    fn a_file_of_any_name_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        // Whatever the file that was there before is kept as must not meet the new one.
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
    fn a_failure_midway_restores_what_was_there() {
        let folder = tempfile::tempdir().unwrap();
        let [first, second] = ["a.txt", "b.txt"].map(|name| folder.path().join(name));
        fs::write(&first, "old").unwrap();
        let mut staging = Staging::new(&Interrupt::default());
        let draft = staging.add_file(&first).unwrap();
        staging.write(&draft, b"new").unwrap();
        // The second draft is never written, so that it cannot be put in place.
        staging.add_file(&second).unwrap();
        assert!(staging.commit().is_err());
        assert_eq!(names(folder.path()), ["a.txt"]);
        assert_eq!(fs::read(&first).unwrap(), b"old");
    }

    #[test]
    fn places_that_cannot_take_a_file_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let mut staging = Staging::new(&Interrupt::default());
        assert!(staging.add_file(folder.path()).is_err(), "a folder");
        assert!(staging.add_file(&folder.path().join("missing/a.txt")).is_err());
        let target = folder.path().join("a.txt");
        staging.add_file(&target).unwrap();
        assert!(staging.add_file(&target).is_err(), "twice");
    }
}
