//! Progress on a terminal.

use std::cell::OnceCell;
use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::run::Progress;

/// Does work that reports how many draws are done, and how many there will be: from the second second on, a
/// bar shows them on a terminal.
pub(super) fn watched<T>(wanted: bool, work: impl FnOnce(&Progress<'_>) -> T) -> T {
    let start = Instant::now();
    let bar = OnceCell::new();
    let shown = wanted && std::io::stderr().is_terminal();
    let progress = |done: u64, total: Option<u64>| {
        if shown && start.elapsed() > Duration::from_secs(1) {
            bar.get_or_init(|| progress_bar(total)).set_position(done);
        }
    };
    let result = work(&progress);
    if let Some(bar) = bar.get() {
        bar.finish_and_clear();
    }
    result
}

fn progress_bar(total: Option<u64>) -> ProgressBar {
    let style = ProgressStyle::with_template("{bar:40} {human_pos} of {human_len} draws, {eta} to go");
    let bar = ProgressBar::new(total.unwrap_or(0));
    style.map(|style| bar.clone().with_style(style)).unwrap_or(bar)
}
