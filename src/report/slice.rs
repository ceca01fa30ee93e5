//! A flat cut through the volume: one level, or the merged light with the borders between levels.
//!
//! On paper x always runs to the right and y always up; z takes the place that is left. So a cut
//! across z is seen from +z, cuts across x and y from −x and −y:
//!
//! | cut across | columns, to the right | rows, upwards |
//! |---|---|---|
//! | z | x | y |
//! | y | x | z |
//! | x | z | y |

use crate::field::{Cell, Channels, Grid, IndexVolume, Octree};
use crate::sh::Sh;
use crate::simulation::Simulation;
use crate::study::light;

/// The axis that a cut is made across.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Axis {
    /// Columns along z, rows along y.
    X,
    /// Columns along x, rows along z.
    Y,
    /// Columns along x, rows along y; the thesis's view (000, 5.1).
    #[default]
    Z,
}

impl Axis {
    /// All three, in the order of their names.
    pub const ALL: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];

    /// The coordinate that is the same all over the cut: 0 for x, 1 for y, 2 for z.
    pub fn across(self) -> usize {
        self as usize
    }

    /// The coordinate that grows to the right.
    pub fn columns(self) -> usize {
        match self {
            Axis::X => 2,
            Axis::Y | Axis::Z => 0,
        }
    }

    /// The coordinate that grows upwards.
    pub fn rows(self) -> usize {
        match self {
            Axis::Y => 2,
            Axis::X | Axis::Z => 1,
        }
    }

    /// The name of a coordinate.
    pub fn name(coordinate: usize) -> &'static str {
        ["x", "y", "z"][coordinate]
    }

    /// The cell at a column and a row of the cut at `index`, all in cells of the same level.
    pub fn cell(self, index: usize, column: usize, row: usize) -> Cell {
        let mut cell = [index; 3];
        cell[self.columns()] = column;
        cell[self.rows()] = row;
        cell
    }

    /// A vector's parts to the right and upwards.
    pub fn project(self, vector: [f32; 3]) -> [f32; 2] {
        [vector[self.columns()], vector[self.rows()]]
    }
}

/// Where a cut is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Plane {
    /// The axis it is made across.
    pub axis: Axis,
    /// How far along that axis, in finest cells, from 0 to n − 1. Beyond the last cell the last is meant.
    pub index: usize,
}

/// One sample of light and the square that it is drawn in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SliceCell {
    /// The square's left side, in finest cells.
    pub column: usize,
    /// The square's lower side, in finest cells; rows count upwards.
    pub row: usize,
    /// The square's side, in finest cells.
    pub span: usize,
    /// The octree level that the light was sampled from.
    pub level: usize,
    /// The sampled cell, counted in its own level.
    pub cell: Cell,
    /// The light in red, green and blue.
    pub light: [Sh<f32>; 3],
}

impl SliceCell {
    /// The middle of the square, in finest cells from the lower left corner of the slice.
    pub fn centre(&self) -> [f32; 2] {
        let half = self.span as f32 / 2.0;
        [self.column as f32 + half, self.row as f32 + half]
    }
}

/// A straight line between corners of finest cells, (column, row) from the lower left corner of the slice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Border {
    /// The lower or left end.
    pub from: [usize; 2],
    /// The upper or right end.
    pub to: [usize; 2],
}

/// A cut through the light: squares that cover it once, and where neighbours come from different levels.
#[derive(Clone, Debug, PartialEq)]
pub struct Slice {
    /// Where it was made.
    pub plane: Plane,
    /// Finest cells along a side, n.
    pub side: usize,
    /// The samples, which together cover every finest cell of the cut exactly once.
    pub cells: Vec<SliceCell>,
    /// Lines between neighbouring finest cells whose levels differ; to be drawn bolder (000, figure 14).
    pub borders: Vec<Border>,
}

