//! Every closed form against tables of its true values, in units in the last place (ulp) of the correctly
//! rounded one.
//!
//! `data/extremes.csv` holds the worksheet's extremes, `data/closed_forms.csv` every public closed form at
//! inputs of every size (made by `data/closed_forms.py`, which makes as many more as asked for). Inputs are
//! taken from their bits. The closed forms of [`unbiased::rectangle::Integrand`], which promise 12 digits
//! only, have their tables in `rectangle.rs`.
//!
//! ```sh
//! cargo test --release --test vectors -- --nocapture  # rows passed and worst ulp of each function
//! UNBIASED_VECTORS=more.csv cargo test --release --test vectors -- --nocapture  # another table
//! ```

mod common;

use std::collections::BTreeMap;

use common::{Stuck, ulps};
use glam::DVec3;
use rand::distr::Distribution;
use unbiased::inversion::Exponential;
use unbiased::lambertian::hemisphere::{Direction, Hemisphere};
use unbiased::lambertian::{CosinePower, Lambertian, Light, RingLight};
use unbiased::paths::room::form_factor;
use unbiased::rectangle::Rectangle;
use unbiased::roulette::{LightModel, Roulette, RoulettePaths, TruncatedPaths};
use unbiased::{Density, Error, Estimate, Estimator, Stream, f_over_p, from_fn};

// ---- tables ----

struct Row {
    function: String,
    inputs: String,
    bits: BTreeMap<String, String>,
    digits: String,
    truth: f64,
}

impl Row {
    /// id, function, inputs, bits, 20 digits, nearest `f64`: commas and quotes only in the first three.
    fn of(line: &str) -> Self {
        let [nearest, digits, bits, rest] = line.rsplitn(4, ',').collect::<Vec<_>>().try_into().expect(line);
        let [_, function, inputs] = rest.splitn(3, ',').collect::<Vec<_>>().try_into().expect(line);
        // "exp_sf: exp(-lambda*x)": the name, then its formula
        let function = function.trim_matches('"').split([':', ' ']).next().expect(line).to_owned();
        let inputs = inputs.trim_matches('"').to_owned();
        let bits = bits.split(';').filter_map(|pair| pair.split_once('='));
        let bits = bits.map(|(name, bits)| (name.into(), bits.into())).collect();
        let [rounded, nearest] = [digits, nearest].map(|number| number.parse::<f64>().expect(line));
        // in rows of f32 `nearest` is one
        let truth = if function.ends_with("_f32") { rounded } else { nearest };
        // both columns say the same (20 digits may not tell on which side of a tie they are: 1 ulp)
        assert!(ulps(truth, rounded) <= 1, "{line}");
        Self { function, inputs, bits, digits: digits.to_owned(), truth }
    }

    fn hex(&self, name: &str) -> u64 {
        let text = &self.bits[name];
        u64::from_str_radix(text.strip_prefix("0x").expect(text), 16).expect(text)
    }

    fn number(&self, name: &str) -> f64 {
        f64::from_bits(self.hex(name))
    }

    fn count(&self, name: &str) -> u64 {
        self.bits[name].parse().expect(name)
    }
}

/// How many steps from one `f64` to the next lead from a to b; NaN is far from everything.
fn ulps_f32(a: f32, b: f32) -> u64 {
    let rank = |x: f32| if x.is_sign_negative() { -(x.abs().to_bits() as i64) } else { x.to_bits() as i64 };
    if a.is_nan() || b.is_nan() { u64::MAX } else { rank(a).abs_diff(rank(b)) }
}

// ---- what the crate says ----

#[derive(Debug)]
enum Found {
    /// The value, one for each way to get it.
    Values(Vec<f64>),
    Single(f32),
    /// A value with an error bound of its own, in ulp of this size.
    Within(f64, f64),
    /// A typed error where the crate refuses such inputs by design.
    Refused(Error),
    /// No function of the crate's answers this.
    NoFunction,
    /// Out of reach for anything but an exact accumulator.
    ExactOnly,
}

