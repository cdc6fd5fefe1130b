//! Base parameters: the fewest combinations of inertial parameters that decide the torques.

use blocksim_multibody::{Model, PARAMETER_NAMES, PARAMETERS_PER_BODY, regressor};
use nalgebra::DMatrix;

use crate::random::Random;

/// Entries of the triangle of the factorisation that count as zero, over the largest.
const ZERO: f64 = 1e-9;

/// Coefficients of combinations that are rounding.
const ROUNDING: f64 = 1e-9;

/// One base parameter: an inertial parameter, and the others that cannot be told from it.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseParameter {
    /// Index of the parameter that stands for the combination, among those of
    /// [`Model::inertial_parameters`].
    pub chosen: usize,
    /// The others with their factors.
    pub others: Vec<(usize, f64)>,
}

/// The base parameters of a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseParameters {
    /// The parameters, by the index of the chosen one.
    pub parameters: Vec<BaseParameter>,
    /// Inertial parameters that move nothing, by index.
    pub without_effect: Vec<usize>,
}

impl BaseParameters {
    /// Finds them from the regressor at `samples` random motions: the columns of those inertial parameters that depend on
    /// columns before them are given to these. Numerical, therefore for any tree; seeded, therefore reproducible.
    ///
    /// Columns are tried from the base outwards, so that what an outer body adds is grouped with the bodies that bear it,
    /// as in textbooks.
    ///
    /// Source: M. Gautier, *Numerical Calculation of the Base Inertial Parameters of Robots*, Journal of Robotic Systems 8
    /// (1991) 485-506.
    pub fn of(model: &Model, samples: usize, seed: u64) -> BaseParameters {
        let columns = PARAMETERS_PER_BODY * model.bodies().count();
        let stack = random_stack(model, samples, seed);
        let order: Vec<usize> = preference(columns);
        // Modified Gram-Schmidt, twice: a column that nothing is left of depends on those before it.
        let mut basis: Vec<(usize, Vec<f64>)> = Vec::new();
        let mut dependent = Vec::new();
        let mut without_effect = Vec::new();
        let scale = stack.column_iter().map(|column| column.norm()).fold(0.0, f64::max);
        for &column in &order {
            let mut rest: Vec<f64> = stack.column(column).iter().copied().collect();
            let length = norm(&rest);
            if length <= ZERO * scale {
                without_effect.push(column);
                continue;
            }
            for _ in 0..2 {
                for (_, unit) in &basis {
                    let along: f64 = unit.iter().zip(&rest).map(|(a, b)| a * b).sum();
                    rest.iter_mut().zip(unit).for_each(|(rest, unit)| *rest -= along * unit);
                }
            }
            let left = norm(&rest);
            if left > ZERO * length {
                rest.iter_mut().for_each(|rest| *rest /= left);
                basis.push((column, rest));
            } else {
                dependent.push(column);
            }
        }
        without_effect.sort_unstable();
        let chosen: Vec<usize> = basis.iter().map(|(column, _)| *column).collect();
        let mut parameters: Vec<BaseParameter> =
            chosen.iter().map(|chosen| BaseParameter { chosen: *chosen, others: Vec::new() }).collect();
        if !dependent.is_empty() && !chosen.is_empty() {
            let independent = DMatrix::from_fn(stack.nrows(), chosen.len(), |i, j| stack[(i, chosen[j])]);
            let wanted = DMatrix::from_fn(stack.nrows(), dependent.len(), |i, j| stack[(i, dependent[j])]);
            let qr = independent.qr();
            let right = qr.q().tr_mul(&wanted);
            if let Some(factors) = qr.r().solve_upper_triangular(&right) {
                for (row, parameter) in parameters.iter_mut().enumerate() {
                    parameter.others = (0..dependent.len())
                        .map(|j| (dependent[j], factors[(row, j)]))
                        .filter(|(_, factor)| factor.abs() > ROUNDING)
                        .collect();
                    parameter.others.sort_by_key(|(index, _)| *index);
                }
            }
        }
        parameters.sort_by_key(|parameter| parameter.chosen);
        BaseParameters { parameters, without_effect }
    }

    /// Number of base parameters.
    pub fn len(&self) -> usize {
        self.parameters.len()
    }

    /// Nothing decides the torques.
    pub fn is_empty(&self) -> bool {
        self.parameters.is_empty()
    }

    /// Values of the base parameters for inertial parameters of all bodies.
    pub fn values(&self, inertial: &[f64]) -> Vec<f64> {
        let value = |parameter: &BaseParameter| {
            let others: f64 = parameter.others.iter().map(|(index, factor)| factor * inertial[*index]).sum();
            inertial[parameter.chosen] + others
        };
        self.parameters.iter().map(value).collect()
    }

    /// Columns of a full regressor, row-major with `columns` in each row, that belong to the base parameters.
    pub fn reduce(&self, full: &[f64], columns: usize, rows: &mut Vec<f64>) {
        for row in full.chunks_exact(columns) {
            rows.extend(self.parameters.iter().map(|parameter| row[parameter.chosen]));
        }
    }

    /// The combination in words: `Izz2 + 0.36 m3`. Bodies are counted from 1.
    pub fn name(&self, index: usize) -> String {
        let parameter = &self.parameters[index];
        let mut name = inertial_name(parameter.chosen);
        for (other, factor) in &parameter.others {
            let sign = if *factor < 0.0 { '-' } else { '+' };
            let size = factor.abs();
            let factor = if (size - 1.0).abs() < 1e-6 { String::new() } else { format!("{} ", short(size)) };
            name.push_str(&format!(" {sign} {factor}{}", inertial_name(*other)));
        }
        name
    }
}

