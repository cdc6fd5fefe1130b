//! What a random model is.

/// What a node does. Numbers are in SI units, times in s; signals have no unit.
#[allow(missing_docs, reason = "fields are named as the parameters of the blocks")]
#[derive(Debug, Clone, PartialEq)]
pub enum Law {
    /// A number.
    Constant(f64),
    /// From one value to another.
    Step { time: f64, before: f64, after: f64 },
    /// `bias + amplitude sin(2 pi frequency t + phase)`.
    Sine { amplitude: f64, frequency: f64, phase: f64, bias: f64 },
    /// Rectangles.
    Pulse { amplitude: f64, period: f64, width: f64, delay: f64 },
    /// `initial + slope max(t - start, 0)`.
    Ramp { slope: f64, start: f64, initial: f64 },
    /// Time in seconds.
    Clock,
    /// `k u`.
    Gain(f64),
    /// Sum of the inputs, each with its sign.
    Sum(Vec<f64>),
    /// Product of two inputs.
    Product,
    /// `|u|`.
    Abs,
    /// The least or (true) the greatest of two inputs.
    MinMax(bool),
    /// A smooth function.
    Function(Smooth),
    /// A table: breakpoints, values.
    Table { way: Way, points: Vec<f64>, values: Vec<f64> },
    /// Limits.
    Saturation { lower: f64, upper: f64 },
    /// Nothing in between.
    DeadZone { start: f64, end: f64 },
    /// Limits of the slope.
    RateLimiter { rising: f64, falling: f64, y0: f64 },
    /// Play.
    Backlash { width: f64, y0: f64 },
    /// Whole multiples.
    Quantizer { interval: f64 },
    /// Relation to a constant, or of two inputs.
    Compare { relation: Relation, constant: Option<f64> },
    /// -1, 0, 1.
    Sign,
    /// Two points.
    Relay { on_at: f64, off_at: f64, on: f64, off: f64 },
    /// `u1` where the control is at least the threshold, else `u3`; the control is Bool without a threshold.
    Switch { threshold: Option<f64> },
    /// Number of crossings.
    HitCrossing { at: f64, edge: Edge },
    /// Gate of truth values.
    Logic(Gate),
    /// `y_k = u_(k-steps)`; the block `UnitDelay` with one step.
    Delay { ts: f64, steps: usize, x0: f64 },
    /// Sampled and held.
    Hold { ts: f64 },
    /// Sum of samples.
    DiscreteIntegrator { ts: f64, method: Method, gain: f64, limit: Option<f64> },
    /// `k b / (z - a)`, with `through` `k (b z + c) / (z - a)`.
    DiscreteTransfer { ts: f64, num: Vec<f64>, den: Vec<f64> },
    /// Sampled controller.
    DiscretePid { ts: f64, gains: Gains },
    /// Dead time.
    TransportDelay { delay: f64, y0: f64 },
    /// Integrator, with limits to both sides and a reset.
    Integrator { x0: f64, limit: Option<f64>, reset: Option<Edge> },
    /// First order.
    LowPass { tau: f64, y0: f64 },
    /// Rational, in descending powers; the first coefficient of `den` is 1.
    Transfer { num: Vec<f64>, den: Vec<f64> },
    /// Filtered derivative.
    Derivative { n: f64 },
    /// Controller.
    Pid(Gains),
}

/// Smooth functions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Smooth {
    /// Sine.
    Sin,
    /// Inverse tangent.
    Atan,
    /// Hyperbolic tangent.
    Tanh,
    /// Second power.
    Square,
}

/// Ways to read a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Way {
    /// Straight lines, held beyond the ends.
    Linear,
    /// The value at the lower breakpoint.
    Flat,
    /// The value at the nearer breakpoint.
    Nearest,
}

/// Relations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Relation {
    /// a < b
    Less,
    /// a <= b
    LessEqual,
    /// a > b
    Greater,
    /// a >= b
    GreaterEqual,
}

/// What sets something off.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Edge {
    /// Upwards.
    Rising,
    /// Downwards.
    Falling,
    /// Both.
    Either,
    /// While positive; only of a reset.
    Level,
}

/// Gates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Gate {
    /// All.
    And,
    /// Any.
    Or,
    /// An odd number.
    Xor,
    /// Not all.
    Nand,
    /// None.
    Nor,
    /// Not the one.
    Not,
}

