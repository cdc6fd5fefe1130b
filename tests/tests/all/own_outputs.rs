//! What parts of networks measure by themselves, without sensors.

use blocksim_tests::run_text;

const MODEL: &str = r#"Diagram(
    simulation: (stop_time: "1 s", solver: Ode45(rtol: 1e-10), output: Every("10 ms")),
    blocks: {
        "m": Mass(m: "2 kg"), "k": TranslationalSpring(k: "40 N/m", x0: "0.1 m"), "d": TranslationalDamper(d: "3 N*s/m"),
        "bed": TranslationalReference, "motion": TranslationalMotionSensor(x0: "0.1 m"),
        "j": Inertia(j: "0.5 kg*m^2", w0: "2 rad/s"), "gear": SimpleGear(ratio: 4, direction: Reversed),
        "wheel": Inertia(j: "0.1 kg*m^2"), "rd": RotationalDamper(d: "1 N*m*s/rad"), "rk": RotationalSpring(k: "30 N*m/rad"),
        "housing": RotationalReference, "turns": MotionSensor,
        "v": VoltageSource(v: "10 V"), "r": Resistor(r: "5 ohm"), "c": Capacitor(c: "50 mF"), "e": ElectricalReference,
    },
    connections: [
        "m.r <-> k.r <-> d.r <-> motion.r", "k.c <-> d.c <-> motion.c <-> bed.r",
        "j.r <-> gear.base", "gear.follower <-> wheel.r <-> rd.r <-> rk.r <-> turns.r",
        "rd.c <-> rk.c <-> turns.c <-> housing.r",
        "v.p <-> r.p", "r.n <-> c.p", "c.n <-> v.n <-> e.p",
    ],
    record: [
        "m.*", "k.*", "d.*", "motion.*", "j.*", "wheel.*", "rd.*", "rk.*", "turns.*", "r.*", "c.*",
    ],
)"#;

#[test]
fn motion_and_flow_of_parts_are_recorded_without_sensors() {
    let run = run_text(MODEL);
    assert!(run.error.is_none(), "{:?}", run.error);
    let of = |name: &str| run.column(name).to_vec();
    let same = |name: &str, expected: &dyn Fn(usize) -> f64, size: f64| {
        for (row, found) in of(name).into_iter().enumerate() {
            let expected = expected(row);
            assert!((found - expected).abs() < 1e-7 * size, "{name} at {row}: {found} instead of {expected}");
        }
    };
    // m x'' = -k x - d x', from x = 0.1 m at rest.
    let (decay, root) = (3.0 / 4.0, (20.0_f64 - 0.75 * 0.75).sqrt());
    let x = |t: f64| 0.1 * (-decay * t).exp() * ((root * t).cos() + decay / root * (root * t).sin());
    let v = |t: f64| -0.1 * (-decay * t).exp() * (root + decay * decay / root) * (root * t).sin();
    let t = |row: usize| run.time[row];
    same("k.x", &|row| x(t(row)), 0.1);
    same("k.f", &|row| 40.0 * x(t(row)), 4.0);
    same("m.v", &|row| v(t(row)), 0.5);
    same("m.a", &|row| -(40.0 * x(t(row)) + 3.0 * v(t(row))) / 2.0, 2.0);
    same("d.v", &|row| v(t(row)), 0.5);
    same("d.f", &|row| 3.0 * v(t(row)), 1.5);
    // A shaft turns against an implied ground, the follower the other way at a quarter of the speed of the base.
    let (w, a, phi) = (of("turns.w"), of("turns.a"), of("turns.phi"));
    same("wheel.w", &|row| w[row], 1.0);
    same("wheel.a", &|row| a[row], 10.0);
    same("j.w", &|row| -4.0 * w[row], 4.0);
    same("j.a", &|row| -4.0 * a[row], 40.0);
    same("rd.w", &|row| w[row], 1.0);
    same("rd.tau", &|row| w[row], 1.0);
    same("rk.tau", &|row| 30.0 * phi[row], 30.0);
    // The capacitor is charged through the resistor within 0.25 s.
    let charge = |row: usize| (-t(row) / 0.25).exp();
    same("r.v", &|row| 10.0 * charge(row), 10.0);
    same("r.i", &|row| 2.0 * charge(row), 2.0);
}
