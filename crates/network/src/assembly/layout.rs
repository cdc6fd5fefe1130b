//! Where the values of all members lie: states, discrete states, inputs, outputs, guards.

use std::sync::Arc;

use std::ops::Range;

use blocksim_block::event::{Change, Event, Subject};
use blocksim_block::physical::{Domain, Element, LossModel, Needs, Part, ValveKind};
use blocksim_block::{Crossing, Discrete, Guard, Input, Interface, JumpPhrase, Output, State};
use blocksim_multibody::Joint;
use blocksim_signal::Unit;

use crate::accounts::Accounts;
use crate::assembly::grids::Grid;
use crate::electrics::currents::UNTOLD;
use crate::electrics::inputs::InputCells;
use crate::electrics::{Branch, Capacitance, Electrics, Separate};
use crate::mechanics::envelope::Envelope;
use crate::mechanics::frames::{Frames, Loop};
use crate::mechanics::rotation::Rotation;
use crate::mechanics::scene;
use crate::mechanics::stiction::parts::Stiction;
use crate::member::Member;
use crate::network::Network;
use crate::problem::NetworkProblem;
use crate::readings::{Givers, Read};
use crate::seat::{Active, CHARGE, ELECTRICS, Held, MOTION, Role, STATE, Seat, Shares};

/// Counters of everything that members have a share of.
#[derive(Default)]
struct Next {
    x: usize,
    d: usize,
    u: usize,
    y: usize,
    g: usize,
    pins: usize,
    gears: usize,
    branches: usize,
    frictions: usize,
    dry: usize,
    speed_sources: usize,
}

fn take(next: &mut usize, count: usize) -> Range<usize> {
    let start = *next;
    *next += count;
    start..*next
}

