//! A run as an animation: iteration after iteration is shown, its picture taken, and all are written on a thread of
//! their own.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::Context;
use resvg::tiny_skia::{Color, Pixmap, PixmapPaint, Transform};

use super::export;
use crate::app::session::Session;
use crate::app::session::asides::{Aside, Watch};
use crate::app::session::command::Command;
use crate::report::{apng, raster};
use crate::scene::file::write_whole;

/// How long each iteration is seen, in milliseconds.
const SHOWN_FOR: u16 = 400;

/// Pictures that are being taken.
#[derive(Debug)]
struct Reel {
    path: PathBuf,
    /// One picture a file, or all in one.
    numbered: bool,
    next: usize,
    last: usize,
    /// The iteration that was seen before.
    back_to: Option<usize>,
    pictures: Vec<String>,
}

/// The animation in progress, if there is one.
#[derive(Debug)]
pub struct Film {
    reel: Option<Reel>,
    /// The animation of a number, written: a line that says where.
    written: Aside<u64, String>,
    number: u64,
    work: Option<Arc<Reel>>,
}

impl Default for Film {
    fn default() -> Self {
        Film { reel: None, written: Aside::new("animation"), number: 0, work: None }
    }
}

impl Film {
    /// Begins to take the pictures of all iterations that are remembered; an export command says how they are written.
    pub fn begin(&mut self, session: &mut Session, command: Command, path: &Path) {
        let progress = &session.run.progress;
        let (next, last) = (progress.oldest, progress.iteration);
        let reel = Reel {
            path: path.to_path_buf(),
            numbered: command == Command::ExportFrames,
            next,
            last,
            back_to: session.run.at,
            pictures: Vec::new(),
        };
        session.run.playing = None;
        session.say(format!("Taking pictures of the iterations {next} to {last}"));
        session.scrub(next);
        self.reel = Some(reel);
    }

    /// Whether pictures are taken or written.
    pub fn is_underway(&self) -> bool {
        self.reel.is_some() || self.work.is_some()
    }

    /// Takes the next picture once it is to be seen, and writes all once they are there.
    pub fn advance(&mut self, session: &mut Session, ctx: &Context) {
        if let Some(reel) = &mut self.reel {
            let seen = session.sight.answered && session.sight.shown.iter().all(|shown| shown.iteration == reel.next);
            if seen && session.run.waiting.is_none() {
                reel.pictures.push(export::grids_picture(session, &session.settings.plots.format));
                reel.next += 1;
                session.scrub(reel.next);
            }
            if reel.next > reel.last
                && let Some(reel) = self.reel.take()
            {
                session.run.at = reel.back_to;
                self.number += 1;
                self.work = Some(Arc::new(reel));
            }
        }
        let Some(work) = &self.work else { return };
        let each = session.settings.plots.format.pixels_each();
        let begun = self.written.want(&self.number, ctx, |_| {
            let reel = Arc::clone(work);
            move |watch: &Watch| write(&reel, each, watch)
        });
        let heard = begun.and_then(|()| self.written.hear(ctx));
        if let Err(line) = heard {
            self.work = None;
            session.fail(line);
        } else if let Some(line) = self.written.known(&self.number) {
            self.work = None;
            session.say(line.clone());
        }
    }
}

/// Writes the pictures, with `each` pixels for a unit of theirs; a line that says where.
fn write(reel: &Reel, each: f32, watch: &Watch) -> Result<String, String> {
    let mut pictures = Vec::new();
    for (i, svg) in reel.pictures.iter().enumerate() {
        if !watch.go_on(i as f64 / reel.pictures.len() as f64) {
            return Err("the animation was called off".to_owned());
        }
        pictures.push(raster::pixels(svg, each).map_err(|error| error.to_string())?);
    }
    let pictures = alike(&pictures)?;
    let save = |path: &Path, bytes: &[u8]| write_whole(path, bytes).map_err(|error| error.to_string());
    if !reel.numbered {
        let joined = apng::join(&pictures, SHOWN_FOR).map_err(|error| error.to_string())?;
        save(&reel.path, &joined)?;
        return Ok(format!("Saved {}", reel.path.display()));
    }
    let first = reel.last + 1 - pictures.len();
    for (k, picture) in (first..).zip(&pictures) {
        save(&numbered(&reel.path, k), picture)?;
    }
    Ok(format!("Saved {} pictures as {} and so on", pictures.len(), numbered(&reel.path, first).display()))
}

/// The pictures as PNG files of one size: legends tell what there is to be explained, so their height may differ.
fn alike(pictures: &[Pixmap]) -> Result<Vec<Vec<u8>>, String> {
    let width = pictures.iter().map(Pixmap::width).max().unwrap_or(1);
    let height = pictures.iter().map(Pixmap::height).max().unwrap_or(1);
    let fitted = pictures.iter().map(|picture| {
        let mut sheet = Pixmap::new(width, height).ok_or_else(|| "an animation has no size".to_owned())?;
        let ground = picture.pixel(0, 0).map(|pixel| pixel.demultiply());
        if let Some(ground) = ground {
            sheet.fill(Color::from_rgba8(ground.red(), ground.green(), ground.blue(), ground.alpha()));
        }
        sheet.draw_pixmap(0, 0, picture.as_ref(), &PixmapPaint::default(), Transform::identity(), None);
        sheet.encode_png().map_err(|error| error.to_string())
    });
    fitted.collect()
}

/// The file of iteration `k`: its number before the ending.
fn numbered(path: &Path, k: usize) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!("{stem}-{k:04}.png"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_numbered_by_their_iteration() {
        assert_eq!(numbered(Path::new("a/run.png"), 12), Path::new("a/run-0012.png"));
    }
}
