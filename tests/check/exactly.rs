//! Moments without noise: right, or refused.

use proptest::prelude::*;
use unbiased::check::{Exact, exactly};
use unbiased::lambertian::hemisphere::{Direction, Hemisphere};
use unbiased::{Error, Stream, f_over_p, from_fn};

use crate::common;

#[test]
fn an_estimator_of_more_numbers_cannot_be_integrated() {
    let three = from_fn(|rng| rng.uniform() * rng.uniform() * rng.uniform());
    assert!(matches!(exactly(&three, 2), Err(Error::NotIntegrable { .. })));
    assert!(exactly(&three, 0).is_err() && exactly(&three, 4).is_err());
    let nan = from_fn(|rng| (rng.uniform() - 0.5).sqrt());
    assert!(matches!(exactly(&nan, 1), Err(Error::NotIntegrable { .. })));
}

/// What `exactly` promises of both moments, as a relative error.
const EXACT: f64 = 1e-9;

/// Whether it was answered: refused is allowed, wrong is not. `size` is E|X|.
fn right_or_refused(exact: Result<Exact, Error>, mean: f64, variance: f64, size: f64, what: &str) -> bool {
    match exact {
        Ok(exact) => {
            assert!((exact.mean - mean).abs() <= EXACT * size, "{what}: {exact:?} for {mean}");
            let off = (exact.variance - variance).abs();
            assert!(off <= EXACT * variance, "{what}: {exact:?} for {variance}");
            true
        }
        Err(Error::NotIntegrable { .. }) => false,
        Err(other) => panic!("{what}: {other}"),
    }
}

/// Up to three intervals that do not meet, and their width together: from 1e-6 to 1, evenly in the logarithm.
fn intervals(rng: &mut Stream) -> (Vec<[f64; 2]>, f64) {
    let count = 1 + (3.0 * rng.uniform()) as usize;
    let mut ends = Vec::new();
    for third in 0..count {
        let room = 1.0 / count as f64;
        let width = room * (1e-6f64 / room).powf(rng.uniform());
        let from = room * third as f64 + (room - width) * rng.uniform();
        ends.push([from, from + width]);
    }
    let width = ends.iter().map(|[from, to]| to - from).sum();
    (ends, width)
}

fn inside(ends: &[[f64; 2]], u: f64) -> bool {
    ends.iter().any(|[from, to]| (*from..*to).contains(&u))
}

/// An interval that lay between the nodes was once taken for 0.
#[test]
fn an_interval_between_the_nodes_is_seen() {
    let interval = from_fn(|rng| if (0.7..0.75).contains(&rng.uniform()) { 20.0 } else { 0.0 });
    assert!(right_or_refused(exactly(&interval, 1), 1.0, 19.0, 1.0, "0.7 to 0.75"));
    // as narrow as is promised, and a hundredth of the whole
    let narrow = from_fn(|rng| {
        let u = rng.uniform();
        u + if (0.3..0.3 + 9.6e-7).contains(&u) { 1e4 } else { 0.0 }
    });
    let exact = exactly(&narrow, 1).unwrap();
    assert!((exact.mean - 0.5096).abs() <= EXACT * 0.51, "{exact:?}");
}

/// 400 of them, or as many as `UNBIASED_INTERVALS` says: none wrong, none refused.
#[test]
fn random_intervals_are_integrated() {
    let mut rng = Stream::new(common::seed(70), 0);
    let asked = std::env::var("UNBIASED_INTERVALS").ok().and_then(|count| count.parse().ok());
    for _ in 0..asked.unwrap_or(common::draws(400)) {
        let (ends, width) = intervals(&mut rng);
        let height = 1.0 / width * if rng.uniform() < 0.5 { -1.0 } else { 1.0 };
        let what = format!("{ends:?}");
        let x = from_fn(|rng| if inside(&ends, rng.uniform()) { height } else { 0.0 });
        let [mean, variance] = [height * width, height * height * width * (1.0 - width)];
        assert!(right_or_refused(exactly(&x, 1), mean, variance, 1.0, &what), "{what} was refused");
    }
}

