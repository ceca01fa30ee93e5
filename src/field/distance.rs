//! How far every cell of a grid is from the nearest marked one, exactly.
//!
//! The square of a Euclidean distance is a sum over the axes, so it is found one axis after the other: along a line each
//! cell q stands for a parabola (x − q)² + f(q), f what the axes before have found, and the line's new values are the
//! lower envelope of those (Felzenszwalb and Huttenlocher 2012, Distance transforms of sampled functions). O(n³).

use super::index_volume::Marks;

/// The squared distance of every cell to the nearest marked one, in cells, x fastest; `None` where none is marked.
///
/// ```
/// use lpv_lab::field::{Marks, squared_distances};
///
/// let mut marks = Marks::new(4);
/// marks.set([1, 0, 0]);
/// let squared = squared_distances(&marks).expect("a cell is marked");
/// assert_eq!((squared[1], squared[0], squared[3 + 4 * 2]), (0, 1, 2 * 2 + 2 * 2));
/// assert_eq!(squared_distances(&Marks::new(4)), None);
/// ```
pub fn squared_distances(marks: &Marks) -> Option<Vec<u32>> {
    let n = marks.side();
    let mut squared: Vec<Option<u32>> = vec![None; n * n * n];
    let mut any = false;
    for [x, y, z] in marks.cells() {
        (squared[(z * n + y) * n + x], any) = (Some(0), true);
    }
    let mut line = Line { values: vec![None; n], parabolas: Vec::with_capacity(n) };
    for step in [1, n, n * n] {
        // The cells at which lines along this axis begin.
        for first in (0..n * n * n).filter(|i| i / step % n == 0) {
            let at = |k: usize| first + k * step;
            line.values.iter_mut().enumerate().for_each(|(k, value)| *value = squared[at(k)]);
            line.envelope(|k, value| squared[at(k)] = Some(value));
        }
    }
    any.then(|| squared.into_iter().flatten().collect())
}

/// One line of cells.
struct Line {
    values: Vec<Option<u32>>,
    /// Those that the envelope consists of: the cell, and from where on it is the lowest.
    parabolas: Vec<(usize, f64)>,
}

impl Line {
    /// Tells the lower envelope in every cell; nothing where no cell has a value.
    fn envelope(&mut self, mut tell: impl FnMut(usize, u32)) {
        self.parabolas.clear();
        let height = |q: usize, f: u32| (q * q) as f64 + f64::from(f);
        for (q, f) in self.values.iter().enumerate().filter_map(|(q, f)| Some((q, (*f)?))) {
            let mut from = f64::NEG_INFINITY;
            while let Some((last, begins)) = self.parabolas.last().copied() {
                let other = self.values[last].unwrap_or_default();
                from = (height(q, f) - height(last, other)) / (2.0 * (q - last) as f64);
                if from > begins {
                    break;
                }
                self.parabolas.pop();
                from = f64::NEG_INFINITY;
            }
            self.parabolas.push((q, from));
        }
        let mut lowest = 0;
        for k in (0..self.values.len()).filter(|_| !self.parabolas.is_empty()) {
            while self.parabolas.get(lowest + 1).is_some_and(|(_, from)| *from < k as f64) {
                lowest += 1;
            }
            let (q, _) = self.parabolas[lowest];
            tell(k, self.values[q].unwrap_or_default() + (k.abs_diff(q) as u32).pow(2));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::Layout;

    #[test]
    fn it_is_the_least_over_all_marked_cells() {
        for (n, every) in [(1, 1), (8, 1), (8, 37), (16, 211), (16, 4000)] {
            let mut marks = Marks::new(n);
            let marked: Vec<_> = Layout::new(n).cells().skip(every / 3).step_by(every).collect();
            marked.iter().for_each(|cell| marks.set(*cell));
            let squared = squared_distances(&marks).unwrap();
            for ([x, y, z], found) in Layout::new(n).cells().zip(squared) {
                let to = |[a, b, c]: &[usize; 3]| {
                    (x.abs_diff(*a).pow(2) + y.abs_diff(*b).pow(2) + z.abs_diff(*c).pow(2)) as u32
                };
                assert_eq!(Some(found), marked.iter().map(to).min(), "n = {n}, {x}, {y}, {z}");
            }
        }
    }
}