impl Slice {
    /// Takes the light of another cut of the same side away, cell by cell.
    ///
    /// ```
    /// use lpv_lab::field::{Channels, Grid};
    /// use lpv_lab::report::slice::{Plane, Slice};
    /// use lpv_lab::sh::Sh;
    ///
    /// let mut grid = Grid::<f32>::new(4);
    /// grid.set([1, 2, 0], Sh([1.0, 0.5, 0.0, 0.0]));
    /// let white = Channels::of_colors(&[[1.0; 3]]);
    /// let mut slice = Slice::level(&[&grid], &white, 0, Plane::default());
    /// slice.subtract(&slice.clone());
    /// assert!(slice.cells.iter().all(|cell| cell.light[0].is_zero()));
    /// ```
    pub fn subtract(&mut self, other: &Slice) {
        let mut light = vec![[Sh::ZERO; 3]; other.side * other.side];
        for cell in &other.cells {
            for row in cell.row..cell.row + cell.span {
                let start = row * other.side + cell.column;
                light[start..start + cell.span].fill(cell.light);
            }
        }
        for cell in &mut self.cells {
            let taken = light.get(cell.row * other.side + cell.column).copied().unwrap_or_default();
            cell.light = std::array::from_fn(|c| cell.light[c] - taken[c]);
        }
    }

    /// A cut through one level; `grids` holds that level of each channel.
    pub fn level(grids: &[&Grid<f32>], channels: &Channels, level: usize, plane: Plane) -> Self {
        let side = grids.first().map_or(0, |grid| grid.side());
        let n = side << level;
        let plane = Plane { index: plane.index.min(n.saturating_sub(1)), ..plane };
        let span = 1 << level;
        let mut cells = Vec::with_capacity(side * side);
        for row in 0..side {
            for column in 0..side {
                let cell = plane.axis.cell(plane.index >> level, column, row);
                let light = mix(channels, |channel| grids[channel].get(cell));
                cells.push(SliceCell { column: column * span, row: row * span, span, level, cell, light });
            }
        }
        Slice { plane, side: n, cells, borders: Vec::new() }
    }

    /// A cut through the merged light S(x, y, z) of (000, 4.2); `octrees` holds one octree a channel.
    ///
    /// A coarse sample is one square of its own size where all finest cells that it covers in the
    /// cut are sampled from its level. Where finer light lies within it, the finest cells that are
    /// left to it are squares of their own, each with the coarse sample's light.
    pub fn merged(octrees: &[&Octree<f32>], index: &IndexVolume, channels: &Channels, plane: Plane) -> Self {
        let side = index.sizes().finest();
        let plane = Plane { index: plane.index.min(side - 1), ..plane };
        let mut levels = Vec::with_capacity(side * side);
        for row in 0..side {
            levels.extend((0..side).map(|column| index.index(plane.axis.cell(plane.index, column, row))));
        }
        let levels = LevelMap { side, levels };
        let mut cells = Vec::new();
        let blocks = index.sizes().coarsest();
        let coarsest = index.sizes().count() - 1;
        for block in (0..blocks * blocks).map(|i| [i % blocks, i / blocks]) {
            levels.squares(coarsest, block, &mut |[column, row], span| {
                let level = levels.at([column, row]);
                let cell = plane.axis.cell(plane.index, column, row).map(|c| c >> level);
                let light = mix(channels, |channel| octrees[channel].level(level).get(cell));
                cells.push(SliceCell { column, row, span, level, cell, light });
            });
        }
        Slice { plane, side, cells, borders: levels.borders() }
    }

    /// A cut through the merged light of a run: as it is sampled, or cell by cell where levels are blended.
    pub fn of_merged(run: &Simulation<f32>, plane: Plane) -> Self {
        if run.blends_levels() {
            let merged = light::sampled(run);
            return Slice::level(&merged.iter().collect::<Vec<_>>(), run.channels(), 0, plane);
        }
        let octrees: Vec<_> = run.lights().iter().map(|light| &light.accumulated).collect();
        Slice::merged(&octrees, run.index(), run.channels(), plane)
    }

    /// The side of the cells that its axes count, in finest cells: that of its level, 1 for merged light.
    pub fn unit(&self) -> usize {
        let same = |cell: &&SliceCell| self.cells.iter().all(|other| other.span == cell.span);
        self.cells.first().filter(same).map_or(1, |cell| cell.span)
    }

    /// The sample drawn at a finest cell, (column, row), or `None` outside the slice.
    pub fn at(&self, [column, row]: [usize; 2]) -> Option<&SliceCell> {
        let covers = |from: usize, span: usize, at: usize| (from..from + span).contains(&at);
        self.cells.iter().find(|cell| covers(cell.column, cell.span, column) && covers(cell.row, cell.span, row))
    }
}

