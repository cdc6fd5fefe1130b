//! A bench for single blocks: what the engine does, for one block, in slow motion.

use std::sync::Arc;

use crate::law::BlockLaw;
use crate::{
    Block, BlockKind, Context, Fault, Given, Interface, NODES, ParamUnits, Piece, PortType, Resolution,
    Scratch,
};

/// One block with its buffers.
#[derive(Debug)]
pub struct Bench {
    /// The block; if it records its law, one that runs that.
    block: Arc<dyn Block>,
    /// What the block says of itself.
    pub interface: Interface,
    /// Time, s.
    pub t: f64,
    /// Continuous states.
    pub x: Vec<f64>,
    /// Discrete states.
    pub d: Vec<f64>,
    u: Vec<f64>,
    y: Vec<f64>,
    w: Scratch,
    inputs: Vec<(u32, u32)>,
    outputs: Vec<(u32, u32)>,
    evaluation: u64,
    fault: Fault,
}

impl Bench {
    /// A block whose inputs are real scalars without unit.
    ///
    /// # Panics
    /// Panics if the parameters or the interface are refused: this is a tool of tests.
    pub fn new(kind: impl BlockKind) -> Self {
        Self::of(kind.built())
    }

    /// The same of what a kind has been built to.
    ///
    /// # Panics
    /// Panics if the interface is refused: this is a tool of tests.
    pub fn of(block: impl Block) -> Self {
        let names = block.interface(&Given::nothing()).expect("an interface").inputs;
        let given = names.into_iter().map(|input| {
            let kind = input.kind.unwrap_or(blocksim_signal::Kind::Real);
            (input.name, PortType { kind, ..PortType::scalar() })
        });
        Self::of_inputs(block, given.collect())
    }

    /// A block with inputs of these types.
    ///
    /// # Panics
    /// Panics if the parameters or the interface are refused: this is a tool of tests.
    pub fn with_inputs(kind: impl BlockKind, given: Vec<(String, PortType)>) -> Self {
        Self::of_inputs(kind.built(), given)
    }

    fn of_inputs(block: impl Block, given: Vec<(String, PortType)>) -> Self {
        let given = Given::new(given, ParamUnits::default());
        let interface = block.interface(&given).expect("an interface");
        let spans = |lengths: Vec<usize>| {
            let mut at = 0;
            lengths
                .into_iter()
                .map(|n| {
                    at += n as u32;
                    (at - n as u32, at)
                })
                .collect::<Vec<_>>()
        };
        let inputs = spans(
            interface
                .inputs
                .iter()
                .map(|input| input.shape.unwrap_or(given.input_or_unknown(&input.name).shape).len())
                .collect(),
        );
        let outputs = spans(interface.outputs.iter().map(|output| output.port_type.shape.len()).collect());
        let mut u = vec![0.0; inputs.last().map_or(0, |span| span.1 as usize)];
        for (input, (start, end)) in interface.inputs.iter().zip(&inputs) {
            u[*start as usize..*end as usize].fill(input.default.unwrap_or(0.0));
        }
        let w = block.scratch();
        let plain: Arc<dyn Block> = Arc::new(block);
        let law = BlockLaw::record(&plain, &interface, &inputs, &outputs).expect("a law that makes sense");
        let (interface, block): (_, Arc<dyn Block>) = match law {
            Some(law) => (law.complete(interface), Arc::new(law)),
            None => (interface, plain),
        };
        let mut bench = Self {
            x: interface.states.iter().map(|state| state.initial).collect(),
            d: interface.discrete.iter().map(|state| state.initial).collect(),
            u,
            y: vec![0.0; outputs.last().map_or(0, |span| span.1 as usize)],
            w,
            inputs,
            outputs,
            evaluation: 0,
            fault: Fault::default(),
            t: 0.0,
            interface,
            block,
        };
        let (mut x, mut d) = (std::mem::take(&mut bench.x), std::mem::take(&mut bench.d));
        bench.block.initialize(&bench.context(&[], &[]), &mut x, &mut d);
        (bench.x, bench.d) = (x, d);
        bench
    }

