//! Slices as a picture for a paper: polar glyphs side by side, with axes and a legend, as SVG or PNG.

mod legend;
mod plan;

use std::collections::BTreeMap;

use super::colour::{Paint, Rgb, Theme};
use super::glyph::{self, GlyphScale, Glyphs, Hue, Outline};
use super::raster::{self, RasterError};
use super::slice::{Axis, Slice};
use super::svg::{Anchor, PathData, Stroke, Svg, Type, fitted};
use legend::{LEADING, Legend};
use plan::{MARGIN, Plan};

/// One slice in a picture.
#[derive(Clone, Copy, Debug)]
pub struct Panel<'a> {
    /// What it shows, such as "Source".
    pub title: &'a str,
    /// The light.
    pub slice: &'a Slice,
    /// How its intensities become radii.
    pub scale: GlyphScale,
}

impl<'a> Panel<'a> {
    /// A panel whose largest glyph just fills its cell; with `decades`, on a logarithmic scale.
    pub fn fitted(title: &'a str, slice: &'a Slice, hue: Hue, decades: Option<f32>) -> Self {
        let full = glyph::fit([slice], hue, 1.0).unwrap_or(1.0);
        let scale = match decades {
            Some(decades) => GlyphScale::Log { full, decades },
            None => GlyphScale::Linear { full },
        };
        Panel { title, slice, scale }
    }
}

/// A picture of one or more slices.
#[derive(Clone, Debug)]
pub struct Picture<'a> {
    /// The head line.
    pub title: &'a str,
    /// The line below it; may be empty.
    pub subtitle: &'a str,
    /// The slices, from left to right.
    pub panels: Vec<Panel<'a>>,
    /// What of coloured light is shown.
    pub hue: Hue,
    /// What the glyphs' colour tells.
    pub paint: Paint,
    /// Whether the cells' grounds show the mean intensity K0·c00.
    pub heat: bool,
    /// The colours.
    pub theme: Theme,
    /// The width in pixels; the height follows.
    pub width: u32,
}

/// What a panel's glyphs turned out to need explaining.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Seen {
    /// Some glyph has a negative lobe that can be seen.
    pub negative: bool,
    /// Some neighbours come from different levels.
    pub borders: bool,
    /// How many glyphs were cut down to their cells.
    pub clipped: usize,
}

/// Thinner cells than this, in pixels, get no lines between them.
const SMALLEST_RULED_CELL: f64 = 5.0;

/// Glyphs of smaller radius than this, in pixels, are not drawn.
const SMALLEST_GLYPH: f32 = 0.2;

/// Negative lobes of smaller radius than this, where the cell's side is 1, need no word in the legend.
const SMALLEST_EXPLAINED_LOBE: f32 = 0.03;

