//! Section 2: closed forms of the integrands, exact sums, and rectangles of any bits. Means, variances, laws
//! and costs of the estimators are those of tests/estimators.rs, points those of tests/placement.rs.

mod common;

use std::f64::consts::PI;

use approx::assert_relative_eq;
use common::{Stuck, any_bits, config};
use proptest::prelude::*;
use rand::distr::Distribution;
use unbiased::rectangle::{Integrand, Rectangle};
use unbiased::{Density, Estimator, Stream, f_over_p};

const SHEET: Rectangle = Rectangle::WORKSHEET;

fn rectangle(x: [f64; 2], y: [f64; 2]) -> Rectangle {
    Rectangle::new(x, y).unwrap()
}

/// 1.7 × 4.1, away from the origin: neither its area nor its perimeter nor its centre hides a mistake.
fn offset() -> Rectangle {
    rectangle([0.3, 2.0], [-1.1, 3.0])
}

#[test]
fn the_density_is_one_over_the_area_inside_and_nothing_outside() {
    let r = offset();
    assert_eq!((r.x_range(), r.y_range()), ([0.3, 2.0], [-1.1, 3.0]));
    assert_eq!(rectangle([-2.0, 2.0], [-2.0, 2.0]), SHEET);
    for inside in [[0.3, -1.1], [2.0, 3.0], [0.3, 3.0], [1.0, 0.0]] {
        assert_relative_eq!(r.pdf(&inside), 1.0 / 6.97, epsilon = 0.0, max_relative = 4e-16);
    }
    for outside in [
        [0.3f64.next_down(), 0.0],
        [2f64.next_up(), 0.0],
        [1.0, -1.2],
        [1.0, 3.1],
        [f64::NAN, 0.0],
        [1.0, f64::INFINITY],
    ] {
        assert_eq!(r.pdf(&outside).to_bits(), 0, "{outside:?}");
    }
}

#[test]
fn integrands_are_what_they_say() {
    let texts: std::collections::BTreeSet<_> =
        Integrand::ALL.iter().flat_map(|f| [f.name(), f.formula()]).filter(|text| !text.is_empty()).collect();
    assert_eq!(texts.len(), 12);
    let at = |x, y| Integrand::ALL.map(|f| f.at(x, y));
    assert_eq!(at(3.0, -4.0), [1.0, 25.0, 0.0, (-25f64).exp(), -12.0, 0.2]);
    assert_eq!(at(0.0, 2.0), [1.0, 4.0, 1.0, (-4f64).exp(), 0.0, 0.5]);
    // the pole, and where 1/r overflows: 0, so that no draw is infinite
    let inverse = |x, y| Integrand::InverseDistance.at(x, y);
    for [x, y] in [[0.0, 0.0], [-0.0, 0.0], [0.0, 5e-324], [-5e-309, 1e-310]] {
        assert_eq!(inverse(x, y).to_bits(), 0);
    }
    assert!(inverse(0.0, 1e-308).is_finite() && inverse(0.0, 1e-308) > 9e307);
    assert_relative_eq!(inverse(3e-200, 4e-200), 2e199, epsilon = 0.0, max_relative = 4e-16);
    assert_eq!(format!("{}", Integrand::Paraboloid), "x² + y²");
}

// ---- closed forms

