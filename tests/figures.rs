//! The figures of section 4, and what is said of them: paths that can be told apart, values that are what
//! they are called, and rows that own up to having found nothing.
#![cfg(feature = "workbook")]

mod common;

use std::path::Path;
use std::process::Command;

use proptest::prelude::*;
use unbiased::Error;
use unbiased::inversion::Exponential;
use unbiased::lambertian::hemisphere::Hemisphere::{Cosine, Uniform};
use unbiased::paths::room::{BoxRoom, Scene};
use unbiased::paths::{Bounces, FindLight, Paths};
use unbiased::plot::{Edition, Figure};
use unbiased::rectangle::Rectangle;
use unbiased::roulette::LightModel;
use unbiased::{inversion, lambertian, paths, rectangle, roulette, workbook};

fn paths(scene: Scene, bounces: Bounces, light: FindLight) -> Paths {
    Paths::new(BoxRoom::new(scene).unwrap(), bounces, Cosine, light).unwrap()
}

/// The rows of a series in the CSV: x, y, low, high, with NaN for an empty cell.
fn series(figure: &Figure, name: &str) -> Vec<[f64; 4]> {
    let quoted = if name.contains(',') { format!(",\"{name}\",") } else { format!(",{name},") };
    let rows = figure.csv().lines().filter_map(|line| {
        let (_, cells) = line.split_once(&quoted)?;
        let cells: Vec<f64> = cells.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
        Some([cells[0], cells[1], cells[2], cells[3]])
    });
    rows.collect()
}

/// A tag's attribute.
fn attribute<'a>(tag: &'a str, name: &str) -> &'a str {
    let (_, from) = tag.split_once(&format!(" {name}=\"")).unwrap();
    from.split_once('"').unwrap().0
}

/// Texts of a figure that stand in the middle of their place, and a box about each that is smaller than the
/// ink: its middle, and half its width and height.
fn texts(figure: &Figure) -> Vec<(String, [f64; 4])> {
    let tags = figure.svg().split("<text").skip(1);
    let boxes = tags.filter_map(|tag| {
        let (tag, rest) = tag.split_once('>')?;
        let text = rest.split_once("</text>")?.0.trim().to_string();
        let number = |name: &str| attribute(tag, name).parse::<f64>().unwrap();
        let size = number("font-size");
        let half = 0.25 * size * text.chars().count() as f64;
        (attribute(tag, "text-anchor") == "middle" && !tag.contains("transform"))
            .then(|| (text, [number("x"), number("y"), half, 0.3 * size]))
    });
    boxes.collect()
}

/// That paths are drawn as they should be, and as many as the title says.
fn assert_drawn(paths: &Paths, bounces: usize, seed: u64) -> usize {
    let [student, solved] = paths::figures::paths_drawn(paths, 3, seed).unwrap();
    let mut drawn = 0;
    let mut vertices: Vec<[f64; 2]> = Vec::new();
    for number in ["①", "②", "③"] {
        let line: Vec<[f64; 2]> =
            series(&solved, &format!("path {number}")).iter().map(|row| [row[0], row[1]]).collect();
        assert!(series(&student, &format!("path {number}")).is_empty() && !student.svg().contains(number));
        if line.is_empty() {
            continue;
        }
        drawn += 1;
        // p, a point a bounce after it, and the light
        assert_eq!(line.len(), bounces + 1);
        assert_eq!(line[bounces][1], 4.0);
        for [x, z] in &line[1..bounces] {
            // on a face seen edge on: of the room, or of the cube
            let on_room = x.abs() == 2.0 || *z == 0.0 || *z == 4.0;
            assert!(on_room || (x.abs() == 0.5 && *z <= 1.0) || (x.abs() <= 0.5 && *z == 1.0), "{line:?}");
            for [a, b] in &vertices {
                assert!((x - a).hypot(z - b) > 0.5, "{line:?}");
            }
        }
        vertices.extend(&line[1..bounces]);
        for corner in line.windows(3) {
            let way = |to: usize| [corner[to][0] - corner[1][0], corner[to][1] - corner[1][1]];
            let [[x, y], [u, v]] = [way(0), way(2)];
            let angle = (x * v - y * u).atan2(x * u + y * v).abs().to_degrees();
            assert!(angle > 19.0, "{angle}° at {corner:?}");
        }
        for pair in line.windows(2) {
            for i in 0..=1000 {
                let t = f64::from(i) / 1000.0;
                let [x, z] = [0, 1].map(|axis| pair[0][axis] + t * (pair[1][axis] - pair[0][axis]));
                // a chord of the silhouette between two of the points that the drawing looks at is shorter
                // than 0.03
                assert!(x.abs() > 0.485 || z > 0.985, "through the cube: {line:?}");
            }
        }
    }
    let count = ["No", "One", "Two", "Three"][drawn];
    assert!(solved.title().starts_with(&format!("{count} sampled path")), "{} of {drawn}", solved.title());
    for word in ["ω", "path ", ">n<"] {
        assert!(!student.svg().contains(word) && !student.csv().contains(word));
    }
    drawn
}

