//! The part alone as a diagram, fed with what the whole one gave it: the reference of the code.

use std::sync::Arc;

use blocksim_block::problem::Problem;
use blocksim_block::schedule::{
    Instance, OutputTimes, Rate, Schedule, Settings, Solver, Start as Begin, Step, When,
};
use blocksim_block::{Block, Context, Interface, Output, PortType, Scratch};
use blocksim_signal::SampleTime;
use blocksim_sim::{Control, Counts, Observer, SimError, Simulation};

use crate::part::Selected;
use crate::{Method, refusal};

/// Where a run begins.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Start {
    /// Continuous states of the diagram.
    pub x: Vec<f64>,
    /// Discrete states of the diagram.
    pub d: Vec<f64>,
    /// All signals at time zero; constants have their values for good.
    pub signals: Vec<f64>,
}

/// Inputs and outputs of the part, step by step.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Record {
    pub inputs: Vec<Vec<f64>>,
    pub outputs: Vec<Vec<f64>>,
    /// What the engine says of the steps and the method of the target: the code does the same, be it good or bad.
    pub warnings: Vec<Problem>,
}

/// Who looks at signals between runs, not at rows.
struct Nobody;

impl Observer for Nobody {
    fn row(&mut self, _t: f64, _values: &[f64]) {}

    fn progress(&mut self, _t: f64, _counts: &Counts) -> Control {
        Control::Go
    }
}

/// The values at the start.
///
/// # Errors
/// If the diagram cannot be evaluated there.
pub(crate) fn start(selected: &Selected) -> Result<Start, Problem> {
    let schedule = selected.schedule;
    let mut simulation = Simulation::new(Arc::new(schedule.clone())).map_err(failed)?;
    let x = simulation.states().to_vec();
    let mut d = simulation.discrete_states().to_vec();
    simulation.run_until(0.0, &mut Nobody).map_err(failed)?;
    // What is evaluated once has chosen its modes once.
    for &at in selected.blocks.iter().filter(|at| selected.is_constant(**at)) {
        let block = selected.block(at);
        let own = block.d..block.d + block.interface.discrete.len();
        d[own.clone()].copy_from_slice(&simulation.discrete_states()[own]);
    }
    let signals = simulation.signals()[..schedule.initial_signals.len()].to_vec();
    Ok(Start { x, d, signals })
}

fn failed(error: SimError) -> Problem {
    let message = format!("the simulation for the test failed at {} s: {}", error.t, error.message);
    refusal(message, error.help.as_deref().unwrap_or("run the model first; once it runs, export it"))
}

/// Simulates the whole diagram for the inputs, then the part alone for the outputs.
///
/// # Errors
/// If one of the simulations fails.
pub(crate) fn record(selected: &Selected, start: &Start) -> Result<Record, Problem> {
    let step = selected.target.step;
    // The diagram may end before.
    let count = (selected.schedule.settings.stop_time / step * (1.0 + 1e-9)).floor() + 1.0;
    let count = count.min(selected.target.test_steps as f64) as usize;
    let inputs = if selected.part.inputs.is_empty() {
        vec![Vec::new(); count]
    } else {
        let mut simulation = Simulation::new(Arc::new(selected.schedule.clone())).map_err(failed)?;
        let cells: Vec<usize> = selected.part.inputs.iter().flat_map(crate::Port::cells).collect();
        rows(&mut simulation, selected, &cells, count)?
    };
    let mut simulation = Simulation::new(Arc::new(alone(selected, start, &inputs))).map_err(failed)?;
    let cells: Vec<usize> = selected.part.outputs.iter().flat_map(crate::Port::cells).collect();
    let outputs = rows(&mut simulation, selected, &cells, count)?;
    let warnings = simulation.warnings().into_iter().filter(|warning| warning.code == "coarse_step");
    let warnings = warnings.map(|Problem { message, .. }| {
        Problem::warning("coarse_step", message).help(
            "the code does the same as this simulation: shorten `--rate`, or take `--method rk4` for `euler`, and compare with a run \
             of the model by a method that chooses its steps",
        )
    });
    Ok(Record { inputs, outputs, warnings: warnings.collect() })
}

