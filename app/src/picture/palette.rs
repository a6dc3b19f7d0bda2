//! The colours of pictures: one for each method, everywhere, and others for what has no method.
//!
//! Those that stand in one picture can be told apart with any colour vision, on white and on black: they differ in
//! lightness too. A method on a retraction has the retraction's colour, another the colour of its scheme.

/// A colour, by its meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Color {
    /// The colour of references: black on white, white on black.
    Ink,
    /// Grid lines.
    Grid,
    /// The background.
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
    /// Hamilton–Jacobi steps.
    HamiltonJacobi,
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
    /// How many components have a colour of their own.
    pub const COMPONENTS: usize = 6;

    /// Of the components of a vector, in their order.
    pub fn component(index: usize) -> Self {
        const ALL: [Color; Color::COMPONENTS] = [Color::X, Color::Y, Color::Z, Color::W, Color::V, Color::U];
        ALL[index % ALL.len()]
    }

    /// On white, and on black.
    pub fn hex(self) -> [&'static str; 2] {
        match self {
            Color::Ink => ["#1c1f23", "#e6e8ea"],
            Color::Grid => ["#dfe2e6", "#31363c"],
            Color::Paper => ["#ffffff", "#14171a"],
            Color::Exponential | Color::X => ["#0072b2", "#4fa8e0"],
            Color::Cayley => ["#e08a00", "#f0a22e"],
            Color::Order4 => ["#c4463a", "#db2825"],
            Color::Order6 => ["#9c2a5b", "#d53a8f"],
            Color::Order8 => ["#6a1f7a", "#c54af0"],
            Color::Order10 => ["#2d1050", "#ddc7fd"],
            Color::HamiltonJacobi => ["#3d2b00", "#f5ff8a"],
            Color::Rk4 | Color::Z => ["#009e73", "#2cbf94"],
            Color::Rkmk4 => ["#cc6fa8", "#ee9dc7"],
            Color::Rk2 | Color::ExplicitEuler | Color::Y => ["#d55e00", "#f08a45"],
            Color::Rk2Projected | Color::ImplicitEuler => ["#dfb600", "#f3d94e"],
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
        let digits = u32::from_str_radix(self.hex()[0].trim_start_matches('#'), 16);
        let [_, red, green, blue] = digits.unwrap_or(0).to_be_bytes();
        [red, green, blue]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Red, green and blue as people without one kind of cones see them (Machado, Oliveira and Fernandes 2009): none is
    /// missing, the one for long waves, the one for middle ones.
    const VISIONS: [[[f64; 3]; 3]; 3] = [
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
        [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    ];
    /// To the tristimulus values, by those of white.
    const TO_XYZ: [[f64; 3]; 3] =
        [[0.4339, 0.3762, 0.1899], [0.2126, 0.7152, 0.0722], [0.0177, 0.1095, 0.8728]];

    fn times(matrix: &[[f64; 3]; 3], vector: [f64; 3]) -> [f64; 3] {
        matrix.map(|row| row.iter().zip(vector).map(|(a, b)| a * b).sum::<f64>().clamp(0.0, 1.0))
    }

    /// CIE L*a*b* of a colour as it is seen.
    fn lab(hex: &str, vision: &[[f64; 3]; 3]) -> [f64; 3] {
        let light = [1, 3, 5].map(|at| {
            let value = f64::from(u8::from_str_radix(&hex[at..at + 2], 16).expect("digits")) / 255.0;
            if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        });
        let root = |t: f64| if t > 0.008856 { t.cbrt() } else { 7.787 * t + 16.0 / 116.0 };
        let [x, y, z] = times(&TO_XYZ, times(vision, light)).map(root);
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    #[test]
    fn colours_of_one_picture_are_told_apart_with_any_vision() {
        use Color::*;
        let pictures: [&[Color]; 4] = [
            &[Exponential, Cayley, Order4, Order6, Order8, Order10, HamiltonJacobi, Rk4, Rkmk4],
            &[ExplicitEuler, ImplicitEuler, EulerA, EulerB, Ink],
            &[Rk2, Rk2Projected, Verlet, Ink],
            &[X, Y, Z],
        ];
        for colors in pictures {
            for (background, vision) in
                [0, 1].into_iter().flat_map(|page| VISIONS.iter().map(move |v| (page, v)))
            {
                let seen: Vec<[f64; 3]> =
                    colors.iter().chain([&Paper]).map(|color| lab(color.hex()[background], vision)).collect();
                for (i, one) in seen.iter().enumerate() {
                    for (k, other) in seen[..i].iter().enumerate() {
                        let distance =
                            one.iter().zip(other).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
                        assert!(distance > 14.0, "{:?} {:?}: {distance}", colors[k], colors.get(i));
                    }
                }
            }
        }
    }
}
