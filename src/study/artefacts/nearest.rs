//! The lit cell that is nearest to each cell of a volume.

use crate::field::Cell;

/// No lit cell at all.
const NONE: u32 = u32::MAX;

/// For every finest cell the nearest of some cells, by the straight distance; of equals any.
#[derive(Clone, Debug)]
pub(super) struct Nearest {
    n: usize,
    /// x fastest, numbers in the list that it was made of.
    nearest: Vec<u32>,
}

impl Nearest {
    /// Among the cells `lights` of an n³ volume.
    ///
    /// Axis by axis: the nearest cell of a plane is the nearest one of a row of it, brought there by another row
    /// (T. Saito and J. Toriwaki, "New algorithms for Euclidean distance transformation", 1994).
    pub(super) fn new(n: usize, lights: &[Cell]) -> Self {
        let mut found = Nearest { n, nearest: vec![NONE; n.pow(3)] };
        for (number, light) in lights.iter().enumerate() {
            let at = found.place(*light);
            found.nearest[at] = number as u32;
        }
        let mut line = vec![NONE; n];
        for axis in 0..3 {
            for (u, v) in (0..n).flat_map(|v| (0..n).map(move |u| (u, v))) {
                let cell = |along: usize| -> Cell {
                    let mut cell = [u, u, u];
                    cell[axis] = along;
                    cell[(axis + 1) % 3] = u;
                    cell[(axis + 2) % 3] = v;
                    cell
                };
                for (i, number) in line.iter_mut().enumerate() {
                    *number = found.nearest[found.place(cell(i))];
                }
                for i in 0..n {
                    let at = found.place(cell(i));
                    found.nearest[at] = nearest_in_line(&line, lights, i, cell(i));
                }
            }
        }
        found
    }

    /// The number of the light that is nearest to a cell; `None` where there is no light.
    pub(super) fn of(&self, cell: Cell) -> Option<usize> {
        Some(self.nearest[self.place(cell)]).filter(|number| *number != NONE).map(|number| number as usize)
    }

    fn place(&self, [x, y, z]: Cell) -> usize {
        (z * self.n + y) * self.n + x
    }
}

/// Of the lights that the cells of a line know the nearest to `cell`, the line's `at`-th, looking outwards until the
/// way along the line alone is too long.
fn nearest_in_line(line: &[u32], lights: &[Cell], at: usize, cell: Cell) -> u32 {
    let (mut best, mut least) = (NONE, usize::MAX);
    for away in 0..line.len() {
        if away * away >= least {
            break;
        }
        let both = [at.checked_sub(away), Some(at + away).filter(|i| *i < line.len() && away > 0)];
        for number in both.into_iter().flatten().map(|i| line[i]).filter(|number| *number != NONE) {
            let light = lights[number as usize];
            let distance: usize = light.iter().zip(cell).map(|(a, b)| a.abs_diff(b).pow(2)).sum();
            if distance < least {
                (best, least) = (number, distance);
            }
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Layout;

    #[test]
    fn the_nearest_is_as_near_as_looking_at_all_of_them_finds() {
        let lights = [[0, 0, 0], [7, 2, 5], [3, 3, 3], [3, 7, 0], [6, 6, 7]];
        let nearest = Nearest::new(8, &lights);
        let distance = |a: Cell, b: Cell| -> usize { a.iter().zip(b).map(|(a, b)| a.abs_diff(b).pow(2)).sum() };
        for cell in Layout::new(8).cells() {
            let least = lights.iter().map(|light| distance(*light, cell)).min();
            assert_eq!(nearest.of(cell).map(|number| distance(lights[number], cell)), least, "{cell:?}");
        }
        assert_eq!(Nearest::new(4, &[]).of([1, 2, 3]), None);
    }
}
