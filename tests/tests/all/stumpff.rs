//! The Stumpff functions against their defining series, summed with 71 digits.

use std::f64::consts::PI;
use std::sync::LazyLock;

use coadjoint::__private::family;
use coadjoint::nalgebra::RealField;
use coadjoint_codegen::expr::Function;
use coadjoint_support::evaluate::Value;
use coadjoint_support::precise::real::Real;
use num_dual::Dual2_64;

/// The members of the largest family.
const MEMBERS: usize = 12;

/// `1/m!`
static INVERSE_FACTORIALS: LazyLock<Vec<Real>> = LazyLock::new(|| {
    let next = |inverse: &mut Real, m: i64| {
        *inverse = &*inverse / Real::from(m);
        Some(inverse.clone())
    };
    std::iter::once(Real::from(1)).chain((1..2500).scan(Real::from(1), next)).collect()
});

/// The definition. What cancels in the series of a positive `z` are terms as large as `e^√z`: up to 1000 that leaves 40 digits and more. Beyond, the
/// first two members are sums in closed form, cosine and sine, and the next ones follow from these: `c_{k+2} = (1/k! − c_k) / z`.
fn exact(z: &Real) -> [Real; MEMBERS + 1] {
    if Real::from(1000) < *z {
        let angle = z.sqrt();
        let mut all = std::array::from_fn(|_| angle.apply(Function::Cos));
        all[1] = angle.apply(Function::Sin) / &angle;
        for k in 2..=MEMBERS {
            all[k] = (&INVERSE_FACTORIALS[k - 2] - &all[k - 2]) / z;
        }
        return all;
    }
    let mut sums = std::array::from_fn(|_| Real::from(0));
    let mut power = Real::from(1);
    for j in 0.. {
        let mut negligible = true;
        for (k, sum) in sums.iter_mut().enumerate() {
            let term = &power * &INVERSE_FACTORIALS[k + 2 * j];
            negligible &= term.is_negligible();
            *sum = &*sum + term;
        }
        if negligible {
            break;
        }
        power = -(power * z);
    }
    sums
}

trait Float: RealField + Copy + Into<f64> {
    const NAME: &'static str;
    const EPSILON: f64;
    fn nearest(x: f64) -> Self;
    fn next(self) -> Self;
}

impl Float for f64 {
    const NAME: &'static str = "f64";
    const EPSILON: f64 = f64::EPSILON;
    fn nearest(x: f64) -> Self {
        x
    }
    fn next(self) -> Self {
        self.next_up()
    }
}

impl Float for f32 {
    const NAME: &'static str = "f32";
    const EPSILON: f64 = f32::EPSILON as f64;
    fn nearest(x: f64) -> Self {
        x as f32
    }
    fn next(self) -> Self {
        self.next_up()
    }
}

/// The families of 1 to [`MEMBERS`] members.
fn families<T: Float>(z: T) -> [Vec<T>; MEMBERS] {
    macro_rules! sizes {
        ($($n:literal),*) => { [$(family::<T, $n>(z).to_vec()),*] };
    }
    sizes!(1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12)
}

/// The largest error of each member in any family, in units of ε relative to the member (c_0 from z = 1 on:
/// relative to 1), with the z where it occurs.
fn largest_errors<T: Float>(points: impl IntoIterator<Item = T>) -> [(f64, f64); MEMBERS] {
    let mut largest = [(0.0, 0.0); MEMBERS];
    for z in points {
        let at: f64 = z.into();
        let exact = exact(&Real::from(at));
        let sizes = exact.each_ref().map(|member| member.to_f64().abs());
        for members in families(z) {
            for (k, &value) in members.iter().enumerate() {
                let error = (Real::from(value.into()) - &exact[k]).to_f64().abs();
                let scale = if k == 0 && at >= 1.0 { 1.0 } else { sizes[k] };
                let error = error / (T::EPSILON * scale);
                // negated, so that NaN counts as an error
                if !matches!(error.partial_cmp(&largest[k].0), Some(std::cmp::Ordering::Less)) {
                    largest[k] = (error, at);
                }
            }
        }
    }
    largest
}