/// On one axis of several, alone or on a slope along the others: 100, none wrong.
#[test]
fn intervals_of_one_axis_are_right_or_refused() {
    let mut rng = Stream::new(71, 0);
    let (mut answered, cases) = (0, common::draws(100));
    for case in 0..cases {
        let dimensions = if case % 8 == 7 { 3 } else { 2 };
        let axis = (dimensions as f64 * rng.uniform()) as usize;
        let (ends, width) = intervals(&mut rng);
        let slope = f64::from(u8::from(rng.uniform() < 0.7));
        let height = 1.0 / width.sqrt();
        let x = from_fn(|rng| {
            let mut u = [0.0; 3];
            u[..dimensions].fill_with(|| rng.uniform());
            let other = u[(axis + 1) % dimensions];
            slope * other + if inside(&ends, u[axis]) { height } else { 0.0 }
        });
        let mean = 0.5 * slope + height * width;
        let variance = slope * slope / 12.0 + height * height * width * (1.0 - width);
        let what = format!("{ends:?} of axis {axis} of {dimensions}, slope {slope}");
        answered += u64::from(right_or_refused(exactly(&x, dimensions), mean, variance, mean, &what));
    }
    println!("{answered} of {cases} answered");
    // the scattered points may miss what the diagonal has found
    assert!(2 * answered >= cases, "{answered} of {cases}");
}

/// The edge of a disc lies aslant: 100 of any size, on a slope or not, are refused, and if not, right.
#[test]
fn random_discs_are_right_or_refused() {
    let mut rng = Stream::new(common::seed(72), 0);
    for _ in 0..common::draws(100) {
        let radius = 0.5 * 0.012f64.powf(rng.uniform());
        let [x, y] = [0; 2].map(|_| radius + (1.0 - 2.0 * radius) * rng.uniform());
        let slope = f64::from(u8::from(rng.uniform() < 0.3));
        let area = std::f64::consts::PI * radius * radius;
        // missed by all 2¹⁸ points
        common::alarm((-262_144.0 * area).exp());
        let disc = from_fn(|rng| {
            let [u, v] = [rng.uniform(), rng.uniform()];
            slope * u + if (u - x).hypot(v - y) < radius { 2.0 } else { 0.0 }
        });
        let mean = 0.5 * slope + 2.0 * area;
        // E X² = s²/3 + 4a + 4 s a x, x being the mean of u over the disc
        let variance = slope / 3.0 + 4.0 * area + 4.0 * slope * area * x - mean * mean;
        right_or_refused(exactly(&disc, 2), mean, variance, mean, &format!("{radius} at {x}, {y}, {slope}"));
    }
}

/// E (1 − u)⁻ᵃ = 1/(1 − a), and the square is the same with 2a.
#[test]
fn singular_estimators_are_right_or_said_to_be() {
    for (a, answered) in [(0.1, true), (0.15, true), (0.25, false), (0.4, false), (0.5, false), (0.9, false)]
    {
        let exact = exactly(&from_fn(|rng| (1.0 - rng.uniform()).powf(-a)), 1);
        if let Err(error) = &exact {
            assert!(error.to_string().contains("variance is infinite, or nearly so"), "{a}: {error}");
        }
        let mean = 1.0 / (1.0 - a);
        let variance = 1.0 / (1.0 - 2.0 * a) - mean * mean;
        assert_eq!(right_or_refused(exact, mean, variance, mean, &format!("a = {a}")), answered, "a = {a}");
    }
    // both ends, a product, a sum
    let log = |u: f64| -(1.0 - u).ln();
    let both = from_fn(|rng| {
        let u = rng.uniform();
        log(u) + log(1.0 - u.max(1e-16))
    });
    // Var = 2 + 2 Cov, and ∫ ln u ln(1 − u) = 2 − π²/6
    let variance = 2.0 + 2.0 * (1.0 - std::f64::consts::PI.powi(2) / 6.0);
    assert!(right_or_refused(exactly(&both, 1), 2.0, variance, 2.0, "both ends"));
    let product = from_fn(|rng| log(rng.uniform()) * log(rng.uniform()));
    assert!(right_or_refused(exactly(&product, 2), 1.0, 3.0, 1.0, "product"));
    let sum = from_fn(|rng| log(rng.uniform()) + log(rng.uniform()));
    assert!(right_or_refused(exactly(&sum, 2), 2.0, 2.0, 2.0, "sum"));
}

