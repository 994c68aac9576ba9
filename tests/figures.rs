//! Figures that can be read whatever is drawn, students' editions that tell nothing, and slides.
#![cfg(feature = "workbook")]

mod common;

use std::path::Path;

use common::drawn::{assert_drawn_or_refused, assert_legible, assert_off_lines, attribute, boxes, series};
use common::rivals::{comparison, measured, named};
use unbiased::inversion::Exponential;
use unbiased::lambertian::hemisphere::Hemisphere::{Cosine, Uniform};
use unbiased::paths::room::{BoxRoom, Scene};
use unbiased::paths::{Bounces, FindLight, Paths};
use unbiased::plot::{Edition, Figure};
use unbiased::rectangle::Rectangle;
use unbiased::roulette::LightModel;
use unbiased::trade::{Measured, Nature};
use unbiased::{inversion, lambertian, paths, rectangle, roulette, trade, workbook};

const SCALES: [f64; 14] =
    [5e-324, 1e-310, 1e-290, 1e-100, 1e-9, 1e-4, 0.003, 0.3, 1.0, 7.5, 1e4, 123_456.789, 1e12, 1e300];

#[test]
fn figures_of_the_exponential_read_at_every_scale() {
    for rate in SCALES {
        let exponential = Exponential::new(rate).unwrap();
        let drawn = |u, edition| inversion::figures::exponential(&exponential, u, edition);
        for u in [0.0, 1e-300, 1e-6, 0.05, 0.2, 0.3, 0.5, 0.6321, 0.75, 0.9, 0.97, 0.9999, 1.0 - 1e-12, 1.0] {
            let (figure, why) = (drawn(u, Edition::Solution), format!("λ = {rate:e}, u = {u}"));
            assert_eq!(figure.is_ok(), (1e-290..=1e290).contains(&rate), "{why}");
            if let Ok(figure) = &figure {
                assert_eq!(boxes(figure).iter().filter(|(text, _)| text.starts_with("U = ")).count(), 2);
                // longer numbers may not fit beside the curves
                if (0.3..10.0).contains(&rate) {
                    assert_off_lines(figure, &why);
                }
            }
            assert_drawn_or_refused(figure, &why);
        }
        let why = format!("λ = {rate:e}");
        assert_drawn_or_refused(drawn(0.75, Edition::Student), &why);
        assert_drawn_or_refused(inversion::figures::tails(&exponential, 1 << 10, 1), &why);
        for draws in [1, 200] {
            let why = format!("{why}, {draws} draws");
            assert_drawn_or_refused(inversion::figures::empirical_cdf(&exponential, draws, 1), &why);
        }
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
fn figures_of_a_comparison_leave_nothing_out_in_silence() {
    let draw = |rivals| trade::figures::comparison("trade_test", "Rivals", &comparison(rivals)).unwrap();
    let many = (0..18)
        .map(|k| named(&format!("rival {k:02}"), measured(Nature::Unbiased, 2.0, 1.5f64.powi(k), 1e-8)));
    let drawn = draw(many.collect::<Vec<_>>());
    assert!(drawn.svg().contains("Not drawn, as there are only sixteen kinds of lines: rival 16, rival 17."));
    assert!((0..16).all(|k| drawn.csv().contains(&format!("Efficiency,rival {k:02},"))));
    // 1.5¹⁷ = 985
    assert!(drawn.svg().contains("× 985"));

    let pair = |variance: f64, evaluations: f64| {
        let best = measured(Nature::Unbiased, 2.0, 1.0, 1e-8);
        let other = Measured { evaluations, ..measured(Nature::Unbiased, 2.0, variance, 1e-8) };
        draw(vec![best, other]).svg().to_owned()
    };
    // within the axes; beyond them, a round number below; not told apart: none
    assert!(pair(3.0, 1.0).contains("× 3.0") && !pair(3.0, 1.0).contains("&gt; ×"));
    assert!(pair(1e9, 1.0).contains("&gt; × 10000"));
    assert!(!pair(1.03, 1.0).contains('×') && !pair(1.9, 1.0).contains('×'));
    assert!(pair(2.1, 1.0).contains("× 2.1"));
    assert!(pair(3.0, 1.0).contains("evaluations or rays") && pair(3.0, 0.0).contains("random numbers"));

    // nothing to draw, and things that cannot be
    let odd = [
        measured(Nature::InfiniteVariance, 2.0, 1.0, 1e-8),
        measured(Nature::Unbiased, 2.0, 0.0, 1e-8),
        Measured { random_numbers: 0.0, evaluations: 0.0, ..measured(Nature::Unbiased, 2.0, 1.0, 1e-8) },
        measured(Nature::Biased, 2.001, 1.0, 1e-8),
    ];
    for rivals in [&odd[..0], &odd[..1], &odd[1..2], &odd[..2], &odd[2..3], &odd[3..], &odd[..]] {
        let found = draw(rivals.to_vec());
        assert!(!found.svg().contains("NaN") && !found.csv().contains("NaN"), "{rivals:?}");
        assert_eq!(
            found.svg().contains(">infinite variance<") || found.svg().contains("infinite variance\n"),
            rivals.iter().any(|rival| rival.nature == Nature::InfiniteVariance)
        );
    }
}

#[test]
fn what_cannot_be_written_is_a_sentence() {
    let figure = lambertian::figures::integrand().unwrap();
    let error = figure.save(Path::new("/proc/no/such/folder")).unwrap_err().to_string();
    assert!(error.contains("could not be written"), "{error}");
}
