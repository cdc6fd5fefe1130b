//! From the lists of a controller to those of the table, when the plug-in is compiled.

use crate::abi::{MAX_INPUTS, Quantity as Row, Text};
use crate::quantity::{Input, Quantity};

const EMPTY: Row = Row {
    size: size_of::<Row>() as u32,
    length: 1,
    name: Text::EMPTY,
    unit: Text::EMPTY,
    doc: Text::EMPTY,
    default_value: std::ptr::null(),
    reads: 0,
};

/// The rows of one list; `inputs` are the inputs of the same controller.
///
/// # Panics
///
/// At compile time: a quantity is not where the list has it, a default has another length than its
/// quantity, an output reads what is no input, there are more than 64 inputs, a name occurs twice.
pub const fn rows<R: Copy, const N: usize>(list: &[Quantity<R>], inputs: &[Input]) -> [Row; N] {
    assert!(inputs.len() <= MAX_INPUTS as usize, "a controller has at most 64 inputs");
    let mut rows = [EMPTY; N];
    let mut at = 0;
    let mut i = 0;
    while i < N {
        let quantity = &list[i];
        assert!(
            quantity.at == at,
            "a place (first argument) is not the sum of the lengths before it in the list"
        );
        assert!(quantity.length > 0, "a quantity has no numbers");
        assert!(!quantity.name.is_empty(), "a quantity has no name");
        let mut before = 0;
        while before < i {
            assert!(!same(list[before].name, quantity.name), "a name occurs twice in one list");
            before += 1;
        }
        rows[i] = Row {
            length: quantity.length as u32,
            name: Text::new(quantity.name),
            unit: Text::new(quantity.unit),
            doc: Text::new(quantity.doc),
            default_value: match quantity.default {
                Some(default) => {
                    assert!(
                        default.len() == quantity.length,
                        "a default has another length than its quantity"
                    );
                    default.as_ptr()
                }
                None => std::ptr::null(),
            },
            reads: mask(quantity.reads, inputs),
            ..EMPTY
        };
        at += quantity.length;
        i += 1;
    }
    rows
}

/// A bit for each input that is read.
const fn mask(reads: &[Input], inputs: &[Input]) -> u64 {
    let mut mask = 0;
    let mut r = 0;
    while r < reads.len() {
        let mut i = 0;
        while i < inputs.len() && !same(inputs[i].name, reads[r].name) {
            i += 1;
        }
        assert!(i < inputs.len(), "an output reads an input that is not in INPUTS");
        mask |= 1 << i;
        r += 1;
    }
    mask
}

const fn same(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    if a.len() != b.len() {
        return false;
    }
    let mut i = 0;
    while i < a.len() {
        if a[i] != b[i] {
            return false;
        }
        i += 1;
    }
    true
}

/// How many numbers a list holds.
pub const fn numbers<R>(list: &[Quantity<R>]) -> usize {
    let mut sum = 0;
    let mut i = 0;
    while i < list.len() {
        sum += list[i].length;
        i += 1;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Output, Parameter};

    const A: Input = Input::new(0, "a", "1", "");
    const B: Input = Input::vector(1, 3, "b", "1", "");
    const C: Input = Input::new(4, "c", "1", "");

    #[test]
    fn feedthrough_names_ports_not_places() {
        const Y: Output = Output::new(0, "y", "1", "").reads(&[C, A]);
        let [row] = rows(&[Y], &[A, B, C]);
        assert_eq!(row.reads, 0b101);
    }

    #[test]
    fn rows_carry_lengths_texts_and_defaults() {
        const GAINS: Parameter = Parameter::vector(1, 2, "gains", "N*m/rad", "Both.").or(&[3.0, 4.0]);
        let rows: [Row; 2] = rows(&[Parameter::new(0, "ts", "s", ""), GAINS], &[]);
        assert!(rows[0].default_value.is_null());
        assert_eq!((rows[1].length, rows[1].size), (2, 72));
        // SAFETY: constants of this test.
        unsafe {
            assert_eq!((rows[1].name.as_str(), rows[1].unit.as_str()), (Some("gains"), Some("N*m/rad")));
            assert_eq!(*rows[1].default_value.add(1), 4.0);
        }
    }

    #[test]
    #[should_panic = "not the sum of the lengths before"]
    fn a_wrong_place_is_refused() {
        rows::<_, 2>(&[A, Input::new(2, "x", "1", "")], &[]);
    }

    #[test]
    #[should_panic = "not in INPUTS"]
    fn reading_a_port_of_another_controller_is_refused() {
        rows::<_, 1>(&[Output::new(0, "y", "1", "").reads(&[C])], &[A]);
    }

    #[test]
    #[should_panic = "another length"]
    fn a_default_of_wrong_length_is_refused() {
        rows::<_, 1>(&[Parameter::new(0, "k", "1", "").or(&[1.0, 2.0])], &[]);
    }

    #[test]
    #[should_panic = "twice"]
    fn two_of_one_name_are_refused() {
        rows::<_, 2>(&[A, Input::new(1, "a", "1", "")], &[]);
    }
}
