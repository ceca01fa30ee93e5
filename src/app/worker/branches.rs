//! Runs that were left: clearing, going on from an earlier iteration and running again lead to another branch, and the
//! one before is kept as long as its memory allows, so that the way back is open.

use super::ledger::Ledger;
use super::track::Track;

/// The most runs that are kept, however small.
const MOST: usize = 16;

/// A run with all that was found of it.
#[derive(Debug)]
pub struct Branch {
    /// What the window knows it by.
    pub tag: u64,
    /// The simulations, the document's own first.
    pub tracks: Vec<Track>,
    /// What has been measured of it.
    pub measured: Ledger,
    /// Whether its light has been merged since it changed.
    pub merged: bool,
    /// On each axis, the slab of cells with the most injected light.
    pub brightest: [usize; 3],
}

impl Branch {
    fn bytes(&self) -> usize {
        self.tracks.iter().map(|track| track.now_bytes() + track.past_bytes()).sum()
    }

    /// Whether anything would be lost with it.
    fn holds_work(&self) -> bool {
        self.tracks.first().is_some_and(|track| track.now().iteration() > 0)
    }
}

/// The branches before and after the present one.
#[derive(Debug, Default)]
pub struct Branches {
    before: Vec<Branch>,
    after: Vec<Branch>,
}

impl Branches {
    /// Leaves a branch for a new one: those that were gone back from are forgotten, and the oldest go until all fit
    /// `budget` bytes.
    pub fn leave(&mut self, branch: Branch, budget: usize) {
        self.after.clear();
        if branch.holds_work() {
            self.before.push(branch);
        }
        while self.before.len() > MOST || self.before.iter().map(Branch::bytes).sum::<usize>() > budget {
            self.before.remove(0);
        }
    }

    /// Exchanges the present branch for the one before it, if there is one.
    pub fn back(&mut self, present: Branch) -> Branch {
        match self.before.pop() {
            Some(branch) => {
                self.after.push(present);
                branch
            }
            None => present,
        }
    }

    /// Exchanges the present branch for the one that was last gone back from, if there is one.
    pub fn forward(&mut self, present: Branch) -> Branch {
        match self.after.pop() {
            Some(branch) => {
                self.before.push(present);
                branch
            }
            None => present,
        }
    }

    /// The tags of the branches before and after the present one, the nearest last.
    pub fn tags(&self) -> [Vec<u64>; 2] {
        [&self.before, &self.after].map(|branches| branches.iter().map(|branch| branch.tag).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::worker::cut::tests::{ONE, track};

    fn branch(tag: u64) -> Branch {
        let measured = Ledger::default();
        Branch { tag, tracks: vec![track(ONE)], measured, merged: false, brightest: [0; 3] }
    }

    #[test]
    fn the_way_back_and_forth_is_the_way_that_was_taken() {
        let mut branches = Branches::default();
        branches.leave(branch(1), usize::MAX);
        branches.leave(branch(2), usize::MAX);
        let present = branches.back(branch(3));
        assert_eq!((present.tag, branches.tags()), (2, [vec![1], vec![3]]));
        let present = branches.back(present);
        assert_eq!(branches.back(present).tag, 1);
        let present = branches.forward(branch(1));
        assert_eq!((present.tag, branches.tags()), (2, [vec![1], vec![3]]));
        branches.leave(present, usize::MAX);
        assert_eq!(branches.tags(), [vec![1, 2], vec![]]);
    }

    #[test]
    fn the_oldest_go_where_there_is_no_room() {
        let room = 2 * branch(0).bytes();
        let mut branches = Branches::default();
        (1..=3).for_each(|tag| branches.leave(branch(tag), room));
        assert_eq!(branches.tags()[0], [2, 3]);
        branches.leave(branch(4), 0);
        assert!(branches.tags()[0].is_empty());
    }
}
