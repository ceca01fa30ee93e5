//! The truth: what light does in the scene itself, path traced.
//!
//! [`Truth`] is what a camera sees, its direct and its indirect light apart, each pixel the mean over its square.
//! [`super::surface`] has the same for surfaces, without a camera. Estimators: [`super::bounce`]; error bars and
//! batches: [`super::estimate`].

use super::bounce::{Bounces, First, indirect};
use super::estimate::{BATCHES, Estimates, Sample, Watch};
use super::image::Image;
use super::rgb::{Rgb, add};
use super::sequence::Points;
use super::sparks::Sparks;
use super::view::View;
use super::world::World;

/// Paths from each place that is seen.
const PATHS: u32 = 4;

/// A picture being path traced.
#[derive(Clone, Debug)]
pub struct Truth {
    view: View,
    bounces: Bounces,
    /// Direct light, then indirect.
    estimates: Estimates<6>,
}

impl Truth {
    /// Nothing traced yet.
    pub fn new(view: View, bounces: Bounces) -> Self {
        let [width, height] = view.size();
        Truth { view, bounces, estimates: Estimates::new(width * height, 0) }
    }

    /// A picture of `samples` paths a pixel altogether, in as many batches as an error bar wants; `None` where `watch`
    /// ended it.
    pub fn traced(world: &World, view: View, bounces: Bounces, samples: u64, watch: Watch) -> Option<Self> {
        let mut truth = Truth::new(view, bounces);
        let each = samples.div_ceil(u64::from(BATCHES));
        let batch = |batch: u32| {
            let share = |share: f64| watch((f64::from(batch) + share) / f64::from(BATCHES));
            truth.add_batch(world, each, &share)
        };
        (0..BATCHES).all(batch).then_some(truth)
    }

    /// Adds a batch of `samples` paths a pixel; tells whether `watch` let it finish.
    pub fn add_batch(&mut self, world: &World, samples: u64, watch: Watch) -> bool {
        let sparks = Sparks::new(world, u64::from(self.estimates.batches()));
        let eye = Eye::new(world, &sparks, self.view, self.bounces);
        let samples = samples.div_ceil(PATHS as u64);
        self.estimates.add_batch(samples, watch, |pixel, sample| eye.sample(pixel, sample))
    }

    /// The view that is traced.
    pub fn view(&self) -> &View {
        &self.view
    }

    /// Which light is traced.
    pub fn bounces(&self) -> Bounces {
        self.bounces
    }

    /// Paths a pixel so far.
    pub fn samples(&self) -> u64 {
        self.estimates.samples() * PATHS as u64
    }

    /// The radiance of direct light: what surfaces emit towards the camera, and reflect of what comes straight from
    /// the lights.
    pub fn direct(&self) -> Image {
        self.image(|pixel| colour(self.estimates.mean(pixel), 0))
    }

    /// The radiance of the light that has been reflected before it came to the surface that is seen.
    pub fn indirect(&self) -> Image {
        self.image(|pixel| colour(self.estimates.mean(pixel), 3))
    }

    /// All radiance.
    pub fn total(&self) -> Image {
        self.image(|pixel| add(colour(self.estimates.mean(pixel), 0), colour(self.estimates.mean(pixel), 3)))
    }

    /// One standard deviation of the indirect light.
    pub fn indirect_deviation(&self) -> Image {
        self.image(|pixel| colour(self.estimates.deviation(pixel), 3))
    }

    /// One standard deviation of all light; the errors of direct and indirect light count as unrelated.
    pub fn deviation(&self) -> Image {
        self.image(|pixel| {
            let deviation = self.estimates.deviation(pixel);
            std::array::from_fn(|c| deviation[c].hypot(deviation[3 + c]))
        })
    }

    /// The standard deviations of all pixels over the light of all pixels, for the indirect light: the least L1
    /// error that can be told from none. 0 where there is none to tell.
    pub fn noise(&self) -> f64 {
        let sum = |image: Image| image.mean().iter().sum::<f64>();
        let (deviation, light) = (sum(self.indirect_deviation()), sum(self.indirect()));
        if light > 0.0 { deviation / light } else { 0.0 }
    }

    fn image(&self, of: impl Fn(usize) -> Rgb) -> Image {
        let [width, _] = self.view.size();
        Image::new(width, (0..self.estimates.len()).map(|pixel| of(pixel).map(|v| v as f32)).collect())
    }
}

/// The three numbers from `from` on.
fn colour(numbers: [f64; 6], from: usize) -> Rgb {
    std::array::from_fn(|c| numbers[from + c])
}

/// Takes samples of pixels.
struct Eye<'a> {
    world: &'a World<'a>,
    sparks: &'a Sparks,
    view: View,
    bounces: Bounces,
    places: Points<2>,
    paths: First,
}

impl<'a> Eye<'a> {
    fn new(world: &'a World, sparks: &'a Sparks, view: View, bounces: Bounces) -> Self {
        Eye { world, sparks, view, bounces, places: Points::new(), paths: First::default() }
    }

    /// One place in a pixel, with the paths from there.
    fn sample(&self, pixel: usize, sample: Sample) -> [f64; 6] {
        let Sample { number, shift: [x, y, a, b, c, d], mut more } = sample;
        let [x, y] = self.places.at(&[x, y], number);
        let [width, _] = self.view.size();
        let place = [(pixel % width) as f64 + x, (pixel / width) as f64 + y];
        let Some(seen) = self.world.meet(self.view.from, self.view.way(place)) else { return [0.0; 6] };
        let [r, g, b_] = add(seen.emission, seen.reflects(self.world.direct(&seen)));
        let mut sum = [0.0; 3];
        for path in 0..PATHS as u64 {
            let first = self.paths.at([a, b, c, d], number * PATHS as u64 + path);
            sum = add(sum, indirect(self.world, self.sparks, &seen, self.bounces, first, &mut more));
        }
        let [u, v, w] = seen.reflects(sum).map(|value| value / f64::from(PATHS));
        [r, g, b_, u, v, w]
    }
}