/// By mpmath's nested quadrature at 30 digits: what quadrature in f64 cannot do, the disc and 1/r, on the
/// sheet's square, a rectangle that holds the disc, and others.
#[test]
fn closed_forms_agree_with_quadrature_by_another_program() {
    let about = rectangle([-0.6, 1.1], [-1.3, 2.8]);
    let holds = rectangle([-2.5, 2.6], [-3.0, 2.2]);
    // the ends 0.3, −1.1 … and their differences are rounded: a few ulp more
    let close = |got: Option<f64>, truth: f64| got.is_some_and(|got| (got - truth).abs() <= 2e-14 * truth);
    for (r, area, perimeter) in [(SHEET, 16.0, 8.0), (holds, 26.52, 5.1 + 5.2)] {
        let variance = 4.0 * PI * (area - 4.0 * PI);
        let effects = perimeter * 128.0 / 3.0 - 32.0 * PI * PI;
        assert!(
            close(Integrand::Disc.integral(&r), 4.0 * PI) && close(Integrand::Disc.variance(&r), variance)
        );
        for n in [1.0, 2.0, 32.0, 2f64.powi(40)] {
            let exact = (variance + (n - 1.0) * effects) / (n * n);
            assert!(close(Integrand::Disc.all_pairs_variance(&r, n as u64), exact), "{n}² pairs on {r:?}");
        }
    }
    // all of it in the disc, or none: a constant
    for r in [rectangle([0.0, 1.0], [-1.0, 1.0]), rectangle([3.0, 4.0], [-1.0, 1.0])] {
        assert_eq!(Integrand::Disc.all_pairs_variance(&r, 3), Some(0.0));
    }
    let inverse = Integrand::InverseDistance;
    for (r, integral) in [
        (SHEET, 14.101977392312689),
        (offset(), 4.71255559178865),
        (about, 8.43980044029643),
        (holds, 18.066791854020398),
    ] {
        assert_relative_eq!(inverse.integral(&r).unwrap(), integral, epsilon = 0.0, max_relative = 2e-15);
        let infinite = (r != offset()).then_some(f64::INFINITY);
        assert_eq!((inverse.variance(&r), inverse.all_pairs_variance(&r, 32)), (infinite, infinite));
    }
}