use Found::{ExactOnly, NoFunction, Refused, Single, Values, Within};

impl From<f64> for Found {
    fn from(value: f64) -> Self {
        Values(vec![value])
    }
}

/// Whether a generator can give u.
fn is_drawn(u: f64) -> bool {
    (0.0..1.0).contains(&u) && (u * 2f64.powi(53)).fract() == 0.0
}

fn evaluate(row: &Row) -> Result<Found, Error> {
    let x = |name: &str| row.number(name);
    let exponential = || Exponential::new(x("lam"));
    let bounces = || Roulette::new(x("p"));
    let model = || LightModel::new(x("rho"), if row.bits.contains_key("v") { x("v") } else { 1.0 });
    let paths = || -> Result<RoulettePaths, Error> { model()?.roulette(x("q")) };
    let truncated = || -> Result<TruncatedPaths, Error> { model()?.truncated(row.count("k")) };
    let direction = |hemisphere: Hemisphere| {
        hemisphere.direction_of(x("u"), if row.bits.contains_key("v") { x("v") } else { 0.0 })
    };
    let vector = || Direction::new(x("x"), x("y"), x("z"));
    let surface = || Lambertian::new(x("albedo"));
    let box_of = || Rectangle::new([0.0, x("w")], [0.0, x("h")]);
    let rectangle = || Rectangle::new([x("a"), x("b")], [x("c"), x("d")]);
    use Hemisphere::{Cosine, Uniform};
    Ok(match row.function.as_str() {
        "exp_inv_1mu" => {
            let (law, u) = (exponential()?, x("u"));
            let mut values = vec![law.inverse_cdf(u)?];
            if is_drawn(u) {
                values.push(law.draw(&mut Stream::scripted(&[u])));
            }
            Values(values)
        }
        "exp_inv_f32" => Single({
            let (law, u) = (Exponential::new(1.0)?, f32::from_bits(row.hex("u") as u32));
            let on_grid = u * 2f32.powi(24);
            if u < 1.0 && on_grid.fract() == 0.0 {
                law.sample(&mut Stuck(u64::from(on_grid as u32) << 40))
            } else {
                law.inverse_cdf(u.into())? as f32
            }
        }),
        "exp_sf" => exponential()?.survival(x("x")).into(),
        "exp_cdf" => exponential()?.cdf(x("x")).into(),
        "exp_pdf" => Values(vec![exponential()?.pdf(x("x")), Density::pdf(&exponential()?, &x("x"))]),
        "exp_mean" => exponential()?.mean().into(),
        "exp_var" => exponential()?.variance().into(),

        "geom_pmf" => bounces()?.bounces().pmf(row.count("n")).into(),
        "geom_sf" => bounces()?.bounces().survival(row.count("n")).into(),
        "geom_cdf" => bounces()?.bounces().cdf(row.count("n")).into(),
        "geom_mean" => bounces()?.bounces().mean().into(),
        "geom_var" | "geom_var_wrong_order" => bounces()?.bounces().variance().into(),
        "geom_inv" => {
            let law = bounces()?.bounces().by_inversion()?;
            // the sampler's U is 1 − u
            let u = 1.0 - x("u");
            if is_drawn(u) && 1.0 - u == x("u") {
                law.draw(&mut Stream::scripted(&[u])).into()
            } else {
                NoFunction
            }
        }
        "rr_weight" => {
            let one = bounces()?.wrap(from_fn(|_| 1.0));
            one.draw(&mut Stream::scripted(&[])).into()
        }

        "light_mean" => model()?.mean().into(),
        "light_optimum" => model()?.optimum().into(),
        "light_crossing" => model()?.crossing(x("q"), row.count("k"))?.into(),
        "paths_var" => paths()?.variance().into(),
        "paths_cost" => paths()?.cost().into(),
        "paths_mse" => paths()?.mean_square_error(x("vertices"))?.into(),
        "furnace_S_k" | "truncated_mean" => truncated()?.mean().into(),
        "truncated_bias" => truncated()?.bias().into(),
        "truncated_var" => truncated()?.variance().into(),
        "truncated_mse" => truncated()?.mean_square_error(x("vertices"))?.into(),

        "coshemi_cos" | "cosine_cos" => direction(Cosine)?.cos_theta().into(),
        "coshemi_sin" | "cosine_sin" => direction(Cosine)?.sin_theta().into(),
        "coshemi_theta" | "cosine_theta" => direction(Cosine)?.theta().into(),
        "coshemi_pdf" | "cosine_pdf" => Cosine.pdf(&direction(Cosine)?).into(),
        "cosine_phi" => direction(Cosine)?.phi().into(),
        "uniform_cos" => direction(Uniform)?.cos_theta().into(),
        "uniform_sin" => direction(Uniform)?.sin_theta().into(),
        "uniform_theta" => direction(Uniform)?.theta().into(),
        "uniform_pdf" => Uniform.pdf(&direction(Uniform)?).into(),
        "uniform_phi" => direction(Uniform)?.phi().into(),
        "coshemi_weight" if is_drawn(x("u")) => {
            let grey = Lambertian::new(0.5)?;
            let draw = |estimator: &dyn Estimator| estimator.draw(&mut Stream::scripted(&[x("u"), 0.0]));
            Values(vec![draw(&grey.cosine_estimator(|_| 1.0)), draw(&grey.estimator(|_| 1.0, Cosine))])
        }
        "coshemi_weight" => NoFunction,
        "direction_cos" => vector()?.cos_theta().into(),
        "direction_theta" => vector()?.theta().into(),
        "direction_phi" => vector()?.phi().into(),

        "brdf" => surface()?.brdf().into(),
        "reflected" => surface()?.reflected(x("light")).into(),
        "power_reflected" => CosinePower::new(x("a"))?.reflected(surface()?).into(),
        "power_uniform" => CosinePower::new(x("a"))?.variance(surface()?, Uniform).into(),
        "power_cosine" => CosinePower::new(x("a"))?.variance(surface()?, Cosine).into(),
        "ring_reflected" => RingLight::new(x("ring"))?.reflected(surface()?).into(),
        "ring_uniform" => RingLight::new(x("ring"))?.variance(surface()?, Uniform).into(),
        "ring_cosine" => RingLight::new(x("ring"))?.variance(surface()?, Cosine).into(),

        "box_area" => box_of()?.area().into(),
        "box_density" => box_of()?.pdf(&[0.5 * x("w"), x("h")]).into(),
        "box_weight" => {
            let draw = |estimator: &dyn Estimator| estimator.draw(&mut Stream::scripted(&[0.3, 0.7]));
            Values(vec![draw(&f_over_p(|_| 1.0, box_of()?)), draw(&box_of()?.independent(|_, _| 1.0))])
        }
        "rectangle_area" => rectangle()?.area().into(),
        "rectangle_density" => rectangle()?.pdf(&[x("a"), x("d")]).into(),
        "box_lerp" => {
            let (low, high, u) = (x("lo"), x("hi"), x("u"));
            // the other side is such that the area is near 1
            let across = Rectangle::new([low, high], [0.0, 1.0 / (high - low)])?;
            let up = Rectangle::new([0.0, 1.0 / (high - low)], [low, high])?;
            let mut rng = Stream::scripted(&[u, u, u, u]);
            let [along, _] = across.sample(&mut rng);
            let [_, upwards] = up.sample(&mut rng);
            assert_eq!(along, upwards);
            // a drawn point lies on a grid: where lo + u(hi − lo) cancels it is exact to the last place of
            // the larger of lo and itself
            Within(along, along.abs().max(low.abs()))
        }
        "polygon" | "polygon_compact" => {
            let vector =
                |name: &str| DVec3::from_array(["x", "y", "z"].map(|axis| x(&format!("{name}{axis}"))));
            let corners = ["c0", "c1", "c2", "c3"]
                .map(|name| row.bits.contains_key(&format!("{name}x")).then(|| vector(name)));
            let corners: Vec<DVec3> = corners.into_iter().flatten().collect();
            let seen = form_factor(&corners, vector("p"), vector("n"));
            // to 2 ulp of 2, 9e-16, and where it is seen well to 16 of its own
            Within(seen, if row.function == "polygon" { 2.0 } else { 8.0 * seen })
        }
        "sum" | "mean" | "sample_variance" => return statistics(row),
        other => panic!("no check of {other}"),
    })
}

