//! Whole pictures.

use super::*;

const STYLES: [Style; 7] = [
    Style::Line,
    Style::Dashed,
    Style::Marked(Mark::Dot),
    Style::DashedMarked(Mark::Ring),
    Style::Marks(Mark::Dot),
    Style::Band(0.2),
    Style::Bars,
];

fn figure(panels: Vec<Panel>) -> Figure {
    let span = (0.0, 10.0);
    Figure::over_time("t <&> t".to_owned(), "time, s", span, Key::Each, panels)
}

fn panel(label: &str, axis: Axis, color: Color, style: Style, values: &[f64]) -> Panel {
    let points = values.iter().enumerate().map(|(i, &y)| (i as f64, y)).collect();
    Panel::new(Axis::linear("x"), axis, vec![Series::new(label, color, style, points)])
}

#[test]
fn figures_without_any_variation_can_be_drawn() {
    for values in [&[][..], &[0.0], &[0.0, 0.0], &[1e-3, 1e-3], &[f64::NAN, f64::INFINITY, 1.0]] {
        for style in STYLES {
            for key in [Key::Above, Key::Each] {
                for axis in [Axis::logarithmic("error"), Axis::linear("error")] {
                    let panel = panel("a", axis, Color::X, style, values);
                    let stacked = Figure { key, ..figure(vec![panel.clone()]) };
                    let beside = Figure {
                        columns: 2,
                        shared: (true, true),
                        panels: vec![Panel { equal: true, ..panel.clone() }, panel],
                        ..stacked.clone()
                    };
                    for figure in [stacked, beside, Figure { panels: Vec::new(), ..self::figure(Vec::new()) }]
                    {
                        let svg = figure.svg();
                        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{values:?} {style:?} {key:?}");
                    }
                }
            }
        }
    }
}

#[test]
fn titles_that_are_long_stand_in_lines() {
    let panel = panel("a", Axis::linear("y"), Color::X, Style::Line, &[0.0, 1.0]);
    let words = "momentum ± 2%, ".repeat(30);
    let figure = Figure { title: words.trim_end_matches([',', ' ']).to_owned(), ..figure(vec![panel]) };
    let scene = layout::scene(&figure);
    let titles: Vec<_> = scene
        .shapes
        .iter()
        .filter_map(|shape| match shape {
            scene::Shape::Text(text) if text.text.contains('±') => Some(text),
            _ => None,
        })
        .collect();
    assert!(titles.len() > 2, "{titles:?}");
    for title in &titles {
        assert!(font::width(&title.text, title.size) < scene.width, "{title:?}");
    }
    assert!(titles.windows(2).all(|pair| pair[1].at.1 >= pair[0].at.1 + pair[0].size), "{titles:?}");
    let joined = titles.iter().map(|title| title.text.as_str()).collect::<Vec<_>>().join(" ");
    assert_eq!(joined, figure.title);
}

/// Lists the texts between a tag's beginning and the next quotation mark.
fn all<'a>(svg: &'a str, beginning: &str) -> Vec<&'a str> {
    svg.split(beginning).skip(1).filter_map(|rest| rest.split('"').next()).collect()
}

#[test]
fn a_line_is_where_its_values_are() {
    let panel =
        panel("a", Axis::linear("y").within(0.0, 4.0), Color::Rk4, Style::Line, &[0.0, 4.0, 1.0, 9.0]);
    let svg = Figure { title: String::new(), ..figure(vec![panel]) }.svg();
    let [line] = all(&svg, "<polyline class=\"stroke-rk4\" points=\"")[..] else { panic!("{svg}") };
    let points: Vec<(f64, f64)> = line
        .split(' ')
        .filter_map(|point| point.split_once(','))
        .map(|(x, y)| (x.parse().expect("x"), y.parse().expect("y")))
        .collect();
    let [(left, bottom), (x, top), (x2, y2), (x3, y3)] = points[..] else { panic!("{line}") };
    // the frame is 760 by 170, and ten seconds long
    assert!((x - left - 76.0).abs() < 0.11 && (bottom - top - 170.0).abs() < 0.11, "{line}");
    assert!((x2 - left - 152.0).abs() < 0.11 && (bottom - y2 - 42.5).abs() < 0.11, "{line}");
    // out at the upper edge, after 3/8 of the way
    assert!((x3 - x2 - 28.5).abs() < 0.11 && (y3 - top).abs() < 0.11, "{line}");
}

#[test]
fn a_dark_page_has_other_colours() {
    let svg = figure(vec![panel("a", Axis::linear("y"), Color::Rk4, Style::Line, &[0.0, 1.0])]).svg();
    let [light, dark] = Color::Rk4.hex();
    assert!(svg.contains(&format!("stroke=\"{light}\"")), "{svg}");
    assert!(svg.contains(&format!(".stroke-rk4 {{ stroke: {dark} }}")), "{svg}");
    assert!(svg.contains("<title>t &lt;&amp;> t</title>"), "{svg}");
}

#[test]
fn panels_share_their_axes() {
    let panels = |high: f64| panel("", Axis::linear("y"), Color::X, Style::Line, &[0.0, high]);
    let both = Figure { columns: 2, shared: (true, true), ..figure(vec![panels(1.0), panels(100.0)]) };
    let svg = both.svg();
    let lines = all(&svg, "<polyline class=\"stroke-x\" points=\"");
    let top = |line: &str| line.rsplit(',').next().and_then(|y| y.parse::<f64>().ok()).expect("a line");
    let [small, large] = [top(lines[0]), top(lines[1])];
    assert!(small - large > 140.0, "{small} {large}");
    // one axis has numbers and a name
    assert_eq!(svg.matches(">y</text>").count(), 1);
    assert_eq!(svg.matches(">100</text>").count(), 1);
}

