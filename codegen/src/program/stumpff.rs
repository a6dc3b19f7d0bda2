//! How Stumpff functions `c_k(z) = Σ_j (−z)^j / (k + 2j)!` are computed where nothing is lost, as data: of a family `c_0, …, c_{n−1}` the two
//! highest members from their series, the others downward by `c_k(z) = 1/k! − z c_{k+2}(z)`.
//!
//! How many terms of a series there are depends on `|z|`. Terms come in quartets, of which the first term is `1/k!`:
//!
//! ```text
//! quartet(k) = (1/k! − z/(k + 2)!) + z² (1/(k + 4)! − z/(k + 6)!)
//! ```
//!
//! Below [`brief`] a series is the quartet of `k`, below [`SHORT`] `quartet(k) + z⁴ quartet(k + 8)`, and below [`LONG`]
//! `quartet(k) + z⁴ (quartet(k + 8) + z⁴ quartet(k + 16))`. From there on the library computes `c_0`, `c_1` and `c_2` from sine and cosine of half
//! the angle, or from an exponential; `runtime/src/scalar/stumpff.rs` says how, and why so.

/// The most members of a family.
pub const MAX: usize = 12;
/// Below, two quartets are enough.
pub const SHORT: f64 = 0.125;
/// Below, three of them are.
pub const LONG: f64 = 3.0;
/// The terms of a series that matter where sine and cosine are used.
pub const TERMS: usize = 26;

/// `1/m!`
pub fn inverse_factorial(m: usize) -> f64 {
    1.0 / (1..=m as u128).product::<u128>() as f64
}

/// The two members of a family of so many that the others follow from; of a family of one, twice the one.
pub const fn highest(members: usize) -> [usize; 2] {
    [members.saturating_sub(2), members - 1]
}

/// Below this `|z|` one quartet has the very digits of two, in numbers of 64 bits and of fewer.
pub fn brief(members: usize) -> f64 {
    let [k, _] = highest(members);
    let fourth = f64::EPSILON / 8.0 * inverse_factorial(k) / inverse_factorial(k + 8);
    // from above, by Newton's iteration
    let mut root = 1.0_f64;
    for _ in 0..64 {
        root -= (root * root * root * root - fourth) / (4.0 * root * root * root);
    }
    root
}