/// Red, green and blue from the channels that are carried.
fn mix(channels: &Channels, light: impl Fn(usize) -> Sh<f32>) -> [Sh<f32>; 3] {
    channels.rgb().map(|share| light(share.channel) * share.scale as f32)
}

/// The level that each finest cell of a cut is sampled from, row by row.
struct LevelMap {
    side: usize,
    levels: Vec<usize>,
}

impl LevelMap {
    fn at(&self, [column, row]: [usize; 2]) -> usize {
        self.levels[row * self.side + column]
    }

    /// Hands the squares within a block of `level` to `draw`, each by its lower left corner and span.
    fn squares(&self, level: usize, [column, row]: [usize; 2], draw: &mut impl FnMut([usize; 2], usize)) {
        let span = 1 << level;
        let corner = [column * span, row * span];
        let whole = (corner[1]..corner[1] + span).all(|row| {
            let start = row * self.side + corner[0];
            self.levels[start..start + span].iter().all(|found| *found == level)
        });
        if whole || level == 0 {
            draw(corner, span);
        } else {
            for [right, up] in [[0, 0], [1, 0], [0, 1], [1, 1]] {
                self.squares(level - 1, [2 * column + right, 2 * row + up], draw);
            }
        }
    }

    /// The lines between neighbours of different levels, unit lines joined to the longest straight runs.
    fn borders(&self) -> Vec<Border> {
        let mut borders: Vec<Border> = Vec::new();
        let mut join = |from: [usize; 2], to: [usize; 2]| match borders.last_mut() {
            Some(last) if last.to == from && (last.from[0] == to[0] || last.from[1] == to[1]) => last.to = to,
            _ => borders.push(Border { from, to }),
        };
        for fixed in 1..self.side {
            for along in 0..self.side {
                if self.at([fixed - 1, along]) != self.at([fixed, along]) {
                    join([fixed, along], [fixed, along + 1]);
                }
            }
            for along in 0..self.side {
                if self.at([along, fixed - 1]) != self.at([along, fixed]) {
                    join([along, fixed], [along + 1, fixed]);
                }
            }
        }
        borders
    }
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;
    use crate::field::Levels;

    fn white() -> Channels {
        Channels::of_colors(&[[1.0; 3]])
    }

    /// An octree whose every cell tells its level and place.
    fn labelled(n: usize) -> Octree<f32> {
        let mut octree = Octree::new(Levels::new(n, 1).unwrap());
        for level in 0..octree.sizes().count() {
            for cell in octree.level(level).layout().cells() {
                octree.level_mut(level).set(cell, label(level, cell));
            }
        }
        octree
    }

    fn label(level: usize, [x, y, z]: Cell) -> Sh<f32> {
        Sh([level as f32, x as f32, y as f32, z as f32])
    }

    /// An index volume with a few lit cells on several levels, so that coarse samples are cut into.
    fn lit(n: usize) -> IndexVolume {
        let mut index = IndexVolume::new(Levels::new(n, 1).unwrap());
        index.level_mut(0).set([0, 0, 0]);
        index.level_mut(0).set([5, 2, 6]);
        index.level_mut(1).set([0, 1, 0]);
        index.level_mut(1).set([2, 1, 3]);
        index.level_mut(2).set([0, 0, 0]);
        index.level_mut(2).set([1, 0, 1]);
        index
    }

    #[test]
    fn a_level_is_read_at_its_own_cells() {
        let octree = labelled(8);
        for axis in Axis::ALL {
            let slice = Slice::level(&[octree.level(1)], &white(), 1, Plane { axis, index: 5 });
            assert_eq!((slice.side, slice.cells.len()), (8, 16));
            for cell in &slice.cells {
                assert_eq!((cell.span, cell.level, cell.cell[axis.across()]), (2, 1, 2));
                assert_eq!(cell.cell[axis.columns()] * 2, cell.column);
                assert_eq!(cell.cell[axis.rows()] * 2, cell.row);
                assert_eq!(cell.light, [label(1, cell.cell); 3]);
            }
        }
    }

