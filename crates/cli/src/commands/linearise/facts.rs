//! What is told of each way from the input to an output.

use blocksim_linear::{
    Channel, Complex, Delayed, Gain, LinearError, Margins, Mode, Reduced, Response, StateSpace, StepInfo,
    bandwidth, bandwidth_delayed, frequencies, is_stable, margins, margins_delayed, modes, poles,
    poles_by_part, reduced, static_gain, step_info, step_response, zeros,
};

use super::matrices::Linearised;

/// One way from the input to an output, without the states that have no part in it.
#[derive(Debug)]
pub struct Way {
    /// The channel itself; of one with dead times nothing but its rational part is a channel.
    pub law: Law,
    /// By how much, relative to its size, the response changed when states were left away.
    pub reduction: f64,
    /// Its poles.
    pub modes: Vec<Mode>,
    /// Its zeros, none if nothing comes through.
    pub zeros: Option<Vec<Complex<f64>>>,
    /// What a constant input leads to.
    pub gain: Gain,
    /// Where 3 dB are lost, rad/s.
    pub bandwidth: Option<f64>,
    /// How a step comes to its end.
    pub step: Option<StepInfo>,
    /// Of a loop: how far it is from its border.
    pub margins: Option<Margins>,
    /// Of a loop: the pole of the model with this loop closed that grows fastest, where none of the loop itself does. What it belongs to the
    /// loop does not reach or does not see.
    pub unseen: Option<Complex<f64>>,
    /// rad/s.
    pub frequencies: Vec<f64>,
    /// At each frequency.
    pub response: Vec<Complex<f64>>,
}

/// What passes from the input to an output.
#[derive(Debug, Clone)]
pub enum Law {
    /// A rational function.
    Rational(Channel),
    /// Dead times are on the way.
    Dead(Dead),
}

/// A way with dead times on it.
#[derive(Debug, Clone)]
pub struct Dead {
    /// The way.
    pub delayed: Delayed,
    /// Whether one of them feeds itself, which makes infinitely many poles.
    pub is_circular: bool,
    /// How many of these grow, where that is asked for and can be known.
    pub growing: Option<usize>,
}

impl Way {
    /// Time between two samples, s; none in continuous time.
    pub fn period(&self) -> Option<f64> {
        match &self.law {
            Law::Rational(channel) => channel.period,
            Law::Dead(_) => None,
        }
    }

    /// The response to a step, of a loop that of the closed one: times in s and values. Until it has come to its end, or for as long as
    /// tells where it goes; nothing where dead times are.
    pub fn step_course(&self) -> Option<Vec<(f64, f64)>> {
        let Law::Rational(channel) = &self.law else { return None };
        let closed = match &self.margins {
            Some(_) => Some(channel.closed()?),
            None => None,
        };
        let channel = closed.as_ref().unwrap_or(channel);
        let poles = poles(&channel.a).ok()?;
        let settling = step_info(channel).ok().flatten().map(|info| info.settling);
        let settled = settling.filter(|settling| settling.is_finite() && *settling > 0.0);
        // Slow poles with hardly any part in it would make it too long to see the rest.
        let end = settled.map_or_else(|| course_end(&poles, channel.period), |settling| 2.0 * settling);
        Some(step_response(channel, end, COURSE))
    }

    /// Number of states that take part, besides what is in dead times.
    pub fn order(&self) -> usize {
        match &self.law {
            Law::Rational(channel) => channel.order(),
            Law::Dead(dead) => dead.delayed.order(),
        }
    }
}

/// Points of the response to a step.
const COURSE: usize = 400;

/// How long a response to a step is looked at, s: six times the longest time constant of what dies down, three times the shortest of what
/// grows. What neither does nor grows is an integrator, or swings for ever.
fn course_end(poles: &[Complex<f64>], period: Option<f64>) -> f64 {
    let all = modes(poles, period);
    let rate = |mode: &Mode| mode.time_constant.abs().recip().min(f64::MAX);
    let fastest = all.iter().map(|mode| mode.frequency).filter(|w| w.is_finite()).fold(0.0, f64::max);
    // Slower than that is at rest, as an integrator is.
    let moves = |rate: &f64| *rate > 1e-6 * fastest;
    let grows = |mode: &&Mode| mode.time_constant < 0.0;
    let growth = all.iter().filter(grows).map(rate).fold(0.0, f64::max);
    let least = all.iter().map(rate).filter(moves).fold(f64::INFINITY, f64::min);
    let end = match (growth > 0.0, least.is_finite()) {
        (true, _) => 3.0 / growth,
        (false, true) => 6.0 / least,
        (false, false) if fastest > 0.0 => 20.0 / fastest,
        _ => period.map_or(1.0, |period| 50.0 * period),
    };
    period.map_or(end, |period| end.max(20.0 * period))
}

