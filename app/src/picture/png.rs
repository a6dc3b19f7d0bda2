//! A picture as pixels, drawn as browsers draw it: the same shapes, with the font that is built in.

use zeno::{Angle, Cap, Command, Join, Mask, PathBuilder, Stroke, Style, Transform, Vector};

use super::font;
use super::palette::Color;
use super::scene::{Anchor, DASHES, Mark, Point, RADIUS, RING, Scene, Shape, Text};

/// Pixels to a unit: sharp in print and on dense screens.
const SCALE: f32 = 2.0;

/// The picture as a PNG file, on white.
pub(super) fn png(scene: &Scene) -> Vec<u8> {
    let [width, height] = [scene.width, scene.height].map(|length| length.ceil() as u32 * SCALE as u32);
    let mut canvas = Canvas { width, pixels: vec![255; width as usize * height as usize * 3] };
    for shape in &scene.shapes {
        canvas.draw(shape);
    }
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_compression(png::Compression::Balanced);
    // the smallest files of lines on white
    encoder.set_filter(png::Filter::NoFilter);
    // writing to memory does not fail
    let _ = encoder.write_header().and_then(|mut writer| writer.write_image_data(&canvas.pixels));
    file
}

struct Canvas {
    width: u32,
    /// Red, green and blue, row by row.
    pixels: Vec<u8>,
}

type Path = Vec<Command>;

fn vector((x, y): Point) -> Vector {
    Vector::new(x as f32, y as f32)
}

impl Canvas {
    fn draw(&mut self, shape: &Shape) {
        match shape {
            Shape::Line { points, color, width, dashed } => {
                let mut stroke = Stroke::new(*width as f32);
                stroke.join(Join::Round).cap(Cap::Butt);
                if *dashed {
                    stroke.dash(&DASHES, 0.0);
                }
                self.fill(&polyline(points), stroke, *color, 1.0);
            }
            Shape::Area { points, color, opacity } => {
                let mut path = polyline(points);
                path.close();
                self.fill(&path, zeno::Fill::NonZero, *color, *opacity);
            }
            Shape::Marks { at, mark, color } => {
                let (radius, style): (f64, Style<'_>) = match mark {
                    Mark::Dot => (RADIUS, zeno::Fill::NonZero.into()),
                    Mark::Ring => (RING.0, Stroke::new(RING.1 as f32).into()),
                };
                for point in at {
                    let mut path = Path::new();
                    path.add_circle(vector(*point), radius as f32);
                    self.fill(&path, style, *color, 1.0);
                }
            }
            Shape::Text(text) => self.text(text),
        }
    }

    fn text(&mut self, text: &Text) {
        let length = font::width(&text.text, text.size) as f32;
        let back = match text.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => 0.5 * length,
            Anchor::End => length,
        };
        let turn = Transform::rotation(Angle::from_degrees(if text.upwards { -90.0 } else { 0.0 }));
        let start = vector(text.at) - turn.transform_vector(Vector::new(back, 0.0));
        let place = turn.then_translate(start.x, start.y);
        let outline = font::outline(&text.text, text.size);
        let path: Path = outline.iter().map(|command| command.transform(&place)).collect();
        self.fill(&path, zeno::Fill::NonZero, text.color, 1.0);
    }

    /// Puts a colour where the path is.
    fn fill<'a>(&mut self, path: &Path, style: impl Into<Style<'a>>, color: Color, opacity: f64) {
        let scaled = Some(Transform::scale(SCALE, SCALE));
        let (mask, place) = Mask::new(path).style(style).transform(scaled).render();
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
    let mut points = points.iter().map(|point| vector(*point));
    let start = points.next().map(Command::MoveTo);
    start.into_iter().chain(points.map(Command::LineTo)).collect()
}
