//! Embeds a controller that is Rust code, without a plug-in: `cargo run -p blocksim-diagram --example own_controller`.
//!
//! A block is a struct of parameters with pure functions; what it remembers belongs to the engine. The derive macro registers its
//! kind, and from then on diagrams name it like any other, with units, defaults and ranges.

// An example prints.
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::path::Path;
use std::sync::Arc;

use blocksim_block::prelude::*;
use blocksim_blocks as _;
use blocksim_diagram::{Reader, Sources, compile};
use blocksim_sim::{Observer, Simulation};

/// Proportional and integral control with a sample time: $u = k_p e + x$, $x \leftarrow x + k_i T_s e$.
///
/// ```ron
/// SpeedController(kp: 0.5, ki: 5.0, ts: "1 ms")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Own")]
pub struct SpeedController {
    /// Gain.
    #[block(finite)]
    pub kp: f64,
    /// Gain of the integral, per second.
    #[block(unit = "1/s", finite)]
    pub ki: f64,
    /// Sample time.
    #[block(unit = "s", positive, default = 1e-3)]
    pub ts: f64,
}

impl Block for SpeedController {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        let ports = Interface::new().input(Input::real("e").scalar()).output(Output::real("u"));
        Ok(ports.discrete("x", 0.0).sampled(self.ts))
    }

    fn outputs(&self, _group: usize, c: &Context, _w: &mut Scratch, y: &mut [f64]) {
        y[0] = self.kp * c.scalar(0) + c.d[0];
    }

    fn update(&self, c: &Context, _w: &mut Scratch, d: &mut [f64]) {
        d[0] += self.ki * self.ts * c.scalar(0);
    }
}

const MODEL: &str = r#"Diagram(
    simulation: (stop_time: "2 s"),
    blocks: {
        "demand": Step(time: "0.1 s", after: 1.0),
        "error": Sum(signs: "+-"),
        "law": SpeedController(kp: 2.0, ki: 5.0),
        "plant": LowPass(tau: "0.4 s"),
        "show": Scope(inputs: ["set", "actual"]),
    },
    connections: [
        "demand.y -> error.u1, show.set",
        "plant.y -> error.u2, show.actual",
        "error.y -> law.e",
        "law.u -> plant.u",
    ],
)"#;

struct Model;

impl Reader for Model {
    fn read(&self, _path: &Path) -> Result<String, String> {
        Ok(MODEL.to_owned())
    }
}

/// Keeps the last row.
#[derive(Default)]
struct LastRow(Vec<f64>);

impl Observer for LastRow {
    fn row(&mut self, _t: f64, values: &[f64]) {
        values.clone_into(&mut self.0);
    }
}

/// Runs the loop; returns the set value and the actual value at its end.
pub fn run() -> Result<[f64; 2], Box<dyn Error>> {
    let compiled = compile(&Sources::new(&Model), Path::new("loop.ron"), &[]);
    let Some(schedule) = compiled.schedule else {
        let messages: Vec<String> = compiled.problems.iter().map(|problem| problem.message.clone()).collect();
        return Err(messages.join("\n").into());
    };
    let mut last = LastRow::default();
    Simulation::new(Arc::new(schedule))?.run(&mut last)?;
    match last.0[..] {
        [set, actual] => Ok([set, actual]),
        _ => Err("two signals are recorded".into()),
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let [set, actual] = run()?;
    println!("set {set}, actual {actual:.6}");
    Ok(())
}