/// Prints the largest errors (`cargo test -- --nocapture`) and compares them with the bound of the range.
fn require<T: Float>(range: &str, bound: f64, points: impl IntoIterator<Item = f64>) {
    let errors = largest_errors::<T>(points.into_iter().map(T::nearest));
    println!("{} {range}", T::NAME);
    for (k, (error, z)) in errors.iter().enumerate() {
        println!("    c_{k:<2} {error:5.2} ε at z = {z:e}");
    }
    for (k, (error, z)) in errors.iter().enumerate() {
        assert!(*error <= bound, "{} {range}: c_{k}({z:e}) is wrong by {error} ε", T::NAME);
    }
}

/// `count` points between `from` and `to`, off round numbers.
fn spread(from: f64, to: f64, count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| from + (to - from) * (i as f64 + 0.37) / count as f64)
}

fn both_signs(z: f64) -> [f64; 2] {
    [z, -z]
}

fn near_zero<T: Float>(count: usize) {
    require::<T>("|z| < 1e-300", 1.0, [0.0, -0.0, f64::MIN_POSITIVE, -5e-324, 1e-310]);
    require::<T>("tiny", 1.7, spread(-30.0, -3.0, count).map(|e| 10f64.powf(e)).flat_map(both_signs));
    require::<T>("1e-3 < |z| < 1/8", 1.7, spread(1e-3, 0.125, 2 * count).flat_map(both_signs));
    require::<T>("1/8 < |z| < 3", 1.9, spread(0.125, 3.0, 4 * count).flat_map(both_signs));
}

#[test]
fn near_zero_f64() {
    near_zero::<f64>(200);
}

#[test]
fn near_zero_f32() {
    near_zero::<f32>(150);
}

/// Where one polynomial gives way to another, and the longer one to sine and cosine.
#[test]
fn at_the_switches() {
    fn neighbours<T: Float>(switch: f64) -> impl Iterator<Item = f64> {
        let mut z = T::nearest(switch * (1.0 - 100.0 * T::EPSILON));
        (0..200).map(move |_| {
            z = z.next();
            z.into()
        })
    }
    for switch in [0.125, 3.0] {
        for sign in [1.0, -1.0] {
            let name = format!("around {}", sign * switch);
            require::<f64>(&name, 2.4, neighbours::<f64>(switch).map(|z| sign * z));
            require::<f32>(&name, 2.4, neighbours::<f32>(switch).map(|z| sign * z));
        }
    }
}

fn oscillating<T: Float>(count: usize) {
    let square = |angle: f64| angle * angle;
    require::<T>("3 < z < 100", 2.4, spread(3f64.sqrt(), 10.0, 3 * count).map(square));
    require::<T>("100 < z < 900", 2.4, spread(10.0, 30.0, count).map(square));
    require::<T>("900 < z < 1e6", 2.4, spread(30.0, 1000.0, count / 50).map(square));
    // c_0 vanishes at odd multiples of π/2, c_1 at multiples of π, c_2 doubly at multiples of 2π
    require::<T>("zeros", 2.4, (1..30).map(|n| square(f64::from(n) * PI / 2.0)));
}

#[test]
fn oscillating_f64() {
    oscillating::<f64>(200);
}

#[test]
fn oscillating_f32() {
    oscillating::<f32>(150);
}

fn hyperbolic<T: Float>(count: usize) {
    let square = |angle: f64| -angle * angle;
    require::<T>("-100 < z < -3", 4.2, spread(3f64.sqrt(), 10.0, 3 * count).map(square));
    require::<T>("-900 < z < -100", 4.2, spread(10.0, 30.0, count).map(square));
    require::<T>("-7000 < z < -900", 4.2, spread(30.0, 80.0, count / 20).map(square));
}

#[test]
fn hyperbolic_f64() {
    hyperbolic::<f64>(200);
    require::<f64>("-4e5 < z < -7000", 4.2, spread(80.0, 630.0, 20).map(|angle| -angle * angle));
}

#[test]
fn hyperbolic_f32() {
    hyperbolic::<f32>(150);
}

#[test]
fn values_at_zero_are_the_nearest_to_inverse_factorials() {
    let mut factorial = 1.0;
    for (k, value) in family::<f64, MEMBERS>(0.0).into_iter().enumerate() {
        factorial *= k.max(1) as f64;
        assert_eq!(value, 1.0 / factorial, "c_{k}(0)");
    }
}

