//! Rows of section 4 in which no path found the light.

use unbiased::paths::room::BoxRoom;

/// Whether every path brought 0 though some light comes to p, in a sentence.
///
/// Without a truth, light after two bounces or more is meant: it comes to every point that reflects, unless
/// the walls
/// reflect none (the cube does not see itself).
pub fn none_found(room: &BoxRoom, truth: Option<f64>) -> impl Fn(f64) -> Option<String> + use<> {
    let scene = room.scene();
    let lamp = scene.radiance > 0.0 && scene.light_half_width > 0.0;
    let lit = lamp && scene.wall_albedo > 0.0 && room.albedo(&room.point()) > 0.0;
    let some = truth.map_or(lit, |truth| truth > 0.0);
    move |mean| (some && mean == 0.0).then(|| "no path found the light; 0 ± 0 says nothing but that".into())
}
