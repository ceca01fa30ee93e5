//! An SVG drawing as it is written: lines, boxes, paths and text, in pixels from the upper left corner.

use std::fmt::Write;

use super::colour::Rgb;
use super::raster::FONTS;
use crate::system::text::{one_line, shortened};

/// Which end of a text its place is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Its beginning.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// Its colour.
    pub color: Rgb,
    /// Its width, in pixels.
    pub width: f64,
    /// Lengths of dashes and gaps, in pixels; empty for a solid line.
    pub dashes: &'static [f64],
}

impl Stroke {
    /// A solid line.
    pub fn solid(color: Rgb, width: f64) -> Self {
        Stroke { color, width, dashes: &[] }
    }

    fn attributes(&self) -> String {
        let mut text = format!("stroke=\"{}\" stroke-width=\"{}\"", self.color.css(), pixels(self.width));
        if !self.dashes.is_empty() {
            let dashes: Vec<String> = self.dashes.iter().map(|length| pixels(*length)).collect();
            let _ = write!(text, " stroke-dasharray=\"{}\"", dashes.join(" "));
        }
        text
    }
}

/// How text is set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Type {
    /// Its height, in pixels.
    pub size: f64,
    /// Its colour.
    pub color: Rgb,
    /// Which end of it is placed.
    pub anchor: Anchor,
}

impl Type {
    /// The same type, smaller where `text` would be wider than `width` pixels.
    pub fn fitting(self, text: &str, width: f64) -> Self {
        let wide = text_width(text, self.size);
        if wide > width { Type { size: self.size * width / wide, ..self } } else { self }
    }
}

/// The smallest that type is set to make a text fit, as a part of its size; what is longer still is cut.
const SMALLEST: f64 = 0.6;

/// The smallest type that can be read on paper, in pixels: six points.
const LEGIBLE: f64 = 8.0;

/// A text that is no wider than `width` pixels: in smaller type, and cut with `…` where that would become too small.
pub fn fitted(text: &str, set: Type, width: f64) -> (String, Type) {
    let mut text = one_line(text);
    let least = (SMALLEST * set.size).max(LEGIBLE.min(set.size));
    while text_width(&text, least) > width && text.chars().count() > 1 {
        let count = text.chars().count();
        let part = width / text_width(&text, least);
        text = shortened(&text, ((count as f64 * part) as usize).clamp(1, count - 1));
    }
    let set = set.fitting(&text, width);
    (text, set)
}

/// How wide a text will be, in pixels, and rather a little more than too little: fonts differ, and the
/// reader's may be another.
pub fn text_width(text: &str, size: f64) -> f64 {
    let ems = |c: char| match c {
        ' ' | '.' | ',' | ':' | ';' | '|' | 'i' | 'j' | 'l' | '’' | '·' => 0.27,
        'f' | 'r' | 't' | '(' | ')' | '/' | '-' => 0.4,
        'm' | 'w' | 'M' | 'W' => 0.86,
        '⁻' | '⁰' | '¹' | '²' | '³' | '⁴'..='⁹' => 0.4,
        c if c.is_uppercase() => 0.68,
        // Hangul, kana and Chinese characters fill a square.
        '\u{1100}'..='\u{115f}' | '\u{2e80}'..='\u{d7ff}' | '\u{f900}'..='\u{faff}' | '\u{ff00}'..='\u{ff60}' => 1.0,
        '\u{1f000}'..='\u{3ffff}' => 1.0,
        _ => 0.56,
    };
    size * text.chars().map(ems).sum::<f64>()
}