#[test]
fn the_sheets_scene_shows_three_paths_of_two_and_of_three_bounces() {
    for seed in 1..=6 {
        for (bounces, name) in [(2, "4_1_paths"), (3, "4_2_paths")] {
            let paths = paths(Scene::default(), Bounces::Exactly(bounces), FindLight::BySampling);
            assert_eq!(assert_drawn(&paths, bounces as usize, seed), 3, "{bounces} bounces, seed {seed}");
            let [_, solved] = paths::figures::paths_drawn(&paths, 3, seed).unwrap();
            assert_eq!(solved.name(), name);
            let texts = texts(&solved);
            assert!(texts.len() >= 12, "{texts:?}");
            for (i, (text, [x, y, half, high])) in texts.iter().enumerate() {
                for (other, [a, b, half_of_other, high_of_other]) in &texts[..i] {
                    let apart =
                        (x - a).abs() >= half + half_of_other || (y - b).abs() >= high + high_of_other;
                    assert!(apart, "{text} on {other}, {bounces} bounces, seed {seed}");
                }
            }
        }
    }
}

#[test]
fn paths_are_drawn_from_where_p_is_seen_beside_the_cube() {
    for (point, across) in [
        ([0.0, -0.5, 0.5], "from the east, along x"),
        ([0.2, 0.5, 0.3], "from the east, along x"),
        ([0.0, 1.5, 0.0], "from the east, along x"),
        ([0.0, 2.0, 3.0], "from the east, along x"),
        ([0.5, 0.0, 0.5], "from the south, along y"),
        ([1.5, 0.0, 0.0], "from the south, along y"),
        ([2.0, 2.0, 4.0], "from the south, along y"),
    ] {
        let scene = Scene { point, ..Scene::default() };
        for bounces in [2, 3] {
            let paths = paths(scene, Bounces::Exactly(bounces), FindLight::BySampling);
            assert!(assert_drawn(&paths, bounces as usize, 1) >= 1, "{point:?}, {bounces} bounces");
            let [student, solved] = paths::figures::paths_drawn(&paths, 3, 1).unwrap();
            assert!(student.svg().contains(across) && solved.svg().contains(across), "{point:?}");
        }
    }
}

#[test]
fn paths_up_to_a_number_and_those_that_find_light_by_chance_are_drawn_whole() {
    let up_to = paths(Scene::default(), Bounces::UpTo(3), FindLight::BySampling);
    assert_eq!(assert_drawn(&up_to, 3, 1), 3);
    let large = Scene { light_half_width: 1.5, ..Scene::default() };
    assert!(assert_drawn(&paths(large, Bounces::Exactly(2), FindLight::ByChance), 2, 1) >= 2);
    assert!(assert_drawn(&paths(large, Bounces::UpTo(3), FindLight::ByChance), 3, 1) >= 2);
}

