//! The colours of pictures: one for each method, everywhere, and others for what has no method.
//!
//! Those that stand in one picture can be told apart with any colour vision, on white and on black: they differ in lightness too. A method on a
//! retraction has the retraction's colour, another the colour of its scheme.

/// What a colour means.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Color {
    /// What others are compared with: black on white, white on black.
    Ink,
    /// Grid lines.
    Grid,
    /// What lies below everything.
    Paper,
    /// Steps of order 2 on the exponential map.
    Exponential,
    /// Steps of order 2 on the Cayley map.
    Cayley,
    /// Compositions of Cayley steps, of order 4.
    Order4,
    /// Of order 6.
    Order6,
    /// Of order 8.
    Order8,
    /// Of order 10.
    Order10,
    /// The classical method of order 4.
    Rk4,
    /// The method of Runge, Kutta, Munthe and Kaas, of order 4.
    Rkmk4,
    /// The explicit midpoint rule.
    Rk2,
    /// The same with projection.
    Rk2Projected,
    /// Störmer–Verlet where there is no retraction.
    Verlet,
    /// Symplectic Euler A where there is no retraction.
    EulerA,
    /// Symplectic Euler B where there is no retraction.
    EulerB,
    /// The explicit Euler method.
    ExplicitEuler,
    /// The implicit Euler method.
    ImplicitEuler,
    /// The first component of a vector, or the only series.
    X,
    /// The second component.
    Y,
    /// The third component.
    Z,
    /// The fourth component.
    W,
    /// The fifth component.
    V,
    /// The sixth component.
    U,
}

impl Color {
    /// Of the components of a vector, in their order.
    pub fn component(index: usize) -> Self {
        const COMPONENTS: [Color; 6] = [Color::X, Color::Y, Color::Z, Color::W, Color::V, Color::U];
        COMPONENTS[index % COMPONENTS.len()]
    }

    /// On white, and on black.
    pub fn hex(self) -> [&'static str; 2] {
        match self {
            Color::Ink => ["#1c1f23", "#e6e8ea"],
            Color::Grid => ["#dfe2e6", "#31363c"],
            Color::Paper => ["#ffffff", "#14171a"],
            Color::Exponential | Color::X => ["#0072b2", "#4fa8e0"],
            Color::Cayley => ["#e08a00", "#f0a22e"],
            Color::Order4 => ["#c4463a", "#e8705f"],
            Color::Order6 => ["#9c2a5b", "#d2659a"],
            Color::Order8 => ["#6a1f7a", "#b37fd0"],
            Color::Order10 => ["#2d1050", "#9d93e8"],
            Color::Rk4 | Color::Z => ["#009e73", "#2cbf94"],
            Color::Rkmk4 => ["#cc6fa8", "#e79aca"],
            Color::Rk2 | Color::ExplicitEuler | Color::Y => ["#d55e00", "#f08a45"],
            Color::Rk2Projected | Color::ImplicitEuler => ["#b9a000", "#d9c63c"],
            Color::Verlet | Color::EulerA => ["#332288", "#9a8cf0"],
            Color::EulerB => ["#3fa7d6", "#7cc8ea"],
            Color::W => ["#aa4499", "#d685c8"],
            Color::V => ["#777777", "#a0a0a0"],
            Color::U => ["#b9a000", "#d9c63c"],
        }
    }

    /// Red, green and blue on white.
    #[cfg(feature = "png")]
    pub(super) fn rgb(self) -> [u8; 3] {
        let digits = self.hex()[0].trim_start_matches('#');
        [0, 2, 4]
            .map(|at| digits.get(at..at + 2).and_then(|pair| u8::from_str_radix(pair, 16).ok()).unwrap_or(0))
    }
}
