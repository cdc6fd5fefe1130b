//! One block for each thing that a block can do.

use blocksim_block::{Block, Context, Crossing, Given, Input, Interface, InterfaceError, Output, Scratch};
use blocksim_signal::SampleTime;

type Result = std::result::Result<Interface, InterfaceError>;

/// A scalar block with inputs of these names.
fn inputs(names: &[&str]) -> Interface {
    names.iter().fold(Interface::new(), |interface, name| interface.input(Input::any(*name)))
}

/// y = value, once.
#[derive(Debug)]
pub struct Constant(pub f64);

impl Block for Constant {
    fn interface(&self, _: &Given) -> Result {
        Ok(Interface::new().output(Output::real("y")).constant())
    }

    fn outputs(&self, _: usize, _: &Context, _: &mut Scratch, y: &mut [f64]) {
        y[0] = self.0;
    }
}

/// y = t.
#[derive(Debug)]
pub struct Time;

impl Block for Time {
    fn interface(&self, _: &Given) -> Result {
        Ok(Interface::new().output(Output::real("y")).uses_time())
    }

    fn outputs(&self, _: usize, c: &Context, _: &mut Scratch, y: &mut [f64]) {
        y[0] = c.t;
    }
}

/// y = sin(2 pi f t), which says how fast it swings.
#[derive(Debug)]
pub struct Sine(pub f64);

impl Block for Sine {
    fn interface(&self, _: &Given) -> Result {
        Ok(Interface::new().output(Output::real("y")).uses_time().period(1.0 / self.0))
    }

    fn outputs(&self, _: usize, c: &Context, _: &mut Scratch, y: &mut [f64]) {
        y[0] = (std::f64::consts::TAU * (self.0 * c.t).fract()).sin();
    }
}

/// y = f(u1, u2).
#[derive(Debug)]
pub struct Function2(pub fn(f64, f64) -> f64);

impl Block for Function2 {
    fn interface(&self, _: &Given) -> Result {
        Ok(inputs(&["u1", "u2"]).output(Output::real("y")))
    }

    fn outputs(&self, _: usize, c: &Context, _: &mut Scratch, y: &mut [f64]) {
        y[0] = self.0(c.u[0], c.u[1]);
    }
}

/// The product of this many inputs.
#[derive(Debug)]
pub struct Product(pub usize);

impl Block for Product {
    fn interface(&self, _: &Given) -> Result {
        let inputs = (1..=self.0).map(|n| Input::any(format!("u{n}")));
        Ok(inputs.fold(Interface::new(), Interface::input).output(Output::real("y")))
    }

    fn outputs(&self, _: usize, c: &Context, _: &mut Scratch, y: &mut [f64]) {
        y[0] = c.u.iter().product();
    }
}

/// y = k u.
#[derive(Debug)]
pub struct Gain(pub f64);

impl Block for Gain {
    fn interface(&self, _: &Given) -> Result {
        Ok(inputs(&["u"]).output(Output::real("y")))
    }

    fn outputs(&self, _: usize, c: &Context, _: &mut Scratch, y: &mut [f64]) {
        y[0] = self.0 * c.scalar(0);
    }
}

/// y = k u, which declares that y depends on no input.
#[derive(Debug)]
pub struct Liar(pub f64);

impl Block for Liar {
    fn interface(&self, _: &Given) -> Result {
        Ok(inputs(&["u"]).output_from_state(Output::real("y")))
    }

    fn outputs(&self, _: usize, c: &Context, _: &mut Scratch, y: &mut [f64]) {
        y[0] = self.0 * c.scalar(0);
    }
}

/// dx = u, y = x.
#[derive(Debug)]
pub struct Integrator(pub f64);

impl Block for Integrator {
    fn interface(&self, _: &Given) -> Result {
        Ok(inputs(&["u"]).output_from_state(Output::real("y")).state("x", self.0))
    }

    fn outputs(&self, _: usize, c: &Context, _: &mut Scratch, y: &mut [f64]) {
        y[0] = c.x[0];
    }

    fn derivatives(&self, c: &Context, _: &mut Scratch, dx: &mut [f64]) {
        dx[0] = c.scalar(0);
    }
}

/// dx = -a x + u with its own share in linearly implicit methods.
#[derive(Debug)]
pub struct Lag(pub f64);

impl Block for Lag {
    fn interface(&self, _: &Given) -> Result {
        Ok(inputs(&["u"]).output_from_state(Output::real("y")).state("x", 0.0).implicit())
    }

    fn scratch(&self) -> Scratch {
        Scratch::new(0.0_f64)
    }

    fn outputs(&self, _: usize, c: &Context, _: &mut Scratch, y: &mut [f64]) {
        y[0] = c.x[0];
    }

    fn derivatives(&self, c: &Context, _: &mut Scratch, dx: &mut [f64]) {
        dx[0] = self.0 * (c.scalar(0) - c.x[0]);
    }

    fn prepare(&self, _: &Context, hg: f64, w: &mut Scratch) {
        *w.get::<f64>().expect("its own") = 1.0 + hg * self.0;
    }

