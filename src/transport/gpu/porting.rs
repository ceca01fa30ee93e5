//! The page that goes with exported kernels: what they are bound to, how they are called, what to check first.

use std::fmt::Write;

use super::layout::GROUP;
use super::text::{Constants, Kernel, Solids};

/// What a kernel's bindings are, number and sentence.
fn bindings(kernel: Kernel) -> &'static [(u32, &'static str)] {
    match kernel {
        Kernel::Inject => &[
            (2, "the lights: vec4 (c00, X, Y, Z), then the cell x, y, z and an unused number; each cell at most once"),
            (3, "the source grid, read and written"),
            (4, "the accumulated grid, read and written"),
            (5, "marks, a bit a cell"),
        ],
        Kernel::Downsample => &[
            (2, "the next finer level"),
            (3, "the level to fill; `source_at` and `target_at` of job 0 say where both begin"),
            (5, "marks"),
        ],
        Kernel::Propagate => &[
            (2, "the source grids S_k"),
            (3, "the target grids S_k+1, all overwritten; swap with the source after every iteration"),
            (4, "the accumulated grids, to which S_k+1 is added"),
            (5, "marks"),
            (6, "masks: two words for every 32 cells, read only in the modes 16 and 32; else bind any 8 bytes"),
            (7, "decisions, four words a job: begin with (0, 0, 0, 1)"),
        ],
        Kernel::Solids => &[
            (2, "the source grids S_k"),
            (3, "the target grids S_k+1"),
            (4, "the accumulated grids"),
            (5, "marks"),
            (6, "masks"),
            (8, "the touched cells: job, place in its slabs, first entry of `around`, colour"),
            (9, "what is around them; the kernel's comments say what its entries are"),
        ],
        Kernel::Merge => {
            &[(2, "the accumulated grids of one channel, a job for each level"), (3, "the merged grid"), (5, "marks")]
        }
    }
}

/// What a kernel does and how many workgroups it takes.
fn call(kernel: Kernel) -> String {
    match kernel {
        Kernel::Inject => "adds a list of lights to the finest level: ceil(lights / 64) workgroups".into(),
        Kernel::Downsample => "fills one level from the next finer one: ceil(n^3 / 64) workgroups; call it level by level, for source and accumulated".into(),
        Kernel::Propagate => format!("one iteration of all jobs: the sum of ceil(slabs * n^2 / {GROUP}) over the jobs"),
        Kernel::Solids => "the same for the cells that solids touch: ceil(cells / 64), after `propagate`".into(),
        Kernel::Merge => "samples the octree: ceil(n^3 / 64) workgroups, n the finest side".into(),
    }
}

/// The kernels that a setting needs.
pub fn needed(constants: &Constants) -> Vec<Kernel> {
    let has_levels = constants.levels.len() > 1;
    Kernel::ALL
        .into_iter()
        .filter(|kernel| match kernel {
            Kernel::Solids => constants.solids.is_some(),
            Kernel::Downsample | Kernel::Merge => has_levels,
            Kernel::Inject | Kernel::Propagate => true,
        })
        .collect()
}