#[test]
fn what_cannot_be_drawn_is_refused_or_said() {
    for (bounces, most) in [
        (Bounces::Exactly(0), 0),
        (Bounces::Exactly(1), 1),
        (Bounces::Exactly(5), 5),
        (Bounces::UpTo(64), 64),
        (Bounces::All(0.8), u64::from(u32::MAX)),
        (Bounces::AllByThroughput, u64::from(u32::MAX)),
    ] {
        let refused =
            paths::figures::paths_drawn(&paths(Scene::default(), bounces, FindLight::BySampling), 3, 1);
        assert!(matches!(refused, Err(Error::Count { value, .. }) if value == most), "{bounces:?}");
    }
    let sheet = Scene::default();
    for dark in [
        Scene { wall_albedo: 0.0, ..sheet },
        Scene { cube_albedo: 0.0, ..sheet },
        Scene { radiance: 0.0, ..sheet },
        Scene { light_half_width: 0.0, ..sheet },
    ] {
        let [_, solved] =
            paths::figures::paths_drawn(&paths(dark, Bounces::Exactly(2), FindLight::BySampling), 3, 1)
                .unwrap();
        assert_eq!(solved.title(), "No sampled paths of two bounces");
        assert!(solved.svg().contains("No light leaves p after that many bounces"));
    }
}

proptest! {
    #![proptest_config(common::config(24))]
    #[test]
    fn wherever_p_is_what_is_drawn_is_right(
        face in 0usize..11, u in 0.0f64..=1.0, v in 0.0f64..=1.0, half_width in 0.0f64..=2.0, seed: u64,
    ) {
        let face = unbiased::paths::room::Face::ALL[face];
        let [low, high] = common::bounds(face);
        let at = |t: [f64; 3]| [low.x + t[0] * (high.x - low.x), low.y + t[1] * (high.y - low.y),
            low.z + t[2] * (high.z - low.z)];
        let point = if low.x == high.x { at([0.0, u, v]) } else if low.y == high.y { at([u, 0.0,
            v]) } else { at([u, v, 0.0]) };
        // under the cube, or on the light
        let Ok(room) = BoxRoom::new(Scene { point, light_half_width: half_width,
            ..Scene::default() }) else { return Ok(()) };
        for bounces in [2u32, 3] {
            let paths = Paths::new(room, Bounces::Exactly(bounces), Cosine, FindLight::BySampling).unwrap();
            assert_drawn(&paths, bounces as usize, seed);
        }
    }
}

/// The worksheet's cumulative values, 0.33502 − 0.31276 (±0.00001 each), and the figure's own 95 % interval,
/// ±0.000012: an alarm that is false has 1e-9. A bias of 0.3 % would be seen.
#[test]
fn the_third_bar_is_what_two_other_programs_found() {
    let figure = paths::figures::radiance_by_bounces(&BoxRoom::new(Scene::default()).unwrap(), 1).unwrap();
    assert_eq!(figure.title(), "Each bounce adds less");
    assert_eq!(series(&figure, "exact").len(), 2);
    let found = series(&figure, "estimated");
    let [k, mean, low, high] = *found.iter().rfind(|row| row[0] == 3.0).unwrap();
    assert!(k == 3.0 && (high - low) / mean <= 2e-3);
    assert!((mean - 22.26).abs() <= 2.0 * 0.01 + 3.1 * 0.5 * (high - low), "{mean}");
    assert!(figure.svg().contains("k = 1, 2: exact"));
}

#[test]
fn bars_are_called_exact_where_they_are() {
    let room = BoxRoom::new(Scene { point: [2.0, 2.0, 4.0], wall_albedo: 0.99, ..Scene::default() }).unwrap();
    let figure = paths::figures::radiance_by_bounces(&room, 1).unwrap();
    // the ceiling gets no light at once, so the second bounce adds more than the first
    assert_ne!(figure.title(), "Each bounce adds less");
    assert!(figure.svg().contains("k = 1: exact") && !figure.svg().contains("k = 1, 2"));
    assert!(series(&figure, "exact").is_empty(), "no bar of height 0");
    assert_eq!(series(&figure, "estimated").len(), 14);
}

/// Each root mean square error is of 100 means, so its relative error is 1/√200, 7 %; a reference that is off
/// by a tenth of the truth leaves 10 % at n = 1,024, where there should be 5 %.
#[test]
fn all_light_falls_to_its_truth_where_hardly_anything_is_absorbed() {
    let room = BoxRoom::new(Scene { wall_albedo: 0.99, ..Scene::default() }).unwrap();
    let figures = paths::figures::path_errors(&room, 1).unwrap();
    assert!(series(&figures[0], "roulette q = 0.8").is_empty(), "its variance may be infinite");
    // the points come before the line
    let by_throughput = series(&figures[0], "roulette by throughput");
    let [[_, few, ..], _, [_, many, ..], ..] = by_throughput[..] else { panic!("{by_throughput:?}") };
    let ratio = few / many;
    assert!((4.0..16.0).contains(&ratio), "from 16 to 1,024 paths the error falls by 8, not by {ratio}");
}

