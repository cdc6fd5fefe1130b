use super::super::samples;
use super::*;

/// What a machine would have on its plate, with windings for 400 V at 50 Hz and the slip that is called rated.
fn plate_of(circuit: &Circuit, slip: f64) -> NamePlate {
    let rated = circuit.steady_state(1.0, 1.0, slip);
    let locked = circuit.steady_state(1.0, 1.0, 1.0);
    let (apparent, shaft) = (rated.i_s.abs(), rated.torque * (1.0 - slip));
    let (ratio, locked_rotor) = match circuit.cages {
        Cages::Single { l, .. } => (circuit.l_ls / l, None),
        Cages::Double { l, .. } => {
            let (torque, current) = (locked.torque / rated.torque, locked.i_s.abs() / apparent);
            (circuit.l_ls / l[1], Some(LockedRotor { torque, current }))
        }
    };
    NamePlate {
        power: 15e3 * shaft,
        voltage: 400.0,
        frequency: 50.0,
        pole_pairs: 2,
        slip,
        power_factor: rated.i_s.re / apparent,
        efficiency: shaft / rated.i_s.re,
        mechanical_loss: 0.0,
        breakdown_torque: circuit.breakdown(1.0, 1.0).1 / rated.torque,
        locked_rotor,
        leakage_ratio: ratio,
        tolerance: 0.0,
    }
}

/// All parameters, in units of the base of 15 kVA that [`plate_of`] takes.
fn parameters(circuit: &Circuit, scale: f64) -> Vec<f64> {
    let mut list = vec![circuit.r_s, circuit.l_ls, circuit.magnetisation.unsaturated()];
    match circuit.cages {
        Cages::Single { r, l } => list.extend([r, l]),
        Cages::Double { r, l, .. } => list.extend([r[0], l[0], r[1], l[1]]),
    }
    list.iter().map(|value| value * scale).collect()
}

fn recovered(circuit: &Circuit, slip: f64, digits: f64) {
    let plate = plate_of(circuit, slip);
    let found = plate.circuit().unwrap_or_else(|error| panic!("{slip}: {error:?}"));
    let scale = plate.base().z / Base::of(15e3, 400.0, 50.0, 2).z;
    let (found, expected) = (parameters(&found, scale), parameters(circuit, 1.0));
    for (found, expected) in found.iter().zip(&expected) {
        assert!((found / expected - 1.0).abs() < digits, "slip {slip}: {found} instead of {expected}");
    }
}

#[test]
fn a_single_cage_is_recovered_from_its_own_name_plate() {
    for slip in [0.01, 0.02, 0.03, 0.05] {
        recovered(&samples::single(), slip, 1e-6);
    }
}

#[test]
fn two_cages_are_recovered_from_their_own_name_plate() {
    let double = samples::double;
    recovered(&double(), 0.015, 1e-5);
    recovered(&double(), 0.025, 1e-5);
    let other = |r_s, l_ls, x_m, r, l| Circuit {
        r_s,
        l_ls,
        magnetisation: Magnetisation::linear(x_m),
        cages: Cages::Double { r, l, common: 0.0 },
        l_0: None,
    };
    recovered(&other(0.035, 0.06, 2.0, [0.03, 0.08], [0.09, 0.06]), 0.03, 1e-5);
    recovered(&other(0.008, 0.1, 3.5, [0.01, 0.2], [0.2, 0.1]), 0.008, 1e-5);
    recovered(&other(0.02, 0.05, 3.0, [0.02, 0.3], [0.12, 0.05]), 0.02, 1e-5);
}

/// A motor with four poles as catalogues list it: power (W), speed (rpm), efficiency, power factor, breakdown torque, torque
/// and current at standstill.
fn catalogue(
    [power, rpm, efficiency, power_factor, breakdown_torque, torque, current]: [f64; 7],
) -> NamePlate {
    NamePlate {
        power,
        voltage: 400.0,
        frequency: 50.0,
        pole_pairs: 2,
        slip: 1.0 - rpm / 1500.0,
        power_factor,
        efficiency,
        mechanical_loss: 0.0,
        breakdown_torque,
        locked_rotor: Some(LockedRotor { torque, current }),
        leakage_ratio: 1.0,
        tolerance: 0.0,
    }
}

