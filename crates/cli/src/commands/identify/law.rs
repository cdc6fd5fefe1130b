//! Laws of the members of a network at a speed that no run has.

use blocksim_block::physical::{
    Component, DryMesh, Element, ElementPlace, Fed, Flowing, Grip, JointMotion, Known, Moving, Needs, Supply,
    Torque,
};
use blocksim_network::Member;

/// Temperature of thermal ports, K.
const ROOM: f64 = 293.15;

/// Torque of a member without states over the speed between its ports, N*m: from `r` to `c`, its inputs as they are where
/// nothing is connected. `None` where it does not follow from the speed alone.
pub fn torque(member: &Member, w: f64) -> Option<f64> {
    if !member.part.states.is_empty() {
        return None;
    }
    let found = match acting(member)? {
        Element::Friction { .. } => seen(member, w, &voltages(member), |component, c| {
            let mut grips = [Grip::default()];
            component.grips(c, &mut grips);
            w.signum() * grips[0].slide[usize::from(w < 0.0)].value
        }),
        _ => seen(member, w, &voltages(member), branch),
    };
    found.filter(|torque| torque.is_finite())
}

/// Torque of a machine without currents that is not in its output `torque`, N*m: its own friction.
pub fn idle_torque(member: &Member, w: f64) -> Option<f64> {
    acting(member)?;
    let voltage = without_current(member, w)?;
    let outputs = &member.part.outputs;
    let place = outputs.iter().position(|(output, _)| output.name == "torque");
    let found = seen(member, w, &voltage, |component, c| {
        let mut y = vec![0.0; outputs.len()];
        match place.map(|place| outputs[place].1) {
            Some(Needs::State) => component.measure_state(c, &mut y),
            Some(Needs::Electrics) => component.measure_electrics(c, &mut y),
            Some(Needs::Motion) | None => {}
        }
        branch(component, c) + place.map_or(0.0, |place| y[place])
    })?;
    found.is_finite().then_some(found)
}

/// Torque of spring, damper and ends of travel inside a joint, N*m, at a position and a speed.
pub fn inside_joint(member: &Member, q: f64, w: f64) -> f64 {
    let joint = [JointMotion { q, w }];
    let found = seen(member, w, &voltages(member), |component, c| {
        let mut tau = [Torque::default()];
        component.joint_torques(&Moving { joint: &joint, ..c.fed.moving }, &mut tau);
        tau[0].value
    });
    found.unwrap_or(f64::NAN)
}

/// What a mesh with stiction loses, if it is the same at all speeds; `number` counts these meshes of the member.
pub fn mesh_loss(member: &Member, number: usize) -> Option<DryMesh> {
    let at = |w: f64| {
        seen(member, w, &voltages(member), |component, c| {
            let mut losses = vec![DryMesh::default(); number + 1];
            component.mesh_losses(c, &vec![w; number + 1], &mut losses);
            losses[number]
        })
    };
    let loss = at(1.0)?;
    [0.01, 100.0].into_iter().all(|w| at(w) == Some(loss)).then_some(loss)
}

fn branch(component: &dyn Component, c: &Flowing) -> f64 {
    let mut tau = [Torque::default()];
    component.torques(c, &mut tau);
    tau[0].value
}

/// The only element of a member that acts on the mechanics.
fn acting(member: &Member) -> Option<&Element> {
    let is_acting = |element: &&Element| matches!(element, Element::Branch { .. } | Element::Friction { .. });
    let mut found = member.part.elements.iter().filter(is_acting);
    found.next().filter(|_| found.next().is_none())
}

/// Voltages of the two-pins of a member at rest.
fn voltages(member: &Member) -> Vec<f64> {
    let of = |element: &Element| {
        let volts = if matches!(element, Element::Heat { .. }) { ROOM } else { 0.0 };
        std::iter::repeat_n(volts, element.two_pins())
    };
    member.part.elements.iter().flat_map(of).collect()
}

/// The voltages at which no current flows in windings whose current follows from the voltage: their induced voltages.
fn without_current(member: &Member, w: f64) -> Option<Vec<f64>> {
    let mut voltage = voltages(member);
    let (mut pin, mut windings) = (0, Vec::new());
    for element in &member.part.elements {
        match element {
            Element::Winding { from_state, .. } => windings.push((pin, *from_state)),
            Element::CurrentSource { .. } => windings.push((pin, true)),
            _ => {}
        }
        pin += element.two_pins();
    }
    let currents = |voltage: &[f64]| {
        seen(member, w, voltage, |component, c| {
            let mut i = vec![0.0; windings.len()];
            component.currents_by_voltages(c, &mut i);
            i
        })
    };
    let idle = currents(&voltage)?;
    for (place, (pin, _)) in windings.iter().enumerate().filter(|(_, (_, from_state))| !from_state) {
        let mut more = voltage.clone();
        more[*pin] += 1.0;
        voltage[*pin] -= idle[place] / (currents(&more)?[place] - idle[place]);
    }
    Some(voltage)
}

