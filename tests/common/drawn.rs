//! What tests of figures share: their texts and numbers, and whether they can be read.

use unbiased::plot::Figure;

/// The rows of a series in the CSV: x, y, low, high, with NaN for an empty cell.
pub fn series(figure: &Figure, name: &str) -> Vec<[f64; 4]> {
    let quoted = if name.contains(',') { format!(",\"{name}\",") } else { format!(",{name},") };
    let rows = figure.csv().lines().filter_map(|line| {
        let (_, cells) = line.split_once(&quoted)?;
        let cells: Vec<f64> = cells.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
        Some([cells[0], cells[1], cells[2], cells[3]])
    });
    rows.collect()
}

/// A tag's attribute.
pub fn attribute<'a>(tag: &'a str, name: &str) -> &'a str {
    let (_, from) = tag.split_once(&format!(" {name}=\"")).unwrap();
    from.split_once('"').unwrap().0
}

/// Every text of a figure with a box about it, a little smaller than its ink: its middle, and half its width
/// and height.
pub fn boxes(figure: &Figure) -> Vec<(String, [f64; 4])> {
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
pub fn assert_legible(figure: &Figure, why: &str) {
    let (name, svg) = (figure.name(), figure.svg());
    let (_, drawn) = svg.split_once("</desc>").unwrap();
    let boxes = boxes(figure);
    for (text, _) in &boxes {
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
pub fn assert_drawn_or_refused(figure: unbiased::Result<Figure>, why: &str) {
    match figure {
        Ok(figure) => assert_legible(&figure, why),
        Err(error) => {
            let sentence = error.to_string();
            let told = ["finite draws", " must ", "could not be drawn"];
            assert!(told.iter().any(|words| sentence.contains(words)), "{why}: {sentence}");
        }
    }
}

/// That no text of a figure lies on a line of it.
pub fn assert_off_lines(figure: &Figure, why: &str) {
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
