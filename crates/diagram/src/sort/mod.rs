//! The order of evaluation, and where every value lies.

mod clock;
mod laws;
mod layout;
mod loops;
mod order;
mod rates;
mod when;

use std::sync::Arc;

use blocksim_block::schedule::{Schedule, Settings};
use foldhash::HashMap;

use crate::flatten::Flat;
use crate::infer::Typed;
use crate::problems::Problems;
use clock::{clock, rate_of};
use laws::Laws;
use layout::lay_out;
use order::Order;
use when::when;

/// Sorts the output groups and lays out all values.
pub(crate) fn sort(
    title: String,
    flat: Flat,
    mut typed: Typed,
    settings: Settings,
    problems: &mut Problems,
) -> Option<Schedule> {
    let mut laws = Laws::record(&flat, &mut typed, problems);
    // Where blocks seem to need each other's outputs, only their values may tell whether they do.
    let mut order = Order::new(&flat, &typed, &laws);
    let bound = order.in_loops();
    if !bound.is_empty() {
        drop(order);
        laws.split(&typed, &bound);
        order = Order::new(&flat, &typed, &laws);
    }
    let sorted = order.topological();
    let clock = clock(&flat, &typed, problems);
    if problems.any_error() {
        return None;
    }
    let rated = typed.interfaces.iter().enumerate();
    let rates = rated.filter_map(|(block, interface)| rate_of(interface, &clock).map(|rate| (block, rate)));
    let rates: HashMap<usize, usize> = rates.collect();
    let when = when(&order, &sorted, &rates);
    problems.extend(order.judge(&sorted, &when, settings.algebraic_loops));
    problems.extend(rates::judge(&order, &when));
    if problems.any_error() {
        return None;
    }
    let mut schedule = lay_out(title, &order, settings, &sorted, clock, &rates, &when);
    drop(order);
    hand_over(&mut schedule, flat, typed);
    Some(schedule)
}

/// Puts names, places and interfaces into a schedule, which are not needed elsewhere any more.
fn hand_over(schedule: &mut Schedule, flat: Flat, typed: Typed) {
    let mut signals = schedule.signals.iter_mut();
    for ((block, of), interface) in flat.blocks.into_iter().zip(&mut schedule.blocks).zip(typed.interfaces) {
        let names = block.output_names.into_iter().take(interface.outputs.len());
        names.zip(signals.by_ref()).for_each(|(name, signal)| signal.path = name);
        of.path = block.path;
        of.kind = block.kind;
        of.place = block.place;
        of.parts = block.parts;
        of.interface = Arc::unwrap_or_clone(interface);
    }
}

