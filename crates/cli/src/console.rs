//! What the user sees while a command works and when it is done.

use std::{
    io::{self, IsTerminal, Write},
    time::Duration,
};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use isochore_mesh::Monitor;
use serde::Serialize;

use crate::{command_error::CommandError, interrupt::Interrupt};

/// Progress and words on stderr, results on stdout; the [`Monitor`] of all long work.
#[derive(Debug)]
pub(crate) struct Console {
    bar: ProgressBar,
    interrupt: Interrupt,
    is_quiet: bool,
    is_json: bool,
}

/// Steps of the progress bar.
const STEPS: u64 = 1000;

impl Console {
    /// # Errors
    /// Where the system refuses to tell of interrupts.
    pub(crate) fn new(is_quiet: bool, is_json: bool) -> Result<Self, CommandError> {
        let interrupt = Interrupt::listen()
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

    /// Takes the progress bar away.
    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }

    /// A line on stderr, unless quiet or for machines.
    pub(crate) fn say(&self, line: impl std::fmt::Display) {
        if !self.is_quiet && !self.is_json {
            self.bar.suspend(|| print_line(&mut io::stderr(), line));
        }
    }

    /// A line on stderr, quiet or not, which begins with what sort of line it is: `warning: …`.
    pub(crate) fn warn(&self, sort: &str, text: impl std::fmt::Display) {
        let line = match self.is_json {
            true => serde_json::json!({ sort: text.to_string() }).to_string(),
            false => format!("{sort}: {text}"),
        };
        self.bar.suspend(|| print_line(&mut io::stderr(), line));
    }

    /// A line of results on stdout.
    pub(crate) fn print(&self, line: impl std::fmt::Display) {
        self.bar.suspend(|| print_line(&mut io::stdout(), line));
    }

    /// An object of results on stdout, as JSON.
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

/// Indented JSON, without the line break at its end.
pub(crate) fn to_json(value: &impl Serialize) -> String {
    serde_json::to_string_pretty(value).expect("reports have only strings for keys")
}

/// The line `error: …`, or the same as a JSON object.
pub(crate) fn print_error(error: &CommandError, is_json: bool) {
    if is_json {
        print_line(&mut io::stderr(), error.to_json());
    } else {
        let text = error.to_string().lines().map(str::trim).collect::<Vec<_>>().join(" ");
        print_line(&mut io::stderr(), format_args!("error: {text}"));
    }
}

/// A reader that has gone away, as `head` does, is no error of ours.
fn print_line(stream: &mut dyn Write, line: impl std::fmt::Display) {
    let _ = writeln!(stream, "{line}");
}
