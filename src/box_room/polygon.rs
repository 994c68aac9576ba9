//! The form factor of a polygon, in closed form.

use std::f64::consts::TAU;

use glam::DVec3;

/// The part P of the cosine-weighted hemisphere above `point` that a plane polygon fills: P = |Σ Θᵢ Γᵢ·n|/(2π), in \[0, 1\].
///
/// Θᵢ is the angle between the directions vᵢ, vᵢ₊₁ to neighbouring corners and Γᵢ the unit vector of vᵢ × vᵢ₊₁ (Lambert, *Photometria*, 1760; Baum, Rushmeier
/// & Winget 1989). What lies below the horizon of `normal`, of any length, is cut off. A diffuse surface of albedo ρ reflects ρ L_e P of a light of radiance L_e of this shape
/// (worksheet 4); one draw that looks for it along a cosine-distributed direction has variance (ρ L_e)² P(1 − P).
///
/// The corners follow each other around the polygon, in either sense. P is 0 for fewer than three of them, and where `point` lies in the polygon's plane: it is
/// seen edge on, from its boundary, too. It is P to a few ulp however small the polygon, and however large, as long as it is not much longer than wide. It is NaN
/// where it has no meaning: if a coordinate is NaN or infinite, or the normal has no length.
///
/// ```
/// use glam::DVec3;
/// use unbiased::box_room::form_factor;
///
/// // a square of side 2a at distance a: F = 4/(π√2) · atan(1/√2)
/// let square = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 1.0));
/// let seen = form_factor(&square, DVec3::ZERO, DVec3::Z);
/// let exact = 4.0 / (std::f64::consts::PI * 2f64.sqrt()) * (1.0 / 2f64.sqrt()).atan();
/// assert!((seen - exact).abs() < 1e-15);
/// ```
pub fn form_factor(corners: &[DVec3], point: DVec3, normal: DVec3) -> f64 {
    let steepest = normal.abs().max_element();
    let finite = corners.iter().all(|corner| corner.is_finite()) && point.is_finite() && normal.is_finite();
    if !finite || steepest == 0.0 {
        return f64::NAN;
    }
    // a unit vector keeps its bits
    let normal = if normal.length_squared() == 1.0 { normal } else { (normal / steepest).normalize() };
    let (origin, corners) = above_horizon(corners, point, normal);
    let Some(own_first) = corners.first().copied() else { return 0.0 };
    let first = origin + own_first;
    // the polygon's normal: where the point lies in its plane, P is 0
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    let area: DVec3 = edges.map(|(a, b)| (*a - own_first).cross(*b - own_first)).sum();
    if area.dot(first) == 0.0 {
        return 0.0;
    }
    // Σ Θᵢ Γᵢ = Σ uᵢ × uᵢ₊₁ + Σ (Θᵢ/sin Θᵢ − 1) uᵢ × uᵢ₊₁ for the unit vectors u to the corners. In the first sum u₀ may be taken from every uᵢ, so that
    // for a small polygon nothing cancels; the second is smaller by Θ².
    let length = first.length();
    // each u, and u − u₀
    let units: Vec<(DVec3, DVec3)> = corners
        .iter()
        .map(|corner| {
            let (way, step) = (origin + *corner, *corner - own_first);
            let own = way.length();
            // 1/|vᵢ| − 1/|v₀|, without taking the difference
            let shorter = -step.dot(way + first) / ((own + length) * own * length);
            (way / own, step / own + first * shorter)
        })
        .collect();
    let mut sum = 0.0;
    for ((unit, a), (next, b)) in units.iter().zip(units.iter().cycle().skip(1)) {
        let cross = unit.cross(*b - *a);
        sum += normal.dot(a.cross(*b)) + angle_excess(cross.length(), unit.dot(*next)) * normal.dot(cross);
    }
    // rounding apart the sum is in the range
    (sum.abs() / TAU).min(1.0)
}

/// Θ/sin Θ − 1 of an angle in [0, π].
fn angle_excess(sin: f64, cos: f64) -> f64 {
    if cos > 0.0 && sin < 0.3 {
        // arcsin(s)/s − 1 = s²/6 + 3s⁴/40 + …, term by term: the last one left out is below 1e-17 of the first
        let (square, mut power, mut sum) = (sin * sin, 1.0, 0.0);
        for n in 1..=15 {
            let n = f64::from(n);
            power *= square * (2.0 * n - 1.0) / (2.0 * n);
            sum += power / (2.0 * n + 1.0);
        }
        sum
    } else if sin > 0.0 {
        sin.atan2(cos) / sin - 1.0
    } else {
        0.0 // the point lies on an edge, where the polygon is seen edge on
    }
}

/// The first corner as seen from `point`, and all of them as seen from that one, cut off where they are below the horizon of `normal` (Sutherland & Hodgman
/// 1974). Their differences are taken before anything else, as a small polygon's are exact then. P does not depend on the unit of length: it is the largest
/// coordinate here, so that no square leaves `f64`.
fn above_horizon(corners: &[DVec3], point: DVec3, normal: DVec3) -> (DVec3, Vec<DVec3>) {
    // a quarter of what is so large that a difference might overflow
    let far = corners.iter().chain([&point]).any(|corner| corner.abs().max_element() > 0.25 * f64::MAX);
    let scale = if far { 0.25 } else { 1.0 };
    let (corners, point) = (corners.iter().map(|corner| *corner * scale), point * scale);
    let corners: Vec<DVec3> = corners.collect();
    let Some(first) = corners.first().copied() else { return (DVec3::ZERO, Vec::new()) };
    let unit = corners.iter().map(|corner| (*corner - point).abs().max_element()).fold(0.0, f64::max);
    let origin = (first - point) / unit;
    let seen: Vec<(DVec3, f64)> = corners
        .iter()
        .map(|corner| {
            let step = (*corner - first) / unit;
            (step, normal.dot(origin + step))
        })
        .collect();
    let mut kept = Vec::with_capacity(seen.len() + 2);
    for ((step, height), (next, next_height)) in seen.iter().zip(seen.iter().cycle().skip(1)) {
        if *height >= 0.0 {
            kept.push(*step);
        }
        if (*height > 0.0 && *next_height < 0.0) || (*height < 0.0 && *next_height > 0.0) {
            let part = height / (height - next_height);
            kept.push(*step + (*next - *step) * part);
        }
    }
    (origin, if kept.len() < 3 { Vec::new() } else { kept })
}
