//! What parameters are called elsewhere: in textbooks, in Simulink and Simscape, in the Modelica library.
//!
//! A name that a kind does not know is looked up here, and the first of our names that the kind has is suggested. Only names of
//! the same quantity stand together, so that the value need not change: a period is no frequency, a stall torque no rated
//! one.

/// Names of others in small letters without underscores, and ours, the likeliest first.
const SYNONYMS: &[(&[&str], &[&str])] = &[
    // Start values.
    (
        &[
            "initial",
            "initialvalue",
            "initialcondition",
            "initialconditions",
            "initialstate",
            "initialoutput",
            "ic",
            "init",
            "start",
            "startvalue",
            "xinit",
            "xstart",
            "y0",
            "x0",
            "ystart",
            "yinit",
            "outinit",
            "initialx",
            "vinit",
            "v0",
        ],
        &["x0", "y0", "v0", "z0", "initial", "before"],
    ),
    (&["initialvoltage", "vc", "vc0", "vstart", "u0"], &["v0"]),
    (&["initialcurrent", "istart", "il0", "i0"], &["i0", "i_a0"]),
    (
        &["initialvelocity", "v", "v0", "vstart", "vinit", "w0", "wstart", "initialspeed", "speed0"],
        &["v0", "w0", "velocity"],
    ),
    (
        &[
            "initialangle",
            "phi",
            "phistart",
            "phi0",
            "theta0",
            "theta",
            "angle0",
            "initialrotation",
            "phirel0",
            "q0",
            "s0",
            "srel0",
            "initialposition",
            "position0",
            "x0",
        ],
        &["phi0", "x0", "theta0", "position", "angle"],
    ),
    (&["initialfilter", "filter0", "derivative0"], &["d0"]),
    // Factors and functions.
    (&["gain", "factor", "k", "kp", "value", "multiplier"], &["k", "gain", "kp", "value"]),
    (&["p", "proportional", "proportionalgain", "kc", "pgain", "kr"], &["kp"]),
    (&["i", "integral", "integralgain", "igain"], &["ki"]),
    (&["d", "derivative", "derivativegain", "dgain", "kdd"], &["kd"]),
    (&["n", "nd", "filter", "filtercoefficient", "filterconstant"], &["n"]),
    (&["antiwindupmethod", "antiwindup", "antiwindupmode", "windup"], &["anti_windup"]),
    (&["backcalculationcoefficient", "backcalculation", "kt", "kaw"], &["kb"]),
    (
        &["function", "operator", "operation", "op", "fcn", "func", "relop", "mode", "type"],
        &["function", "operator", "form", "method", "model"],
    ),
    (
        &["inputs", "numinputs", "listofsigns", "iconshape", "sign", "n", "nin", "ports", "numberofinputs"],
        &["signs", "inputs", "operator"],
    ),
    (&["outputs", "numoutputs", "numberofoutputs", "nout"], &["outputs"]),
    (&["elements", "index", "indexes", "channel", "channels"], &["indices", "elements", "columns"]),
    (&["num", "numerator", "b", "zeros"], &["num"]),
    (&["den", "denominator", "a", "poles"], &["den"]),
    (&["power", "order", "exp"], &["exponent"]),
    (
        &["threshold", "thresh", "u2threshold", "constant", "limit", "level", "offset", "hitcrossingoffset"],
        &["threshold", "constant", "at"],
    ),
    (&["hitcrossingdirection", "edge"], &["direction"]),
    (&["const", "constantvalue", "val", "c", "k", "y"], &["value", "constant"]),
    (&["externalreset", "resettrigger", "resettype"], &["reset"]),
    // Times.
    (&["timeconstant", "t", "t1", "tc", "tau", "lag", "tf"], &["tau", "ts"]),
    (&["sampletime", "sampleperiod", "period", "dt", "tsample", "samplinginterval", "h", "t"], &["ts"]),
    (&["delaytime", "delay", "td", "deadtime", "lag", "timedelay", "tau"], &["delay", "steps"]),
    (&["delaylength", "numdelays", "samples", "length", "n"], &["steps"]),
    (&["phasedelay", "starttime", "t0"], &["delay", "time", "start", "after"]),
    (&["maximumdelay", "maxdelay", "delaymax"], &["max_delay"]),
    (&["steptime", "time", "t", "at"], &["time", "at"]),
    (&["initialvaluebefore", "initialvalue", "initial", "offset", "from"], &["before"]),
    (&["finalvalue", "final", "height", "to", "stepsize", "value"], &["after"]),
    (&["rate", "slope", "ramprate", "gradient"], &["slope"]),
    // Waves.
    (
        &["freq", "freqhz", "f", "fhz", "hz", "frequency"],
        &["frequency", "switching_frequency", "rated_frequency", "f_rated"],
    ),
    (
        &["amp", "ampl", "a", "peak", "peakvoltage", "peakamplitude", "height", "v", "u"],
        &["amplitude", "voltage"],
    ),
    (&["phaseshift", "phi", "phase0", "theta", "phaseangle"], &["phase"]),
    (&["offset", "dc", "mean", "bias"], &["bias"]),
    (&["pulsewidth", "duty", "dutycycle", "width"], &["width"]),
    (
        &["fpwm", "fsw", "carrierfrequency", "pwmfrequency", "switchingfrequency", "fswitch", "frequency"],
        &["switching_frequency"],
    ),
    // Limits.
    (
        &[
            "upper",
            "max",
            "maximum",
            "upperlimit",
            "uppersaturationlimit",
            "ymax",
            "umax",
            "outmax",
            "high",
            "phimax",
            "smax",
            "xmax",
            "upperbound",
            "limitmax",
        ],
        &["upper", "end"],
    ),
    (
        &[
            "lower",
            "min",
            "minimum",
            "lowerlimit",
            "lowersaturationlimit",
            "ymin",
            "umin",
            "outmin",
            "low",
            "phimin",
            "smin",
            "xmin",
            "lowerbound",
            "limitmin",
        ],
        &["lower", "start"],
    ),
    (&["startofdeadzone", "lowervalue", "deadzonestart"], &["start"]),
    (&["endofdeadzone", "uppervalue", "deadzoneend"], &["end"]),
    (&["risinglimit", "risingslewlimit", "maxrate", "up", "risingrate", "risinglimitrate"], &["rising"]),
    (&["fallinglimit", "fallingslewlimit", "minrate", "down", "fallingrate"], &["falling"]),
    (&["onswitchvalue", "switchonpoint", "onpoint", "upperthreshold", "bandupper", "on"], &["on_at"]),
    (&["offswitchvalue", "switchoffpoint", "offpoint", "lowerthreshold", "bandlower", "off"], &["off_at"]),
    (&["onoutputvalue", "outputwhenon", "onvalue"], &["on"]),
    (&["offoutputvalue", "outputwhenoff", "offvalue"], &["off"]),
    (&["backlashwidth", "deadbandwidth", "gap", "play", "b", "clearance"], &["width", "backlash"]),
    (&["quantizationinterval", "step", "resolution", "q", "quantum"], &["interval"]),
    // Tables.
    (
        &["breakpoints", "breakpointsfordimension1", "x", "inputvalues", "bp", "inputs", "xdata"],
        &["breakpoints", "rows"],
    ),
    (&["breakpointsfordimension1", "bp1", "u1", "x"], &["rows"]),
    (&["breakpointsfordimension2", "bp2", "u2", "y"], &["columns"]),
    (&["tabledata", "outputvalues", "values", "y", "data", "ydata", "z"], &["table"]),
    (&["interpmethod", "interpolationmethod", "smoothness", "lookupmethod"], &["interpolation"]),
    (&["extrapmethod", "extrapolationmethod", "outside"], &["extrapolation"]),
    (&["filename", "path", "source"], &["file"]),
    // Electrical.
    (&["resistance", "rs", "ra", "r0", "armatureresistance", "ohm", "ohms"], &["r", "r_s"]),
    (&["inductance", "la", "l0", "armatureinductance", "henry"], &["l"]),
    (&["capacitance", "farad"], &["c"]),
    (&["voltage", "u", "dcvoltage", "vdc", "amplitude"], &["v", "vdc", "voltage"]),
    (&["torqueconstant", "kt", "ke", "kv", "backemfconstant", "emfconstant", "kphi", "kemf"], &["k"]),
    (&["polepairs", "p", "np", "zp", "numberofpolepairs", "npolepairs"], &["pole_pairs"]),
    (&["forwardvoltage", "vf", "vfwd", "vknee", "vdrop"], &["v_f"]),
    (&["onresistance", "ron", "rdson", "rclosed", "rds"], &["r_on"]),
    (&["offconductance", "gopen", "goff"], &["g_off"]),
    (&["ratedpower", "nominalpower", "pn", "pnominal"], &["rated_power", "power"]),
    (&["ratedvoltage", "nominalvoltage", "vn", "vnominal"], &["rated_voltage", "v_rated", "voltage"]),
    (&["ratedspeed", "nominalspeed", "wn", "wnominal"], &["rated_speed", "speed"]),
    (&["ratedfrequency", "nominalfrequency", "fn", "fnominal"], &["rated_frequency", "f_rated", "frequency"]),
    (&["fluxlinkage", "psi", "psipm", "pmflux", "lambda"], &["flux"]),
    (&["ld"], &["l_d"]),
    (&["lq"], &["l_q"]),
    // Mechanical.
    (&["inertia", "momentofinertia", "jrotor", "rotorinertia", "theta"], &["j", "moi"]),
    (&["mass"], &["m"]),
    (&["m", "weight"], &["mass"]),
    (
        &["stiffness", "springrate", "springconstant", "c", "k", "springstiffness", "cspring"],
        &["k", "stiffness"],
    ),
    (
        &[
            "damping",
            "dampingcoefficient",
            "d",
            "b",
            "viscousdamping",
            "viscousfriction",
            "dampingconstant",
            "dampingfactor",
        ],
        &["d", "damping", "viscous"],
    ),
    (&["coulombfriction", "coulombfrictiontorque", "coulombtorque", "tc", "fc"], &["coulomb"]),
    (
        &["breakawayfriction", "breakawaytorque", "breakawayforce", "static", "stiction", "staticfriction"],
        &["breakaway"],
    ),
    (
        &["stribeckvelocity", "vs", "breakawayspeed", "breakawayfrictionvelocity"],
        &["breakaway_velocity", "stribeck_velocity"],
    ),
    (&["gearratio", "ratio", "n", "i", "transmissionratio", "reduction"], &["ratio"]),
    (&["efficiency", "eta", "etamf"], &["losses", "efficiency"]),
    (&["torque", "t", "m", "tauconstant", "constanttorque", "moment"], &["tau", "torque"]),
    (&["force", "fconstant", "constantforce", "thrust"], &["f"]),
    (&["radius", "wheelradius", "rw", "pinionradius"], &["radius"]),
    (&["pitch", "screwlead", "p"], &["lead"]),
    (&["coefficientofrestitution", "e", "bounce", "restitutioncoefficient"], &["restitution"]),
    (&["centerofmass", "centreofmass", "cog", "cg", "rcm", "rcom"], &["com"]),
    (&["momentsofinertia", "inertiatensor", "ixx"], &["moi"]),
    (&["productsofinertia", "ixy"], &["poi"]),
    (&["restlength", "naturallength", "freelength", "l0"], &["length"]),
    (&["springequilibrium", "equilibriumposition", "restposition"], &["equilibrium"]),
    (&["axisofrotation", "rotationaxis", "n", "direction"], &["axis"]),
    (&["offset", "r", "xyz", "displacement", "position"], &["translation"]),
    (&["angles", "euler", "eulerangles", "orientation", "rollpitchyaw"], &["rpy", "rotation"]),
    (&["g", "gravityvector", "gravitationalacceleration"], &["gravity"]),
];

