//! The objects of a scene as they stand in a cut: where they are, and how they are moved, sized and turned.

use crate::field::Cell;
use crate::report::slice::{Axis as Across, Plane};
use crate::scene::Preset;
use crate::scene::injector::InjectorKind;
use crate::scene::occluder::{Axis, OccluderKind};

/// What the pointer does in a view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tool {
    /// Pin cells, choose and change objects.
    #[default]
    Select,
    /// Add an injector: a cell, or a rectangle of them.
    Light,
    /// Add an occluder: a block of cells.
    Occluder,
    /// Lay the line whose light is plotted through a cell.
    Probe,
}

impl Tool {
    /// Whether dragging it over cells marks them for something to add.
    pub fn marks_cells(self) -> bool {
        matches!(self, Tool::Light | Tool::Occluder)
    }
}

/// An object of the scene, by its place in the preset's list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Item {
    /// An injector.
    Injector(usize),
    /// An occluder.
    Occluder(usize),
}

impl Item {
    /// Its name in words.
    pub fn name(self) -> String {
        match self {
            Item::Injector(i) => format!("injector {}", i + 1),
            Item::Occluder(i) => format!("occluder {}", i + 1),
        }
    }

    /// All objects that are switched on, those that are drawn last first.
    pub fn all(preset: &Preset) -> Vec<Item> {
        let injectors = preset.injectors.iter().enumerate().filter(|(_, injector)| injector.enabled);
        let occluders = preset.occluders.iter().enumerate().filter(|(_, occluder)| occluder.enabled);
        let occluders = occluders.map(|(i, _)| Item::Occluder(i));
        injectors.map(|(i, _)| Item::Injector(i)).chain(occluders).collect()
    }

    /// Its corners, both within it; `None` for files, and for what is no longer there.
    pub fn corners(self, preset: &Preset) -> Option<[Cell; 2]> {
        let last = preset.size.saturating_sub(1);
        let slab = |axis: usize, at: usize| {
            let (mut from, mut to) = ([0; 3], [last; 3]);
            (from[axis], to[axis]) = (at, at);
            [from, to]
        };
        match self {
            Item::Injector(i) => match preset.injectors.get(i)?.kind {
                InjectorKind::Wall { side } => {
                    let inwards = side.inwards().to_array()[side.axis()] > 0.0;
                    Some(slab(side.axis(), if inwards { 0 } else { last }))
                }
                InjectorKind::Rectangle { from, to } => Some([from, to]),
                InjectorKind::Single { cell } => Some([cell, cell]),
                InjectorKind::File { .. } => None,
            },
            Item::Occluder(i) => match preset.occluders.get(i)?.kind {
                OccluderKind::Box { from, to } => Some([from, to]),
                OccluderKind::Plane { axis, at } => Some(slab(of(axis), at)),
                OccluderKind::File { .. } => None,
            },
        }
    }

    /// Where it crosses a cut: its lower left and upper right finest cells, (column, row); `None` where it does not.
    pub fn footprint(self, preset: &Preset, plane: Plane) -> Option<[[usize; 2]; 2]> {
        let [from, to] = self.corners(preset)?;
        let axis = plane.axis;
        let across = axis.across();
        let crossed = (from[across].min(to[across])..=from[across].max(to[across])).contains(&plane.index);
        let least = |part: usize| from[part].min(to[part]);
        let most = |part: usize| from[part].max(to[part]);
        let flat = |of: &dyn Fn(usize) -> usize| [of(axis.columns()), of(axis.rows())];
        crossed.then(|| [flat(&least), flat(&most)])
    }

    /// Whether it has corners of its own that can be moved.
    pub fn can_be_sized(self, preset: &Preset) -> bool {
        match self {
            Item::Injector(i) => {
                preset.injectors.get(i).is_some_and(|injector| matches!(injector.kind, InjectorKind::Rectangle { .. }))
            }
            Item::Occluder(i) => {
                preset.occluders.get(i).is_some_and(|occluder| matches!(occluder.kind, OccluderKind::Box { .. }))
            }
        }
    }

    /// Moves it by cells to the right and upwards in a cut, as far as it stays in the volume.
    pub fn shift(self, preset: &mut Preset, axis: Across, by: [isize; 2]) {
        let Some([from, to]) = self.corners(preset) else { return };
        let last = preset.size.saturating_sub(1);
        let mut step = [0isize; 3];
        for (part, by) in [axis.columns(), axis.rows()].into_iter().zip(by) {
            let (least, most) = (from[part].min(to[part]) as isize, from[part].max(to[part]) as isize);
            step[part] = by.clamp(-least, last as isize - most);
        }
        let shifted = |cell: Cell| std::array::from_fn(|part| cell[part].saturating_add_signed(step[part]));
        self.set_corners(preset, [shifted(from), shifted(to)]);
    }

    /// Moves its upper right corner in a cut to a cell, (column, row).
    pub fn stretch(self, preset: &mut Preset, axis: Across, to: [usize; 2]) {
        let Some([from, mut end]) = self.corners(preset).filter(|_| self.can_be_sized(preset)) else { return };
        let last = preset.size.saturating_sub(1);
        for (part, at) in [axis.columns(), axis.rows()].into_iter().zip(to) {
            end[part] = at.clamp(from[part], last);
        }
        self.set_corners(preset, [from, end]);
    }

