//! Parameters and ports.

use blocksim_controller::prelude::*;

/// Most links that an arm can have here.
const MOST: usize = 6;
/// Numbers of a link.
const LINK: usize = 16;
/// Parameters of a link.
const OF_LINK: usize = 6;
/// Parameters behind those of the links.
const BEHIND: usize = 22;

/// The parameters of a link and of the joint before it.
#[derive(Debug, Clone, Copy)]
pub struct Link {
    pub origin: Parameter,
    pub axis: Parameter,
    pub mass: Parameter,
    pub com: Parameter,
    pub moi: Parameter,
    pub poi: Parameter,
}

macro_rules! link {
    ($i:literal) => {
        Link {
            origin: Parameter::vector(
                LINK * ($i - 1),
                3,
                concat!("origin", $i),
                "m",
                "Joint on the link before.",
            ),
            axis: Parameter::vector(
                LINK * ($i - 1) + 3,
                3,
                concat!("axis", $i),
                "1",
                "Direction of the joint.",
            ),
            mass: Parameter::new(LINK * ($i - 1) + 6, concat!("mass", $i), "kg", "Mass of the link."),
            com: Parameter::vector(
                LINK * ($i - 1) + 7,
                3,
                concat!("com", $i),
                "m",
                "Its centre, from the joint.",
            ),
            moi: Parameter::vector(
                LINK * ($i - 1) + 10,
                3,
                concat!("moi", $i),
                "kg*m^2",
                "Ixx, Iyy, Izz about it.",
            ),
            poi: Parameter::vector(
                LINK * ($i - 1) + 13,
                3,
                concat!("poi", $i),
                "kg*m^2",
                "Iyz, Izx, Ixy about it.",
            )
            .or(&[0.0; 3]),
        }
    };
}

/// Links from the base on.
pub const LINKS: [Link; MOST] = [link!(1), link!(2), link!(3), link!(4), link!(5), link!(6)];

/// Numbers behind those of `n` links: the tool, what all joints share, what the tool carries.
#[derive(Debug, Clone, Copy)]
pub struct Rest {
    pub tool_at: Parameter,
    pub tool_rpy: Parameter,
    pub tool_mass: Parameter,
    pub tool_com: Parameter,
    pub tool_moi: Parameter,
    pub tool_poi: Parameter,
    pub gravity: Parameter,
    pub threshold: Parameter,
    pub ts: Parameter,
    pub ratio: Parameter,
    pub inertia: Parameter,
    pub damping: Parameter,
    pub forward: Parameter,
    pub backward: Parameter,
    pub breakaway: Parameter,
    pub breakaway_velocity: Parameter,
    pub coulomb: Parameter,
    pub viscous: Parameter,
    pub load_mass: Parameter,
    pub load_com: Parameter,
    pub load_moi: Parameter,
    pub load_poi: Parameter,
}

/// One number of each joint.
const ONES: [f64; MOST] = [1.0; MOST];
const ZEROS: [f64; MOST] = [0.0; MOST];
const ONES_OF: &[f64; MOST] = &ONES;
const ZEROS_OF: &[f64; MOST] = &ZEROS;