/// The draws that a row names.
fn draws_of(row: &Row) -> Vec<f64> {
    let accuracy = |middle: f64, low: f64, high: f64| {
        let pairs = [low, high].into_iter().cycle().take(1000);
        std::iter::once(middle).chain(pairs).collect()
    };
    match row.inputs.as_str() {
        "[1e16,1,-1e16]" => vec![1e16, 1.0, -1e16],
        "[1,1e100,1,-1e100] (Kahan fails)" => vec![1.0, 1e100, 1.0, -1e100],
        "[1e16]+[1]*1000000+[-1e16]" => [vec![1e16], vec![1.0; 1_000_000], vec![-1e16]].concat(),
        "[0.1]*10" => vec![0.1; 10],
        "[0.1]*1000" => vec![0.1; 1000],
        "[1e16]+[0.1]*1000" => [vec![1e16], vec![0.1; 1000]].concat(),
        "[1e308,1e308,-1e308] (overflow on the way)" => vec![1e308, 1e308, -1e308],
        "[MAX,MAX,-MAX,-MAX]" => vec![f64::MAX, f64::MAX, -f64::MAX, -f64::MAX],
        "[MAX,MAX]" => vec![f64::MAX; 2],
        "[5e-324]*1000" => vec![5e-324; 1000],
        "[1e16,1.5]*3+[-3e16]" => [[1e16, 1.5].repeat(3), vec![-3e16]].concat(),
        "[1,1e32,1,-1e32,... x1000]" => [1.0, 1e32, 1.0, -1e32].repeat(1000),
        "[1e300]*3" => vec![1e300; 3],
        "[1e16,1e16+2,1e16+4]" => vec![1e16, 1e16 + 2.0, 1e16 + 4.0],
        "1e8+{4,7,13,16}" => [4.0, 7.0, 13.0, 16.0].map(|x| 1e8 + x).to_vec(),
        "1e9+{4,7,13,16}" => [4.0, 7.0, 13.0, 16.0].map(|x| 1e9 + x).to_vec(),
        "NumAcc3: 1000000.2,(.1,.3)x500" => accuracy(1_000_000.2, 1_000_000.1, 1_000_000.3),
        "NumAcc4: 10000000.2,(.1,.3)x500" => accuracy(10_000_000.2, 10_000_000.1, 10_000_000.3),
        other => panic!("unknown draws {other}"),
    }
}

