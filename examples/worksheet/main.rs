//! The whole worksheet: every question answered in closed form, by an estimator with its error bar, and in a picture, on one page.

use std::process::ExitCode;

use unbiased::workbook;

#[path = "../q1_1_exponential.rs"]
mod q1_1;
#[path = "../q1_2_one_sample.rs"]
mod q1_2;
#[path = "../q1_3_axes.rs"]
mod q1_3;
#[path = "../q2_1_square.rs"]
mod q2_1;

fn main() -> ExitCode {
    workbook::worksheet(&[
        ("1.1", q1_1::answer),
        ("1.2", q1_2::answer),
        ("1.3", q1_3::answer),
        ("2.1", q2_1::answer),
    ])
}
