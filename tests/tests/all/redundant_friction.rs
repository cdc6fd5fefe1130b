//! Several dry frictions that hold the same parts: what they bear together, against closed forms.

use blocksim_tests::{close, run_blocks};

const SOLVERS: [&str; 11] = [
    "Auto",
    "Ode45",
    "Ode23",
    "Dop853",
    "Ode15s",
    "Radau5",
    "Rodas4",
    "Ode23tb",
    "Ode23t",
    "RosW3",
    "Ode4(step: 1e-3)",
];

/// Three discs, a clutch between each two. A torque between `a` and `b` grows: the clutch `ab` bears what it can, and the
/// way over `c` the lower one of its two. An even share would be too much for `ab` long before.
#[test]
fn a_triangle_of_clutches_gives_way_when_all_ways_are_full() {
    for (ab, bc, ca) in [(1.0, 5.0, 7.0), (4.0, 2.0, 9.0), (6.0, 9.0, 0.5), (3.0, 3.0, 3.0), (0.0, 4.0, 4.0)]
    {
        for solver in SOLVERS {
            let full = ab + f64::min(bc, ca);
            let start = full / 4.0;
            let run = run_blocks(
                &format!("{:?} s", start + 0.4),
                solver,
                &format!(
                    r#""ramp": Ramp(slope: "4 N*m/s"), "one": Constant(value: 1.0),
                       "forward": IdealTorqueSource, "back": IdealTorqueSource, "minus": Gain(k: -1.0),
                       "a": Inertia(j: 0.5), "b": Inertia(j: 0.5), "c": Inertia(j: 0.5),
                       "ab": Clutch(torque: {ab:?}), "bc": Clutch(torque: {bc:?}), "ca": Clutch(torque: {ca:?}),
                       "sa": MotionSensor, "sb": MotionSensor, "sc": MotionSensor, "frame": RotationalReference,
                       "scope": Scope(inputs: ["a", "b", "c"])"#
                ),
                r#""one.y -> ab.normal, bc.normal, ca.normal", "ramp.y -> forward.tau, minus.u", "minus.y -> back.tau",
                   "forward.r <-> a.r <-> ab.r <-> ca.c <-> sa.r", "back.r <-> b.r <-> ab.c <-> bc.r <-> sb.r",
                   "c.r <-> bc.c <-> ca.r <-> sc.r",
                   "forward.c <-> back.c <-> sa.c <-> sb.c <-> sc.c <-> frame.r",
                   "sa.w -> scope.a", "sb.w -> scope.b", "sc.w -> scope.c""#,
            );
            let fixed = if solver.contains("step") { 4e-3 } else { 1e-6 };
            let ends = run.column("scope.a").iter().zip(run.column("scope.b"));
            for (t, (a, b)) in run.time.iter().zip(ends) {
                assert!(
                    *t > start - 1e-9 || a == b,
                    "{solver}, {ab} {bc} {ca}: moves at {t} s, due {start} s"
                );
            }
            // From then on the rest accelerates `a` forward; `c` goes with the end whose clutch holds.
            let impulse = 2.0 * 0.4 * 0.4;
            let (a, b, c) = (run.last("scope.a"), run.last("scope.b"), run.last("scope.c"));
            let what = format!("{solver}, {ab} {bc} {ca}");
            close(a + b + c, 0.0, fixed * (1.0 + impulse), &what);
            if bc == ca {
                close(a, impulse / 0.5, fixed * (1.0 + impulse) * 10.0, &what);
                close(c, 0.0, fixed * (1.0 + impulse) * 10.0, &what);
            } else {
                // The weaker clutch slips; with the stronger one `c` and its end are one body of twice the inertia.
                let (lone, pair) = if bc < ca { (b, a) } else { (a, b) };
                close(lone.abs(), impulse / 0.5, fixed * (1.0 + impulse) * 10.0, &what);
                close(pair.abs(), impulse / 1.0, fixed * (1.0 + impulse) * 10.0, &what);
                close(c, pair, fixed * (1.0 + impulse) * 10.0, &what);
            }
        }
    }
}

/// Brakes on all three shafts of a differential, of which any two hold it.
#[test]
fn brakes_on_all_shafts_of_a_differential_hold_what_two_of_them_can() {
    for solver in SOLVERS {
        let run = run_blocks(
            "3 s",
            solver,
            r#""ramp": Ramp(slope: "2 N*m/s"), "push": IdealTorqueSource, "one": Constant(value: 1.0),
               "gear": PlanetaryGear(ring_teeth: 60, sun_teeth: 30),
               "js": Inertia(j: 0.1), "jr": Inertia(j: 0.1), "jc": Inertia(j: 0.1),
               "bs": Brake(torque: 0.25), "br": Brake(torque: 4.0), "bc": Brake(torque: 6.0),
               "sensor": MotionSensor, "frame": RotationalReference, "scope": Scope(inputs: ["w"])"#,
            r#""one.y -> bs.engaged, br.engaged, bc.engaged", "ramp.y -> push.tau",
               "gear.sun <-> js.r <-> bs.r <-> push.r <-> sensor.r", "gear.ring <-> jr.r <-> br.r",
               "gear.carrier <-> jc.r <-> bc.r",
               "push.c <-> bs.c <-> br.c <-> bc.c <-> sensor.c <-> frame.r", "sensor.w -> scope.w""#,
        );
        // At rest the sun bears 0.25 by its brake; the mesh takes T from it, 2 T from the ring and puts 3 T on the carrier,
        // which hold 4 and 6 N*m: the ring and the carrier give way at T = 2, both at once.
        let start = (0.25 + 2.0) / 2.0;
        for (t, w) in run.time.iter().zip(run.column("scope.w")) {
            assert!(*t > start - 1e-9 || *w == 0.0, "{solver}: moves at {t} s, due {start} s");
        }
        assert!(run.last("scope.w") > 1.0, "{solver}: it moves after {start} s: {}", run.last("scope.w"));
    }
}
