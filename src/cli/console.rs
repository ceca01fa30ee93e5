//! What commands say: results on standard output, remarks on standard error. All of it goes through here.
//!
//! `println!` panics where nobody reads any more (`| head -1`) or the disk is full (`> results.txt`), and passes on
//! whatever a title holds. Here a reader that has gone away ends the talking and not the work, any other failure is
//! kept until the end ([`finish`]), when the files are written; and nothing that steers a terminal gets through.
//!
//! ```
//! use lpv_lab::cli::console;
//! console::line(format_args!("{} cells are lit", 57));
//! assert!(console::finish().is_ok());
//! ```

use std::fmt;
use std::io::{self, BufWriter, ErrorKind, Write};
use std::sync::{Mutex, PoisonError};

use super::CliError;
use crate::system::text;

/// How standard output does.
enum Output {
    /// It takes what it gets.
    Open,
    /// Its reader has gone away, which is no failure.
    Closed,
    /// It failed.
    Failed(io::Error),
}

static OUTPUT: Mutex<Output> = Mutex::new(Output::Open);

/// Prints a line, or several, on standard output.
pub fn line(what: fmt::Arguments<'_>) {
    print(format_args!("{what}\n"));
}

/// Prints text as it is laid out, with its ends of lines.
pub fn print(what: fmt::Arguments<'_>) {
    stream(|out| out.write_all(text::lines(&what.to_string()).as_bytes()));
}

/// Prints what is too long to be held, and holds nothing that was taken from outside.
pub fn stream(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) {
    let mut output = OUTPUT.lock().unwrap_or_else(PoisonError::into_inner);
    if !matches!(*output, Output::Open) {
        return;
    }
    let mut out = BufWriter::new(io::stdout().lock());
    match write(&mut out).and_then(|()| out.flush()) {
        Ok(()) => {}
        Err(error) if error.kind() == ErrorKind::BrokenPipe => *output = Output::Closed,
        Err(error) => *output = Output::Failed(error),
    }
    // What could not be written is dropped, not tried again.
    let _ = out.into_parts();
}

/// Says something about the work on standard error, in one line that begins with the program's name. Where even that
/// cannot be written there is nobody to tell.
pub fn note(what: fmt::Arguments<'_>) {
    let _ = writeln!(io::stderr().lock(), "lpv-lab: {}", text::one_line(&what.to_string()));
}

/// Whether what is said still reaches somebody.
pub fn is_open() -> bool {
    matches!(*OUTPUT.lock().unwrap_or_else(PoisonError::into_inner), Output::Open)
}

/// Ends the talking.
///
/// # Errors
/// Where something that was said could not be written, other than to a reader that has gone away.
pub fn finish() -> Result<(), CliError> {
    let output = OUTPUT.lock().unwrap_or_else(PoisonError::into_inner);
    match &*output {
        Output::Failed(error) => Err(CliError::Failed(format!("cannot write to standard output: {error}"))),
        Output::Open | Output::Closed => Ok(()),
    }
}

/// Prints a line on standard output, as `println!` does, by [`console::line`](crate::cli::console::line).
macro_rules! say {
    ($($what:tt)*) => { $crate::cli::console::line(format_args!($($what)*)) };
}

/// Says something on standard error in one line, by [`console::note`](crate::cli::console::note).
macro_rules! remark {
    ($($what:tt)*) => { $crate::cli::console::note(format_args!($($what)*)) };
}

pub(crate) use {remark, say};