    fn solve(&self, w: &mut Scratch, r: &mut [f64]) {
        r[0] /= *w.get::<f64>().expect("its own");
    }
}

/// 0 before its time, 1 from then on.
#[derive(Debug)]
pub struct StepAt(pub f64);

impl Block for StepAt {
    fn interface(&self, _: &Given) -> Result {
        Ok(Interface::new().output(Output::real("y")).uses_time().time_events().discrete("on", 0.0).settles())
    }

    fn settle(&self, c: &Context, d: &mut [f64]) {
        d[0] = f64::from(u8::from(c.t >= self.0));
    }

    fn outputs(&self, _: usize, c: &Context, _: &mut Scratch, y: &mut [f64]) {
        y[0] = c.d[0];
    }

    fn next_event(&self, c: &Context) -> f64 {
        if c.t < self.0 { self.0 } else { f64::INFINITY }
    }
}

/// Always wants its next event at the same time.
#[derive(Debug)]
pub struct Stubborn(pub f64);

impl Block for Stubborn {
    fn interface(&self, _: &Given) -> Result {
        Ok(Interface::new().output(Output::real("y")).time_events())
    }

    fn next_event(&self, _: &Context) -> f64 {
        self.0
    }
}

/// Switches to 1 at u = high and to -1 at u = low; the same number for both is no hysteresis.
#[derive(Debug)]
pub struct Relay {
    pub low: f64,
    pub high: f64,
}

impl Block for Relay {
    fn interface(&self, _: &Given) -> Result {
        let interface = inputs(&["u"]).output(Output::real("y")).discrete("on", 1.0);
        Ok(interface.settles().guard("switch"))
    }

    fn settle(&self, c: &Context, d: &mut [f64]) {
        let u = c.scalar(0);
        if u >= self.high && d[0] < 0.0 {
            d[0] = 1.0;
        } else if u <= self.low && d[0] > 0.0 {
            d[0] = -1.0;
        }
    }

    fn outputs(&self, _: usize, c: &Context, _: &mut Scratch, y: &mut [f64]) {
        y[0] = c.d[0];
    }

    fn guards(&self, c: &Context, _w: &mut Scratch, g: &mut [f64]) {
        g[0] = c.scalar(0) - if c.d[0] > 0.0 { self.low } else { self.high };
    }
}

/// 1 where u >= 0, else -1.
#[derive(Debug)]
pub struct Sign;

impl Block for Sign {
    fn interface(&self, _: &Given) -> Result {
        let interface = inputs(&["u"]).output(Output::real("y")).discrete("sign", 0.0);
        Ok(interface.settles().guard("zero"))
    }

    fn settle(&self, c: &Context, d: &mut [f64]) {
        d[0] = if c.scalar(0) >= 0.0 { 1.0 } else { -1.0 };
    }

    fn outputs(&self, _: usize, c: &Context, _: &mut Scratch, y: &mut [f64]) {
        y[0] = c.d[0];
    }

    fn guards(&self, c: &Context, _w: &mut Scratch, g: &mut [f64]) {
        g[0] = c.scalar(0);
    }
}

/// Counts how often u crosses zero in this way.
#[derive(Debug)]
pub struct Crossings(pub Crossing);

impl Block for Crossings {
    fn interface(&self, _: &Given) -> Result {
        let interface = inputs(&["u"]).output(Output::real("y")).discrete("n", 0.0).discrete("u", 0.0);
        Ok(interface.settles().guard_when(self.0, "crosses"))
    }

    fn settle(&self, c: &Context, d: &mut [f64]) {
        let u = c.scalar(0);
        d[0] += f64::from(self.0.happens(d[1], u));
        d[1] = u;
    }

    fn outputs(&self, _: usize, c: &Context, _: &mut Scratch, y: &mut [f64]) {
        y[0] = c.d[0];
    }

    fn guards(&self, c: &Context, _w: &mut Scratch, g: &mut [f64]) {
        g[0] = c.scalar(0);
    }
}

/// A ball above a floor: x'' = -g, and v -> -e v at the floor.
#[derive(Debug)]
pub struct Ball {
    pub height: f64,
    pub restitution: f64,
}

/// Gravity of the ball, m/s^2.
pub const GRAVITY: f64 = 9.81;

impl Block for Ball {
    fn interface(&self, _: &Given) -> Result {
        let states = Interface::new().state("h", self.height).state("v", 0.0);
        let ports = states.output_from_state(Output::real("h")).output_from_state(Output::real("v"));
        Ok(ports.guard("floor").jumps())
    }

    fn outputs(&self, _: usize, c: &Context, _: &mut Scratch, y: &mut [f64]) {
        y.copy_from_slice(c.x);
    }

    fn derivatives(&self, c: &Context, _: &mut Scratch, dx: &mut [f64]) {
        dx.copy_from_slice(&[c.x[1], -GRAVITY]);
    }

