//! How curves and their points are drawn.

use crate::report::colour::Rgb;
use crate::report::svg::{PathData, Stroke, Svg};

/// How a curve is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Dash {
    /// In one go.
    #[default]
    Solid,
    /// In dashes.
    Dashed,
    /// In dots.
    Dotted,
    /// Only its points.
    Points(Shape),
}

/// What a point is drawn as.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shape {
    /// A full circle.
    #[default]
    Disc,
    /// A full square.
    Square,
    /// A full triangle that points up.
    Triangle,
    /// A full square on its corner.
    Diamond,
    /// Two lines.
    Cross,
}

/// A point of a shape that reaches about `radius` from its middle.
pub(super) fn draw_point(svg: &mut Svg, shape: Shape, [x, y]: [f64; 2], radius: f64, color: Rgb) {
    let corner = |right: f64, down: f64| [x + radius * right, y + radius * down];
    let mut path = PathData::default();
    match shape {
        Shape::Disc => return svg.disc([x, y], radius, color),
        Shape::Square => {
            path.polygon([corner(-0.9, -0.9), corner(0.9, -0.9), corner(0.9, 0.9), corner(-0.9, 0.9)]);
        }
        Shape::Triangle => path.polygon([corner(0.0, -1.2), corner(1.1, 0.8), corner(-1.1, 0.8)]),
        Shape::Diamond => path.polygon([corner(0.0, -1.2), corner(1.2, 0.0), corner(0.0, 1.2), corner(-1.2, 0.0)]),
        Shape::Cross => {
            for [from, to] in [[corner(-1.0, -1.0), corner(1.0, 1.0)], [corner(-1.0, 1.0), corner(1.0, -1.0)]] {
                svg.line(from, to, Stroke::solid(color, 0.5 * radius));
            }
            return;
        }
    }
    svg.shape(path.as_str(), color);
}

/// The line of a curve, `em` being the height of ordinary text.
pub(super) fn stroke(color: Rgb, dash: Dash, em: f64) -> Stroke {
    let dashes: &[f64] = match dash {
        Dash::Solid | Dash::Points(_) => &[],
        Dash::Dashed => &[6.0, 4.0],
        Dash::Dotted => &[1.5, 3.0],
    };
    Stroke { color, width: (0.14 * em).max(1.0), dashes }
}
