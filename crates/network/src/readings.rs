//! Outputs of members that are numbers of the network, and voltages and currents that they give as they find them: nobody is asked.

use blocksim_block::Context;
use blocksim_block::physical::{Flowing, Gives, Handle, Loaded, Moving, Needs, Reading};

use crate::network::Network;
use crate::seat::{MOTION, STATE, Seat};
use crate::work::Work;

/// An output of a member that is a number of the network.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Read {
    /// Its group.
    pub group: usize,
    /// Its place among the outputs of the member.
    pub place: usize,
    pub reading: Reading,
}

/// A number that is an output, and its place among all outputs.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shown {
    number: Number,
    y: usize,
}

/// Where a number lies that a member reads.
#[derive(Debug, Clone, Copy)]
enum Number {
    State(usize),
    Speed(usize),
    Acceleration(usize),
    Torque(usize),
    Mesh(usize),
    Voltage(usize),
    Current(usize),
    JointPosition(usize),
    JointSpeed(usize),
    JointAcceleration(usize),
    /// The member has no element of that name: a mistake in its part, which shall be heard of.
    Missing,
}

impl Number {
    /// Where a member finds what it reads.
    fn of(seat: &Seat, reading: Reading) -> Self {
        let of_element = |handle: Handle, number: fn(usize) -> Self| {
            let place = seat.places.iter().find(|place| place.handle == handle);
            place.map_or(Self::Missing, |place| number(seat.two_pins.start + place.two_pin))
        };
        match reading {
            Reading::State(i) => Self::State(seat.x.start + i),
            Reading::Speed(i) => Self::Speed(seat.pins.start + i),
            Reading::Acceleration(i) => Self::Acceleration(seat.pins.start + i),
            Reading::Torque(i) => Self::Torque(seat.pins.start + i),
            Reading::Mesh(i) => Self::Mesh(seat.gears.start + i),
            Reading::Voltage(handle) => of_element(handle, Self::Voltage),
            Reading::Current(handle) => of_element(handle, Self::Current),
            Reading::JointPosition(i) => Self::JointPosition(seat.joint.start + i),
            Reading::JointSpeed(i) => Self::JointSpeed(seat.joint.start + i),
            Reading::JointAcceleration(i) => Self::JointAcceleration(seat.joint.start + i),
        }
    }

    #[inline(always)]
    fn value(self, c: &Context, w: &Work) -> f64 {
        match self {
            Self::State(i) => c.x[i],
            Self::Speed(i) => w.pin_speed[i],
            Self::Acceleration(i) => w.pin_acceleration[i],
            Self::Torque(i) => w.pin_torque[i],
            Self::Mesh(i) => w.all_mesh[i],
            Self::Voltage(i) => w.voltage[i],
            Self::Current(i) => w.current[i],
            Self::JointPosition(i) => w.joint_motion[i].q,
            Self::JointSpeed(i) => w.joint_motion[i].w,
            Self::JointAcceleration(i) => w.joint_load[i].a,
            Self::Missing => f64::NAN,
        }
    }
}

impl Shown {
    /// The outputs of a group that are numbers of the network.
    pub(crate) fn of(seats: &[Seat], group: usize) -> Vec<Self> {
        let seats = seats.iter().filter(|seat| !seat.reads_by_itself());
        let shown = seats.flat_map(|seat| {
            let reads = seat.reads.iter().filter(|read| read.group == group);
            reads.map(|read| Self { number: Number::of(seat, read.reading), y: seat.y.start + read.place })
        });
        shown.collect()
    }
}

/// A voltage or a current that is a number already, and where that lies.
#[derive(Debug, Clone, Copy)]
enum Giver {
    State(usize),
    Input(usize),
}

/// The voltages and currents that a member gives as it finds them; none where it must be asked.
#[derive(Debug, Clone, Default)]
pub(crate) struct Givers {
    voltages: Vec<Giver>,
    currents: Vec<Giver>,
}