/// Sums for integrals.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Value at the start of a sample.
    ForwardEuler,
    /// At its end.
    BackwardEuler,
    /// The mean.
    Trapezoidal,
}

/// What stops the integral part of a controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Windup {
    /// Nothing.
    None,
    /// It stands still.
    Clamping,
    /// It is led back.
    BackCalculation,
}

/// A controller in parallel form; fields are named as the parameters of the blocks.
#[allow(missing_docs, reason = "fields are named as the parameters of the blocks")]
#[derive(Debug, Clone, PartialEq)]
pub struct Gains {
    pub kp: f64,
    pub ki: f64,
    pub kd: f64,
    pub n: f64,
    /// Limits to both sides.
    pub limit: Option<f64>,
    pub windup: Windup,
    pub kb: f64,
}

/// A law with its inputs.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// What it does.
    pub law: Law,
    /// The nodes whose outputs it takes, in the order of its ports.
    pub inputs: Vec<usize>,
    /// Whether its output is a truth value.
    pub boolean: bool,
}

/// A model: nodes, those of whose outputs the integral is asked for, and when it ends.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    /// All nodes; inputs are numbers of others, before or behind.
    pub nodes: Vec<Node>,
    /// The nodes whose integral is asked for.
    pub probes: Vec<usize>,
    /// End of the run, s.
    pub stop: f64,
}

impl Law {
    /// The kind of block.
    pub fn kind(&self) -> &'static str {
        match self {
            Law::Constant(_) => "Constant",
            Law::Step { .. } => "Step",
            Law::Sine { .. } => "Sine",
            Law::Pulse { .. } => "Pulse",
            Law::Ramp { .. } => "Ramp",
            Law::Clock => "Clock",
            Law::Gain(_) => "Gain",
            Law::Sum(_) => "Sum",
            Law::Product => "Product",
            Law::Abs => "Abs",
            Law::MinMax(_) => "MinMax",
            Law::Function(_) => "Function",
            Law::Table { .. } => "LookupTable1D",
            Law::Saturation { .. } => "Saturation",
            Law::DeadZone { .. } => "DeadZone",
            Law::RateLimiter { .. } => "RateLimiter",
            Law::Backlash { .. } => "Backlash",
            Law::Quantizer { .. } => "Quantizer",
            Law::Compare { .. } => "Compare",
            Law::Sign => "Sign",
            Law::Relay { .. } => "Relay",
            Law::Switch { .. } => "Switch",
            Law::HitCrossing { .. } => "HitCrossing",
            Law::Logic(_) => "Logic",
            Law::Delay { steps: 1, .. } => "UnitDelay",
            Law::Delay { .. } => "Delay",
            Law::Hold { .. } => "ZeroOrderHold",
            Law::DiscreteIntegrator { .. } => "DiscreteIntegrator",
            Law::DiscreteTransfer { .. } => "DiscreteTransferFunction",
            Law::DiscretePid { .. } => "DiscretePid",
            Law::TransportDelay { .. } => "TransportDelay",
            Law::Integrator { .. } => "Integrator",
            Law::LowPass { .. } => "LowPass",
            Law::Transfer { .. } => "TransferFunction",
            Law::Derivative { .. } => "Derivative",
            Law::Pid(_) => "Pid",
        }
    }

    /// Sample time, if it has one.
    pub fn sample_time(&self) -> Option<f64> {
        match self {
            Law::Delay { ts, .. }
            | Law::Hold { ts }
            | Law::DiscreteIntegrator { ts, .. }
            | Law::DiscreteTransfer { ts, .. }
            | Law::DiscretePid { ts, .. } => Some(*ts),
            _ => None,
        }
    }

    /// Number of inputs.
    pub fn inputs(&self) -> usize {
        match self {
            Law::Constant(_)
            | Law::Step { .. }
            | Law::Sine { .. }
            | Law::Pulse { .. }
            | Law::Ramp { .. }
            | Law::Clock => 0,
            Law::Sum(signs) => signs.len(),
            Law::Product | Law::MinMax(_) | Law::Compare { constant: None, .. } => 2,
            Law::Logic(gate) if *gate != Gate::Not => 2,
            Law::Integrator { reset: Some(_), .. } => 2,
            Law::Switch { .. } => 3,
            _ => 1,
        }
    }

    /// Whether the output depends on this input at the same instant.
    pub fn feeds_through(&self, port: usize) -> bool {
        match self {
            Law::Delay { .. } | Law::TransportDelay { .. } | Law::LowPass { .. } => false,
            // What sets it back does so at that very instant.
            Law::Integrator { .. } => port == 1,
            Law::DiscreteIntegrator { method, .. } => *method != Method::ForwardEuler,
            Law::DiscreteTransfer { num, den, .. } | Law::Transfer { num, den } => num.len() == den.len(),
            _ => true,
        }
    }
}

