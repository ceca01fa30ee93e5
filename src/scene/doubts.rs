//! What a preset may say and hardly means: told as a warning with its place, because nothing is impossible about it.
//!
//! Light that a surface sends is nowhere negative. The longest lobe that is sent here is a cosine's,
//! max(0, cos θ): its mean coefficient is √π/2 and its direction's length √(π/3) (000, 3.2), a ratio of 2/√3. Sums of
//! such lobes are no longer in proportion, whichever way they point, so light from a file that is longer, or whose mean
//! is negative, has not been sent by surfaces. Iterations without the clamp do make such light, and it may be injected
//! again.

use super::error::{Fault, Step};
use super::injector::{Injector, InjectorKind};
use super::{Preset, Problem};
use crate::field::Cell;
use crate::sh::Sh;

/// How far above a cosine's a lobe may be, in proportion: rounding in single precision, many sums long.
const ROUNDING: f64 = 1e-3;

/// Everything about a preset's light that is to be doubted, in the preset's order. `problem` is what the preset became.
pub fn doubts(preset: &Preset, problem: &Problem) -> Vec<Fault> {
    let enabled = preset.injectors.iter().enumerate().filter(|(_, injector)| injector.enabled);
    let lit = enabled.zip(&problem.sources);
    lit.filter_map(|((i, injector), source)| {
        let fault = of_file(injector, &source.light)?;
        Some(fault.within(Step::Item(i)).within(Step::Field("injectors")))
    })
    .collect()
}

/// What is odd about the light of a file.
fn of_file(injector: &Injector, light: &[(Cell, Sh<f64>)]) -> Option<Fault> {
    let InjectorKind::File { path, .. } = &injector.kind else { return None };
    let odd = |sh: &Sh<f64>| is_negative(sh) || is_too_long(sh);
    let count = light.iter().filter(|(_, sh)| odd(sh)).count();
    let ([x, y, z], sh) = light.iter().find(|(_, sh)| odd(sh))?;
    let what = if is_negative(sh) { "is negative in the mean" } else { "has a longer lobe than a cosine's" };
    let remedy = "in light that surfaces send, c00 is at least 0.866 times the length of (c1-1, c10, c11)";
    let others = match count - 1 {
        0 => String::new(),
        1 => " and that of one more cell".to_owned(),
        more => format!(" and that of {more} more cells"),
    };
    let what = format!("light in `{}`, cell ({x}, {y}, {z}){others}, {what}", path.display());
    Some(Fault::new(what, remedy).field("path").field("kind"))
}

fn is_negative(sh: &Sh<f64>) -> bool {
    sh.0[0] < 0.0
}

fn is_too_long(sh: &Sh<f64>) -> bool {
    let [mean, x, y, z] = sh.0;
    let longest = 2.0 / 3f64.sqrt() * (1.0 + ROUNDING);
    (x * x + y * y + z * z).sqrt() > longest * mean
}