/// The same at the ends of f64's range, where a product in the wrong order would over- or underflow (mpmath,
/// 60 digits).
#[test]
fn closed_forms_hold_at_the_ends_of_the_range() {
    let tiny = 1e-300;
    #[rustfmt::skip]
    let rows = [
        (Integrand::InverseDistance, [0.0, tiny], [0.0, 1e300], Some(1.3832442029769874e-297),
            Some(f64::INFINITY)),
        (Integrand::InverseDistance, [-tiny, tiny], [-1e300, 1e300], Some(5.5329768119079495e-297),
            Some(f64::INFINITY)),
        (Integrand::InverseDistance, [-1e150, 3e150], [-1e-150, 2e-150], Some(4.1553352986164063e-147),
            Some(f64::INFINITY)),
        (Integrand::InverseDistance, [0.0, 1e9], [0.0, 1.0], Some(22.416413017506358), Some(f64::INFINITY)),
        (Integrand::InverseDistance, [3.0, 4.0], [0.0, 1.0], Some(0.28378148350631294), None),
        (Integrand::InverseDistance, [1e-9, 1.0], [1e-9, 1.0], Some(1.7627471309690073), None),
        (Integrand::InverseDistance, [1e9, 1e9 + 1.0], [0.0, 1.0], None, None),
        (Integrand::Paraboloid, [1e100, 3e100], [1e-250, 2e-250], Some(8.666666666666665e50),
            Some(2.1688888888888882e101)),
        (Integrand::Paraboloid, [1e154, 1.5e154], [-1e-154, 0.0], Some(7.916666666666669e307),
            Some(f64::INFINITY)),
        (Integrand::Product, [1e100, 3e100], [1e-250, 2e-250], Some(6e-300), Some(0.0)),
        (Integrand::Product, [1e154, 1.5e154], [-1e-154, 0.0], Some(-0.31250000000000006), None),
        (Integrand::Gaussian, [0.0, 1e300], [0.0, tiny], Some(8.86226925452758e-301),
            Some(6.266570686577502e-301)),
        (Integrand::Gaussian, [3.0, 4.0], [-1.0, 1.0], Some(2.9221032725264563e-05),
            Some(2.1045597902100118e-09)),
        (Integrand::Gaussian, [-2.0, -1.0], [0.25, 0.5], Some(0.029268739946639154),
            Some(0.0004805184620827945)),
        (Integrand::Gaussian, [0.0, 0.5], [0.0, 0.5], Some(0.21278016687719867), Some(0.0004804193337620764)),
        (Integrand::Gaussian, [-1e300, 1e300], [-1.0, 1.0], Some(2.6474226203051177),
            Some(5.997298717593193e300)),
        (Integrand::Gaussian, [10.0, 11.0], [0.5, 2.0], Some(7.788484606752762e-46),
            Some(9.685010464096884e-90)),
        (Integrand::Gaussian, [2.0, 2.0 + 1e-9], [0.0, 1.0], Some(1.3678562234396564e-11), None),
        (Integrand::Gaussian, [20.0, 26.0], [-1.0, 0.5], Some(5.777112132202588e-176), Some(0.0)),
        (Integrand::Gaussian, [25.0, 25.0 + 1.0 / (1u64 << 40) as f64], [0.0, 1.0],
            Some(2.500157262791068e-284), Some(0.0)),
        (Integrand::Gaussian, [20.3, 26.1], [-1.0, 0.5], Some(3.1962467416788425e-181), Some(0.0)),
        (Integrand::Gaussian, [-26.7, -25.9], [0.0, 1.0], Some(6.7528028411152416e-294), Some(0.0)),
        (Integrand::Gaussian, [26.5, 1e10], [0.0, 1.0], Some(1.4633017404444406e-307), Some(0.0)),
        (Integrand::Gaussian, [100.0, 200.0], [0.0, 1.0], Some(0.0), Some(0.0)),
        (Integrand::Disc, [-tiny, tiny], [-1.0, 1.0], Some(4e-300), Some(0.0)),
        (Integrand::Disc, [1.5, 1e300], [1.5, 2.0], Some(0.0), Some(0.0)),
        (Integrand::Disc, [-2.0, 1e300], [-2.0, 2.0], Some(4.0 * PI), Some(16.0 * PI * 1e300)),
        (Integrand::Disc, [1.8, 3.0], [0.0, 1.0], None, None),
        (Integrand::Disc, [2.1, 3.0], [-1.0, 1.0], Some(0.0), Some(0.0)),
        (Integrand::Disc, [-2.0, 1.9], [-2.0, 2.0], None, None),
    ];
    for (f, x, y, integral, variance) in rows {
        let r = rectangle(x, y);
        let close = |got: Option<f64>, truth: Option<f64>, off: f64| match (got, truth) {
            (Some(got), Some(truth)) => got == truth || (got - truth).abs() <= off * truth.abs(),
            (got, truth) => got == truth,
        };
        assert!(
            close(f.integral(&r), integral, 2e-15),
            "{f} on {x:?} × {y:?}: {:?}, not {integral:?}",
            f.integral(&r)
        );
        // where no variance is stated, nothing but its sign is asked
        let got = f.variance(&r);
        assert!(
            if variance.is_some() { close(got, variance, 1e-12) } else { got.is_none_or(|got| got >= 0.0) },
            "{f} on {x:?} × {y:?}: variance {got:?}, not {variance:?}"
        );
    }
}