impl Picture<'_> {
    /// The picture as SVG.
    pub fn to_svg(&self) -> String {
        let count = self.panels.len().max(1) as f64;
        let em = f64::from(self.width.max(64)) / (36.0 * count).max(56.0);
        self.to_svg_set(em.max(6.0), None)
    }

    /// The picture as SVG with ordinary text `em` pixels high. Where they would be small side by side, panels
    /// go below each other; with a `height`, they are as large as it allows.
    pub fn to_svg_set(&self, em: f64, height: Option<f64>) -> String {
        let seen: Vec<Seen> = self.panels.iter().map(|panel| self.seen(panel)).collect();
        let width = f64::from(self.width.max(64));
        let legend = Legend::new(self, &seen, em, width - 2.0 * MARGIN * em);
        let plan = Plan::new(self, width, height, em, &legend, &seen);

        let mut svg = Svg::new(width, plan.height, self.theme.ground, self.title);
        let set = |size: f64, color: Rgb| Type { size: size * em, color, anchor: Anchor::Start };
        let (margin, room) = (MARGIN * em, width - 2.0 * MARGIN * em);
        let (title, type_of_title) = fitted(self.title, set(1.5, self.theme.ink), room);
        svg.text([margin, margin + 1.1 * em], &title, type_of_title);
        svg.lines([margin, margin + 2.8 * em], &plan.subtitle, set(1.0, self.theme.muted), LEADING * em, room);
        for (i, panel) in self.panels.iter().enumerate() {
            let (corner, side) = (plan.corner(i), plan.side);
            let frame = Frame { corner, side, em, cells: panel.slice.side };
            let title = &plan.titles[i];
            let above = corner[1] - (0.7 + LEADING * (title.len() as f64 - 1.0)) * em;
            svg.lines([corner[0], above], title, set(1.15, self.theme.ink), LEADING * em, side);
            self.draw_light(&mut svg, panel, &frame);
            self.draw_axes(&mut svg, panel.slice, &frame);
            let below = [corner[0], corner[1] + side + 4.2 * em];
            legend.draw_scale(&mut svg, &plan.scales[i], below, side);
        }
        legend.draw(&mut svg, [margin, plan.legend]);
        svg.finish()
    }

    /// The picture as a PNG file's bytes.
    ///
    /// # Errors
    /// Where it is too large to be held in memory.
    pub fn to_png(&self) -> Result<Vec<u8>, RasterError> {
        raster::png(&self.to_svg())
    }

    fn seen(&self, panel: &Panel) -> Seen {
        let glyphs = Glyphs::new(panel.slice.plane.axis, panel.scale, 4);
        let mut outline = Outline::default();
        let mut seen = Seen { borders: !panel.slice.borders.is_empty(), ..Seen::default() };
        for cell in &panel.slice.cells {
            glyphs.outline(self.hue.of(cell.light), &mut outline);
            seen.negative |= outline.negative.iter().any(|p| p[0].hypot(p[1]) > SMALLEST_EXPLAINED_LOBE);
            seen.clipped += usize::from(outline.clipped);
        }
        seen
    }

    fn draw_light(&self, svg: &mut Svg, panel: &Panel, frame: &Frame) {
        let (slice, theme) = (panel.slice, &self.theme);
        let axis = slice.plane.axis;
        let brightest = glyph::fit([slice], self.hue, 1.0).unwrap_or(1.0);
        let cell_pixels = frame.pixels(1.0) * slice.unit() as f64;
        // A point every pixel and a half of a full glyph's circumference looks round.
        let glyphs = Glyphs::new(axis, panel.scale, (2.0 * cell_pixels).clamp(8.0, 64.0) as usize);
        let (mut grounds, mut lines) = (BTreeMap::<Rgb, PathData>::new(), PathData::default());
        let (mut lights, mut negative) = (BTreeMap::<Rgb, PathData>::new(), PathData::default());
        let mut outline = Outline::default();
        for cell in &slice.cells {
            let light = self.hue.of(cell.light);
            let (at, span) = ([cell.column as f64, cell.row as f64], cell.span as f64);
            if self.heat {
                let mean = glyph::mean(light);
                let share = if mean > 0.0 { panel.scale.share(mean, brightest).min(1.0) } else { 0.0 };
                let corners = [[0.0, 0.0], [span, 0.0], [span, span], [0.0, span]];
                let square = corners.map(|[right, up]| frame.place([at[0] + right, at[1] + up]));
                grounds.entry(theme.heat(share)).or_default().polygon(square);
            }
            if frame.pixels(span) >= SMALLEST_RULED_CELL {
                lines.start(frame.place([at[0], at[1] + span]));
                lines.to(frame.place(at));
                lines.to(frame.place([at[0] + span, at[1]]));
            }
            let peak = glyph::peak(light, axis);
            let radius = glyph::FULL_RADIUS * panel.scale.share(peak, peak).min(1.0);
            if peak <= 0.0 || radius * (frame.pixels(span) as f32) < SMALLEST_GLYPH {
                continue;
            }
            let share = panel.scale.share(peak, brightest).min(1.0);
            glyphs.outline(light, &mut outline);
            let [column, row] = cell.centre().map(f64::from);
            let place = |p: &[f32; 2]| frame.place([column + span * f64::from(p[0]), row + span * f64::from(p[1])]);
            let color = self.paint.glyph(theme, cell.light, light, axis, share);
            lights.entry(color).or_default().polygon(outline.positive.iter().map(place));
            negative.polygon(outline.negative.iter().map(place));
        }
        for (color, path) in &grounds {
            svg.shape(path.as_str(), *color);
        }
        svg.outline(lines.as_str(), Stroke::solid(theme.grid, (frame.em * 0.06).max(0.5)));
        for (color, path) in &lights {
            svg.shape(path.as_str(), *color);
        }
        svg.shape(negative.as_str(), self.paint.negative(theme));
        let mut borders = PathData::default();
        for border in &slice.borders {
            borders.start(frame.place(border.from.map(|c| c as f64)));
            borders.to(frame.place(border.to.map(|c| c as f64)));
        }
        svg.outline(borders.as_str(), Stroke::solid(theme.ink, (frame.em * 0.16).max(1.2)));
    }

    fn draw_axes(&self, svg: &mut Svg, slice: &Slice, frame: &Frame) {
        let (theme, em, [left, top], side) = (&self.theme, frame.em, frame.corner, frame.side);
        let mut path = PathData::default();
        path.polygon([[left, top], [left + side, top], [left + side, top + side], [left, top + side]]);
        svg.outline(path.as_str(), Stroke::solid(theme.muted, (em * 0.08).max(0.75)));

        let axis = slice.plane.axis;
        let unit = slice.unit();
        let cells = slice.side / unit;
        let set = |anchor, size, color| Type { size: size * em, color, anchor };
        for index in ticks(cells, side / em) {
            let middle = frame.pixels((index as f64 + 0.5) * unit as f64);
            let label = index.to_string();
            svg.text([left + middle, top + side + 1.2 * em], &label, set(Anchor::Middle, 0.9, theme.muted));
            svg.text([left - 0.45 * em, top + side - middle + 0.32 * em], &label, set(Anchor::End, 0.9, theme.muted));
        }
        let [columns, rows] = [axis.columns(), axis.rows()].map(Axis::name);
        let which = match unit {
            1 => String::new(),
            _ => format!(" (cells of level {})", unit.ilog2()),
        };
        let name = set(Anchor::Middle, 1.0, theme.ink);
        svg.text([left + side / 2.0, top + side + 2.5 * em], &format!("{columns}{which}"), name);
        svg.turned_text([left - 2.65 * em, top + side / 2.0], &format!("{rows}{which}"), name, -90.0);
    }
}