/// The parameters behind the links of an arm with `n` joints.
pub const fn rest(n: usize) -> Rest {
    let at = LINK * n;
    let joints = at + 21;
    let load = joints + 9 * n;
    let (ones, zeros) = (ONES_OF.split_at(n).0, ZEROS_OF.split_at(n).0);
    Rest {
        tool_at: Parameter::vector(at, 3, "tool_at", "m", "Frame of the tool on the last link.")
            .or(&[0.0; 3]),
        tool_rpy: Parameter::vector(at + 3, 3, "tool_rpy", "rad", "Its roll, pitch and yaw.").or(&[0.0; 3]),
        tool_mass: Parameter::new(at + 6, "tool_mass", "kg", "Mass of the tool.").or(&[0.0]),
        tool_com: Parameter::vector(at + 7, 3, "tool_com", "m", "Its centre, in its frame.").or(&[0.0; 3]),
        tool_moi: Parameter::vector(at + 10, 3, "tool_moi", "kg*m^2", "Ixx, Iyy, Izz about it.")
            .or(&[0.0; 3]),
        tool_poi: Parameter::vector(at + 13, 3, "tool_poi", "kg*m^2", "Iyz, Izx, Ixy about it.")
            .or(&[0.0; 3]),
        gravity: Parameter::vector(at + 16, 3, "gravity", "m/s^2", "Gravity in the frame of the base.")
            .or(&[0.0, 0.0, -9.80665]),
        threshold: Parameter::new(
            at + 19,
            "threshold",
            "rad/s",
            "Speed of a motor where its gear loses fully.",
        )
        .or(&[1.0]),
        ts: Parameter::new(at + 20, "ts", "s", "Sample time.").or(&[1e-3]),
        ratio: Parameter::vector(joints, n, "ratio", "1", "Turns of the motor for one of the joint.")
            .or(ones),
        inertia: Parameter::vector(joints + n, n, "inertia", "kg*m^2", "Rotor and gear, at the motor.")
            .or(zeros),
        damping: Parameter::vector(joints + 2 * n, n, "damping", "N*m*s/rad", "Of the motor.").or(zeros),
        forward: Parameter::vector(joints + 3 * n, n, "efficiency_forward", "1", "Gear, motor drives.")
            .or(ones),
        backward: Parameter::vector(joints + 4 * n, n, "efficiency_backward", "1", "Gear, joint drives.")
            .or(ones),
        breakaway: Parameter::vector(joints + 5 * n, n, "breakaway", "N*m", "Largest dry friction.")
            .or(zeros),
        breakaway_velocity: Parameter::vector(
            joints + 6 * n,
            n,
            "breakaway_velocity",
            "rad/s",
            "Speed of the joint where friction is largest.",
        )
        .or(ones),
        coulomb: Parameter::vector(joints + 7 * n, n, "coulomb", "N*m", "Dry friction in motion.").or(zeros),
        viscous: Parameter::vector(joints + 8 * n, n, "viscous", "N*m*s/rad", "Viscous friction.").or(zeros),
        load_mass: Parameter::new(load, "load_mass", "kg", "Mass of what the tool carries.").or(&[0.0]),
        load_com: Parameter::vector(load + 1, 3, "load_com", "m", "Its centre, in the frame of the tool.")
            .or(&[0.0; 3]),
        load_moi: Parameter::vector(load + 4, 3, "load_moi", "kg*m^2", "Ixx, Iyy, Izz about it.")
            .or(&[0.0; 3]),
        load_poi: Parameter::vector(load + 7, 3, "load_poi", "kg*m^2", "Iyz, Izx, Ixy about it.")
            .or(&[0.0; 3]),
    }
}

/// How many parameters an arm with `n` joints has.
pub const fn count(n: usize) -> usize {
    OF_LINK * n + BEHIND
}

/// All parameters of an arm with `n` joints in their order; only the first [`count`] count.
pub const fn all(n: usize) -> [Parameter; OF_LINK * MOST + BEHIND] {
    let r = rest(n);
    let mut list = [r.ts; OF_LINK * MOST + BEHIND];
    let mut i = 0;
    while i < n {
        let l = LINKS[i];
        let of_link = [l.origin, l.axis, l.mass, l.com, l.moi, l.poi];
        let mut k = 0;
        while k < OF_LINK {
            list[OF_LINK * i + k] = of_link[k];
            k += 1;
        }
        i += 1;
    }
    let behind = [
        r.tool_at,
        r.tool_rpy,
        r.tool_mass,
        r.tool_com,
        r.tool_moi,
        r.tool_poi,
        r.gravity,
        r.threshold,
        r.ts,
        r.ratio,
        r.inertia,
        r.damping,
        r.forward,
        r.backward,
        r.breakaway,
        r.breakaway_velocity,
        r.coulomb,
        r.viscous,
        r.load_mass,
        r.load_com,
        r.load_moi,
        r.load_poi,
    ];
    let mut k = 0;
    while k < behind.len() {
        list[OF_LINK * n + k] = behind[k];
        k += 1;
    }
    list
}
