//! How each method is called, and the colour that it has in every figure.

use coadjoint_app::picture::{Color, Mark, Series, Style};

/// Names in keys and captions.
pub(crate) const EXPONENTIAL: &str = "exponential";
pub(crate) const CAYLEY: &str = "Cayley";
pub(crate) const ORDER_4: &str = "Cayley, order 4";
pub(crate) const ORDER_6: &str = "Cayley, order 6";
pub(crate) const ORDER_8: &str = "Cayley, order 8";
pub(crate) const ORDER_10: &str = "Cayley, order 10";
pub(crate) const HAMILTON_JACOBI: &str = "Hamilton–Jacobi, order 6";
pub(crate) const RK4: &str = "RK4";
pub(crate) const RKMK4: &str = "RKMK4";
pub(crate) const RK2: &str = "RK2";
pub(crate) const RK2_PROJECTED: &str = "RK2 with projection";
pub(crate) const VERLET: &str = "Störmer–Verlet";
pub(crate) const EXPLICIT_EULER: &str = "explicit Euler";
pub(crate) const IMPLICIT_EULER: &str = "implicit Euler";
pub(crate) const EULER_A: &str = "symplectic Euler A";
pub(crate) const EULER_B: &str = "symplectic Euler B";

/// The colour of a method.
pub(crate) fn color(method: &str) -> Color {
    match method {
        EXPONENTIAL => Color::Exponential,
        CAYLEY => Color::Cayley,
        ORDER_4 => Color::Order4,
        ORDER_6 => Color::Order6,
        ORDER_8 => Color::Order8,
        ORDER_10 => Color::Order10,
        HAMILTON_JACOBI => Color::HamiltonJacobi,
        RK4 => Color::Rk4,
        RKMK4 => Color::Rkmk4,
        RK2 => Color::Rk2,
        RK2_PROJECTED => Color::Rk2Projected,
        VERLET => Color::Verlet,
        EXPLICIT_EULER => Color::ExplicitEuler,
        IMPLICIT_EULER => Color::ImplicitEuler,
        EULER_A => Color::EulerA,
        EULER_B => Color::EulerB,
        _ => Color::Ink,
    }
}

/// A line in the method's colour.
pub(crate) fn line(method: &str, points: Vec<(f64, f64)>) -> Series {
    Series::line(method, color(method), points)
}

/// A line with marks: rings where the method does nearly the same as another, so that both can be seen.
pub(crate) fn marked(method: &str, points: Vec<(f64, f64)>) -> Series {
    let style = if method == RKMK4 { Style::Marks(Mark::Ring) } else { Style::Marked(Mark::Dot) };
    Series::new(method, color(method), style, points)
}
