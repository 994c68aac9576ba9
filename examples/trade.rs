//! What does a second buy? The workbook's trades of speed against accuracy, measured on this machine.
//!
//! Each table compares estimators of one quantity, drawn in turns on one core: the best has the smallest variance × time. `--seconds S` takes S seconds for each estimator.

use std::process::ExitCode;

use unbiased::box_room::{BoxRoom, Scene};
use unbiased::figure;
use unbiased::hemisphere::Hemisphere::{Cosine, Uniform};
use unbiased::inversion::Exponential;
use unbiased::lambertian::{CosinePower, Lambertian, Light};
use unbiased::paths::{Bounces, FindLight, Paths};
use unbiased::rectangle::{Family, Genz, Integrand, Rectangle};
use unbiased::roulette::LightModel;
use unbiased::trade::{Comparison, Measured, Nature, Rival, Trade};
use unbiased::workbook::{self, Answer, Appendix, Options, Table};
use unbiased::{Budget, Estimator, Result, from_fn};

/// The section, as the options ask.
pub fn answer(options: &Options) -> Result<Appendix> {
    let seconds = match options.budget {
        Some(Budget::Time(time)) => time.as_secs_f64(),
        _ => 0.03,
    };
    let trade = |truth: f64| Trade::new(options.seed, truth)?.seconds_each(seconds);

    let directions =
        [0.0, 1.0, 10.0, -0.5, -0.9].map(|a| directions(a, trade)).into_iter().collect::<Result<Vec<_>>>()?;
    let points = points(trade)?;
    let endings = endings(trade)?;
    let (ways, all) = (ways_to_the_light(trade)?, all_bounces(trade)?);
    let (logarithms, precisions) = (logarithms(trade)?, precisions(trade)?);

    let tables = vec![
        table("3.6: directions under a light cos^a θ, for each a on their own", &directions),
        table("1.1: the mean of an exponential, by two logarithms", [&logarithms]),
        points_table(&points),
        table("5.3: roulette against truncation in the model with ρ = 0.8, v = 0.5", [&endings]),
        table("4.3: the light found by chance or sampled, up to two bounces", [&ways]),
        table("4.3: all bounces, ended by roulette or cut off", [&all]),
        table(
            "4.3: one path after the other or many side by side, in double and in single precision",
            [&precisions],
        ),
    ];
    let compared = directions.iter().map(|comparison| ("3.6", comparison));
    let compared = compared.chain(points.iter().map(|(_, comparison)| ("2.1", comparison)));
    let compared = compared.chain([("5.3", &endings), ("4.3", &ways), ("4.3", &all)]);
    let compared = compared.chain([("1.1", &logarithms), ("4.3", &precisions)]);
    let records = compared.flat_map(|(question, comparison)| {
        comparison.rivals.iter().map(move |rival| record(question, rival, options.seed))
    });
    Ok(Appendix {
        example: "trade",
        title: "What does a second buy?",
        text: format!(
            "Estimators of the same quantity, drawn in turns on one core of this machine, {seconds} s each (seed {}). Efficiency is 1/(variance × time), as a part of the best one's; the times are those to a std error of so much relative to the truth. \
             “As good as the one above” means less than three standard errors apart.",
            options.seed
        ),
        tables,
        records: records.collect(),
        figures: vec![
            figure::trade("trade_light", "Light found by chance or sampled: draws, rays and seconds", &ways)?,
            figure::trade("trade_endings", "Roulette falls on where truncation levels off", &endings)?,
        ],
    })
}

fn directions(a: f64, trade: impl Fn(f64) -> Result<Trade>) -> Result<Comparison> {
    let (surface, light) = (Lambertian::new(0.8)?, CosinePower::new(a)?);
    let rivals = [Uniform, Cosine].map(|density| {
        let nature = if light.variance(surface, density).is_finite() {
            Nature::Unbiased
        } else {
            Nature::InfiniteVariance
        };
        Rival::new(
            format!("a = {a}: {density:?}").to_lowercase(),
            surface.estimator(move |w| light.incoming(w), density),
        )
        .nature(nature)
    });
    trade(light.reflected(surface))?.compare(&rivals)
}

/// Points in the plane: independent pairs, all pairs, jittered and Sobol, over the test set and Genz's families.
fn points(trade: impl Fn(f64) -> Result<Trade>) -> Result<Vec<(String, Comparison)>> {
    let mut found = Vec::new();
    for f in [Integrand::Paraboloid, Integrand::Gaussian, Integrand::Disc, Integrand::InverseDistance] {
        let square = Rectangle::WORKSHEET;
        let infinite = f.variance(&square) == Some(f64::INFINITY);
        let truth = f.integral(&square).unwrap_or(f64::NAN);
        found.push((
            f.formula().to_owned(),
            ways_to_place(square, move |x, y| f.at(x, y), infinite, trade(truth)?)?,
        ));
    }
    for family in Family::ALL {
        let genz = Genz::new(family, [5.0, 3.0], [0.3, 0.6])?;
        let square = Rectangle::new([0.0, 1.0], [0.0, 1.0])?;
        let name =
            format!("Genz: {family:?}").to_lowercase().replace("genz", "Genz").replace("peak", " peak");
        found.push((name, ways_to_place(square, move |x, y| genz.at(x, y), false, trade(genz.integral())?)?));
    }
    Ok(found)
}

