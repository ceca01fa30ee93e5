//! Test patterns: lobes to inject into a port, so that a few dumps of its grid tell what it does.
//!
//! - **Weak cells.** A lobe n of multiplier m and one of −n of 0.45·m make a cell whose flux is positive through every
//!   face, whatever a port does with negative flux. Its neighbours' light is then linear in its own, and four such
//!   cells with independent directions fix the 4×4 shares of all six directions of travel.
//! - **Tilted strong cells.** A lone lobe, aslant of the axes, sends negative flux through some faces: clamps show.
//! - **A twin.** In `spaced16` one cell holds the lobe of another, three times as bright and elsewhere: a spread that
//!   is not proportional to the light, or that depends on the place, shows.
//! - **Cells at borders** and in corners show what a port reads outside of its grid.
//! - No two cells of a `spaced` pattern have a common neighbour, so each number of the next grid has one cause. No
//!   two lights are alike under a symmetry of the cube, so the dump's axes show.
//! - **`dense`** lights every cell, two thirds of them weak: many numbers for one weight, so that even in half
//!   precision a wrong digit of a weight shows.

use glam::DVec3;

use crate::field::Cell;
use crate::sh::Sh;

/// The patterns that there are: name, side and file.
const FILES: [(&str, usize, &str); 3] = [
    ("spaced", 8, include_str!("../../presets/patterns/spaced8.csv")),
    ("spaced", 16, include_str!("../../presets/patterns/spaced16.csv")),
    ("dense", 8, include_str!("../../presets/patterns/dense8.csv")),
];

/// One light of a pattern.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lobe {
    /// The cell it is injected into.
    pub cell: Cell,
    /// Where it shines, of any length.
    pub direction: DVec3,
    /// What its clamped cosine lobe is multiplied with.
    pub multiplier: f64,
}

impl Lobe {
    /// Its light: the multiplier times the clamped cosine lobe about its direction (000, 3.1, eq. 6).
    pub fn light(&self) -> Sh<f64> {
        Sh::lobe(self.direction.normalize()) * self.multiplier
    }
}

/// A list of lobes for a grid of one size; lobes in one cell add up.
///
/// ```
/// use lpv_lab::study::pattern::Pattern;
///
/// let pattern = Pattern::find("spaced", 8).unwrap();
/// assert_eq!(pattern.lobes().len(), 15);
/// assert_eq!(pattern.csv().lines().nth(1), Some("2,2,2,1,2,3,1"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    name: &'static str,
    side: usize,
    csv: &'static str,
    lobes: Vec<Lobe>,
}

impl Pattern {
    /// The pattern of a name and size.
    pub fn find(name: &str, side: usize) -> Option<Pattern> {
        let (name, side, csv) = FILES.into_iter().find(|(n, s, _)| *n == name && *s == side)?;
        let lobes = csv.lines().skip(1).filter_map(lobe).collect();
        Some(Pattern { name, side, csv, lobes })
    }

    /// Every pattern's name and size.
    pub fn list() -> impl Iterator<Item = (&'static str, usize)> {
        FILES.into_iter().map(|(name, side, _)| (name, side))
    }

    /// Its name.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Cells along a side of the grid it is for.
    pub fn side(&self) -> usize {
        self.side
    }

    /// Its lobes.
    pub fn lobes(&self) -> &[Lobe] {
        &self.lobes
    }

