//! The search for a port that makes the second dump from the first: the lab's schemes first, then the schemes with
//! one mistake of the catalogue, then two, up to [`MOST_MISTAKES`].
//!
//! Few mistakes before many, and among the same number those that leave less: a beam search. What is left over is
//! the sum of squares after least squares, so every mistake that is really there lowers it.

use std::collections::{HashMap, HashSet};

use rayon::prelude::*;

use super::catalogue::{Edit, Group};
use super::fit::{Agreement, Fit, Rounding, Step};
use super::port::{Kind, Port};
use crate::field::Cell;

/// The most mistakes of a step that are looked for at once.
pub const MOST_MISTAKES: usize = 4;

/// Ports that are kept from one number of mistakes to the next.
const BEAM: usize = 20;

/// Of those, ports with the same mistakes in different forms.
const FORMS: usize = 3;

/// Cells by which ports are ranked; all cells decide whether one is right.
const RANKED_BY: usize = 300;

/// Ports of the same number of mistakes whose agreement is looked at closely.
const LOOKED_AT: usize = 30;

/// The largest share of the squares that rounding leaves; integers over a thousand are the coarsest.
const ROUNDING: f64 = 2e-3;

/// A port that was tried.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The scheme it started from, an index of the list that was given.
    pub base: usize,
    /// Its mistakes, indices of the list that was given, in rising order.
    pub edits: Vec<usize>,
    /// The port.
    pub port: Port,
    /// Its weights.
    pub fit: Fit,
    /// How its step agrees with the dump.
    pub agreement: Agreement,
    /// The rounding it was looked at with.
    pub rounding: Rounding,
}

/// A port on its way.
#[derive(Clone)]
struct Node {
    base: usize,
    edits: Vec<usize>,
    /// The sum of squares that is left over.
    left: f64,
    /// And before anything was explained.
    total: f64,
}

/// What ports are made from.
struct Parts<'a> {
    step: &'a Step,
    bases: &'a [Port],
    edits: &'a [Edit],
    /// The cells by which ports are ranked.
    ranked: Vec<Cell>,
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Found {
    /// Ports that agree in every number, all with the same, smallest number of mistakes.
    pub full: Vec<Candidate>,
    /// The port that agrees in the most cells, where none agrees in all.
    pub nearest: Candidate,
}

/// Looks for ports that make `step`, from `bases` by `edits`, of at most `most` mistakes.
pub fn search(step: &Step, bases: &[Port], edits: &[Edit], most: usize) -> Option<Found> {
    let receivers = step.receivers();
    let parts = Parts { step, bases, edits, ranked: thinned(&receivers, step.before.side()) };
    let mut beam: Vec<Node> = Vec::new();
    let mut nearest: Option<Candidate> = None;
    for mistakes in 0..=most {
        let mut nodes = if mistakes == 0 { parts.right() } else { parts.grown(&beam) };
        nodes.sort_by(|a, b| a.left.total_cmp(&b.left));
        let mut full = Vec::new();
        for rounding in [Rounding::Stored, Rounding::Dumped] {
            // What leaves much is no rounding.
            let near = nodes
                .iter()
                .enumerate()
                .take(LOOKED_AT)
                .filter(|(i, node)| *i < 2 || node.left < ROUNDING * node.total);
            for (_, node) in near {
                let candidate = parts.looked_at(node, rounding, &receivers);
                if candidate.agreement.is_full() && is_sensible(&candidate.port, &candidate.fit) {
                    full.push(candidate);
                } else if nearest.as_ref().is_none_or(|n| candidate.agreement.agreeing > n.agreement.agreeing) {
                    nearest = Some(candidate);
                }
            }
            if !full.is_empty() {
                break;
            }
        }
        if let Some(first) = full.first() {
            let nearest = first.clone();
            // Of ports that agree alike the likelier mistake stands first in the catalogue.
            full.sort_by(|a, b| (a.base, &a.edits).cmp(&(b.base, &b.edits)));
            return Some(Found { full, nearest });
        }
        beam = parts.kept(nodes, mistakes);
    }
    nearest.map(|nearest| Found { full: Vec::new(), nearest })
}

