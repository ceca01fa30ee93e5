//! The search for a port that makes the second dump from the first: the lab's schemes first, then the schemes with
//! one mistake of the catalogue, then two, up to [`MOST_MISTAKES`].
//!
//! Few mistakes before many, and among the same number those that leave less: a beam search. What is left over is
//! the sum of squares after least squares, so every mistake that is really there lowers it.

use std::collections::{HashMap, HashSet};

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
const RANKED_BY: usize = 150;

/// Ports of the same number of mistakes whose agreement is looked at closely.
const LOOKED_AT: usize = 30;

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
    port: Port,
    left: f64,
}

/// What was found.
#[derive(Clone, Debug)]
pub struct Found {
    /// Ports that agree in every number, all with the same, smallest number of mistakes.
    pub full: Vec<Candidate>,
    /// The port that agrees in the most cells, where none agrees in all.
    pub nearest: Candidate,
}

/// Looks for ports that make `step`, from `bases` by `edits`; `cost` says how many mistakes a base stands for.
pub fn search(step: &Step, bases: &[(Port, usize)], edits: &[Edit], most: usize) -> Option<Found> {
    let receivers = step.receivers();
    let ranked = thinned(&receivers);
    let mut beam: Vec<Node> = Vec::new();
    let mut nearest: Option<Candidate> = None;
    for mistakes in 0..=most {
        let mut nodes = grown(step, bases, &beam, edits, &ranked);
        let fresh = bases.iter().enumerate().filter(|(_, (_, cost))| *cost == mistakes);
        nodes.extend(fresh.map(|(base, (port, _))| {
            let left = step.rough(port, &ranked).left;
            Node { base, edits: Vec::new(), port: port.clone(), left }
        }));
        nodes.sort_by(|a, b| a.left.total_cmp(&b.left));
        let mut full = Vec::new();
        for rounding in [Rounding::Stored, Rounding::Dumped] {
            for node in nodes.iter().take(LOOKED_AT) {
                let candidate = looked_at(step, node, rounding, &receivers);
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
        // All schemes, and where the coefficients are not known all conventions, are worth a first mistake.
        beam = kept(nodes, edits, if mistakes == 0 { bases.len() } else { BEAM });
    }
    nearest.map(|nearest| Found { full: Vec::new(), nearest })
}

/// Every port with one mistake more than one of the beam.
fn grown(step: &Step, bases: &[(Port, usize)], beam: &[Node], edits: &[Edit], ranked: &[Cell]) -> Vec<Node> {
    let mut nodes: Vec<Node> = Vec::new();
    let mut seen: HashSet<(usize, Vec<usize>)> = HashSet::new();
    for node in beam {
        for (i, edit) in edits.iter().enumerate() {
            if !goes_with(edit, i, node, edits) {
                continue;
            }
            let mut chosen = node.edits.clone();
            let at = chosen.partition_point(|&e| e < i);
            chosen.insert(at, i);
            if !seen.insert((node.base, chosen.clone())) {
                continue;
            }
            let mut port = bases[node.base].0.clone();
            chosen.iter().for_each(|&e| (edits[e].rule)(&mut port));
            if port == node.port {
                continue;
            }
            let left = step.rough(&port, ranked).left;
            // Two mistakes may hide each other, so that either alone makes it worse.
            if left < node.left * 0.999 || (node.edits.is_empty() && node.base == 0 && turns_all(edit)) {
                nodes.push(Node { base: node.base, edits: chosen, port, left });
            }
        }
    }
    nodes
}

/// Whether a mistake can join those that a port has: one clamp, border, order and convention, each mistake once in a
/// form.
fn goes_with(edit: &Edit, index: usize, node: &Node, edits: &[Edit]) -> bool {
    node.edits.iter().all(|&e| {
        let other = &edits[e];
        e != index && (edit.mistake.group == Group::Faces || other.mistake.group != edit.mistake.group)
    })
}

fn looked_at(step: &Step, node: &Node, rounding: Rounding, receivers: &[Cell]) -> Candidate {
    let (fit, agreement) = step.precise(&node.port, rounding, receivers);
    Candidate { base: node.base, edits: node.edits.clone(), port: node.port.clone(), fit, agreement, rounding }
}

/// Whether a mistake is worth a second one whatever it leaves alone: it turns all light.
fn turns_all(edit: &Edit) -> bool {
    let is_table = edit.mistake.id == "side-table-sign";
    let is_whole = edit.mistake.group == Group::Faces && !is_table && !edit.detail.contains("light ");
    is_whole || edit.mistake.group == Group::Injection
}

/// The best ports, no two that are alike, and few with the same mistakes; and those that a second mistake may turn
/// back.
fn kept(nodes: Vec<Node>, edits: &[Edit], most: usize) -> Vec<Node> {
    let mut kept: Vec<Node> = Vec::new();
    let mut forms: HashMap<Vec<&str>, usize> = HashMap::new();
    for node in nodes {
        if kept.len() >= most && !(node.edits.len() == 1 && node.base == 0 && turns_all(&edits[node.edits[0]])) {
            continue;
        }
        let ids: Vec<&str> = node.edits.iter().map(|e| edits[*e].mistake.id).collect();
        let alike = forms.entry(ids).or_default();
        let turns = node.edits.len() == 1 && turns_all(&edits[node.edits[0]]);
        if (*alike < FORMS || node.edits.is_empty() || turns) && !kept.iter().any(|k| k.port == node.port) {
            *alike += 1;
            kept.push(node);
        }
    }
    kept
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

/// Some of the cells, evenly.
fn thinned(cells: &[Cell]) -> Vec<Cell> {
    let every = cells.len().div_ceil(RANKED_BY).max(1);
    // A step that is no divisor of a row's length takes cells of every column.
    cells.iter().step_by(if every > 1 { every | 1 } else { 1 }).copied().collect()
}
