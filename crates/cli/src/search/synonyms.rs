//! Words that mean the same to those who look for something.

/// Groups of words of which each finds the others.
pub const SYNONYMS: &[&[&str]] = &[
    &["add", "sum", "subtract", "plus", "minus", "difference"],
    &["angle", "orientation", "attitude"],
    &["asynchronous", "induction"],
    &["axis", "joint"],
    &["backlash", "play", "slack", "clearance"],
    &["battery", "source", "supply"],
    &["brushless", "bldc", "pmsm", "permanent", "synchronous"],
    &["capacitor", "capacitance", "condenser"],
    &["change", "set", "override"],
    &["clutch", "coupling"],
    &["coil", "inductor", "inductance", "choke"],
    &["collision", "contact", "touch", "hit"],
    &["column", "signal"],
    &["compare", "difference", "agree", "diff"],
    &["constraint", "algebraic", "implicit"],
    &["controller", "control", "regulator", "pid"],
    &["converter", "inverter"],
    &["count", "counter", "counting"],
    &["damper", "damping", "viscous", "dashpot"],
    &["deadtime", "delay", "latency"],
    &["derivative", "differentiate", "differentiator"],
    &["divide", "quotient", "division"],
    &["draw", "drawing", "picture", "graph", "plot", "figure", "chart", "diagram"],
    &["elastic", "spring", "stiffness", "compliance"],
    &["equation", "differential", "formula"],
    &["error", "problem", "message", "warning"],
    &["excel", "workbook", "spreadsheet", "xlsx", "libreoffice"],
    &["exponent", "power", "square", "root"],
    &["export", "save", "write", "csv"],
    &["filter", "lowpass", "lag", "pt1", "smoothing"],
    &["flywheel", "inertia", "mass"],
    &["friction", "coulomb", "stribeck", "stiction", "stick"],
    &["gain", "multiply", "amplifier", "factor"],
    &["gear", "gearbox", "transmission", "reducer", "reduction"],
    &["gravity", "weight"],
    &["heat", "thermal", "temperature"],
    &["hold", "sample", "zoh", "sampled"],
    &["hydraulic", "fluid", "oil", "pressure"],
    &["integrate", "integrator", "integral"],
    &["join", "mux", "concatenate", "vector"],
    &["limit", "saturation", "clip", "clamp", "saturate", "bound"],
    &["linearise", "linearize", "linearisation", "linearization", "bode", "poles", "margin"],
    &["load", "payload"],
    &["lookup", "table", "interpolation", "characteristic"],
    &["loss", "efficiency", "dissipation"],
    &["magnetic", "reluctance", "flux", "mmf", "core"],
    &["magnitude", "absolute", "abs"],
    &["manipulator", "robot", "arm"],
    &["manual", "help", "documentation", "page", "guide"],
    &["matlab", "mat"],
    &["matrix", "matrices", "transpose"],
    &["maximum", "max", "greatest", "largest", "minimum", "min", "least"],
    &["method", "solver", "integrator", "ode"],
    &["motor", "machine", "drive"],
    &["move", "motion", "trajectory", "path"],
    &["noise", "random", "stochastic"],
    &["orifice", "throttle", "restriction", "nozzle"],
    &["parameter", "value", "constant"],
    &["product", "multiply", "times"],
    &["pump", "displacement"],
    &["rectifier", "diode"],
    &["resistor", "resistance"],
    &["result", "recording", "run", "output"],
    &["round", "floor", "ceil", "trunc", "rounding"],
    &["scope", "display", "show", "record"],
    &["sensor", "measure", "measurement", "probe"],
    &["speed", "velocity"],
    &["split", "demux"],
    &["spool", "valve", "directional"],
    &["step", "jump"],
    &["stop", "end", "duration", "until"],
    &["tank", "reservoir"],
    &["switch", "contact", "breaker", "contactor"],
    &["template", "project", "new", "start", "init"],
    &["test", "assertion", "assert"],
    &["tolerance", "accuracy", "rtol", "precision"],
    &["torque", "moment"],
    &["transistor", "mosfet", "igbt", "semiconductor"],
    &["triangle", "sawtooth"],
    &["tune", "vary", "sweep", "sensitivity"],
    &["unit", "dimension"],
    &["wheel", "pinion", "axle"],
];