/// All poles of a model.
#[derive(Debug)]
pub struct Whole {
    /// Those of no way included, but for those of `constant`.
    pub modes: Vec<Mode>,
    /// States that nothing acts on, by number: they are as constant as parameters, and no poles of the dynamics.
    pub constant: Vec<usize>,
    /// States that keep what is added to them, and that nothing else reads.
    pub unread: Vec<usize>,
    /// Whether all others die out; `None` on the border.
    pub is_stable: Option<bool>,
}

/// Part of the fastest pole that rounding leaves of one at zero.
const ROUNDING: f64 = 1e-14;

/// All poles of the system.
///
/// # Errors
/// If the eigenvalues cannot be computed.
pub fn whole(linearised: &Linearised) -> Result<Whole, LinearError> {
    let StateSpace { a, b, period, .. } = &linearised.system;
    let n = a.nrows();
    let stays = if period.is_some() { 1.0 } else { 0.0 };
    let is_constant =
        |&i: &usize| b.row(i).amax() == 0.0 && (0..n).all(|j| a[(i, j)] == if i == j { stays } else { 0.0 });
    let (constant, moving): (Vec<usize>, Vec<usize>) = (0..n).partition(is_constant);
    let own = |states: &[usize]| a.select_rows(states).select_columns(states);
    // Of several integrators in a row this is the last one alone: what the others keep, it adds up for ever.
    let is_unread = |&j: &usize| (0..n).all(|i| a[(i, j)] == if i == j { stays } else { 0.0 });
    let (unread, read): (Vec<usize>, Vec<usize>) = moving.iter().partition(|&j| is_unread(j));
    let (deciding, fastest): (Vec<_>, Vec<_>) = poles_by_part(&own(&read))?.into_iter().unzip();
    // 1/s: how fast each dies out; what is slower than rounding stays.
    let rates = modes(&deciding, *period).into_iter().zip(fastest).map(|(mode, fastest)| {
        let least = ROUNDING * period.map_or(fastest, f64::recip);
        Some(mode.time_constant.recip()).filter(|rate| rate.abs() > least)
    });
    let rates: Vec<Option<f64>> = rates.collect();
    let grows = rates.iter().flatten().any(|rate| *rate < 0.0);
    let is_stable = if grows { Some(false) } else { rates.iter().all(Option::is_some).then_some(true) };
    Ok(Whole { modes: modes(&poles(&own(&moving))?, *period), constant, unread, is_stable })
}

/// How many poles of a model with dead times grow, if that can be known.
///
/// # Errors
/// As [`Delayed::growing`].
pub fn all_growing(linearised: &Linearised) -> Result<Option<usize>, LinearError> {
    let times: Vec<f64> = linearised.dead.iter().map(|dead| dead.1).collect();
    Delayed::whole(&linearised.system, &times).growing()
}

/// Whether a loop of the model leads through a dead time.
pub fn has_circle(linearised: &Linearised) -> bool {
    let times: Vec<f64> = linearised.dead.iter().map(|dead| dead.1).collect();
    Delayed::whole(&linearised.system, &times).is_circular()
}

/// What is told of the ways to all outputs.
///
/// # Errors
/// If the eigenvalues cannot be computed.
pub fn ways(linearised: &Linearised, is_loop: bool) -> Result<Vec<Way>, LinearError> {
    let outputs = linearised.system.c.nrows() - linearised.dead.len();
    let times: Vec<f64> = linearised.dead.iter().map(|dead| dead.1).collect();
    (0..outputs)
        .map(|output| {
            if times.is_empty() {
                return way(linearised, output, is_loop);
            }
            let delayed = Delayed::new(&linearised.system, output, &times);
            if delayed.is_rational() { way(linearised, output, is_loop) } else { dead_way(delayed, is_loop) }
        })
        .collect()
}

