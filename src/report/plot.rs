//! Curves as a figure for a paper: one or more plots above each other, as SVG or PNG.

mod pen;

use super::axis::Axis;
use super::colour::Theme;
use super::raster::{self, RasterError};
use super::svg::{Anchor, PathData, Stroke, Svg, Type, fitted, text_width};
pub use pen::{Dash, Shape};
use pen::{draw_point, stroke};

/// What a shape stands for, where colours stand for something else.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    /// The shape.
    pub shape: Shape,
    /// What it says.
    pub text: String,
}

/// A curve: points in the order in which they are joined.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// What the legend says; empty to leave it out.
    pub name: String,
    /// (x, y). Where a point has no place (not finite, or not above zero on a logarithmic axis) the
    /// curve is interrupted.
    pub points: Vec<[f64; 2]>,
    /// Which of [`Theme::curve`]'s colours.
    pub color: usize,
    /// How it is drawn.
    pub dash: Dash,
}

/// A place on the x axis that is pointed out.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Where.
    pub x: f64,
    /// What it says.
    pub label: String,
}

/// Curves with common axes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Plot {
    /// What it shows.
    pub title: String,
    /// What x is, with its unit.
    pub x_label: String,
    /// What y is, with its unit.
    pub y_label: String,
    /// Whether x goes by powers of ten.
    pub log_x: bool,
    /// Whether y goes by powers of ten.
    pub log_y: bool,
    /// The curves, the first on top of the others.
    pub curves: Vec<Curve>,
    /// What the shapes of points stand for.
    pub keys: Vec<Key>,
    /// Places to point out.
    pub marks: Vec<Mark>,
}

/// Plots above each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    /// The head line; may be empty.
    pub title: String,
    /// The plots, from top to bottom.
    pub plots: Vec<Plot>,
    /// The colours.
    pub theme: Theme,
    /// Width and height, in pixels.
    pub size: [u32; 2],
}

/// In figures that are less wide than this many heights of text legends stand below the curves.
const NARROW: f64 = 48.0;

/// Curves of at most this many points show each of them.
const DOTTED_UP_TO: usize = 40;

impl Figure {
    /// The figure as SVG.
    pub fn to_svg(&self) -> String {
        self.to_svg_set((f64::from(self.size[0].max(64)) / 66.0).max(6.0))
    }

    /// The figure as SVG with ordinary text `em` pixels high. Where it is narrow for that, legends stand below
    /// the curves.
    pub fn to_svg_set(&self, em: f64) -> String {
        let [width, height] = self.size.map(|side| f64::from(side.max(64)));
        let margin = 1.3 * em;
        let narrow = width < NARROW * em;
        let set = |size: f64, color, anchor| Type { size: size * em, color, anchor };
        let mut svg = Svg::new(width, height, self.theme.ground, &self.title);
        let mut top = margin;
        if !self.title.is_empty() {
            let (title, type_of_title) =
                fitted(&self.title, set(1.4, self.theme.ink, Anchor::Start), width - 2.0 * margin);
            svg.text([margin, top + 1.1 * em], &title, type_of_title);
            top += 2.2 * em;
        }
        let names = self
            .plots
            .iter()
            .flat_map(|plot| plot.curves.iter().map(|curve| &curve.name).chain(plot.keys.iter().map(|key| &key.text)));
        let widest = names.map(|name| text_width(name, em)).fold(0.0, f64::max);
        let beside = if widest > 0.0 && !narrow { (widest + 4.2 * em).min(0.36 * width) } else { 0.0 };
        let below = self.legends(if narrow { width - 2.0 * margin } else { f64::INFINITY }, em);
        let lines = if narrow { below.iter().map(Vec::len).sum::<usize>() as f64 } else { 0.0 };
        let legends = if narrow { below.iter().filter(|rows| !rows.is_empty()).count() as f64 } else { 0.0 };
        let each = (height - margin - top - (1.5 * lines + 0.7 * legends) * em) / self.plots.len().max(1) as f64;
        let axes: Vec<[Axis; 2]> = self.plots.iter().map(Plot::axes).collect();
        // All plots begin at the same distance from the left, so that their x axes can be compared.
        let labels = axes.iter().flat_map(|[_, y]| y.ticks(8)).filter_map(|tick| tick.label);
        let gutter = labels.map(|label| text_width(&label, 0.95 * em)).fold(2.0 * em, f64::max) + 2.6 * em;
        for ((plot, axes), legend) in self.plots.iter().zip(&axes).zip(below) {
            // Marks have a line of their own between the title and the curves.
            let head = if plot.marks.is_empty() { 1.9 * em } else { 3.1 * em };
            let corner = [margin + gutter, top + head];
            let size = [(width - 2.0 * margin - gutter - beside).max(em), (each - head - 3.5 * em).max(em)];
            let frame = Frame { corner, size, em, axes };
            self.draw_axes(&mut svg, plot, &frame);
            frame.draw_curves(&mut svg, plot, &self.theme);
            top += each;
            if narrow && !legend.is_empty() {
                top += 0.7 * em;
                for row in legend {
                    let mut x = margin;
                    for entry in row {
                        self.draw_entry(&mut svg, &entry, [x, top], width - margin - x, em);
                        x += entry.width(em);
                    }
                    top += 1.5 * em;
                }
            } else if !narrow {
                let x = corner[0] + size[0] + 1.4 * em;
                for (line, entry) in legend.iter().flatten().enumerate() {
                    let y = corner[1] + em * (0.6 + 1.5 * line as f64);
                    self.draw_entry(&mut svg, entry, [x, y], beside - 1.4 * em, em);
                }
            }
        }
        svg.finish()
    }

