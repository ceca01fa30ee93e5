//! What a camera sees of a scene that a volume of cells lights.
//!
//! Direct light is exact, shadows included; reflected light is whatever the cells say of the surface that is seen.

use glam::DVec3;

use super::estimate::{Estimates, Watch};
use super::image::Image;
use super::rgb::{Rgb, add};
use super::sequence::Points;
use super::view::View;
use super::world::World;

/// A picture, direct and indirect light apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Seen {
    /// The radiance of what surfaces emit, and reflect of the light that comes straight from the lamps.
    pub direct: Image,
    /// The radiance of the light in cells that surfaces reflect.
    pub indirect: Image,
}

impl Seen {
    /// The picture of a view, each pixel the mean over `samples` places even in its square. `irradiance` is the light
    /// [W/m²] that cells give a place with a normal. `None` where `watch` ended it.
    pub fn new(
        world: &World,
        view: &View,
        samples: u64,
        irradiance: impl Fn(DVec3, DVec3) -> Rgb + Sync,
        watch: Watch,
    ) -> Option<Self> {
        let [width, height] = view.size();
        let places = Points::<2>::new();
        let mut pixels = Estimates::<6>::new(width * height, 2);
        let finished = pixels.add_batch(samples.max(1), watch, |pixel, sample| {
            let [x, y, ..] = sample.shift;
            let [x, y] = places.at(&[x, y], sample.number);
            let place = [(pixel % width) as f64 + x, (pixel / width) as f64 + y];
            let Some(seen) = world.meet(view.from, view.way(place)) else { return [0.0; 6] };
            let [r, g, b] = add(seen.emission, seen.reflects(world.direct(&seen)));
            let [u, v, w] = seen.reflects(irradiance(seen.at, seen.normal));
            [r, g, b, u, v, w]
        });
        let image = |from: usize| {
            let pixel = |i: usize| std::array::from_fn(|c| pixels.mean(i)[from + c] as f32);
            Image::new(width, (0..pixels.len()).map(pixel).collect())
        };
        finished.then(|| Seen { direct: image(0), indirect: image(3) })
    }

    /// All light.
    pub fn total(&self) -> Image {
        self.scaled(1.0)
    }

    /// Direct light, and `scale` times the indirect.
    pub fn scaled(&self, scale: f64) -> Image {
        self.direct.zip(&self.indirect, |direct, indirect| direct + scale as f32 * indirect)
    }
}