#[test]
fn a_key_has_each_name_once() {
    let panels = || {
        let mut panel = panel("RK4", Axis::linear("y"), Color::Rk4, Style::Line, &[0.0, 1.0]);
        panel.series.push(Series::line("RKMK4", Color::Rkmk4, vec![(0.0, 1.0), (1.0, 0.0)]));
        panel
    };
    for (key, times) in [(Key::Above, 1), (Key::Each, 2)] {
        let svg = Figure { key, ..figure(vec![panels(), panels()]) }.svg();
        assert_eq!(svg.matches(">RK4</text>").count(), times, "{key:?}");
    }
}

#[test]
fn a_long_label_stays_beside_its_panel() {
    let label = "a quantity with a name that is longer than its panel is high, kg m²/s";
    let svg = figure(vec![panel("", Axis::linear(label), Color::X, Style::Line, &[0.0, 1.0])]).svg();
    let text = svg.lines().find(|line| line.contains(label)).expect("it is written");
    let size: f64 = all(text, "font-size=\"")[0].parse().expect("a number");
    assert!(font::width(label, 14.0) > 170.0 && font::width(label, size) < 170.1, "{size}");
}

#[test]
fn bands_are_as_dark_in_the_key_as_in_the_picture() {
    let edge = |height: f64| vec![(0.0, height), (10.0, height)];
    let band = |label: &str, height: f64| Series::band(label, Color::X, 0.2, edge(-height), edge(height));
    let series = vec![band("all", 3.0), band("most", 2.0), band("half", 1.0)];
    let panel = Panel::new(Axis::linear("x"), Axis::linear("y"), series);
    let svg = Figure { key: Key::Above, ..figure(vec![panel]) }.svg();
    // one, two and three upon each other
    assert_eq!(svg.matches("<polygon").count(), 3 + 1 + 2 + 3);
}

/// Reads a picture by another program's reader.
#[cfg(feature = "png")]
fn decoded(file: Vec<u8>) -> (::png::OutputInfo, Vec<u8>) {
    let mut reader = ::png::Decoder::new(std::io::Cursor::new(file)).read_info().expect("a picture");
    let mut pixels = vec![0; reader.output_buffer_size().expect("small")];
    (reader.next_frame(&mut pixels).expect("a picture"), pixels)
}

/// Where a picture has ink as pixels it has it as SVG.
#[cfg(feature = "png")]
#[test]
fn pixels_show_what_the_picture_shows() {
    let panel = panel("", Axis::linear("y").within(0.0, 1.0), Color::Rk4, Style::Line, &[0.5, 0.5]);
    let figure = Figure { title: String::new(), ..figure(vec![panel]) };
    let svg = figure.svg();
    let line = all(&svg, "<polyline class=\"stroke-rk4\" points=\"")[0];
    let (x, y) = line.split(' ').next().and_then(|point| point.split_once(',')).expect("a point");
    let [x, y] = [x, y].map(|number| number.parse::<f64>().expect("a number"));
    let (info, pixels) = decoded(figure.picture(Kind::Png));
    assert_eq!((info.width % 2, info.height % 2), (0, 0));
    assert_eq!(info.color_type, ::png::ColorType::Rgb);
    let at = |x: f64, y: f64| {
        let start = ((2.0 * y) as usize * info.width as usize + (2.0 * x) as usize) * 3;
        pixels[start..start + 3].to_vec()
    };
    assert_eq!(at(x + 50.0, y), Color::Rk4.rgb());
    assert_eq!(at(x + 50.0, y + 10.0), [255; 3]);
    // the line ends after a second
    assert_eq!(at(x + 100.0, y + 10.0), [255; 3]);
}

/// A text that is read upwards is as pixels where it is as SVG: about its place, and as long as its letters.
#[cfg(feature = "png")]
#[test]
fn pixels_show_texts_at_their_places() {
    let label = "a label";
    let figure = figure(vec![panel("", Axis::linear(label), Color::X, Style::Line, &[0.0, 1.0])]);
    let svg = figure.svg();
    let text = svg.lines().find(|line| line.contains("rotate(-90)")).expect("it is written");
    let (x, y) = all(text, "translate(")[0].split_once(' ').expect("a place");
    let [x, y] = [x, y.split(')').next().expect("y")].map(|number| number.parse::<f64>().expect("a number"));
    let (info, pixels) = decoded(figure.picture(Kind::Png));
    // the letters' rows stand left of the place where they begin
    let columns = (2.0 * (x - 10.0)) as usize..(2.0 * x) as usize;
    let is_ink = |row: usize, column: usize| pixels[(row * info.width as usize + column) * 3] < 128;
    let rows: Vec<f64> = (0..info.height as usize)
        .filter(|&row| columns.clone().any(|column| is_ink(row, column)))
        .map(|row| row as f64 / 2.0)
        .collect();
    let (first, last) = (rows[0], rows[rows.len() - 1]);
    assert!((0.5 * (first + last) - y).abs() < 1.5, "{first} {last} {y}");
    assert!((last - first - font::width(label, 14.0)).abs() < 3.0, "{first} {last}");
}
