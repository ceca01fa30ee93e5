//! What the window remembers from one time to the next.

use std::fmt;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use ron::ser::PrettyConfig;
use serde::de::Visitor;
use serde::{Deserialize, Deserializer, Serialize};

use super::folds::Folds;
use super::plots::Plots;
use super::unreadable::fault;
use super::view::{View, Workspace};
use crate::app::worker::look::Layer;
use crate::scene::SceneError;
use crate::simulation::options::Device;

/// How many recent presets are remembered.
const MOST_RECENT: usize = 8;
/// The memory for past iterations that can be chosen, in MiB.
pub const PAST: RangeInclusive<usize> = 1..=65_536;
/// The iterations a second that can be chosen.
pub const PACE: RangeInclusive<f64> = 0.2..=60.0;
/// The intensities that can be chosen to fill a cell.
pub const FULL: RangeInclusive<f32> = 1e-9..=1e9;
/// The powers of ten that a logarithmic scale can span.
pub const DECADES: RangeInclusive<f32> = 0.5..=12.0;
/// Beyond every cell and every level of any volume.
const BEYOND: usize = 1 << 16;

/// Remembered settings. What an older or newer program did not know takes its default.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// What fills the window between the bars.
    pub workspace: Workspace,
    /// Which panels are folded away.
    pub folds: Folds,
    /// How light is looked at.
    pub view: View,
    /// What the error plots show.
    pub plots: Plots,
    /// Presets opened or saved, the latest first.
    pub recent: Vec<PathBuf>,
    /// Memory for past iterations, in MiB.
    pub past_mib: usize,
    /// Iterations a second while playing.
    pub pace: f64,
    /// Whether playing begins again at the end.
    pub looping: bool,
    /// Whether edits run again by themselves; where nothing was chosen, those of small volumes do.
    #[serde(deserialize_with = "chosen")]
    pub rerun: Option<bool>,
    /// Whether a graphics card iterates, where it can.
    pub on_card: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Settings {
            workspace: Workspace::default(),
            folds: Folds::default(),
            view: View::default(),
            plots: Plots::default(),
            recent: Vec::new(),
            past_mib: 512,
            pace: 4.0,
            looping: false,
            rerun: None,
            on_card: false,
        }
    }
}

impl Settings {
    /// Reads settings; `name` is the file that errors name. Numbers that cannot be chosen are taken as the nearest
    /// that can.
    pub fn parse(text: &str, name: &Path) -> Result<Self, SceneError> {
        let settings: Result<Settings, _> = ron::from_str(text);
        let settings =
            settings.map_err(|error| fault(&error, name, "these are no settings that this program wrote"))?;
        Ok(settings.within_bounds())
    }

    /// The settings as text that [`Settings::parse`] reads back equal.
    pub fn to_ron(&self) -> String {
        // Writing numbers and strings to a String has no way to fail: paths that are no text are not remembered.
        ron::ser::to_string_pretty(self, PrettyConfig::new().new_line("\n")).unwrap_or_default() + "\n"
    }

    fn within_bounds(mut self) -> Self {
        let usual = Settings::default();
        self.past_mib = nearest(self.past_mib, PAST, usual.past_mib);
        self.pace = nearest(self.pace, PACE, usual.pace);
        self.recent.truncate(MOST_RECENT);
        if !Workspace::FILLED.contains(&self.workspace) {
            self.workspace = Workspace::default();
        }
        let view = &mut self.view;
        view.full = nearest(view.full, FULL, usual.view.full);
        view.decades = nearest(view.decades, DECADES, usual.view.decades);
        view.index = view.index.min(BEYOND);
        if let Layer::Level(level) = &mut view.layer {
            *level = (*level).min(BEYOND);
        }
        self
    }

    /// What iterates.
    pub fn device(&self) -> Device {
        if self.on_card { Device::Gpu } else { Device::Cpu }
    }

    /// Memory for past iterations, in bytes.
    pub fn budget(&self) -> usize {
        self.past_mib << 20
    }

    /// Puts a preset first among the recent ones. A path that is no text cannot be kept in a file of text.
    pub fn remember(&mut self, path: &Path) {
        if path.to_str().is_none() {
            return;
        }
        // The program may be started elsewhere the next time.
        let path = std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf());
        self.recent.retain(|known| *known != path);
        self.recent.insert(0, path);
        self.recent.truncate(MOST_RECENT);
    }
}