impl Givers {
    /// Those of a seat whose other values are final.
    pub(crate) fn of(seat: &Seat) -> Self {
        if seat.reads_by_itself() {
            return Self::default();
        }
        let giver = |gives: &Gives| match *gives {
            Gives::State(i) => Giver::State(seat.x.start + i),
            Gives::Input(port) => Giver::Input(seat.u.start + seat.inputs[port].0 as usize),
        };
        let part = &seat.member.part;
        Self {
            voltages: part.voltages.iter().map(giver).collect(),
            currents: part.currents.iter().map(giver).collect(),
        }
    }

    /// Writes the voltages, unless the member must be asked; returns whether it need not be.
    #[inline(always)]
    pub(crate) fn voltages(&self, c: &Context, to: &mut [f64]) -> bool {
        write(&self.voltages, c, to)
    }

    /// The same with the currents.
    #[inline(always)]
    pub(crate) fn currents(&self, c: &Context, to: &mut [f64]) -> bool {
        write(&self.currents, c, to)
    }
}

#[inline(always)]
fn write(givers: &[Giver], c: &Context, to: &mut [f64]) -> bool {
    for (to, giver) in to.iter_mut().zip(givers) {
        *to = match *giver {
            Giver::State(i) => c.x[i],
            Giver::Input(i) => c.u[i],
        };
    }
    !givers.is_empty()
}

impl Seat {
    /// It has other numbers than those of the network at that time: means over a step, or states that sources add to.
    pub(crate) fn reads_by_itself(&self) -> bool {
        self.held.is_some() || self.shifted.is_some()
    }

    /// Whether anybody must be asked for outputs of a group.
    pub(crate) fn is_asked(&self, group: usize) -> bool {
        !self.measures[group].is_empty()
            || self.reads_by_itself() && self.reads.iter().any(|read| read.group == group)
    }

    /// Writes outputs of a group when only states and speeds are known.
    fn measure_moving(&self, c: &Moving, group: usize, y: &mut [f64]) {
        if let (true, Some(component)) = (self.measures[group].contains(&Needs::State), self.component()) {
            component.measure_state(c, y);
        }
        self.read(group, |reading| reading.of_state(c), y);
    }

    /// The same when voltages and currents are known.
    pub(crate) fn measure_flowing(&self, c: &Flowing, group: usize, y: &mut [f64]) {
        if let (true, Some(component)) = (self.measures[group].contains(&Needs::Electrics), self.component())
        {
            component.measure_electrics(c, y);
        }
        self.measure_moving(c, group, y);
        self.read(group, |reading| reading.of_electrics(c), y);
    }

    /// The same when all is known.
    fn measure_loaded(&self, c: &Loaded, group: usize, y: &mut [f64]) {
        if let (true, Some(component)) = (self.measures[group].contains(&Needs::Motion), self.component()) {
            component.measure_motion(c, y);
        }
        self.measure_flowing(c, group, y);
        self.read(group, |reading| reading.of_motion(c), y);
    }

    /// Writes the outputs of a group that are numbers of the network, if the member reads them by itself.
    fn read(&self, group: usize, value: impl Fn(Reading) -> f64, y: &mut [f64]) {
        if self.reads_by_itself() {
            for read in self.reads.iter().filter(|read| read.group == group) {
                y[read.place] = value(read.reading);
            }
        }
    }
}

impl Network {
    /// Lets a member write outputs of a group, with what is known when that group is evaluated.
    #[inline]
    pub(crate) fn measure(&self, c: &Context, seat: &Seat, group: usize, w: &Work, y: &mut [f64]) {
        match group {
            STATE => seat.measure_moving(&self.moving_law(c, seat, w), group, y),
            MOTION => seat.measure_loaded(&self.loaded_law(c, seat, w), group, y),
            _ => seat.measure_flowing(&self.flowing_law(c, seat, w), group, y),
        }
    }

    /// Writes the outputs of a group that are numbers of the network.
    #[inline]
    pub(crate) fn show(&self, group: usize, c: &Context, w: &Work, y: &mut [f64]) {
        for shown in &self.active.shown[group] {
            y[shown.y] = shown.number.value(c, w);
        }
    }
}
