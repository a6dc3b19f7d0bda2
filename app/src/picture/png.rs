//! A picture as pixels, drawn as browsers draw it: the same shapes, with the font that is built in.

use ttf_parser::OutlineBuilder;
use zeno::{Cap, Command, Join, Mask, PathBuilder, Stroke, Style, Vector};

use super::font;
use super::palette::Color;
use super::scene::{Anchor, DASHES, HALO, Mark, Point, RADIUS, RING, Scene, Shape, Text};

/// Pixels to a unit: sharp in print and on dense screens.
const SCALE: f64 = 2.0;

/// The picture as a PNG file, on white.
pub(super) fn png(scene: &Scene) -> Vec<u8> {
    let mut canvas = Canvas::new((scene.width.ceil() * SCALE) as u32, (scene.height.ceil() * SCALE) as u32);
    for shape in &scene.shapes {
        canvas.draw(shape);
    }
    encoded(canvas.width, &canvas.pixels)
}

/// Encodes rows of this width, three bytes a pixel, as a PNG file.
fn encoded(width: u32, pixels: &[u8]) -> Vec<u8> {
    let height = pixels.len() / (width as usize * 3).max(1);
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::Balanced);
    // the smallest files of lines on white
    encoder.set_filter(png::Filter::NoFilter);
    // writing to memory does not fail
    let _ = encoder.write_header().and_then(|mut writer| writer.write_image_data(pixels));
    file
}

struct Canvas {
    width: u32,
    /// Red, green and blue, row by row.
    pixels: Vec<u8>,
}

type Path = Vec<Command>;

fn vector((x, y): Point) -> Vector {
    Vector::new((x * SCALE) as f32, (y * SCALE) as f32)
}

impl Canvas {
    fn new(width: u32, height: u32) -> Self {
        Self { width, pixels: vec![255; width as usize * height as usize * 3] }
    }

    fn draw(&mut self, shape: &Shape) {
        match shape {
            Shape::Line { points, color, width, dashed } => {
                let dashes = DASHES.map(|length| (length * SCALE) as f32);
                let mut stroke = Stroke::new((width * SCALE) as f32);
                stroke.join(Join::Round).cap(Cap::Butt);
                if *dashed {
                    stroke.dash(&dashes, 0.0);
                }
                self.fill(&polyline(points), stroke, *color, 1.0);
            }
            Shape::Area { points, color, opacity } => {
                let mut path = polyline(points);
                path.close();
                self.fill(&path, zeno::Fill::NonZero, *color, *opacity);
            }
            Shape::Marks { at, mark, color } => {
                for point in at {
                    let mut path = Path::new();
                    let circle = |path: &mut Path, radius: f64| {
                        path.add_circle(vector(*point), (radius * SCALE) as f32);
                    };
                    match mark {
                        Mark::Dot => {
                            circle(&mut path, RADIUS);
                            self.fill(&path, zeno::Fill::NonZero, *color, 1.0);
                        }
                        Mark::Ring => {
                            circle(&mut path, RING.0);
                            self.fill(&path, Stroke::new((RING.1 * SCALE) as f32), *color, 1.0);
                        }
                    }
                }
            }
            Shape::Text(text) => self.text(text),
        }
    }

    fn text(&mut self, text: &Text) {
        let length = font::width(&text.text, text.size);
        let back = match text.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5 * length,
            Anchor::End => length,
        };
        let mut pen = Pen { path: Path::new(), text, back, along: 0.0, unit: 0.0 };
        font::outline(&text.text, text.size, &mut pen, |pen, x, unit| {
            (pen.along, pen.unit) = (x - pen.back, unit);
        });
        let path = pen.path;
        if text.halo {
            let mut stroke = Stroke::new((HALO * SCALE) as f32);
            self.fill(&path, stroke.join(Join::Round), Color::Paper, 1.0);
        }
        self.fill(&path, zeno::Fill::NonZero, text.color, 1.0);
    }

    /// Puts a colour where the path is.
    fn fill<'a>(&mut self, path: &Path, style: impl Into<Style<'a>>, color: Color, opacity: f64) {
        let (mask, place) = Mask::new(path).style(style).render();
        let (color, width) = (color.rgb(), self.width as usize);
        // most of what surrounds a line is not covered
        for (k, coverage) in mask.into_iter().enumerate().filter(|(_, coverage)| *coverage > 0) {
            let [x, y] =
                [place.left + (k as u32 % place.width) as i32, place.top + (k as u32 / place.width) as i32];
            let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else { continue };
            let start = (y * width + x) * 3;
            let Some(pixel) = self.pixels.get_mut(start..start + 3).filter(|_| x < width) else { continue };
            let part = f64::from(coverage) / 255.0 * opacity;
            for (below, above) in pixel.iter_mut().zip(color) {
                *below = (f64::from(*below) * (1.0 - part) + f64::from(above) * part).round() as u8;
            }
        }
    }
}

fn polyline(points: &[Point]) -> Path {
    let mut path = Path::new();
    for (k, point) in points.iter().enumerate() {
        match k {
            0 => path.move_to(vector(*point)),
            _ => path.line_to(vector(*point)),
        };
    }
    path
}

/// Draws a letter's outline where it belongs.
struct Pen<'a> {
    path: Path,
    text: &'a Text,
    /// How far before the text's position it begins.
    back: f64,
    /// How far from the text's position this letter begins.
    along: f64,
    /// The size of the font's unit.
    unit: f64,
}

impl Pen<'_> {
    fn point(&self, x: f32, y: f32) -> Vector {
        let (along, up) = (self.along + f64::from(x) * self.unit, f64::from(y) * self.unit);
        let (x, y) = self.text.at;
        vector(if self.text.upwards { (x - up, y - along) } else { (x + along, y - up) })
    }
}

impl OutlineBuilder for Pen<'_> {
    fn move_to(&mut self, x: f32, y: f32) {
        let to = self.point(x, y);
        self.path.move_to(to);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let to = self.point(x, y);
        self.path.line_to(to);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let (control, to) = (self.point(x1, y1), self.point(x, y));
        self.path.quad_to(control, to);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let (first, second, to) = (self.point(x1, y1), self.point(x2, y2), self.point(x, y));
        self.path.curve_to(first, second, to);
    }

    fn close(&mut self) {
        self.path.close();
    }
}