#[test]
fn where_nothing_ends_a_path_all_light_is_left_out() {
    let room = BoxRoom::new(Scene { wall_albedo: 1.0, ..Scene::default() }).unwrap();
    let figures = paths::figures::path_errors(&room, 1).unwrap();
    assert!(!series(&figures[0], "sampled, cosine").is_empty());
    assert!(series(&figures[0], "k ≤ 4").is_empty());
    assert!(figures[0].svg().contains("All light is left out"));
}

#[test]
fn the_words_on_a_sum_in_f32_are_its_numbers() {
    let figure = workbook::extremes::running_mean_errors(1).unwrap();
    let errors: Vec<f64> = series(&figure, "f32").iter().map(|row| 100.0 * row[1]).collect();
    let worst = errors.iter().fold(0.0, |worst: f64, error| worst.max(*error));
    let words = format!("reaches {worst:.1} %, and is {:.1} % at the end", errors[errors.len() - 1]);
    assert!(figure.svg().contains(&words), "{words}");
}

#[test]
fn a_row_in_which_no_path_found_the_light_is_no_answer() {
    let tests = std::env::current_exe().unwrap();
    let program = |name| tests.parent().and_then(Path::parent).unwrap().join("examples").join(name);
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join("dark");
    for (example, arguments, found_none) in [
        ("q4_2_three_bounces", &["--light-half-width", "1e-9"][..], 1),
        ("q4_2_three_bounces", &["--light-half-width", "1e-9", "--point", "1.5,0,0"], 1),
        // nothing is there to be found
        ("q4_2_three_bounces", &["--light-half-width", "0"], 0),
        ("q4_2_three_bounces", &["--wall-albedo", "0"], 0),
        ("q4_2_three_bounces", &["--radiance", "0"], 0),
        ("q4_3_paths", &["--light-half-width", "1e-9", "--bounces", "3"], 2),
    ] {
        let output = Command::new(program(example))
            .args(arguments)
            .args(["--draws", "10000", "--json", "--out", out.to_str().unwrap()])
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let rows: Vec<serde_json::Value> = output
            .stdout
            .split(|byte| *byte == b'\n')
            .filter_map(|line| serde_json::from_slice(line).ok())
            .collect();
        let none = rows.iter().filter(|row| row["estimate"] == 0.0 && row["kind"] == "demonstration").count();
        assert_eq!(none, found_none, "{example} {arguments:?}");
        let zeros = rows.iter().filter(|row| row["estimate"] == 0.0 && row["kind"] == "answer").count();
        assert_eq!(zeros, if found_none == 0 { 2 } else { 0 }, "{example} {arguments:?}");
    }
}

/// Every text of a figure with a box about it, a little smaller than its ink: its middle, and half its width
/// and height.
fn boxes(figure: &Figure) -> Vec<(String, [f64; 4])> {
    let narrow = "₀₁₂₃₄₅₆₇₈₉ₒᵢⱼ′⁰¹²³⁴⁵⁶⁷⁸⁹⁻.,|il()1 ";
    let of = |tag: &str| {
        let (tag, rest) = tag.split_once('>')?;
        let text = rest.split_once("</text>")?.0.trim().to_string();
        let number = |name: &str| attribute(tag, name).parse::<f64>().unwrap();
        let (size, [x, y]) = (number("font-size"), ["x", "y"].map(number));
        let half = text.chars().map(|c| if narrow.contains(c) { 0.14 } else { 0.25 }).sum::<f64>() * size;
        let x = match attribute(tag, "text-anchor") {
            "start" => x + half,
            "end" => x - half,
            _ => x,
        };
        let y = match attribute(tag, "dy") {
            "0.76em" => y + 0.4 * size,
            "0.5ex" => y,
            _ => y - 0.4 * size,
        };
        let turned = tag.contains("rotate");
        (!text.is_empty() && !turned).then_some((text, [x, y, half, 0.3 * size]))
    };
    figure.svg().split("<text").skip(1).filter_map(of).collect()
}

