use std::sync::Arc;

use blocksim_block::law::BlockLaw;
use blocksim_block::schedule::{
    Clock, FixedMethod, Instance, Keep, LoopPolicy, OutputTimes, Rate, Recorded, Schedule, Settings, Signal,
    Solver, Start, Step, VariableMethod, When,
};
use blocksim_block::{Block, Given, Interface, ParamUnits};
use blocksim_signal::{Kind, SampleTime, Shape};

/// A diagram of scalar signals. A connection is named by the block it comes from, with `.port` unless that is the first
/// output.
#[derive(Clone, Default)]
pub struct Toy {
    blocks: Vec<Part>,
    major: Vec<String>,
    not_minor: Vec<String>,
}

/// Path, block, interface and where its inputs come from.
type Part = (String, Arc<dyn Block>, Interface, Vec<String>);

pub fn ode4(step: f64) -> Solver {
    Solver::Fixed { method: FixedMethod::Ode4, step }
}

pub fn ode45() -> Solver {
    Solver::Variable { method: VariableMethod::Ode45, rtol: 1e-8, atol: Some(1e-10), max_step: f64::MAX }
}

impl Toy {
    pub fn new() -> Self {
        Self::default()
    }

    pub fn with(mut self, path: &str, block: impl Block + 'static, inputs: &[&str]) -> Self {
        let names = block.interface(&Given::nothing()).expect("an interface").inputs;
        let given = names.into_iter().map(|input| (input.name, blocksim_block::PortType::scalar())).collect();
        let interface = block.interface(&Given::new(given, ParamUnits::default())).expect("an interface");
        assert_eq!(inputs.len(), interface.inputs.len(), "inputs of {path}");
        let inputs = inputs.iter().map(ToString::to_string).collect();
        self.blocks.push((path.to_owned(), Arc::new(block), interface, inputs));
        self
    }

    /// The outputs of this block change at major steps only.
    pub fn major(mut self, path: &str) -> Self {
        self.major.push(path.to_owned());
        self
    }

    /// No derivative and no guard depends on the outputs of this block.
    pub fn not_minor(mut self, path: &str) -> Self {
        self.not_minor.push(path.to_owned());
        self
    }

    fn find(&self, name: &str) -> (usize, usize) {
        let (path, port) = name.split_once('.').unwrap_or((name, ""));
        let block = self.blocks.iter().position(|block| block.0 == path);
        let block = block.unwrap_or_else(|| panic!("no block {path}"));
        let outputs = &self.blocks[block].2.outputs;
        (block, outputs.iter().position(|output| output.name == port).unwrap_or(0))
    }

    /// Groups in an order in which each finds its inputs known.
    fn order(&self) -> Vec<(usize, usize)> {
        let groups = self.blocks.iter().enumerate();
        let mut rest: Vec<(usize, usize)> =
            groups.flat_map(|(i, block)| (0..block.2.groups.len()).map(move |g| (i, g))).collect();
        let mut order = Vec::new();
        while !rest.is_empty() {
            let ready = rest.iter().position(|&(i, group)| {
                let (.., interface, inputs) = &self.blocks[i];
                inputs.iter().enumerate().filter(|(input, _)| interface.reads(group, *input)).all(
                    |(_, name)| {
                        let (from, port) = self.find(name);
                        order.contains(&(from, self.blocks[from].2.group_of[port]))
                    },
                )
            });
            order.push(rest.remove(ready.expect("no algebraic loop")));
        }
        order
    }

