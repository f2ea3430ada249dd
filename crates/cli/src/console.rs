//! Progress, messages and results of a command.

use std::{
    io::{self, IsTerminal, Write},
    time::Duration,
};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use isochore_mesh::Monitor;
use serde::Serialize;

use crate::{command_error::CommandError, interrupt::Interrupt};

/// Prints progress and messages on stderr and results on stdout; the [`Monitor`] of every long
/// operation.
#[derive(Debug)]
pub(crate) struct Console {
    bar: ProgressBar,
    interrupt: Interrupt,
    is_quiet: bool,
    is_json: bool,
}

/// Number of steps of the progress bar.
const STEPS: u64 = 1000;

impl Console {
    /// Starts listening for interrupts and shows a progress bar if stderr is a terminal.
    ///
    /// # Errors
    /// The handler of interrupts cannot be installed.
    pub(crate) fn new(is_quiet: bool, is_json: bool) -> Result<Self, CommandError> {
        let interrupt = Interrupt::listen(is_json)
            .map_err(|error| CommandError::Usage(format!("cannot listen for interrupts: {error}")))?;
        let shows_progress = !is_quiet && io::stderr().is_terminal();
        let target = if shows_progress { ProgressDrawTarget::stderr_with_hz(10) } else { ProgressDrawTarget::hidden() };
        let style = ProgressStyle::with_template("{msg:10} {wide_bar} {percent:>3} % {elapsed:>4}");
        let bar = ProgressBar::with_draw_target(Some(STEPS), target)
            .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        if shows_progress {
            bar.enable_steady_tick(Duration::from_millis(100));
        }
        Ok(Self { bar, interrupt, is_quiet, is_json })
    }

    pub(crate) fn interrupt(&self) -> &Interrupt {
        &self.interrupt
    }

    pub(crate) fn is_json(&self) -> bool {
        self.is_json
    }

    /// Removes the progress bar.
    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }

    /// Prints a line on stderr, unless the console is quiet or prints JSON.
    pub(crate) fn say(&self, line: impl std::fmt::Display) {
        if !self.is_quiet && !self.is_json {
            self.bar.suspend(|| print_line(&mut io::stderr(), line));
        }
    }

    /// Prints a line such as `warning: …` on stderr, even if the console is quiet.
    pub(crate) fn warn(&self, label: &str, text: impl std::fmt::Display) {
        let line = if self.is_json {
            serde_json::json!({ label: text.to_string() }).to_string()
        } else {
            format!("{label}: {text}")
        };
        self.bar.suspend(|| print_line(&mut io::stderr(), line));
    }

    /// Prints a line of results on stdout.
    pub(crate) fn print(&self, line: impl std::fmt::Display) {
        self.bar.suspend(|| print_line(&mut io::stdout(), line));
    }

    /// Prints results on stdout as a JSON object.
    pub(crate) fn print_json(&self, value: &impl Serialize) {
        self.print(to_json(value));
    }
}

impl Monitor for Console {
    fn update(&self, stage: &'static str, done: f64) {
        if !self.bar.is_hidden() {
            self.bar.set_message(stage);
            self.bar.set_position((done.clamp(0.0, 1.0) * STEPS as f64) as u64);
        }
    }

    fn is_cancelled(&self) -> bool {
        self.interrupt.is_raised()
    }
}

/// Indented JSON without a final line break.
pub(crate) fn to_json(value: &impl Serialize) -> String {
    serde_json::to_string_pretty(value).expect("all keys of a report are strings")
}

/// Ignores failure: a reader may close its end early, as `head` does.
fn print_line(stream: &mut dyn Write, line: impl std::fmt::Display) {
    let _ = writeln!(stream, "{line}");
}