    /// The lobes as CSV, `x,y,z,dx,dy,dz,multiplier`.
    pub fn csv(&self) -> &'static str {
        self.csv
    }

    /// A preset that injects it.
    pub fn preset(&self) -> String {
        let rows = self.csv.lines().skip(1).filter_map(fields).map(|[x, y, z, dx, dy, dz, multiplier]| {
            format!("        (kind: Single(cell: ({x}, {y}, {z})), direction: ({dx}, {dy}, {dz}), multiplier: {multiplier}),\n")
        });
        format!(
            "(\n    version: 1,\n    title: \"Test pattern {}{} for identify\",\n    size: {},\n    injectors: [\n{}    ],\n    \
             propagation: (scheme: \"cascaded\", factor: 3.0, iterations: 4, snapshots: Thesis, clamp: true),\n)\n",
            self.name,
            self.side,
            self.side,
            rows.collect::<String>()
        )
    }

    /// The lobes as a C header.
    pub fn header(&self) -> String {
        let rows = self.csv.lines().skip(1).filter_map(fields).map(|[x, y, z, dx, dy, dz, multiplier]| {
            let [dx, dy, dz, multiplier] = [dx, dy, dz, multiplier].map(literal);
            format!("    {{ {{ {x}, {y}, {z} }}, {{ {dx}, {dy}, {dz} }}, {multiplier} }},\n")
        });
        let name = format!("lpv_pattern_{}{}", self.name, self.side);
        format!(
            "/* Test pattern {name_and_side}: clamped cosine lobes to add to the cells of an empty {n} x {n} x {n} grid.\n   \
             A lobe is multiplier * (sqrt(pi)/2, sqrt(pi/3) * direction / length(direction)), its second band with the\n   \
             signs of the basis that the grid uses. Lobes in one cell add up. */\n\
             #ifndef {guard}\n#define {guard}\n\n\
             static const struct {{\n    int cell[3];\n    float direction[3];\n    float multiplier;\n}} {name}[{count}] = {{\n{rows}}};\n\n#endif\n",
            name_and_side = format_args!("{}{}", self.name, self.side),
            n = self.side,
            guard = name.to_uppercase() + "_H",
            count = self.lobes.len(),
            rows = rows.collect::<String>()
        )
    }
}

/// A number as C writes a float.
fn literal(number: &str) -> String {
    let point = if number.contains('.') { "" } else { ".0" };
    format!("{number}{point}f")
}

fn fields(line: &str) -> Option<[&str; 7]> {
    let mut fields = line.split(',');
    let all = [(); 7].map(|()| fields.next());
    all.iter().all(Option::is_some).then(|| all.map(Option::unwrap_or_default))
}

fn lobe(line: &str) -> Option<Lobe> {
    let [x, y, z, dx, dy, dz, multiplier] = fields(line)?;
    let cell = [x.parse().ok()?, y.parse().ok()?, z.parse().ok()?];
    let direction = DVec3::new(dx.parse().ok()?, dy.parse().ok()?, dz.parse().ok()?);
    Some(Lobe { cell, direction, multiplier: multiplier.parse().ok()? })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pattern_is_read_whole_and_stays_inside() {
        for (name, side) in Pattern::list() {
            let pattern = Pattern::find(name, side).unwrap();
            assert_eq!(pattern.lobes().len() + 1, pattern.csv().lines().count(), "{name}{side}");
            for lobe in pattern.lobes() {
                assert!(lobe.cell.iter().all(|c| *c < side) && lobe.multiplier > 0.0 && lobe.direction.length() > 0.5);
            }
        }
        assert_eq!(Pattern::find("spaced", 9), None);
    }

    #[test]
    fn cells_of_spaced_patterns_have_no_common_neighbour() {
        for side in [8, 16] {
            let pattern = Pattern::find("spaced", side).unwrap();
            for (a, b) in pattern.lobes().iter().flat_map(|a| pattern.lobes().iter().map(move |b| (a.cell, b.cell))) {
                let distance: usize = (0..3).map(|i| a[i].abs_diff(b[i])).sum();
                assert!(a == b || distance > 2, "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn the_header_holds_floats_and_every_lobe() {
        let header = Pattern::find("spaced", 8).unwrap().header();
        assert!(header.contains("lpv_pattern_spaced8[15]"));
        assert!(header.contains("{ { 2, 2, 2 }, { 1.0f, 2.0f, 3.0f }, 1.0f },"));
        assert_eq!(header.matches("    { { ").count(), 15);
    }
}
