//! The whole worksheet on one page: every question answered in closed form, by an estimator with its error
//! bar, and by a figure.

use std::process::ExitCode;

use unbiased::workbook::{self, AnswerFn, Worksheet};

#[path = "../extremes.rs"]
mod extremes;
#[path = "../q1_1_exponential.rs"]
mod q1_1;
#[path = "../q1_2_one_sample.rs"]
mod q1_2;
#[path = "../q1_3_axes.rs"]
mod q1_3;
#[path = "../q2_1_square.rs"]
mod q2_1;
#[path = "../q3_1_emission.rs"]
mod q3_1;
#[path = "../q3_2_uniform_sky.rs"]
mod q3_2;
#[path = "../q3_3_dependence.rs"]
mod q3_3;
#[path = "../q3_4_brdf_directions.rs"]
mod q3_4;
#[path = "../q3_5_cosine_directions.rs"]
mod q3_5;
#[path = "../q3_6_variance.rs"]
mod q3_6;
#[path = "../q4_1_two_bounces.rs"]
mod q4_1;
#[path = "../q4_2_three_bounces.rs"]
mod q4_2;
#[path = "../q4_3_paths.rs"]
mod q4_3;
#[path = "../q5_1_bounces.rs"]
mod q5_1;
#[path = "../q5_2_few_bounces.rs"]
mod q5_2;
#[path = "../q5_3_more_bounces.rs"]
mod q5_3;

#[path = "../trade.rs"]
mod trade;

fn main() -> ExitCode {
    let answers: [(&str, AnswerFn); _] = [
        ("1.1", q1_1::answer),
        ("1.2", q1_2::answer),
        ("1.3", q1_3::answer),
        ("2.1", q2_1::answer),
        ("3.1", q3_1::answer),
        ("3.2", q3_2::answer),
        ("3.3", q3_3::answer),
        ("3.4", q3_4::answer),
        ("3.5", q3_5::answer),
        ("3.6", q3_6::answer),
        ("4.1", q4_1::answer),
        ("4.2", q4_2::answer),
        ("4.3", q4_3::answer),
        ("5.1", q5_1::answer),
        ("5.2", q5_2::answer),
        ("5.3", q5_3::answer),
    ];
    let mut worksheet = Worksheet::new("Monte Carlo and global illumination");
    for (id, answer) in answers {
        match workbook::question(id) {
            Ok(question) => worksheet = worksheet.question(question, answer),
            Err(error) => {
                eprintln!("{error}");
                return ExitCode::FAILURE;
            }
        }
    }
    worksheet.beside(&extremes::APPENDIX).beside(&trade::APPENDIX).run()
}
