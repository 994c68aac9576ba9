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
use unbiased::question::Value;
use unbiased::rectangle::{Family, Genz, Integrand, Rectangle};
use unbiased::roulette::LightModel;
use unbiased::trade::figures;
use unbiased::trade::{Comparison, Measured, Nature, Rival, Trade};
use unbiased::workbook::{self, Answer, Appendix, Contents, Options, Table};
use unbiased::{Budget, Error, Estimator, Result, from_fn};

/// A comparison, with what is estimated and the question that it belongs to.
struct Compared {
    question: &'static str,
    what: String,
    found: Comparison,
}

/// How rivals are compared.
#[derive(Clone, Copy)]
struct Judge {
    seed: u64,
    seconds: f64,
}

impl Judge {
    /// The truth is given with its std error, if it is an estimate.
    fn compare(
        self,
        question: &'static str,
        what: impl Into<String>,
        [truth, truth_error]: [f64; 2],
        rivals: &[Rival<'_>],
    ) -> Result<Compared> {
        let trade = Trade::new(self.seed, truth)?.seconds_each(self.seconds)?;
        let trade = if truth_error > 0.0 { trade.known_to(truth_error)? } else { trade };
        Ok(Compared { question, what: what.into(), found: trade.compare(rivals)? })
    }
}

fn unbiased(variance: f64) -> Nature {
    if variance.is_finite() { Nature::Unbiased } else { Nature::InfiniteVariance }
}

/// The appendix that answers it.
pub const APPENDIX: Appendix = Appendix {
    example: "trade",
    title: "What does a second buy?",
    about: "What does a second buy? The workbook's rival estimators, compared by variance and time on one \
            core of this machine.",
    seconds: Some("seconds for each estimator (0.03)"),
    why: "it compares estimators on one core, for --seconds S each, and has no student edition and no hint",
    make,
};

fn make(options: &Options) -> Result<Contents> {
    let seconds = if let Some(Budget::Time(time)) = options.budget { time.as_secs_f64() } else { 0.03 };
    let judge = Judge { seed: options.seed, seconds };

    let directions =
        [0.0, 1.0, 10.0, -0.5, -0.9].map(|a| directions(a, judge)).into_iter().collect::<Result<Vec<_>>>()?;
    let points = points(judge)?;
    let endings = endings(judge)?;
    let (ways, all) = (ways_to_the_light(judge)?, all_bounces(judge)?);
    let (logarithms, precisions) = (logarithms(judge)?, precisions(judge)?);
    let placements = placements(judge)?;

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
    let placed = |bounces: &str| placements.iter().find(|of| of.what.starts_with(bounces));
    let drawn = [
        ("trade_light", "Light found by chance or sampled: draws, rays and seconds", Some(&ways)),
        ("trade_endings", "Roulette keeps improving where truncation levels off", Some(&endings)),
        ("trade_placed_2", "Up to 2 bounces, independent and placed", placed("k ≤ 2,")),
        ("trade_placed_15", "Up to 15 bounces, independent and placed", placed("k ≤ 15,")),
    ];
    let drawn = drawn.into_iter().filter_map(|(name, title, of)| Some((name, title, &of?.found)));
    let figures = drawn.map(|(name, title, found)| figures::comparison(name, title, found));
    let figures = figures.collect::<Result<_>>()?;
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
    Ok(Contents {
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

fn directions(a: f64, judge: Judge) -> Result<Compared> {
    let (surface, light) = (Lambertian::new(0.8)?, CosinePower::new(a)?);
    let rivals = [Uniform, Cosine].map(|density| {
        let name = format!("a = {a}: {density:?}").to_lowercase();
        let estimator = surface.estimator(move |w| light.incoming(w), density);
        Rival::new(name, estimator).nature(unbiased(light.variance(surface, density)))
    });
    let what = format!("light reflected under cos^a θ, a = {a}");
    judge.compare("3.6", what, [light.reflected(surface), 0.0], &rivals)
}

/// Points in the plane: independent pairs, all pairs, jittered and Sobol, over the test set and Genz's
/// families.
fn points(judge: Judge) -> Result<Vec<Compared>> {
    let mut found = Vec::new();
    for f in [Integrand::Paraboloid, Integrand::Gaussian, Integrand::Disc, Integrand::InverseDistance] {
        let square = Rectangle::WORKSHEET;
        let nature = unbiased(f.variance(&square).unwrap_or_default());
        let rivals = ways_to_place(square, move |x, y| f.at(x, y), nature)?;
        let truth = f.integral(&square).unwrap_or(f64::NAN);
        found.push(judge.compare("2.1", f.formula(), [truth, 0.0], &rivals)?);
    }
    for family in Family::ALL {
        let genz = Genz::new(family, [5.0, 3.0], [0.3, 0.6])?;
        let square = Rectangle::new([0.0, 1.0], [0.0, 1.0])?;
        let what =
            format!("Genz: {family:?}").to_lowercase().replace("genz", "Genz").replace("peak", " peak");
        let rivals = ways_to_place(square, move |x, y| genz.at(x, y), Nature::Unbiased)?;
        found.push(judge.compare("2.1", what, [genz.integral(), 0.0], &rivals)?);
    }
    Ok(found)
}

fn ways_to_place(
    square: Rectangle,
    f: impl Fn(f64, f64) -> f64 + Sync + Copy + 'static,
    nature: Nature,
) -> Result<[Rival<'static>; 6]> {
    let rivals = [
        Rival::new("independent", square.independent(f)),
        Rival::new("all pairs, 64²", square.all_pairs(f, 64)?),
        Rival::new("jittered, 8²", square.jittered(f, 8)?).series("jittered"),
        Rival::new("jittered, 64²", square.jittered(f, 64)?).series("jittered"),
        Rival::new("Sobol, 64", square.sobol(f, 64)?).series("Sobol"),
        Rival::new("Sobol, 4096", square.sobol(f, 4096)?).series("Sobol"),
    ];
    Ok(rivals.map(|rival| rival.nature(nature)))
}

fn endings(judge: Judge) -> Result<Compared> {
    let model = LightModel::new(0.8, 0.5)?;
    let mut rivals = Vec::new();
    for q in [0.8, model.optimum(), 0.7, 0.2] {
        let paths = model.roulette(q)?;
        let nature = unbiased(paths.variance());
        rivals.push(Rival::new(format!("roulette, q = {q:.3}"), paths).nature(nature));
    }
    for max_k in [8, 16] {
        let paths = model.truncated(max_k)?;
        rivals.push(Rival::new(format!("cut after k ≤ {max_k}"), paths).nature(Nature::Biased));
    }
    judge.compare("5.3", "light along a path, ρ = 0.8, v = 0.5", [model.mean(), 0.0], &rivals)
}

/// The radiance after one bounce, and after two.
fn few_bounces(room: &BoxRoom) -> [f64; 2] {
    [room.one_bounce(), room.two_bounces().unwrap_or(f64::NAN)]
}

fn ways_to_the_light(judge: Judge) -> Result<Compared> {
    let room = BoxRoom::new(Scene::default())?;
    let paths = |directions, light| Paths::new(room, Bounces::UpTo(2), directions, light);
    let rivals = [
        Rival::new("sampled, cosine", paths(Cosine, FindLight::BySampling)?),
        Rival::new("sampled, uniform", paths(Uniform, FindLight::BySampling)?),
        Rival::new("by chance, cosine", paths(Cosine, FindLight::ByChance)?),
        Rival::new("by chance, uniform", paths(Uniform, FindLight::ByChance)?),
    ];
    let truth = few_bounces(&room).iter().sum();
    judge.compare("4.3", "up to two bounces, the light found", [truth, 0.0], &rivals)
}

fn all_bounces(judge: Judge) -> Result<Compared> {
    let room = BoxRoom::new(Scene::default())?;
    let paths = |bounces| Paths::new(room, bounces, Cosine, FindLight::BySampling);
    let rivals = [
        Rival::new("roulette by throughput", paths(Bounces::AllByThroughput)?),
        Rival::new("roulette, q = 0.8", paths(Bounces::All(0.8))?),
        Rival::new("roulette, q = 0.7", paths(Bounces::All(0.7))?),
        Rival::new("up to 2 bounces", paths(Bounces::UpTo(2))?).nature(Nature::Biased),
        Rival::new("up to 6 bounces", paths(Bounces::UpTo(6))?).nature(Nature::Biased),
    ];
    judge.compare("4.3", "all bounces (the truth is an estimate)", ALL_LIGHT, &rivals)
}

/// The radiance of all bounces in the sheet's scene, with its std error, as no closed form is known: from 10⁹
/// paths of up to ten bounces (cosine directions, the light sampled), and 2·10⁶ paths for what bounces 11 to
/// 40 add.
const ALL_LIGHT: [f64; 2] = [0.3553311, 1.5e-6];

/// The accurate logarithm against the fast one, which is accurate to 1 ulp and is vectorized.
fn logarithms(judge: Judge) -> Result<Compared> {
    let exponential = Exponential::new(0.37)?;
    let rate = exponential.rate();
    let rivals = [
        Rival::new("fast logarithm, many at a time", exponential),
        Rival::new("ln, one draw at a time", from_fn(move |rng| -(1.0 - rng.uniform()).ln() / rate)),
        Rival::new("ln_1p, one draw at a time", from_fn(move |rng| -(-rng.uniform()).ln_1p() / rate)),
    ];
    judge.compare("1.1", "mean of an exponential, λ = 0.37", [exponential.mean(), 0.0], &rivals)
}

fn precisions(judge: Judge) -> Result<Compared> {
    let room = BoxRoom::new(Scene::default())?;
    let paths = Paths::new(room, Bounces::UpTo(2), Cosine, FindLight::BySampling)?;
    let rivals = [
        Rival::new("f32, many at a time", paths.in_f32()?),
        Rival::new("f64, many at a time", paths),
        Rival::new("f64, one path after the other", from_fn(move |rng| paths.draw(rng))),
    ];
    let truth = few_bounces(&room).iter().sum();
    judge.compare("4.3", "up to two bounces, in two precisions", [truth, 0.0], &rivals)
}

/// The question, what is estimated, the estimator, and the truth with its error.
type Placeable = (&'static str, &'static str, Box<dyn Estimator>, [f64; 2]);

/// Independent numbers against jittered and Sobol ones, from a function of two numbers to paths of fifteen
/// bounces. A jump in the integrand, and every further bounce, reduce the gain.
fn placements(judge: Judge) -> Result<Vec<Compared>> {
    let surface = Lambertian::new(0.8)?;
    let (smooth, ring) = (CosinePower::new(1.0)?, RingLight::new(0.1)?);
    let model = LightModel::new(0.8, 0.5)?;
    let room = BoxRoom::new(Scene::default())?;
    let up_to = |most| Paths::new(room, Bounces::UpTo(most), Cosine, FindLight::BySampling);
    let [once, twice] = few_bounces(&room);
    let under_smooth = surface.cosine_estimator(move |w| smooth.incoming(w));
    let under_half = surface.cosine_estimator(|w| if w.vector().x > 0.0 { 1.0 } else { 0.0 });
    let under_ring = surface.cosine_estimator(move |w| ring.incoming(w));
    let known = reflected(room, Cosine, move |p_j, _| room.direct(p_j));
    let compared: [Placeable; 9] = [
        ("3.5", "cos θ", Box::new(under_smooth), [smooth.reflected(surface), 0.0]),
        ("3.5", "half the sky", Box::new(under_half), [0.4, 0.0]),
        ("3.5", "a ring", Box::new(under_ring), [ring.reflected(surface), 0.0]),
        ("5.3", "the model, q = 0.8", Box::new(model.roulette(0.8)?), [model.mean(), 0.0]),
        ("4.3", "k ≤ 1", Box::new(up_to(1)?), [once, 0.0]),
        ("4.3", "k = 2, L_o(p_j) known", Box::new(known), [twice, 0.0]),
        ("4.3", "k ≤ 2", Box::new(up_to(2)?), [once + twice, 0.0]),
        ("4.3", "k ≤ 3", Box::new(up_to(3)?), UP_TO_3),
        ("4.3", "k ≤ 15", Box::new(up_to(15)?), UP_TO_15),
    ];
    let mut found = Vec::new();
    for (question, what, estimator, truth) in compared {
        let rivals = [
            Rival::new(format!("independent: {what}"), &*estimator),
            Rival::new(format!("jittered 64²: {what}"), jittered(&*estimator, 64)?),
            Rival::new(format!("Sobol 4096: {what}"), sobol(&*estimator, 4096)?),
        ];
        found.push(judge.compare(question, format!("{what}, placed numbers"), truth, &rivals)?);
    }
    Ok(found)
}

/// Estimates and their std errors, as no closed form is known: 20,000 and 3,000 sets of 65,536 Sobol points
/// (cosine directions, the light sampled).
const UP_TO_3: [f64; 2] = [0.335_016_21, 2.4e-7];
const UP_TO_15: [f64; 2] = [0.355_326_94, 9.1e-7];

fn table<'a>(caption: &str, comparisons: impl IntoIterator<Item = &'a Compared>) -> Table {
    let comparisons: Vec<&Comparison> = comparisons.into_iter().map(|compared| &compared.found).collect();
    let columns = comparisons.first().map_or(Vec::new(), |first| first.columns());
    Table::new(caption, columns, comparisons.into_iter().flat_map(Comparison::rows))
}

/// One row per integrand: how fast the error of each way falls with n, and which way reaches 0.1 % first.
fn points_table(points: &[Compared]) -> Table {
    let rows = points.iter().map(|Compared { what, found, .. }| {
        let slope =
            |rival| found.slope(rival).map_or(String::new(), |slope| format!("{slope:.2}").replace('-', "−"));
        let mut cells = vec![what.clone()];
        if let [independent, pairs, _, jittered, _, sobol] = &found.rivals[..] {
            let to = |rival: &Measured| rival.seconds_to(1e-3).to_string();
            cells.extend([jittered, sobol].map(slope));
            cells.extend([independent, pairs, jittered, sobol].map(to));
        }
        let infinite = found.rivals.iter().any(|rival| rival.nature == Nature::InfiniteVariance);
        let ranking = found.ranking();
        let best: Vec<_> =
            ranking.iter().filter(|place| place.rank == 1).map(|place| place.rival.name.as_str()).collect();
        cells.push(if infinite { "infinite variance: no valid error bar".into() } else { best.join(" or ") });
        cells
    });
    let columns = ["integrand", "slope, jittered", "slope, Sobol", "independent", "all pairs, 64²"];
    let columns = columns.into_iter().chain(["jittered, 64²", "Sobol, 4096", "most efficient"]);
    Table::new(
        "2.1: how the points are placed: slopes of the error in n (−½ for independent points), and seconds \
         to 0.1 %, at least those of one draw, which is a whole replicate. The most efficient way, or any \
         not told apart from it, need not be the fastest to 0.1 %: a replicate may already be more \
         accurate",
        columns,
        rows,
    )
}

/// All comparisons, one below the other.
fn csv(compared: &[Compared]) -> String {
    let mut csv = String::new();
    for Compared { question, what, found } in compared {
        let rows = found.csv();
        let mut lines = rows.lines();
        let head = lines.next().unwrap_or_default();
        if csv.is_empty() {
            csv = format!("question,what,{head}\n");
        }
        csv.extend(lines.map(|line| format!("{question},\"{what}\",{line}\n")));
    }
    csv
}

fn records(Compared { question, what, found }: &Compared) -> Vec<Answer> {
    let ranking = found.ranking();
    let record = |rival: &Measured| {
        let place = ranking.iter().find(|place| std::ptr::eq(place.rival, rival));
        let what = format!("{what}: {}", rival.name);
        record(Answer::new(question, &what).measured(rival, found.seed), rival, place.map(|place| place.rank))
    };
    found.rivals.iter().map(record).collect()
}

/// A rival's record; null is infinite, never reached, or unknown.
fn record(answer: Answer, rival: &Measured, rank: Option<usize>) -> Answer {
    // 0 or 1
    let flag = |flag: bool| Value::Limit(Some(flag.into()));
    let biased = rival.nature == Nature::Biased;
    let of_bias = |number: f64| if biased { number } else { f64::NAN };
    let [low, high] = rival.seconds_range;
    let mut record = answer
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
        .parameter("rank", rank.map_or(f64::NAN.into(), |rank| Value::Limit(u32::try_from(rank).ok())));
    for error in [1e-2, 1e-3, 1e-4, 1e-5] {
        let name = format!("seconds_to_{error:e}");
        record = record.parameter(&name, rival.seconds_to(error).seconds().unwrap_or(f64::NAN));
    }
    if rival.nature == Nature::Unbiased { record } else { record.demonstration() }
}

#[allow(dead_code)] // the worksheet takes this file in as a module
fn main() -> ExitCode {
    workbook::appendix(&APPENDIX)
}