    /// The figure as a PNG file's bytes.
    ///
    /// # Errors
    /// Where it is too large to be held in memory.
    pub fn to_png(&self) -> Result<Vec<u8>, RasterError> {
        raster::png(&self.to_svg())
    }

    fn draw_axes(&self, svg: &mut Svg, plot: &Plot, frame: &Frame) {
        let (theme, em) = (&self.theme, frame.em);
        let ([left, top], [width, height]) = (frame.corner, frame.size);
        let (right, bottom) = (left + width, top + height);
        let set = |size: f64, color, anchor| Type { size: size * em, color, anchor };
        let (title, type_of_title) = fitted(&plot.title, set(1.1, theme.ink, Anchor::Start), width);
        let above = if plot.marks.is_empty() { 0.7 * em } else { 1.9 * em };
        svg.text([left, top - above], &title, type_of_title);
        let (thin, thick) = ((0.06 * em).max(0.5), (0.09 * em).max(0.75));
        for tick in frame.axes[1].ticks((height / (2.6 * em)) as usize) {
            let y = bottom - height * frame.axes[1].share(tick.value);
            match tick.label {
                Some(label) => {
                    svg.line([left, y], [right, y], Stroke::solid(theme.grid, thin));
                    svg.text([left - 0.55 * em, y + 0.33 * em], &label, set(0.95, theme.muted, Anchor::End));
                }
                None => svg.line([left, y], [left + 0.35 * em, y], Stroke::solid(theme.muted, thin)),
            }
        }
        let room = (width / (4.5 * em)) as usize;
        for tick in frame.axes[0].ticks(plot.whole_steps().map_or(room, |steps| room.min(steps))) {
            let x = left + width * frame.axes[0].share(tick.value);
            svg.line([x, top], [x, bottom], Stroke::solid(theme.grid, thin));
            svg.text([x, bottom + 1.3 * em], &tick.label.unwrap_or_default(), set(0.95, theme.muted, Anchor::Middle));
        }
        let mut path = PathData::default();
        path.start([left, top]);
        path.to([left, bottom]);
        path.to([right, bottom]);
        svg.outline(path.as_str(), Stroke::solid(theme.muted, thick));
        svg.text([left + width / 2.0, bottom + 2.75 * em], &plot.x_label, set(1.0, theme.ink, Anchor::Middle));
        let y_label = set(1.0, theme.ink, Anchor::Middle).fitting(&plot.y_label, height + 3.0 * em);
        svg.turned_text([0.5 * em + y_label.size, top + height / 2.0], &plot.y_label, y_label, -90.0);
    }