/// A text in lines that are no wider than `width` pixels, broken at its spaces but
/// not at no-break spaces; a word that is wider stands alone.
pub fn wrapped(text: &str, size: f64, width: f64) -> Vec<String> {
    if text_width(text, size) <= width {
        return vec![text.to_owned()];
    }
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ').filter(|word| !word.is_empty()) {
        match lines.last_mut() {
            Some(line) if text_width(&format!("{line} {word}"), size) <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// A drawing.
#[derive(Clone, Debug)]
pub struct Svg {
    text: String,
}

impl Svg {
    /// A drawing on an even ground; its title is for those who cannot see it.
    pub fn new(width: f64, height: f64, ground: Rgb, title: &str) -> Self {
        let (width, height) = (pixels(width), pixels(height));
        let text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" xml:space=\"preserve\" font-family=\"{FONTS}\">\n<title>{}</title>\n\
             <rect width=\"100%\" height=\"100%\" fill=\"{}\"/>\n",
            escaped(&one_line(title)),
            ground.css()
        );
        Svg { text }
    }

    /// A straight line.
    pub fn line(&mut self, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2], stroke: Stroke) {
        let path = format!("M{} {}L{} {}", pixels(x1), pixels(y1), pixels(x2), pixels(y2));
        self.outline(&path, stroke);
    }

    /// A filled box.
    pub fn rect(&mut self, [x, y]: [f64; 2], [width, height]: [f64; 2], fill: Rgb) {
        let [x, y, width, height] = [x, y, width, height].map(pixels);
        let fill = fill.css();
        self.push(&format!("<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"{fill}\"/>"));
    }

    /// A filled shape, from [`PathData`].
    pub fn shape(&mut self, path: &str, fill: Rgb) {
        if !path.is_empty() {
            self.push(&format!("<path d=\"{path}\" fill=\"{}\"/>", fill.css()));
        }
    }

    /// A line along a path, from [`PathData`].
    pub fn outline(&mut self, path: &str, stroke: Stroke) {
        if !path.is_empty() {
            self.push(&format!("<path d=\"{path}\" fill=\"none\" stroke-linejoin=\"round\" {}/>", stroke.attributes()));
        }
    }

    /// A filled circle.
    pub fn disc(&mut self, [x, y]: [f64; 2], radius: f64, fill: Rgb) {
        let [x, y, radius] = [x, y, radius].map(pixels);
        self.push(&format!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{}\"/>", fill.css()));
    }

    /// A line of text on the base line at `at`.
    pub fn text(&mut self, at: [f64; 2], text: &str, set: Type) {
        self.turned_text(at, text, set, 0.0);
    }

    /// Lines of text under each other, `leading` pixels apart, the first on the base line at `at`; what is wider
    /// than `width` even so is set smaller.
    pub fn lines(&mut self, [x, y]: [f64; 2], lines: &[String], set: Type, leading: f64, width: f64) {
        for (i, line) in lines.iter().enumerate() {
            let (line, set) = fitted(line, set, width);
            self.text([x, y + leading * i as f64], &line, set);
        }
    }

    /// A line of text turned clockwise by `degrees` about `at`.
    pub fn turned_text(&mut self, [x, y]: [f64; 2], text: &str, set: Type, degrees: f64) {
        let text = &one_line(text);
        let anchor = match set.anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let [x, y, size] = [x, y, set.size].map(pixels);
        let turn = if degrees == 0.0 { String::new() } else { format!(" transform=\"rotate({degrees} {x} {y})\"") };
        self.push(&format!(
            "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\" text-anchor=\"{anchor}\" fill=\"{}\"{turn}>{}</text>",
            set.color.css(),
            with_raised_digits(text, set.size)
        ));
    }

    /// The whole file.
    pub fn finish(mut self) -> String {
        self.text.push_str("</svg>\n");
        self.text
    }

    fn push(&mut self, element: &str) {
        self.text.push_str(element);
        self.text.push('\n');
    }
}

/// The `d` of a path, point by point.
#[derive(Clone, Debug, Default)]
pub struct PathData(String);

impl PathData {
    /// Begins a part at a point.
    pub fn start(&mut self, [x, y]: [f64; 2]) {
        let _ = write!(self.0, "M{} {}", pixels(x), pixels(y));
    }

    /// Goes straight to a point.
    pub fn to(&mut self, [x, y]: [f64; 2]) {
        let _ = write!(self.0, "L{} {}", pixels(x), pixels(y));
    }

    /// Adds a closed polygon; nothing where it has no points.
    pub fn polygon(&mut self, points: impl IntoIterator<Item = [f64; 2]>) {
        let mut points = points.into_iter();
        if let Some(first) = points.next() {
            self.start(first);
            points.for_each(|point| self.to(point));
            self.0.push('Z');
        }
    }

    /// What was written so far.
    pub fn as_str(&self) -> &str {
        &self.0
    }
}

/// A length in hundredths of a pixel, without trailing zeros. What is not finite is 0.
fn pixels(length: f64) -> String {
    let hundredths = if length.is_finite() { (length * 100.0).round() / 100.0 } else { 0.0 };
    // Adding 0 turns −0 into 0.
    format!("{}", hundredths + 0.0)
}