/// Names of blocks in Simulink, Simscape and the Modelica library, in small letters without spaces, whose words do not lead
/// to ours by themselves.
const ELSEWHERE: &[(&str, &[&str])] = &[
    ("4waydirectionalvalve", &["DirectionalValve"]),
    ("6dofjoint", &["FreeJoint"]),
    ("bandlimitedwhitenoise", &["Noise"]),
    ("bricksolid", &["Body"]),
    ("combitable1d", &["LookupTable1D"]),
    ("combitable1ds", &["LookupTable1D"]),
    ("combitable2d", &["LookupTable2D"]),
    ("combitimetable", &["FromFile"]),
    ("constantvolumehydraulicchamber", &["FluidVolume"]),
    ("counterfreerunning", &["Counter"]),
    ("counterlimited", &["Counter"]),
    ("detectchange", &["EdgeDetector"]),
    ("detectfallnegative", &["EdgeDetector"]),
    ("detectrisepositive", &["EdgeDetector"]),
    ("differentiator", &["Derivative"]),
    ("display", &["Scope"]),
    ("doubleactinghydrauliccylinder", &["HydraulicCylinder"]),
    ("electromagneticconverter", &["MagneticWinding"]),
    ("fcn", &["Expression", "Function"]),
    ("filesolid", &["Body"]),
    ("firstorder", &["LowPass"]),
    ("fixeddisplacementpump", &["HydraulicPump"]),
    ("fixedorifice", &["Orifice"]),
    ("flywheel", &["Inertia"]),
    ("fromspreadsheet", &["FromFile"]),
    ("fromworkspace", &["FromFile"]),
    ("gaschargedaccumulator", &["Accumulator"]),
    ("gimbaljoint", &["SphericalJoint"]),
    ("ground", &["ElectricalReference", "RotationalReference", "TranslationalReference"]),
    ("hydraulicpipeline", &["HydraulicPipe"]),
    ("hydraulicreference", &["Tank"]),
    ("hypot", &["Function"]),
    ("idealrotationalmotionsensor", &["MotionSensor"]),
    ("idealtranslationalmotionsensor", &["TranslationalMotionSensor"]),
    ("ifaction", &["IfElse"]),
    ("ifactionsubsystem", &["IfElse", "Merge"]),
    ("indexvector", &["MultiportSwitch"]),
    ("limiter", &["Saturation"]),
    ("linearhydraulicresistance", &["HydraulicResistance"]),
    ("logicaloperator", &["Logic"]),
    ("mathfunction", &["Function"]),
    ("matlabfunction", &["Expression", "OdeSystem"]),
    ("matrixmultiply", &["Product", "Gain"]),
    ("mechanicalrotationalreference", &["RotationalReference"]),
    ("mechanicaltranslationalreference", &["TranslationalReference"]),
    ("mechanismconfiguration", &["World"]),
    ("mod", &["Function"]),
    ("onewaybearing", &["OneWayClutch"]),
    ("pmac", &["PermanentMagnetMachine"]),
    ("pressurereliefvalve", &["ReliefValve"]),
    ("pulsegenerator", &["Pulse"]),
    ("randomnumber", &["Noise"]),
    ("ratelimiterdynamic", &["RateLimiter"]),
    ("ratetransition", &["ZeroOrderHold"]),
    ("relationaloperator", &["Compare"]),
    ("repeatingsequence", &["SignalBuilder", "Sawtooth"]),
    ("rigidtransform", &["Transform"]),
    ("roundingfunction", &["Function"]),
    ("saturationdynamic", &["Saturation"]),
    ("signaleditor", &["SignalBuilder"]),
    ("signalgenerator", &["Sine", "Pulse", "Sawtooth", "Noise"]),
    ("sinewave", &["Sine"]),
    ("solid", &["Body"]),
    ("springdamper", &["RotationalSpringDamper", "TranslationalSpringDamper", "FrameSpringDamper"]),
    ("starpoint", &["FloatingNeutral", "NeutralPoint", "GroundedNeutral"]),
    ("stopsimulation", &["Stop"]),
    ("switchcaseactionsubsystem", &["SwitchCase", "Merge"]),
    ("terminatesimulation", &["Stop"]),
    ("timetable", &["SignalBuilder"]),
    ("tofile", &["Scope"]),
    ("toworkspace", &["Scope"]),
    ("transferfcn", &["TransferFunction"]),
    ("triangle", &["Sawtooth"]),
    ("trigonometricfunction", &["Function", "Atan2"]),
    ("uniformnoise", &["Noise"]),
    ("uniformrandomnumber", &["Noise"]),
    ("unitdelayexternalic", &["UnitDelay"]),
    ("unitdelayresettable", &["UnitDelay"]),
    ("universalbridge", &["SixPulseInverter", "RectifierBridge"]),
    ("variantsubsystem", &["Variant"]),
    ("weld", &["WeldJoint"]),
    ("wye", &["FloatingNeutral", "NeutralPoint", "GroundedNeutral"]),
    ("xygraph", &["XyScope"]),
    ("zoh", &["ZeroOrderHold"]),
];

/// Kinds of block for a name of another program, in small letters without spaces.
pub fn elsewhere(name: &str) -> &'static [&'static str] {
    ELSEWHERE.iter().find(|(other, _)| *other == name).map_or(&[], |(_, kinds)| kinds)
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::kinds;
    use blocksim_diagram::HIERARCHY;

    #[test]
    fn names_elsewhere_are_sorted_and_lead_to_kinds_that_exist() {
        assert!(ELSEWHERE.is_sorted_by_key(|(name, _)| *name));
        let ours = kinds().into_iter().map(|info| info.kind);
        let all: Vec<&str> = ours.chain(HIERARCHY.iter().map(|info| info.kind)).collect();
        for (name, ours) in ELSEWHERE {
            assert!(ours.iter().all(|kind| all.contains(kind)), "{name}: {ours:?}");
            assert!(!all.iter().any(|kind| kind.to_lowercase() == *name), "{name} is one of ours");
        }
    }

    #[test]
    fn no_word_stands_twice_in_a_group() {
        for group in SYNONYMS {
            let distinct: std::collections::BTreeSet<_> = group.iter().collect();
            assert_eq!(distinct.len(), group.len(), "{group:?}");
        }
    }
}
