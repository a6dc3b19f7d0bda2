//! Searches with brackets: where a function changes its sign, and where it comes closest to zero.
//!
//! Both end after a bounded number of values, whatever the function does, and pass on the error of a value that there is not.

/// A function of the share of a step.
pub(crate) type Function<'a, E> = dyn FnMut(f64) -> Result<f64, E> + 'a;

/// A share of a step, and the function's value there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Point {
    pub(crate) at: f64,
    pub(crate) value: f64,
}

/// No search takes more values: bisection alone halves as often as there are digits, and others are not much worse.
const MOST: u32 = 200;

/// Closes in on a change of sign between two points with values of different signs, neither zero, until they are no farther apart than the
/// tolerance, or than numbers are. What comes back are the two ends: the first has the sign of the `near` end, the second that of the
/// `far` one, or is a zero.
///
/// T. R. Chandrupatla, Adv. Eng. Softw. 28 (1997) 145: inverse quadratic interpolation where it is sure to help, bisection else.
pub(crate) fn crossing<E>(
    function: &mut Function<'_, E>,
    near: Point,
    far: Point,
    tolerance: f64,
) -> Result<(Point, Point), E> {
    let is_near = |value: f64| (value > 0.0) == (near.value > 0.0);
    // the newest point, the one on the other side of the zero, and the one before
    let (mut a, mut b) = (far, near);
    let mut c;
    let mut share = 0.5;
    for _ in 0..MOST {
        let at = a.at + share * (b.at - a.at);
        if at == a.at || at == b.at {
            break;
        }
        let point = Point { at, value: function(at)? };
        if point.value.is_nan() {
            break;
        }
        // a zero is the far end, and what comes before it is sought on
        if (is_near(point.value) && point.value != 0.0) == (is_near(a.value) && a.value != 0.0) {
            c = a;
        } else {
            (c, b) = (b, a);
        }
        a = point;
        let width = (b.at - a.at).abs();
        if width <= tolerance {
            break;
        }
        let least = (0.5 * tolerance / width).min(0.5);
        let (xi, phi) = ((a.at - b.at) / (c.at - b.at), (a.value - b.value) / (c.value - b.value));
        share = if phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi {
            let first = a.value / (b.value - a.value) * (c.value / (b.value - c.value));
            let second = (c.at - a.at) / (b.at - a.at) * (a.value / (c.value - a.value));
            (first + second * (b.value / (c.value - b.value))).clamp(least, 1.0 - least)
        } else {
            0.5
        };
    }
    Ok(if is_near(a.value) && a.value != 0.0 { (a, b) } else { (b, a) })
}

/// Where a function that is positive at three points, and least in the middle, comes closest to zero; or a point where it is not positive, if it
/// meets one, which is then below the noise or as far below zero as it gets. Given up as soon as it is clear that it stays away from zero.
///
/// Parabolas through the three points, and golden sections where they do not help.
pub(crate) fn dip<E>(
    function: &mut Function<'_, E>,
    mut left: Point,
    mut middle: Point,
    mut right: Point,
) -> Result<Option<Point>, E> {
    const GOLDEN: f64 = 0.381_966_011_250_105_1;
    // with less of it left, it is the caller's to say whether that is rounding
    let rounding = 1e-12 * left.value.max(right.value);
    let mut before = f64::INFINITY;
    for step in 0..MOST {
        let (to_left, to_right) = (middle.at - left.at, right.at - middle.at);
        // digits of a place where the slope is zero are half as many
        if to_left.max(to_right) <= 1e-8 * (left.at.abs() + right.at.abs()).max(f64::MIN_POSITIVE) {
            return Ok(Some(middle));
        }
        let (rise, fall) = ((right.value - middle.value) / to_right, (left.value - middle.value) / to_left);
        let bend = (rise + fall) / (to_left + to_right);
        let slope = rise - bend * to_right;
        // of the parabola
        let by = -0.5 * slope / bend;
        let least = middle.value - 0.25 * slope * slope / bend;
        let is_parabola = bend > 0.0 && by > -to_left && by < to_right;
        // once the parabola is the function nearly, as the one before tells, half of what is left is well above what it leaves out; at first much
        // more has to be
        let is_away = match step {
            0 => least > 0.9 * middle.value && least > 0.5 * (left.value.max(right.value) - least),
            1 => false,
            _ => least > 0.5 * middle.value && (least - before).abs() < 0.01 * least,
        };
        before = least;
        if is_parabola && is_away && middle.value > rounding {
            return Ok(None);
        }
        let wider = to_right > to_left;
        let tiny = 1e-9 * (right.at - left.at).max(left.at.abs().max(right.at.abs()));
        let by = if is_parabola && step % 3 != 2 {
            // not where a point is, but on the side where there is more room
            if by.abs() < tiny { if wider { tiny } else { -tiny } } else { by }
        } else if wider {
            GOLDEN * to_right
        } else {
            -GOLDEN * to_left
        };
        let at = middle.at + by;
        if !(at > left.at && at < right.at) || at == middle.at {
            return Ok(Some(middle));
        }
        let point = Point { at, value: function(at)? };
        if point.value.is_nan() {
            return Ok(None);
        }
        if point.value <= 0.0 {
            return Ok(Some(point));
        }
        match (point.value < middle.value, point.at < middle.at) {
            (true, true) => (middle, right) = (point, middle),
            (true, false) => (left, middle) = (middle, point),
            (false, true) => left = point,
            (false, false) => right = point,
        }
    }
    Ok(Some(middle))
}