    fn set_corners(self, preset: &mut Preset, [from, to]: [Cell; 2]) {
        match self {
            Item::Injector(i) => match preset.injectors.get_mut(i).map(|injector| &mut injector.kind) {
                Some(InjectorKind::Rectangle { from: a, to: b }) => (*a, *b) = (from, to),
                Some(InjectorKind::Single { cell }) => *cell = from,
                _ => {}
            },
            Item::Occluder(i) => match preset.occluders.get_mut(i).map(|occluder| &mut occluder.kind) {
                Some(OccluderKind::Box { from: a, to: b }) => (*a, *b) = (from, to),
                Some(OccluderKind::Plane { axis, at }) => *at = from[of(*axis)],
                _ => {}
            },
        }
    }

    /// Where its light goes, of any length but zero; `None` for occluders.
    pub fn direction(self, preset: &Preset) -> Option<[f64; 3]> {
        let Item::Injector(i) = self else { return None };
        let injector = preset.injectors.get(i)?;
        let own = match injector.kind {
            InjectorKind::Wall { side } => side.inwards().to_array(),
            InjectorKind::File { .. } => return None,
            _ => [1.0, 0.0, 0.0],
        };
        Some(injector.direction.unwrap_or(own))
    }

    /// Turns its light within a cut; what it had across the cut is given up.
    pub fn turn(self, preset: &mut Preset, axis: Across, [right, up]: [f64; 2]) {
        let (Item::Injector(i), true) = (self, right != 0.0 || up != 0.0) else { return };
        let Some(injector) = preset.injectors.get_mut(i) else { return };
        let round = |part: f64| (part * 20.0).round() / 20.0;
        let length = right.hypot(up);
        let mut direction = [0.0; 3];
        (direction[axis.columns()], direction[axis.rows()]) = (round(right / length), round(up / length));
        injector.direction = Some(direction);
    }

    /// Whether it is the same in another preset, so that what was run is what is seen.
    pub fn is_same(self, preset: &Preset, other: &Preset) -> bool {
        match self {
            Item::Injector(i) => preset.injectors.get(i) == other.injectors.get(i),
            Item::Occluder(i) => preset.occluders.get(i) == other.occluders.get(i),
        }
    }
}

fn of(axis: Axis) -> usize {
    match axis {
        Axis::X => 0,
        Axis::Y => 1,
        Axis::Z => 2,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::injector::{Injector, Side};
    use crate::scene::occluder::Occluder;

    fn preset() -> Preset {
        let injectors = [
            InjectorKind::Wall { side: Side::PosX },
            InjectorKind::Rectangle { from: [1, 2, 3], to: [4, 5, 3] },
            InjectorKind::Single { cell: [7, 0, 4] },
        ];
        let plane = Occluder {
            kind: OccluderKind::Plane { axis: Axis::Y, at: 6 },
            normal: None,
            opacity: 1.0,
            albedo: [0.0; 3],
            enabled: true,
        };
        let injectors = injectors.map(Injector::new).to_vec();
        Preset { size: 8, injectors, occluders: vec![plane], ..Preset::default() }
    }

    #[test]
    fn objects_stand_in_the_cuts_that_cross_them() {
        let preset = preset();
        let at = |index| Plane { axis: Across::Z, index };
        assert_eq!(Item::Injector(0).footprint(&preset, at(3)), Some([[7, 0], [7, 7]]));
        assert_eq!(Item::Injector(1).footprint(&preset, at(3)), Some([[1, 2], [4, 5]]));
        assert_eq!(Item::Injector(1).footprint(&preset, at(4)), None);
        assert_eq!(Item::Occluder(0).footprint(&preset, at(0)), Some([[0, 6], [7, 6]]));
        // Across y, columns are x and rows z.
        let plane = Plane { axis: Across::Y, index: 0 };
        assert_eq!(Item::Injector(2).footprint(&preset, plane), Some([[7, 4], [7, 4]]));
    }

    #[test]
    fn objects_are_moved_sized_and_turned_within_the_volume() {
        let mut preset = preset();
        Item::Injector(1).shift(&mut preset, Across::Z, [-5, 1]);
        assert_eq!(preset.injectors[1].kind, InjectorKind::Rectangle { from: [0, 3, 3], to: [3, 6, 3] });
        Item::Injector(1).stretch(&mut preset, Across::Z, [99, 0]);
        assert_eq!(preset.injectors[1].kind, InjectorKind::Rectangle { from: [0, 3, 3], to: [7, 3, 3] });
        Item::Occluder(0).shift(&mut preset, Across::Z, [3, -2]);
        assert_eq!(preset.occluders[0].kind, OccluderKind::Plane { axis: Axis::Y, at: 4 });
        Item::Injector(2).turn(&mut preset, Across::Z, [0.0, -3.0]);
        assert_eq!(preset.injectors[2].direction, Some([0.0, -1.0, 0.0]));
        Item::Injector(2).turn(&mut preset, Across::Z, [0.0, 0.0]);
        assert_eq!(preset.injectors[2].direction, Some([0.0, -1.0, 0.0]));
    }
}
