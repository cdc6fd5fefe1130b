use blocksim_controller::prelude::*;

use crate::arm::torques;
use crate::drive::motor_torque;
use crate::quantities::{LINKS, Rest, all, count, rest};

/// Central feedforward of torques for an arm with `N` joints: what each motor must give, so that the arm as it is
/// described moves along the set values.
///
/// It sees the set values of all joints and thus what they do to each other, and no measurement: the controllers of
/// the joints are left with what the description misses. In diagrams `ComputedTorque` has six joints,
/// `ComputedTorque2` two.
#[derive(Debug)]
pub struct ComputedTorque<const N: usize>;

impl<const N: usize> ComputedTorque<N> {
    const REST: Rest = rest(N);
    const ALL: &'static [Parameter] = &all(N);

    const Q: Input = Input::vector(0, N, "q", "rad", "Set positions.");
    const QD: Input = Input::vector(N, N, "qd", "rad/s", "Set speeds.");
    const QDD: Input = Input::vector(2 * N, N, "qdd", "rad/s^2", "Set accelerations.");
    const PORTS: &'static [Input] = &[Self::Q, Self::QD, Self::QDD];
    const TAU: Output = Output::vector(0, N, "tau", "N*m", "Torques of the motors.").reads(Self::PORTS);
}

impl<const N: usize> Controller for ComputedTorque<N> {
    const KIND: &'static str = if N == 6 { "ComputedTorque" } else { "ComputedTorque2" };
    const DOC: &'static str = include_str!("../README.md");
    const PARAMETERS: &'static [Parameter] = Self::ALL.split_at(count(N)).0;
    const INPUTS: &'static [Input] = Self::PORTS;
    const OUTPUTS: &'static [Output] = &[Self::TAU];

    fn check(p: &Parameters) -> Outcome {
        for (i, link) in LINKS[..N].iter().enumerate() {
            let numbers = [
                ("origin", link.origin),
                ("axis", link.axis),
                ("com", link.com),
                ("moi", link.moi),
                ("poi", link.poi),
            ];
            for (name, parameter) in numbers {
                finite(&format!("{name}{}", i + 1), p.vector(parameter))?;
            }
            not_negative(&format!("mass{}", i + 1), p.vector(link.mass))?;
            if p.vector(link.axis).iter().all(|x| *x == 0.0) {
                return Err(format!("`axis{}` is zero, it must have a direction", i + 1));
            }
        }
        let r = Self::REST;
        let numbers = [
            ("tool_at", r.tool_at),
            ("tool_rpy", r.tool_rpy),
            ("tool_com", r.tool_com),
            ("tool_moi", r.tool_moi),
            ("tool_poi", r.tool_poi),
            ("load_com", r.load_com),
            ("load_moi", r.load_moi),
            ("load_poi", r.load_poi),
            ("gravity", r.gravity),
        ];
        numbers.iter().try_for_each(|(name, parameter)| finite(name, p.vector(*parameter)))?;
        let amounts = [
            ("tool_mass", r.tool_mass),
            ("load_mass", r.load_mass),
            ("inertia", r.inertia),
            ("damping", r.damping),
            ("breakaway", r.breakaway),
            ("coulomb", r.coulomb),
            ("viscous", r.viscous),
        ];
        amounts.iter().try_for_each(|(name, parameter)| not_negative(name, p.vector(*parameter)))?;
        let scales = [
            ("threshold", r.threshold),
            ("ts", r.ts),
            ("ratio", r.ratio),
            ("breakaway_velocity", r.breakaway_velocity),
        ];
        scales.iter().try_for_each(|(name, parameter)| positive(name, p.vector(*parameter)))?;
        efficiency("efficiency_forward", p.vector(r.forward))?;
        efficiency("efficiency_backward", p.vector(r.backward))
    }

    fn sample_time(p: &Parameters) -> f64 {
        p[Self::REST.ts]
    }

    fn outputs(c: &Context, y: &mut Outputs) -> Outcome {
        let (q, qd, qdd) = (c.u.vector(Self::Q), c.u.vector(Self::QD), c.u.vector(Self::QDD));
        let tau: [f64; N] = torques(c.p, &Self::REST, q, qd, qdd);
        for (i, motor) in y.vector_mut(Self::TAU).iter_mut().enumerate() {
            *motor = motor_torque(c.p, &Self::REST, i, tau[i], qd[i], qdd[i]);
        }
        Ok(())
    }
}

/// An error unless all numbers of a parameter are `good`; with several of them it names the place or the joint.
fn each(name: &str, numbers: &[f64], good: impl Fn(f64) -> bool, rule: &str) -> Outcome {
    match numbers.iter().position(|number| !good(*number)) {
        None => Ok(()),
        Some(_) if numbers.len() == 1 => Err(format!("`{name}` is {}, {rule}", numbers[0])),
        Some(i) => Err(format!("`{name}[{i}]` is {}, {rule}", numbers[i])),
    }
}

fn finite(name: &str, numbers: &[f64]) -> Outcome {
    each(name, numbers, f64::is_finite, "it must be finite")
}

fn not_negative(name: &str, numbers: &[f64]) -> Outcome {
    each(name, numbers, |x| x >= 0.0 && x.is_finite(), "it must be finite and not negative")
}

fn positive(name: &str, numbers: &[f64]) -> Outcome {
    each(name, numbers, |x| x > 0.0 && x.is_finite(), "it must be finite and positive")
}

fn efficiency(name: &str, numbers: &[f64]) -> Outcome {
    each(name, numbers, |x| x > 0.0 && x <= 1.0, "an efficiency is above 0 and at most 1")
}
