//! Results that are no numbers: which, and from what.

use blocksim_signal::{Dimension, si_text};

use crate::kind::Quantity;

/// Whether all numbers are finite.
#[inline]
pub fn all_finite(numbers: &[f64]) -> bool {
    numbers.iter().all(|number| number.is_finite())
}

/// The first element of a list that is not finite: `u is NaN`, `v[2] is inf`.
pub fn culprit(what: &str, list: &[Quantity], numbers: &[f64]) -> Option<String> {
    let mut at = 0;
    for quantity in list {
        for i in 0..quantity.length {
            let value = *numbers.get(at + i)?;
            if !value.is_finite() {
                let name = element(quantity, i);
                return Some(format!("{what} `{name}` is {value}"));
            }
        }
        at += quantity.length;
    }
    None
}

/// Name of an element: `u`, or `v[2]` of a vector.
pub fn element(quantity: &Quantity, i: usize) -> String {
    if quantity.length == 1 { quantity.name.to_owned() } else { format!("{}[{i}]", quantity.name) }
}

/// All values of a list: `q = 0.1 rad, v = [1, 2, 3]`.
pub fn values(list: &[Quantity], numbers: &[f64]) -> String {
    let mut at = 0;
    let mut texts = Vec::new();
    for quantity in list {
        let end = (at + quantity.length).min(numbers.len());
        let dimension = quantity.dimension.unwrap_or(Dimension::NONE);
        let elements: Vec<String> = numbers[at..end].iter().map(|&value| si_text(value, dimension)).collect();
        let text = elements.join(", ");
        texts.push(match quantity.length {
            1 => format!("{} = {text}", quantity.name),
            _ => format!("{} = [{text}]", quantity.name),
        });
        at = end;
    }
    if texts.is_empty() { "none".to_owned() } else { texts.join(", ") }
}