impl Model {
    /// Nodes in an order in which each comes after what it depends on, and those integrators that an algebraic loop through
    /// their own reset would lead back to themselves: they are set back after all else has been evaluated.
    pub fn order(&self) -> (Vec<usize>, Vec<bool>) {
        let mut late = vec![false; self.nodes.len()];
        loop {
            let (order, stuck) = self.sorted(&late);
            let looped = |&n: &usize| !late[n] && self.is_reset(n) && self.resets_itself(n);
            let Some(node) = stuck.into_iter().find(looped) else {
                return (order, late);
            };
            late[node] = true;
        }
    }

    /// The signal that decides what a node does.
    pub(super) fn watched(&self, node: usize) -> Option<usize> {
        let Node { law, inputs, .. } = &self.nodes[node];
        let port = usize::from(matches!(law, Law::Switch { .. } | Law::Integrator { reset: Some(_), .. }));
        inputs.get(port).copied()
    }

    /// Whether what sets an integrator back depends on its output at the same instant.
    fn resets_itself(&self, integrator: usize) -> bool {
        let mut seen = vec![false; self.nodes.len()];
        let mut open = vec![self.nodes[integrator].inputs[1]];
        while let Some(n) = open.pop() {
            if n == integrator {
                return true;
            }
            if !std::mem::replace(&mut seen[n], true) {
                let Node { law, inputs, .. } = &self.nodes[n];
                open.extend(inputs.iter().enumerate().filter(|(p, _)| law.feeds_through(*p)).map(|(_, u)| u));
            }
        }
        false
    }

    fn is_reset(&self, node: usize) -> bool {
        matches!(self.nodes[node].law, Law::Integrator { reset: Some(_), .. })
    }

    /// Nodes in order, and those on or behind a loop.
    fn sorted(&self, late: &[bool]) -> (Vec<usize>, Vec<usize>) {
        let mut order = Vec::new();
        let mut done = vec![false; self.nodes.len()];
        loop {
            let ready = |n: &usize| {
                let node = &self.nodes[*n];
                let mut ports = node.inputs.iter().enumerate();
                !done[*n] && ports.all(|(p, &u)| done[u] || late[*n] || !node.law.feeds_through(p))
            };
            let Some(next) = (0..self.nodes.len()).find(ready) else { break };
            done[next] = true;
            order.push(next);
        }
        let stuck = (0..self.nodes.len()).filter(|&n| !done[n]).collect();
        (order, stuck)
    }

    /// Whether no algebraic loop is left.
    pub fn is_causal(&self) -> bool {
        self.order().0.len() == self.nodes.len()
    }

    /// The model with only the nodes that the given ones depend on, in the same order.
    pub fn only(&self, wanted: &[usize]) -> Model {
        let mut needed = vec![false; self.nodes.len()];
        let mut open = wanted.to_vec();
        while let Some(n) = open.pop() {
            if !std::mem::replace(&mut needed[n], true) {
                open.extend(&self.nodes[n].inputs);
            }
        }
        let mut place = vec![usize::MAX; self.nodes.len()];
        let kept: Vec<usize> = (0..self.nodes.len()).filter(|&n| needed[n]).collect();
        kept.iter().enumerate().for_each(|(new, &old)| place[old] = new);
        let moved = |&n: &usize| {
            let Node { law, inputs, boolean } = self.nodes[n].clone();
            Node { law, inputs: inputs.into_iter().map(|u| place[u]).collect(), boolean }
        };
        Model {
            nodes: kept.iter().map(moved).collect(),
            probes: self.probes.iter().filter(|&&p| needed[p]).map(|&p| place[p]).collect(),
            stop: self.stop,
        }
    }
}