/// Where a slice lies in the picture.
struct Frame {
    /// Upper left, in pixels.
    corner: [f64; 2],
    /// In pixels.
    side: f64,
    /// The height of ordinary text, in pixels.
    em: f64,
    /// Finest cells along the side.
    cells: usize,
}

impl Frame {
    fn pixels(&self, cells: f64) -> f64 {
        cells * self.side / self.cells.max(1) as f64
    }

    /// The pixel at a place in finest cells from the lower left.
    fn place(&self, [column, row]: [f64; 2]) -> [f64; 2] {
        [self.corner[0] + self.pixels(column), self.corner[1] + self.side - self.pixels(row)]
    }
}

/// The cell indices to label along a side of `ems` text heights: every 1, 2, 4 … cells, and at least the first.
fn ticks(cells: usize, ems: f64) -> impl Iterator<Item = usize> {
    let most = (ems / 2.4).clamp(1.0, 9.0);
    let mut step = 1;
    while cells as f64 / step as f64 > most {
        step *= 2;
    }
    (0..cells).step_by(step)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use resvg::tiny_skia::Pixmap;
    use resvg::usvg::roxmltree::Document;

    use super::*;
    use crate::field::{Channels, Grid, IndexVolume, Levels, Octree};
    use crate::report::slice::Plane;
    use crate::sh::Sh;

    fn lone_lobe(direction: DVec3) -> Slice {
        let mut grid = Grid::new(8);
        grid.set([2, 5, 0], Sh::lobe(direction));
        Slice::level(&[&grid], &Channels::of_colors(&[[1.0; 3]]), 0, Plane::default())
    }

    fn picture<'a>(panels: Vec<Panel<'a>>) -> Picture<'a> {
        Picture {
            title: "<A> & B",
            subtitle: "below",
            panels,
            hue: Hue::Mean,
            paint: Paint::Single,
            heat: false,
            theme: Theme::LIGHT,
            width: 600,
        }
    }

    /// The middle of the first shape of a colour, in pixels.
    fn middle(svg: &str, fill: Rgb) -> [f64; 2] {
        let document = Document::parse(svg).unwrap();
        let shape = document.descendants().find(|n| n.has_tag_name("path") && n.attribute("fill") == Some(&fill.css()));
        let points: Vec<[f64; 2]> = shape.and_then(|n| n.attribute("d")).unwrap()[1..]
            .trim_end_matches('Z')
            .split('L')
            .map(|p| p.split_once(' ').map(|(x, y)| [x.parse().unwrap(), y.parse().unwrap()]).unwrap())
            .collect();
        [0, 1].map(|c| points.iter().map(|p| p[c]).sum::<f64>() / points.len() as f64)
    }

    #[test]
    fn a_lobe_is_drawn_in_its_cell_towards_its_light() {
        for (direction, to) in [(DVec3::X, [1.0, 0.0]), (DVec3::Y, [0.0, -1.0])] {
            let slice = lone_lobe(direction);
            let picture = picture(vec![Panel::fitted("Source", &slice, Hue::Mean, None)]);
            let svg = picture.to_svg();
            let (front, back) = (middle(&svg, picture.theme.glyph), middle(&svg, picture.theme.negative));
            let along = (front[0] - back[0]) * to[0] + (front[1] - back[1]) * to[1];
            assert!(along > 5.0, "{direction}: {front:?} {back:?}");
            // Cell (2, 5) of 8: beside the labels of its column and row.
            let document = Document::parse(&svg).unwrap();
            let label = |name: &str, anchor: &str| -> f64 {
                let labels = document.descendants().filter(|n| n.attribute("text-anchor") == Some(anchor));
                let found = labels.clone().find(|n| n.text() == Some(name)).unwrap();
                found.attribute(if anchor == "middle" { "x" } else { "y" }).unwrap().parse().unwrap()
            };
            let cell = label("3", "middle") - label("2", "middle");
            assert!((front[0] - label("2", "middle")).abs() < cell / 2.0);
            assert!((label("5", "end") - front[1]).abs() < cell / 2.0);
        }
    }

    #[test]
    fn the_png_is_as_wide_as_asked_and_bears_the_theme() {
        let slice = lone_lobe(DVec3::X);
        for theme in [Theme::LIGHT, Theme::DARK] {
            let panels = ["Source", "Target", "Accumulated"].map(|t| Panel::fitted(t, &slice, Hue::Red, Some(3.0)));
            let picture = Picture { theme, heat: true, width: 900, ..picture(panels.to_vec()) };
            let pixels = Pixmap::decode_png(&picture.to_png().unwrap()).unwrap();
            assert_eq!(pixels.width(), 900);
            let Rgb(ground) = theme.ground;
            let corner = pixels.pixel(2, 2).unwrap();
            assert_eq!([corner.red(), corner.green(), corner.blue()], ground);
        }
    }

    #[test]
    fn the_legend_explains_what_is_there_and_nothing_else() {
        let dark = lone_lobe(DVec3::X);
        let level = picture(vec![Panel::fitted("Source", &dark, Hue::Mean, None)]).to_svg();
        assert!(level.contains("negative") && !level.contains("border between") && level.contains("&lt;A&gt; &amp; B"));
        let octree = Octree::<f32>::new(Levels::new(8, 1).unwrap());
        let mut index = IndexVolume::new(octree.sizes());
        index.level_mut(0).set([1, 1, 0]);
        let merged = Slice::merged(&[&octree], &index, &Channels::of_colors(&[]), Plane::default());
        let merged = picture(vec![Panel::fitted("Merged", &merged, Hue::Mean, None)]).to_svg();
        assert!(!merged.contains("negative") && merged.contains("border between"));
    }

    #[test]
    fn a_picture_of_nothing_is_still_a_picture() {
        let empty = picture(Vec::new());
        assert!(empty.to_png().is_ok());
        let tiny = Picture { width: 0, ..picture(Vec::new()) };
        assert!(Document::parse(&tiny.to_svg()).is_ok());
    }

    #[test]
    fn tick_labels_are_whole_steps_and_not_too_many() {
        for cells in [1, 2, 4, 8, 16, 32, 64, 128, 256] {
            let all: Vec<usize> = ticks(cells, 30.0).collect();
            assert!(all[0] == 0 && all.len() <= 9 && all.len() >= cells.min(4), "{cells}: {all:?}");
        }
    }
}