impl Network {
    pub(crate) fn new(
        members: Vec<Member>,
        rotation: Rotation,
        mut electrics: Electrics,
        frames: Frames,
        fed_by: &[Option<usize>],
        grids: &[Option<Grid>],
    ) -> Result<Self, Vec<NetworkProblem>> {
        let (positions, joints) = (frames.position.len(), frames.speeds.len());
        let mut interface = Interface::new().implicit();
        // What has an end of travel does not go on for ever.
        let ends = |i: usize| {
            let of = frames.speeds.iter().filter(|speed| speed.position == Some(i));
            of.flat_map(|speed| members[speed.member].part.travel).any(|end| end.is_some())
        };
        for (i, (name, position)) in frames.position_names.iter().zip(&frames.position).enumerate() {
            interface = match ends(i) {
                true => interface.state(name.clone(), *position),
                false => interface.drifting_state(name.clone(), *position),
            };
        }
        if let Some(tree) = &frames.model {
            let turns = tree.bodies().filter(|body| matches!(tree.joint(*body), Joint::Revolute { .. }));
            interface.turning_states = turns.flat_map(|body| tree.positions(body)).collect();
        }
        for (name, start) in rotation.names.iter().zip(&rotation.start) {
            interface = interface.state(name.clone(), *start);
        }
        interface.kin = frames.loops.iter().map(|closing| kin(&frames, &rotation, closing)).collect();
        let mut separate = Separate::of(&electrics);
        for island in &mut separate {
            for name in [
                "begin",
                "end",
                "parts",
                "left",
                "until",
                "rtol",
                "need",
                "least",
                "lasting",
                "most",
                "span",
                "noted",
                "since",
                "cubes",
                "cut",
                "interrupted",
                "outlasts",
            ] {
                let start = interface.discrete.len();
                interface = interface.discrete(format!("{}.{name}", members[island.members[0]].path), 0.0);
                if name == "begin" {
                    island.times = start;
                }
            }
        }

        // Inputs of prescribed speeds and of electrical sources: what groups 0 and 1 read.
        let mut reads = [Vec::new(), Vec::new()];
        let mut next = Next { x: positions + rotation.free, d: interface.discrete.len(), ..Next::default() };
        let (supply_of, supplies) = supplies(&members, fed_by);
        let mut seats: Vec<Seat> = Vec::new();
        for (index, member) in members.into_iter().enumerate() {
            let places = &electrics.places[index];
            let held_by = separate.iter().position(|s| Some(s.island) == places.island);
            let part = &member.part;
            let count = |which: &dyn Fn(&Element) -> bool| part.elements.iter().filter(|e| which(e)).count();
            let branches = count(&|e| matches!(e, Element::Branch { .. }));
            let frictions = count(&|e| matches!(e, Element::Friction { .. }));
            let dry = count(
                &|e| matches!(e, Element::Gear { loss: Some(loss), .. } if loss.model == LossModel::Stiction),
            );
            let speed_sources = count(&|e| matches!(e, Element::SpeedSource { .. }));
            let looks = count(&|e| {
                matches!(
                    e,
                    Element::Rigid { .. } | Element::SpeedProbe { .. } | Element::AbsoluteSpeedProbe { .. }
                )
            });
            let gears = count(&|e| matches!(e, Element::Gear { .. }));
            let has = |which: &dyn Fn(&Element) -> bool| part.elements.iter().any(which);

            let prescribes_speed = speed_sources > 0;
            let drives_electrics = has(&|e| {
                matches!(
                    e,
                    Element::VoltageSource { .. }
                        | Element::CurrentSource { .. }
                        | Element::Supply { .. }
                        | Element::Valve { .. }
                        | Element::VariableTransformer { .. }
                        | Element::Characteristic { .. }
                )
            });
            let mut inputs = Vec::new();
            let mut cells = 0;
            let first_input = interface.inputs.len();
            let mut own_sources = next.speed_sources..next.speed_sources + speed_sources;
            let moves_masses = own_sources.any(|source| rotation.moves_masses(source));
            for (input, length) in part.inputs.iter().zip(&member.input_lengths) {
                inputs.push((cells as u32, (cells + length) as u32));
                cells += length;
                if prescribes_speed {
                    reads[STATE].push(interface.inputs.len());
                }
                if drives_electrics || prescribes_speed {
                    reads[ELECTRICS].push(interface.inputs.len());
                }
                if held_by.is_some() {
                    interface.notes.push(interface.inputs.len());
                }
                let name = format!("{}.{}", member.path, input.name);
                let rate_of = input.rate_of.filter(|_| moves_masses).map(|of| first_input + of);
                interface.inputs.push(Input { name, rate_of, ..input.clone() });
            }
            let (x, d, held) = match held_by {
                Some(by) => {
                    let sizes =
                        [branches, places.two_pins.len(), branches + frictions + speed_sources + looks];
                    hold(&mut interface, &mut next, &member, separate[by].times, sizes)
                }
                None => free(&mut interface, &mut next, &member),
            };
            if held.is_none() && is_shifted(&electrics, index) {
                // The states are not what they are in the law: sources add the rest.
                interface.states[x.clone()].iter_mut().for_each(|state| state.floor = None);
            }
            let early = held.is_none()
                && !places.two_pins.is_empty()
                && places.two_pins.clone().all(|i| electrics.early[i].is_some());
            let (measures, reads_numbers) = measures(
                &mut interface,
                &member,
                (!places.two_pins.is_empty(), is_shifted(&electrics, index)),
                early,
                reads_heat(&electrics, index),
            );
            let outputs = part.outputs.iter().map(|(o, _)| o.port_type.shape.len()).sum();
            let winding_pins = electrics.winding_pins(index);
            seats.push(Seat {
                x,
                d,
                held,
                u: take(&mut next.u, cells),
                inputs,
                y: take(&mut next.y, outputs),
                g: take(&mut next.g, if held_by.is_some() { 0 } else { part.guards.len() }),
                pins: take(&mut next.pins, branches + frictions + speed_sources + looks),
                gears: take(&mut next.gears, gears),
                branches: take(&mut next.branches, branches),
                frictions: take(&mut next.frictions, frictions),
                dry: take(&mut next.dry, dry),
                speed_sources: take(&mut next.speed_sources, speed_sources),
                two_pins: places.two_pins.clone(),
                sources: places.sources.clone(),
                windings: places.windings.clone(),
                valves: places.valves.clone(),
                places: places.named.clone(),
                dissipates: places.dissipates.clone(),
                winding_pins,
                joint: frames.user_range(index),
                ball: frames.balls.iter().position(|ball| ball.member == index),
                frames: frames.probe_range(index),
                supply: supply_of[index],
                grid: grids[index].and_then(|grid| Some((supply_of[grid.source]?, grid.exchanged))),
                shifted: None,
                role: role(&member, places.machine, fed_by[index].is_some()),
                is_capacitance: has(&|e| matches!(e, Element::Capacitance { .. })),
                is_early: early,
                measures,
                reads: reads_numbers,
                gives: Givers::default(),
                shares: Shares::default(),
                block: Arc::clone(&member.block),
                member: Box::new(member),
            });
        }
        let mut shifted = 0;
        for (index, seat) in seats.iter_mut().enumerate().filter(|(index, _)| is_shifted(&electrics, *index))
        {
            assert!(electrics.places[index].island.is_some());
            seat.shifted = Some(shifted);
            shifted += seat.x.len();
        }
        for seat in &mut seats {
            seat.shares = Shares::of(seat);
            seat.gives = Givers::of(seat);
        }
        let first_pose = next.y;
        for output in scene::outputs(&frames) {
            interface.outputs.push(output);
            interface.group_of.push(STATE);
        }
        interface.groups = vec![
            Some(reads[STATE].clone()),
            Some(reads[ELECTRICS].clone()),
            None,
            Some(reads[STATE].clone()),
        ];
        let stiction = Stiction::new(&seats, &rotation, &mut interface);
        let envelope = Envelope::of(&rotation, frames.model.is_some());
        let first_latch = interface.discrete.len();
        let first_natural = interface.guards.len();
        let natural = electrics.natural();
        // Where the network integrates by itself, valves change between the instants that anybody sees.
        let of_solver: Vec<usize> =
            with_valves(&electrics).into_iter().flat_map(|i| electrics.islands[i].valves.clone()).collect();
        for (index, valve) in electrics.valves.iter().enumerate() {
            let subject = of_valve(&electrics.valves, &seats, index);
            let path = &seats[valve.member].member.path;
            let words = if valve.kind == ValveKind::Switch { SWITCH } else { VALVE };
            let mode = Discrete::new(format!("{path}.conducts"), 0.0);
            let is_seen = of_solver.contains(&index);
            interface.discrete.push(if is_seen { mode.changes(words, subject) } else { mode });
        }
        // Gates are held from jump to jump, so that an instant is whole before and after it.
        let mut gate_cells = vec![None; electrics.valves.len()];
        for valve in of_solver {
            if electrics.valves[valve].kind != ValveKind::Diode {
                gate_cells[valve] = Some(interface.discrete.len());
                let path = &seats[electrics.valves[valve].member].member.path;
                interface = interface.discrete(format!("{path}.gate"), UNTOLD);
            }
        }
        for valve in &natural {
            let path = &seats[electrics.valves[*valve].member].member.path;
            let guard = Guard::new(format!("{path}.conducts"), Crossing::Holds);
            let subject = of_valve(&electrics.valves, &seats, *valve);
            interface.guards.push(Guard { event: Event::Mode, subject, ..guard });
        }
        for island in with_valves(&electrics) {
            let path = seats[electrics.islands[island].members[0]].member.path.clone();
            electrics.islands[island].size = Some(interface.discrete.len());
            for what in ["voltage", "current"] {
                interface = interface.discrete(format!("{path}.most_{what}"), 0.0);
            }
        }
        for capacitance in jumping(&electrics) {
            let subject = of_capacitance(&electrics, &seats, capacitance);
            let path = &seats[electrics.capacitances[capacitance].member].member.path;
            let name = format!("{path}.jumps");
            electrics.capacitances[capacitance].jumps = Some(interface.discrete.len());
            interface.discrete.push(Discrete::jumps(name, subject, "V"));
        }
        for island in electrics.islands.iter().filter(|island| island.separate.is_none()) {
            for (position, number) in &island.characteristics {
                let path = &seats[island.two_pins[*position].member].member.path;
                electrics.characteristics[*number].guess = Some(interface.discrete.len());
                let first = electrics.characteristics[*number].first_guess;
                interface = interface.discrete(format!("{path}.guess{number}"), first);
            }
        }
        if !natural.is_empty() {
            let steps = seats.iter().filter_map(|seat| seat.member.part.max_step);
            interface.max_step = steps.reduce(f64::min);
        }
        interface.uses_time = seats.iter().any(|seat| seat.member.part.uses_time);
        interface.jumps |= !with_valves(&electrics).is_empty();
        interface.jumps |= electrics.characteristics.iter().any(|c| c.guess.is_some());
        if let Some(step) = separate.iter().map(|s| s.step).reduce(f64::min) {
            // Torques follow a line within a coupling step or a part of it, though nothing else may move.
            interface = interface.sampled(step).subdivides().uses_time();
        }
        let accounts = Accounts::new(&seats, frames.payloads.len(), &mut interface);
        let seeks = interface.discrete.len();
        interface = interface.discrete("seeks", 0.0);
        let mut network = Self {
            active: Active { valves: with_valves(&electrics), ..Active::new(&seats, &electrics) },
            has_early: seats.iter().any(|seat| seat.is_early),
            meshes: rotation.gears.iter().map(|gear| gear.loss).collect(),
            seats,
            rotation,
            stiction,
            envelope,
            electrics,
            frames,
            supplies,
            interface,
            positions,
            first_pose,
            joints,
            first_latch,
            gate_cells,
            natural,
            first_natural,
            separate,
            accounts,
            seeks,
            moved: Vec::new(),
        };
        network.interface.jumps |= network.loops_meet_sources();
        if network.interface.discrete.iter().any(|state| state.changes.is_some()) {
            network.interface.jump_phrase = JumpPhrase("");
        }
        network.mass_matrix_is_definite()?;
        network.fit_currents()?;
        network.fit_voltages()?;
        Ok(network)
    }
}