/// Mean and variance of the draws, in one slice and one at a time; a sum is n times the mean.
fn statistics(row: &Row) -> Result<Found, Error> {
    let draws = draws_of(row);
    let n = draws.len() as f64;
    let mut pushed = Estimate::new();
    draws.iter().for_each(|draw| pushed.push(*draw));
    let ways = [Estimate::from_draws(&draws), pushed];
    Ok(Values(match row.function.as_str() {
        // 106 bits cannot hold 1 beside 1e100 or 1e32·1000
        "sum" if draws.contains(&1e100) || draws.contains(&1e32) => return Ok(ExactOnly),
        "sum" => ways.map(|estimate| estimate.mean() * n).to_vec(),
        "mean" => ways.map(|estimate| estimate.mean()).to_vec(),
        _ => ways.map(|estimate| estimate.variance().expect("two draws")).to_vec(),
    }))
}

/// Whether the crate's documentation says that such inputs are refused.
fn is_refused_by_design(row: &Row) -> bool {
    let normal = |x: f64| x.is_normal() && x > 0.0;
    let sides = |w: f64, h: f64| {
        let area = w * h;
        !(normal(w) && normal(h) && normal(area) && normal(1.0 / area))
    };
    match row.function.as_str() {
        name if name.starts_with("geom_") || name.starts_with("rr_") => {
            row.number("p") == 0.0 || name == "geom_inv" && row.number("p") == 1.0
        }
        "furnace_S_k" => row.number("rho") == 1.0 || row.count("k") > 1_000_000_000,
        name if name.starts_with("box_") && row.bits.contains_key("w") => {
            sides(row.number("w"), row.number("h"))
        }
        "box_lerp" => {
            let width = row.number("hi") - row.number("lo");
            sides(width, 1.0 / width)
        }
        _ => false,
    }
}

