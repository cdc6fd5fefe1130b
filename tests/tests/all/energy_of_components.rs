//! Every physical block balances its energy: what it takes in at its ports and what it supplies is stored or becomes
//! heat. At random states, speeds and voltages; the change of what is stored comes from differences along the
//! derivatives of the states, all else from the laws.

use std::sync::Arc;

use blocksim_block::physical::{
    Characteristics, Element, ElementPlace, Energy, Fed, Flowing, FrameMotion, Freedom, JointMotion, Known,
    Moving, Part, Reading, Supply, Torque, Wrench,
};
use blocksim_block::{Block, Given, kinds};
use blocksim_blocks as _;
use blocksim_diagram::example_block;

/// Texts beside the examples: parameters that open another branch of a law.
const MORE: [&str; 42] = [
    r#"Accumulator(volume: 3.0, precharge: 2.0, r: 1.5)"#,
    r#"DcMotor(r: 1.5, l: 2.5e-3, k: 0.22, j: 5e-5, damping: 1e-4, heat_port: true, alpha: 1e-3)"#,
    r#"HydraulicCylinder(area_a: 2.0, area_b: 1.2, stroke: 1.0, bulk_modulus: 3.0, damping: 0.1, stop_stiffness: 5.0, stop_damping: 1.0, stop_transition: 0.3)"#,
    r#"HydraulicPipe(length: 2.0, diameter: 0.5, bulk_modulus: 3.0, density: 1.0, viscosity: 1e-5)"#,
    r#"Resistor(r: 2.0, heat_port: true, alpha: 1e-3)"#,
    r#"DcMotor(r: 1.5, l: 0.0, k: 0.22, j: 5e-5, damping: 1e-4)"#,
    r#"DcMotor(r: 1.5, l: 2.5e-3, k: 0.22, j: 5e-5, damping: 1e-4)"#,
    r#"UniversalMotor(r: 4.0, l: 0.04, l_af: 0.15, j: 1e-3, damping: 1e-3)"#,
    r#"WoundFieldDcMotor(r: 0.6, l: 0.012, r_f: 240.0, l_f: 120.0, l_af: 1.8, j: 1.0, damping: 0.01)"#,
    r#"PermanentMagnetMachine(pole_pairs: 4, r_s: 0.5, l_d: 2e-3, l_q: 5e-3, flux: 0.1)"#,
    r#"StepperMotor(teeth: 3, r: 1.2, l: 0.024, k: 0.7, j: 1e-3, detent: 0.1, damping: 0.02, g_m: 0.3)"#,
    r#"StepperMotor(teeth: 3, r: 1.2, l: 0.0, k: 0.7, j: 1e-3, detent: 0.1, damping: 0.02, g_m: 0.3)"#,
    r#"MutualInductance(l1: 0.01, l2: 0.04, k: 0.9)"#,
    r#"ThreePhaseRlc(r: 1.0, l: 0.01, c: 1e-3)"#,
    r#"ThreePhaseRlc(c: 1e-3)"#,
    r#"DcLink(c: 1e-3, r: 0.1)"#,
    r#"RotationalSpringDamper(k: 300.0, d: 2.0, backlash: 0.6)"#,
    r#"RotationalSpringDamper(k: 300.0, d: 2.0, backlash: 0.6, transition: 0.5)"#,
    r#"TranslationalSpringDamper(k: 300.0, d: 20.0, backlash: 0.6, transition: 0.5)"#,
    r#"ElasticGear(ratio: 50.0, k: 1e4, d: 10.0, backlash: 0.3, transition: 0.4)"#,
    r#"RotationalHardStop(lower: -0.3, upper: 0.2, stiffness: 500.0, damping: 30.0, transition: 0.3)"#,
    r#"TranslationalHardStop(lower: -0.3, upper: 0.2, stiffness: 500.0, damping: 30.0, transition: 0.0)"#,
    r#"LuGreFriction(coulomb: 1.0, breakaway: 1.5, stribeck_velocity: 0.2, viscous: 0.3, sigma0: 2.0, sigma1: 0.7)"#,
    r#"RotationalFriction(breakaway: 3.0, breakaway_velocity: 0.2, coulomb: 2.0, viscous: 0.1)"#,
    r#"TranslationalFriction(breakaway: 3.0, breakaway_velocity: 0.2, coulomb: 2.0, viscous: 0.1)"#,
    r#"OneWayClutch(d: 5.0, transition: 0.3, model: Smooth)"#,
    r#"RevoluteJoint(equilibrium: 0.1, stiffness: 30.0, damping: 2.0, lower: -0.2, upper: 0.3, limit_transition: 0.4)"#,
    r#"PrismaticJoint(equilibrium: 0.1, stiffness: 30.0, damping: 2.0, lower: -0.2, upper: 0.3, limit_transition: 0.0)"#,
    r#"CylindricalJoint(slide_stiffness: 10.0, slide_damping: 2.0, turn_stiffness: 5.0, turn_damping: 1.0)"#,
    r#"PlanarJoint(slide_stiffness: 10.0, slide_damping: 2.0, turn_stiffness: 5.0, turn_damping: 1.0)"#,
    r#"UniversalJoint(stiffness: 10.0, damping: 2.0)"#,
    r#"SphericalJoint(stiffness: 10.0, damping: 2.0)"#,
    r#"FrameSpringDamper(stiffness: 100.0, damping: 10.0, length: 0.5)"#,
    r#"PointPlaneContact(stiffness: 1e3, damping: 30.0, transition: 0.5, friction: 0.4, threshold: 0.5)"#,
    r#"ExternalForce(axes: Frame)"#,
    r#"Clutch(torque: 20.0, threshold: 0.5, model: Smooth)"#,
    r#"Brake(torque: 20.0, threshold: 0.5, model: Smooth)"#,
    r#"AsynchronousMachine(rated_power: "15 kW", rated_voltage: "220 V", rated_frequency: "60 Hz", pole_pairs: 2, r_s: "0.25 ohm", x_ls: "0.9 ohm", r_r: "0.14 ohm", x_lr: "0.41 ohm", x_m: "17 ohm", connection: Delta)"#,
    r#"AsynchronousMachine(rated_power: "15 kW", rated_voltage: "220 V", rated_frequency: "60 Hz", pole_pairs: 2, r_s: "0.25 ohm", x_ls: "0.9 ohm", r_r: "0.14 ohm", x_lr: "0.41 ohm", x_m: "17 ohm", x_0: "0.5 ohm", connection: Open)"#,
    r#"AsynchronousMachine(rated_power: "15 kW", rated_voltage: "220 V", rated_frequency: "60 Hz", pole_pairs: 2, r_s: "0.25 ohm", x_ls: "0.9 ohm", r_r: "0.14 ohm", x_lr: "0.41 ohm", saturation: Table(current: ["0 A", "8 A", "20 A", "60 A"], voltage: ["0 V", "120 V", "220 V", "280 V"]))"#,
    r#"AsynchronousMachine(rated_power: "15 kW", rated_voltage: "220 V", rated_frequency: "60 Hz", pole_pairs: 2, r_s: "0.25 ohm", x_ls: "0 ohm", r_r: "0.14 ohm", x_lr: "0.41 ohm", saturation: Table(current: ["0 A", "8 A", "20 A", "60 A"], voltage: ["0 V", "120 V", "220 V", "280 V"]), connection: Delta)"#,
    r#"AsynchronousMachine(rated_power: "15 kW", rated_voltage: "220 V", rated_frequency: "60 Hz", pole_pairs: 2, r_s: "0.25 ohm", x_ls: "0.9 ohm", r_r: "0.14 ohm", x_lr: "0.41 ohm", cage: Double(r_r2: "0.5 ohm", x_lr2: "0.2 ohm", x_lr12: "0.1 ohm"), connection: Open, x_0: "0.4 ohm", saturation: Table(current: ["0 A", "8 A", "20 A", "60 A"], voltage: ["0 V", "120 V", "220 V", "280 V"]))"#,
];