/// What a contact is called when it changes, and what a valve.
const SWITCH: &[Change] = &[Change::to(1.0, "closes"), Change::to(0.0, "opens")];
const VALVE: &[Change] = &[Change::to(1.0, "conducts"), Change::to(0.0, "blocks")];

/// The part of a valve, and which of several there it is, in the order of its elements.
fn of_valve(valves: &[crate::electrics::Valve], seats: &[Seat], valve: usize) -> Subject {
    let member = valves[valve].member;
    let is_beside = |other: &&crate::electrics::Valve| other.member == member;
    let several = valves.iter().filter(is_beside).count() > 1;
    let number = valves[..=valve].iter().filter(is_beside).count();
    let detail = several.then(|| format!("valve {number}"));
    Subject { part: Some(seats[member].member.path.clone()), detail }
}

/// The capacitance in a member, and which of several there it is.
fn of_capacitance(electrics: &Electrics, seats: &[Seat], capacitance: usize) -> Subject {
    let member = electrics.capacitances[capacitance].member;
    let beside = |all: &[Capacitance]| all.iter().filter(|other| other.member == member).count();
    let detail = (beside(&electrics.capacitances) > 1)
        .then(|| format!("capacitor {}", beside(&electrics.capacitances[..=capacitance])));
    Subject { part: Some(seats[member].member.path.clone()), detail }
}

