//! How the pictures of a scene are looked at: which of them, through which glass, and how well they are made.

use crate::app::session::comparison::letter;
use crate::render::bounce::Bounces;
use crate::render::cells::Sampling;

/// The sides that pictures can have, in pixels.
pub const SIDES: [usize; 4] = [64, 128, 256, 512];
/// The paths a pixel at which the truth can come to rest.
pub const PATHS: [u64; 4] = [64, 256, 1024, 4096];
/// The bounces that the truth can have.
pub const BOUNCES: [Bounces; 4] = [Bounces::UpTo(0), Bounces::UpTo(1), Bounces::UpTo(2), Bounces::All];

/// A picture to show; runs are counted as in a comparison, the document's own first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tile {
    /// What light does in the scene itself, path traced.
    Truth,
    /// What the camera sees of a run's light.
    Picture(usize),
    /// A run's picture against the truth: red too bright, blue too dark.
    Difference(usize),
    /// The difference that an eye sees, FLIP.
    Flip(usize),
}

impl Tile {
    /// The pictures of so many runs, run by run; those against the truth if asked for.
    pub fn all(places: &[usize], against: bool) -> Vec<Tile> {
        let of_run = |place: &usize| {
            let own = [Tile::Picture(*place), Tile::Difference(*place), Tile::Flip(*place)];
            own.into_iter().take(if against { 3 } else { 1 })
        };
        std::iter::once(Tile::Truth).chain(places.iter().flat_map(of_run)).collect()
    }

    /// Its name on screen and in sheets.
    pub fn name(self) -> String {
        match self {
            Tile::Truth => "Truth".to_owned(),
            Tile::Picture(place) => format!("Picture {}", letter(place)),
            Tile::Difference(place) => format!("Difference {}", letter(place)),
            Tile::Flip(place) => format!("FLIP {}", letter(place)),
        }
    }
}

/// How pictures are looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Glass {
    /// Two pictures under a bar, in place of all side by side.
    pub split: Option<[Tile; 2]>,
    /// Whether difference and FLIP are shown beside the pictures.
    pub against: bool,
    /// Radiance as a scale of colours, in place of what a display shows.
    pub false_colour: bool,
    /// What radiance is multiplied with, in stops over what brings 98 in 100 pixels onto the display.
    pub stops: f32,
    /// Where on the way to a surface the light of cells is taken.
    pub sampling: Sampling,
    /// Pixels along a side.
    pub side: usize,
    /// Which light the truth has.
    pub bounces: Bounces,
    /// Whether the truth is refined.
    pub refine: bool,
    /// Paths a pixel at which it comes to rest.
    pub paths: u64,
}

impl Default for Glass {
    fn default() -> Self {
        Glass {
            split: None,
            against: true,
            false_colour: false,
            stops: 0.0,
            sampling: Sampling::Nearest,
            side: 256,
            bounces: Bounces::UpTo(1),
            refine: true,
            paths: 256,
        }
    }
}

impl Glass {
    /// The pictures that are shown, of runs at these places.
    pub fn tiles(&self, places: &[usize]) -> Vec<Tile> {
        let there = Tile::all(places, true);
        match self.split {
            // A run that was taken out leaves its side of the bar to the document's own.
            Some(both) => both.map(|tile| if there.contains(&tile) { tile } else { Tile::Picture(0) }).to_vec(),
            None => Tile::all(places, self.against),
        }
    }

    /// Puts the bar over truth and picture, or takes it away.
    pub fn turn_split(&mut self) {
        self.split = if self.split.is_some() { None } else { Some([Tile::Truth, Tile::Picture(0)]) };
    }
}

/// A number of bounces in words.
pub fn bounces_name(bounces: Bounces) -> String {
    match bounces {
        Bounces::UpTo(0) => "direct light".to_owned(),
        Bounces::UpTo(1) => "one bounce".to_owned(),
        Bounces::UpTo(number) => format!("{number} bounces"),
        Bounces::All => "all bounces".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_stand_in_a_row_each_with_its_difference() {
        let glass = Glass::default();
        let names: Vec<String> = glass.tiles(&[0, 2]).into_iter().map(Tile::name).collect();
        let right = ["Truth", "Picture A", "Difference A", "FLIP A", "Picture C", "Difference C", "FLIP C"];
        assert_eq!(names, right);
        assert_eq!(Glass { against: false, ..glass }.tiles(&[0, 2]).len(), 3);
    }

    #[test]
    fn a_run_that_is_gone_leaves_its_side_of_the_bar_to_the_documents_own() {
        let mut glass = Glass { split: Some([Tile::Flip(1), Tile::Truth]), ..Glass::default() };
        assert_eq!(glass.tiles(&[0, 1]), [Tile::Flip(1), Tile::Truth]);
        assert_eq!(glass.tiles(&[0]), [Tile::Picture(0), Tile::Truth]);
        glass.turn_split();
        assert_eq!(glass.split, None);
    }
}