    pub fn schedule(
        self,
        recorded: &[&str],
        stop_time: f64,
        solver: Solver,
        output: OutputTimes,
    ) -> Arc<Schedule> {
        let mut periods: Vec<(f64, f64)> = Vec::new();
        for (_, _, interface, _) in &self.blocks {
            if let Some(SampleTime::Discrete { period, offset }) = interface.sample_time
                && !periods.contains(&(period, offset))
            {
                periods.push((period, offset));
            }
        }
        periods.sort_by(|a, b| a.0.total_cmp(&b.0));
        let tick = periods.first().map_or(0.0, |rate| rate.0);
        let ticks = |time: f64| (time / tick).round() as u64;
        let clock = Clock {
            tick,
            rates: periods.iter().map(|&(p, o)| Rate { period: ticks(p), offset: ticks(o) }).collect(),
        };
        let rate_of = |interface: &Interface| match interface.sample_time {
            Some(SampleTime::Discrete { period, offset }) => {
                periods.iter().position(|rate| *rate == (period, offset))
            }
            _ => None,
        };

        let steps = self.order().into_iter().map(|(block, group)| {
            let (path, _, interface, _) = &self.blocks[block];
            let when = match (interface.sample_time, rate_of(interface)) {
                (_, Some(rate)) => When::Sampled(rate as u32),
                (Some(SampleTime::Constant), _) => When::Constant,
                _ if self.major.contains(path) => When::Major,
                _ => When::Continuous,
            };
            let minor = when == When::Continuous && !self.not_minor.contains(path);
            Step { block: block as u32, group: group as u32, when, acts: true, minor }
        });
        let steps: Vec<Step> = steps.collect();
        let held = |name: &str| {
            let (block, port) = self.find(name);
            let group = self.blocks[block].2.group_of[port];
            let mut of_port =
                steps.iter().filter(|step| (step.block as usize, step.group as usize) == (block, group));
            of_port.all(|step| step.when != When::Continuous)
        };

        let (mut y, mut x, mut d, mut g) = (0, 0, 0, 0);
        let starts: Vec<usize> = self
            .blocks
            .iter()
            .map(|block| {
                y += block.2.outputs.len();
                y - block.2.outputs.len()
            })
            .collect();
        let spans = |n: usize| (0..n as u32).map(|i| (i, i + 1)).collect::<Vec<_>>();
        let cell = |name: &str| {
            let (block, port) = self.find(name);
            starts[block] + port
        };
        let mut blocks = Vec::new();
        let mut signals = Vec::new();
        for (i, (path, block, interface, inputs)) in self.blocks.iter().enumerate() {
            for (port, output) in interface.outputs.iter().enumerate() {
                signals.push(Signal {
                    path: format!("{path}.{}", output.name),
                    offset: starts[i] + port,
                    kind: Kind::Real,
                    shape: Shape::Scalar,
                    dimension: None,
                });
            }
            let gather = inputs.iter().map(|name| (cell(name) as u32, 1)).collect();
            let (inputs, outputs) = (spans(inputs.len()), spans(interface.outputs.len()));
            let law = BlockLaw::record(block, interface, &inputs, &outputs).expect("a law");
            blocks.push(Instance {
                path: path.clone(),
                kind: format!("{block:?}").split([' ', '{', '(']).next().unwrap_or_default().to_owned(),
                place: None,
                parts: Vec::new(),
                block: Arc::clone(block),
                interface: interface.clone(),
                law: law.map(Arc::new),
                gather,
                inputs,
                outputs,
                y: starts[i],
                x,
                d,
                g,
                rate: rate_of(interface),
                watched: !interface.guards.is_empty(),
            });
            x += interface.states.len();
            d += interface.discrete.len();
            g += interface.guards.len();
        }
        let recorded: Vec<Recorded> = recorded
            .iter()
            .map(|name| Recorded {
                path: (*name).to_owned(),
                cell: cell(name),
                kind: Kind::Real,
                dimension: None,
                display: None,
                title: Vec::new(),
                legend: None,
                over: None,
                keep: Keep::All,
                held: held(name),
            })
            .collect();
        Arc::new(Schedule {
            title: "toy".to_owned(),
            steps,
            loops: Vec::new(),
            initial_signals: vec![0.0; y],
            states: x,
            discrete: d,
            guards: g,
            clock,
            recorded,
            settings: Settings {
                stop_time,
                solver,
                output,
                seed: 0,
                start: Start::Given,
                atol: Vec::new(),
                algebraic_loops: LoopPolicy::default(),
            },
            blocks,
            signals,
        })
    }
}
