use super::*;
use blocksim_block::testing::Bench;

fn matrix<const N: usize>(rows: &[[f64; N]]) -> Vec<Vec<f64>> {
    rows.iter().map(|row| row.to_vec()).collect()
}

/// A capacitor of 1 mF behind 1 kohm: voltage and current.
fn capacitor() -> DescriptorStateSpace {
    DescriptorStateSpace {
        e: matrix(&[[1e-3, 0.0], [0.0, 0.0]]),
        a: matrix(&[[0.0, 1.0], [-1.0, -1e3]]),
        b: matrix(&[[0.0], [1.0]]),
        c: matrix(&[[1.0, 0.0], [0.0, 1.0]]),
        d: Vec::new(),
        x0: Vec::new(),
        initial: InitialValues::Exact,
    }
}

#[test]
fn a_capacitor_behind_a_resistor_is_charged() {
    let mut bench = Bench::new(capacitor());
    assert!(bench.interface.reads(0, 0) && bench.interface.states[0].name == "x1");
    bench.set(0, &[5.0]).integrate(1.0, 1000);
    let y = bench.minor();
    let left = (-1.0_f64).exp();
    assert!((y[0] - 5.0 * (1.0 - left)).abs() < 1e-11 && (y[1] - 5e-3 * left).abs() < 1e-14, "{y:?}");
}

/// All units of equations and unknowns changed: the same behaviour.
#[test]
fn scales_of_rows_and_columns_do_not_matter() {
    for (row, column) in [(1e9, 1e-9), (1e-12, 1e6)] {
        let mut block = capacitor();
        for m in [&mut block.e, &mut block.a] {
            m[1].iter_mut().for_each(|value| *value *= row);
            m.iter_mut().for_each(|row| row[1] *= column);
        }
        block.b[1][0] *= row;
        block.c[1][1] *= column;
        let mut bench = Bench::new(block);
        bench.set(0, &[5.0]).integrate(1.0, 1000);
        let y = bench.minor();
        let left = (-1.0_f64).exp();
        assert!((y[0] - 5.0 * (1.0 - left)).abs() < 1e-11 && (y[1] - 5e-3 * left).abs() < 1e-14, "{y:?}");
    }
}

#[test]
fn a_regular_matrix_and_one_of_zeros_are_the_borders() {
    // 2 x' = -4 x + 2 u.
    let block = DescriptorStateSpace {
        e: matrix(&[[2.0]]),
        a: matrix(&[[-4.0]]),
        b: matrix(&[[2.0]]),
        c: matrix(&[[1.0]]),
        x0: vec![1.0],
        ..capacitor()
    };
    let mut bench = Bench::new(block);
    bench.set(0, &[0.0]).integrate(1.0, 1000);
    assert!((bench.minor()[0] - (-2.0_f64).exp()).abs() < 1e-11);
    // 0 = -4 x + 2 u.
    let block = DescriptorStateSpace {
        e: matrix(&[[0.0]]),
        a: matrix(&[[-4.0]]),
        b: matrix(&[[2.0]]),
        c: matrix(&[[1.0]]),
        ..capacitor()
    };
    let mut bench = Bench::new(block);
    assert!(bench.interface.states.is_empty());
    assert_eq!(bench.respond(3.0), 1.5);
}

#[test]
fn an_index_of_two_and_a_singular_pencil_are_refused_with_their_reason() {
    // x1' = x2, 0 = x1 - u: x2 = u'.
    let two = DescriptorStateSpace {
        e: matrix(&[[1.0, 0.0], [0.0, 0.0]]),
        a: matrix(&[[0.0, 1.0], [1.0, 0.0]]),
        b: matrix(&[[0.0], [-1.0]]),
        ..capacitor()
    };
    let error = &two.try_build().unwrap_err()[0];
    assert!(
        error.message.contains("the index of the equations is 2 or more: 1 of the 1"),
        "{}",
        error.message
    );
    let none = DescriptorStateSpace { a: matrix(&[[1.0, 1.0], [0.0, 0.0]]), ..capacitor() };
    let error = &none.try_build().unwrap_err()[0];
    assert!(error.message.contains("singular for every s"), "{}", error.message);
    let close = DescriptorStateSpace { e: matrix(&[[1.0, 1.0], [1.0, 1.0 + 1e-12]]), ..capacitor() };
    assert_eq!(close.try_build().unwrap_err()[0].param, "e");
    let size = DescriptorStateSpace { e: matrix(&[[1.0]]), ..capacitor() };
    assert_eq!(size.try_build().unwrap_err()[0].param, "e");
}

#[test]
#[should_panic(expected = "x0[1] is 1, but -2.000000e-3 follows")]
fn initial_values_that_contradict_the_constraints_are_told() {
    let mut bench = Bench::new(DescriptorStateSpace { x0: vec![2.0, 1.0], ..capacitor() });
    bench.set(0, &[0.0]).integrate(1e-3, 1);
}

#[test]
fn of_initial_values_the_differential_part_can_be_taken_alone() {
    let block =
        DescriptorStateSpace { x0: vec![2.0, 1.0], initial: InitialValues::Differential, ..capacitor() };
    let mut bench = Bench::new(block);
    bench.set(0, &[0.0]);
    assert_eq!(bench.minor(), [2.0, -2e-3]);
}