#[cfg(all(test, feature = "std"))]
mod tests {
    use super::*;
    use core::convert::Infallible;

    fn crossed(function: impl Fn(f64) -> f64, from: f64, to: f64, tolerance: f64) -> ((Point, Point), u32) {
        let mut values = 0;
        let mut counted = |at: f64| {
            values += 1;
            Ok::<f64, Infallible>(function(at))
        };
        let point = |at: f64| Point { at, value: function(at) };
        let ends =
            crossing(&mut counted, point(from), point(to), tolerance).unwrap_or_else(|never| match never {});
        (ends, values)
    }

    #[test]
    fn changes_of_sign_are_closed_in_on() {
        type Case = (fn(f64) -> f64, f64);
        let functions: [Case; 8] = [
            (|x| x - 0.3, 0.3),
            (|x| (x - 0.3).powi(3), 0.3),
            (|x| (x - 0.3).powi(9), 0.3),
            (|x| (20.0 * (x - 0.3)).tanh(), 0.3),
            (|x| (x - 0.3).cbrt(), 0.3),
            (|x| if x < 0.3 { -1e-300 } else { 1e300 }, 0.3),
            (|x| 1.0 / (x - 0.3), 0.3),
            (|x| x.powi(20) - 1e-12, 0.251_188_643_150_958),
        ];
        for (k, (function, zero)) in functions.into_iter().enumerate() {
            for sign in [1.0, -1.0] {
                let ((near, far), values) = crossed(|x| sign * function(x), 0.0, 1.0, 4e-16);
                assert!(near.at < far.at && far.at - near.at <= 4e-16, "{k}: {near:?} {far:?}");
                assert!((far.at - zero).abs() < 2e-15 || k < 3 && far.value == 0.0, "{k}: {far:?}");
                assert!(near.value * sign < 0.0 && far.value * sign >= 0.0, "{k}: {near:?} {far:?}");
                assert!(values < 150, "{k}: {values} values");
            }
        }
        // smooth ones are fast
        let (_, values) = crossed(|x| (2.0 * x).sin() - 0.4, 0.0, 0.7, 4e-16);
        assert!(values <= 10, "{values}");
        // and backwards
        let ((near, far), _) = crossed(|x| x - 0.3, 1.0, 0.0, 1e-15);
        assert!(near.at > far.at && near.value > 0.0 && far.value <= 0.0, "{near:?} {far:?}");
    }

    #[test]
    fn errors_and_what_is_no_number_end_a_search() {
        let ends = [Point { at: 0.0, value: -1.0 }, Point { at: 1.0, value: 1.0 }];
        let found = crossing(&mut |_| Err("no value"), ends[0], ends[1], 0.0);
        assert_eq!(found, Err("no value"));
        let found = crossing(&mut |_| Ok::<f64, ()>(f64::NAN), ends[0], ends[1], 0.0);
        assert_eq!(found, Ok((ends[0], ends[1])));
    }

    fn lowest(function: impl Fn(f64) -> f64) -> (Option<Point>, u32) {
        let mut values = 0;
        let mut counted = |at: f64| {
            values += 1;
            Ok::<f64, Infallible>(function(at))
        };
        let [left, middle, right] = [0.2, 0.4, 0.6].map(|at| Point { at, value: function(at) });
        let found = dip(&mut counted, left, middle, right).unwrap_or_else(|never| match never {});
        (found, values)
    }

    #[test]
    fn dips_are_found_and_others_given_up() {
        // a touch, exact and with rounding
        let (found, values) = lowest(|x| (x - 0.37).powi(2));
        let found = found.expect("a touch");
        assert!((found.at - 0.37).abs() < 1e-7 && found.value < 1e-14 && values < 20, "{found:?} {values}");
        let (found, values) = lowest(|x| 1.0 - (5.0 * (x - 0.37)).cos());
        let found = found.expect("a touch");
        assert!((found.at - 0.37).abs() < 1e-7 && found.value < 1e-14 && values < 30, "{found:?} {values}");
        // wherever it is among the points, and not the same to both sides
        for k in 0..400 {
            let zero = 0.31 + 0.18 * f64::from(k) / 400.0;
            let (found, values) = lowest(|x| ((2.0 * x + 0.4).cos() - (2.0 * zero + 0.4).cos()).powi(2));
            let found = found.expect("a touch");
            let is_zero = (2.0 * found.at + 0.4).cos() - (2.0 * zero + 0.4).cos();
            assert!(is_zero.abs() < 1e-6 && values < 60, "{zero}: {found:?} {values}");
        }
        // a pair of zeros, however close
        for depth in [1e-3, 1e-6, 1e-10] {
            let (found, values) = lowest(|x| (3.0 * (x - 0.41)).cosh() - 1.0 - depth);
            assert!(found.expect("zeros").value <= 0.0 && values < 20, "{depth} {values}");
        }
        // what stays away from zero takes few values
        for height in [1.0, 0.1, 1e-2, 1e-4] {
            let (found, values) = lowest(|x| (3.0 * (x - 0.41)).cosh() - 1.0 + height);
            assert!(found.is_none() && values <= 5, "{height}: {found:?} {values}");
        }
        let _ = lowest(|x| if x == 0.4 { 1.0 } else { 2.0 });
        let _ = lowest(|x| if x < 0.41 { f64::INFINITY } else { 2.0 });
    }
}
