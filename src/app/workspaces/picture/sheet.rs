//! What is shown, as one sheet to take home.

use std::path::Path;

use super::numbers::{quality, run_name, told};
use super::tiles::Made;
use crate::app::session::Session;
use crate::app::session::picture::Tile;
use crate::report::colour::Theme;
use crate::report::number::short;
use crate::report::sheet;
use crate::scene::file::write_whole;

/// Writes every tile that is shown and made; difference and FLIP stand below their run's picture in words only where
/// they are shown.
///
/// # Errors
/// Where a sheet cannot be made or written; in a line.
pub fn save(session: &Session, made: &Made, path: &Path, theme: &Theme) -> Result<(), String> {
    let shown = session.picture.tiles(&made.pictures.places());
    let tiles: Vec<sheet::Tile> = shown.iter().filter_map(|tile| one(session, made, *tile)).collect();
    let runs = made.pictures.runs.len();
    // A row for every run, truth before the first, where that fits; else as square as can be.
    let columns = if runs == 1 { tiles.len() } else { (tiles.len() as f64).sqrt().ceil() as usize };
    let title = format!("{}, iteration {}", session.document.name(), session.seen());
    let png = sheet::png(&title, &tiles, columns, theme).map_err(|error| error.to_string())?;
    write_whole(path, &png).map_err(|error| error.to_string())
}

fn one(session: &Session, made: &Made, tile: Tile) -> Option<sheet::Tile> {
    let (side, rgb) = made.rgb(tile)?;
    Some(sheet::Tile { title: tile.name(), lines: lines(session, made, tile), size: [side, side], rgb })
}

/// What is said of a tile.
fn lines(session: &Session, made: &Made, tile: Tile) -> Vec<String> {
    let apart = |place: usize| made.apart.iter().flat_map(|apart| apart.iter()).find(|apart| apart.place == place);
    let Some(traced) = &made.truth else { return Vec::new() };
    match tile {
        Tile::Truth => vec![quality(traced)],
        Tile::Picture(place) => {
            let ratio = apart(place).map(|apart| told(&apart.compared.raw, &traced.bars)[3].clone());
            let ratio = ratio.map(|ratio| format!("mean {ratio} of the truth's"));
            std::iter::once(run_name(session, place)).chain(ratio).collect()
        }
        Tile::Difference(place) => {
            let rmse = apart(place).map(|apart| told(&apart.compared.raw, &traced.bars)[1].clone());
            rmse.map(|rmse| format!("RMSE {rmse}")).into_iter().collect()
        }
        Tile::Flip(place) => {
            apart(place).map(|apart| format!("mean {}", short(apart.compared.raw.flip, 3))).into_iter().collect()
        }
    }
}