/// Sums keep every digit: 65536 terms of 0.1 are 6553.6, not 6553.600000000…; terms and weights at the ends
/// of the range neither over- nor underflow on the way.
#[test]
fn sums_are_exact_at_every_scale() {
    let one_draw = |estimator: &dyn Estimator| estimator.draw(&mut Stream::new(1, 0));
    let close = |got: f64, truth: f64| (got - truth).abs() <= 2.0 * f64::EPSILON * truth.abs();
    for (r, value) in [
        (rectangle([0.0, 1.0], [0.0, 1.0]), 0.1),
        (offset(), 0.1),
        (rectangle([0.0, 1e-300], [0.0, 1e300]), 1e300),
        (rectangle([0.0, 1.0], [0.0, 1.0]), f64::MAX),
        (rectangle([0.0, 1e-300], [0.0, 1.0]), f64::MAX),
        (rectangle([0.0, 1e300], [0.0, 1.0]), 1e-300),
        (rectangle([0.0, 1e300], [0.0, 1e7]), 1.0),
        (rectangle([0.0, 1e-300], [0.0, 1e-7]), 1.0),
        (rectangle([0.0, 1e-300], [0.0, 1e-7]), 1e300),
        (rectangle([0.0, 1.0], [0.0, 1.0]), -1e-290),
    ] {
        let truth = r.area() * value;
        let f = move |_: f64, _: f64| value;
        assert!(close(one_draw(&r.independent(f)), truth));
        assert!(close(one_draw(&f_over_p(move |_: &[f64; 2]| value, r)), truth));
        assert!(close(one_draw(&r.sobol(f, 65536).unwrap()), truth), "{value:e} on {r:?}");
        assert!(close(one_draw(&r.sobol(f, 1000).unwrap()), truth), "{value:e} on {r:?}");
        assert!(close(one_draw(&r.jittered(f, 101).unwrap()), truth), "{value:e} on {r:?}");
        assert!(close(one_draw(&r.all_pairs(f, 101).unwrap()), truth), "{value:e} on {r:?}");
    }
    // 2⁵³ + 1 + … + 1 − 2⁵³: a plain sum loses every 1
    let count = std::sync::atomic::AtomicU64::new(0);
    let f = |_: f64, _: f64| match count.fetch_add(1, std::sync::atomic::Ordering::Relaxed) {
        0 => 9007199254740992.0,
        1023 => -9007199254740992.0,
        _ => 1.0,
    };
    assert_eq!(one_draw(&SHEET.sobol(&f, 1024).unwrap()), 16.0 * 1022.0 / 1024.0);
}

// ---- properties

fn sorted() -> impl Strategy<Value = [f64; 2]> {
    let wild = || common::any_number();
    (wild(), wild()).prop_map(|(a, b)| if a > b { [b, a] } else { [a, b] })
}

proptest! {
    #![proptest_config(config(4000))]

    /// Any bits: an error or a rectangle that keeps its word.
    #[test]
    fn any_bits_make_an_error_or_a_sound_rectangle(x in sorted(), y in sorted(), n in any::<u64>(),
        px in any_bits(), py in any_bits()) {
        for f in Integrand::ALL {
            // a finite point has a value that is a number
            prop_assert!(!(px.is_finite() && py.is_finite() && f.at(px, py).is_nan()));
        }
        let Ok(r) = Rectangle::new(x, y) else { return Ok(()) };
        prop_assert!(r.area().is_normal() && r.area() > 0.0 && (1.0 / r.area()).is_normal());
        let mut rng = Stream::new(n, 0);
        for point in [r.sample(&mut Stuck(u64::MAX)), r.sample(&mut rng), [x[0], y[0]], [x[1], y[1]]] {
            prop_assert!(x[0] <= point[0] && point[0] <= x[1] && y[0] <= point[1] && point[1] <= y[1]);
            prop_assert_eq!(r.pdf(&point), 1.0 / r.area());
        }
        prop_assert!(!r.pdf(&[px, py]).is_nan());
        for f in Integrand::ALL {
            prop_assert!(f.integral(&r).is_none_or(|integral| !integral.is_nan()));
            prop_assert!(f.variance(&r).is_none_or(|variance| variance >= 0.0), "{} {:?}", f, f.variance(&r));
            prop_assert!(f.all_pairs_variance(&r, n).is_none_or(|variance| variance >= 0.0));
            prop_assert_eq!(f.all_pairs_variance(&r, 0), None);
        }
    }
}