impl Parts<'_> {
    fn port(&self, base: usize, edits: &[usize]) -> Port {
        let mut port = self.bases[base].clone();
        edits.iter().for_each(|e| (self.edits[*e].rule)(&mut port));
        port
    }

    /// Every port without a mistake.
    fn right(&self) -> Vec<Node> {
        let node = |base: usize| {
            let fit = self.step.rough(&self.bases[base], &self.ranked);
            Node { base, edits: Vec::new(), left: fit.left, total: fit.total }
        };
        (0..self.bases.len()).into_par_iter().map(node).collect()
    }

    /// Every port with one mistake more than one of the beam.
    fn grown(&self, beam: &[Node]) -> Vec<Node> {
        let mut seen: HashSet<(usize, Vec<usize>)> = HashSet::new();
        let mut chosen: Vec<(&Node, Vec<usize>)> = Vec::new();
        for node in beam {
            for i in (0..self.edits.len()).filter(|i| self.goes_with(*i, node)) {
                let mut edits = node.edits.clone();
                edits.insert(edits.partition_point(|&e| e < i), i);
                if seen.insert((node.base, edits.clone())) {
                    chosen.push((node, edits));
                }
            }
        }
        let node = |(from, edits): (&Node, Vec<usize>)| {
            let fit = self.step.rough(&self.port(from.base, &edits), &self.ranked);
            // Two mistakes may hide each other, so that either alone makes it worse.
            let worth = fit.left < from.left * 0.999 || (from.base == 0 && self.turns_all(&edits));
            worth.then_some(Node { base: from.base, edits, left: fit.left, total: fit.total })
        };
        chosen.into_par_iter().filter_map(node).collect()
    }

    /// Whether a mistake can join those that a port has: one clamp, border, order and convention, each form once.
    fn goes_with(&self, i: usize, node: &Node) -> bool {
        let group = self.edits[i].mistake.group;
        let alike = |e: &usize| group != Group::Faces && self.edits[*e].mistake.group == group;
        !node.edits.iter().any(|e| *e == i || alike(e))
    }

    /// Whether a lone mistake is worth a second one whatever it leaves: it turns all light.
    fn turns_all(&self, edits: &[usize]) -> bool {
        let [edit] = edits else { return false };
        let edit = &self.edits[*edit];
        let whole = !edit.detail.contains("light ");
        match edit.mistake.id {
            "injects-minus-n" => true,
            "injection-axes" => edit.rank < 5,
            "reads-minus-d" | "sides-minus-d" | "read-sign" | "lobe-sign" | "reprojected-along-read" => whole,
            "mirrored-sides" | "axes-exchanged" => whole,
            _ => false,
        }
    }

    fn looked_at(&self, node: &Node, rounding: Rounding, receivers: &[Cell]) -> Candidate {
        let port = self.port(node.base, &node.edits);
        let (fit, agreement) = self.step.precise(&port, rounding, receivers);
        Candidate { base: node.base, edits: node.edits.clone(), port, fit, agreement, rounding }
    }

    /// The best ports, no two that are alike, and few with the same mistakes; and those that a second mistake may
    /// turn back. All schemes, and where the coefficients are not known all conventions, are worth a first mistake.
    fn kept(&self, nodes: Vec<Node>, mistakes: usize) -> Vec<Node> {
        if mistakes == 0 {
            return nodes;
        }
        let mut kept: Vec<(Node, Port)> = Vec::new();
        let mut forms: HashMap<Vec<&str>, usize> = HashMap::new();
        let mut best = 0;
        for node in nodes {
            let turns = node.base == 0 && self.turns_all(&node.edits);
            if best >= BEAM && !turns {
                continue;
            }
            let ids: Vec<&str> = node.edits.iter().map(|e| self.edits[*e].mistake.id).collect();
            let alike = forms.entry(ids).or_default();
            if *alike >= FORMS && !turns {
                continue;
            }
            let port = self.port(node.base, &node.edits);
            if !kept.iter().any(|(_, other)| *other == port) {
                *alike += 1;
                best += 1;
                kept.push((node, port));
            }
        }
        kept.into_iter().map(|(node, _)| node).collect()
    }
}

/// Whether weights are some that an author could have typed: none is negative, and light that goes back through the
/// shared face goes on through the far one too.
fn is_sensible(port: &Port, fit: &Fit) -> bool {
    let positive = |kind: Kind| fit.weight(kind) >= -5.0 * fit.deviation(kind) - 1e-6;
    let is_there = |kind: Kind| fit.weight(kind) > 5.0 * fit.deviation(kind) + 1e-5;
    let has_near = port.taps.iter().flatten().any(|tap| tap.kind == Kind::Near);
    [Kind::Far, Kind::Side, Kind::Near].into_iter().all(positive)
        && (!has_near || (is_there(Kind::Far) && is_there(Kind::Near)))
}

/// Some of the cells, evenly, those at the border and those inside by themselves: few cells show a border.
fn thinned(cells: &[Cell], side: usize) -> Vec<Cell> {
    let is_border = |cell: &&Cell| cell.iter().any(|c| *c == 0 || *c + 1 == side);
    let (border, inside): (Vec<&Cell>, Vec<&Cell>) = cells.iter().partition(is_border);
    let some = |cells: Vec<&Cell>| -> Vec<Cell> {
        let every = cells.len().div_ceil(RANKED_BY).max(1);
        // A step that is no divisor of a row's length takes cells of every column.
        cells.into_iter().step_by(if every > 1 { every | 1 } else { 1 }).copied().collect()
    };
    [some(border), some(inside)].concat()
}