/// Capacitances of the circuits in which valves may close loops of them.
fn jumping(electrics: &Electrics) -> Vec<usize> {
    let islands = electrics.islands.iter().filter(|island| island.divides && island.separate.is_none());
    let sources = islands.flat_map(|island| &island.two_pins).filter_map(|pin| match pin.branch {
        Branch::Source(index) => Some(index),
        _ => None,
    });
    let places = sources.filter_map(|index| electrics.capacitances.iter().position(|c| c.source == index));
    places.collect()
}

/// Whether sources add to the voltage of a capacitance of a member, or to its currents.
fn is_shifted(electrics: &Electrics, member: usize) -> bool {
    let island = electrics.places[member].island.map(|island| &electrics.islands[island]);
    island.is_some_and(|island| {
        island.in_cuts.contains(&member) || island.shifts.iter().any(|shift| shift.member == member)
    })
}

/// Circuits with valves that the solver integrates.
fn with_valves(electrics: &Electrics) -> Vec<usize> {
    let islands = electrics.islands.iter().enumerate();
    islands.filter(|(_, i)| !i.valves.is_empty() && i.separate.is_none()).map(|(i, _)| i).collect()
}

/// Whether what a member reads in a thermal network changes with heat, which is known after torques.
fn reads_heat(electrics: &Electrics, member: usize) -> bool {
    let island = electrics.places[member].island.map(|island| &electrics.islands[island]);
    island.filter(|island| !island.heats.is_empty()).is_some_and(|island| {
        island.two_pins.iter().any(|pin| {
            pin.member == member
                && pin.domain == Domain::Thermal
                && matches!(pin.branch, Branch::Source(_) | Branch::Wire)
        })
    })
}

