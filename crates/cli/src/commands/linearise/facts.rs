//! What is told of each way from the input to an output.

use blocksim_linear::{
    Channel, Complex, Gain, LinearError, Margins, Mode, Reduced, Response, StepInfo, bandwidth, frequencies,
    is_stable, margins, modes, poles, reduced, static_gain, step_info, zeros,
};

use super::matrices::Linearised;

/// One way from the input to an output, without the states that have no part in it.
#[derive(Debug)]
pub struct Way {
    /// The channel itself.
    pub channel: Channel,
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
    /// rad/s.
    pub frequencies: Vec<f64>,
    /// At each frequency.
    pub response: Vec<Complex<f64>>,
}

/// All poles of the system, with those of no way.
///
/// # Errors
/// If the eigenvalues cannot be computed.
pub fn all_modes(linearised: &Linearised) -> Result<Vec<Mode>, LinearError> {
    Ok(modes(&poles(&linearised.system.a)?, linearised.system.period))
}

/// What is told of the ways to all outputs.
///
/// # Errors
/// If the eigenvalues cannot be computed.
pub fn ways(linearised: &Linearised, is_loop: bool) -> Result<Vec<Way>, LinearError> {
    (0..linearised.system.c.nrows()).map(|output| way(linearised, output, is_loop)).collect()
}

fn way(linearised: &Linearised, output: usize, is_loop: bool) -> Result<Way, LinearError> {
    let Reduced { channel, error } = reduced(&linearised.system.channel(0, output));
    let period = channel.period;
    let poles = poles(&channel.a)?;
    let zeros = zeros(&channel)?;
    let margins = if is_loop { Some(margins(&channel)?) } else { None };
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
        response: frequencies.iter().map(|&w| response.at(w)).collect(),
        frequencies,
        zeros,
        reduction: error,
        channel,
    })
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
