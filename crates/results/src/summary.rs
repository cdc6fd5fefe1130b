//! The last line a run says.

use std::path::Path;

use crate::manifest::{Ended, Manifest};
use blocksim_numbers::format::{count, duration, simulated};

/// One line on how a run ended, what it cost and where it lies. `place` is `None` where nothing was kept.
pub fn done_line(manifest: &Manifest, signals: usize, place: Option<&Path>) -> String {
    let how = match manifest.ended {
        Ended::Unfinished => "Unfinished",
        Ended::Complete => "Done",
        Ended::Stopped { .. } => "Stopped",
        Ended::Interrupted => "Interrupted",
        Ended::Failed { .. } => "Failed",
    };
    let mut line =
        format!("{how:>11} {} in {}", simulated(manifest.simulated_time), duration(manifest.wall_time));
    let factor = manifest.simulated_time / manifest.wall_time;
    if factor.is_finite() {
        line.push_str(&format!(" ({}×)", blocksim_numbers::format::significant(factor, 3)));
    }
    let counts = manifest.counts;
    let parts = [
        (counts.steps, "step"),
        (counts.rejected, "rejected"),
        (counts.events, "event"),
        (signals as u64, "signal"),
    ];
    for (n, name) in parts {
        let plural = if n == 1 || name == "rejected" { "" } else { "s" };
        line.push_str(&format!(" · {} {name}{plural}", count(n)));
    }
    if let Some(place) = place {
        line.push_str(&format!(" → {}", place.display()));
    }
    if let Ended::Stopped { reason } | Ended::Failed { reason } = &manifest.ended {
        line.push_str(&format!("\n{:>11} {reason}", "because"));
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::manifest::tests::example;

    #[test]
    fn the_last_line_tells_time_work_and_place() {
        let place = Path::new("runs/2026-11-21T14-03-22_pick");
        assert_eq!(
            done_line(&example(), 13, Some(place)),
            "       Done 10.000 s in 0.42 s (23.8×) · 4 183 steps · 96 rejected · 3 events · 13 signals → \
             runs/2026-11-21T14-03-22_pick"
        );
        let ended = Ended::Failed { reason: "step size fell below 1e-12 s in arm/joint_3".into() };
        let manifest = Manifest { ended, wall_time: 0.0, ..example() };
        assert_eq!(
            done_line(&manifest, 1, None),
            "     Failed 10.000 s in 0.00 s · 4 183 steps · 96 rejected · 3 events · 1 signal\n    because step \
             size fell below 1e-12 s in arm/joint_3"
        );
    }
}