/// That a figure reads: no text on another or outside, no number that is none, a white ground.
fn assert_legible(figure: &Figure, why: &str) {
    let (name, svg) = (figure.name(), figure.svg());
    let (_, drawn) = svg.split_once("</desc>").unwrap();
    let said: Vec<String> = boxes(figure).into_iter().map(|(text, _)| text).collect();
    for text in &said {
        let zero = text.strip_prefix(['-', '−']).is_some_and(|size| size.parse() == Ok(0.0));
        assert!(
            !zero && !text.contains("NaN") && !text.contains("inf ") && text != "inf",
            "{name}, {why}: {text}"
        );
    }
    assert!(!drawn.contains("=\"NaN") && !drawn.contains("2147483"), "{name}, {why}");
    assert!(svg.contains("<rect width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>"), "{name}");
    assert!(svg.contains("DejaVu Sans"), "{name}");
    let view = attribute(svg.split_once('>').unwrap().0, "viewBox").split(' ');
    let view: Vec<f64> = view.map(|number| number.parse().unwrap()).collect();
    let boxes = boxes(figure);
    for (i, (text, [x, y, half, high])) in boxes.iter().enumerate() {
        let inside = x - half >= -1.0 && x + half <= view[2] && y - high >= -1.0 && y + high <= view[3];
        assert!(inside, "{name}, {why}: “{text}” at {x}, {y} leaves {view:?}");
        for (other, [a, b, half_of_other, high_of_other]) in &boxes[..i] {
            let apart = (x - a).abs() >= half + half_of_other || (y - b).abs() >= high + high_of_other;
            assert!(apart, "{name}, {why}: “{text}” on “{other}”");
        }
    }
    for line in figure.csv().lines() {
        assert!(!line.contains("NaN"), "{name}, {why}: {line}");
    }
}

/// That a figure reads, or is refused in a sentence.
fn assert_drawn_or_refused(figure: unbiased::Result<Figure>, why: &str) {
    match figure {
        Ok(figure) => assert_legible(&figure, why),
        Err(error) => {
            let sentence = error.to_string();
            let told = ["finite draws"].iter().any(|words| sentence.contains(words));
            assert!(
                told || sentence.contains(" must ") || sentence.contains("could not be drawn"),
                "{why}: {sentence}"
            );
        }
    }
}

const SCALES: [f64; 14] =
    [5e-324, 1e-310, 1e-290, 1e-100, 1e-9, 1e-4, 0.003, 0.3, 1.0, 7.5, 1e4, 123_456.789, 1e12, 1e300];

#[test]
fn figures_of_the_exponential_read_at_every_scale() {
    for rate in SCALES {
        let exponential = Exponential::new(rate).unwrap();
        for u in [0.0, 1e-300, 1e-6, 0.05, 0.2, 0.3, 0.5, 0.6321, 0.75, 0.9, 0.97, 0.9999, 1.0 - 1e-12, 1.0] {
            let drawn = |edition| inversion::figures::exponential(&exponential, u, edition);
            assert_drawn_or_refused(drawn(Edition::Solution), &format!("λ = {rate:e}, u = {u}"));
            assert_drawn_or_refused(drawn(Edition::Student), &format!("λ = {rate:e}, u = {u}"));
            assert_eq!(drawn(Edition::Solution).is_ok(), (1e-290..=1e290).contains(&rate));
        }
        for draws in [1, 200] {
            let why = format!("λ = {rate:e}, {draws} draws");
            assert_drawn_or_refused(inversion::figures::empirical_cdf(&exponential, draws, 1), &why);
        }
        assert_drawn_or_refused(
            inversion::figures::tails(&exponential, 1 << 10, 1),
            &format!("λ = {rate:e}"),
        );
    }
    let drawn =
        inversion::figures::exponential(&Exponential::new(1e4).unwrap(), 0.75, Edition::Solution).unwrap();
    for text in ["U = 0.75", "≈ 0.000139", "x (10⁻⁴)", "p(x) = 2500"] {
        assert!(drawn.svg().contains(text), "{text}");
    }
}

