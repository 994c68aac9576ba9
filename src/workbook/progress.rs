//! Progress on a terminal.

use std::cell::OnceCell;
use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::run::Progress;

/// Does work that reports how many draws are done, and how many there will be. After one second, a bar shows
/// them on a terminal. With a `time`, the bar shows that instead.
pub(super) fn watched<T>(wanted: bool, time: Option<Duration>, work: impl FnOnce(&Progress<'_>) -> T) -> T {
    let start = Instant::now();
    let bar = OnceCell::new();
    let shown = wanted && std::io::stderr().is_terminal();
    let progress = |done: u64, total: u64| {
        if shown && start.elapsed() > Duration::from_secs(1) {
            let bar = bar.get_or_init(|| progress_bar(time, total));
            bar.set_position(time.map_or(done, |_| milliseconds(start.elapsed())));
        }
    };
    let result = work(&progress);
    if let Some(bar) = bar.get() {
        bar.finish_and_clear();
    }
    result
}

fn progress_bar(time: Option<Duration>, total: u64) -> ProgressBar {
    let template = match time {
        Some(time) => format!("{{bar:40}} {{elapsed}} of {:.0} s", time.as_secs_f64()),
        None => "{bar:40} {human_pos} of {human_len} draws, {eta} to go".into(),
    };
    let bar = ProgressBar::new(time.map_or(total, milliseconds));
    match ProgressStyle::with_template(&template) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

fn milliseconds(time: Duration) -> u64 {
    u64::try_from(time.as_millis()).unwrap_or(u64::MAX)
}