/// Reads a choice; older programs wrote it without the mark that one was made.
fn chosen<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<bool>, D::Error> {
    struct Choice;
    impl<'de> Visitor<'de> for Choice {
        type Value = Option<bool>;

        fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
            f.write_str("true, false or None")
        }

        fn visit_bool<E>(self, chosen: bool) -> Result<Self::Value, E> {
            Ok(Some(chosen))
        }

        fn visit_none<E>(self) -> Result<Self::Value, E> {
            Ok(None)
        }

        fn visit_unit<E>(self) -> Result<Self::Value, E> {
            Ok(None)
        }

        fn visit_some<D: Deserializer<'de>>(self, inner: D) -> Result<Self::Value, D::Error> {
            bool::deserialize(inner).map(Some)
        }
    }
    deserializer.deserialize_any(Choice)
}

/// The number in the range that is nearest; the `usual` one for what is not a number.
fn nearest<T: PartialOrd + Copy>(number: T, range: RangeInclusive<T>, usual: T) -> T {
    let (low, high) = (*range.start(), *range.end());
    match number {
        n if n < low => low,
        n if n > high => high,
        n if range.contains(&n) => n,
        _ => usual,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::system::random::Random;

    #[test]
    fn what_is_written_is_read_back_and_what_is_left_out_is_usual() {
        let mut settings = Settings { past_mib: 77, pace: 1.5, rerun: Some(true), ..Settings::default() };
        settings.remember(Path::new("a/\"b\" é.ron"));
        assert!(settings.recent[0].is_absolute());
        settings.view.layer = Layer::Level(3);
        settings.plots.level = Some(2);
        assert_eq!(Settings::parse(&settings.to_ron(), Path::new("s")), Ok(settings));
        assert_eq!(Settings::parse("()", Path::new("s")), Ok(Settings::default()));
        for (text, rerun) in
            [("(rerun: true)", Some(true)), ("(rerun: Some(false))", Some(false)), ("(rerun: None)", None)]
        {
            assert_eq!(Settings::parse(text, Path::new("s")).unwrap().rerun, rerun, "{text}");
        }
        let newer = "(pace: 2.0, of_a_newer_program: (1, 2))";
        assert_eq!(Settings::parse(newer, Path::new("s")).unwrap().pace, 2.0);
    }

    #[test]
    fn numbers_that_cannot_be_chosen_are_brought_back() {
        for number in ["NaN", "inf", "-inf", "-3.0", "1e300"] {
            let text = format!("(pace: {number}, view: (full: {number}, decades: {number}))");
            let settings = Settings::parse(&text, Path::new("s")).unwrap();
            assert!(PACE.contains(&settings.pace), "{number}");
            assert!(FULL.contains(&settings.view.full) && DECADES.contains(&settings.view.decades), "{number}");
        }
        let most = usize::MAX;
        let text = format!(
            "(past_mib: {most}, view: (index: {most}, layer: Level({most})), recent: [{}])",
            "\"a\",".repeat(99)
        );
        let settings = Settings::parse(&text, Path::new("s")).unwrap();
        assert!(settings.budget() <= 64 << 30 && settings.recent.len() == MOST_RECENT);
        assert_eq!((settings.view.index, settings.view.layer), (BEYOND, Layer::Level(BEYOND)));
    }

    #[test]
    fn whatever_befalls_the_text_it_is_refused_in_a_line_or_read() {
        let good = Settings { recent: vec!["a.ron".into()], ..Settings::default() }.to_ron();
        let mut random = Random::new(9);
        let (mut refused, mut read) = (0, 0);
        for _ in 0..20_000 {
            let mut bytes = good.clone().into_bytes();
            for _ in 0..1 + random.below(3) {
                if bytes.len() < 2 {
                    break;
                }
                let (at, other) = (random.below(bytes.len()), random.below(bytes.len()));
                match random.below(4) {
                    0 => bytes[at] = random.below(256) as u8,
                    1 => drop(bytes.remove(at)),
                    2 => bytes.swap(at, other),
                    _ => bytes.truncate(at.max(1)),
                }
            }
            match Settings::parse(&String::from_utf8_lossy(&bytes), Path::new("s.ron")) {
                Ok(settings) => {
                    assert_eq!(Settings::parse(&settings.to_ron(), Path::new("s.ron")), Ok(settings));
                    read += 1;
                }
                Err(error) => {
                    let line = error.to_string();
                    assert!(line.starts_with("s.ron:") && line.lines().count() == 1 && line.contains("; "), "{line}");
                    refused += 1;
                }
            }
        }
        assert!(refused > 1000 && read > 100, "{refused} refused, {read} read");
        for start in ["(", "[", "((", "(view: (", "(recent: [", "Some("] {
            assert!(Settings::parse(&start.repeat(100_000), Path::new("s.ron")).is_err());
        }
    }
}