/// Kinds whose examples are looked at otherwise. The numbers of the hydraulic ones are so many orders apart that differences say nothing:
/// they stand above with numbers of order one. What a winding takes in at its coil becomes flux that changes, which no two-pin shows
/// at one instant: accounts of whole magnetic circuits look at it.
const OTHERWISE: [&str; 4] = ["Accumulator", "HydraulicCylinder", "HydraulicPipe", "MagneticWinding"];

/// Numbers in -1..1 that look random (splitmix64).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        2.0 * ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64 - 1.0
    }

    fn list(&mut self, count: usize) -> Vec<f64> {
        (0..count).map(|_| self.next()).collect()
    }

    fn three(&mut self) -> [f64; 3] {
        [0; 3].map(|_| self.next())
    }

    fn quaternion(&mut self) -> [f64; 4] {
        let p = [0; 4].map(|_| self.next());
        let length = p.iter().map(|e| e * e).sum::<f64>().sqrt();
        p.map(|e| e / length)
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The product of two quaternions (w, x, y, z).
fn product(a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
    [
        a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],
        a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],
        a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],
        a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0],
    ]
}

/// The quaternion of a rotation vector, rad.
fn turn(v: [f64; 3]) -> [f64; 4] {
    let angle = dot(v, v).sqrt();
    let scale = if angle > 0.0 { (0.5 * angle).sin() / angle } else { 0.5 };
    [(0.5 * angle).cos(), scale * v[0], scale * v[1], scale * v[2]]
}

