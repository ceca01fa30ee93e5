//! What ports get wrong: for each mistake a rule, which changes a right port into the wrong one, and a sentence.
//!
//! A rule may come in several forms (a sign may be wrong along any axis); each form is an [`Edit`]. Mistakes that
//! are numbers rather than rules (a weight, a factor, a sum) have no edits: [`super::weights`], [`super::iterations`] and
//! [`super::injection`] read them off. To add a mistake, add an entry to one of the files below.

mod borders;
mod faces;
mod numbers;
mod signs;

use std::fmt;
use std::sync::Arc;

use super::port::{Kind, Port, Tap};
use crate::transport::lattice::face::Direction;

/// A mistake that is known.
#[derive(Clone, Copy)]
pub struct Mistake {
    /// Its name in reports and files.
    pub id: &'static str,
    /// What it is, one sentence.
    pub sentence: &'static str,
    /// What to change, with the right numbers.
    pub remedy: &'static str,
    /// Of which kind its rule is: a port has at most one of each kind but [`Group::Faces`].
    pub group: Group,
    /// The forms of its rule; none where it is a number.
    pub edits: fn() -> Vec<Form>,
}

/// What a rule changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// How light is read and put back.
    Faces,
    /// Which fluxes are clamped.
    Clamp,
    /// What lies beyond the border.
    Border,
    /// In which order cells are updated, and what a cell reads in place of its neighbours.
    Order,
    /// How light was injected, seen against how it is propagated.
    Injection,
    /// What is copied along with the light that has moved.
    Copy,
    /// A number: no rule.
    Number,
}

/// One form of a rule: a few words for the report, and the change.
pub type Form = (String, Rule);

/// A change of a port.
pub type Rule = Arc<dyn Fn(&mut Port) + Send + Sync>;

/// A form of a mistake, ready to be tried.
#[derive(Clone)]
pub struct Edit {
    /// The mistake.
    pub mistake: Mistake,
    /// Which form it has; empty where there is one only.
    pub detail: String,
    /// The change.
    pub rule: Rule,
    /// How many forms of the same mistake are likelier.
    pub rank: usize,
}

impl fmt::Debug for Edit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({})", self.mistake.id, self.detail)
    }
}

/// Every known mistake. Rules that set whole tables come before those that turn signs in them, and of two that make
/// the same port the likelier one stands first.
pub fn all() -> Vec<Mistake> {
    [faces::MISTAKES, signs::MISTAKES, borders::MISTAKES, numbers::MISTAKES].concat()
}

/// The mistake of this name.
pub fn find(id: &str) -> Option<Mistake> {
    all().into_iter().find(|mistake| mistake.id == id)
}

/// Every form of every mistake that has a rule, in the order in which they apply.
pub fn edits() -> Vec<Edit> {
    let forms = all().into_iter().flat_map(|mistake| {
        let forms = (mistake.edits)();
        let ranked = forms.into_iter().enumerate();
        ranked.map(move |(rank, (detail, rule))| Edit { mistake, detail, rule, rank })
    });
    forms.collect()
}

/// No forms: the mistake is a number.
fn none() -> Vec<Form> {
    Vec::new()
}

/// A form of a rule.
fn form(detail: impl Into<String>, rule: impl Fn(&mut Port) + Send + Sync + 'static) -> Form {
    (detail.into(), Arc::new(rule))
}

/// Some directions of travel, with their name: all, those of an axis, one alone, half of them.
fn scopes() -> Vec<(String, [bool; 6])> {
    let mut scopes = vec![(String::new(), [true; 6])];
    let names = ["+x", "-x", "+y", "-y", "+z", "-z"];
    let axes = ["x", "y", "z"];
    let of = |wanted: &dyn Fn(Direction) -> bool| Direction::ALL.map(wanted);
    scopes.extend((0..3).map(|a| (format!("light along {}", axes[a]), of(&|d| d.axis() == a))));
    scopes.extend((0..3).map(|a| {
        let [b, c] = others(a);
        (format!("light along {} and {}", axes[b], axes[c]), of(&|d| d.axis() != a))
    }));
    scopes.extend((0..6).map(|i| (format!("light towards {}", names[i]), std::array::from_fn(|d| d == i))));
    scopes.push(("light towards lower indices".to_owned(), of(&|d| !d.is_positive())));
    scopes.push(("light towards higher indices".to_owned(), of(&|d| d.is_positive())));
    scopes
}

/// The two other axes, the lower one first.
fn others(axis: usize) -> [usize; 2] {
    match axis {
        0 => [1, 2],
        1 => [0, 2],
        _ => [0, 1],
    }
}

/// Changes the taps of the directions in `scope`; the rule gets the direction of travel.
fn each_tap(port: &mut Port, scope: [bool; 6], rule: impl Fn(Direction, &mut Tap)) {
    for (d, taps) in port.taps.iter_mut().enumerate().filter(|(d, _)| scope[*d]) {
        taps.iter_mut().for_each(|tap| rule(Direction::ALL[d], tap));
    }
}

/// As [`each_tap`], for side faces only.
fn each_side(port: &mut Port, scope: [bool; 6], rule: impl Fn(Direction, &mut Tap)) {
    each_tap(port, scope, |d, tap| {
        if tap.kind == Kind::Side {
            rule(d, tap);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::lattice::schemes;

    #[test]
    fn every_mistake_has_a_name_of_its_own_and_tells_what_to_do() {
        let all = all();
        for mistake in &all {
            assert_eq!(all.iter().filter(|other| other.id == mistake.id).count(), 1, "{}", mistake.id);
            assert!(mistake.sentence.len() > 20 && mistake.remedy.len() > 20, "{}", mistake.id);
        }
    }

    #[test]
    fn every_form_changes_the_port() {
        let right = Port::of(&schemes::all()[0]);
        for edit in edits() {
            let mut wrong = right.clone();
            (edit.rule)(&mut wrong);
            assert_ne!(wrong, right, "{edit:?}");
        }
    }
}