/// `c_k′ = (k c_{k+2} − c_{k+1}) / 2`, on which generated code relies, against difference quotients of the
/// definition.
#[test]
fn derivatives_are_members() {
    for z in [-60.0, -7.0, -1.5, -0.06, 1e-9, 0.04, 0.9, 2.9, 11.0, 150.0] {
        let [center, offset] = [z, 2f64.powi(-70)].map(Real::from);
        let (after, before) = (exact(&(&center + &offset)), exact(&(&center - &offset)));
        let c = family::<f64, MEMBERS>(z);
        for k in 0..MEMBERS - 2 {
            let quotient = (&after[k] - &before[k]).to_f64() * 2f64.powi(69);
            let derivative = (k as f64 * c[k + 2] - c[k + 1]) / 2.0;
            let scale = (k as f64 * c[k + 2]).abs() + c[k + 1].abs();
            assert!((derivative - quotient).abs() <= 3.0 * f64::EPSILON * scale, "c_{k}′({z})");
        }
    }
}

/// Also where the number alone needs fewer powers than its derivatives.
#[test]
fn dual_numbers_find_derivatives() {
    for z in spread(-30.0, 0.4, 300).map(|e| 10f64.powf(e)).flat_map(both_signs) {
        let c = family::<f64, { MEMBERS }>(z);
        let duals = family::<_, { MEMBERS - 4 }>(Dual2_64::from_re(z).derivative());
        for (k, dual) in duals.iter().enumerate() {
            let order = k as f64;
            let first = (order * c[k + 2] - c[k + 1]) / 2.0;
            let second = (order * (order + 2.0) * c[k + 4] - (2.0 * order + 1.0) * c[k + 3] + c[k + 2]) / 4.0;
            let bound = |scale: f64| 2.0 * f64::EPSILON * scale;
            assert!((dual.v1 - first).abs() <= bound(c[k + 1]), "c_{k}′({z:e}) = {}, not {first}", dual.v1);
            assert!((dual.v2 - second).abs() <= bound(c[k + 2]), "c_{k}″({z:e}) = {}, not {second}", dual.v2);
        }
    }
}

#[test]
fn extreme_arguments_keep_their_bounds() {
    fn check<T: Float>(largest: T, overflowing: T) {
        let members = |z: T| family::<T, MEMBERS>(z).map(|c| -> f64 { c.into() });
        for z in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(members(T::nearest(z)).iter().all(|c| c.is_nan()), "{z}");
        }
        // far beyond the angles whose sine means anything
        let above = 1.0 + 4.0 * T::EPSILON;
        let huge = (4..).map(|e| T::nearest(10f64.powi(e))).take_while(|z| *z < largest).chain([largest]);
        for z in huge {
            let c = members(z);
            let angle = z.into().sqrt();
            assert!(c[0].abs() <= above && (angle * c[1]).abs() <= above, "{z}");
            assert!((0.0..=2.0 * above).contains(&(angle * angle * c[2])), "{z}");
            assert!(c[3..].iter().all(|c| (0.0..2.0 / z.into()).contains(c)), "{z}");
        }
        assert_eq!(members(overflowing), [f64::INFINITY; MEMBERS]);
        assert!(members(-largest).iter().all(|c| !c.is_finite()));
    }
    check(f64::MAX, -6e5);
    check(f32::MAX, -1e4);
}

/// `θ / sin θ` and its derivatives by the cosine, in doubles and singles, against the same with 71 digits.
#[test]
fn angles_over_sines_are_what_they_are() {
    fn check<T: Float, const N: u32>() {
        let mut worst = 0.0_f64;
        for k in -180..=200 {
            // as near to 1 as a number can be, too
            let c = if k > 100 { 1.0 - 0.7_f64.powi(k) } else { f64::from(k) / 200.0 };
            let c = T::nearest(c);
            let exact = Real::from(c.into()).apply(Function::AngleOverSine(N));
            let found: f64 = coadjoint::__private::Scalar::angle_over_sine::<N>(c).into();
            worst = worst.max(((Real::from(found) - &exact) / &exact).to_f64().abs() / T::EPSILON);
        }
        println!("{}, derivative {N}: {worst:.1} ε", T::NAME);
        // where the equation is used, each derivative costs a digit or so
        assert!(worst < [4.0, 20.0, 100.0, 600.0][N as usize], "{}, derivative {N}: {worst:.1} ε", T::NAME);
    }
    check::<f64, 0>();
    check::<f64, 1>();
    check::<f64, 2>();
    check::<f64, 3>();
    check::<f32, 0>();
    check::<f32, 1>();
    check::<f32, 2>();
}