/// Name of an inertial parameter: `Ixx3`, `m2`.
pub fn inertial_name(index: usize) -> String {
    format!("{}{}", PARAMETER_NAMES[index % PARAMETERS_PER_BODY], index / PARAMETERS_PER_BODY + 1)
}

/// Four significant digits without trailing zeros.
fn short(x: f64) -> String {
    let digits = (3 - x.log10().floor() as i32).clamp(0, 12) as usize;
    let text = format!("{x:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// The order in which parameters are chosen: from the base outwards, of each body inertias and first moments before the
/// mass. Of several that cannot be told apart the earliest stands for all.
fn preference(columns: usize) -> Vec<usize> {
    // Of moments of inertia of which only a difference shows, xx stands for it.
    let within = [4, 9, 8, 7, 6, 1, 2, 3, 5, 0];
    let bodies = columns / PARAMETERS_PER_BODY;
    (0..bodies).flat_map(|body| within.map(|k| PARAMETERS_PER_BODY * body + k)).collect()
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Regressors of random motions one below the other.
fn random_stack(model: &Model, samples: usize, seed: u64) -> DMatrix<f64> {
    let (n, mut data) = (model.dof(), model.data());
    let columns = PARAMETERS_PER_BODY * model.bodies().count();
    let mut random = Random::new(seed);
    let mut stack = Vec::with_capacity(samples * n * columns);
    let mut y = vec![0.0; n * columns];
    for _ in 0..samples {
        let mut draw = |count: usize, size: f64| -> Vec<f64> {
            (0..count).map(|_| random.between(-size, size)).collect()
        };
        let (q, v, a) = (draw(model.nq(), 3.0), draw(n, 3.0), draw(n, 10.0));
        regressor(model, &mut data, &q, &v, &a, &mut y);
        stack.extend_from_slice(&y);
    }
    DMatrix::from_row_slice(samples * n, columns, &stack)
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use blocksim_multibody::{Inertia, Joint, ModelBuilder, Placement, rnea};

    /// Links of 0.8 m in a row about parallel axes; the weight lies along x or along the axes.
    pub(crate) fn planar(links: usize, gravity: [f64; 3]) -> Model {
        let mut builder = ModelBuilder::new();
        builder.gravity(gravity);
        let mut parent = None;
        for link in 0..links {
            let at = [if link == 0 { 0.0 } else { 0.8 }, 0.0, 0.0];
            let inertia =
                Inertia::from_moments(3.0 + link as f64, [0.4, 0.05, 0.1], [0.1, 0.2, 0.25], [0.0; 3]);
            let place = Placement::from_rpy(at, [0.0; 3]);
            parent = builder.add_body(parent, Joint::revolute([0.0, 0.0, 1.0]), place, inertia.unwrap()).ok();
        }
        builder.build()
    }

    fn names(base: &BaseParameters) -> Vec<String> {
        (0..base.len()).map(|index| base.name(index)).collect()
    }

    #[test]
    fn a_planar_arm_of_two_links_has_the_base_parameters_of_the_textbooks() {
        // In a horizontal plane: I1 + m2 l1², I2, mx2, my2; the first moments of link 1 only show under gravity.
        let base = BaseParameters::of(&planar(2, [0.0, 0.0, -9.81]), 50, 1);
        assert_eq!(names(&base), ["Izz1 + 0.64 m2", "mx2", "my2", "Izz2"]);
        let base = BaseParameters::of(&planar(2, [0.0, -9.81, 0.0]), 50, 1);
        assert_eq!(names(&base), ["mx1 + 0.8 m2", "my1", "Izz1 + 0.64 m2", "mx2", "my2", "Izz2"]);
        assert_eq!(base.without_effect.len(), 20 - 7);
    }

    #[test]
    fn base_parameters_give_the_torques_of_all_parameters() {
        let model = planar(3, [1.0, -9.0, 2.0]);
        let base = BaseParameters::of(&model, 60, 3);
        let values = base.values(&model.inertial_parameters());
        let (mut data, mut tau) = (model.data(), [0.0; 3]);
        let (q, v, a) = ([0.3, -1.0, 2.0], [1.0, 2.0, -0.5], [3.0, -1.0, 0.5]);
        rnea(&model, &mut data, &q, &v, &a, &mut tau);
        let (mut full, mut reduced) = (vec![0.0; 90], Vec::new());
        regressor(&model, &mut data, &q, &v, &a, &mut full);
        base.reduce(&full, 30, &mut reduced);
        for (row, tau) in reduced.chunks_exact(base.len()).zip(tau) {
            let got: f64 = row.iter().zip(&values).map(|(y, p)| y * p).sum();
            assert!((got - tau).abs() < 1e-11 * (1.0 + tau.abs()), "{got} is not {tau}");
        }
    }

    #[test]
    fn a_single_spherical_joint_shows_all_but_the_mass() {
        let mut builder = ModelBuilder::new();
        let body = Inertia::from_moments(2.0, [0.1, 0.2, 0.3], [0.5, 0.6, 0.7], [0.01, 0.02, 0.03]).unwrap();
        builder.add_body(None, Joint::Spherical, Placement::identity(), body).unwrap();
        let base = BaseParameters::of(&builder.build(), 30, 2);
        assert_eq!(base.len(), 9);
        assert_eq!(base.without_effect, [0]);
    }

    #[test]
    fn numbers_in_names_are_short() {
        assert_eq!(
            [0.64, 0.9, 1.5, 12.345_678, 0.012_345_6].map(short),
            ["0.64", "0.9", "1.5", "12.35", "0.01235"]
        );
    }
}