    #[test]
    fn an_index_beyond_the_volume_means_its_last_cell() {
        let octree = labelled(8);
        let slice = Slice::level(&[octree.level(1)], &white(), 1, Plane { axis: Axis::Z, index: 99 });
        assert!(slice.cells.iter().all(|cell| cell.cell[2] == 3));
        let slice = Slice::merged(&[&octree], &lit(8), &white(), Plane { axis: Axis::Z, index: 99 });
        assert_eq!(slice.plane.index, 7);
    }

    #[test]
    fn merged_squares_cover_every_finest_cell_once_with_its_own_sample() {
        let (octree, index) = (labelled(8), lit(8));
        for plane in Axis::ALL.into_iter().flat_map(|axis| (0..8).map(move |index| Plane { axis, index })) {
            let slice = Slice::merged(&[&octree], &index, &white(), plane);
            let mut covered = HashSet::new();
            for square in &slice.cells {
                assert!(square.span == 1 || square.span == 1 << square.level);
                for (c, r) in (0..square.span).flat_map(|c| (0..square.span).map(move |r| (c, r))) {
                    let at = [square.column + c, square.row + r];
                    assert!(covered.insert(at), "{at:?} twice in {plane:?}");
                    let finest = plane.axis.cell(plane.index, at[0], at[1]);
                    let level = index.index(finest);
                    assert_eq!(square.level, level);
                    assert_eq!(square.light[0], label(level, finest.map(|c| c >> level)));
                    assert_eq!(slice.at(at), Some(square));
                }
            }
            assert_eq!(covered.len(), 64);
        }
    }

    #[test]
    fn a_coarse_sample_is_one_square_only_where_nothing_finer_lies_in_it() {
        let slice = Slice::merged(&[&labelled(8)], &lit(8), &white(), Plane { axis: Axis::Z, index: 0 });
        // Level 2's cell (0, 0, 0) holds a lit finest cell and a lit level 1 cell: it is cut up.
        let spans = |level| slice.cells.iter().filter(|c| c.level == level).map(|c| c.span).collect::<Vec<_>>();
        assert_eq!(spans(0), [1]);
        assert_eq!(spans(1), [2]);
        assert_eq!(spans(2), [1; 11]);
        let dark = IndexVolume::new(Levels::new(8, 1).unwrap());
        let slice = Slice::merged(&[&labelled(8)], &dark, &white(), Plane::default());
        assert_eq!(slice.cells.iter().map(|c| c.span).collect::<Vec<_>>(), [8]);
    }

    #[test]
    fn borders_lie_exactly_where_levels_differ() {
        let (octree, index) = (labelled(8), lit(8));
        for plane in Axis::ALL.into_iter().flat_map(|axis| (0..8).map(move |index| Plane { axis, index })) {
            let level = |column: usize, row: usize| index.index(plane.axis.cell(plane.index, column, row));
            let mut expected = HashSet::new();
            for (c, r) in (0..8).flat_map(|c| (0..8).map(move |r| (c, r))) {
                if c > 0 && level(c, r) != level(c - 1, r) {
                    expected.insert(([c, r], [c, r + 1]));
                }
                if r > 0 && level(c, r) != level(c, r - 1) {
                    expected.insert(([c, r], [c + 1, r]));
                }
            }
            let slice = Slice::merged(&[&octree], &index, &white(), plane);
            let mut found = HashSet::new();
            for Border { from, to } in slice.borders {
                let step = if from[0] == to[0] { [0, 1] } else { [1, 0] };
                let mut at = from;
                while at != to {
                    let next = [at[0] + step[0], at[1] + step[1]];
                    assert!(found.insert((at, next)), "{at:?} twice in {plane:?}");
                    at = next;
                }
            }
            assert_eq!(found, expected, "{plane:?}");
        }
    }

    #[test]
    fn colours_are_mixed_from_their_channels() {
        let channels = Channels::of_colors(&[[1.0, 0.5, 0.0], [0.0, 0.0, 0.0]]);
        let octree = labelled(4);
        let slice = Slice::level(&[octree.level(0)], &channels, 0, Plane::default());
        let cell = slice.at([3, 1]).unwrap();
        let light = label(0, [3, 1, 0]);
        assert_eq!(cell.light, [light, light * 0.5, Sh::ZERO]);
    }
}