fn ways_to_place(
    square: Rectangle,
    f: impl Fn(f64, f64) -> f64 + Sync + Copy,
    infinite: bool,
    trade: Trade,
) -> Result<Comparison> {
    let nature = if infinite { Nature::InfiniteVariance } else { Nature::Unbiased };
    let rivals = [
        Rival::new("independent", square.independent(f)),
        Rival::new("all pairs, 64²", square.all_pairs(f, 64)?),
        Rival::new("jittered, 8²", square.jittered(f, 8)?),
        Rival::new("jittered, 64²", square.jittered(f, 64)?),
        Rival::new("Sobol, 64", square.sobol(f, 64)?),
        Rival::new("Sobol, 4096", square.sobol(f, 4096)?),
    ];
    trade.compare(&rivals.map(|rival| rival.nature(nature)))
}

fn endings(trade: impl Fn(f64) -> Result<Trade>) -> Result<Comparison> {
    let model = LightModel::new(0.8, 0.5)?;
    let mut rivals = Vec::new();
    for q in [0.8, model.optimum(), 0.7, 0.2] {
        let paths = model.roulette(q)?;
        let nature = if paths.variance().is_finite() { Nature::Unbiased } else { Nature::InfiniteVariance };
        rivals.push(Rival::new(format!("roulette, q = {:.3}", q), paths).nature(nature));
    }
    for max_k in [8, 16] {
        rivals.push(
            Rival::new(format!("cut after k ≤ {max_k}"), model.truncated(max_k)?).nature(Nature::Biased),
        );
    }
    trade(model.mean())?.compare(&rivals)
}

fn ways_to_the_light(trade: impl Fn(f64) -> Result<Trade>) -> Result<Comparison> {
    let room = BoxRoom::new(Scene::default())?;
    let truth = room.one_bounce() + room.two_bounces().unwrap_or(f64::NAN);
    let mut rivals = Vec::new();
    for (name, directions, light) in [
        ("sampled, cosine", Cosine, FindLight::BySampling),
        ("sampled, uniform", Uniform, FindLight::BySampling),
        ("by chance, cosine", Cosine, FindLight::ByChance),
        ("by chance, uniform", Uniform, FindLight::ByChance),
    ] {
        rivals.push(Rival::new(name, Paths::new(room, Bounces::UpTo(2), directions, light)?));
    }
    trade(truth)?.compare(&rivals)
}

fn all_bounces(trade: impl Fn(f64) -> Result<Trade>) -> Result<Comparison> {
    let room = BoxRoom::new(Scene::default())?;
    let paths = |bounces| Paths::new(room, bounces, Cosine, FindLight::BySampling);
    // no closed form is known: the reference is a run of its own, right to 1e-4
    let reference = unbiased::estimate(&paths(Bounces::UpTo(40))?, Budget::RelativeError(1e-4), 4)?.mean();
    let rivals = [
        Rival::new("roulette by weight", paths(Bounces::AllByWeight)?),
        Rival::new("roulette, q = 0.8", paths(Bounces::All(0.8))?),
        Rival::new("roulette, q = 0.7", paths(Bounces::All(0.7))?),
        Rival::new("up to 2 bounces", paths(Bounces::UpTo(2))?).nature(Nature::Biased),
        Rival::new("up to 6 bounces", paths(Bounces::UpTo(6))?).nature(Nature::Biased),
    ];
    trade(reference)?.compare(&rivals)
}

/// The accurate logarithm against the fast one, which is within 1 ulp and goes wide.
fn logarithms(trade: impl Fn(f64) -> Result<Trade>) -> Result<Comparison> {
    let exponential = Exponential::new(0.37)?;
    let rivals = [
        Rival::new("fast logarithm, many at a time", exponential),
        Rival::new("ln, one draw at a time", from_fn(move |rng| exponential.draw(rng))),
        Rival::new(
            "ln_1p, one draw at a time",
            from_fn(move |rng| -(-rng.uniform()).ln_1p() / exponential.rate()),
        ),
    ];
    trade(exponential.mean())?.compare(&rivals)
}

