//! Numbers as text: for people to their significant digits, for programs with all digits.

/// The mean and the half-width of its interval, both rounded to two digits of the half-width: `0.31276 ±
/// 0.00024`.
pub(crate) fn plus_minus(mean: f64, reach: f64) -> String {
    let places = places(reach);
    if reach == 0.0 {
        format!("{} ± 0", shortened(mean))
    } else if !reach.is_finite() {
        format!("{} ± ∞", shortened(mean))
    } else if (1e-12..1e12).contains(&reach) && mean.abs() < 1e15 {
        let mean = format!("{mean:.places$}");
        // no "-0.000"
        let zero = mean.strip_prefix('-').filter(|digits| digits.chars().all(|c| c == '0' || c == '.'));
        format!("{} ± {reach:.places$}", zero.unwrap_or(&mean))
    } else {
        // the mean to the error's last digit
        let digits = (mean.abs().log10().floor() - reach.log10().floor() + 1.0).clamp(0.0, 16.0);
        format!("{mean:.*e} ± {reach:.1e}", digits as usize)
    }
}

/// Decimal places that show two digits of an error.
pub(crate) fn places(error: f64) -> usize {
    let leading = error.abs().log10().floor();
    if leading.is_finite() { (1.0 - leading).clamp(0.0, 17.0) as usize } else { 6 }
}

/// At most twelve significant digits, without trailing zeros.
pub(crate) fn shortened(value: f64) -> String {
    let rounded = format!("{value:.11e}").parse().unwrap_or(value);
    if rounded == 0.0 || (1e-6..1e12).contains(&f64::abs(rounded)) {
        format!("{rounded}")
    } else {
        format!("{rounded:e}")
    }
}

/// Rounded to this many significant digits, without trailing zeros: 1.2e9.
pub(crate) fn rounded(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let rounded = format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value);
    format!("{rounded:e}")
}

/// A number of standard errors: two decimal places below 100, none above; `∞`.
#[cfg(feature = "workbook")]
pub(crate) fn std_errors(z: f64) -> String {
    let (sign, size) = (if z < 0.0 { "−" } else { "" }, z.abs());
    match size {
        f64::INFINITY => format!("{sign}∞"),
        100.0.. => format!("{sign}{size:.0}"),
        _ => format!("{sign}{size:.2}"),
    }
}

/// Two significant digits, or all of a whole number below 10⁵; `∞`.
pub(crate) fn two_digits(x: f64) -> String {
    if x.is_infinite() {
        return "∞".into();
    }
    // 9.99 is shown as 10, which has one digit more
    let size: f64 = format!("{x:.1e}").parse().map_or(x, f64::abs);
    if x != 0.0 && !(1e-4..1e5).contains(&size) {
        return format!("{x:.1e}");
    }
    // 0 has no first digit
    let places = if x == 0.0 { 0.0 } else { (1.0 - size.log10().floor()).clamp(0.0, 9.0) };
    format!("{x:.*}", places as usize)
}

/// For print: this many significant digits, without trailing zeros, with a power of ten for very small or
/// large numbers: 0.000139, 1.5 × 10⁻⁹, −10¹², ∞.
#[cfg(feature = "workbook")]
pub(crate) fn typeset(value: f64, digits: usize) -> String {
    let rounded: f64 = format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value);
    let text = match rounded.abs() {
        0.0 => "0".into(),
        f64::INFINITY => if rounded < 0.0 { "-∞" } else { "∞" }.into(),
        size if !(1e-4..1e6).contains(&size) && !size.is_nan() => {
            let (sign, scientific) = (if rounded < 0.0 { "-" } else { "" }, format!("{size:e}"));
            let (first, power) = scientific.split_once('e').unwrap_or((&scientific, "0"));
            let power = power_of_ten(power.parse().unwrap_or(0));
            if first == "1" { format!("{sign}{power}") } else { format!("{sign}{first} × {power}") }
        }
        _ => format!("{rounded}"),
    };
    text.replace('-', "−")
}

/// The same after “=”, or after “≈” if it is rounded.
#[cfg(feature = "workbook")]
pub(crate) fn equals(value: f64, digits: usize) -> String {
    let short = typeset(value, digits);
    let sign = if short == typeset(value, 12) { "=" } else { "≈" };
    format!("{sign} {short}")
}

