//! The functions that go wide, against the same with 106 bits.

mod common;

use rand::Rng;
use unbiased::Stream;
use unbiased::fast::{exp, ln, sin_cos_of_turns};

/// A number of 106 bits as an unevaluated sum (Dekker 1971); by sums and products only, so it shares nothing
/// with the code under test.
#[derive(Clone, Copy)]
struct Long(f64, f64);

impl Long {
    fn plus(self, other: Self) -> Self {
        let sum = self.0 + other.0;
        let added = sum - self.0;
        let lost = (self.0 - (sum - added)) + (other.0 - added) + self.1 + other.1;
        Self(sum + lost, lost - ((sum + lost) - sum))
    }

    fn times(self, other: Self) -> Self {
        let product = self.0 * other.0;
        let lost = self.0.mul_add(other.0, -product) + self.0 * other.1 + self.1 * other.0;
        Self(product + lost, lost - ((product + lost) - product))
    }

    fn over(self, n: f64) -> Self {
        let quotient = self.0 / n;
        let rest = ((-quotient).mul_add(n, self.0) + self.1) / n;
        Self(quotient + rest, rest - ((quotient + rest) - quotient))
    }

    /// Σ tⁿ/n! over every `step`th n from `first`, with signs in turn if `turns`.
    fn series(self, first: u32, step: u32, turns: bool) -> Self {
        let (mut term, mut sum) = (Self(1.0, 0.0), Self(0.0, 0.0));
        for n in 0..34 {
            if n % step == first {
                let sign = if turns && n / step % 2 == 1 { -1.0 } else { 1.0 };
                sum = sum.plus(Self(sign * term.0, sign * term.1));
            }
            term = term.times(self).over(f64::from(n + 1));
        }
        sum
    }

    /// By how many units of the last place of itself `x` is off.
    fn ulps_to(self, x: f64) -> f64 {
        let ulp = self.0.abs().next_up() - self.0.abs();
        ((x - self.0) - self.1).abs() / ulp
    }
}

const LN_2: Long = Long(std::f64::consts::LN_2, 2.319_046_813_846_299_6e-17);
const TAU: Long = Long(std::f64::consts::TAU, 2.449_293_598_294_706_4e-16);

/// e^x for |x| < 700.
fn long_exp(x: f64) -> Long {
    let k = (x / LN_2.0).round();
    let r = Long(x, 0.0).plus(LN_2.times(Long(-k, 0.0)));
    let e = r.series(0, 1, false);
    Long(e.0 * 2f64.powi(k as i32), e.1 * 2f64.powi(k as i32))
}

/// ln x, by one step of Halley's method from the library's: it cubes a relative error of 1e-16.
fn long_ln(x: f64) -> Long {
    let guess = x.ln();
    let e = long_exp(guess);
    let step = 2.0 * ((x - e.0) - e.1) / (x + e.0);
    Long(guess, 0.0).plus(Long(step, 0.0))
}

/// −ln(1 − u) for u = k·2⁻⁵³: 300,000 k at either end, one by one, and 1.5 million between, ten thousand of
/// them between any two powers of two. The worst is 0.82 ulp.
#[test]
fn ln_of_every_uniform_number_is_within_1_ulp() {
    const GRID: f64 = (1u64 << 53) as f64;
    let mut worst: f64 = 0.0;
    let mut see = |k: u64| {
        let x = k as f64 / GRID; // 1 − u, exactly
        let off = if k == 1 << 53 { ln(x).abs() } else { long_ln(x).ulps_to(ln(x)) };
        assert!(off <= 1.0, "ln({x:?}) is {:?}, off by {off} ulp", ln(x));
        worst = worst.max(off);
    };
    for k in 0..300_000 {
        see(k + 1);
        see((1 << 53) - k);
    }
    let mut rng = Stream::new(common::seed(700), 0);
    for _ in 0..1_000_000 {
        see((rng.next_u64() >> 11) + 1);
    }
    for power in 0..53 {
        for _ in 0..10_000 {
            see((1 << power) + (rng.next_u64() >> 11) % (1 << power));
        }
    }
    println!("ln: {worst} ulp");
    assert!(worst > 0.5, "a reference with no error to find");
}

