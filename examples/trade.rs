//! What does a second buy? The workbook's estimators compared by speed and accuracy, measured on this
//! machine.
//!
//! Each table compares estimators of one quantity, drawn in turns on one core: the best one has the smallest
//! variance × time. `--seconds S` takes about S seconds for each estimator. The same numbers are written as
//! CSV to `trade_table.csv`, next to the figures.

use std::fs;
use std::process::ExitCode;

use unbiased::inversion::Exponential;
use unbiased::lambertian::hemisphere::Hemisphere::{Cosine, Uniform};
use unbiased::lambertian::{CosinePower, Lambertian, Light, RingLight};
use unbiased::paths::room::{BoxRoom, Scene};
use unbiased::paths::{Bounces, FindLight, Paths, reflected};
use unbiased::placement::{jittered, sobol};
use unbiased::plot::Figure;
use unbiased::rectangle::{Family, Genz, Integrand, Rectangle};
use unbiased::roulette::LightModel;
use unbiased::trade::figures;
use unbiased::trade::{Comparison, Measured, Nature, Ranked, Rival, Trade};
use unbiased::workbook::{self, Answer, Appendix, Options, Table, Value};
use unbiased::{Budget, Error, Estimator, Result, from_fn};

/// A comparison, with what is estimated and the question that it belongs to.
struct Compared {
    question: &'static str,
    what: String,
    found: Comparison,
}

/// The appendix, for these options.
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
    let placements = placements(trade)?;

    let tables = vec![
        table("3.6: directions under a light cos^a θ, ranked for each a on their own", &directions),
        table("1.1: the mean of an exponential, by two logarithms", [&logarithms]),
        points_table(&points),
        table("5.3: roulette against truncation in the model with ρ = 0.8, v = 0.5", [&endings]),
        table("4.3: the light found by chance or sampled, up to two bounces", [&ways]),
        table(
            &format!(
                "4.3: all bounces, ended by roulette or cut off. No closed form is known: the truth is an \
                 estimate, {:.7} ± {:.7}, whose error is part of that of each bias",
                all.found.truth, all.found.truth_error
            ),
            [&all],
        ),
        table(
            "4.3: one path after the other or many side by side, in double and in single precision",
            [&precisions],
        ),
        table(
            "3.5, 5.3 and 4.3 (k bounces): independent numbers, and as many better placed ones, ranked for \
             each estimator on their own",
            &placements,
        ),
    ];
    let figures = vec![
        figures::comparison(
            "trade_light",
            "Light found by chance or sampled: draws, rays and seconds",
            &ways.found,
        )?,
        figures::comparison(
            "trade_endings",
            "Roulette keeps improving where truncation levels off",
            &endings.found,
        )?,
        placed_figure("trade_placed_2", "Up to 2 bounces, independent and placed", &placements, TWO)?,
        placed_figure("trade_placed_15", "Up to 15 bounces, independent and placed", &placements, FIFTEEN)?,
    ];
    let compared: Vec<Compared> = directions
        .into_iter()
        .chain(points)
        .chain([endings, ways, all, logarithms, precisions])
        .chain(placements)
        .collect();
    // the name of the CSV begins like those of the figures: none of these files is the same twice
    let path = options.out.join("trade_table.csv");
    fs::write(&path, csv(&compared))
        .map_err(|error| Error::Write { path: path.display().to_string(), reason: error.to_string() })?;
    Ok(Appendix {
        example: "trade",
        title: "What does a second buy?",
        text: format!(
            "Estimators of the same quantity, drawn in turns on one core of this machine, about {seconds} s \
             each (seed {}). {}",
            options.seed,
            Comparison::EXPLAINED
        ),
        tables,
        records: compared.iter().flat_map(records).collect(),
        figures,
    })
}

fn directions(a: f64, trade: impl Fn(f64) -> Result<Trade>) -> Result<Compared> {
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
    let found = trade(light.reflected(surface))?.compare(&rivals)?;
    Ok(Compared { question: "3.6", what: format!("light reflected under cos^a θ, a = {a}"), found })
}