/// Where the supply of each member lies, if it has one, and how many there are.
fn supplies(members: &[Member], fed_by: &[Option<usize>]) -> (Vec<Option<usize>>, usize) {
    let mut own = vec![None; members.len()];
    let mut supplies = 0;
    for (index, member) in members.iter().enumerate() {
        let three_phase = |e: &Element| matches!(e, Element::Supply { .. } | Element::Machine { .. });
        let is_source = fed_by[index].is_none_or(|source| source == index);
        if is_source && member.part.elements.iter().any(three_phase) {
            own[index] = Some(supplies);
            supplies += 1;
        }
    }
    let of = fed_by.iter().enumerate().map(|(index, source)| source.and_then(|s| own[s]).or(own[index]));
    (of.collect(), supplies)
}

/// The speeds of the joints of a closed loop, among the states.
fn kin(frames: &Frames, rotation: &Rotation, closing: &Loop) -> Vec<usize> {
    let members = frames.joints_between(closing);
    let is_inside = |member: usize| member == closing.member || members.contains(&member);
    let joints = frames.speeds.iter().zip(&rotation.joints).filter(|(speed, _)| is_inside(speed.member));
    let speeds = joints.flat_map(|(_, form)| form.terms().iter().map(|(k, _)| *k as usize));
    let mut kin: Vec<usize> = speeds.map(|k| frames.position.len() + k).collect();
    kin.sort_unstable();
    kin.dedup();
    kin
}

fn role(member: &Member, machine: Option<crate::electrics::Joined>, fed: bool) -> Role {
    if member.part.elements.iter().any(|e| matches!(e, Element::Supply { .. })) {
        Role::Source
    } else if let Some(joined) = machine {
        Role::Machine(joined)
    } else if fed {
        Role::Fed
    } else {
        Role::Other
    }
}

/// States of a member that the solver integrates.
fn free(
    interface: &mut Interface,
    next: &mut Next,
    member: &Member,
) -> (Range<usize>, Range<usize>, Option<Held>) {
    let part = &member.part;
    let first = interface.states.len();
    interface.drifting.extend(part.drifting.iter().map(|state| first + state));
    for state in &part.states {
        let name = format!("{}.{}", member.path, state.name);
        interface.states.push(State { name, ..state.clone() });
    }
    let of_member = |subject: &Subject| Subject { part: Some(member.path.clone()), ..subject.clone() };
    for memory in &part.discrete {
        let own = Discrete::new(format!("{}.{}", member.path, memory.name()), memory.initial);
        interface.discrete.push(match &memory.changes {
            Some(changes) => own.changes(changes.table, of_member(&changes.subject)),
            None => own,
        });
    }
    for guard in &part.guards {
        let name = format!("{}.{}", member.path, guard.name);
        let subject = of_member(&guard.subject);
        interface.guards.push(Guard { name, subject, ..guard.clone() });
    }
    interface.jumps |= part.jumps;
    interface.time_events |= part.time_events;
    (take(&mut next.x, part.states.len()), take(&mut next.d, part.discrete.len()), None)
}

