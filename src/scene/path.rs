//! Light that moves: a path of keyframes, and cells of light moved along it.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::error::{Fault, Step};
use super::{Preset, Problem, Source};
use crate::field::Cell;
use crate::sh::Sh;

/// Where an injector is at a time, relative to where the preset puts it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Keyframe {
    /// Seconds, finite; later in each keyframe than in the one before.
    pub time: f64,
    /// How far it is moved along x, y and z, in cells; fractions are allowed.
    pub by: [f64; 3],
}

/// What becomes of light that is moved by fractions of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Placing {
    /// It is split over the eight cells around its place, each the more the nearer it is.
    #[default]
    Split,
    /// All of it goes to the nearest cell.
    Nearest,
}

/// How far a path has moved its injector at a time: between keyframes in a straight line, before the first and after
/// the last not at all. An empty path moves nothing.
pub fn offset(path: &[Keyframe], time: f64) -> DVec3 {
    let after = path.partition_point(|key| key.time <= time);
    let at = |i: usize| path.get(i).map(|key| (key.time, DVec3::from(key.by)));
    match (after.checked_sub(1).and_then(at), at(after)) {
        (Some((from, start)), Some((to, end))) => start.lerp(end, (time - from) / (to - from)),
        (Some((_, by)), None) | (None, Some((_, by))) => by,
        (None, None) => DVec3::ZERO,
    }
}

/// Whether a path can be followed.
pub(super) fn check(path: &[Keyframe]) -> Result<(), Fault> {
    for (i, key) in path.iter().enumerate() {
        let wrong =
            |what: String, remedy: &str, field| Err(Fault::new(what, remedy).field(field).within(Step::Item(i)));
        if !key.time.is_finite() {
            return wrong(format!("the time is {}", key.time), "write a finite number of seconds", "time");
        }
        if key.by.iter().any(|by| !by.is_finite()) {
            return wrong("a keyframe is not at a finite place".to_owned(), "write finite numbers of cells", "by");
        }
        if i > 0 && key.time <= path[i - 1].time {
            let what = format!("the time {} is not after {}", key.time, path[i - 1].time);
            return wrong(what, "keyframes come in the order of time", "time");
        }
    }
    Ok(())
}

impl Preset {
    /// The first and the last time, in seconds, of all the paths in it; `None` where nothing moves.
    pub fn times(&self) -> Option<[f64; 2]> {
        let times = || self.injectors.iter().flat_map(|injector| &injector.path).map(|key| key.time);
        times().next()?;
        Some([times().fold(f64::INFINITY, f64::min), times().fold(f64::NEG_INFINITY, f64::max)])
    }

    /// The paths of the injectors that are enabled, in their order: one for each of the first sources of its problem.
    pub fn paths(&self) -> Vec<&[Keyframe]> {
        let enabled = self.injectors.iter().filter(|injector| injector.enabled);
        enabled.map(|injector| injector.path.as_slice()).collect()
    }
}

impl Problem {
    /// The problem at a time, in seconds: its first sources have each followed a path, as [`Preset::paths`] has them.
    pub fn at_time(&self, paths: &[&[Keyframe]], time: f64, placing: Placing) -> Problem {
        let paths = paths.iter().copied().chain(std::iter::repeat(&[][..]));
        let source = |(source, path): (&Source, &[Keyframe])| match path {
            // What does not move keeps what is known of the surfaces that it leaves.
            [] => source.clone(),
            path => source.moved(offset(path, time), placing, self.size),
        };
        Problem { sources: self.sources.iter().zip(paths).map(source).collect(), ..self.clone() }
    }
}

impl Source {
    /// Its light moved by so many cells in a volume of side `size`; what leaves the volume is gone.
    pub fn moved(&self, by: DVec3, placing: Placing, size: usize) -> Source {
        let (whole, part) = match placing {
            Placing::Split => (by.floor(), by - by.floor()),
            Placing::Nearest => (by.round(), DVec3::ZERO),
        };
        let mut light: Vec<(Cell, Sh<f64>)> = Vec::new();
        for (cell, value) in &self.light {
            for corner in 0..8 {
                let up = [corner & 1, corner >> 1 & 1, corner >> 2];
                let weight: f64 = (0..3).map(|k| if up[k] == 1 { part[k] } else { 1.0 - part[k] }).product();
                let at = [0, 1, 2].map(|k| cell[k] as f64 + whole[k] + f64::from(up[k]));
                if weight > 0.0 && at.iter().all(|c| (0.0..size as f64).contains(c)) {
                    light.push((at.map(|c| c as usize), *value * weight));
                }
            }
        }
        light.sort_by_key(|([x, y, z], _)| (*z, *y, *x));
        light.dedup_by(|later, kept| {
            let same = later.0 == kept.0;
            if same {
                kept.1 += later.1;
            }
            same
        });
        Source { color: self.color, light, ..Source::default() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(time: f64, x: f64) -> Keyframe {
        Keyframe { time, by: [x, 0.0, 0.0] }
    }

    #[test]
    fn a_path_goes_straight_from_keyframe_to_keyframe() {
        let path = [key(1.0, 0.0), key(3.0, 8.0), key(4.0, 6.0)];
        for (time, x) in [(0.0, 0.0), (1.0, 0.0), (1.5, 2.0), (3.0, 8.0), (3.5, 7.0), (9.0, 6.0)] {
            assert_eq!(offset(&path, time).x, x, "{time}");
        }
        assert_eq!(offset(&[], 2.0), DVec3::ZERO);
        assert!(check(&path).is_ok());
        assert!(check(&[key(1.0, 0.0), key(1.0, 2.0)]).is_err() && check(&[key(f64::NAN, 0.0)]).is_err());
    }

    #[test]
    fn split_light_keeps_its_sum_and_its_centre() {
        let light = vec![([3, 3, 3], Sh([1.0, 0.5, 0.0, 0.0])), ([4, 3, 3], Sh([2.0, 0.0, 0.0, 1.0]))];
        let source = Source { color: [1.0; 3], light, ..Source::default() };
        let by = DVec3::new(0.25, -1.5, 2.0);
        let moved = source.moved(by, Placing::Split, 16);
        let sum: f64 = moved.light.iter().map(|(_, light)| light.0[0]).sum();
        let centre = |light: &[(Cell, Sh<f64>)]| {
            let at = |(cell, value): &(Cell, Sh<f64>)| DVec3::from(cell.map(|c| c as f64)) * value.0[0];
            light.iter().map(at).sum::<DVec3>() / 3.0
        };
        assert!((sum - 3.0).abs() < 1e-15);
        assert!((centre(&moved.light) - centre(&source.light) - by).length() < 1e-12);
        assert_eq!(moved.light.len(), 6); // three along x, of which the middle one twice, two along y, one along z
        assert_eq!(source.moved(by, Placing::Nearest, 16).light.len(), 2);
        assert!(source.moved(DVec3::splat(40.0), Placing::Split, 16).light.is_empty());
    }
}
