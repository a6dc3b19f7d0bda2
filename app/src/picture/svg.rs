//! A picture as SVG. Its colours follow those of the page it stands on, dark or light.

use std::collections::BTreeSet;
use std::fmt::Write;

use super::font::FAMILIES;
use super::palette::Color;
use super::scene::{Anchor, DASHES, Mark, Point, RADIUS, RING, Scene, Shape, Text};

/// The picture's text. Colours are attributes, which everything that draws SVG understands; where dark ones are asked
/// for, a style takes their place.
pub(super) fn svg(scene: &Scene, title: &str) -> String {
    let mut body = String::new();
    for shape in &scene.shapes {
        // writing to a string does not fail
        let _ = write_shape(&mut body, shape);
    }
    let (width, height) = (scene.width.ceil(), scene.height.ceil());
    let [paper, dark_paper] = Color::Paper.hex();
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         font-family=\"{FAMILIES}\">\n<title>{}</title>\n<style>\n@media (prefers-color-scheme: dark) {{\n.paper {{ fill: {dark_paper} }}\n{}}}\n</style>\n<rect class=\"paper\" width=\"{width}\" height=\"{height}\" fill=\"{paper}\"/>\n{body}</svg>\n",
        escape(title),
        dark(scene),
    )
}

/// Rules for the colours that the picture has.
fn dark(scene: &Scene) -> String {
    let rule = |shape: &Shape| {
        let (color, property) = match shape {
            Shape::Line { color, .. } | Shape::Marks { mark: Mark::Ring, color, .. } => (*color, "stroke"),
            Shape::Marks { color, .. } | Shape::Area { color, .. } | Shape::Text(Text { color, .. }) => {
                (*color, "fill")
            }
        };
        format!(".{} {{ {property}: {} }}\n", class(color, property), color.hex()[1])
    };
    scene.shapes.iter().map(rule).collect::<BTreeSet<String>>().into_iter().collect()
}

/// `stroke-rk4`
fn class(color: Color, property: &str) -> String {
    format!("{property}-{color:?}").to_lowercase()
}

fn write_shape(to: &mut String, shape: &Shape) -> std::fmt::Result {
    match shape {
        Shape::Line { points, color, width, dashed } => {
            let (class, points, hex) = (class(*color, "stroke"), pairs(points), color.hex()[0]);
            write!(to, "<polyline class=\"{class}\" points=\"{points}\" fill=\"none\"")?;
            write!(to, " stroke=\"{hex}\" stroke-width=\"{width}\"")?;
            if *dashed {
                write!(to, " stroke-dasharray=\"{} {}\"", DASHES[0], DASHES[1])?;
            }
            writeln!(to, " stroke-linejoin=\"round\"/>")
        }
        Shape::Area { points, color, opacity } => {
            let (class, points, hex) = (class(*color, "fill"), pairs(points), color.hex()[0]);
            write!(to, "<polygon class=\"{class}\" points=\"{points}\"")?;
            writeln!(to, " fill=\"{hex}\" fill-opacity=\"{opacity}\"/>")
        }
        Shape::Marks { at, mark, color } => {
            let (property, radius) = match mark {
                Mark::Dot => ("fill", RADIUS),
                Mark::Ring => ("stroke", RING.0),
            };
            let line = format!(" fill=\"none\" stroke-width=\"{}\"", RING.1);
            let line = if *mark == Mark::Ring { &line } else { "" };
            let (class, hex) = (class(*color, property), color.hex()[0]);
            writeln!(to, "<g class=\"{class}\" {property}=\"{hex}\"{line}>")?;
            for (x, y) in at {
                writeln!(to, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\"/>")?;
            }
            writeln!(to, "</g>")
        }
        Shape::Text(text) => write_text(to, text),
    }
}

fn pairs(points: &[Point]) -> String {
    points.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect::<Vec<_>>().join(" ")
}

fn write_text(
    to: &mut String,
    Text { at: (x, y), text, size, color, anchor, upwards }: &Text,
) -> std::fmt::Result {
    let anchor = match anchor {
        Anchor::Start => "start",
        Anchor::Middle => "middle",
        Anchor::End => "end",
    };
    let place = match upwards {
        true => format!("transform=\"translate({x:.1} {y:.1}) rotate(-90)\""),
        false => format!("x=\"{x:.1}\" y=\"{y:.1}\""),
    };
    let (letters, text) = (format!("text-anchor=\"{anchor}\" font-size=\"{size}\""), escape(text));
    let (class, fill) = (class(*color, "fill"), color.hex()[0]);
    writeln!(to, "<text class=\"{class}\" {place} {letters} fill=\"{fill}\">{text}</text>")
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}
