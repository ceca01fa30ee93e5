//! Every way light travels, as siblings: the schemes of the [`lattice`] that send two bands of spherical
//! harmonics from cell to cell, [`ordinates`] that keep their direction, and the [`ballistic`] reference, which is
//! what truly arrives.
//!
//! All of them take a [`Problem`](crate::scene::Problem) and grids; none knows the simulation that steps it. [`kinds`] is
//! the list of those that can be stepped: what each of them can do is asked there.

pub(crate) mod arrivals;
pub mod ballistic;
pub mod descent;
pub(crate) mod divergence;
#[cfg(feature = "gpu")]
pub mod gpu;
pub(crate) mod kind;
pub mod lattice;
pub mod options;
pub mod ordinates;
pub mod preset;
mod refusal;
pub(crate) mod solve;
pub(crate) mod state;
pub mod team;
pub mod transmittance;

use std::sync::LazyLock;

pub use arrivals::Arrivals;
pub use divergence::Divergence;
pub use kind::{Capabilities, Kind, Law, Precision, Setup, Transport};
pub use refusal::{Refusal, refuse_what_does_not_fit};
pub use solve::{Converged, Found, NoFixedPoint, Solve, solve};
pub use state::{Light, State};

use crate::scene::Propagation;
use crate::scene::error::{Fault, nearest, quote};

/// Every kind of transport that presets may ask for, the default first.
pub fn kinds() -> &'static [Kind] {
    static KINDS: LazyLock<Vec<Kind>> = LazyLock::new(|| {
        let mut kinds = Vec::new();
        kinds.extend(descent::kinds().into_iter().map(on_card));
        kinds.extend(ordinates::kinds());
        kinds
    });
    &KINDS
}

/// The same kind, which a graphics card computes, too.
#[cfg(feature = "gpu")]
fn on_card(kind: Kind) -> Kind {
    Kind { card: Some(gpu::card::OnCard::build), ..kind }
}

/// Without the feature `gpu` no card computes anything.
#[cfg(not(feature = "gpu"))]
fn on_card(kind: Kind) -> Kind {
    kind
}

/// The kind called `name`.
///
/// ```
/// let cascaded = lpv_lab::transport::find("cascaded").unwrap();
/// assert!(cascaded.can.levels && cascaded.can.occluders && cascaded.double.is_some());
/// assert!(lpv_lab::transport::find("no such transport").is_none());
/// ```
pub fn find(name: &str) -> Option<&'static Kind> {
    kinds().iter().find(|kind| kind.name == name)
}

/// The kind called `name`, or an error that names those there are.
pub fn known(name: &str) -> Result<&'static Kind, Refusal> {
    find(name).ok_or_else(|| Refusal::unknown(name, &names()))
}

/// The name of everything that a preset may call its scheme, the default first.
pub fn names() -> Vec<&'static str> {
    kinds().iter().map(|kind| kind.name).collect()
}

/// Whether there is a transport of the name that a setting asks for, and it can run the setting.
pub fn check(propagation: &Propagation) -> Result<(), Fault> {
    if let Some(kind) = find(&propagation.scheme) {
        return (kind.check)(propagation);
    }
    let (what, known) = (format!("the scheme {} is not known", quote(&propagation.scheme)), names());
    let remedy = match nearest(&propagation.scheme, &known) {
        Some(near) => format!("did you mean `{near}`? Known are {}", known.join(", ")),
        None => format!("known are {}", known.join(", ")),
    };
    Err(Fault::new(what, remedy).field("scheme"))
}
