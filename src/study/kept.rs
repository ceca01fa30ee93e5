//! What is costly to find and asked for again and again: kept for the process, a few of a sort.

use std::sync::{Arc, Mutex, PoisonError};

/// The last few of a sort.
#[derive(Debug)]
pub(crate) struct Kept<V> {
    all: Mutex<Vec<Arc<V>>>,
    most: usize,
}

impl<V> Kept<V> {
    /// None yet, and so many at most.
    pub(crate) const fn new(most: usize) -> Self {
        Kept { all: Mutex::new(Vec::new()), most }
    }

    /// The one that is wanted: kept, or else made and kept in place of the oldest. `None` where it cannot be made.
    pub(crate) fn get(&self, wanted: impl Fn(&V) -> bool, make: impl FnOnce() -> Option<V>) -> Option<Arc<V>> {
        // The list is whole whenever the lock is free, whoever panicked with it.
        let lock = || self.all.lock().unwrap_or_else(PoisonError::into_inner);
        let find = |all: &[Arc<V>]| all.iter().find(|known| wanted(known)).cloned();
        if let Some(known) = find(&lock()) {
            return Some(known);
        }
        let made = Arc::new(make()?);
        let mut all = lock();
        // Two may have made it side by side.
        if let Some(known) = find(&all) {
            return Some(known);
        }
        if all.len() >= self.most {
            all.remove(0);
        }
        all.push(Arc::clone(&made));
        Some(made)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_wanted_again_is_not_made_again_and_the_oldest_goes_first() {
        let kept = Kept::new(2);
        let made = std::cell::Cell::new(0);
        let get = |wanted: u32| {
            let make = || {
                made.set(made.get() + 1);
                (wanted > 0).then_some(wanted)
            };
            kept.get(|one| *one == wanted, make)
        };
        assert_eq!([get(1), get(2), get(1)].map(|one| one.as_deref().copied()), [Some(1), Some(2), Some(1)]);
        assert_eq!((made.get(), get(0)), (2, None));
        // 3 takes the place of 1, and 1 that of 2.
        assert_eq!([get(3), get(1), get(3)].map(|one| one.as_deref().copied()), [Some(3), Some(1), Some(3)]);
        assert_eq!(made.get(), 5);
    }
}