/// ∫ₐᵇ g by 20-point Gauss–Legendre in 12 panels, broken at 0.
fn quadrature([a, b]: [f64; 2], g: impl Fn(f64) -> f64) -> f64 {
    let broken = if a < 0.0 && 0.0 < b { vec![a, 0.0, b] } else { vec![a, b] };
    static RULE: std::sync::OnceLock<Vec<(f64, f64)>> = std::sync::OnceLock::new();
    let rule = RULE.get_or_init(|| common::gauss(20));
    let mut sum = 0.0;
    for ends in broken.windows(2) {
        let panel = (ends[1] - ends[0]) / 12.0;
        for i in 0..12 {
            let left = ends[0] + panel * f64::from(i);
            for (node, weight) in rule {
                sum += weight * panel * g(left + panel * node);
            }
        }
    }
    sum
}

/// ∫∫ g, one quadrature within the other.
fn double([x, y]: [[f64; 2]; 2], g: impl Fn(f64, f64) -> f64) -> f64 {
    quadrature(x, |x| quadrature(y, |y| g(x, y)))
}

fn range() -> impl Strategy<Value = [f64; 2]> {
    (-3.0..3.0f64, 0.05..5.0f64).prop_map(|(a, width)| [a, a + width])
}

proptest! {
    #![proptest_config(config(40))]

    /// Closed forms on random rectangles against quadrature; where there is no closed form, there is a
    /// reason.
    #[test]
    fn closed_forms_agree_with_quadrature(x in range(), y in range(), n in 1u64..100) {
        let r = rectangle(x, y);
        for f in [Integrand::Constant, Integrand::Paraboloid, Integrand::Gaussian, Integrand::Product] {
            let integral = double([x, y], |x, y| f.at(x, y));
            let absolute = double([x, y], |x, y| f.at(x, y).abs());
            if let Some(got) = f.integral(&r) {
                prop_assert!((got - integral).abs() <= 1e-12 * absolute, "{}: {} for {}", f, got, integral);
            } else {
                prop_assert!(false, "{} has an integral", f);
            }
            // about the mean, which does not cancel
            let mean = integral / r.area();
            let variance = r.area() * double([x, y], |x, y| (f.at(x, y) - mean).powi(2));
            let scale = r.area() * double([x, y], |x, y| f.at(x, y).powi(2));
            if let Some(got) = f.variance(&r) {
                prop_assert!((got - variance).abs() <= 1e-11 * variance + 1e-26 * scale, "{}: {} for \
                    {}", f, got, variance);
            } else {
                prop_assert!(f == Integrand::Gaussian && variance < scale / 500.0);
            }
            let along_x = (x[1] - x[0]) * quadrature(x, |x| quadrature(y, |y| f.at(x, y) - mean).powi(2));
            let along_y = (y[1] - y[0]) * quadrature(y, |y| quadrature(x, |x| f.at(x, y) - mean).powi(2));
            if let Some(got) = f.all_pairs_variance(&r, n) {
                let n = n as f64;
                let truth = (variance + (n - 1.0) * (along_x + along_y)) / (n * n);
                prop_assert!((got - truth).abs() <= 1e-11 * truth + 1e-26 * scale, "{}: {} for \
                    {}", f, got, truth);
            }
        }
        // div(r/|r|) = 1/|r| in the plane: ∫∫ 1/r is the flux of the unit vector through the four sides
        let side = |distance: f64, along| quadrature(along,
            |t| if distance == 0.0 { 0.0 } else { distance / distance.hypot(t) });
        let flux = side(x[1], y) - side(x[0], y) + side(y[1], x) - side(y[0], x);
        let got = Integrand::InverseDistance.integral(&r);
        // a side at 1e-3 of the origin is more than the quadrature can do
        if [x[0], x[1], y[0], y[1]].iter().all(|end| end.abs() > 0.05) {
            let got = got.expect("no sliver");
            prop_assert!((got - flux).abs() <= 1e-11 * flux, "{} for {}", got, flux);
        }
    }
}