    /// What each plot's legend says, in rows no wider than `width`; none where the plot before says the same.
    fn legends(&self, width: f64, em: f64) -> Vec<Vec<Vec<Entry<'_>>>> {
        let mut explained: Vec<Entry> = Vec::new();
        let mut legends = Vec::new();
        for plot in &self.plots {
            let named = plot.curves.iter().filter(|curve| !curve.name.is_empty());
            let named = named.map(|curve| Entry { name: &curve.name, color: Some(curve.color), dash: curve.dash });
            let keys =
                plot.keys.iter().map(|key| Entry { name: &key.text, color: None, dash: Dash::Points(key.shape) });
            let entries: Vec<Entry> = named.chain(keys).collect();
            let mut rows: Vec<Vec<Entry>> = Vec::new();
            if entries != explained {
                explained.clone_from(&entries);
                let mut x = f64::INFINITY;
                for entry in entries {
                    let wide = entry.width(em);
                    match rows.last_mut() {
                        Some(row) if x + wide <= width => row.push(entry),
                        _ => {
                            rows.push(vec![entry]);
                            x = 0.0;
                        }
                    }
                    x += wide;
                }
            }
            legends.push(rows);
        }
        legends
    }

    fn draw_entry(&self, svg: &mut Svg, entry: &Entry, [x, y]: [f64; 2], width: f64, em: f64) {
        let color = entry.color.map_or(self.theme.muted, |color| self.theme.curve(color));
        match entry.dash {
            Dash::Points(shape) => draw_point(svg, shape, [x + em, y], 0.3 * em, color),
            dash => svg.line([x, y], [x + 2.0 * em, y], stroke(color, dash, em)),
        }
        let set = Type { size: em, color: self.theme.ink, anchor: Anchor::Start };
        svg.text([x + 2.5 * em, y + 0.34 * em], entry.name, set.fitting(entry.name, width - 2.5 * em));
    }
}

/// A line of a legend.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Entry<'a> {
    name: &'a str,
    /// None where only the shape counts.
    color: Option<usize>,
    dash: Dash,
}

impl Entry<'_> {
    /// In pixels, with the gap to the next.
    fn width(&self, em: f64) -> f64 {
        text_width(self.name, em) + 4.0 * em
    }
}

impl Plot {
    /// The x and y axes that show all that can be shown of the curves.
    fn axes(&self) -> [Axis; 2] {
        let points = || self.curves.iter().flat_map(|curve| &curve.points);
        // An x whose y has no place counts as well: linear and logarithmic plots have the same x axis.
        let x = points().map(|[x, _]| *x);
        let x = if self.log_x { Axis::rounded(x, true) } else { Axis::tight(x) };
        [x, Axis::rounded(points().map(|[_, y]| *y), self.log_y)]
    }

    /// How many whole steps x spans, if every x is whole: there are no halves of an iteration.
    fn whole_steps(&self) -> Option<usize> {
        let all = || self.curves.iter().flat_map(|curve| curve.points.iter().map(|[x, _]| *x));
        let (low, high) = all().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
        (!self.log_x && high > low && all().all(|x| x.fract() == 0.0)).then_some((high - low) as usize)
    }

    fn shows(&self, &[x, y]: &[f64; 2]) -> bool {
        Axis::shows(x, self.log_x) && Axis::shows(y, self.log_y)
    }
}

/// Where a plot's axes lie in the figure.
struct Frame<'a> {
    /// Upper left, in pixels.
    corner: [f64; 2],
    /// Width and height, in pixels.
    size: [f64; 2],
    /// The height of ordinary text, in pixels.
    em: f64,
    axes: &'a [Axis; 2],
}