/// Points in the plane: independent pairs, all pairs, jittered and Sobol, over the test set and Genz's
/// families.
fn points(trade: impl Fn(f64) -> Result<Trade>) -> Result<Vec<Compared>> {
    let mut found = Vec::new();
    for f in [Integrand::Paraboloid, Integrand::Gaussian, Integrand::Disc, Integrand::InverseDistance] {
        let square = Rectangle::WORKSHEET;
        let infinite = f.variance(&square) == Some(f64::INFINITY);
        let truth = f.integral(&square).unwrap_or(f64::NAN);
        let of_f = ways_to_place(square, move |x, y| f.at(x, y), infinite, trade(truth)?)?;
        found.push(Compared { question: "2.1", what: f.formula().to_owned(), found: of_f });
    }
    for family in Family::ALL {
        let genz = Genz::new(family, [5.0, 3.0], [0.3, 0.6])?;
        let square = Rectangle::new([0.0, 1.0], [0.0, 1.0])?;
        let what =
            format!("Genz: {family:?}").to_lowercase().replace("genz", "Genz").replace("peak", " peak");
        let of_family = ways_to_place(square, move |x, y| genz.at(x, y), false, trade(genz.integral())?)?;
        found.push(Compared { question: "2.1", what, found: of_family });
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
        Rival::new("jittered, 8²", square.jittered(f, 8)?).series("jittered"),
        Rival::new("jittered, 64²", square.jittered(f, 64)?).series("jittered"),
        Rival::new("Sobol, 64", square.sobol(f, 64)?).series("Sobol"),
        Rival::new("Sobol, 4096", square.sobol(f, 4096)?).series("Sobol"),
    ];
    trade.compare(&rivals.map(|rival| rival.nature(nature)))
}

fn endings(trade: impl Fn(f64) -> Result<Trade>) -> Result<Compared> {
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
    let found = trade(model.mean())?.compare(&rivals)?;
    Ok(Compared { question: "5.3", what: "light along a path, ρ = 0.8, v = 0.5".into(), found })
}

fn ways_to_the_light(trade: impl Fn(f64) -> Result<Trade>) -> Result<Compared> {
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
    let found = trade(truth)?.compare(&rivals)?;
    Ok(Compared { question: "4.3", what: "up to two bounces, the light found".into(), found })
}

fn all_bounces(trade: impl Fn(f64) -> Result<Trade>) -> Result<Compared> {
    let room = BoxRoom::new(Scene::default())?;
    let paths = |bounces| Paths::new(room, bounces, Cosine, FindLight::BySampling);
    let [truth, truth_error] = ALL_LIGHT;
    let rivals = [
        Rival::new("roulette by throughput", paths(Bounces::AllByThroughput)?),
        Rival::new("roulette, q = 0.8", paths(Bounces::All(0.8))?),
        Rival::new("roulette, q = 0.7", paths(Bounces::All(0.7))?),
        Rival::new("up to 2 bounces", paths(Bounces::UpTo(2))?).nature(Nature::Biased),
        Rival::new("up to 6 bounces", paths(Bounces::UpTo(6))?).nature(Nature::Biased),
    ];
    let found = trade(truth)?.known_to(truth_error)?.compare(&rivals)?;
    Ok(Compared { question: "4.3", what: "all bounces (the truth is an estimate)".into(), found })
}

/// The radiance of all bounces in the sheet's scene, with its std error, as no closed form is known: from 10⁹
/// paths of up to ten bounces (cosine directions, the light sampled), and 2·10⁶ paths for what bounces 11 to
/// 40 add.
const ALL_LIGHT: [f64; 2] = [0.3553311, 1.5e-6];

/// The accurate logarithm against the fast one, which is accurate to 1 ulp and is vectorized.
fn logarithms(trade: impl Fn(f64) -> Result<Trade>) -> Result<Compared> {
    let exponential = Exponential::new(0.37)?;
    let rivals = [
        Rival::new("fast logarithm, many at a time", exponential),
        Rival::new(
            "ln, one draw at a time",
            from_fn(move |rng| -(1.0 - rng.uniform()).ln() / exponential.rate()),
        ),
        Rival::new(
            "ln_1p, one draw at a time",
            from_fn(move |rng| -(-rng.uniform()).ln_1p() / exponential.rate()),
        ),
    ];
    let found = trade(exponential.mean())?.compare(&rivals)?;
    Ok(Compared { question: "1.1", what: "mean of an exponential, λ = 0.37".into(), found })
}

