//! Status codes, and the message of the last error of each thread.

use std::{
    cell::RefCell,
    ffi::{CString, c_char},
    panic::{AssertUnwindSafe, catch_unwind},
};

use isochore_mesh::{
    Cancelled, MeshError, SelfIntersectionError,
    io::{ParseError, ReadError, WriteError},
};
use isochore_sculpt::{BuildToolError, ReplayError, SceneError, recipe::RecipeError, session::SessionError};

/// What came of a call.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Status {
    /// It did its work.
    Ok = 0,
    /// An argument is NULL where it must not be, is no text in UTF-8, or out of range.
    Argument = 1,
    /// A mesh cannot be worked with.
    Mesh = 2,
    /// A recipe or the description of a tool cannot be followed.
    Recipe = 3,
    /// A file cannot be read or written.
    File = 4,
    /// The progress function asked to stop.
    Cancelled = 5,
    /// The call does not fit the state of the handle.
    State = 6,
    /// A fault of isochore itself; the handles of the call must only be given back.
    Internal = 7,
}

/// A status other than `Ok`, and words for it.
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
}

thread_local! {
    static LAST_ERROR: RefCell<CString> = RefCell::default();
}

/// What went wrong in the last call on this thread that returned another status than OK, or an empty text. Never NULL; holds
/// until the next such call.
#[unsafe(no_mangle)]
pub extern "C" fn isochore_last_error() -> *const c_char {
    LAST_ERROR.with_borrow(|message| message.as_ptr())
}

/// Does `work`; keeps panics on this side of the border and remembers the message of what fails.
pub(crate) fn guarded(work: impl FnOnce() -> Result<(), Failure>) -> Status {
    // Handles that a panic left half changed are not looked at again: `Status::Internal` says so.
    let failure = match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(())) => return Status::Ok,
        Ok(Err(failure)) => failure,
        Err(panic) => {
            let message = panic.downcast_ref::<String>().map(String::as_str);
            let message = message.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("unknown");
            Failure::new(Status::Internal, format!("internal fault: {message}"))
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

impl From<RecipeError> for Failure {
    fn from(error: RecipeError) -> Self {
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
        // SAFETY: never NULL, and nothing on this thread fails before it is copied.
        unsafe { CStr::from_ptr(isochore_last_error()) }.to_str().unwrap().to_owned()
    }

    fn fails(message: &str) -> Result<(), Failure> {
        Err(Failure::new(Status::Mesh, message))
    }

    #[test]
    fn panics_stay_on_this_side_and_are_told() {
        assert_eq!(guarded(|| panic!("vertex {} is missing", 7)), Status::Internal);
        assert_eq!(last_error(), "internal fault: vertex 7 is missing");
        assert_eq!(guarded(|| panic!("words that are known before")), Status::Internal);
        assert_eq!(last_error(), "internal fault: words that are known before");
        assert_eq!(guarded(|| std::panic::panic_any(7)), Status::Internal);
        assert_eq!(last_error(), "internal fault: unknown");
        // The next call works, and leaves the words.
        assert_eq!(guarded(|| Ok(())), Status::Ok);
        assert_eq!(last_error(), "internal fault: unknown");
        assert_eq!(guarded(|| fails("ends\0early")), Status::Mesh);
        assert_eq!(last_error(), "ends early");
    }

    #[test]
    fn each_thread_has_its_own_message() {
        let both_failed = Barrier::new(2);
        let hear = |message: &'static str| {
            let before = last_error();
            assert_eq!(guarded(|| fails(message)), Status::Mesh);
            both_failed.wait();
            (before, last_error())
        };
        let heard = thread::scope(|scope| {
            let threads = ["one", "other"].map(|message| scope.spawn(move || hear(message)));
            threads.map(|thread| thread.join().unwrap())
        });
        let own = |message: &str| (String::new(), message.to_owned());
        assert_eq!(heard, [own("one"), own("other")]);
    }
}