/// Of the parameters that a kind has, the one that means the same as a name that it does not have.
pub fn parameter<'a>(name: &str, known: impl Fn(&str) -> Option<&'a str>) -> Option<&'a str> {
    let plain = plain(name);
    let groups = SYNONYMS.iter().filter(|(others, _)| others.contains(&plain.as_str()));
    groups.flat_map(|(_, ours)| *ours).filter(|ours| **ours != name).find_map(|ours| known(ours))
}

/// A name in small letters without underscores.
fn plain(name: &str) -> String {
    name.chars().filter(|c| *c != '_').flat_map(char::to_lowercase).collect()
}

/// All names of ours that the table leads to.
pub fn parameters() -> impl Iterator<Item = &'static str> {
    SYNONYMS.iter().flat_map(|(_, ours)| ours.iter().copied())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_elsewhere_are_plain_and_stand_once_in_a_group() {
        for (others, ours) in SYNONYMS {
            let distinct: std::collections::BTreeSet<_> = others.iter().collect();
            assert_eq!(distinct.len(), others.len(), "{others:?}");
            assert!(others.iter().all(|name| plain(name) == *name), "{others:?}");
            assert!(!ours.is_empty());
        }
    }

    #[test]
    fn the_first_that_a_kind_has_is_meant() {
        let of = |names: &'static [&'static str]| {
            move |name: &str| names.iter().copied().find(|known| *known == name)
        };
        assert_eq!(parameter("InitialCondition", of(&["x0", "lower"])), Some("x0"));
        assert_eq!(parameter("initial_condition", of(&["y0"])), Some("y0"));
        assert_eq!(parameter("gain", of(&["k"])), Some("k"));
        assert_eq!(parameter("colour", of(&["k"])), None);
    }
}