fn precisions(trade: impl Fn(f64) -> Result<Trade>) -> Result<Compared> {
    let room = BoxRoom::new(Scene::default())?;
    let truth = room.one_bounce() + room.two_bounces().unwrap_or(f64::NAN);
    let paths = Paths::new(room, Bounces::UpTo(2), Cosine, FindLight::BySampling)?;
    let rivals = [
        Rival::new("f32, many at a time", paths.in_f32()?),
        Rival::new("f64, many at a time", paths),
        Rival::new("f64, one path after the other", from_fn(move |rng| paths.draw(rng))),
    ];
    let found = trade(truth)?.compare(&rivals)?;
    Ok(Compared { question: "4.3", what: "up to two bounces, in two precisions".into(), found })
}

/// The question, what is estimated, the estimator, and the truth with its error.
type Placeable = (&'static str, &'static str, Box<dyn Estimator>, [f64; 2]);

/// Independent numbers against jittered and Sobol ones, from a function of two numbers to paths of fifteen
/// bounces. A jump in the integrand, and every further bounce, reduce the gain.
fn placements(trade: impl Fn(f64) -> Result<Trade>) -> Result<Vec<Compared>> {
    let surface = Lambertian::new(0.8)?;
    let (smooth, ring) = (CosinePower::new(1.0)?, RingLight::new(0.1)?);
    let model = LightModel::new(0.8, 0.5)?;
    let room = BoxRoom::new(Scene::default())?;
    let up_to = |most| Paths::new(room, Bounces::UpTo(most), Cosine, FindLight::BySampling);
    let two = room.two_bounces().unwrap_or(f64::NAN);
    let once = room.one_bounce();
    let compared: [Placeable; 9] = [
        (
            "3.5",
            "cos θ",
            Box::new(surface.cosine_estimator(move |w| smooth.incoming(w))),
            [smooth.reflected(surface), 0.0],
        ),
        (
            "3.5",
            "half the sky",
            Box::new(surface.cosine_estimator(|w| if w.vector().x > 0.0 { 1.0 } else { 0.0 })),
            [0.4, 0.0],
        ),
        (
            "3.5",
            "a ring",
            Box::new(surface.cosine_estimator(move |w| ring.incoming(w))),
            [ring.reflected(surface), 0.0],
        ),
        ("5.3", "the model, q = 0.8", Box::new(model.roulette(0.8)?), [model.mean(), 0.0]),
        ("4.3", "k ≤ 1", Box::new(up_to(1)?), [once, 0.0]),
        (
            "4.3",
            "k = 2, L_o(p_j) known",
            Box::new(reflected(room, Cosine, move |p_j, _| room.direct(p_j))),
            [two, 0.0],
        ),
        ("4.3", TWO, Box::new(up_to(2)?), [once + two, 0.0]),
        ("4.3", "k ≤ 3", Box::new(up_to(3)?), UP_TO_3),
        ("4.3", FIFTEEN, Box::new(up_to(15)?), UP_TO_15),
    ];
    let mut found = Vec::new();
    for (question, what, estimator, [truth, truth_error]) in compared {
        let rivals = [
            Rival::new(format!("independent: {what}"), &*estimator),
            Rival::new(format!("jittered 64²: {what}"), jittered(&*estimator, 64)?),
            Rival::new(format!("Sobol 4096: {what}"), sobol(&*estimator, 4096)?),
        ];
        let trade = trade(truth)?;
        let trade = if truth_error > 0.0 { trade.known_to(truth_error)? } else { trade };
        found.push(Compared {
            question,
            what: format!("{what}, placed numbers"),
            found: trade.compare(&rivals)?,
        });
    }
    Ok(found)
}

const TWO: &str = "k ≤ 2";
const FIFTEEN: &str = "k ≤ 15";

/// Estimates and their std errors, as no closed form is known: 20,000 and 3,000 sets of 65,536 Sobol points
/// (cosine directions, the light sampled).
const UP_TO_3: [f64; 2] = [0.335_016_21, 2.4e-7];
const UP_TO_15: [f64; 2] = [0.355_326_94, 9.1e-7];

fn placed_figure(name: &'static str, title: &str, placements: &[Compared], what: &str) -> Result<Figure> {
    let mine = placements.iter().find(|compared| compared.what.starts_with(&format!("{what},")));
    let mine = mine.ok_or_else(|| Error::Usage(format!("there is no comparison of {what}")))?;
    figures::comparison(name, title, &mine.found)
}

fn table<'a>(caption: &str, comparisons: impl IntoIterator<Item = &'a Compared>) -> Table {
    let comparisons: Vec<&Comparison> = comparisons.into_iter().map(|compared| &compared.found).collect();
    let columns = comparisons.first().map_or(Vec::new(), |first| first.columns());
    Table::new(caption, columns, comparisons.into_iter().flat_map(Comparison::rows))
}