/// A whole multiple of `step`, to the decimal places that steps of 1, 2 or 5 times a power of ten need.
#[cfg(feature = "workbook")]
pub(crate) fn in_steps(value: f64, step: f64) -> String {
    let places = (-(step.log10() + 1e-9).floor()).clamp(0.0, 17.0) as usize;
    format!("{value:.places$}").replace('-', "−")
}

/// 10ⁿ
#[cfg(feature = "workbook")]
pub(crate) fn power_of_ten(power: i32) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    match power {
        0 => "1".into(),
        1 => "10".into(),
        _ => {
            let sign = if power < 0 { "⁻" } else { "" };
            let digits = power.unsigned_abs().to_string();
            let raised = digits.bytes().filter_map(|digit| DIGITS.get(usize::from(digit - b'0')));
            format!("10{sign}{}", raised.collect::<String>())
        }
    }
}

/// The unit in which to show this time, and how many of that unit make a second.
pub(crate) fn unit(seconds: f64) -> (f64, &'static str) {
    match seconds {
        s if s < 1e-6 => (1e9, "ns"),
        s if s < 1e-3 => (1e6, "µs"),
        s if s < 1.0 => (1e3, "ms"),
        _ => (1.0, "s"),
    }
}

/// A time in a suitable unit: `1.4 ns`.
pub(crate) fn duration(seconds: f64) -> String {
    let (factor, unit) = unit(seconds);
    format!("{} {unit}", two_digits(factor * seconds))
}

/// A CSV field (RFC 4180).
pub(crate) fn csv_field(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.into()
    }
}

/// All digits of a number, in the shorter of the plain and the scientific form: both parse back to the same
/// number.
pub(crate) fn parseable(number: f64) -> String {
    let (plain, scientific) = (number.to_string(), format!("{number:e}"));
    if plain.len() <= 12 || plain.len() <= scientific.len() { plain } else { scientific }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_says_how_many_digits_mean_something() {
        for (mean, reach, text) in [
            (0.312761, 0.000241, "0.31276 ± 0.00024"),
            (12345.6, 78.0, "12346 ± 78"),
            (-0.0001, 0.01, "0.000 ± 0.010"),
            (2.0, 0.0, "2 ± 0"),
            (1.5e-20, 2.5e-22, "1.500e-20 ± 2.5e-22"),
            (8.003_581_620_508_651e299, 9.0e296, "8.0036e299 ± 9.0e296"),
            (0.0, 2e-20, "0e0 ± 2.0e-20"),
            (1.0, f64::INFINITY, "1 ± ∞"),
        ] {
            assert_eq!(plus_minus(mean, reach), text);
        }
    }

    #[cfg(feature = "workbook")]
    #[test]
    fn print_has_digits_or_powers_of_ten() {
        for (value, digits, text) in [
            (0.75, 3, "0.75"),
            (1.386_294e-4, 3, "0.000139"),
            (-1.5e-9, 3, "−1.5 × 10⁻⁹"),
            (9.999e5, 3, "10⁶"),
            (-1e12, 12, "−10¹²"),
            (-0.0, 3, "0"),
            (f64::INFINITY, 3, "∞"),
            (123_456.0, 12, "123456"),
        ] {
            assert_eq!(typeset(value, digits), text);
        }
        assert_eq!([-3.999, 1034.4, f64::NEG_INFINITY].map(std_errors), ["−4.00", "1034", "−∞"]);
        assert_eq!([equals(0.25, 3), equals(1.386_29, 3)], ["= 0.25", "≈ 1.39"]);
        assert_eq!([in_steps(-0.5, 0.5), in_steps(20.0, 20.0)], ["−0.5", "20"]);
        assert_eq!([power_of_ten(-18), power_of_ten(0)], ["10⁻¹⁸", "1"]);
    }

    #[test]
    fn csv_fields_with_commas_are_csv_field() {
        assert_eq!(csv_field("a"), "a");
        assert_eq!(csv_field("a, \"b\""), "\"a, \"\"b\"\"\"");
    }
}
