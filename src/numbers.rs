//! Numbers as text: for people to the digits that mean something, for programs with all of them.

/// The mean and the half-width of its interval, both to the digits that the half-width leaves meaningful:
/// `0.31276 ± 0.00024`.
pub(crate) fn plus_minus(mean: f64, reach: f64) -> String {
    let places = places(reach);
    if reach == 0.0 {
        format!("{} ± 0", shortened(mean))
    } else if !reach.is_finite() {
        format!("{} ± ∞", shortened(mean))
    } else if (1e-12..1e12).contains(&reach) && mean.abs() < 1e15 {
        let mean = format!("{mean:.places$}");
        // what rounds to 0 has no sign
        let zero = mean.strip_prefix('-').filter(|digits| digits.chars().all(|c| c == '0' || c == '.'));
        format!("{} ± {reach:.places$}", zero.unwrap_or(&mean))
    } else {
        format!("{mean:e} ± {reach:.1e}")
    }
}

/// Decimal places that show two digits of an error.
pub(crate) fn places(error: f64) -> usize {
    let leading = error.abs().log10().floor();
    if leading.is_finite() { (1.0 - leading).clamp(0.0, 17.0) as usize } else { 6 }
}

/// Twelve significant digits at most, trailing zeros left out.
pub(crate) fn shortened(value: f64) -> String {
    let rounded = format!("{value:.11e}").parse().unwrap_or(value);
    if rounded == 0.0 || (1e-6..1e12).contains(&f64::abs(rounded)) {
        format!("{rounded}")
    } else {
        format!("{rounded:e}")
    }
}

/// Seven significant digits at most, for a sentence: 1.386294, 2·10⁻⁹, −3, ∞.
#[cfg(feature = "workbook")]
pub(crate) fn in_a_text(value: f64) -> String {
    if !value.is_finite() {
        return if value > 0.0 { "∞" } else { "no number" }.into();
    }
    let rounded: f64 = format!("{value:.6e}").parse().unwrap_or(value);
    let size = rounded.abs();
    let text = if size == 0.0 || (1e-4..1e7).contains(&size) {
        format!("{}", rounded + 0.0)
    } else {
        let scientific = format!("{rounded:e}");
        let (digits, power) = scientific.split_once('e').unwrap_or((&scientific, "0"));
        let raised = power.chars().filter_map(|c| "⁻⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth("-0123456789".find(c)?));
        format!("{digits}·10{}", raised.collect::<String>())
    };
    text.replace('-', "−")
}

/// A number to so many digits, trailing zeros left out: 1.2e9.
pub(crate) fn rounded(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let rounded = format!("{value:.*e}", digits.saturating_sub(1)).parse().unwrap_or(value);
    format!("{rounded:e}")
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

/// The unit that suits so many seconds, and how many of it are a second.
pub(crate) fn unit(seconds: f64) -> (f64, &'static str) {
    match seconds {
        s if s < 1e-6 => (1e9, "ns"),
        s if s < 1e-3 => (1e6, "µs"),
        s if s < 1.0 => (1e3, "ms"),
        _ => (1.0, "s"),
    }
}

/// Seconds, in the unit that suits them.
pub(crate) fn duration(seconds: f64) -> String {
    let (factor, unit) = unit(seconds);
    format!("{} {unit}", two_digits(factor * seconds))
}

/// All digits of a number, in the shorter form where the plain one is long: either is read back as the same
/// number.
#[cfg(feature = "workbook")]
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
            (1.5e-20, 2.5e-22, "1.5e-20 ± 2.5e-22"),
            (1.0, f64::INFINITY, "1 ± ∞"),
        ] {
            assert_eq!(plus_minus(mean, reach), text);
        }
    }

    #[cfg(feature = "workbook")]
    #[test]
    fn a_sentence_has_short_numbers() {
        for (value, text) in [
            (4f64.ln(), "1.386294"),
            (0.1 + 0.2, "0.3"),
            (-3.0, "−3"),
            (-0.0, "0"),
            (2e-9, "2·10⁻⁹"),
            (-1.25e12, "−1.25·10¹²"),
            (f64::INFINITY, "∞"),
        ] {
            assert_eq!(in_a_text(value), text);
        }
    }
}