/// The page, in Markdown, for the kernels of a setting called `title` whose files end in `extension`.
pub fn page(title: &str, scheme: &str, factor: f64, constants: &Constants, extension: &str) -> String {
    let mut text = String::new();
    let mut line = |s: &str| {
        let _ = writeln!(text, "{s}");
    };
    line(&format!("# Kernels of {title}\n"));
    line(&format!(
        "Scheme `{scheme}`, factor p = {factor}, {} level{}. The text is the one that lpv-lab runs itself; on the same \
         input it gives the bits of the processor's loops.\n",
        constants.levels.len(),
        if constants.levels.len() == 1 { "" } else { "s" }
    ));
    line("## Light in cells\n");
    line(
        "A cell is four floats (c00, X, Y, Z). (X, Y, Z) points where light flows; in the published real basis \
         (c00, c1-1, c10, c11) it is X = -c11, Y = -c1-1, Z = +c10. Cells lie x fastest, z slowest, without padding. A \
         clamped cosine lobe about the unit vector n is (0.886226925, 1.023326708 n); it integrates to pi.\n",
    );
    line("## Bindings\n");
    line(
        "All in group (set, space) 0. Binding 0: `Jobs`, 16 bytes (how many, and the workgroups of them all) and up to 64 entries of 48 bytes, one for each \
         level and channel. Binding 1: `Step`, 16 bytes: 0, the mode, the iteration modulo 3, and 1 to go through the cells backwards (the newest are still in the cache where iterations take turns). The first number must \
         be 0: products are combined with it, so that no compiler fuses them with sums.\n",
    );
    for kernel in needed(constants) {
        line(&format!("### {}.{extension}, entry point `{}`\n", kernel.name(), kernel.name()));
        line(&format!("{}.\n", call(kernel)));
        for (binding, what) in bindings(kernel) {
            line(&format!("- binding {binding}: {what}"));
        }
        line("");
    }
    line(&format!(
        "A dispatch in two dimensions is read as x + y * (workgroups in x). `propagate` has workgroups of {GROUP}, the \
         others of 64. In mode 0 every face is clamped. Mode 3 uses the linear form once `decisions` proves that no clamp \
         acts any more, which changes nothing but the rounding; 4 and 8 together make the first iteration of NVIDIA's \
         sample; 16 leaves the cells of the masks' first words to `solids`, 64 lets blockers weaken light there; 32 \
         accumulates in the cells of the masks' second words only.\n"
    ));
    line("## The constants\n");
    line("| | ahead | each side | |\n|---|---|---|---|");
    if let Some((form, _)) = constants.levels.first() {
        let side = |i: usize| form.side.map_or("-".to_owned(), |side| format!("{:?}", side.sampler[i]));
        line(&format!("| c00 into the flux | {:?} | {} | weight x 1/(2 sqrt pi) |", form.ahead.sampler[0], side(0)));
        line(&format!(
            "| along the way | {:?} | {} | weight x sqrt 3/(2 sqrt pi) x cosine |",
            form.ahead.sampler[1],
            side(1)
        ));
        line(&format!("| across it | 0 | {} | weight x sqrt 3/(2 sqrt pi) x sine |", side(2)));
        let lobe = |i: usize| form.side.map_or("-".to_owned(), |side| format!("{:?}", side.lobe[i]));
        line(&format!("| flux into c00 | {:?} | {} | p x sqrt pi / 2 |", form.ahead.lobe[0], lobe(0)));
        line(&format!("| flux into the direction | {:?} | {} | p x sqrt(pi/3) |\n", form.ahead.lobe[1], lobe(2)));
    }
    if scheme == "cascaded" {
        line(
            "The weight of the far face is 0.4006696846 / 4 pi, with 4 asin(1/10) = 0.4006696846; that of a side face \
             0.4234313544 / 4 pi, with (2 pi/3 - 0.4006696846) / 4 = 0.4234313544. The five solid angles fill that of the \
             shared face, 2 pi/3. Many ports carry 0.4234413544, one digit wrong. A side face lies in the direction \
             (2 d + f)/sqrt 5: cosine 0.894427191, sine 0.447213595.\n",
        );
    }
    if let Some(Solids::Fuzzy { .. }) = constants.solids {
        line("Light that blockers send back is multiplied by 4.8 and not by p.\n");
    }
    line("## What to check first\n");
    line(
        "1. One lobe (0.886226925, 1.023326708, 0, 0) in the middle, one iteration: write yours with the same layout and hold \
         it against `lpv-lab cells PRESET --iterations 1 --out cells.csv`.\n\
         2. The same lobe along y and z: the grids must be the first one, turned. Ports that err on one axis pass every test \
         of energy.\n\
         3. The sum of c00 over a uniform grid, away from the border, is multiplied by p/4 in an iteration (`cascaded`).\n\
         4. After k iterations no light lies more than k steps from its cell.\n\
         5. `lpv-lab identify` names what is wrong from two or three dumps of your grids.",
    );
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::lattice::kernel::form::Form;
    use crate::transport::lattice::schemes;
    use crate::transport::lattice::stencil::Stencil;

    /// Every binding of every text is told of on the page, and no other.
    #[test]
    fn the_page_tells_of_every_binding() {
        let stencil = Stencil::<f32>::new(&schemes::find("cascaded").unwrap(), 3.0, true);
        let levels = vec![(Form::of(&stencil).unwrap(), stencil); 2];
        let constants = Constants { levels, plain: false, solids: Some(Solids::Hard) };
        assert_eq!(needed(&constants), Kernel::ALL);
        for kernel in Kernel::ALL {
            let text = kernel.text(&constants);
            for binding in 2..12 {
                let is_bound = text.contains(&format!("@binding({binding})"));
                assert_eq!(
                    is_bound,
                    bindings(kernel).iter().any(|(b, _)| *b == binding),
                    "{} {binding}",
                    kernel.name()
                );
            }
        }
        let page = page("two walls", "cascaded", 3.0, &constants, "wgsl");
        assert!(page.contains("0.4234313544 / 4 pi") && page.contains("merge.wgsl"));
    }
}
