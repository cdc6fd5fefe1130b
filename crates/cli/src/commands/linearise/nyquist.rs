//! The response in the complex plane as a drawing.

use std::f64::consts::TAU;

use blocksim_linear::{Complex, Gain};
use blocksim_numbers::format::significant;
use blocksim_picture::{Label, Line, Mark, Plane, Sign, Style, Theme, plane_svg};

use super::Found;
use super::bode::title;

/// Width of the drawing and height of its plot, dots.
pub(super) const SIZE: (f64, f64) = (720.0, 460.0);
/// Distance from the origin beyond which a response that grows without end is not shown.
const FAR: f64 = 3.0;
/// Same of one that ends somewhere.
const FARTHEST: f64 = 20.0;

/// The response over all frequencies, those below zero dashed, with the direction of rising frequencies. Of a loop the critical
/// point, the unit circle and the closest approach to the point.
pub fn drawing(found: &Found, theme: Theme) -> String {
    let is_loop = found.question.is_loop;
    let several = found.ways.len() > 1;
    let (mut lines, mut marks, mut labels) = (Vec::new(), Vec::new(), Vec::new());
    let mut all: Vec<Complex<f64>> = Vec::new();
    if is_loop {
        lines.push(circle((0.0, 0.0), 1.0));
        all.extend([Complex::new(-1.3, -1.1), Complex::new(1.1, 1.1)]);
    }
    for (colour, (way, to)) in found.ways.iter().zip(&found.question.to).enumerate() {
        let finite = || way.response.iter().copied().filter(|l| l.re.is_finite() && l.im.is_finite());
        let largest = finite().map(|l| l.norm()).fold(0.0, f64::max);
        // An integrator goes on without end.
        let far = match way.gain {
            Gain::Infinite => FAR,
            Gain::Finite(_) => FARTHEST,
        };
        let shown = if is_loop { largest.min(far) } else { largest };
        all.extend(finite().filter(|l| l.norm() <= 1.0001 * shown).flat_map(|l| [l, l.conj()]));
        let name = |what: &str| match several {
            true => format!("{}, frequencies {what} zero", to.name),
            false => format!("frequencies {what} zero"),
        };
        let rest = match way.gain {
            Gain::Finite(gain) => Some((gain, 0.0)),
            Gain::Infinite => None,
        };
        let curve: Vec<(f64, f64)> = rest.into_iter().chain(finite().map(|l| (l.re, l.im))).collect();
        let mirrored = curve.iter().map(|p| (p.0, -p.1)).collect();
        lines.push(Line {
            name: name("below"),
            colour,
            style: Style::Dashed,
            courses: vec![mirrored],
            ..Line::default()
        });
        lines.push(Line { name: name("above"), colour, courses: vec![curve.clone()], ..Line::default() });
        marks.extend(arrows(&curve, shown, colour));
        if let Some(margins) = &way.margins {
            let closest = margins.sensitivity;
            let near = way.frequencies.iter().zip(&way.response);
            let near = near.min_by(|a, b| (a.1 + 1.0).norm().total_cmp(&(b.1 + 1.0).norm()));
            if let Some((_, l)) = near {
                lines.push(Line {
                    name: format!(
                        "closest approach, {} at {}",
                        significant(1.0 / closest.value, 3),
                        match closest.frequency {
                            f64::INFINITY => "high frequencies".to_owned(),
                            frequency => format!("{} rad/s", significant(frequency, 3)),
                        }
                    ),
                    colour: colour + 1,
                    courses: vec![vec![(-1.0, 0.0), (l.re, l.im)]],
                    ..Line::default()
                });
            }
        }
    }
    if is_loop {
        marks.push(Mark {
            at: (-1.0, 0.0),
            sign: Sign::Plus,
            colour: None,
            name: "critical point".to_owned(),
        });
        labels.push(Label { at: (-1.0, 0.0), text: "-1".to_owned() });
    }
    let heading = found.ways.first().and_then(|way| way.margins.as_ref()).map(|margins| {
        let stable = if margins.stable { "stable" } else { "unstable" };
        format!(": {stable} when closed")
    });
    let plane = Plane {
        title: title(found, &heading.unwrap_or_default()),
        axes: ("real part".to_owned(), "imaginary part".to_owned()),
        range: around(all.iter().copied()),
        equal: true,
        size: SIZE,
        lines,
        marks,
        labels,
    };
    plane_svg(&plane, theme)
}

/// A circle as a limit.
pub(super) fn circle(middle: (f64, f64), radius: f64) -> Line {
    let at = |k: i32| {
        let (sin, cos) = (f64::from(k) * TAU / 180.0).sin_cos();
        (middle.0 + radius * cos, middle.1 + radius * sin)
    };
    Line { style: Style::Limit, courses: vec![(0..=180).map(at).collect()], ..Line::default() }
}

/// The range of these points with some room.
pub(super) fn around(all: impl Iterator<Item = Complex<f64>>) -> [f64; 4] {
    let mut range = [f64::INFINITY, f64::NEG_INFINITY, f64::INFINITY, f64::NEG_INFINITY];
    for z in all {
        range = [range[0].min(z.re), range[1].max(z.re), range[2].min(z.im), range[3].max(z.im)];
    }
    let (across, upwards) = (range[1] - range[0], range[3] - range[2]);
    let room = 0.06 * across.max(upwards).max(1e-12 * range[1].abs().max(range[0].abs()));
    [range[0] - room, range[1] + room, range[2] - room, range[3] + room]
}

/// Arrows where a curve has gone a third and two thirds of its way within the shown part.
fn arrows(curve: &[(f64, f64)], shown: f64, colour: usize) -> Vec<Mark> {
    let inside = |p: &(f64, f64)| p.0.hypot(p.1) <= 1.0001 * shown;
    let mut gone = Vec::with_capacity(curve.len());
    let mut way = 0.0;
    for pair in curve.windows(2) {
        if inside(&pair[0]) && inside(&pair[1]) {
            way += (pair[1].0 - pair[0].0).hypot(pair[1].1 - pair[0].1);
        }
        gone.push(way);
    }
    let at = |share: f64| {
        let n = gone.iter().position(|gone| *gone >= share * way)?;
        let (from, to) = (curve[n], curve[n + 1]);
        (from != to).then(|| Mark {
            at: from,
            sign: Sign::Arrow(to),
            colour: Some(colour),
            name: String::new(),
        })
    };
    if way == 0.0 { Vec::new() } else { [0.3, 0.7].into_iter().filter_map(at).collect() }
}
