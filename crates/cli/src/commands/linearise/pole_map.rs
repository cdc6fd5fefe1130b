//! Poles and zeros in the complex plane as a drawing.

use blocksim_linear::Complex;
use blocksim_picture::{Label, Line, Mark, Plane, Sign, Style, Theme, plane_svg};

use super::Found;
use super::bode::title;
use super::nyquist::{SIZE, around, circle};

/// Damping of the rays in continuous time.
const DAMPING: [f64; 4] = [0.2, 0.4, 0.6, 0.8];

/// Poles and zeros of the ways, or all poles of the model, with rays of equal damping; in discrete time with the unit circle.
pub fn drawing(found: &Found, theme: Theme) -> String {
    let period = found.linearised.system.period;
    let mut marks = Vec::new();
    let several = found.ways.len() > 1;
    let mark = |z: &Complex<f64>, sign: Sign, colour: usize, what: &str, of: &str| Mark {
        at: (z.re, z.im),
        sign,
        colour: Some(colour),
        name: if several { format!("{what} to {of}") } else { what.to_owned() },
    };
    if found.ways.is_empty() {
        marks.extend(found.modes.iter().map(|mode| mark(&mode.pole, Sign::Cross, 0, "poles", "")));
    }
    for (colour, (way, to)) in found.ways.iter().zip(&found.question.to).enumerate() {
        let poles = way.modes.iter().map(|mode| mark(&mode.pole, Sign::Cross, colour, "poles", &to.name));
        marks.extend(poles);
        let zeros = way.zeros.iter().flatten();
        marks.extend(zeros.map(|zero| mark(zero, Sign::Ring, colour, "zeros", &to.name)));
        let closed = way.margins.iter().flat_map(|margins| &margins.closed);
        marks.extend(
            closed.map(|pole| mark(pole, Sign::Plus, colour + 1, "poles of the closed loop", &to.name)),
        );
    }
    let all: Vec<Complex<f64>> = marks.iter().map(|mark| Complex::new(mark.at.0, mark.at.1)).collect();
    let Ground { range, lines, labels } = ground(&all, period.is_some());
    let heading = if found.question.from.is_some() { title(found, "") } else { found.title.clone() };
    let plane = Plane {
        title: format!("{heading}: poles{}", if found.ways.is_empty() { "" } else { " and zeros" }),
        axes: axes(period.is_some()),
        range,
        equal: period.is_some(),
        size: SIZE,
        lines,
        marks,
        labels,
    };
    plane_svg(&plane, theme)
}

/// Names of the axes.
pub(super) fn axes(is_sampled: bool) -> (String, String) {
    match is_sampled {
        true => ("real part of z".to_owned(), "imaginary part of z".to_owned()),
        false => ("real part [rad/s]".to_owned(), "imaginary part [rad/s]".to_owned()),
    }
}

/// What lies behind poles and zeros.
pub(super) struct Ground {
    pub range: [f64; 4],
    pub lines: Vec<Line>,
    pub labels: Vec<Label>,
}

/// Range and guides for these points.
pub(super) fn ground(all: &[Complex<f64>], is_sampled: bool) -> Ground {
    if is_sampled {
        let corners = [Complex::new(-1.05, -1.05), Complex::new(1.05, 1.05)];
        let range = around(all.iter().copied().chain(corners));
        let mut lines = vec![circle((0.0, 0.0), 1.0)];
        let mut labels = Vec::new();
        // Of equal damping: z = exp((-d + j) a), with a from 0 to the turn of pi.
        for damping in DAMPING {
            let slope = damping / (1.0_f64 - damping * damping).sqrt();
            let at = |k: i32| {
                Complex::from_polar(1.0, std::f64::consts::PI * f64::from(k) / 60.0)
                    * (-slope * std::f64::consts::PI * f64::from(k) / 60.0).exp()
            };
            let upper: Vec<(f64, f64)> = (0..=60).map(|k| (at(k).re, at(k).im)).collect();
            let lower = upper.iter().map(|p| (p.0, -p.1)).collect();
            let top = upper[24];
            labels.push(Label { at: top, text: format!("{damping}") });
            lines.push(Line { style: Style::Limit, courses: vec![upper, lower], ..Line::default() });
        }
        return Ground { range, lines, labels };
    }
    let size = all.iter().map(|z| z.norm()).fold(0.0, f64::max);
    let size = if size > 0.0 { size } else { 1.0 };
    // The border and some of each half plane are seen.
    let corners = [Complex::new(0.08 * size, 0.0), Complex::new(-0.08 * size, 0.0)];
    let mut range = around(all.iter().copied().chain(corners));
    let least = 0.15 * size;
    range[2] = range[2].min(-least);
    range[3] = range[3].max(least);
    let (left, top) = (-range[0], range[3]);
    let mut lines = Vec::new();
    let mut labels = Vec::new();
    for damping in DAMPING {
        let up = (1.0_f64 - damping * damping).sqrt() / damping;
        // To the frame, whichever side comes first.
        let end = left.min(top / up);
        let rays = vec![vec![(0.0, 0.0), (-end, end * up)], vec![(0.0, 0.0), (-end, -end * up)]];
        lines.push(Line { style: Style::Limit, courses: rays, ..Line::default() });
        labels.push(Label { at: (-0.93 * end, 0.93 * end * up), text: format!("{damping}") });
    }
    Ground { range, lines, labels }
}
