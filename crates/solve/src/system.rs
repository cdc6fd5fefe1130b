//! What is integrated: a system of ordinary differential equations and how exactly it is to be followed.

/// A system of ordinary differential equations dx/dt = f(t, x).
///
/// `&mut self` lets it keep scratch space; seen from outside it must be a pure function of (t, x), because
/// trial steps are thrown away and tried again.
pub trait System {
    /// Number of states n; constant over the life of a stepper.
    fn dimension(&self) -> usize;

    /// Writes f(t, x) to `dx`. Both slices have length n.
    ///
    /// A value that is not finite, or a failure, at a trial point rejects the trial step, which is repeated with a smaller
    /// one: the point need not be one of the solution. Of what else belongs to the point, as the signals of a diagram, the system need not
    /// know anything afterwards.
    ///
    /// # Errors
    /// [`Failed`] ends the integration where it happens at the start of a step, or at trial points however near to it;
    /// the system keeps the details of the last one.
    fn derivatives(&mut self, t: f64, x: &[f64], dx: &mut [f64]) -> Result<(), Failed>;

    /// Makes the step of a method of fixed step from (`t`, `x`) to `t1`, whose size is `h`, to the bit as the method makes it, and returns
    /// true; or leaves it to the method. A system that knows no method by which it is integrated, see [`Weights`](crate::Weights), leaves
    /// all of them. What lies within a step that it has made nobody can ask for, and `x` has been finite at all stages.
    fn step(&mut self, _t: f64, _t1: f64, _h: f64, _x: &mut [f64]) -> bool {
        false
    }

    /// Of each state, the derivatives that may depend on it, by number, wherever the system is evaluated; nothing where that is not
    /// known. Asked for once by methods that need a Jacobian: one evaluation then tells the slopes of all states that act on
    /// different derivatives. One that is missing here counts as zero for ever; one too many costs a little.
    fn influence(&self) -> Option<Vec<Vec<usize>>> {
        None
    }

    /// Writes J `direction` to `change`, exactly: how the derivatives change along a direction in the space of the states, with J =
    /// df/dx at (t, x), and returns true; or returns false where that is not known. All slices have length n.
    fn along(&mut self, _t: f64, _x: &[f64], _direction: &[f64], _change: &mut [f64]) -> bool {
        false
    }

    /// Prepares [`solve`](System::solve): an approximation J of the Jacobian df/dx at (t, x), as rough as is cheap,
    /// and the factorisation of I - hg J. Asked for by W-methods only, once per trial step. Default: J = 0.
    ///
    /// # Errors
    /// [`Failed`], as above.
    fn prepare(&mut self, _t: f64, _x: &[f64], _hg: f64) -> Result<(), Failed> {
        Ok(())
    }

    /// Overwrites `r` with (I - hg J)^-1 `r` for the J and hg of the last [`prepare`](System::prepare).
    /// Default: leaves `r` as it is, which belongs to J = 0.
    fn solve(&mut self, _r: &mut [f64]) {}
}

/// The system could not be evaluated. It keeps the reason itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Failed;

impl std::fmt::Display for Failed {
    fn fmt(&self, out: &mut std::fmt::Formatter) -> std::fmt::Result {
        out.write_str("the system could not be evaluated")
    }
}

impl std::error::Error for Failed {}

/// Magnitude below which a state of unknown size is followed with fewer digits, in its own unit: a picometre, a picoampere.
/// A state that leaves zero as t^3, as the angle of a body does that dry friction lets go, has no step at all whose error is a
/// given part of it with a method of order two: every step has the same share.
pub(crate) const NOTHING: f64 = 1e-12;

/// Tolerances of the local error: state i may err by `absolute[i] + relative * |x[i]|` in one step, in the root
/// mean square over the states (Hairer, Nørsett, Wanner: Solving Ordinary Differential Equations I, eq. II.4.11).
#[derive(Debug, Clone, PartialEq)]
pub struct Tolerances {
    /// Part of the state's magnitude; 1e-6 asks for about six digits.
    pub relative: f64,
    /// Floor per state, in its unit: what counts as nothing. Its length is the dimension of the system.
    pub absolute: Vec<f64>,
    /// Whether the floor follows the size that a state has had of late, a thousandth of the relative tolerance there;
    /// `absolute` is then the least. States that are nothing but rounding are found out.
    pub automatic: bool,
    /// States whose floor stays as it is even so.
    pub fixed: Vec<bool>,
    /// Nominal value of each state for automatic floors; 0 where none is known.
    pub nominal: Vec<f64>,
    /// States each of which counts as large as the largest of them for automatic floors.
    pub kin: Vec<Vec<usize>>,
}

impl Tolerances {
    /// The same tolerances for all of `dimension` states.
    pub fn uniform(dimension: usize, relative: f64, absolute: f64) -> Self {
        Self {
            relative,
            absolute: vec![absolute; dimension],
            automatic: false,
            fixed: vec![false; dimension],
            nominal: vec![0.0; dimension],
            kin: Vec::new(),
        }
    }

    /// A relative tolerance alone; what counts as nothing follows from the sizes of the states, down to a magnitude of
    /// 1e-12.
    pub fn automatic(dimension: usize, relative: f64) -> Self {
        Self {
            relative,
            absolute: vec![relative * NOTHING; dimension],
            automatic: true,
            fixed: vec![false; dimension],
            nominal: vec![0.0; dimension],
            kin: Vec::new(),
        }
    }

    /// Gives one state a floor of its own.
    pub fn fix(&mut self, state: usize, absolute: f64) {
        self.absolute[state] = absolute;
        self.fixed[state] = true;
    }
}