    fn context<'a>(&'a self, x: &'a [f64], d: &'a [f64]) -> Context<'a> {
        Context {
            t: self.t,
            x,
            d,
            u: &self.u,
            inputs: &self.inputs,
            outputs: &self.outputs,
            evaluation: self.evaluation,
            resolution: Resolution::default(),
            seed: 0,
            fault: &self.fault,
        }
    }

    /// Sets an input port.
    ///
    /// # Panics
    /// Panics if the length does not fit.
    pub fn set(&mut self, port: usize, values: &[f64]) -> &mut Self {
        let (start, end) = self.inputs[port];
        self.u[start as usize..end as usize].copy_from_slice(values);
        self
    }

    /// Evaluates all outputs as a major step does; jumps, if any, are carried out. Returns all outputs.
    ///
    /// # Panics
    /// Panics if the block fails or never stops jumping.
    pub fn major(&mut self) -> Vec<f64> {
        for _ in 0..100 {
            let mut d = self.d.clone();
            self.block.settle(&self.context(&self.x, &[]), &mut d);
            self.d = d;
            let y = self.minor();
            if !self.interface.jumps {
                return y;
            }
            let (mut x, mut d) = (self.x.clone(), self.d.clone());
            let mut w = std::mem::take(&mut self.w);
            let jumped = self.block.jump(&self.context(&[], &[]), &mut w, &mut x, &mut d);
            (self.x, self.d, self.w) = (x, d, w);
            if !jumped {
                return y;
            }
        }
        panic!("the block never stops jumping");
    }

    /// Evaluates all outputs as a minor step does and returns them.
    ///
    /// # Panics
    /// Panics if the block fails.
    pub fn minor(&mut self) -> Vec<f64> {
        if let Some(reason) = self.failure() {
            panic!("the block failed: {reason}");
        }
        self.y.clone()
    }

    /// Why the outputs cannot be evaluated; nothing if they can.
    pub fn failure(&mut self) -> Option<String> {
        self.evaluation += 1;
        let (mut y, mut w) = (std::mem::take(&mut self.y), std::mem::take(&mut self.w));
        for group in 0..self.interface.groups.len() {
            self.block.outputs(group, &self.context(&self.x, &self.d), &mut w, &mut y);
        }
        (self.y, self.w) = (y, w);
        self.fault.take()
    }

    /// Sets the first input, does a major step and returns the first output.
    pub fn respond(&mut self, u: f64) -> f64 {
        self.set(0, &[u]).major()[0]
    }

    /// A sample hit: outputs, then update. Returns the outputs.
    pub fn hit(&mut self) -> Vec<f64> {
        let y = self.major();
        let mut d = self.d.clone();
        let mut w = std::mem::take(&mut self.w);
        self.block.update(&self.context(&self.x, &[]), &mut w, &mut d);
        self.w = w;
        self.d = d;
        y
    }

    /// Derivatives of the states.
    pub fn derivatives(&mut self) -> Vec<f64> {
        self.minor();
        let (mut dx, mut w) = (vec![0.0; self.x.len()], std::mem::take(&mut self.w));
        self.block.derivatives(&self.context(&self.x, &self.d), &mut w, &mut dx);
        self.w = w;
        dx
    }

    /// Values of the guards.
    pub fn guards(&mut self) -> Vec<f64> {
        let mut g = vec![0.0; self.interface.guards.len()];
        let mut w = std::mem::take(&mut self.w);
        self.block.guards(&self.context(&self.x, &self.d), &mut w, &mut g);
        self.w = w;
        g
    }

    /// Notes an accepted step.
    pub fn accept(&mut self) {
        let mut d = self.d.clone();
        let _ = self.block.accept(&self.context(&self.x, &[]), &mut d);
        self.d = d;
    }

    /// Notes a step to `end` in which all inputs were `u(t)`, and goes there.
    ///
    /// # Panics
    /// Panics if the block fails.
    pub fn remember(&mut self, end: f64, is_fresh: bool, u: impl Fn(f64) -> Vec<f64>) {
        let begin = self.t;
        let inputs: Vec<f64> = NODES.iter().flat_map(|share| u(begin + share * (end - begin))).collect();
        self.t = end;
        self.u = u(end);
        let mut d = self.d.clone();
        let piece = Piece { begin, end, is_fresh, inputs: &inputs };
        self.block.remember(&self.context(&self.x, &[]), &piece, &mut d);
        self.d = d;
        if let Some(reason) = self.fault.take() {
            panic!("the block failed: {reason}");
        }
    }

    /// Lets what has been remembered come out up to now.
    pub fn reach(&mut self) {
        let mut d = self.d.clone();
        self.block.reach(&self.context(&self.x, &[]), &mut d);
        self.d = d;
    }

    /// The next kink.
    pub fn next_kink(&self) -> f64 {
        self.block.next_kink(&self.context(&self.x, &self.d))
    }

    /// The next time event.
    pub fn next_event(&self) -> f64 {
        self.block.next_event(&self.context(&self.x, &self.d))
    }

    /// Integrates with constant inputs over `duration` in `steps` classical Runge-Kutta steps, with a major step
    /// and `accept` after each.
    pub fn integrate(&mut self, duration: f64, steps: usize) -> &mut Self {
        let h = duration / steps as f64;
        let start = self.t;
        for step in 0..steps {
            let (t, x) = (start + step as f64 * h, self.x.clone());
            let mut sum = vec![0.0; x.len()];
            let mut k = vec![0.0; x.len()];
            for (c, weight) in [(0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
                self.t = t + c * h;
                self.x.iter_mut().zip(&x).zip(&k).for_each(|((to, x), k)| *to = x + c * h * k);
                k = self.derivatives();
                sum.iter_mut().zip(&k).for_each(|(sum, k)| *sum += weight * k);
            }
            self.t = start + (step + 1) as f64 * h;
            self.x = x.iter().zip(&sum).map(|(x, sum)| x + h / 6.0 * sum).collect();
            self.major();
            self.accept();
        }
        self
    }
}
