//! Rows of section 4 in which no path found the light.

use unbiased::box_room::BoxRoom;
use unbiased::workbook::Answer;

/// The row; or, where every path brought 0 though some light comes to p, the row as a demonstration that says so.
///
/// Without a truth, light after two bounces or more is meant: it comes to every point that reflects, unless the walls reflect none (the cube does not see itself).
pub fn unless_none_found(row: Answer, room: &BoxRoom) -> Answer {
    let scene = room.scene();
    let lamp = scene.radiance > 0.0 && scene.light_half_width > 0.0;
    let lit = lamp && scene.wall_albedo > 0.0 && room.albedo(&room.point()) > 0.0;
    let some = row.exact().map_or(lit, |truth| truth > 0.0);
    if some && row.estimate().is_some_and(|found| found.mean() == 0.0) {
        row.note("No path found the light: an estimate of 0 ± 0 says nothing but that.").demonstration()
    } else {
        row
    }
}