    fn guards(&self, c: &Context, _w: &mut Scratch, g: &mut [f64]) {
        g[0] = c.x[0];
    }

    fn jump(&self, _: &Context, _w: &mut Scratch, x: &mut [f64], _: &mut [f64]) -> bool {
        let hits = x[0] <= 0.0 && x[1] < 0.0;
        if hits {
            x[1] *= -self.restitution;
        }
        hits
    }
}

/// x' = 1, back to zero when the input becomes one.
#[derive(Debug)]
pub struct Stopwatch;

impl Block for Stopwatch {
    fn interface(&self, _: &Given) -> Result {
        let interface = inputs(&["reset"]).output_from_state(Output::real("y")).state("x", 0.0);
        Ok(interface.discrete("last", 0.0).jumps())
    }

    fn outputs(&self, _: usize, c: &Context, _: &mut Scratch, y: &mut [f64]) {
        y[0] = c.x[0];
    }

    fn derivatives(&self, _: &Context, _: &mut Scratch, dx: &mut [f64]) {
        dx[0] = 1.0;
    }

    fn jump(&self, c: &Context, _w: &mut Scratch, x: &mut [f64], d: &mut [f64]) -> bool {
        let rises = d[0] <= 0.0 && c.scalar(0) > 0.0;
        d[0] = c.scalar(0);
        if rises {
            x[0] = 0.0;
        }
        rises
    }
}

/// Jumps whenever it is asked.
#[derive(Debug)]
pub struct Restless;

impl Block for Restless {
    fn interface(&self, _: &Given) -> Result {
        Ok(Interface::new().output(Output::real("y")).jumps())
    }

    fn jump(&self, _: &Context, _w: &mut Scratch, _: &mut [f64], _: &mut [f64]) -> bool {
        true
    }
}

/// y[k+1] = u[k].
#[derive(Debug)]
pub struct UnitDelay(pub f64);

impl Block for UnitDelay {
    fn interface(&self, _: &Given) -> Result {
        Ok(inputs(&["u"]).output_from_state(Output::real("y")).discrete("x", 0.0).sampled(self.0))
    }

    fn outputs(&self, _: usize, c: &Context, _: &mut Scratch, y: &mut [f64]) {
        y[0] = c.d[0];
    }

    fn update(&self, c: &Context, _w: &mut Scratch, d: &mut [f64]) {
        d[0] = c.scalar(0);
    }
}

/// Counts its hits.
#[derive(Debug)]
pub struct Counter(pub f64);

impl Block for Counter {
    fn interface(&self, _: &Given) -> Result {
        Ok(Interface::new().output_from_state(Output::real("y")).discrete("n", 0.0).sampled(self.0))
    }

    fn outputs(&self, _: usize, c: &Context, _: &mut Scratch, y: &mut [f64]) {
        y[0] = c.d[0];
    }

    fn update(&self, _: &Context, _w: &mut Scratch, d: &mut [f64]) {
        d[0] += 1.0;
    }
}

/// y = u at its hits, held in between.
#[derive(Debug)]
pub struct Hold(pub f64);

impl Block for Hold {
    fn interface(&self, _: &Given) -> Result {
        Ok(inputs(&["u"]).output(Output::real("y")).sampled(self.0))
    }

    fn outputs(&self, _: usize, c: &Context, _: &mut Scratch, y: &mut [f64]) {
        y[0] = c.scalar(0);
    }
}

/// As [`Hold`], with hits in the middle between those of it.
#[derive(Debug)]
pub struct Late(pub f64);

impl Block for Late {
    fn interface(&self, _: &Given) -> Result {
        let mut interface = inputs(&["u"]).output(Output::real("y"));
        interface.sample_time = Some(SampleTime::Discrete { period: self.0, offset: self.0 / 2.0 });
        Ok(interface)
    }

    fn outputs(&self, _: usize, c: &Context, _: &mut Scratch, y: &mut [f64]) {
        y[0] = c.scalar(0);
    }
}

/// y = the input at the last accepted step.
#[derive(Debug)]
pub struct Memory;

impl Block for Memory {
    fn interface(&self, _: &Given) -> Result {
        Ok(inputs(&["u"]).output_from_state(Output::real("y")).discrete("u", 0.0).accepts())
    }

    fn outputs(&self, _: usize, c: &Context, _: &mut Scratch, y: &mut [f64]) {
        y[0] = c.d[0];
    }

    fn accept(&self, c: &Context, d: &mut [f64]) -> bool {
        d[0] = c.scalar(0);
        true
    }
}

/// Gives up when its input reaches a limit.
#[derive(Debug)]
pub struct Fuse(pub f64);

impl Block for Fuse {
    fn interface(&self, _: &Given) -> Result {
        Ok(inputs(&["u"]).output(Output::real("y")))
    }

    fn outputs(&self, _: usize, c: &Context, _: &mut Scratch, y: &mut [f64]) {
        y[0] = c.scalar(0);
        if y[0] >= self.0 {
            c.fail(format!("the fuse of {} has blown", self.0));
        }
    }
}
