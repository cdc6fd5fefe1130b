//! A small edit of a level makes a small change of its drawing.

use blocksim_layout::{Graph, Layout, layout};

use super::edits::{Edit, inserted, scopes, sources, taken_out, wider, wires};
use super::shipped;

/// Where a block stands against another: wholly left or right of it, wholly above or below it.
fn relation(layout: &Layout, a: usize, b: usize) -> (i8, i8) {
    let (a, b) = (&layout.nodes[a], &layout.nodes[b]);
    let side = |a: (f64, f64), b: (f64, f64)| if a.1 <= b.0 { -1 } else { i8::from(b.1 <= a.0) };
    (side((a.x, a.x + a.width), (b.x, b.x + b.width)), side((a.y, a.y + a.height), (b.y, b.y + b.height)))
}

/// How a drawing differs from the one before an edit.
struct Change {
    /// Blocks that turned round against more than a third of the others: were above them and are below, or left and are
    /// right. That everything right of a new block gives way is no move.
    moved: usize,
    blocks: usize,
    /// Share of the pairs of blocks that turned round.
    turned: f64,
    /// Share of the blocks that shifted by more than a block against the median of all.
    shifted: f64,
}

fn change(before: &Layout, after: &Layout, pairs: &[(usize, usize)]) -> Change {
    let turned = |a: &(usize, usize), b: &(usize, usize)| {
        let (was, is) = (relation(before, a.0, b.0), relation(after, a.1, b.1));
        was.0 * is.0 < 0 || was.1 * is.1 < 0
    };
    let against: Vec<usize> = pairs.iter().map(|a| pairs.iter().filter(|b| turned(a, b)).count()).collect();
    let blocks = pairs.len();
    let all = (blocks * blocks.saturating_sub(1)).max(1);
    let middle = |layout: &Layout, node: usize| {
        let placed = &layout.nodes[node];
        (placed.x + placed.width / 2.0, placed.y + placed.height / 2.0)
    };
    let shifts: Vec<(f64, f64)> = pairs
        .iter()
        .map(|(was, is)| (middle(before, *was), middle(after, *is)))
        .map(|(was, is)| (is.0 - was.0, is.1 - was.1))
        .collect();
    let median = |of: fn(&(f64, f64)) -> f64| {
        let mut values: Vec<f64> = shifts.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        values.get(blocks / 2).copied().unwrap_or(0.0)
    };
    let (across, down) = (median(|shift| shift.0), median(|shift| shift.1));
    // A block with its gap.
    let far = |shift: &&(f64, f64)| (shift.0 - across).abs() > 110.0 || (shift.1 - down).abs() > 70.0;
    Change {
        moved: against.iter().filter(|count| 3 * **count + 1 > blocks).count(),
        blocks,
        turned: against.iter().sum::<usize>() as f64 / all as f64,
        shifted: shifts.iter().filter(far).count() as f64 / blocks.max(1) as f64,
    }
}

/// An edit disturbs a drawing if it moves a tenth of the other blocks or more, and more than one: on a level of eight
/// blocks a single one is an eighth.
fn disturbs(change: &Change) -> bool {
    change.moved > 1 && 10 * change.moved >= change.blocks
}

/// What edits of one sort do to all levels with at least eight blocks.
#[derive(Default)]
struct Tally {
    all: usize,
    disturbing: Vec<String>,
    turned: f64,
    shifted: f64,
}

impl Tally {
    /// A row of the manual's table, with shares in percent.
    fn row(&self) -> String {
        let percent = |sum: f64| 100.0 * sum / self.all.max(1) as f64;
        let (disturbing, all) = (self.disturbing.len(), self.all);
        format!("| {disturbing} of {all} | {:.1} % | {:.1} % |", percent(self.turned), percent(self.shifted))
    }

    fn share(&self) -> f64 {
        self.disturbing.len() as f64 / self.all.max(1) as f64
    }
}

fn tally(edits: impl Fn(&Graph) -> Vec<Edit>) -> Tally {
    let mut tally = Tally::default();
    for (name, level) in shipped().into_iter().filter(|(_, level)| level.graph.nodes.len() >= 8) {
        let before = layout(&level.graph);
        for Edit { what, graph, pairs } in edits(&level.graph) {
            let change = change(&before, &layout(&graph), &pairs);
            tally.all += 1;
            tally.turned += change.turned;
            tally.shifted += change.shifted;
            if disturbs(&change) {
                tally.disturbing.push(format!("{name}, {what}: {} of {}", change.moved, change.blocks));
            }
        }
    }
    tally
}

/// The manual tells these numbers.
fn on_the_page(found: &Tally) {
    let page = std::fs::read_to_string(blocksim_tests::root().join("docs/drawing.md")).expect("the page");
    let row = found.row();
    assert!(page.contains(&row), "docs/drawing.md does not say `{row}`: {:#?}", found.disturbing);
}

#[test]
fn wider_blocks_and_other_names_leave_the_others_where_they_are() {
    let found = tally(wider);
    on_the_page(&found);
    assert!(found.all > 1000, "{}", found.all);
    assert!(found.disturbing.is_empty() && found.turned == 0.0, "{}: {:?}", found.row(), found.disturbing);
}

#[test]
fn more_or_fewer_scopes_leave_the_others_where_they_are() {
    let found = tally(scopes);
    on_the_page(&found);
    assert!(found.all > 400, "{}", found.all);
    assert!(found.disturbing.is_empty(), "{}: {:?}", found.row(), found.disturbing);
}

#[test]
fn a_block_in_any_wire_leaves_the_others_where_they_are() {
    let found = tally(inserted);
    on_the_page(&found);
    assert!(found.all > 1500, "{}", found.all);
    assert!(found.disturbing.is_empty(), "{}: {:#?}", found.row(), found.disturbing);
}

#[test]
fn a_block_taken_out_of_a_wire_leaves_the_others_where_they_are() {
    let found = tally(taken_out);
    on_the_page(&found);
    assert!(found.all > 70, "{}", found.all);
    assert!(found.disturbing.is_empty(), "{}: {:?}", found.row(), found.disturbing);
}

/// A wire more is another diagram: what it joins moves together.
const MORE_WIRES: f64 = 0.08;

#[test]
fn one_wire_more_mostly_leaves_the_others_where_they_are() {
    let found = tally(wires);
    on_the_page(&found);
    assert!(found.all > 700, "{}", found.all);
    assert!(found.share() < MORE_WIRES, "{}: {:#?}", found.row(), found.disturbing);
}

/// A source more needs a place of its own, and a drawing with many crossings may find a better one for the others too.
const SOURCES: f64 = 0.05;

#[test]
fn a_source_more_mostly_leaves_the_others_where_they_are() {
    let found = tally(sources);
    on_the_page(&found);
    assert!(found.all > 140, "{}", found.all);
    assert!(found.share() < SOURCES, "{}: {:#?}", found.row(), found.disturbing);
}