impl Frame<'_> {
    fn place(&self, &[x, y]: &[f64; 2]) -> [f64; 2] {
        let [left, top] = self.corner;
        [left + self.size[0] * self.axes[0].share(x), top + self.size[1] * (1.0 - self.axes[1].share(y))]
    }

    fn draw_curves(&self, svg: &mut Svg, plot: &Plot, theme: &Theme) {
        self.draw_marks(svg, plot, theme);
        for curve in plot.curves.iter().rev() {
            let mut path = PathData::default();
            let color = theme.curve(curve.color);
            for run in curve.points.split(|point| !plot.shows(point)) {
                for (i, point) in run.iter().map(|point| self.place(point)).enumerate() {
                    if i == 0 { path.start(point) } else { path.to(point) }
                }
                // A point between two gaps has no line to show it.
                let dots = run.iter().map(|point| self.place(point));
                match curve.dash {
                    Dash::Points(shape) => dots.for_each(|at| draw_point(svg, shape, at, 0.3 * self.em, color)),
                    _ if run.len() == 1 || curve.points.len() <= DOTTED_UP_TO => {
                        dots.for_each(|at| svg.disc(at, 0.2 * self.em, color));
                    }
                    _ => {}
                }
            }
            if !matches!(curve.dash, Dash::Points(_)) {
                svg.outline(path.as_str(), stroke(color, curve.dash, self.em));
            }
        }
        if !plot.curves.iter().flat_map(|curve| &curve.points).any(|point| plot.shows(point)) {
            let at = [self.corner[0] + self.size[0] / 2.0, self.corner[1] + self.size[1] / 2.0];
            svg.text(at, "nothing to show", Type { size: self.em, color: theme.muted, anchor: Anchor::Middle });
        }
    }

    fn draw_marks(&self, svg: &mut Svg, plot: &Plot, theme: &Theme) {
        let ([left, top], [width, height]) = (self.corner, self.size);
        for mark in &plot.marks {
            let share = self.axes[0].share(mark.x);
            if !(0.0..=1.0).contains(&share) {
                continue;
            }
            let x = left + width * share;
            let stroke = Stroke { color: theme.muted, width: (0.08 * self.em).max(0.75), dashes: &[3.0, 3.0] };
            svg.line([x, top], [x, top + height], stroke);
            let half = text_width(&mark.label, 0.95 * self.em) / 2.0;
            let at = x.min(left + width - half).max(left + half);
            let set = Type { size: 0.95 * self.em, color: theme.muted, anchor: Anchor::Middle };
            svg.text([at, top - 0.5 * self.em], &mark.label, set);
        }
    }
}

#[cfg(test)]
mod tests {
    use resvg::tiny_skia::Pixmap;
    use resvg::usvg::roxmltree::{Document, Node};

    use super::*;

    fn figure(plot: Plot) -> Figure {
        Figure { title: "a < b".to_owned(), plots: vec![plot], theme: Theme::LIGHT, size: [800, 500] }
    }

    fn plot(points: Vec<[f64; 2]>, log_y: bool) -> Plot {
        let curve = Curve { name: "mean".to_owned(), points, color: 0, dash: Dash::Solid };
        Plot { log_y, curves: vec![curve], ..Plot::default() }
    }

    /// The attribute of every element drawn in the first curve's colour, but for its line in the legend.
    fn drawn(svg: &str, name: &str) -> Vec<String> {
        let color = Theme::LIGHT.curve(0).css();
        let document = Document::parse(svg).unwrap();
        let ours = |n: &Node| [n.attribute("stroke"), n.attribute("fill")].contains(&Some(&color));
        let found = document.descendants().filter(ours).filter_map(|n| n.attribute(name).map(str::to_owned));
        let all: Vec<String> = found.collect();
        if name == "d" { all[..all.len() - 1].to_vec() } else { all }
    }

    fn path_points(d: &str) -> Vec<[f64; 2]> {
        let points = d.split(['M', 'L']).filter_map(|p| p.split_once(' '));
        points.map(|(x, y)| [x.parse().unwrap(), y.parse().unwrap()]).collect()
    }

    #[test]
    fn points_lie_where_their_values_say() {
        let even = plot((0..=4).map(|k| [f64::from(k), 10f64.powi(-k)]).collect(), true);
        let places = path_points(&drawn(&figure(even).to_svg(), "d")[0]);
        // Powers of ten against their exponents: a straight line with even steps, downwards.
        let step = [places[1][0] - places[0][0], places[1][1] - places[0][1]];
        assert!(step[0] > 50.0 && step[1] > 30.0);
        for pair in places.windows(2) {
            assert!(
                (pair[1][0] - pair[0][0] - step[0]).abs() < 0.03 && (pair[1][1] - pair[0][1] - step[1]).abs() < 0.03
            );
        }
    }

