//! How threads share one iteration, and stay awake until the next.
//!
//! Handing pieces to whoever is free is slow here twice over. A thread that gets another part of the grid
//! every time finds none of it in its cache; so every thread begins with the pieces that were its own the
//! last time, and only then helps out with those that others have not begun. And a thread that has nothing to do
//! soon sleeps; to be woken takes it, on a virtual machine above all, as long as a small level's whole
//! iteration. So threads look out for more a while longer before they do.
//!
//! And the thread that hands out the work should be one of those that do it. One that only waits for them
//! keeps its core just long enough for the system to put two of them on the other, where they take turns
//! for many iterations. So whoever runs simulations is best [`inside`] a pool throughout.

use std::cell::Cell;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

/// How long a thread without work looks out for more. Longer than what lies between two iterations, or
/// frames of a small scene, and short enough that nobody minds when none comes.
const PATIENCE: Duration = Duration::from_millis(1);

/// The program's pool, once it has been gathered.
static POOL: OnceLock<rayon::ThreadPool> = OnceLock::new();

/// Starts the program's pool with as many threads as the system gives: under `ulimit -u` or `-v` it may be fewer than
/// there are cores, down to none, and then the caller does the work. Returns how many were started and how many should
/// be. To be called before any work: rayon's own pool would panic where one of its threads cannot be started.
pub fn gather() -> (usize, usize) {
    let asked = std::env::var("RAYON_NUM_THREADS").ok().and_then(|number| number.parse().ok()).filter(|n| *n > 0);
    let wanted = asked.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
    for threads in (1..=wanted).rev() {
        if let Ok(pool) = rayon::ThreadPoolBuilder::new().num_threads(threads).build() {
            // Where it has been gathered before, it is as it is.
            let _ = POOL.set(pool);
            return (threads, wanted);
        }
    }
    let _ = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global();
    (0, wanted)
}

/// Does the work on a thread of a pool: here, if this is one, else in the program's, or rayon's where none was
/// gathered.
pub fn inside<R: Send>(work: impl FnOnce() -> R + Send) -> R {
    match POOL.get() {
        _ if rayon::current_thread_index().is_some() => work(),
        Some(pool) => pool.install(work),
        None => rayon::scope(|_| work()),
    }
}

/// What `work` makes of every piece, in their order. The threads of the current pool share the pieces; which of
/// them does what must make no difference.
pub fn share<P: Send, R: Send + Sync>(pieces: Vec<P>, work: impl Fn(P) -> R + Sync) -> Vec<R> {
    let (count, threads) = (pieces.len(), rayon::current_num_threads());
    if count < 2 || threads < 2 {
        return pieces.into_iter().map(work).collect();
    }
    let pieces: Vec<Mutex<Option<P>>> = pieces.into_iter().map(|piece| Mutex::new(Some(piece))).collect();
    let done: Vec<OnceLock<R>> = (0..count).map(|_| OnceLock::new()).collect();
    let left = AtomicUsize::new(count);
    let begin = |thread: usize| thread * count / threads;
    let part_of = |thread: usize| begin(thread)..begin(thread + 1);
    let take_part = || {
        let me = rayon::current_thread_index().unwrap_or(0);
        // The others begin at the front of theirs.
        let of_others = (1..threads).flat_map(|i| part_of((me + i) % threads).rev());
        for i in part_of(me).chain(of_others) {
            let piece = pieces[i].lock().unwrap_or_else(PoisonError::into_inner).take();
            if let Some(piece) = piece {
                // Nobody else had the piece.
                let _ = done[i].set(work(piece));
                left.fetch_sub(1, Ordering::Release);
            }
        }
    };
    rayon::scope(|scope| {
        (1..threads.min(count)).for_each(|_| scope.spawn(|_| take_part()));
        take_part();
        // The scope would fall asleep while it waits for the others' last pieces.
        let until = Instant::now() + PATIENCE;
        while left.load(Ordering::Acquire) > 0 && Instant::now() < until {
            std::thread::yield_now();
        }
    });
    done.into_iter().filter_map(OnceLock::into_inner).collect()
}

/// Asks the pool's other threads to stay awake: there will be several calls of [`share`] in a row.
pub fn stay_awake() {
    let Some(caller) = rayon::current_thread_index() else { return };
    for _ in 1..rayon::current_num_threads() {
        rayon::spawn(move || {
            // The caller gets it back where nobody else has taken it, and has better things to do.
            if rayon::current_thread_index() != Some(caller) {
                look_out();
            }
        });
    }
}

thread_local!(static LOOKS_OUT: Cell<bool> = const { Cell::new(false) });

/// Does the pool's work until none has come for a while.
fn look_out() {
    if LOOKS_OUT.replace(true) {
        return;
    }
    let mut until = Instant::now() + PATIENCE;
    while Instant::now() < until {
        match rayon::yield_now() {
            Some(rayon::Yield::Executed) => until = Instant::now() + PATIENCE,
            _ => std::thread::yield_now(),
        }
    }
    LOOKS_OUT.set(false);
}

#[cfg(test)]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind};

    use super::*;

    fn pool(threads: usize) -> rayon::ThreadPool {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap()
    }

    #[test]
    fn every_piece_is_done_once_and_results_keep_their_order() {
        for threads in [1, 2, 3, 5] {
            let rounds = || {
                for count in [0, 1, 2, 7, 64] {
                    stay_awake();
                    let mut numbers = vec![0; count];
                    for round in 1..=20 {
                        let pieces: Vec<&mut usize> = numbers.iter_mut().collect();
                        let found = share(pieces, |number| {
                            *number += 1;
                            *number
                        });
                        assert_eq!(found, vec![round; count], "{threads} threads");
                    }
                    let squares: Vec<usize> = (0..count).map(|i| i * i).collect();
                    assert_eq!(share((0..count).collect(), |i: usize| i * i), squares);
                }
            };
            pool(threads).install(rounds);
        }
    }

    #[test]
    fn the_programs_pool_has_the_threads_that_it_says() {
        let (got, wanted) = gather();
        assert_eq!(got, wanted);
        assert_eq!(inside(rayon::current_num_threads), got);
    }

    #[test]
    fn pieces_may_be_shared_from_outside_of_any_pool() {
        assert_eq!(share(vec![1, 2, 3], |i| 2 * i), [2, 4, 6]);
        assert!(inside(|| rayon::current_thread_index().is_some()));
    }

    #[test]
    fn a_panic_in_a_piece_reaches_the_caller_and_leaves_the_threads_alive() {
        pool(2).install(|| {
            let broken = |i| if i == 5 { panic!("as asked") } else { i };
            assert!(catch_unwind(AssertUnwindSafe(|| share((0..8).collect(), broken))).is_err());
            assert_eq!(share(vec![1, 2, 3], |i| i), [1, 2, 3]);
        });
    }
}