/// Over all of `f64`'s normal range, and at its ends.
#[test]
fn ln_of_any_normal_number_is_within_1_ulp() {
    let mut rng = Stream::new(common::seed(701), 0);
    for _ in 0..300_000 {
        let x = f64::from_bits(rng.next_u64() >> 1);
        // the reference needs e^(ln x) inside the range
        if (1e-300..1e300).contains(&x) {
            let off = long_ln(x).ulps_to(ln(x));
            assert!(off <= 1.0, "ln({x:?}) is {:?}, off by {off} ulp", ln(x));
        }
    }
    for x in [f64::MIN_POSITIVE, f64::MAX, 1.0_f64.next_up(), 1.0_f64.next_down(), 0.5f64.sqrt(), 2f64.sqrt()]
    {
        assert!((ln(x) - x.ln()).abs() <= 1.5 * f64::EPSILON * x.ln().abs(), "{x:?}");
    }
}

/// A million numbers over f64's range, most of them near 0: the worst is 0.99 ulp.
#[test]
fn exp_is_within_1_1_ulp_and_has_its_limits() {
    let mut rng = Stream::new(common::seed(702), 0);
    let mut worst: f64 = 0.0;
    for _ in 0..1_000_000 {
        let x = 1400.0 * (rng.uniform() - 0.5) * rng.uniform().powi(4);
        let off = long_exp(x).ulps_to(exp(x));
        assert!(off <= 1.1, "exp({x:?}) is {:?}, off by {off} ulp", exp(x));
        worst = worst.max(off);
    }
    println!("exp: {worst} ulp");
    for (x, e) in [
        (0.0, 1.0),
        (-0.0, 1.0),
        (f64::INFINITY, f64::INFINITY),
        (f64::NEG_INFINITY, 0.0),
        (f64::MAX, f64::INFINITY),
        (f64::MIN, 0.0),
        (710.0, f64::INFINITY),
        (-746.0, 0.0),
        (5e-324, 1.0),
    ] {
        assert_eq!(exp(x), e, "{x:?}");
    }
    assert!(exp(f64::NAN).is_nan());
    // below the normal range the unit is absolute
    for x in [-708.5, -720.25, -745.0, 709.7] {
        assert!((exp(x) - x.exp()).abs() <= f64::from_bits(1).max(f64::EPSILON * x.exp()), "{x}");
    }
}

#[test]
fn sines_of_turns_are_within_2_ulp() {
    let mut rng = Stream::new(common::seed(703), 0);
    let mut worst: f64 = 0.0;
    for _ in 0..1_000_000 {
        let v = rng.uniform();
        let quarters = (4.0 * v).round();
        let t = TAU.times(Long(v - 0.25 * quarters, 0.0));
        let (sin, cos) = (t.series(1, 2, true), t.series(0, 2, true));
        let minus = |x: Long| Long(-x.0, -x.1);
        let [long_sin, long_cos] = match quarters as u32 % 4 {
            0 => [sin, cos],
            1 => [cos, minus(sin)],
            2 => [minus(sin), minus(cos)],
            _ => [minus(cos), sin],
        };
        let (sin, cos) = sin_cos_of_turns(v);
        let off = long_sin.ulps_to(sin).max(long_cos.ulps_to(cos));
        assert!(off <= 2.0, "at {v:?} turns {off} ulp");
        worst = worst.max(off);
    }
    println!("sin and cos: {worst} ulp");
    for (v, exact) in
        [(0.0, (0.0, 1.0)), (0.25, (1.0, 0.0)), (0.5, (0.0, -1.0)), (0.75, (-1.0, 0.0)), (1.0, (0.0, 1.0))]
    {
        assert_eq!(sin_cos_of_turns(v), exact);
    }
}

/// Of whole numbers, their neighbours and halves, and numbers of every size.
#[test]
fn the_whole_part_is_the_librarys() {
    let powers = (0..=60).map(|power| 2f64.powi(power));
    let near = powers.flat_map(|x| [x, x.next_up(), x.next_down(), x + 0.5, 3.0 * x, 3.0 * x + 0.25]);
    let sizes = (-320..=308).map(|power| 1.7 * 10f64.powi(power));
    for x in near.chain(sizes).chain([0.0, 0.5, f64::MAX, f64::MIN_POSITIVE, f64::INFINITY]) {
        assert_eq!(unbiased::fast::floor(x), x.floor(), "{x:e}");
    }
}