/// Rotation matrix of a unit quaternion, by rows.
fn matrix([w, x, y, z]: [f64; 4]) -> [[f64; 3]; 3] {
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
}

fn has_speed(element: &Element) -> bool {
    matches!(
        element,
        Element::Branch { .. }
            | Element::Friction { .. }
            | Element::Rigid { .. }
            | Element::SpeedSource { .. }
            | Element::SpeedProbe { .. }
    )
}

/// A block at one point, and all that its law is told there.
struct Point {
    block: Arc<dyn Block>,
    elements: Vec<Element>,
    part: Part,
    /// Whether what flows through an element at its across quantity is power.
    is_power: Vec<bool>,
    places: Vec<ElementPlace>,
    t: f64,
    x: Vec<f64>,
    d: Vec<f64>,
    u: Vec<f64>,
    inputs: Vec<(u32, u32)>,
    speed: Vec<f64>,
    mode: Vec<f64>,
    voltage: Vec<f64>,
    current: Vec<f64>,
    supply: Supply,
    line_current: [f64; 3],
    joint: Vec<JointMotion>,
    orientation: [f64; 4],
    frames: Vec<FrameMotion>,
    turned: Vec<[f64; 4]>,
}

impl Point {
    fn random(block: &Arc<dyn Block>, random: &mut Random) -> Self {
        let component = block.component().expect("a component");
        let part = component.part(&Given::nothing());
        let mut inputs = Vec::new();
        let mut cells = 0;
        for input in &part.inputs {
            let length = input.shape.map_or(1, |shape| shape.len());
            inputs.push((cells as u32, (cells + length) as u32));
            cells += length;
        }
        let is_power = part.elements.iter().map(|e| part.domain_of(e).carries_power()).collect();
        let is_law = |e: &&Element| matches!(e, Element::Characteristic { .. });
        let place = |(handle, index): &(_, usize)| ElementPlace {
            handle: *handle,
            two_pin: part.elements[..*index].iter().map(Element::two_pins).sum(),
            characteristic: is_law(&&part.elements[*index])
                .then(|| part.elements[..*index].iter().filter(is_law).count()),
        };
        let places = part.handles.iter().map(place).collect();
        let elements = part.elements.clone();
        let pins = elements.iter().filter(|e| has_speed(e)).count();
        let frames =
            elements.iter().filter(|e| matches!(e, Element::FrameForce { .. } | Element::FrameProbe { .. }));
        let turned: Vec<[f64; 4]> = frames.map(|_| random.quaternion()).collect();
        let mut joint = Vec::new();
        for element in &elements {
            let Element::Joint { freedoms, .. } = element else { continue };
            for freedom in freedoms {
                for _ in 0..freedom.speeds() {
                    let ball = matches!(freedom, Freedom::Ball { .. });
                    let q = if ball { 0.0 } else { random.next() };
                    joint.push(JointMotion { q, w: random.next() });
                }
            }
        }
        let mut point = Self {
            block: block.clone(),
            t: random.next().abs(),
            x: random.list(part.states.len()),
            d: part.discrete.iter().map(|memory| memory.initial).collect(),
            u: random.list(cells),
            inputs,
            speed: random.list(pins),
            mode: vec![1.0; pins],
            voltage: random.list(elements.iter().map(Element::two_pins).sum()),
            current: random.list(elements.iter().map(Element::two_pins).sum()),
            supply: Supply {
                voltage: [random.next(), random.next()],
                zero: random.next(),
                frequency: random.next(),
                angle: random.next(),
                ..Supply::NONE
            },
            line_current: [0.0; 3],
            joint,
            orientation: random.quaternion(),
            frames: turned
                .iter()
                .map(|p| FrameMotion {
                    rotation: matrix(*p),
                    position: random.three(),
                    angular: random.three(),
                    velocity: random.three(),
                })
                .collect(),
            turned,
            elements,
            part,
            is_power,
            places,
        };
        point.electrics();
        if point.part.discrete.iter().any(|state| state.changes.is_some()) {
            // Modes fit the states.
            let (mut x, mut d) = (point.x.clone(), point.d.clone());
            block.component().expect("a component").jump(&point.law(), &mut x, &mut d);
            point.d = d;
        }
        point
    }

