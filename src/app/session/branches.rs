//! What is known of the runs before and after the present one, beside what the worker keeps of them.

use std::collections::HashMap;
use std::sync::Arc;

use super::curves::Curves;
use crate::app::worker::rival::Rival;
use crate::scene::{Preset, Problem};

/// What is known of a run.
#[derive(Clone, Debug)]
pub struct Record {
    /// What its results were made from.
    pub ran: Preset,
    /// When its injectors were where their paths have them, if it was at a time.
    pub ran_at: Option<f64>,
    /// What ran beside the preset's own propagator.
    pub others: Vec<Rival>,
    /// What ran.
    pub problem: Option<Arc<Problem>>,
    /// Its error curves.
    pub curves: Vec<Curves>,
}

/// The runs before and after the present one.
#[derive(Debug, Default)]
pub struct Branches {
    /// The present run's tag.
    pub present: u64,
    newest: u64,
    records: HashMap<u64, Record>,
    kept: [Vec<u64>; 2],
}

impl Branches {
    /// Begins a new run, of which nothing is known yet; `left` is what is known of the present one. Its tag.
    pub fn begin(&mut self, left: Record) -> u64 {
        self.records.insert(self.present, left);
        self.newest += 1;
        self.present = self.newest;
        self.present
    }

    /// Turns to the run of a tag; `left` is what is known of the one that was present.
    pub fn turn_to(&mut self, tag: u64, left: Record) -> Option<Record> {
        self.records.insert(self.present, left);
        self.present = tag;
        self.records.remove(&tag)
    }

    /// Forgets the runs that the worker no longer keeps.
    pub fn keep(&mut self, tags: [Vec<u64>; 2]) {
        let present = self.present;
        self.records.retain(|tag, _| *tag == present || tags.iter().any(|tags| tags.contains(tag)));
        self.kept = tags;
    }

    /// Whether there is a run before the present one, and one after it.
    pub fn around(&self) -> [bool; 2] {
        [!self.kept[0].is_empty(), !self.kept[1].is_empty()]
    }
}
