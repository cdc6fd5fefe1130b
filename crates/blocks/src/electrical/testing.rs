//! What tests of parts with characteristics need.

use blocksim_block::Given;
use blocksim_block::physical::{Characteristics, Component, Element, ElementPlace};

use crate::mechanics::testing::Seen;

/// Where the named elements of a part lie.
pub(crate) fn places(component: &dyn Component) -> Vec<ElementPlace> {
    let part = component.part(&Given::nothing());
    let two_pins = |element: &Element| match element {
        Element::IdealTransformer { .. } | Element::VariableTransformer { .. } => 2,
        Element::Junction { .. } => 0,
        element => usize::from(element.pins().len() == 2),
    };
    let is_law = |element: &&Element| matches!(element, Element::Characteristic { .. });
    let place = |(handle, index): &(_, usize)| {
        let before = &part.elements[..*index];
        ElementPlace {
            handle: *handle,
            two_pin: before.iter().map(two_pins).sum(),
            characteristic: is_law(&&part.elements[*index]).then(|| before.iter().filter(is_law).count()),
        }
    };
    part.handles.iter().map(place).collect()
}

/// Currents of the characteristics of a part at these voltages, and their slopes by rows.
pub(crate) fn characteristic(component: &dyn Component, x: &[f64], v: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let places = places(component);
    let (mut current, mut slope) = (vec![f64::NAN; v.len()], vec![f64::NAN; v.len() * v.len()]);
    let mut view = Characteristics::new(&places, v, &mut current, &mut slope);
    component.characteristics(&Seen { x, places: &places, ..Seen::NOTHING }.loaded(), &mut view);
    (current, slope)
}

/// Compares slopes with central differences.
pub(crate) fn slopes_are_exact(component: &dyn Component, x: &[f64], v: &[f64]) {
    let n = v.len();
    let (_, slope) = characteristic(component, x, v);
    for column in 0..n {
        let h = 1e-6 * v[column].abs().max(1e-2);
        let at = |by: f64| {
            let mut v = v.to_vec();
            v[column] += by;
            characteristic(component, x, &v).0
        };
        let (up, down) = (at(h), at(-h));
        for row in 0..n {
            let difference = (up[row] - down[row]) / (2.0 * h);
            let scale = slope[row * n + column].abs().max(up[row].abs().max(down[row].abs()) * 1e-9 / h);
            let error = (slope[row * n + column] - difference).abs();
            assert!(
                error <= 1e-6 * scale + 1e-300,
                "slope {row}, {column} at {v:?}: {slope:?}, {difference}"
            );
        }
    }
}