    fn law(&self) -> Flowing<'_> {
        let known = Known { t: self.t, x: &self.x, d: &self.d, u: &self.u, inputs: &self.inputs };
        let moving = Moving {
            known,
            speed: &self.speed,
            mode: &self.mode,
            joint: &self.joint,
            orientation: &self.orientation,
            frames: &self.frames,
        };
        Flowing {
            fed: Fed { moving, supply: &self.supply },
            voltage: &self.voltage,
            current: &self.current,
            places: &self.places,
            line_current: &self.line_current,
        }
    }

    /// Voltages and currents that the component gives.
    fn electrics(&mut self) {
        let is_source =
            |e: &Element| matches!(e, Element::VoltageSource { .. } | Element::Capacitance { .. });
        let is_winding = |e: &Element| matches!(e, Element::Winding { .. } | Element::CurrentSource { .. });
        let block = self.block.clone();
        let component = block.component().expect("a component");
        let count = |which: &dyn Fn(&Element) -> bool| self.elements.iter().filter(|e| which(e)).count();
        let (mut v, mut i) = (vec![0.0; count(&is_source)], vec![0.0; count(&is_winding)]);
        // A network asks for what there is.
        let part = &self.part;
        for reading in part.readings.iter().flatten() {
            let is_there = match reading {
                Reading::Voltage(handle) | Reading::Current(handle) => {
                    part.handles.iter().any(|(name, _)| name == handle)
                }
                Reading::State(i) => *i < part.states.len(),
                _ => true,
            };
            assert!(is_there, "{reading:?} is of nothing");
        }
        for (given, count) in [(&part.voltages, v.len()), (&part.currents, i.len())] {
            assert!(given.is_empty() || given.len() == count, "all of them or none: {given:?} of {count}");
        }
        if !v.is_empty() {
            part.write_voltages(component, &self.law(), &mut v);
        }
        if !i.is_empty() {
            part.write_currents(component, &self.law(), &mut i);
            if self.elements.iter().any(|e| matches!(e, Element::Winding { from_state: false, .. })) {
                component.currents_by_voltages(&self.law(), &mut i);
            }
        }
        let law = |e: &Element| matches!(e, Element::Characteristic { .. });
        let mut at = 0;
        let mut laws = Vec::new();
        for element in &self.elements {
            laws.extend(law(element).then_some(at));
            at += element.two_pins();
        }
        let across: Vec<f64> = laws.iter().map(|at| self.voltage[*at]).collect();
        let (mut through, mut slope) = (vec![0.0; laws.len()], vec![0.0; laws.len() * laws.len()]);
        let mut view = Characteristics::new(&self.places, &across, &mut through, &mut slope);
        component.characteristics(&self.law(), &mut view);
        laws.iter().zip(through).for_each(|(at, through)| self.current[*at] = through);
        self.line_current = component.line_current(&self.law());
        let (mut at, mut v, mut i) = (0, v.into_iter(), i.into_iter());
        for element in &self.elements {
            if is_source(element) {
                self.voltage[at] = v.next().expect("a voltage");
            } else if is_winding(element) {
                self.current[at] = i.next().expect("a current");
            }
            at += element.two_pins();
        }
    }

    /// Powers that come in where only the component knows what becomes of them.
    fn absorbed(&self) -> Vec<f64> {
        let component = self.block.component().expect("a component");
        let (law, mut powers) = (self.law(), Vec::new());
        let branches = self.elements.iter().filter(|e| matches!(e, Element::Branch { .. })).count();
        let mut tau = vec![Torque::default(); branches];
        if !tau.is_empty() {
            component.torques(&law, &mut tau);
        }
        let (mut branch, mut pin, mut two_pin) = (tau.into_iter(), 0, 0);
        for (element, is_power) in self.elements.iter().zip(&self.is_power) {
            if matches!(element, Element::Characteristic { .. }) && *is_power {
                powers.push(self.voltage[two_pin] * self.current[two_pin]);
            }
            if matches!(element, Element::Branch { .. }) {
                powers.push(branch.next().expect("a torque").value * self.speed[pin]);
            }
            if matches!(element, Element::Winding { .. } | Element::Capacitance { .. }) && *is_power {
                powers.push(self.voltage[two_pin] * self.current[two_pin]);
            }
            if matches!(element, Element::Machine { .. }) {
                let ([v_d, v_q], [i_d, i_q, i_0]) = (self.supply.voltage, self.line_current);
                powers.extend([1.5 * v_d * i_d, 1.5 * v_q * i_q, 3.0 * self.supply.zero * i_0]);
            }
            pin += usize::from(has_speed(element));
            two_pin += element.two_pins();
        }
        let mut tau = vec![Torque::default(); self.joint.len()];
        if !tau.is_empty() {
            component.joint_torques(&law, &mut tau);
        }
        powers.extend(tau.iter().zip(&self.joint).map(|(tau, joint)| -tau.value * joint.w));
        let mut wrenches = vec![Wrench::default(); self.frames.len()];
        if self.elements.iter().any(|e| matches!(e, Element::FrameForce { .. })) {
            component.wrenches(&law, &mut wrenches);
        }
        for (wrench, frame) in wrenches.iter().zip(&self.frames) {
            powers.push(-dot(wrench.force, frame.velocity));
            powers.push(-dot(wrench.torque, frame.angular));
        }
        powers
    }

    fn energy(&self) -> Energy {
        self.block.component().expect("a component").energy(&self.law())
    }

    /// Where everything that moves is after a time.
    fn later(&self, h: f64) -> Self {
        let mut dx = vec![0.0; self.x.len()];
        self.block.component().expect("a component").derivatives(&self.law(), &mut dx);
        let ball: Vec<f64> = {
            let kinds = self.elements.iter().flat_map(|element| match element {
                Element::Joint { freedoms, .. } => freedoms.clone(),
                _ => Vec::new(),
            });
            let mut first = 0;
            let mut found = Vec::new();
            for freedom in kinds {
                if matches!(freedom, Freedom::Ball { .. }) {
                    found = (0..3).map(|k| h * self.joint[first + k].w).collect();
                }
                first += freedom.speeds();
            }
            found
        };
        let orientation = match ball[..] {
            [x, y, z] => product(self.orientation, turn([x, y, z])),
            _ => self.orientation,
        };
        let joint = self.joint.iter().map(|joint| JointMotion { q: joint.q + h * joint.w, w: joint.w });
        let frames = self.frames.iter().zip(&self.turned).map(|(frame, p)| FrameMotion {
            rotation: matrix(product(turn(frame.angular.map(|w| h * w)), *p)),
            position: [0, 1, 2].map(|k| frame.position[k] + h * frame.velocity[k]),
            ..*frame
        });
        let turned = self.frames.iter().zip(&self.turned);
        Self {
            block: self.block.clone(),
            elements: self.elements.clone(),
            part: self.part.clone(),
            is_power: self.is_power.clone(),
            places: self.places.clone(),
            t: self.t + h,
            x: self.x.iter().zip(&dx).map(|(x, dx)| x + h * dx).collect(),
            d: self.d.clone(),
            u: self.u.clone(),
            inputs: self.inputs.clone(),
            speed: self.speed.clone(),
            mode: self.mode.clone(),
            voltage: self.voltage.clone(),
            current: self.current.clone(),
            supply: Supply {
                angle: self.supply.angle + std::f64::consts::TAU * self.supply.frequency * h,
                ..self.supply
            },
            line_current: self.line_current,
            joint: joint.collect(),
            orientation,
            frames: frames.collect(),
            turned: turned.map(|(frame, p)| product(turn(frame.angular.map(|w| h * w)), *p)).collect(),
        }
    }

    /// Change of what is stored, W, by differences of order four.
    fn storing(&self) -> f64 {
        let mut dx = vec![0.0; self.x.len()];
        self.block.component().expect("a component").derivatives(&self.law(), &mut dx);
        let fastest = dx.iter().fold(1.0_f64, |max, dx| max.max(dx.abs()));
        let h = 2e-5 / fastest;
        let stored = |k: f64| self.later(k * h).energy().stored;
        (8.0 * (stored(1.0) - stored(-1.0)) - (stored(2.0) - stored(-2.0))) / (12.0 * h)
    }

    /// How far the balance is off, relative to the largest power in it; and whether heat flows the wrong way.
    fn defect(&self) -> (f64, bool) {
        let (absorbed, energy, storing) = (self.absorbed(), self.energy(), self.storing());
        let scale = absorbed
            .iter()
            .chain([&energy.supplied, &energy.dissipated, &storing])
            .fold(1e-12_f64, |max, power| max.max(power.abs()));
        let off = absorbed.iter().sum::<f64>() + energy.supplied - energy.dissipated - storing;
        (off.abs() / scale, energy.dissipated < -1e-9 * scale)
    }
}

