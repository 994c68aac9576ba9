//! SVG documents: sizes in mm, titles and descriptions, fonts and dashes.

/// Units per millimetre: ten per CSS pixel of 1/96 inch.
pub(super) const MM: f64 = 960.0 / 25.4;

/// plotters has no dashes: lines get one of these opacities, which are replaced by the dash pattern.
pub(super) const DASHES: [(f64, &str); 3] = [(0.991, "75 30"), (0.992, "90 30 15 30"), (0.993, "15 25")];

/// Fonts that have all characters used, in order of preference.
const FONTS: &str = "font-family=\"DejaVu Sans, Noto Sans, Noto Sans Math, STIX Two Math, sans-serif\"";

/// The white outline of texts.
const EDGE: &str = " stroke=\"#FFFFFF\" stroke-width=\"24\" paint-order=\"stroke\"";

/// Adds the size in mm, title, description and dash patterns, and a white outline around texts so that lines
/// do not touch them.
pub(super) fn of_plot(name: &str, size: [f64; 2], told: [&str; 2], drawn: &str) -> String {
    let body = drawn.split_once('>').map_or("", |(_, body)| body);
    let mut body = body
        .trim_end_matches("</svg>\n")
        .replace(" opacity=\"1\"", "")
        .replace(" \"/>", "\"/>")
        .replace("font-family=\"sans-serif\"", FONTS)
        .replace("<text ", &format!("<text{EDGE} "));
    for (opacity, pattern) in DASHES {
        body = body.replace(&format!("opacity=\"{opacity}\""), &format!("stroke-dasharray=\"{pattern}\""));
    }
    let lattice = size.map(|size| (size * MM).trunc());
    document(name, size, lattice, told, &body)
}

/// A picture of this size in mm on white, `[width, height]` of its own units, with title and description.
pub(super) fn document(
    name: &str,
    [width, height]: [f64; 2],
    [across, down]: [f64; 2],
    [title, description]: [&str; 2],
    body: &str,
) -> String {
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}mm\" height=\"{height}mm\" viewBox=\"0 0 \
         {across} {down}\" stroke-linejoin=\"round\" role=\"img\" aria-labelledby=\"{name}-title \
         {name}-desc\">\n<title id=\"{name}-title\">{}</title>\n<desc id=\"{name}-desc\">{}</desc>\n<rect \
         width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>{body}</svg>\n",
        escape(title),
        escape(description),
    )
}

/// A line of a title, centred at x, with its baseline at y, in type of `size`.
pub(super) fn title_line(x: f64, y: f64, size: u8, text: &str) -> String {
    let text = escape(text);
    format!(
        "\n<text x=\"{x}\" y=\"{y}\" text-anchor=\"middle\" {FONTS} font-size=\"{size}\" \
         fill=\"#222222\">{text}</text>"
    )
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
