//! What takes long is done on a thread of its own: it can be watched and called off, and a panic in it is told
//! like any other failure.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, TryRecvError, channel};

use egui::Context;

/// How far an errand is, and whether it is still wanted; both ends hold it.
#[derive(Clone, Debug, Default)]
pub struct Watch {
    /// The share done, as the bits of an f64.
    share: Arc<AtomicU64>,
    called_off: Arc<AtomicBool>,
}

impl Watch {
    /// Takes note of the share done, 0 to 1; false once the errand is called off.
    pub fn go_on(&self, share: f64) -> bool {
        self.share.store(share.to_bits(), Ordering::Relaxed);
        !self.called_off.load(Ordering::Relaxed)
    }
}

/// Work in progress. Dropped, it is called off.
#[derive(Debug)]
pub struct Errand<T> {
    watch: Watch,
    answer: Receiver<Result<T, String>>,
}

impl<T: Send + 'static> Errand<T> {
    /// Starts `work`, which is to call [`Watch::go_on`] often; what it returns once it is called off is of no
    /// interest. The window is drawn anew when it ends.
    pub fn start(
        name: &str,
        ctx: &Context,
        work: impl FnOnce(&Watch) -> Result<T, String> + Send + 'static,
    ) -> std::io::Result<Self> {
        let (sender, answer) = channel();
        let watch = Watch::default();
        let (theirs, ctx) = (watch.clone(), ctx.clone());
        std::thread::Builder::new().name(name.to_owned()).spawn(move || {
            let worked = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| work(&theirs)));
            let answer =
                worked.unwrap_or_else(|_| Err("the computation broke down; edit the scene and try again".into()));
            // Nobody may be interested any more.
            let _ = sender.send(answer);
            ctx.request_repaint();
        })?;
        Ok(Errand { watch, answer })
    }
}

impl<T> Errand<T> {
    /// The share done, 0 to 1.
    pub fn share(&self) -> f64 {
        f64::from_bits(self.watch.share.load(Ordering::Relaxed))
    }

    /// What came of it, once it is there.
    pub fn answer(&self) -> Option<Result<T, String>> {
        match self.answer.try_recv() {
            Ok(answer) => Some(answer),
            Err(TryRecvError::Empty) => None,
            Err(TryRecvError::Disconnected) => Some(Err("the computation ended without an answer".to_owned())),
        }
    }
}

impl<T> Drop for Errand<T> {
    fn drop(&mut self) {
        self.watch.called_off.store(true, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    fn wait<T>(errand: &Errand<T>) -> Result<T, String> {
        for _ in 0..2000 {
            if let Some(answer) = errand.answer() {
                return answer;
            }
            std::thread::sleep(Duration::from_millis(2));
        }
        panic!("no answer");
    }

    #[test]
    fn an_errand_answers_and_its_panic_is_told() {
        let ctx = Context::default();
        assert_eq!(wait(&Errand::start("seven", &ctx, |_| Ok(7)).unwrap()), Ok(7));
        let broken = Errand::<()>::start("broken", &ctx, |_| panic!("as ordered")).unwrap();
        assert!(wait(&broken).unwrap_err().contains("broke down"));
    }

    #[test]
    fn an_errand_that_is_dropped_is_called_off() {
        let (told, end) = channel();
        let endless = move |watch: &Watch| {
            while watch.go_on(0.25) {
                std::thread::sleep(Duration::from_millis(1));
            }
            told.send(()).map_err(|error| error.to_string())
        };
        let errand = Errand::start("endless", &Context::default(), endless).unwrap();
        while errand.share() == 0.0 {
            std::thread::sleep(Duration::from_millis(1));
        }
        assert_eq!(errand.share(), 0.25);
        drop(errand);
        end.recv_timeout(Duration::from_secs(10)).unwrap();
    }
}