fn worst(text: &str, block: &Arc<dyn Block>) -> Option<String> {
    let mut random = Random(text.len() as u64);
    for trial in 0..200 {
        let point = Point::random(block, &mut random);
        let (off, cools) = point.defect();
        if off > 1e-6 || cools {
            return Some(format!(
                "{text}\n  point {trial}: off by {off:e} of the largest power; absorbed {:?}, {:?}, d(stored)/dt {}",
                point.absorbed(),
                point.energy(),
                point.storing()
            ));
        }
    }
    None
}

/// Categories of blocks that are parts of networks.
const PHYSICAL: [&str; 10] = [
    "Electrical",
    "Gears",
    "Hydraulic",
    "Machines",
    "Magnetic",
    "Multibody",
    "Power electronics",
    "Rotational",
    "Three-phase",
    "Translational",
];

#[test]
fn every_physical_block_balances_what_it_takes_in_stores_and_turns_into_heat() {
    let mut found = Vec::new();
    let mut physical = 0;
    let examples = kinds().into_iter().flat_map(|info| {
        let physical = PHYSICAL.contains(&info.category);
        let examples = if OTHERWISE.contains(&info.kind) { Vec::new() } else { info.examples() };
        examples.into_iter().map(move |text| (text, physical))
    });
    for (text, must) in examples.chain(MORE.map(|text| (text, true))) {
        let text = text.split_once("\": ").filter(|_| text.starts_with('"')).map_or(text, |(_, block)| block);
        let text = text.trim_end_matches(',');
        let block = example_block(text);
        assert!(block.is_some() || !must, "cannot be built: {text}");
        let Some(block) = block.filter(|block| block.component().is_some()) else { continue };
        physical += 1;
        found.extend(worst(text, &block));
    }
    assert!(physical > 100, "only {physical} physical blocks were looked at");
    assert!(found.is_empty(), "{} of {physical}:\n{}", found.len(), found.join("\n"));
}