/// The text with raised digits and signs as ordinary ones set higher and smaller: few fonts have them all,
/// and a font that steps in for one character changes the look of the line.
fn with_raised_digits(text: &str, size: f64) -> String {
    const RAISED: [(char, char); 11] = [
        ('⁻', '−'),
        ('⁰', '0'),
        ('¹', '1'),
        ('²', '2'),
        ('³', '3'),
        ('⁴', '4'),
        ('⁵', '5'),
        ('⁶', '6'),
        ('⁷', '7'),
        ('⁸', '8'),
        ('⁹', '9'),
    ];
    let plain = |c: char| RAISED.iter().find(|(raised, _)| *raised == c).map(|(_, plain)| *plain);
    let (rise, small) = (pixels(-0.36 * size), pixels(0.7 * size));
    let mut out = String::new();
    let mut rest = text;
    let mut back_down = String::new();
    while !rest.is_empty() {
        let line = rest.find(|c| plain(c).is_some()).unwrap_or(rest.len());
        let (before, after) = rest.split_at(line);
        if !before.is_empty() {
            let _ = match back_down.is_empty() {
                true => write!(out, "{}", escaped(before)),
                false => write!(out, "<tspan dy=\"{back_down}\">{}</tspan>", escaped(before)),
            };
        }
        let end = after.find(|c| plain(c).is_none()).unwrap_or(after.len());
        let (raised, after) = after.split_at(end);
        if !raised.is_empty() {
            let digits: String = raised.chars().filter_map(plain).collect();
            let _ = write!(out, "<tspan dy=\"{rise}\" font-size=\"{small}\">{digits}</tspan>");
            back_down = pixels(0.36 * size);
        }
        rest = after;
    }
    out
}

fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            // XML has no place for control characters.
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use resvg::usvg::roxmltree::{Document, Node};

    use super::*;

    #[test]
    fn what_is_written_can_be_read_again() {
        let black = Rgb::hex(0);
        let mut svg = Svg::new(100.0, 50.0, Rgb::hex(0xffffff), "a < b & \"c\"");
        let set = Type { size: 12.0, color: black, anchor: Anchor::End };
        svg.turned_text([10.0, 20.004], "1 < 2 & 3\u{1}\u{202e}", set, -90.0);
        let stroke = Stroke { color: black, width: 1.5, dashes: &[4.0, 2.0] };
        svg.line([0.0, f64::NAN], [-0.001, 3.25], stroke);
        let text = svg.finish();
        let document = Document::parse(&text).unwrap();
        let find = |name| document.descendants().find(|n: &Node| n.has_tag_name(name)).unwrap();
        assert_eq!(find("title").text(), Some("a < b & \"c\""));
        assert_eq!(find("text").text(), Some("1 < 2 & 3\\u{1}\\u{202e}"));
        assert_eq!(find("text").attribute("y"), Some("20"));
        assert_eq!(find("path").attribute("d"), Some("M0 0L0 3.25"));
        assert_eq!(find("path").attribute("stroke-dasharray"), Some("4 2"));
    }

    #[test]
    fn raised_digits_are_lifted_and_the_line_comes_down_again() {
        assert_eq!(
            with_raised_digits("2×10⁻⁵ < 3", 10.0),
            "2×10<tspan dy=\"-3.6\" font-size=\"7\">−5</tspan><tspan dy=\"3.6\"> &lt; 3</tspan>"
        );
        assert_eq!(with_raised_digits("no power", 10.0), "no power");
    }

    #[test]
    fn long_text_is_set_smaller_then_cut() {
        let set = Type { size: 10.0, color: Rgb::hex(0), anchor: Anchor::Start };
        assert_eq!(fitted("short", set, 100.0), ("short".to_owned(), set));
        let (text, smaller) = fitted(&"a".repeat(20), set, 100.0);
        assert!(text.len() == 20 && smaller.size < 10.0 && smaller.size >= LEGIBLE);
        for long in ["a".repeat(3000), "壁".repeat(3000), "\u{1b}".repeat(500)] {
            let (text, smallest) = fitted(&long, set, 100.0);
            assert!(text.ends_with('…') && (LEGIBLE..9.0).contains(&smallest.size), "{text} {}", smallest.size);
            assert!(text_width(&text, smallest.size) <= 100.0 + 1e-9);
        }
        assert_eq!(fitted("ab", set, 0.1).0, "…");
    }

    #[test]
    fn an_empty_polygon_draws_nothing() {
        let mut path = PathData::default();
        path.polygon([]);
        path.polygon([[0.0, 0.0], [1.0, 0.0], [0.5, 1.25]]);
        assert_eq!(path.as_str(), "M0 0L1 0L0.5 1.25Z");
    }
}