    #[test]
    fn what_has_no_place_interrupts_the_curve() {
        let values = [1.0, 2.0, 0.0, 4.0, f64::NAN, -1.0, 3.0, 5.0];
        let points: Vec<_> = values.iter().enumerate().map(|(x, y)| [x as f64, *y]).collect();
        let log = drawn(&figure(plot(points.clone(), true)).to_svg(), "d")[0].clone();
        assert_eq!((log.matches('M').count(), log.matches('L').count()), (3, 2));
        let linear = drawn(&figure(plot(points, false)).to_svg(), "d")[0].clone();
        assert_eq!((linear.matches('M').count(), linear.matches('L').count()), (2, 5));
    }

    #[test]
    fn one_point_is_a_dot_and_none_is_said() {
        let one = figure(plot(vec![[3.0, 0.5]], true)).to_svg();
        assert_eq!(drawn(&one, "cx").len(), 1);
        assert!(!one.contains("nothing to show"));
        let none = figure(plot(vec![[0.0, 0.0]], true)).to_svg();
        assert!(drawn(&none, "cx").is_empty() && none.contains("nothing to show"));
        assert!(figure(Plot::default()).to_png().is_ok());
        assert!(Figure { plots: Vec::new(), ..figure(Plot::default()) }.to_png().is_ok());
    }

    #[test]
    fn ten_thousand_points_fit_into_the_frame() {
        let many = plot((0..10_000).map(|k| [f64::from(k), f64::from(k).sin()]).collect(), false);
        let svg = figure(many).to_svg();
        let places = path_points(&drawn(&svg, "d")[0]);
        assert_eq!(places.len(), 10_000);
        assert!(places.iter().all(|[x, y]| (0.0..800.0).contains(x) && (0.0..500.0).contains(y)));
        assert!(drawn(&svg, "cx").is_empty());
        let pixels = Pixmap::decode_png(&raster::png(&svg).unwrap()).unwrap();
        assert_eq!((pixels.width(), pixels.height()), (800, 500));
    }

    #[test]
    fn points_are_not_joined() {
        let points = (0..50).map(|k| [f64::from(k), f64::from(k)]).collect();
        let curve = Curve { name: "ways".to_owned(), points, color: 0, dash: Dash::Points(Shape::Disc) };
        let svg = figure(Plot { curves: vec![curve], ..Plot::default() }).to_svg();
        // Fifty, and the one in the legend.
        assert_eq!(drawn(&svg, "cx").len(), 51);
        assert_eq!(svg.matches(&format!("stroke=\"{}\"", Theme::LIGHT.curve(0).css())).count(), 0);
    }

    #[test]
    fn in_a_narrow_figure_text_keeps_its_size_and_the_legend_stands_below() {
        let narrow = Figure { size: [320, 400], ..figure(plot(vec![[0.0, 1.0], [1.0, 2.0]], false)) };
        let svg = narrow.to_svg_set(10.0);
        let document = Document::parse(&svg).unwrap();
        let texts = document.descendants().filter(|n| n.has_tag_name("text"));
        assert!(texts.clone().all(|n| n.attribute("font-size").unwrap().parse::<f64>().unwrap() >= 9.5));
        let place = |what: &str| -> f64 {
            texts.clone().find(|n| n.text() == Some(what)).unwrap().attribute("y").unwrap().parse().unwrap()
        };
        assert!(path_points(&drawn(&svg, "d")[0]).iter().all(|[_, y]| *y < place("mean")));
        assert!(place("mean") < 400.0);
    }

    #[test]
    fn the_legend_stands_beside_the_curves_and_once_for_all() {
        let points = vec![[0.0, 0.0], [1.0, 1.0]];
        let mut two = figure(plot(points.clone(), false));
        two.plots.push(plot(points, false));
        let svg = two.to_svg();
        let document = Document::parse(&svg).unwrap();
        let names: Vec<Node> = document.descendants().filter(|n| n.is_element() && n.text() == Some("mean")).collect();
        assert_eq!(names.len(), 1);
        let legend: f64 = names[0].attribute("x").unwrap().parse().unwrap();
        assert!(path_points(&drawn(&svg, "d")[0]).iter().all(|[x, _]| *x < legend));
    }
}