/// A way on which dead times are.
fn dead_way(delayed: Delayed, is_loop: bool) -> Result<Way, LinearError> {
    let poles = delayed.poles()?;
    let frequencies = delayed.frequencies()?;
    let response: Vec<Complex<f64>> = frequencies.iter().map(|&w| delayed.at(w)).collect();
    let passes = response.iter().any(|l| l.norm() > 0.0);
    // Of a loop that is not closed nobody asks.
    let growing = if is_loop { None } else { delayed.unstable().unwrap_or(None) };
    let is_stable = growing == Some(0);
    Ok(Way {
        modes: modes(&poles.clone().unwrap_or_default(), None),
        gain: delayed.static_gain()?,
        bandwidth: if is_stable { bandwidth_delayed(&delayed)? } else { None },
        step: None,
        margins: if is_loop { Some(margins_delayed(&delayed)?) } else { None },
        unseen: None,
        response,
        frequencies,
        zeros: passes.then(Vec::new),
        reduction: 0.0,
        law: Law::Dead(Dead { is_circular: poles.is_none(), growing, delayed }),
    })
}

fn way(linearised: &Linearised, output: usize, is_loop: bool) -> Result<Way, LinearError> {
    let Reduced { channel, error } = reduced(&linearised.system.channel(0, output));
    let period = channel.period;
    let poles = poles(&channel.a)?;
    let zeros = zeros(&channel)?;
    let margins = if is_loop { Some(margins(&channel)?) } else { None };
    let unseen = match &margins {
        Some(margins) if margins.stable => unseen(&linearised.system.channel(0, output))?,
        _ => None,
    };
    let closed = margins.iter().flat_map(|margins| &margins.closed);
    let all: Vec<Complex<f64>> = poles.iter().chain(closed).copied().collect();
    let frequencies = frequencies(&all, zeros.as_deref().unwrap_or_default(), period);
    let response = Response::new(&channel);
    Ok(Way {
        modes: modes(&poles, period),
        gain: static_gain(&channel, &poles),
        bandwidth: if is_stable(&poles, period) && !is_loop { bandwidth(&channel)? } else { None },
        step: if is_loop { None } else { step_info(&channel)? },
        margins,
        unseen,
        response: frequencies.iter().map(|&w| response.at(w)).collect(),
        frequencies,
        zeros,
        reduction: error,
        law: Law::Rational(channel),
    })
}

/// Growth of a pole, as a part of its size or of the unit circle, that no slope makes up.
const GROWS: f64 = 1e-4;

/// The pole of a system whose loop through a channel is closed that grows fastest, if one does for sure.
fn unseen(channel: &Channel) -> Result<Option<Complex<f64>>, LinearError> {
    let Some(closed) = channel.closed() else { return Ok(None) };
    let all = poles(&closed.a)?;
    let fastest = all.iter().map(|pole| pole.norm()).fold(0.0, f64::max);
    let growth = |pole: &Complex<f64>| match closed.period {
        Some(_) => pole.norm() - 1.0 - GROWS,
        None => pole.re - GROWS * pole.norm().max(GROWS * fastest),
    };
    let grows = all.into_iter().filter(|pole| growth(pole) > 0.0);
    Ok(grows.max_by(|a, b| growth(a).total_cmp(&growth(b))))
}

/// Magnitudes in dB.
pub fn decibels(response: &[Complex<f64>]) -> Vec<f64> {
    response.iter().map(|l| 20.0 * l.norm().log10()).collect()
}

/// Phases in degrees without jumps of a turn, the first one within -180 and 180, or -270 and 90 of what falls from -90.
pub fn degrees(response: &[Complex<f64>]) -> Vec<f64> {
    let mut turns = 0.0;
    let mut last: Option<f64> = None;
    let phase = |l: &Complex<f64>| {
        let raw = l.arg().to_degrees();
        // A real and negative start is a fall by half a turn, as that of a double integrator.
        let raw = if last.is_none() && raw > 179.0 { raw - 360.0 } else { raw };
        if let Some(last) = last {
            turns -= ((raw - last) / 360.0).round();
        }
        last = Some(raw);
        raw + 360.0 * turns
    };
    response.iter().map(phase).collect()
}
