//! What is found, as data.

use blocksim_linear::{Complex, DMatrix, Gain, Margin, Mode};
use serde_json::{Value, json};

use super::Found;
use super::facts::{Law, Way, decibels, degrees};
use super::matrices::{Hold, Stays};

/// Everything with all digits, in SI units, with the responses point by point if they are wanted.
pub fn json(found: &Found, with_curves: bool) -> Value {
    let (question, system) = (&found.question, &found.linearised);
    let open = question.open.iter().map(|place| json!({ "name": place.name, "unit": place.unit() }));
    let to = question.to.iter().zip(&system.values);
    let to = to.map(|(place, y)| json!({ "name": place.name, "unit": place.unit(), "value": y }));
    let held = system.held.iter().map(|(path, hold)| match hold {
        Hold::Sampled(period) => json!({ "path": path, "period": period }),
        Hold::Remembers => json!({ "path": path }),
    });
    let stays = |stays: Stays| -> Vec<&str> {
        system.modes.iter().filter(|mode| mode.1 == stays).map(|mode| mode.0.as_str()).collect()
    };
    let ways = found.ways.iter().zip(&question.to).map(|(way, to)| {
        let mut data = of_way(way, &to.name);
        if with_curves {
            data["curves"] = curves(way);
        }
        data
    });
    json!({
        "v": 1,
        "type": "linear",
        "title": found.title,
        "t": found.t,
        "steady": found.steady,
        "adrift": found.adrift,
        "loop": question.is_loop,
        "period": system.system.period,
        "from": question.from.as_ref().map(|from| json!({
            "name": from.name, "unit": from.unit(), "value": system.value,
        })),
        "dead_times": system.dead.iter().map(|(path, time)| json!({ "path": path, "time": time })).collect::<Vec<_>>(),
        "growing": found.growing,
        "constant": found.constant,
        "unread": found.unread,
        "following": system.following,
        "to": to.collect::<Vec<_>>(),
        "open": open.collect::<Vec<_>>(),
        "states": system.names.iter().zip(&system.x).map(|(name, x)| json!({ "name": name, "value": x })).collect::<Vec<_>>(),
        "a": matrix(&system.system.a),
        "b": matrix(&system.system.b),
        "c": matrix(&system.system.c),
        "d": matrix(&system.system.d),
        "accuracy": system.accuracy,
        "differences": { "blocks": system.method.blocks, "over": system.method.columns, "because": system.method.because },
        "not_smooth": system.kinks,
        "stuck": stays(Stays::Stuck),
        "limited": stays(Stays::Limited),
        "held": held.collect::<Vec<_>>(),
        "poles": found.modes.iter().map(mode).collect::<Vec<_>>(),
        "ways": ways.collect::<Vec<_>>(),
        "locus": found.locus.as_ref().map(|locus| locus.json()),
    })
}

fn of_way(way: &Way, to: &str) -> Value {
    let margin = |margin: &Margin| json!({ "value": margin.value, "frequency": margin.frequency });
    let margins = way.margins.as_ref().map(|margins| {
        json!({
            "gain": margins.gain.iter().map(margin).collect::<Vec<_>>(),
            "phase": margins.phase.iter().map(margin).collect::<Vec<_>>(),
            "delay": margins.delay.as_ref().map(margin),
            "sensitivity": margin(&margins.sensitivity),
            "closed_poles": margins.closed.iter().map(complex).collect::<Vec<_>>(),
            "growing": margins.growing,
            "stable": margins.stable,
            "unseen_pole": way.unseen.as_ref().map(complex),
        })
    });
    let dead = match &way.law {
        Law::Rational(_) => None,
        Law::Dead(dead) => Some(dead),
    };
    // Those of a way with dead times are not known.
    let zeros = way.zeros.as_ref().filter(|_| dead.is_none());
    let zeros = zeros.map(|zeros| zeros.iter().map(complex).collect::<Vec<_>>());
    json!({
        "to": to,
        "order": way.order(),
        "poles": way.modes.iter().map(mode).collect::<Vec<_>>(),
        "zeros": zeros,
        "dead_times": dead.map_or(&[][..], |dead| dead.delayed.times()),
        "infinitely_many_poles": dead.is_some_and(|dead| dead.is_circular),
        "growing": dead.and_then(|dead| dead.growing),
        "static_gain": match way.gain { Gain::Finite(gain) => Some(gain), Gain::Infinite => None },
        "bandwidth": way.bandwidth,
        "step": way.step.map(|step| json!({
            "overshoot": step.overshoot, "rise": step.rise, "settling": step.settling,
        })),
        "margins": margins,
    })
}

/// Magnitude in dB and phase in degrees over frequency in rad/s, the response as complex numbers, and the course of a step.
fn curves(way: &Way) -> Value {
    let response: Vec<Value> = way.response.iter().map(complex).collect();
    json!({
        "frequency": way.frequencies, "magnitude": decibels(&way.response), "phase": degrees(&way.response),
        "response": response, "step": way.step_course(),
    })
}

/// Row by row.
fn matrix(matrix: &DMatrix<f64>) -> Vec<Vec<f64>> {
    matrix.row_iter().map(|row| row.iter().copied().collect()).collect()
}

pub(super) fn complex(z: &Complex<f64>) -> Value {
    json!([z.re, z.im])
}

fn mode(mode: &Mode) -> Value {
    json!({
        "pole": complex(&mode.pole), "frequency": mode.frequency, "damping": mode.damping,
        "time_constant": mode.time_constant,
    })
}

/// Frequencies and, for each way, magnitude in dB and phase in degrees. Each way has frequencies of its own, so each has
/// rows of its own.
pub fn csv(found: &Found) -> String {
    let mut text = "to,frequency [rad/s],magnitude [dB],phase [deg],real,imaginary\n".to_owned();
    for (way, to) in found.ways.iter().zip(&found.question.to) {
        let name = if to.name.contains([',', '"']) {
            format!("\"{}\"", to.name.replace('"', "\"\""))
        } else {
            to.name.clone()
        };
        let (magnitudes, phases) = (decibels(&way.response), degrees(&way.response));
        for (n, (w, l)) in way.frequencies.iter().zip(&way.response).enumerate() {
            text.push_str(&format!("{name},{w},{},{},{},{}\n", magnitudes[n], phases[n], l.re, l.im));
        }
    }
    text
}