/// The longest time that a block has something to show, for `stop_time: Auto`.
pub(crate) fn end_time(flat: &Flat) -> Option<f64> {
    flat.blocks.iter().filter_map(|block| block.block.end_time()).max_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use blocksim_block::schedule::{
        Loop, LoopPolicy, OutputTimes, Rate, Solver, Start, VariableMethod, When,
    };

    use super::*;
    use crate::elaborate::elaborate;
    use crate::infer::infer;
    use crate::toys::{flat, messages, model};

    /// The schedule of toys, and what is wrong with them.
    fn scheduled(flat: Flat) -> (Option<Schedule>, Vec<String>) {
        let mut problems = Problems::default();
        let solver =
            Solver::Variable { method: VariableMethod::Ode45, rtol: 1e-6, atol: Some(1e-6), max_step: 1.0 };
        let settings = Settings {
            stop_time: 1.0,
            solver,
            output: OutputTimes::Steps,
            seed: 0,
            start: Start::Given,
            atol: Vec::new(),
            algebraic_loops: LoopPolicy::default(),
        };
        let (flat, _) = elaborate(flat, [].iter(), &mut problems);
        let typed = infer(&flat, &mut problems);
        let schedule = sort(String::new(), flat, typed, settings, &mut problems);
        (schedule, messages(&problems))
    }

    fn order(schedule: &Schedule) -> Vec<&str> {
        schedule.steps.iter().map(|step| schedule.blocks[step.block as usize].path.as_str()).collect()
    }

    #[test]
    fn readers_follow_their_sources_and_ties_go_by_path() {
        let blocks = "\"z\": State, \"c\": Gain, \"b\": Gain, \"a\": Gain";
        let (schedule, _) = scheduled(flat(blocks, "\"z.y -> c.u, b.u\", \"c.y -> a.u\", \"a.y -> z.u\""));
        let schedule = schedule.expect("a schedule");
        assert_eq!(order(&schedule), ["z", "b", "c", "a"]);
        // `b` only shows; the others lead to a derivative.
        let minor: Vec<bool> = schedule.steps.iter().map(|step| step.minor).collect();
        assert_eq!(minor, [true, false, true, true]);
    }

    #[test]
    fn between_major_steps_nothing_is_looked_at_for_what_is_held() {
        let blocks = "\"s\": Sampled(period: 1, offset: 0), \"held\": Limit, \"x\": State, \"g\": Gain, \"moving\": Limit";
        let wires = "\"x.y -> g.u\", \"g.y -> s.u, moving.u\", \"s.y -> held.u\", \"held.y -> x.u\"";
        let (schedule, _) = scheduled(flat(blocks, wires));
        let schedule = schedule.expect("a schedule");
        let watched: Vec<&str> =
            schedule.blocks.iter().filter(|block| block.watched).map(|block| block.path.as_str()).collect();
        assert_eq!(watched, ["moving"], "what a sampled block gives crosses nothing");
        // Without its guard nobody would need the gain: the sampled block hides it.
        let (schedule, _) = scheduled(flat(&blocks.replace("\"moving\": Limit", "\"moving\": Gain"), wires));
        let schedule = schedule.expect("a schedule");
        let steps = schedule.steps.iter().filter(|step| step.minor);
        let minor: Vec<&str> = steps.map(|step| schedule.blocks[step.block as usize].path.as_str()).collect();
        assert_eq!(minor, Vec::<&str>::new());
    }

    #[test]
    fn what_depends_on_constants_alone_is_evaluated_once() {
        let (schedule, _) = scheduled(flat("\"c\": Constant(n: 1), \"g\": Gain", "\"c.y -> g.u\""));
        assert!(schedule.expect("a schedule").steps.iter().all(|step| step.when == When::Constant));
    }

    #[test]
    fn an_algebraic_loop_is_told_hop_by_hop() {
        let blocks = "\"a\": Gain, \"b\": Gain, \"c\": Gain, \"d\": Gain";
        let (schedule, messages) =
            scheduled(flat(blocks, "\"a.y -> c.u, d.u\", \"c.y -> b.u\", \"b.y -> a.u\""));
        assert_eq!(messages, ["algebraic loop: a -> c -> b -> a; solved at every instant"]);
        let schedule = schedule.expect("a schedule");
        // Each follows its source but for one, behind which the loop is cut; `d` only looks on.
        assert_eq!(order(&schedule), ["c", "b", "a", "d"]);
        let cell = schedule.signals.iter().find(|signal| signal.path == "a.y").map(|signal| signal.offset);
        assert_eq!(
            schedule.loops,
            [Loop { first: 0, count: 3, cells: cell.into_iter().collect(), chosen: Vec::new(), sought: 0 }]
        );
    }

    #[test]
    fn a_loop_of_several_ways_is_cut_where_they_meet() {
        // Two rings that have `a` in common, and a third behind them.
        let blocks = "\"a\": Sum, \"b\": Gain, \"c\": Gain, \"x\": Sum, \"y\": Gain";
        let wires =
            "\"a.y -> b.u, c.u, x.u\", \"b.y -> a.u\", \"c.y -> a.v\", \"x.y -> y.u\", \"y.y -> x.v\"";
        let schedule = scheduled(flat(blocks, wires)).0.expect("a schedule");
        let loops: Vec<(usize, usize, usize)> =
            schedule.loops.iter().map(|found| (found.first, found.count, found.cells.len())).collect();
        assert_eq!(loops, [(0, 3, 1), (3, 2, 1)]);
        assert_eq!(order(&schedule)[..3], ["b", "c", "a"]);
    }

    fn sampled(times: &[(f64, f64)]) -> (Option<Schedule>, Vec<String>) {
        let block = |(n, (period, offset)): (usize, &(f64, f64))| {
            format!("\"s{n}\": Sampled(period: {period}, offset: {offset}),")
        };
        let blocks: String = times.iter().enumerate().map(block).collect();
        let connections: String = (0..times.len()).map(|n| format!("\"s{n}.y -> s{n}.u\",")).collect();
        scheduled(flat(&blocks, &connections))
    }

    #[test]
    fn sample_times_share_one_clock() {
        let (schedule, _) = sampled(&[(0.005, 0.0), (0.001, 0.0), (0.005, 0.0005), (0.001, 0.0)]);
        let clock = schedule.expect("a schedule").clock;
        assert!((clock.tick - 0.0005).abs() < 1e-15, "{}", clock.tick);
        let rate = |period, offset| Rate { period, offset };
        assert_eq!(clock.rates, [rate(2, 0), rate(10, 0), rate(10, 1)]);
    }

    #[test]
    fn sample_times_without_a_common_clock_are_refused() {
        let (_, messages) = sampled(&[(1.0, 0.0), (std::f64::consts::PI * 1e-10, 0.0)]);
        assert_eq!(messages, ["the sample times have no common clock"]);
        let (_, messages) = sampled(&[(0.0, 0.0)]);
        assert_eq!(messages, ["a sample time of 0 s cannot be kept"]);
    }

    /// A row of gains whose signals run against the order of names.
    fn chain(n: usize) -> (String, String) {
        let blocks = (0..n).map(|i| format!("\"g{i:05}\": Gain,")).collect();
        let connections = (1..n).map(|i| format!("\"g{i:05}.y -> g{:05}.u\",", i - 1)).collect();
        (blocks, connections)
    }

    #[test]
    fn twenty_thousand_blocks_in_a_row_take_no_long_time() {
        let start = Instant::now();
        let (blocks, mut connections) = chain(20_000);
        let model = model(&blocks, &connections);
        let mut problems = Problems::default();
        crate::connect::check(&model, &mut problems);
        let (schedule, messages) = scheduled(crate::flatten::flatten(&model, &[], &mut problems));
        assert_eq!(messages, Vec::<String>::new());
        let schedule = schedule.expect("a schedule");
        assert_eq!(order(&schedule)[..2], ["g19999", "g19998"]);
        assert_eq!(crate::emit::schedule(&schedule).lines().count(), 20_002);
        // The same row closed to a loop.
        connections.push_str("\"g00000.y -> g19999.u\"");
        let (schedule, messages) = scheduled(flat(&blocks, &connections));
        assert_eq!(schedule.map(|schedule| schedule.loops[0].cells.len()), Some(1));
        assert!(messages[0].starts_with("algebraic loop: g00000 -> g19999 -> g19998"));
        assert!(start.elapsed() < Duration::from_secs(20), "{:?}", start.elapsed());
    }

    #[test]
    fn a_reader_has_one_edge_from_each_group_that_it_reads() {
        let many = 1000;
        let blocks: String = (0..many).map(|i| format!("\"s{i}\": Sum,")).collect();
        let wires: String = (0..many).map(|i| format!("\"c.y -> s{i}.u, s{i}.v\",")).collect();
        let flat = flat(&format!("\"c\": Constant(n: 1), {blocks}"), &wires);
        let mut problems = Problems::default();
        let (flat, _) = elaborate(flat, [].iter(), &mut problems);
        let mut typed = infer(&flat, &mut problems);
        let laws = Laws::record(&flat, &mut typed, &mut problems);
        let order = Order::new(&flat, &typed, &laws);
        assert_eq!((order.graph.node_count(), order.graph.edge_count()), (many + 1, many));
        let (schedule, messages) = scheduled(flat);
        assert_eq!((schedule.map(|schedule| schedule.steps.len()), messages), (Some(many + 1), Vec::new()));
    }
}
