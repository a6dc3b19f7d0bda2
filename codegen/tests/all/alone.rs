//! Files of the generator that stand by themselves, and the tests of what they keep to themselves.
#![allow(dead_code, unreachable_pub)]

#[path = "../../src/diagnostics.rs"]
mod diagnostics;
#[path = "../../src/group/exact.rs"]
mod exact;
#[path = "../../src/parse/shape.rs"]
mod shape;

mod diagnostics_tests {
    use super::diagnostics::*;

    #[test]
    fn slips_are_recognised() {
        let known = ["gamma", "weight", "chi", "inertia"];
        assert_eq!(nearest("gama", &known), Some("gamma"));
        assert_eq!(nearest("wieght", &known), Some("weight"));
        assert_eq!(nearest("Chi", &known), Some("chi"));
        assert_eq!(nearest("advect", &["advected", "potential"]), Some("advected"));
        assert_eq!(nearest("x", &known), None);
        assert_eq!(nearest("mass", &known), None);
        assert_eq!(nearest("", &known), None);
    }

    #[test]
    fn edits_are_counted() {
        for (from, to, count) in [
            ("", "abc", 3),
            ("abc", "", 3),
            ("abc", "abc", 0),
            ("abc", "abd", 1),
            ("abc", "ac", 1),
            ("ac", "abc", 1),
            // neighbours swapped, and letters that only look so
            ("ab", "ba", 1),
            ("xaby", "xbay", 1),
            ("ab", "ca", 2),
            ("ab", "bc", 2),
            ("abc", "cba", 2),
        ] {
            assert_eq!(edits(from, to), count, "{from} {to}");
        }
    }

    #[test]
    fn a_single_letter_is_not_a_slip_of_another() {
        assert_eq!(nearest("a", &["b", "x"]), None);
    }

    #[test]
    fn what_is_short_or_has_another_number_is_no_slip() {
        let groups = ["R1", "R2", "SO2", "SO3", "SE3"];
        for written in ["SO4", "S2", "R20", "SO33", "SL3", "SO"] {
            assert_eq!(nearest(written, &groups), None, "{written}");
        }
        assert_eq!(nearest("so3", &groups), Some("SO3"));
        assert_eq!(nearest("Vector4", &["Vector3"]), None);
    }

    #[test]
    fn lists_read_as_sentences() {
        assert_eq!(list(["a"]), "`a`");
        assert_eq!(list(["a", "b", "c"]), "`a`, `b` and `c`");
    }

    #[test]
    fn all_problems_are_kept() {
        let mut diagnostics = Diagnostics::new();
        diagnostics.push(quote::quote!(a), "one");
        diagnostics.push(quote::quote!(b), "two");
        let error = diagnostics.finish().expect_err("two problems were pushed");
        let messages: Vec<String> = error.into_iter().map(|error| error.to_string()).collect();
        assert_eq!(messages, ["one", "two"]);
    }
}

mod exact_tests {
    use super::exact::*;

    fn matrix<const N: usize>(rows: [[i128; N]; N]) -> RationalMatrix {
        RationalMatrix::from_fn(N, N, |i, j| Rational::from(rows[i][j]))
    }

    #[test]
    fn linear_algebra_is_exact() {
        let m = matrix([[2, 1, 0], [1, 3, 1], [0, 1, 7]]);
        let inverse = m.inverse().expect("regular");
        assert_eq!(m.times(&inverse), matrix([[1, 0, 0], [0, 1, 0], [0, 0, 1]]));
        let singular = matrix([[1, 2, 3], [2, 4, 6], [1, 0, 1]]);
        assert_eq!(singular.inverse(), None);
        assert_eq!(RationalMatrix::zero(3, 2).inverse(), None);
        assert_eq!(RationalMatrix::zero(2, 3).inverse(), None);
        assert_eq!(singular.clone().reduce(), [0, 1]);
        let kernel = singular.kernel();
        assert_eq!(kernel.len(), 1);
        let column = RationalMatrix::from_fn(3, 1, |i, _| kernel[0][i]);
        assert!(singular.times(&column).is_zero() && !column.is_zero());
    }

    #[test]
    fn what_grows_too_large_is_unknown() {
        let large = Rational::from(i128::MAX / 1024);
        assert!(!(large * large).is_exact() && !(large * large).is_zero() && !(large * large).is_negative());
        assert!(!(large + Rational::one() / Rational::zero()).is_exact());
        assert_eq!(Rational::new(1, 3) + Rational::new(1, 6), Rational::new(1, 2));
    }

    #[test]
    fn definiteness_is_told() {
        assert!(matrix([[1, 1], [1, 1]]).is_positive_semidefinite());
        assert!(matrix([[0, 0], [0, 3]]).is_positive_semidefinite());
        assert!(!matrix([[0, 1], [1, 3]]).is_positive_semidefinite());
        assert!(!matrix([[1, 2], [2, 1]]).is_positive_semidefinite());
    }
}

mod shape_tests {
    use super::shape::*;
    use crate::quantity::{ScalarType, Shape};
    use syn::Type;
    use syn::parse_quote;

    #[test]
    fn types_are_told_by_their_last_segment() {
        let shape = |ty: Type| of_type(&ty).map(|(shape, _)| shape);
        assert_eq!(shape(parse_quote!(f64)), Some(Shape::Scalar));
        assert_eq!(shape(parse_quote!(Vector3<f64>)), Some(Shape::Vector(3)));
        assert_eq!(shape(parse_quote!(nalgebra::Matrix3<f64>)), Some(Shape::Matrix(3, 3)));
        assert_eq!(shape(parse_quote!(::coadjoint::nalgebra::SVector<f64, 4>)), Some(Shape::Vector(4)));
        assert_eq!(shape(parse_quote!(SMatrix<f64, 2, 3>)), Some(Shape::Matrix(2, 3)));
        assert_eq!(shape(parse_quote!(Matrix2x3<f64>)), Some(Shape::Matrix(2, 3)));
        assert_eq!(of_type(&parse_quote!(Vector3<f32>)), Some((Shape::Vector(3), ScalarType::F32)));
    }

    #[test]
    fn other_types_are_not_known() {
        for ty in [
            "String",
            "Vector3",
            "Vector7<f64>",
            "Vector3<u8>",
            "Vec<f64>",
            "SVector<f64, 0>",
            "SVector<f64, N>",
            "SMatrix<f64, 3>",
            "Vector3<f64, 3>",
            "f64<f64>",
            "&'static f64",
            "[f64; 3]",
            "<T as Trait>::f64",
        ] {
            let parsed: Type = syn::parse_str(ty).expect("a type");
            assert_eq!(of_type(&parsed), None, "{ty}");
        }
    }
}