#[test]
fn figures_of_the_rectangle_read_at_every_scale() {
    for half in [1e-100, 1e-9, 1e-3, 0.5, 2.0, 30.0, 1e6, 1e100] {
        for [x, y] in [[[-half, half], [-half, half]], [[0.0, half], [0.25 * half, 3.0 * half]]] {
            let rectangle = Rectangle::new(x, y).unwrap();
            let why = format!("{x:?} × {y:?}");
            assert_drawn_or_refused(rectangle::figures::sampling_errors(rectangle, 1), &why);
            assert_drawn_or_refused(rectangle::figures::running_means(rectangle, 1), &why);
        }
    }
}

#[test]
fn figures_of_directions_and_bounces_read_whatever_is_drawn() {
    assert_legible(&lambertian::figures::integrand().unwrap(), "");
    for hemisphere in [Uniform, Cosine] {
        for count in [0, 1, 600] {
            assert_legible(
                &lambertian::figures::directions(hemisphere, count, 1).unwrap(),
                &format!("{count} directions"),
            );
        }
    }
    for draws in [2, 10_000] {
        let why = format!("{draws} draws");
        assert_drawn_or_refused(lambertian::figures::variance_against_exponent(draws, 1), &why);
        assert_drawn_or_refused(lambertian::figures::variance_against_ring(draws, 1), &why);
        assert_drawn_or_refused(roulette::figures::mean_bounces([0.8, 0.2], draws, 1), &why);
        assert_drawn_or_refused(paths::figures::occluded_fraction(draws, 1), &why);
    }
    for p in [1e-300, 1e-6, 0.2, 0.5, 0.8, 0.83, 0.987_654_321, 0.9999, 1.0 - 1e-9] {
        for draws in [1, 2000] {
            assert_drawn_or_refused(
                roulette::figures::bounces([p, 1.0 / 3.0], draws, 1),
                &format!("p_rr = {p}"),
            );
        }
    }
}

/// That no text of a figure lies on a line of it.
fn assert_off_lines(figure: &Figure, why: &str) {
    let boxes = boxes(figure);
    for line in figure.svg().split("<polyline").skip(1) {
        let points = attribute(line.split_once('>').unwrap().0, "points").split_whitespace();
        let points: Vec<[f64; 2]> = points
            .map(|point| point.split_once(',').unwrap())
            .map(|(x, y)| [x, y].map(|number| number.parse().unwrap()))
            .collect();
        for (pair, (text, [x, y, half, high])) in
            points.windows(2).flat_map(|pair| boxes.iter().map(move |text| (pair, text)))
        {
            // steps so small that none jumps over a box
            let steps = ((pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]) / high).ceil() as u32 + 1;
            let on = (0..=steps).map(|i| f64::from(i) / f64::from(steps)).any(|t| {
                let [a, b] = [0, 1].map(|axis| pair[0][axis] + t * (pair[1][axis] - pair[0][axis]));
                (a - x).abs() < *half && (b - y).abs() < *high
            });
            assert!(!on, "{}, {why}: “{text}” lies on a line", figure.name());
        }
    }
}

#[test]
fn figures_of_roulette_read_for_every_model() {
    for albedo in [0.0, 0.01, 1.0 / 3.0, 0.5, 0.8, 0.9, 0.99] {
        for visibility in [0.01, 0.2, 0.5, 1.0] {
            let model = LightModel::new(albedo, visibility).unwrap();
            for q in [0.01, 0.5, 6.0 / 7.0, 0.9, 0.99] {
                let why = format!("ρ = {albedo}, v = {visibility}, q = {q}");
                for figure in [
                    roulette::figures::roulette_trade(&model, q).unwrap(),
                    roulette::figures::truncation(&model, q, 8, 1, 1).unwrap(),
                ] {
                    assert_legible(&figure, &why);
                    assert_off_lines(&figure, &why);
                    assert!(boxes(&figure).len() > 8, "{why}: nothing is said");
                }
            }
        }
    }
    for p in [0.01, 0.1, 0.2, 0.5, 0.8, 0.9, 0.95, 0.99] {
        for beside in [0.01, 0.2, 0.79, 0.99] {
            let why = format!("p_rr = {p} and {beside}");
            let mean = roulette::figures::mean_bounces([p, beside], 1000, 1).unwrap();
            let bars = roulette::figures::bounces([p, beside], 1000, 1).unwrap();
            for figure in [&mean, &bars] {
                assert_legible(figure, &why);
                assert_off_lines(figure, &why);
            }
            let marked = boxes(&mean).iter().filter(|(text, _)| text.contains(" at ")).count();
            assert_eq!(marked, if p == beside { 1 } else { 2 }, "{why}");
        }
    }
    let mean = roulette::figures::mean_bounces([0.75, 0.2], 1000, 1).unwrap();
    assert!(mean.svg().contains("E[N] = 3 at 0.75") && mean.svg().contains("E[N] = 0.25 at 0.2"));
}

