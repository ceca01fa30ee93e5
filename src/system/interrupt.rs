//! Ctrl-C, for work that has something to save when it is asked to stop.
//!
//! Until somebody [`listen`]s, Ctrl-C ends the program at once, as it ends any other: files are whole whenever that
//! happens (see [`super::file`]). Afterwards the first one only asks, and the second one ends it.

use std::process;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};

use super::memory;

/// The exit code after Ctrl-C, as shells have it: 128 and the number of the signal.
pub const EXIT_CODE: u8 = 130;

/// Bytes that must be free for the listening thread: its stack, and what the system sets up beside it.
const NEEDED: u64 = 16 << 20;

static ASKED: AtomicBool = AtomicBool::new(false);

/// From now on Ctrl-C is a question, which [`asked`] answers. Where the system gives no thread to listen with, it
/// stays an end.
pub fn listen() {
    static LISTENING: Once = Once::new();
    LISTENING.call_once(|| {
        // A thread whose stack does not fit ends in a panic of its own, not in an error that could be told.
        if memory::free().is_some_and(|free| free < NEEDED) {
            log::warn!("Ctrl-C will end the program at once: there is no memory for a thread that listens");
            return;
        }
        let heard = || {
            if ASKED.swap(true, Ordering::Relaxed) {
                process::exit(EXIT_CODE.into());
            }
        };
        if let Err(error) = ctrlc::set_handler(heard) {
            log::warn!("Ctrl-C will end the program at once: {error}");
        }
    });
}

/// Whether Ctrl-C has been pressed since somebody began to [`listen`].
pub fn asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}