/// Whatever the size of the draws, and however many numbers they take.
#[test]
fn every_scale_is_right_or_refused() {
    for scale in [1e-300, -1e-160, 1e-100, 1.0, -1e100, 1e150, 1e160, 1e300] {
        let x = from_fn(|rng| scale * rng.uniform());
        let variance = scale * scale / 12.0;
        let answered =
            right_or_refused(exactly(&x, 1), 0.5 * scale, variance, scale.abs(), &format!("{scale}"));
        assert_eq!(answered, variance.is_normal(), "{scale}");
        let constant = exactly(&from_fn(|_| scale), 3).unwrap();
        assert_eq!(constant, Exact { mean: scale, variance: 0.0 });
        let seldom = from_fn(|rng| if (0.5..0.501).contains(&rng.uniform()) { scale } else { 0.0 });
        let [mean, variance] = [1e-3 * scale, 1e-3 * (1.0 - 1e-3) * scale * scale];
        right_or_refused(exactly(&seldom, 1), mean, variance, mean.abs(), &format!("seldom {scale}"));
    }
    for dimensions in 1..=3 {
        assert_eq!(exactly(&from_fn(|_| 0.0), dimensions).unwrap(), Exact { mean: 0.0, variance: 0.0 });
        let sign = from_fn(|rng| if rng.uniform() < 0.5 { -1.0 } else { 1.0 });
        assert!(right_or_refused(exactly(&sign, dimensions), 0.0, 1.0, 1.0, "sign"));
        // one number, or a second one
        let some = from_fn(|rng| if rng.uniform() < 0.5 { 1.0 } else { 2.0 * rng.uniform() });
        assert_eq!(exactly(&some, dimensions).is_ok(), dimensions > 1);
    }
    // no polynomial at all
    let noise =
        from_fn(|rng| ((rng.uniform() * 9007199254740992.0) as u64).wrapping_mul(0x9e3779b97f4a7c15) as f64);
    let error = exactly(&noise, 1).unwrap_err().to_string();
    assert!(error.contains("more than 30000000 draws"), "{error}");
}

proptest! {
    #![proptest_config(common::config(100))]

    /// Pieces c + s u between random cuts, of any width.
    #[test]
    fn random_pieces_are_integrated(
        cuts in prop::collection::vec(0.0..1.0f64, 0..6),
        lines in prop::collection::vec((-1.0..1.0f64, -1.0..1.0f64), 7),
    ) {
        let mut ends = cuts;
        ends.sort_unstable_by(f64::total_cmp);
        let x = from_fn(|rng| {
            let u = rng.uniform();
            let (c, s) = lines[ends.iter().filter(|end| **end <= u).count()];
            c + s * u
        });
        let (mut mean, mut square) = (0.0, 0.0);
        for (piece, (c, s)) in lines.iter().enumerate().take(ends.len() + 1) {
            let from = if piece == 0 { 0.0 } else { ends[piece - 1] };
            let to = ends.get(piece).copied().unwrap_or(1.0);
            let (width, middle) = (to - from, c + s * 0.5 * (from + to));
            mean += width * middle;
            square += width * (middle * middle + s * s * width * width / 12.0);
        }
        // E|X| ≥ E X² / max|X|
        prop_assert!(right_or_refused(exactly(&x, 1), mean, square - mean * mean, 0.5 * square, "pieces"));
    }
}

/// What quadrature finds hard: a kink or a jump close beside a point where pieces meet, an inner integral
/// that cancels, and draws that vary by rounding alone.
#[test]
fn quadrature_sees_jumps_beside_its_own_seams_and_stops_at_rounding() {
    for jump in [0.5 + 1e-4, 0.5 - 1e-7, 0.75 + 1e-10, 1e-3, 1.0 - 1e-5] {
        let step = exactly(&from_fn(move |rng| if rng.uniform() < jump { 3.0 } else { 1.0 }), 1).unwrap();
        assert!((step.mean - (1.0 + 2.0 * jump)).abs() <= 1e-9, "{jump}: {}", step.mean);
        let kink = exactly(&from_fn(move |rng| rng.uniform().min(jump)), 1).unwrap();
        assert!((kink.mean - jump * (1.0 - 0.5 * jump)).abs() <= 1e-9, "{jump}: {}", kink.mean);
    }
    let cancels =
        exactly(&from_fn(|rng| (4.0 * rng.uniform() - 2.0) * (4.0 * rng.uniform() - 2.0)), 2).unwrap();
    assert!(cancels.mean.abs() <= 1e-12 && (cancels.variance - 16.0 / 9.0).abs() <= 1e-9, "{cancels:?}");
    let constant = exactly(&f_over_p(|w: &Direction| 0.61 * w.cos_theta(), Hemisphere::Cosine), 2).unwrap();
    assert!(
        (constant.mean - 0.61 * std::f64::consts::PI).abs() <= 1e-12 && constant.variance == 0.0,
        "{constant:?}"
    );
    let aslant = from_fn(|rng| if rng.uniform() + rng.uniform() * rng.uniform() < 0.7 { 1.0 } else { 0.0 });
    assert!(exactly(&aslant, 3).unwrap_err().to_string().contains("at an angle"));
}