#[test]
fn figures_of_errors_read_in_every_room() {
    let sheet = Scene::default();
    for scene in [
        sheet,
        Scene { wall_albedo: 0.2, ..sheet },
        Scene { wall_albedo: 1.0, ..sheet },
        Scene { light_half_width: 0.1, ..sheet },
        Scene { point: [1.5, 0.0, 0.0], ..sheet },
    ] {
        for figure in paths::figures::path_errors(&BoxRoom::new(scene).unwrap(), 1).unwrap() {
            let why = format!("{scene:?}");
            assert_legible(&figure, &why);
            assert_off_lines(&figure, &why);
        }
    }
}

#[test]
fn a_slide_has_the_figure_below_its_title() {
    let room = BoxRoom::new(Scene::default()).unwrap();
    let model = LightModel::new(0.8, 0.5).unwrap();
    let column = roulette::figures::roulette_trade(&model, 0.8).unwrap();
    let page = rectangle::figures::sampling_errors(Rectangle::new([-2.0, 2.0], [-2.0, 2.0]).unwrap(), 1);
    let long = lambertian::figures::betting(1).unwrap();
    for (figure, width) in [(column, "85mm"), (page.unwrap(), "170mm"), (long, "170mm")] {
        assert_eq!(attribute(figure.svg(), "width"), width);
        let slide = figure.slide();
        let svg = slide.svg();
        assert_eq!(slide.name(), format!("{}_slide", figure.name()));
        assert_eq!((attribute(svg, "width"), attribute(svg, "height")), ("338.7mm", "190.5mm"));
        let numbers = |tag: &str| {
            let view = attribute(tag, "viewBox").split(' ').map(|number| number.parse().unwrap());
            view.collect::<Vec<f64>>()
        };
        let view = numbers(svg);
        assert_eq!(view[2] / view[3], 16.0 / 9.0);
        // every element is closed, in the order in which they were opened
        let mut open = Vec::new();
        for tag in svg.split('<').skip(1).map(|rest| rest.split_once('>').unwrap().0) {
            let name = tag.split([' ', '\n']).next().unwrap();
            if let Some(closed) = name.strip_prefix('/') {
                assert_eq!(open.pop(), Some(closed), "{tag}");
            } else if !tag.ends_with('/') {
                open.push(name);
            }
        }
        assert!(open.is_empty() && !svg.split('&').skip(1).any(|rest| !rest.contains(';')));
        let mut ids: Vec<_> =
            svg.split(" id=\"").skip(1).map(|rest| rest.split_once('"').unwrap().0).collect();
        let all = ids.len();
        ids.sort_unstable();
        ids.dedup();
        assert!(all >= 2 && ids.len() == all, "{ids:?}");
        // the title, in at most three lines above the figure, and inside
        let (head, drawn) = svg.split_once("</desc>").unwrap().1.split_once("<svg ").unwrap();
        let lines = head.split("</text>").filter_map(|line| line.split_once("<text")?.1.split_once('>'));
        let lines: Vec<(&str, &str)> = lines.collect();
        let title = lines.iter().map(|(_, text)| *text).collect::<Vec<_>>().join(" ");
        assert_eq!(title.replace("&lt;", "<").replace("&gt;", ">"), figure.title());
        assert!((1..=3).contains(&lines.len()));
        let number = |tag: &str, name: &str| attribute(tag, name).parse::<f64>().unwrap();
        for (tag, text) in &lines {
            let size = number(tag, "font-size");
            assert!(size >= 24.0 && 0.55 * size * text.chars().count() as f64 <= view[2], "{text}");
            assert!(number(tag, "y") < number(&format!(" {drawn}"), "y"), "{text}");
        }
        // 14 points are 14/72 inch, of the slide's 13.33
        let (room, own) =
            (["width", "height"].map(|name| number(&format!(" {drawn}"), name)), numbers(drawn));
        let scale = (room[0] / own[2]).min(room[1] / own[3]);
        let sizes = drawn.split(" font-size=\"").skip(1).map(|rest| rest.split_once('"').unwrap().0);
        let least = sizes.map(|size| size.parse::<f64>().unwrap()).fold(f64::INFINITY, f64::min);
        assert!(least * scale / view[2] * 960.0 >= 14.0, "{}: {}", slide.name(), least * scale * 0.75);
    }
    // what is tall is as large as fits
    let paths = Paths::new(room, Bounces::Exactly(2), Cosine, FindLight::BySampling).unwrap();
    let [student, _] = paths::figures::paths_drawn(&paths, 3, 1).unwrap();
    assert_eq!(student.slide().edition(), Edition::Student);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("slide");
    let saved = student.slide().save(&folder).unwrap();
    assert!(saved.iter().all(|path| path.exists() && !path.ends_with("4_1_paths_student_slide.csv")));
}

