//! What runs beside the document's own propagator, on the same scene.

use crate::app::worker::look::Of;
use crate::scene::propagation::Policy;
use crate::scene::{Problem, Propagation};

/// What the document's own propagator is compared with.
#[derive(Clone, Debug, PartialEq)]
pub enum Rival {
    /// Another propagator.
    Propagator(Propagation),
    /// The uniform volume: the document's own propagator on the finest level alone.
    Uniform,
    /// What truly arrives along straight lines.
    Ballistic,
}

impl Rival {
    /// What is simulated for it beside `own`; nothing for what truly arrives.
    pub fn problem(&self, own: &Problem) -> Option<Problem> {
        match self {
            Rival::Propagator(propagation) => Some(Problem { propagation: propagation.clone(), ..own.clone() }),
            Rival::Uniform => Some(Problem { coarsest: own.size, ..own.clone() }),
            Rival::Ballistic => None,
        }
    }

    /// Whether anything is simulated for it.
    pub fn runs(&self) -> bool {
        *self != Rival::Ballistic
    }

    /// A few words, as titles and legends have them.
    pub fn describe(&self) -> String {
        match self {
            Rival::Propagator(propagation) => describe(propagation),
            Rival::Uniform => "uniform volume of A".to_owned(),
            Rival::Ballistic => "what truly arrives".to_owned(),
        }
    }

    /// What the list of schemes says.
    pub fn choice(&self) -> &str {
        match self {
            Rival::Propagator(propagation) => &propagation.scheme,
            Rival::Uniform => "Uniform volume",
            Rival::Ballistic => "What truly arrives",
        }
    }
}

/// Whose light each of the compared views shows: the document's own first, then its rivals'.
pub fn sides(rivals: &[Rival]) -> Vec<Of> {
    let mut tracks = 1..;
    let others = rivals.iter().map(|rival| match rival.runs() {
        true => Of::Track(tracks.next().unwrap_or_default()),
        false => Of::Truth,
    });
    std::iter::once(Of::Track(0)).chain(others).collect()
}

/// A propagator in a few words, as titles and legends have it.
pub fn describe(propagation: &Propagation) -> String {
    let clamp = if propagation.clamp { "" } else { ", no clamp" };
    let levels = match propagation.levels {
        Policy::Same => "",
        Policy::Consistent => ", consistent",
        Policy::Exact => ", exact",
        Policy::Ahead => ", ahead",
    };
    format!("{}, p = {}{levels}{clamp}", propagation.scheme, propagation.factor)
}
