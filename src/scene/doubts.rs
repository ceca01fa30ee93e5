//! What a preset may say and hardly means: told as a warning with its place, because nothing is impossible about it.
//!
//! Light that a surface sends is nowhere negative. The longest lobe that is sent here is a cosine's,
//! max(0, cos θ): its mean coefficient is √π/2 and its direction's length √(π/3) (000, 3.2), a ratio of 2/√3. Sums of
//! such lobes are no longer in proportion, whichever way they point, so light from a file that is longer, or whose mean
//! is negative, has not been sent by surfaces. Iterations without the clamp do make such light, and it may be injected
//! again.

use super::error::{Fault, Step};
use super::injector::{Injector, InjectorKind};
use super::occluder::OcclusionMode;
use super::{Preset, Problem, Source};
use crate::field::{Cell, memory_order};
use crate::sh::Sh;

/// How far above a cosine's a lobe may be, in proportion: rounding in single precision, many sums long.
const ROUNDING: f64 = 1e-3;

/// Everything about a preset's light that is to be doubted, in the preset's order. `problem` is what the preset became.
pub fn doubts(preset: &Preset, problem: &Problem) -> Vec<Fault> {
    let lit = |source: &Source| {
        source.color.iter().any(|part| *part > 0.0) && source.light.iter().any(|(_, sh)| !sh.is_zero())
    };
    if !problem.sources.iter().any(lit) {
        return vec![
            Fault::new("there is no light", "add an injector, switch one on, or give it a colour").field("injectors"),
        ];
    }
    let enabled = preset.injectors.iter().enumerate().filter(|(_, injector)| injector.enabled);
    let found = enabled.zip(&problem.sources).flat_map(|((i, injector), source)| {
        let faults = of_file(injector, &source.light).into_iter().chain(shut_in(problem, &source.light));
        faults.map(move |fault| fault.within(Step::Item(i)).within(Step::Field("injectors")))
    });
    found.collect()
}

/// Light that hard occluders keep in its cells: nothing can be learned from it.
fn shut_in(problem: &Problem, light: &[(Cell, Sh<f64>)]) -> Option<Fault> {
    if problem.occlusion.mode != OcclusionMode::Hard || problem.solids.is_empty() {
        return None;
    }
    let opaque = |cell: Cell| {
        let found = problem.solids.binary_search_by_key(&memory_order(cell), |solid| memory_order(solid.cell));
        found.is_ok_and(|i| problem.solids[i].opacity.iter().all(|opacity| *opacity >= 1.0))
    };
    let is_shut = |cell: Cell| {
        let neighbours = (0..6).map(|face| {
            let (axis, mut neighbour) = (face / 2, cell);
            neighbour[axis] = if face % 2 == 0 { cell[axis].checked_sub(1)? } else { cell[axis] + 1 };
            (neighbour[axis] < problem.size).then_some(neighbour)
        });
        // Through the volume's border light leaves.
        neighbours.into_iter().all(|neighbour| neighbour.is_some_and(opaque))
    };
    let count = light.iter().filter(|(cell, _)| is_shut(*cell)).count();
    let ([x, y, z], _) = light.iter().find(|(cell, _)| is_shut(*cell))?;
    let what = format!("{count} of {} lit cells are shut in by opaque ones, such as ({x}, {y}, {z})", light.len());
    Some(Fault::new(what, "light does not leave them; move it, or open a way"))
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
