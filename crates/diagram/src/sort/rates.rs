//! Inputs whose derivatives are not connected.

use blocksim_block::problem::{Place, Problem};
use blocksim_block::schedule::When;

use super::order::Order;

/// Warns of inputs that vary although the input for their derivative is left open, which then is zero.
pub(super) fn judge(order: &Order, when: &[When]) -> Vec<Problem> {
    let mut found = Vec::new();
    for (block, interface) in order.typed.interfaces.iter().enumerate() {
        let flat = &order.flat.blocks[block];
        for (rate, input) in interface.inputs.iter().enumerate() {
            let Some(of) = input.rate_of.filter(|_| flat.inputs[rate].is_none()) else { continue };
            let Some(source) = &flat.inputs[of] else { continue };
            let varies = |group| when[order.number(group)] == When::Continuous;
            if !order.writers(source.block, source.output).any(varies) {
                continue;
            }
            let (owner, port) = input.name.rsplit_once('.').unwrap_or((&flat.path, &input.name));
            let what = interface.inputs[of].name.rsplit('.').next().unwrap_or_default();
            let part = flat.parts.iter().find(|part| part.path == owner);
            let place: Option<&Place> = part.map_or(flat.place.as_ref(), |part| part.place.as_ref());
            let message = format!(
                "`{what}` of `{owner}` varies and moves masses, but its derivative `{port}` is not connected and counts as zero: what \
                 accelerates them will be wrong"
            );
            let problem = Problem::warning("open_derivative", message);
            let problem = place.into_iter().fold(problem, |problem, place| problem.at(place, ""));
            found.push(problem.help(format!(
                "connect to `{port}` what goes into the integrator or the filter that gives the signal, or a source with its slope"
            )));
        }
    }
    found
}
