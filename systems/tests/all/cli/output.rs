//! What is written and drawn: tables in three formats, pictures, pages, figures, generated code.

use std::fs;

use serde_json::Value;

use super::{Scratch, shown, table, text};

#[test]
fn csv_and_json_hold_the_same_numbers_to_the_last_digit() {
    let scratch = Scratch::new("run-json");
    let arguments =
        ["run", "heavy_top", "--retraction", "cayley", "--duration", "0.3", "--set", "chi=0,0.25,1"];
    scratch.prints(&arguments);
    scratch.prints(&[&arguments[..], &["--format", "json", "--out", "deep/er"]].concat());

    let csv = scratch.read("out/heavy_top-cayley.csv");
    let (header, rows) = table(&csv);
    assert_eq!(rows.len(), 31);
    let json: Value = serde_json::from_str(&scratch.read("deep/er/heavy_top-cayley.json")).expect("JSON");
    assert_eq!(json["columns"], serde_json::json!(header));
    assert!(json["rows"] == serde_json::json!(rows), "the files differ");
    assert_eq!(json["system"], "heavy_top");
    assert_eq!(json["retraction"], "cayley");
    assert_eq!((&json["method"], &json["order"]), (&"standard".into(), &2.into()));
    assert_eq!(json["step"], 0.01);
    assert_eq!(
        json["parameters"],
        serde_json::json!({ "inertia": [1.0, 10.0, 100.0], "weight": 1.0, "chi": [0.0, 0.25, 1.0] })
    );
    let energy = &json["invariants"]["energy"];
    assert_eq!(energy["initial"].as_f64(), Some(rows[0][11]));
    assert!(energy["largest_error"].as_f64().expect("a number") < 1e-3);
}

#[test]
fn a_run_is_drawn_where_that_is_asked_for() {
    let scratch = Scratch::new("plot");
    for system in ["kepler", "quadrotor", "heavy_top_on_se3"] {
        let printed = scratch
            .prints(&["run", system, "--every", "1000", "--plot", "--out", system, "--method", "midpoint"]);
        let stem = format!("{system}-midpoint-exponential");
        assert!(printed.contains(&stem) && printed.contains(".png"), "{printed}");
        assert_eq!(scratch.files(system), ["csv", "png", "svg"].map(|end| format!("{stem}.{end}")));
        let svg = scratch.read(&format!("{system}/{stem}.svg"));
        assert!(svg.contains("</svg>") && !svg.contains("NaN"));
    }
}

#[test]
fn show_prints_code_that_parses() {
    let scratch = Scratch::new("show");
    for system in ["heavy_top", "free_rigid_body", "quadrotor", "lagrange_top"] {
        for retraction in [&[][..], &["--retraction", "exp"], &["--retraction", "cayley"]] {
            let code = scratch.prints(&[&["show", system], retraction].concat());
            syn::parse_file(&code).expect("Rust");
            assert!(code.lines().count() > 10, "{code}");
        }
    }
}

#[test]
fn parquet_holds_what_csv_holds() {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;
    let scratch = Scratch::new("parquet");
    let arguments = ["run", "gyrostat", "--duration", "300", "--step", "0.01"];
    scratch.prints(&arguments);
    scratch.prints(&[&arguments[..], &["--format", "parquet"]].concat());
    let csv = scratch.read("out/gyrostat-exponential.csv");
    let (header, rows) = table(&csv);
    // more than one row group
    assert_eq!(rows.len(), 30_001);
    let file = fs::File::open(scratch.path("out/gyrostat-exponential.parquet")).expect("written");
    let reader = SerializedFileReader::new(file).expect("Parquet");
    assert_eq!(reader.metadata().num_row_groups(), 2);
    let metadata = reader.metadata().file_metadata().key_value_metadata().expect("there is");
    let value = |key: &str| metadata.iter().find(|pair| pair.key == key).and_then(|pair| pair.value.clone());
    assert_eq!(value("system").as_deref(), Some("\"gyrostat\""));
    assert!(value("invariants").expect("there").contains("largest_error"));
    for (row, expected) in reader.get_row_iter(None).expect("rows").zip(&rows) {
        let row = row.expect("readable");
        let names: Vec<&String> = row.get_column_iter().map(|(name, _)| name).collect();
        assert_eq!(names, header);
        let numbers: Vec<f64> = row
            .get_column_iter()
            .map(|(_, field)| if let Field::Double(number) = field { *number } else { panic!("{field}") })
            .collect();
        assert_eq!(&numbers, expected);
    }
}

#[test]
fn a_view_is_one_page_that_needs_nothing_else() {
    let scratch = Scratch::new("view");
    for system in
        ["heavy_top", "kepler", "planar_pendulum", "coupled_bodies", "rigid_body_in_space", "quadrotor"]
    {
        scratch.prints(&["view", system]);
        let page = scratch.read(&format!("out/{system}-exponential.html"));
        assert!(page.contains("default-src 'none'"), "{system}");
        // names of XML's, and where three.js is from, are no requests
        let names = ["http://www.w3.org/1999/xhtml", "http://www.w3.org/2000/svg", "https://threejs.org"];
        let page = names.iter().fold(page, |page, name| page.replace(name, ""));
        assert!(
            !page.contains("__COADJOINT_DATA__") && !page.contains("http://") && !page.contains("https://"),
            "{system}"
        );
        let data = shown(&page);
        assert_eq!(data["title"], system);
        let moments = data["time"].as_array().expect("a list").len();
        assert!((1001..=8192).contains(&moments), "{system}: {moments}");
        let page = coadjoint_app::page::Page::from_json(&data.to_string()).expect(system);
        assert_eq!(page.runs.len(), 1, "{system}");
        assert!(!page.runs[0].bodies.is_empty() && !page.runs[0].plots.is_empty(), "{system}");
    }
    assert_eq!(scratch.files("out").len(), 6, "pages alone");
}