/// Evaluates a law of a member at a speed, with states of zero and its inputs as they are where nothing is connected.
fn seen<T>(
    member: &Member,
    w: f64,
    voltage: &[f64],
    law: impl FnOnce(&dyn Component, &Flowing) -> T,
) -> Option<T> {
    let component = member.block.component()?;
    let part = &member.part;
    let (mut u, mut inputs) = (Vec::new(), Vec::new());
    for (input, length) in part.inputs.iter().zip(&member.input_lengths) {
        let first = u.len() as u32;
        u.extend(std::iter::repeat_n(input.default.unwrap_or(0.0), *length));
        inputs.push((first, u.len() as u32));
    }
    let mut places = Vec::new();
    let mut two_pin = 0;
    for (index, element) in part.elements.iter().enumerate() {
        let named = part.handles.iter().filter(|(_, named)| *named == index);
        places.extend(named.map(|(handle, _)| ElementPlace {
            handle: *handle,
            two_pin,
            characteristic: None,
        }));
        two_pin += element.two_pins();
    }
    let (x, d) = (vec![0.0; part.states.len()], vec![0.0; part.discrete.len()]);
    let (speed, mode) = (vec![w; part.elements.len()], vec![w.signum(); part.elements.len()]);
    let current = vec![0.0; voltage.len()];
    let known = Known { x: &x, d: &d, u: &u, inputs: &inputs, ..Known::NOTHING };
    let moving = Moving { known, speed: &speed, mode: &mode, ..Moving::NOTHING };
    let fed = Fed { moving, supply: &Supply::NONE };
    let c = Flowing { fed, voltage, current: &current, places: &places, ..Flowing::NOTHING };
    Some(law(component, &c))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use blocksim_block::{Block, Given};
    use blocksim_blocks::machines::{StepperMotor, UniversalMotor};
    use blocksim_blocks::mechanics::FrictionModel;
    use blocksim_blocks::rotational::{RotationalDamper, RotationalFriction};

    use super::*;

    fn member(block: impl Component) -> Member {
        let part = block.part(&Given::nothing());
        let (input_lengths, read) = (vec![1; part.inputs.len()], vec![false; part.outputs.len()]);
        let block: Arc<dyn Block> = Arc::new(block);
        Member { path: "part".to_owned(), block, part, input_lengths, read }
    }

    fn stepper(l: f64) -> StepperMotor {
        StepperMotor {
            teeth: 50,
            r: 1.2,
            l,
            k: 0.22,
            j: 5e-6,
            detent: 8e-3,
            damping: 2e-4,
            g_m: 0.01,
            theta0: 0.0,
            i_a0: 0.0,
            i_b0: 0.0,
            heat_port: false,
        }
    }

    #[test]
    fn a_machine_without_currents_has_its_damping() {
        // The losses in the iron of a stepper are in its torque; without inductance its induced voltages drive currents.
        for machine in [member(stepper(2.4e-3)), member(stepper(0.0))] {
            let torque = idle_torque(&machine, 30.0).unwrap();
            assert!((torque - 2e-4 * 30.0).abs() < 1e-12, "{torque}");
        }
        let universal =
            UniversalMotor { r: 4.0, l: 0.02, l_af: 0.12, j: 1e-4, damping: 1e-4, i0: 5.0, heat_port: false };
        assert!((idle_torque(&member(universal), -50.0).unwrap() + 5e-3).abs() < 1e-15);
    }

    #[test]
    fn torques_of_the_speed_alone_are_known_and_others_are_not() {
        assert_eq!(torque(&member(RotationalDamper { d: 0.5, heat_port: false }), -4.0), Some(-2.0));
        let friction = RotationalFriction {
            breakaway: 8.0,
            breakaway_velocity: 0.02,
            coulomb: 6.0,
            viscous: 4.0,
            model: FrictionModel::Stiction,
            heat_port: false,
        };
        // By hand at the breakaway velocity: 6 + 2 exp(-1/2) + 4 * 0.02.
        let expected = 6.0 + 2.0 * (-0.5_f64).exp() + 0.08;
        for sense in [1.0, -1.0] {
            let found = torque(&member(friction.clone()), sense * 0.02).unwrap();
            assert!((found - sense * expected).abs() < 1e-12, "{found}");
        }
        assert_eq!(torque(&member(stepper(0.0)), 1.0), None);
    }
}
