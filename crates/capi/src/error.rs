//! Status codes, and the message of the last error of each thread.

use std::{
    cell::RefCell,
    ffi::{CString, c_char},
    fmt::Display,
    panic::{AssertUnwindSafe, catch_unwind},
    path::Path,
};

use isochore_mesh::{
    Cancelled, MeshError, SelfIntersectionError,
    io::{ParseError, ReadError, WriteError},
};
use isochore_sculpt::{
    BuildToolError, ReplayError, SceneError, files::LoadError, recipe::RecipeError, session::SessionError,
};

/// Result of a call.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// Success.
    Ok = 0,
    /// Invalid argument: a required pointer is NULL, a string is not valid UTF-8, or a value is out
    /// of range.
    Argument = 1,
    /// Invalid mesh, or a mesh that the operation does not support.
    Mesh = 2,
    /// Invalid recipe, tool description or mask.
    Recipe = 3,
    /// A file cannot be opened, read or written.
    File = 4,
    /// The progress callback returned false.
    Cancelled = 5,
    /// The call is not allowed in the current state of the handle.
    State = 6,
    /// Internal error of isochore. Free the handles passed to the call and do not use them
    /// otherwise.
    Internal = 7,
}

/// A status other than `Ok` with its message.
#[derive(Debug)]
pub(crate) struct Failure {
    pub(crate) status: Status,
    pub(crate) message: String,
}

impl Failure {
    pub(crate) fn new(status: Status, message: impl ToString) -> Self {
        Self { status, message: message.to_string() }
    }

    pub(crate) fn argument(message: impl ToString) -> Self {
        Self::new(Status::Argument, message)
    }

    /// Adds the file at fault to the message.
    pub(crate) fn in_file(self, path: &Path) -> Self {
        Self { message: format!("{}: {}", path.display(), self.message), ..self }
    }
}

thread_local! {
    static LAST_ERROR: RefCell<CString> = RefCell::default();
}

/// Returns the message of the last failed call on this thread, or an empty string if no call has
/// failed. Never NULL. The string is valid until the next failed call on the same thread.
#[unsafe(no_mangle)]
pub extern "C" fn isochore_last_error() -> *const c_char {
    LAST_ERROR.with_borrow(|message| message.as_ptr())
}

/// Runs `work`, converts a panic into [`Status::Internal`], and stores the message of a failure for
/// this thread.
pub(crate) fn guarded(work: impl FnOnce() -> Result<(), Failure>) -> Status {
    // A panic may leave a handle half changed; `Status::Internal` forbids further use of it.
    let failure = match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(())) => return Status::Ok,
        Ok(Err(failure)) => failure,
        Err(panic) => {
            let message = panic.downcast_ref::<String>().map(String::as_str);
            let message = message.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("unknown");
            Failure::new(Status::Internal, format!("internal error: {message}"))
        }
    };
    let text = CString::new(failure.message.replace('\0', " ")).unwrap_or_default();
    LAST_ERROR.with_borrow_mut(|message| *message = text);
    failure.status
}

impl From<Cancelled> for Failure {
    fn from(error: Cancelled) -> Self {
        Self::new(Status::Cancelled, error)
    }
}

impl From<MeshError> for Failure {
    fn from(error: MeshError) -> Self {
        Self::new(Status::Mesh, error)
    }
}

impl From<ParseError> for Failure {
    fn from(error: ParseError) -> Self {
        Self::new(Status::Mesh, error)
    }
}

impl From<ReadError> for Failure {
    fn from(error: ReadError) -> Self {
        let status = if let ReadError::Io { .. } = error { Status::File } else { Status::Mesh };
        Self::new(status, error)
    }
}

impl From<WriteError> for Failure {
    fn from(error: WriteError) -> Self {
        let status = if let WriteError::Io { .. } = error { Status::File } else { Status::Mesh };
        Self::new(status, error)
    }
}

impl From<SelfIntersectionError> for Failure {
    fn from(error: SelfIntersectionError) -> Self {
        match error {
            SelfIntersectionError::Cancelled(cancelled) => cancelled.into(),
            error => Self::new(Status::Mesh, error),
        }
    }
}

impl<P: Display> From<RecipeError<P>> for Failure {
    fn from(error: RecipeError<P>) -> Self {
        Self::new(Status::Recipe, error)
    }
}

impl From<ReplayError> for Failure {
    fn from(error: ReplayError) -> Self {
        match error {
            ReplayError::Cancelled(cancelled) => cancelled.into(),
            error => Self::new(Status::Recipe, error),
        }
    }
}

impl From<LoadError> for Failure {
    fn from(error: LoadError) -> Self {
        let status = if error.io_error().is_some() { Status::File } else { Status::Recipe };
        Self::new(status, error)
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        ReplayError::from(error).into()
    }
}

impl From<BuildToolError> for Failure {
    fn from(error: BuildToolError) -> Self {
        SceneError::from(error).into()
    }
}

impl From<SessionError> for Failure {
    fn from(error: SessionError) -> Self {
        let status = match error {
            SessionError::StrokeUnderWay | SessionError::NoStroke => Status::State,
            SessionError::Cancelled(_) => Status::Cancelled,
            _ => Status::Argument,
        };
        Self::new(status, error)
    }
}

#[cfg(test)]
mod tests {
    use std::{ffi::CStr, sync::Barrier, thread};

    use super::*;

    fn last_error() -> String {
        // SAFETY: the pointer is never NULL, and no call fails on this thread before the text is copied.
        unsafe { CStr::from_ptr(isochore_last_error()) }.to_str().unwrap().to_owned()
    }

    fn fails(message: &str) -> Result<(), Failure> {
        Err(Failure::new(Status::Mesh, message))
    }

    #[test]
    fn panics_become_internal_errors() {
        assert_eq!(guarded(|| panic!("vertex {} is missing", 7)), Status::Internal);
        assert_eq!(last_error(), "internal error: vertex 7 is missing");
        assert_eq!(guarded(|| panic!("a literal message")), Status::Internal);
        assert_eq!(last_error(), "internal error: a literal message");
        assert_eq!(guarded(|| std::panic::panic_any(7)), Status::Internal);
        assert_eq!(last_error(), "internal error: unknown");
        // A successful call keeps the last message.
        assert_eq!(guarded(|| Ok(())), Status::Ok);
        assert_eq!(last_error(), "internal error: unknown");
        assert_eq!(guarded(|| fails("ends\0early")), Status::Mesh);
        assert_eq!(last_error(), "ends early");
    }

    #[test]
    fn each_thread_has_its_own_message() {
        let both_failed = Barrier::new(2);
        let fail_and_read = |message: &'static str| {
            let before = last_error();
            assert_eq!(guarded(|| fails(message)), Status::Mesh);
            both_failed.wait();
            (before, last_error())
        };
        let messages = thread::scope(|scope| {
            let threads = ["one", "other"].map(|message| scope.spawn(move || fail_and_read(message)));
            threads.map(|thread| thread.join().unwrap())
        });
        let own = |message: &str| (String::new(), message.to_owned());
        assert_eq!(messages, [own("one"), own("other")]);
    }
}