#[test]
fn a_figure_is_a_picture_its_data_and_its_caption() {
    let scratch = Scratch::new("figures");
    let printed = scratch.prints(&["figures", "1.1", "1.2", "1.3"]);
    assert!(printed.contains("1.645 times the energy"), "{printed}");
    let files = ["1.1", "1.2", "1.3"]
        .map(|name| ["csv", "png", "svg", "txt"].map(|extension| format!("figure-{name}.{extension}")));
    let mut files = files.concat();
    files.push("index.html".to_owned());
    assert_eq!(scratch.files("out/figures"), files);
    let csv = scratch.read("out/figures/figure-1.1.csv");
    assert_eq!(csv.lines().next(), Some("panel,horizontal,vertical,series,x,y"));
    assert!(csv.contains("\n1,\"position q, m\",\"momentum p, kg m/s\",explicit Euler,1.0,0.0\n"), "{csv}");

    // the numbers of a caption are those of the file beside it
    let csv = scratch.read("out/figures/figure-1.2.csv");
    let values = |panel: usize, series: &str| -> Vec<f64> {
        let of_series =
            |line: &&str| line.starts_with(&format!("{panel},")) && line.contains(&format!(",{series},"));
        let value = |line: &str| line.rsplit(',').next().and_then(|y| y.parse().ok()).expect("a number");
        csv.lines().filter(of_series).map(value).collect()
    };
    let caption = scratch.read("out/figures/figure-1.2.txt");
    for (panel, series) in [(3, "RK2"), (4, "RK2"), (3, "Störmer–Verlet"), (4, "Störmer–Verlet")] {
        let largest = values(panel, series).into_iter().map(f64::abs).fold(0.0, f64::max);
        let text = coadjoint_app::picture::two_digits(largest);
        assert!(largest > 0.0 && caption.contains(&text), "{text} in {caption}");
    }
    for panel in [3, 4] {
        let text = coadjoint_app::picture::two_digits(*values(panel, "RK2").last().expect("a last one"));
        assert!(caption.contains(&text), "{text} in {caption}");
    }
    let page = scratch.read("out/figures/index.html");
    for link in ["href=\"#1.2\"", "src=\"figure-1.2.svg\"", "href=\"figure-1.2.txt\""] {
        assert!(page.contains(link), "{link} in {page}");
    }
    let paragraphs: Vec<&str> = caption.lines().skip(2).collect();
    assert!(!paragraphs.is_empty() && paragraphs.iter().all(|paragraph| page.contains(paragraph)), "{page}");
}

/// Beside figures it says what made them; they take the place of the same figures alone, and those that were there stay on
/// the page.
#[test]
fn figures_take_no_others_place() {
    let scratch = Scratch::new("figures-guarded");
    scratch.prints(&["figures", "1.1"]);
    let made: Value = serde_json::from_str(&scratch.read("out/figures/figure-1.1.run.json")).expect("JSON");
    assert_eq!((&made["program"], &made["command"]), (&"coadjoint".into(), &"figures 1.1".into()));
    for extension in ["csv", "png", "svg", "txt"] {
        let name = format!("figure-1.1.{extension}");
        assert_eq!(made["files"][&name], "complete", "{made}");
        let output = scratch.coadjoint(&["run", "--again", &format!("out/figures/{name}")]);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains("`coadjoint figures 1.1` makes it again"), "{message}");
    }
    // the same again, and another one beside it
    scratch.prints(&["figures", "1.1"]);
    scratch.prints(&["figures", "1.2"]);
    let page = scratch.read("out/figures/index.html");
    for link in ["src=\"figure-1.1.svg\"", "src=\"figure-1.2.svg\""] {
        assert!(page.contains(link), "{link} in {page}");
    }
    for name in ["figure-1.2.csv", "index.html"] {
        let path = scratch.0.join("out/figures").join(name);
        let beside = path.with_extension("run.json");
        let (before, made) = (fs::read(&path).expect(name), fs::read(&beside).expect(name));
        fs::write(&path, "mine").expect("writable");
        for others in [None, Some("mine too")] {
            match others {
                None => fs::remove_file(&beside).expect("there"),
                Some(others) => fs::write(&beside, others).expect("writable"),
            }
            let output = scratch.coadjoint(&["figures", "1.1", "1.2"]);
            let message = text(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{name}: {message}");
            let stem = name.split_once(".csv").map_or("index", |(stem, _)| stem);
            assert!(
                message.contains(stem) && message.contains("was not made by this program"),
                "{name}: {message}"
            );
            assert_eq!(fs::read(&path).expect(name), b"mine");
            // nothing was drawn before it was refused
            assert!(output.stdout.is_empty(), "{}", text(&output.stdout));
        }
        fs::write(&path, before).expect("writable");
        fs::write(&beside, made).expect("writable");
    }
    let [first, second] =
        ["1.1", "1.2"].map(|name| scratch.0.join(format!("out/figures/figure-{name}.run.json")));
    let other = fs::read_to_string(first).expect("there").replace("figure-1.1", "figure-1.2");
    fs::write(second, other).expect("writable");
    let output = scratch.coadjoint(&["figures", "1.2"]);
    assert!(text(&output.stderr).contains("was made by `figures 1.1`"), "{}", text(&output.stderr));
    scratch.prints(&["figures", "1.2", "--force"]);
    let output = scratch.coadjoint(&["figures", "1.2", "--out", "-"]);
    assert!(text(&output.stderr).contains("give `--out` a directory"), "{}", text(&output.stderr));
}
