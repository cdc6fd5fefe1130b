//! Dry friction on the slide of a slider-crank: at its dead centres, and beside a mesh that sticks.

use std::f64::consts::PI;

use crate::plant::{Plant, close};

const FRICTION: f64 = 12.0;

/// A crank of 0.1 m and a rod of 0.3 m push a piston along dry friction; a gear drives the crank.
fn slider_crank(crank: &str, slide: &str, gear: &str) -> Plant {
    let crank = format!("RevoluteJoint(axis: (0.0, -1.0, 0.0), {crank})");
    let slide = format!("PrismaticJoint(axis: (1.0, 0.0, 0.0), {slide})");
    Plant::new(
        &[
            ("world", "World(gravity: (0.0, 0.0, 0.0))"),
            ("crank", &crank),
            ("wheel", "Body(mass: 1.0, moi: (0.1, 0.2, 0.1))"),
            ("throw", "Transform(translation: (0.1, 0.0, 0.0))"),
            ("pin", "RevoluteJoint(axis: (0.0, -1.0, 0.0))"),
            ("rod", "Body(mass: 0.5, com: (0.15, 0.0, 0.0), moi: (0.0, 0.004, 0.004))"),
            ("far", "Transform(translation: (0.3, 0.0, 0.0))"),
            ("wrist", "RevoluteJoint(axis: (0.0, -1.0, 0.0))"),
            ("slide", &slide),
            ("piston", "Body(mass: 0.4)"),
            (
                "guide",
                "TranslationalFriction(breakaway: 12.0, coulomb: 12.0, breakaway_velocity: 0.01, model: Stiction)",
            ),
            ("bed", "TranslationalReference"),
            ("motor", "IdealTorqueSource"),
            ("rotor", "Inertia(j: 0.01)"),
            ("gear", gear),
            ("wall", "RotationalReference"),
        ],
        &[
            "world.frame <-> crank.base <-> slide.base",
            "crank.follower <-> wheel.frame <-> throw.base",
            "throw.follower <-> pin.base",
            "pin.follower <-> rod.frame <-> far.base",
            "far.follower <-> wrist.base",
            "wrist.follower <-> slide.follower <-> piston.frame",
            "slide.r <-> guide.r",
            "slide.c <-> guide.c <-> bed.r",
            "motor.r <-> rotor.r <-> gear.base",
            "gear.follower <-> crank.r",
            "motor.c <-> crank.c <-> wall.r",
        ],
    )
}

/// Way of the piston per angle of the crank, m.
fn slope(q: f64) -> f64 {
    let (r, l) = (0.1, 0.3);
    -r * q.sin() - r * r * q.sin() * q.cos() / (l * l - (r * q.sin()).powi(2)).sqrt()
}

#[test]
fn a_crank_turns_through_its_dead_centres_against_dry_friction_on_the_slide() {
    // There the piston stands, but no force on it can hold it: it is accelerated by r w^2 (1 +- r/l).
    let (r, l, w) = (0.1, 0.3, 20.0);
    for (crank, slide, outward) in [(0.0, l + r, -1.0), (PI, l - r, 1.0)] {
        for turns in [1.0, -1.0] {
            let start = format!("position: {crank:?}, velocity: {:?}", turns * w);
            let mut plant = slider_crank(&start, &format!("position: {slide:?}"), "SimpleGear(ratio: 5.0)");
            plant.bench.major();
            let expected = outward * r * w * w * (1.0 - outward * r / l);
            close(plant.get("slide.a"), expected, 1e-9 * expected.abs());
            let mode = plant.bench.interface.discrete.iter().position(|state| state.name() == "guide.mode");
            assert_eq!(plant.bench.d[mode.expect("a mode")], outward);
            close(plant.get("crank.w"), turns * w, 1e-12);
        }
    }
}

#[test]
fn a_mesh_that_sticks_bears_nothing_of_what_the_slide_holds() {
    let mut plant = slider_crank(
        "position: 0.5",
        "position: 0.35",
        "SimpleGear(ratio: 5.0, efficiency: 0.8, loss: Stiction)",
    );
    // What the slide holds without the mesh; the mesh passes 0.8 of what drives it on, and holds the rest.
    let enough = FRICTION * slope(0.5).abs() / 5.0;
    for part in [0.0, 0.5, 0.99, 1.01, 1.24] {
        plant.set("motor.tau", part * enough);
        plant.bench.major();
        plant.run_to(plant.bench.t + 0.01, 1e-3);
        close(plant.get("crank.w"), 0.0, 1e-9);
    }
    plant.set("motor.tau", 1.5 * enough);
    plant.bench.major();
    plant.run_to(plant.bench.t + 0.01, 1e-4);
    assert!(plant.get("crank.w").abs() > 1e-4, "{}", plant.get("crank.w"));
}
