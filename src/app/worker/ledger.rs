//! Which iterations have been measured, by which metric: measuring takes longer than an iteration in a large volume,
//! so it follows behind, the newest iteration first.

use std::collections::{BTreeSet, HashMap};
use std::ops::RangeInclusive;

use crate::study::expectation::Expectation;

/// What has been measured.
#[derive(Clone, Debug, Default)]
pub struct Ledger {
    done: HashMap<Expectation, BTreeSet<usize>>,
}

impl Ledger {
    /// Notes that an iteration has been measured.
    pub fn enter(&mut self, metric: Expectation, iteration: usize) {
        self.done.entry(metric).or_default().insert(iteration);
    }

    /// Iteration `k` and later ones are not what they were.
    pub fn forget_from(&mut self, k: usize) {
        self.done.values_mut().for_each(|done| done.retain(|iteration| *iteration < k));
    }

    /// What was measured by a metric no longer holds.
    pub fn forget(&mut self, metric: Expectation) {
        self.done.remove(&metric);
    }

    /// The iterations of `all` that are still to be measured, oldest first.
    pub fn open(&self, metric: Expectation, all: RangeInclusive<usize>) -> impl DoubleEndedIterator<Item = usize> {
        let done = self.done.get(&metric);
        all.filter(move |iteration| done.is_none_or(|done| !done.contains(iteration)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_open_is_what_was_not_entered_or_was_forgotten() {
        let mut ledger = Ledger::default();
        for k in [0, 1, 3, 4] {
            ledger.enter(Expectation::Thesis, k);
        }
        let open = |ledger: &Ledger, metric| ledger.open(metric, 1..=5).collect::<Vec<_>>();
        assert_eq!(open(&ledger, Expectation::Thesis), [2, 5]);
        assert_eq!(open(&ledger, Expectation::Merged), [1, 2, 3, 4, 5]);
        ledger.forget_from(3);
        assert_eq!(open(&ledger, Expectation::Thesis), [2, 3, 4, 5]);
        ledger.forget(Expectation::Thesis);
        assert_eq!(open(&ledger, Expectation::Thesis), [1, 2, 3, 4, 5]);
    }
}