const LARGE: [f64; 7] = [37e3, 1482.0, 0.939, 0.85, 2.8, 2.6, 7.0];
const SMALL: [f64; 7] = [4e3, 1460.0, 0.886, 0.81, 3.2, 2.6, 7.3];

#[test]
fn the_circuit_of_a_catalogue_motor_has_its_figures() {
    for loss in [0.0, 0.01, 0.02] {
        let plate = NamePlate { mechanical_loss: loss * 37e3, ..catalogue(LARGE) };
        let (circuit, base) = (plate.circuit().unwrap(), plate.base());
        let rated = circuit.steady_state(1.0, 1.0, plate.slip);
        assert!((rated.i_s.abs() - 1.0).abs() < 1e-9 && (rated.i_s.re - 0.85).abs() < 1e-9, "{rated:?}");
        let speed = (1.0 - plate.slip) / base.speed;
        let shaft = base.t * rated.torque * speed - plate.mechanical_loss;
        assert!((shaft - 37e3).abs() < 1e-4, "{shaft}");
        // Three windings take 3 V I cos(phi).
        let drawn = 3.0 * 400.0 * base.i / 2.0_f64.sqrt() * rated.i_s.re;
        assert!((37e3 / drawn - 0.939).abs() < 1e-9, "{drawn}");
        let locked = circuit.steady_state(1.0, 1.0, 1.0);
        assert!((locked.i_s.abs() - 7.0).abs() < 1e-8 && (locked.torque / rated.torque - 2.6).abs() < 1e-8);
        assert!((circuit.breakdown(1.0, 1.0).1 / rated.torque - 2.8).abs() < 1e-8);
        let single = NamePlate { locked_rotor: None, ..plate }.circuit().unwrap();
        assert!((single.breakdown(1.0, 1.0).1 / rated.torque - 2.8).abs() < 1e-8);
    }
}

#[test]
fn figures_that_no_circuit_has_are_listed_with_the_nearest() {
    let error = catalogue(SMALL).circuit().unwrap_err();
    assert_eq!(error.param, "locked_rotor.current");
    assert_eq!(
        error.message,
        "no circuit with two cages has all these figures; the nearest deviates: rated torque +0.8 %, \
         rated reactive power +0.2 %, breakdown torque +2.7 %, torque at standstill +0.1 %, current at standstill -3.5 %"
    );
    let help = "check the figures, change `leakage_ratio`, or accept it with `tolerance: \"4 %\"`";
    assert_eq!(error.help.as_deref(), Some(help));
    let circuit = NamePlate { tolerance: 0.04, ..catalogue(SMALL) }.circuit().unwrap();
    assert!((circuit.steady_state(1.0, 1.0, 1.0).i_s.abs() / 7.3 - 1.0).abs() < 0.04);
}

#[test]
fn figures_that_contradict_each_other_are_refused() {
    let plate = catalogue(LARGE);
    let refused = |plate: NamePlate| {
        let mut errors = ParamErrors::default();
        plate.validate(&mut errors);
        errors[0].clone()
    };
    // At this slip the rotor alone loses 1.2 %.
    let error = refused(NamePlate { efficiency: 0.99, ..plate });
    assert_eq!(error.param, "efficiency");
    assert_eq!(
        error.message,
        "`efficiency` is 0.9900, but at a slip of 0.0120 the rotor alone leaves no more than 0.9880"
    );
    assert_eq!(refused(NamePlate { slip: 0.0, ..plate }).param, "speed");
    let locked = |torque, current| {
        refused(NamePlate { locked_rotor: Some(LockedRotor { torque, current }), ..plate }).param
    };
    assert_eq!(locked(2.9, 7.0), "locked_rotor.torque");
    assert_eq!(locked(2.0, 1.5), "locked_rotor.current");
    assert_eq!(locked(0.0, 7.0), "locked_rotor.torque");
    // A leakage that lets so little torque through takes more reactive power than there is.
    let weak = NamePlate { breakdown_torque: 1.05, locked_rotor: None, ..plate };
    assert!(
        weak.circuit()
            .unwrap_err()
            .message
            .starts_with("no circuit with a single cage has all these figures")
    );
}
