//! A problem's scheme as exact levels and descents take it: in the form of the fast loops, and as what one step sends to
//! a neighbour once no clamp acts.

use super::kernel::form::{Form, Share};
use super::schemes;
use super::stencil::Stencil;
use crate::scene::Problem;
use crate::sh::Real;
use crate::transport::refusal::Refusal;

/// The scheme of `problem`; `what` is told where it cannot be had so.
pub fn linear_form<T: Real>(problem: &Problem, what: &'static str) -> Result<(Form<T>, Share<f64>), Refusal> {
    let propagation = &problem.propagation;
    let scheme =
        schemes::find(&propagation.scheme).ok_or_else(|| Refusal::unknown(&propagation.scheme, &schemes::names()))?;
    let form = Form::of(&Stencil::<T>::new(&scheme, propagation.factor, propagation.clamp));
    form.map(|form| (form, widened(form.share))).ok_or_else(|| {
        let is_the_factor = Form::of(&Stencil::<f64>::new(&scheme, 1.0, propagation.clamp)).is_some();
        let (setting, remedy) = if is_the_factor {
            (format!("the factor {:e}", propagation.factor), "use a smaller one")
        } else {
            (format!("the scheme {}", propagation.scheme), "use a scheme with one face ahead and four beside it")
        };
        Refusal::Underived { what, setting, remedy }
    })
}

/// The numbers of a share in double precision.
fn widened<T: Real>(share: Share<T>) -> Share<f64> {
    let Share { alpha, beta, gamma, delta, epsilon } = share;
    let [alpha, beta, gamma, delta, epsilon] = [alpha, beta, gamma, delta, epsilon].map(T::to_f64);
    Share { alpha, beta, gamma, delta, epsilon }
}