fn precisions(trade: impl Fn(f64) -> Result<Trade>) -> Result<Comparison> {
    let room = BoxRoom::new(Scene::default())?;
    let truth = room.one_bounce() + room.two_bounces().unwrap_or(f64::NAN);
    let paths = Paths::new(room, Bounces::UpTo(2), Cosine, FindLight::BySampling)?;
    let rivals = [
        Rival::new("f32, many at a time", paths.in_f32()),
        Rival::new("f64, many at a time", paths),
        Rival::new("f64, one path after the other", from_fn(move |rng| paths.draw(rng))),
    ];
    trade(truth)?.compare(&rivals)
}

fn table<'a>(caption: &str, comparisons: impl IntoIterator<Item = &'a Comparison>) -> Table {
    Table {
        caption: caption.into(),
        columns: vec![
            "estimator",
            "σ/truth",
            "work",
            "ns/draw",
            "efficiency",
            "to 1 %",
            "to 0.1 %",
            "to 10⁻⁴",
            "to 10⁻⁵",
            "remark",
        ],
        rows: comparisons.into_iter().flat_map(ranked_rows).collect(),
    }
}

/// The unbiased ones by rank, then the biased.
fn ranked_rows(comparison: &Comparison) -> Vec<Vec<String>> {
    let places = comparison.ranking();
    let ranked = places.iter().map(|place| {
        let remark = match place.rival.nature {
            Nature::InfiniteVariance => "infinite variance",
            _ if !place.rival.varies() => "no variance",
            _ if place.rival.heavy_tail => "a few draws hold the variance",
            _ if !place.set_apart => "as good as the one above",
            _ => "",
        };
        row(place.rival, format!("{:.3}", place.of_the_best), remark.into())
    });
    let biased = comparison.rivals.iter().filter(|rival| rival.nature == Nature::Biased).map(|rival| {
        let mut remark = format!("bias {:.2} %", 100.0 * rival.bias() / rival.truth);
        if let Some([seconds, error]) = places.first().and_then(|best| rival.overtaken_at(best.rival)) {
            remark += &format!("; overtaken after {seconds:.1e} s, at {:.2} %", 100.0 * error / rival.truth);
        }
        row(rival, String::new(), remark)
    });
    ranked.chain(biased).collect()
}

fn row(rival: &Measured, efficiency: String, remark: String) -> Vec<String> {
    let [low, high] = rival.seconds_range;
    let to =
        |error| rival.seconds_to(error).map_or("never".to_owned(), |seconds| format!("{seconds:.1e}\u{a0}s"));
    let time = format!("{:.1}\u{a0}±\u{a0}{:.1}", 1e9 * rival.seconds, 0.5e9 * (high - low));
    let spread = format!("{:.3}", rival.variance().sqrt() / rival.truth.abs());
    let mut cells = vec![rival.name.clone(), spread, format!("{:.2}", rival.evaluations), time, efficiency];
    cells.extend([1e-2, 1e-3, 1e-4, 1e-5].map(to));
    cells.push(remark);
    cells
}

/// One line an integrand: how fast the error of each way falls with n, and which one reaches 0.1 % first.
fn points_table(points: &[(String, Comparison)]) -> Table {
    let slope = |from: &Measured, to: &Measured| {
        let slope = 0.5 * (to.variance() / from.variance()).ln() / (to.evaluations / from.evaluations).ln();
        format!("{slope:.2}")
    };
    let rows = points.iter().map(|(name, comparison)| {
        let mut cells = vec![name.clone()];
        if let [independent, pairs, jittered_8, jittered_64, sobol_64, sobol_4096] = &comparison.rivals[..] {
            cells.extend([slope(jittered_8, jittered_64), slope(sobol_64, sobol_4096)]);
            let to = |rival: &Measured| {
                rival.seconds_to(1e-3).map_or("never".into(), |seconds| format!("{seconds:.1e}\u{a0}s"))
            };
            cells.extend([independent, pairs, jittered_64, sobol_4096].map(to));
        }
        let heavy = comparison.rivals.first().is_some_and(|rival| rival.nature == Nature::InfiniteVariance);
        let best = comparison.ranking().first().map_or(String::new(), |place| place.rival.name.clone());
        cells.push(if heavy { "infinite variance: no error bar holds".into() } else { best });
        cells
    });
    Table {
        caption:
            "2.1: where the points stand; error slopes in n (independent points: −½), and seconds to 0.1 %"
                .into(),
        columns: vec![
            "integrand",
            "slope, jittered",
            "slope, Sobol",
            "independent",
            "all pairs, 64²",
            "jittered, 64²",
            "Sobol, 4096",
            "most efficient",
        ],
        rows: rows.collect(),
    }
}

fn record(question: &str, rival: &Measured, seed: u64) -> Answer {
    let record = Answer::new(question, &rival.name).measured(rival, seed);
    if rival.nature == Nature::Unbiased { record } else { record.demonstration() }
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> ExitCode {
    workbook::appendix("trade", answer)
}
