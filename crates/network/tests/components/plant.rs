//! A network written as in a diagram, on a bench.

use std::marker::PhantomData;
use std::sync::Arc;

use blocksim_block::testing::Bench;
use blocksim_block::{Block, BlockKind, Given, Input, Output};
use blocksim_blocks::electrical::*;
use blocksim_blocks::gears::*;
use blocksim_blocks::machines::*;
use blocksim_blocks::multibody::*;
use blocksim_blocks::power_electronics::*;
use blocksim_blocks::rotational::*;
use blocksim_blocks::three_phase::*;
use blocksim_blocks::translational::*;
use blocksim_network::{Member, Network, NetworkProblem, Terminal, assemble};
use serde::de::{DeserializeSeed, Deserializer};

use crate::open_windings::{Cyclic, StarPoint};

/// Reads the parameters of a kind.
struct Reader<K>(&'static str, PhantomData<K>);

impl<'de, K: BlockKind> DeserializeSeed<'de> for Reader<K> {
    type Value = K;

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<K, D::Error> {
        K::from_deserializer(self.0, deserializer)
    }
}

fn read<K: BlockKind>(kind: &'static str, text: &str) -> Arc<dyn Block> {
    let options = ron::Options::default().with_default_extension(ron::extensions::Extensions::IMPLICIT_SOME);
    let read = options.from_str_seed(text, Reader::<K>(kind, PhantomData));
    let kind = read.unwrap_or_else(|error| panic!("{text}: {error}"));
    Arc::new(kind.try_build().unwrap_or_else(|errors| panic!("{text}: {errors:?}")))
}

/// Wraps the numbers that may have a unit or none as a diagram does: `r_s: 0.25` to `r_s: Number(0.25, [])`.
fn with_measures(text: &str) -> String {
    let names = ["r_s", "x_ls", "r_r", "x_lr", "x_m", "x_0", "voltage", "frequency", "slip"];
    let mut wrapped = String::new();
    for part in text.split_inclusive([',', '(', ')']) {
        let (value, end) = part.split_at(part.len() - usize::from(part.ends_with([',', '(', ')'])));
        let number = value
            .split_once(": ")
            .filter(|(name, value)| names.contains(&name.trim()) && value.trim().parse::<f64>().is_ok());
        match number {
            Some((name, value)) => wrapped += &format!("{name}: Number({value}, []){end}"),
            None => wrapped += part,
        }
    }
    wrapped
}

/// A block from text such as `Inertia(j: 1.0)`; all numbers are SI.
fn block(text: &str) -> Arc<dyn Block> {
    let kind = text.split('(').next().unwrap_or_default();
    let text = if text.contains('(') { text.to_owned() } else { format!("{text}()") };
    let text = if kind.starts_with("AsynchronousMachine") { with_measures(&text) } else { text };
    macro_rules! one_of {
        ($($kind:ident)*) => {
            match kind {
                $(stringify!($kind) => read::<$kind>(stringify!($kind), &text),)*
                _ => panic!("unknown kind {kind}"),
            }
        };
    }
    one_of!(
        ElasticGear AsynchronousMachine AveragedInverter Body Brake Clutch ConstantTorque ControlledVoltageSource
        CurrentSensor Cyclic CycloidalDrive CylindricalJoint DcMotor DcMotorByRating DcMotorByStall Differential
        ElectricalReference ExternalForce FrameSpringDamper Payload PointPlaneContact TransformSensor
        FreeJoint HarmonicDrive IdealAngleSource IdealSpeedSource IdealTorqueSource Inertia LossyGear LuGreFriction
        MotionSensor OneWayClutch PermanentMagnetMachine PlanarJoint PlanetaryGear PrismaticJoint QuadraticLoad RevoluteJoint
        RotationalDamper RotationalFriction RotationalHardStop RotationalReference RotationalSpring
        RotationalRigidStop RotationalSpringDamper SimpleGear SphericalJoint StarPoint ThreePhaseSource TorqueSensor
        Transform UniversalJoint UniversalMotor
        VectorInverter VoltageSensor VoltageSource WeldJoint World WormGear WoundFieldDcMotor
        ConstantForce ForceSensor IdealForceSource IdealVelocitySource LeadScrew LeadScrewByFriction Mass
        RackAndPinion TranslationalDamper TranslationalFriction TranslationalHardStop
        TranslationalMotionSensor TranslationalReference TranslationalRigidStop TranslationalSpring TranslationalSpringDamper
        WheelAndAxle
    )
}

fn members(blocks: &[(&str, &str)]) -> Vec<Member> {
    let mut members: Vec<Member> = blocks
        .iter()
        .map(|(path, text)| {
            let block = block(text);
            let part = block.component().expect("a component").part(&Given::nothing());
            let length = |input: &Input| input.shape.map_or(1, |shape| shape.len());
            let input_lengths = part.inputs.iter().map(length).collect();
            let read = vec![true; part.outputs.len()];
            Member { path: (*path).to_owned(), block, part, input_lengths, read }
        })
        .collect();
    members.sort_by(|a, b| a.path.cmp(&b.path));
    members
}

fn terminal(members: &[Member], text: &str) -> Terminal {
    let (path, name) = text.trim().rsplit_once('.').expect("path.port");
    let member = members.iter().position(|member| member.path == path).expect("a member of this path");
    let ports = &members[member].part.ports;
    let port = ports.iter().position(|port| port.name == name).unwrap_or_else(|| panic!("no port {text}"));
    Terminal { member, port }
}

/// Assembles blocks with connections such as `motor.r <-> gear.base`; each set of joined ports is one line.
pub fn assembled(blocks: &[(&str, &str)], connections: &[&str]) -> Result<Network, Vec<NetworkProblem>> {
    joined(members(blocks), connections)
}

fn joined(members: Vec<Member>, connections: &[&str]) -> Result<Network, Vec<NetworkProblem>> {
    let joined: Vec<Vec<Terminal>> = connections
        .iter()
        .map(|line| line.split("<->").map(|text| terminal(&members, text)).collect())
        .collect();
    assemble(members, &joined)
}

/// A network with its buffers.
pub struct Plant {
    pub bench: Bench,
}

impl Plant {
    pub fn new(blocks: &[(&str, &str)], connections: &[&str]) -> Self {
        let network = assembled(blocks, connections).unwrap_or_else(|problems| panic!("{problems:#?}"));
        Self { bench: Bench::of(network) }
    }

    /// Where somebody reads these outputs alone.
    pub fn read_at(blocks: &[(&str, &str)], connections: &[&str], outputs: &[&str]) -> Self {
        let mut members = members(blocks);
        for Member { path, part, read, .. } in &mut members {
            let names = part.outputs.iter().map(|(output, _)| format!("{path}.{}", output.name));
            read.iter_mut().zip(names).for_each(|(read, name)| *read = outputs.contains(&name.as_str()));
        }
        let network = joined(members, connections).unwrap_or_else(|problems| panic!("{problems:#?}"));
        Self { bench: Bench::of(network) }
    }

    /// Sets an input of a member.
    pub fn set(&mut self, name: &str, value: f64) -> &mut Self {
        let index = self.bench.interface.inputs.iter().position(|input| input.name == name);
        self.bench.set(index.unwrap_or_else(|| panic!("no input {name}")), &[value]);
        self
    }

    /// Sets a vector input of a member.
    pub fn set_all(&mut self, name: &str, values: &[f64]) -> &mut Self {
        let index = self.bench.interface.inputs.iter().position(|input| input.name == name);
        self.bench.set(index.unwrap_or_else(|| panic!("no input {name}")), values);
        self
    }

    fn output(&self, name: &str) -> usize {
        let index = self.bench.interface.outputs.iter().position(|output| output.name == name);
        index.unwrap_or_else(|| panic!("no output {name}"))
    }

    /// The group with which an output of a member is evaluated.
    pub fn group(&self, name: &str) -> usize {
        self.bench.interface.group_of[self.output(name)]
    }

    /// Reads an output of a member.
    pub fn get(&mut self, name: &str) -> f64 {
        self.get_all(name)[0]
    }

    /// Reads a vector output of a member.
    pub fn get_all(&mut self, name: &str) -> Vec<f64> {
        let index = self.output(name);
        let length = |output: &Output| output.port_type.shape.len();
        let outputs = &self.bench.interface.outputs;
        let (start, n) = (outputs[..index].iter().map(length).sum::<usize>(), length(&outputs[index]));
        self.bench.minor()[start..start + n].to_vec()
    }

    /// Index of a state.
    pub fn state(&self, name: &str) -> usize {
        let index = self.bench.interface.states.iter().position(|state| state.name == name);
        index.unwrap_or_else(|| panic!("no state {name} in {:?}", self.bench.interface.states))
    }

    /// Integrates with steps of `h` to time `end`.
    pub fn run_to(&mut self, end: f64, h: f64) -> &mut Self {
        let duration = end - self.bench.t;
        self.bench.integrate(duration, (duration / h).round() as usize);
        self
    }

    /// The inputs that an output reads at the same instant.
    pub fn read_by(&self, name: &str) -> Vec<String> {
        let interface = &self.bench.interface;
        let group = interface.group_of[self.output(name)];
        let names = interface.inputs.iter().enumerate().filter(|(i, _)| interface.reads(group, *i));
        names.map(|(_, input)| input.name.clone()).collect()
    }
}

/// Asserts that two numbers agree up to an absolute tolerance.
#[track_caller]
pub fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} != {expected} (tolerance {tolerance})");
}
