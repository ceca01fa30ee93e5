//! Ctrl-C, for work that has something to save when it is asked to stop.
//!
//! Until somebody [`listen`]s, Ctrl-C ends the program at once, as it ends any other: files are whole whenever that
//! happens (see [`super::file`]). Afterwards the first one only asks, and the second one ends it.

use std::process;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};

/// The exit code after Ctrl-C, as shells have it: 128 and the number of the signal.
pub const EXIT_CODE: u8 = 130;

static ASKED: AtomicBool = AtomicBool::new(false);

/// From now on Ctrl-C is a question, which [`asked`] answers. Where the system gives no thread to listen with, it
/// stays an end.
pub fn listen() {
    static LISTENING: Once = Once::new();
    LISTENING.call_once(|| {
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
