//! A toy gyroscope as an animated picture: `cargo run --example lagrange_top > docs/lagrange_top.svg`
//!
//! The top is let go at an angle. It nods and goes about; its spin is such that the path of its axis closes after five nods.

use std::f64::consts::TAU;

use coadjoint::prelude::*;
use coadjoint::{Invariants, Run};

/// Lagrange's top: round, with its centre of mass on its axis. In space `L' = r × F`.
#[lie_poisson_system(group = SO3, advected(up: R3), potential = weight * length * up.z)]
struct Top {
    /// About the point of the stem, kg m².
    #[inertia]
    inertia: Vector3<f64>,
    /// N
    weight: f64,
    /// From the point of the stem to the disc, m.
    length: f64,
}

/// Radius of the disc, m.
const RADIUS: f64 = 0.04;
/// From the point to the disc, and to the upper end of the stem, m.
const LENGTH: f64 = 0.05;
const STEM: f64 = 0.09;
/// Angular velocity about the axis, rad/s, and the time after which the path of the axis closes, s.
const SPIN: f64 = 128.3235;
const PERIOD: f64 = 1.164_66;
/// How many times slower the picture is than the motion.
const SLOWER: f64 = 8.0;
/// Moments that are drawn, steps between two of them, and how many share one drawing of the disc.
const MOMENTS: usize = 400;
const STEPS: u64 = 10;
const SHARED: usize = 5;

/// The direction in which the eye is: in front, 22° above the horizon.
fn eye() -> Vector3<f64> {
    let (sine, cosine) = 22_f64.to_radians().sin_cos();
    vector![0.0, -cosine, sine]
}

/// Where a point in space appears.
fn seen(point: Vector3<f64>) -> String {
    let up = Vector3::x().cross(&-eye());
    format!("{:.1},{:.1}", 240.0 + 2_400.0 * point.x, 240.0 - 2_400.0 * up.dot(&point))
}

/// An SVG element whose points move.
fn moving(element: &str, style: &str, moments: &[Vec<Vector3<f64>>]) -> String {
    let line =
        |points: &Vec<Vector3<f64>>| points.iter().map(|point| seen(*point)).collect::<Vec<_>>().join(" ");
    let values = moments.iter().map(line).collect::<Vec<_>>().join(";");
    let duration = SLOWER * PERIOD;
    format!(
        "<{element} {style}><animate attributeName=\"points\" dur=\"{duration:.2}s\" \
         repeatCount=\"indefinite\" values=\"{values}\"/></{element}>\n"
    )
}

/// The edge of the disc on this axis.
fn rim(axis: &Vector3<f64>) -> Vec<Vector3<f64>> {
    let across = axis.cross(&Vector3::x()).normalize();
    let along = across.cross(axis);
    let point = |angle: f64| LENGTH * axis + RADIUS * (angle.cos() * along + angle.sin() * across);
    (0..36).map(|k| point(TAU * f64::from(k) / 36.0)).collect()
}

/// The picture of a motion.
fn print(attitudes: &[UnitQuaternion<f64>], caption: &str) {
    let axes: Vec<_> = attitudes.iter().map(|attitude| attitude * Vector3::z()).collect();
    let few: Vec<_> = axes.iter().step_by(SHARED).collect();
    // the stem's part below the disc, and the one above it; the eye may be on either side
    let stem = |axis: &Vector3<f64>, is_front: bool| {
        let end = if (axis.dot(&eye()) > 0.0) == is_front { STEM } else { 0.0 };
        vec![LENGTH * axis, end * axis]
    };
    let behind: Vec<_> = few.iter().map(|axis| stem(axis, false)).collect();
    let before: Vec<_> = few.iter().map(|axis| stem(axis, true)).collect();
    let discs: Vec<_> = few.iter().map(|axis| rim(axis)).collect();
    let spoke = |attitude: &UnitQuaternion<f64>| {
        [-RADIUS, RADIUS].map(|x| attitude * vector![x, 0.0, LENGTH]).to_vec()
    };
    let spokes: Vec<_> = attitudes.iter().map(spoke).collect();
    let path: Vec<_> = axes.iter().step_by(2).map(|axis| seen(STEM * axis)).collect();

    println!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 480 300\" fill=\"none\" stroke-linecap=\"round\">\n\
         <title>A Lagrange top, {SLOWER} times slower than it moves</title>\n\
         <desc>Made by: cargo run --example lagrange_top</desc>\n\
         <style>text{{font:13px sans-serif;fill:#555}}@media(prefers-color-scheme:dark){{text{{fill:#bbb}}}}</style>\n\
         <ellipse cx=\"240\" cy=\"240\" rx=\"60\" ry=\"22\" fill=\"#888\" fill-opacity=\".15\"/>"
    );
    let grey = "stroke=\"#777\" stroke-width=\"5\"";
    print!("{}", moving("polyline", grey, &behind));
    let disc = "fill=\"#0072b2\" fill-opacity=\".85\" stroke=\"#004c78\" stroke-width=\"2\"";
    print!("{}", moving("polygon", disc, &discs));
    print!("{}", moving("polyline", "stroke=\"#9fd3f2\" stroke-width=\"3\"", &spokes));
    print!("{}", moving("polyline", grey, &before));
    println!("<polygon points=\"{}\" stroke=\"#e69f00\" stroke-width=\"1.5\"/>", path.join(" "));
    println!("<text x=\"240\" y=\"292\" text-anchor=\"middle\">{caption}</text>\n</svg>");
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mass = 0.2;
    let about = mass * RADIUS.powi(2) / 2.0;
    let across = about / 2.0 + mass * LENGTH.powi(2);
    let top = Top { inertia: vector![across, across, about], weight: mass * 9.81, length: LENGTH };
    let attitude = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 30_f64.to_radians());
    let momentum = vector![0.0, 0.0, about * SPIN];
    let mut state = TopState { attitude, momentum, up: attitude.inverse() * Vector3::z() };

    // once around, a moment after every ten steps
    let mut stepper = top.stepper::<Exponential>(PERIOD / (MOMENTS as f64 * STEPS as f64))?;
    let mut attitudes = Vec::new();
    Run::new(&mut stepper, &mut state)
        .every(STEPS, |tick| attitudes.push(tick.state.attitude))
        .steps(MOMENTS as u64 * STEPS)?;
    let [first, last] = [0, MOMENTS].map(|moment| attitudes[moment] * Vector3::z());
    assert!((last - first).norm() < 1e-3, "the path closes");

    // a million steps, for what is kept
    let mut invariants = Invariants::new();
    Run::new(&mut stepper, &mut state).observe(&mut invariants).steps(1_000_000)?;
    let worst = invariants.casimir_drifts().iter().fold(0.0, |worst: f64, drift| worst.max(*drift));
    assert!(worst < 1e-12, "{worst}");

    let step = 1e3 * stepper.step_size();
    print(&attitudes, &format!("a million steps of {step:.2} ms: Casimirs kept within {worst:.0e}"));
    Ok(())
}

#[test]
fn runs() -> Result<(), Box<dyn std::error::Error>> {
    main()
}