/// The values of some signals at each step of the target.
fn rows(
    simulation: &mut Simulation,
    selected: &Selected,
    cells: &[usize],
    count: usize,
) -> Result<Vec<Vec<f64>>, Problem> {
    let mut rows = Vec::with_capacity(count);
    let clock = selected.clock();
    for k in 0..count {
        simulation.run_until(clock.time(k as u64), &mut Nobody).map_err(failed)?;
        rows.push(cells.iter().map(|cell| simulation.signals()[*cell]).collect());
    }
    Ok(rows)
}

/// The part as a diagram in which everything lies where it lies in the whole one.
fn alone(selected: &Selected, start: &Start, inputs: &[Vec<f64>]) -> Schedule {
    let whole = selected.schedule;
    let mut clock = selected.clock();
    clock.rates.push(Rate { period: 1, offset: 0 });
    let own_rate = clock.rates.len() - 1;
    let mut blocks: Vec<Instance> = Vec::new();
    let mut steps: Vec<Step> = Vec::new();
    let mut column = 0;
    for port in &selected.part.inputs {
        let width = port.shape.len();
        if selected.inputs.contains_key(&port.cell) {
            let values = inputs.iter().map(|row| row[column..column + width].to_vec()).collect();
            let player = Player { step: selected.target.step, values };
            steps.push(Step {
                block: blocks.len() as u32,
                group: 0,
                when: When::Sampled(own_rate as u32),
                acts: true,
                minor: false,
            });
            blocks.push(player.instance(port.cell, width, &port.signal, own_rate));
        }
        column += width;
    }
    // Without inputs there is still a step at each step.
    if blocks.is_empty() {
        let player = Player { step: selected.target.step, values: Vec::new() };
        blocks.push(player.instance(0, 0, "", own_rate));
    }
    let mut numbers = vec![u32::MAX; whole.blocks.len()];
    for &at in &selected.blocks {
        numbers[at] = blocks.len() as u32;
        let mut block = whole.blocks[at].clone();
        let (x, d) = (block.x, block.d);
        block.interface.states.iter_mut().enumerate().for_each(|(i, state)| state.initial = start.x[x + i]);
        block.interface.discrete.iter_mut().enumerate().for_each(|(i, state)| state.initial = start.d[d + i]);
        block.watched = false;
        blocks.push(block);
    }
    steps.extend(selected.steps.iter().map(|step| Step { block: numbers[step.block as usize], ..*step }));
    let mut initial_signals = whole.initial_signals.clone();
    // Constants outside stay what they are.
    initial_signals.iter_mut().enumerate().for_each(|(cell, value)| {
        if let Some(constant) = crate::programs::constant(selected, start, cell) {
            *value = constant;
        }
    });
    let method = selected.target.method.unwrap_or(Method::Euler).of_engine();
    Schedule {
        blocks,
        steps,
        loops: Vec::new(),
        initial_signals,
        clock,
        recorded: Vec::new(),
        settings: Settings {
            solver: Solver::Fixed { method, step: selected.target.step },
            output: OutputTimes::Steps,
            start: Begin::Given,
            atol: Vec::new(),
            ..whole.settings.clone()
        },
        ..whole.clone()
    }
}

/// Gives recorded values, a row a step.
#[derive(Debug)]
struct Player {
    step: f64,
    values: Vec<Vec<f64>>,
}

impl Player {
    fn instance(self, cell: usize, width: usize, path: &str, rate: usize) -> Instance {
        let sample = SampleTime::Discrete { period: self.step, offset: 0.0 };
        let mut interface = Interface::new();
        if width > 0 {
            interface = interface.output(Output::like("y", PortType::vector(width)));
        }
        interface.sample_time = Some(sample);
        Instance {
            path: format!("{path} (recorded)"),
            kind: "Recorded".to_owned(),
            place: None,
            parts: Vec::new(),
            block: Arc::new(self),
            law: None,
            gather: Vec::new(),
            inputs: Vec::new(),
            outputs: if width > 0 { vec![(0, width as u32)] } else { Vec::new() },
            y: cell,
            x: 0,
            d: 0,
            g: 0,
            rate: Some(rate),
            watched: false,
            interface,
        }
    }
}

impl Block for Player {
    fn outputs(&self, _group: usize, c: &Context, _w: &mut Scratch, y: &mut [f64]) {
        let at = (c.t / self.step).round() as usize;
        if let Some(row) = self.values.get(at).or(self.values.last()) {
            y.copy_from_slice(row);
        }
    }
}