// ---- the tables' verdict ----

/// Most ulp that a value may be off.
const BOUND: u64 = 2;

/// What became of a function's rows: how many of each, and the worst in ulp.
#[derive(Default)]
struct Tally {
    outcomes: BTreeMap<&'static str, u32>,
    worst: u64,
}

fn check(name: &str, table: &str) -> BTreeMap<&'static str, u32> {
    let mut functions: BTreeMap<String, Tally> = BTreeMap::new();
    let mut failures = vec![];
    for line in table.lines().skip(1) {
        let row = Row::of(line);
        let off = |value: f64| {
            // what is exactly 0 or beyond f64 must be so
            let edge = row.digits == "0" || row.truth.is_infinite();
            if edge && value != row.truth { u64::MAX } else { ulps(value, row.truth) }
        };
        let found = evaluate(&row).unwrap_or_else(Refused);
        let (outcome, worst) = match &found {
            Values(values) => ("within", values.iter().map(|value| off(*value)).max().unwrap_or(u64::MAX)),
            Single(value) => ("within", ulps_f32(*value, row.truth as f32)),
            Within(value, size) => {
                let ulp = size.next_up() - size;
                ("within", ((value - row.truth).abs() / ulp).ceil() as u64)
            }
            Refused(_) if is_refused_by_design(&row) => ("refused", 0),
            Refused(_) => ("failed", u64::MAX),
            NoFunction => ("no function", 0),
            ExactOnly => ("exact only", 0),
        };
        let tally = functions.entry(row.function.clone()).or_default();
        tally.worst = tally.worst.max(worst);
        *tally.outcomes.entry(outcome).or_default() += 1;
        if worst > BOUND {
            let given = if let Refused(error) = found { error.to_string() } else { format!("{found:?}") };
            failures.push(format!("{worst} ulp: {line}: {given}"));
        }
    }
    let mut all = BTreeMap::new();
    for (function, Tally { outcomes, worst }) in functions {
        println!("{name}: {function:22} {outcomes:?}, worst {worst} ulp");
        outcomes.into_iter().for_each(|(outcome, rows)| *all.entry(outcome).or_default() += rows);
    }
    let shown = failures.iter().take(40).map(String::as_str).collect::<Vec<_>>().join("\n");
    assert!(failures.is_empty(), "{name}: {} rows failed:\n{shown}", failures.len());
    all
}

#[test]
fn the_worksheets_extremes_come_out() {
    let all = check("extremes.csv", include_str!("data/extremes.csv"));
    // refused: p_rr = 0 (18 rows), rectangles outside f64 (91), sums of a furnace without an end or of more
    // than 10⁹ terms (13); without a function: the number of bounces at a U that no generator gives
    assert_eq!(
        all,
        BTreeMap::from([("within", 516), ("refused", 122), ("exact only", 2), ("no function", 4)])
    );
}

#[test]
fn closed_forms_are_right_at_inputs_of_every_size() {
    match std::env::var("UNBIASED_VECTORS") {
        Ok(path) => check(&path, &std::fs::read_to_string(&path).expect(&path)),
        Err(_) => check("closed_forms.csv", include_str!("data/closed_forms.csv")),
    };
}
