//! Builds a diagram in Rust, runs it and reads its signals: `cargo run -p blocksim-diagram --example run_a_diagram`.
//!
//! A diagram is text, so that what Rust builds can be printed, checked by `blocksim check` and kept beside others. The compiler opens
//! no files itself: whoever calls it hands the texts in.

// An example prints.
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::path::Path;
use std::sync::Arc;

// Kinds of blocks register themselves when they are linked, and linked is only what is named.
use blocksim_blocks as _;
use blocksim_diagram::{Reader, Sources, compile};
use blocksim_sim::{Observer, Simulation};

/// The only file that there is.
struct OneFile(String);

impl Reader for OneFile {
    fn read(&self, path: &Path) -> Result<String, String> {
        match path == Path::new("model.ron") {
            true => Ok(self.0.clone()),
            false => Err("the file does not exist".to_owned()),
        }
    }
}

/// Keeps the first recorded signal.
#[derive(Default)]
struct FirstSignal(Vec<(f64, f64)>);

impl Observer for FirstSignal {
    fn row(&mut self, t: f64, values: &[f64]) {
        self.0.extend(values.first().map(|value| (t, *value)));
    }
}

/// A chain of lags with these time constants, s, behind a step.
fn chain(constants: &[f64]) -> String {
    let mut blocks = String::from(r#""step": Step(time: "0 s"), "show": Scope, "#);
    let (mut connections, mut last) = (String::new(), "step".to_owned());
    for (i, tau) in constants.iter().enumerate() {
        blocks += &format!(r#""lag{i}": LowPass(tau: "{tau} s"), "#);
        connections += &format!(r#""{last}.y -> lag{i}.u", "#);
        last = format!("lag{i}");
    }
    format!(
        r#"Diagram(simulation: (stop_time: "5 s"), blocks: {{ {blocks} }}, connections: [{connections} "{last}.y -> show.u"])"#
    )
}

/// Runs the chain; returns time and value of its end, row by row.
pub fn run() -> Result<Vec<(f64, f64)>, Box<dyn Error>> {
    let reader = OneFile(chain(&[0.5, 1.0]));
    let compiled = compile(&Sources::new(&reader), Path::new("model.ron"), &[]);
    let Some(schedule) = compiled.schedule else {
        let messages: Vec<String> = compiled.problems.iter().map(|problem| problem.message.clone()).collect();
        return Err(messages.join("\n").into());
    };
    let mut simulation = Simulation::new(Arc::new(schedule))?;
    let mut signal = FirstSignal::default();
    simulation.run(&mut signal)?;
    println!("{} steps to {} s", simulation.counts().accepted, simulation.time());
    // Any output can be read by its path, not only what a scope records.
    println!("lag0.y = {:?}", simulation.signal("lag0.y"));
    Ok(signal.0)
}

fn main() -> Result<(), Box<dyn Error>> {
    for (t, y) in run()? {
        println!("{t:.3} s  {y:.6}");
    }
    Ok(())
}