#[test]
fn figures_of_the_room_read_at_every_radiance() {
    for radiance in [0.0, 1e-100, 1e-9, 1e-3, 1.0, 1e4, 1e12, 1e100] {
        let room = BoxRoom::new(Scene { radiance, ..Scene::default() }).unwrap();
        let why = format!("radiance {radiance}");
        assert_drawn_or_refused(paths::figures::two_bounces_converging(&room, 1), &why);
    }
    let bright = BoxRoom::new(Scene { radiance: 1e12, ..Scene::default() }).unwrap();
    assert_drawn_or_refused(paths::figures::radiance_by_bounces(&bright, 1), "radiance 1e12");
}

#[test]
fn the_students_files_hold_nothing_of_the_answer() {
    for rate in [1.0, 2.5, 1e4] {
        let exponential = Exponential::new(rate).unwrap();
        let student = |u| inversion::figures::exponential(&exponential, u, Edition::Student).unwrap();
        // the same for every u, so that nothing of the sample can be in it
        assert!([0.1, 0.9999, 1.0].iter().all(|u| student(*u) == student(0.75)));
        assert_eq!(student(0.75).csv().lines().count(), 1);
        assert_eq!(student(0.75).name(), "1_2_exponential_student");
        // on the same canvas: all that the student's has, but for title and description, the solution has too
        let solution = inversion::figures::exponential(&exponential, 0.75, Edition::Solution).unwrap();
        let drawn = |figure: &Figure| figure.svg().split_once("</desc>").unwrap().1.to_string();
        for line in drawn(&student(0.75)).lines() {
            assert!(drawn(&solution).contains(line), "{line}");
        }
        for word in ["sampl", "probability", "0.75", "1.386", "1.39"] {
            assert!(!student(0.75).svg().contains(word), "{word}");
        }
    }
    for bounces in [2, 3] {
        let paths = paths(Scene::default(), Bounces::Exactly(bounces), FindLight::BySampling);
        let [student, solved] = paths::figures::paths_drawn(&paths, 3, 1).unwrap();
        let lines = |figure: &Figure| figure.csv().lines().map(str::to_string).collect::<Vec<_>>();
        assert!(lines(&student).iter().all(|line| lines(&solved).contains(line)));
        assert!(lines(&student).iter().all(|line| {
            ["room", "cube", "light", "eye", ",p,", "series"].iter().any(|part| line.contains(part))
        }));
        for word in ["path ", "ω", "①", "p₁", "to the eye", ">n<"] {
            assert!(!student.svg().contains(word) && !student.csv().contains(word), "{word}");
        }
        assert_legible(&student, "student");
        assert_legible(&solved, "solution");
    }
}

#[test]
fn what_cannot_be_written_is_a_sentence() {
    let figure = lambertian::figures::integrand().unwrap();
    let error = figure.save(Path::new("/proc/no/such/folder")).unwrap_err().to_string();
    assert!(error.contains("could not be written"), "{error}");
}