/// One row per integrand: how fast the error of each way falls with n, and which way reaches 0.1 % first.
fn points_table(points: &[Compared]) -> Table {
    let rows = points.iter().map(|Compared { what, found, .. }| {
        let mut cells = vec![what.clone()];
        if let [independent, pairs, _, jittered, _, sobol] = &found.rivals[..] {
            let slope = |rival| {
                found.slope(rival).map_or(String::new(), |slope| format!("{slope:.2}").replace('-', "−"))
            };
            cells.extend([jittered, sobol].map(slope));
            cells.extend(
                [independent, pairs, jittered, sobol].map(|rival| rival.seconds_to(1e-3).to_string()),
            );
        }
        let infinite = found.rivals.iter().any(|rival| rival.nature == Nature::InfiniteVariance);
        let ranking = found.ranking();
        let best: Vec<_> =
            ranking.iter().filter(|place| place.rank == 1).map(|place| place.rival.name.as_str()).collect();
        cells.push(if infinite { "infinite variance: no valid error bar".into() } else { best.join(" or ") });
        cells
    });
    Table::new(
        "2.1: how the points are placed: slopes of the error in n (−½ for independent points), and seconds \
         to 0.1 %, at least those of one draw, which is a whole replicate. The most efficient way, or any \
         not told apart from it, need not be the fastest to 0.1 %: a replicate may already be more \
         accurate",
        [
            "integrand",
            "slope, jittered",
            "slope, Sobol",
            "independent",
            "all pairs, 64²",
            "jittered, 64²",
            "Sobol, 4096",
            "most efficient",
        ],
        rows,
    )
}

/// All comparisons, one below the other.
fn csv(compared: &[Compared]) -> String {
    let mut csv = String::new();
    for Compared { question, what, found } in compared {
        for (index, line) in found.csv().lines().enumerate() {
            if index > 0 {
                csv += &format!("{question},\"{what}\",{line}\n");
            } else if csv.is_empty() {
                csv += &format!("question,what,{line}\n");
            }
        }
    }
    csv
}

fn records(compared: &Compared) -> Vec<Answer> {
    let Compared { question, what, found } = compared;
    let ranking = found.ranking();
    let place = |rival: &Measured| ranking.iter().find(|place| std::ptr::eq(place.rival, rival));
    let rivals = found.rivals.iter();
    rivals.map(|rival| record(question, what, found.seed, rival, place(rival))).collect()
}

/// A rival's record; null is infinite, never reached, or unknown.
fn record(question: &str, what: &str, seed: u64, rival: &Measured, place: Option<&Ranked<'_>>) -> Answer {
    // 0 or 1
    let flag = |flag: bool| Value::Limit(Some(flag.into()));
    let biased = rival.nature == Nature::Biased;
    let of_bias = |number: f64| if biased { number } else { f64::NAN };
    let [low, high] = rival.seconds_range;
    let mut record = Answer::new(question, &format!("{what}: {}", rival.name))
        .measured(rival, seed)
        .parameter("truth_error", rival.truth_error)
        .parameter("biased", flag(biased))
        .parameter("infinite_variance", flag(rival.nature == Nature::InfiniteVariance))
        .parameter("heavy_tail", flag(rival.heavy_tail))
        .parameter("bias", of_bias(rival.bias()))
        .parameter("bias_error", of_bias(rival.bias_error()))
        .parameter("bias_seen", flag(rival.bias_seen()))
        .parameter("evaluations_per_draw", rival.evaluations)
        .parameter("random_numbers_per_draw", rival.random_numbers)
        .parameter("seconds_per_draw_low", low)
        .parameter("seconds_per_draw_high", high)
        .parameter("rank", Value::Limit(place.and_then(|place| u32::try_from(place.rank).ok())));
    for (name, error) in [
        ("seconds_to_1e-2", 1e-2),
        ("seconds_to_1e-3", 1e-3),
        ("seconds_to_1e-4", 1e-4),
        ("seconds_to_1e-5", 1e-5),
    ] {
        record = record.parameter(name, rival.seconds_to(error).seconds().unwrap_or(f64::NAN));
    }
    if rival.nature == Nature::Unbiased { record } else { record.demonstration() }
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> ExitCode {
    workbook::appendix("trade", answer)
}