/// States of a member that the network integrates by itself: all of them are discrete states, once as they are at the
/// beginning of a coupling step and once as they will be at its end; behind them the means of the step.
fn hold(
    interface: &mut Interface,
    next: &mut Next,
    member: &Member,
    times: usize,
    [branches, two_pins, pins]: [usize; 3],
) -> (Range<usize>, Range<usize>, Option<Held>) {
    let part = &member.part;
    let mut copy = |suffix: &str| {
        for state in &part.states {
            let name = format!("{}.{}{suffix}", member.path, state.name);
            *interface = std::mem::take(interface).discrete(name, state.initial);
        }
        for memory in &part.discrete {
            let name = format!("{}.{}{suffix}", member.path, memory.name());
            *interface = std::mem::take(interface).discrete(name, memory.initial);
        }
        (take(&mut next.d, part.states.len()), take(&mut next.d, part.discrete.len()))
    };
    let (x, d) = copy("");
    let (x_end, d_end) = copy("'");
    let mut cells = |what: &str, count: usize| {
        for k in 0..count {
            let name = format!("{}.{what}{k}", member.path);
            *interface = std::mem::take(interface).discrete(name, 0.0);
        }
        take(&mut next.d, count)
    };
    let torque = cells("torque", branches);
    let course = cells("course", branches);
    let mean = cells("mean", part.states.len() + 2 * two_pins + 3);
    let sum = cells("sum", mean.len());
    let sum_before = cells("sum_before", mean.len());
    let owed = cells("owed", branches);
    let given = cells("given", branches);
    let speed = cells("speed", pins);
    let acceleration = cells("acceleration", pins);
    let struck = cells("struck", pins);
    let expected = cells("expected", pins);
    let bent = cells("bent", pins);
    let bent_before = cells("bent_before", pins);
    let missed = cells("missed", 2).start;
    let errors = cells("error", 5 * pins);
    let inputs = cells("input", InputCells::COUNT * member.input_lengths.iter().sum::<usize>());
    let held = Held {
        times,
        x_end,
        d_end,
        torque,
        course,
        mean,
        instants: instants(part),
        sum,
        sum_before,
        owed,
        given,
        speed,
        acceleration,
        struck,
        expected,
        bent,
        bent_before,
        missed,
        errors,
        inputs,
    };
    (x, d, Some(held))
}

/// Cells of the outputs that say something at an instant of a circuit that switches: coils and inertia keep states, currents and fluxes going,
/// while voltages jump, and what is made of them.
fn instants(part: &Part) -> Vec<usize> {
    let through = ["A", "Wb", "T"].map(|unit| Unit::parse(unit).ok().map(|unit| unit.dimension));
    let mut cells = Vec::new();
    let mut next = 0;
    for (place, (output, needs)) in part.outputs.iter().enumerate() {
        let own = next..next + output.port_type.shape.len();
        next = own.end;
        let is_current =
            through.contains(&output.port_type.dimension) || part.currents_per_unit.contains(&place);
        if *needs == Needs::State || is_current {
            cells.extend(own);
        }
    }
    cells
}

/// Declares the outputs of a member; returns, for each group, the needs of the outputs that its component computes, and the
/// outputs that are numbers of the network. A sensor that
/// reads states alone closes no algebraic loop: `early`. Of what follows from states alone, that which nobody reads stands apart
/// from what is evaluated between major steps. What sources add to is not known before they are: `shifted`; nor is heat before
/// torques: `late`.
fn measures(
    interface: &mut Interface,
    member: &Member,
    (electrical, shifted): (bool, bool),
    early: bool,
    late: bool,
) -> ([Vec<Needs>; 4], Vec<Read>) {
    let charge = if member.is_charge_read(early) { CHARGE } else { STATE };
    let group = |declared: Needs| match declared {
        Needs::State if shifted => ELECTRICS,
        Needs::State if electrical => charge,
        Needs::Electrics if early => charge,
        Needs::State => STATE,
        Needs::Electrics if late => MOTION,
        Needs::Electrics => ELECTRICS,
        Needs::Motion => MOTION,
    };
    for (output, declared) in &member.part.outputs {
        let name = format!("{}.{}", member.path, output.name);
        interface.outputs.push(Output { name, ..output.clone() });
        interface.group_of.push(group(*declared));
    }
    let outputs = || member.part.outputs.iter().zip(&member.part.readings);
    let measures = [STATE, ELECTRICS, MOTION, CHARGE].map(|wanted| {
        let computes = |declared: &Needs| {
            group(*declared) == wanted
                && outputs().any(|((_, other), reading)| reading.is_none() && other == declared)
        };
        [Needs::State, Needs::Electrics, Needs::Motion].into_iter().filter(computes).collect()
    });
    let places = member.part.outputs.iter().scan(0, |next, (output, _)| {
        *next += output.port_type.shape.len();
        Some(*next - output.port_type.shape.len())
    });
    let reads = outputs().zip(places).filter_map(|(((_, declared), reading), place)| {
        Some(Read { group: group(*declared), place, reading: (*reading)? })
    });
    (measures, reads.collect())
}
