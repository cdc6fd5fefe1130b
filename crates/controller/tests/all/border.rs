//! What crosses the border when things go right and wrong.

use std::ptr::{null, null_mut};

use blocksim_controller::abi::read::{elements, read};
use blocksim_controller::abi::{BlockTable, ERROR, Message, OK, PANICKED, message};
use blocksim_controller::prelude::*;
use blocksim_controller::testing::Bench;

/// dx/dt = k u for a vector of two, y = (x, sum of u); it fails and panics on demand.
struct Moody;

const MODE: Parameter =
    Parameter::new(0, "mode", "1", "1: error, 2: panic, 3: panic with a value.").or(&[0.0]);
const K: Parameter = Parameter::vector(1, 2, "k", "1/s", "Gains.");
const U: Input = Input::vector(0, 2, "u", "rad", "In.");
const BIAS: Input = Input::new(2, "bias", "rad", "Added to the sum.").or(&[0.5]);
const X: Continuous = Continuous::vector(0, 2, "x", "rad", "Integrals.").or(&[1.0, 2.0]);
const COUNT: Discrete = Discrete::new(0, "count", "1", "Left alone.").or(&[7.0]);
const Y: Output = Output::vector(0, 2, "y", "rad", "The integrals.");
const SUM: Output = Output::new(2, "sum", "rad", "Sum.").reads(&[U, BIAS]);

fn mood(mode: f64) -> Outcome {
    match mode {
        1.0 => Err(format!("mode is {mode}")),
        2.0 => panic!("mode is {mode}"),
        3.0 => std::panic::panic_any(mode),
        _ => Ok(()),
    }
}

impl Controller for Moody {
    const KIND: &'static str = "Moody";
    const DOC: &'static str = "";
    const PARAMETERS: &'static [Parameter] = &[MODE, K];
    const INPUTS: &'static [Input] = &[U, BIAS];
    const OUTPUTS: &'static [Output] = &[Y, SUM];
    const DISCRETE: &'static [Discrete] = &[COUNT];
    const CONTINUOUS: &'static [Continuous] = &[X];

    fn check(p: &Parameters) -> Outcome {
        if p.vector(K)[1] < 0.0 { Err("`k` must not be negative".into()) } else { Ok(()) }
    }

    fn reset(p: &Parameters, x: &mut ContinuousStates, _xd: &mut DiscreteStates) -> Outcome {
        x.vector_mut(X)[1] += p[K];
        Ok(())
    }

    fn outputs(c: &Context, y: &mut Outputs) -> Outcome {
        mood(c[MODE])?;
        y.vector_mut(Y).copy_from_slice(c.x.vector(X));
        y[SUM] = c.u.vector(U).iter().sum::<f64>() + c[BIAS] + c.t;
        Ok(())
    }

    fn update(c: &Context, _next: &mut DiscreteStates) -> Outcome {
        mood(c[MODE])
    }

    fn derivatives(c: &Context, dx: &mut Derivatives) -> Outcome {
        mood(c[MODE])?;
        for (i, dx) in dx.vector_mut(X).iter_mut().enumerate() {
            *dx = c.p.vector(K)[i] * c.u.vector(U)[i];
        }
        Ok(())
    }
}

export_plugin!("moody", [Moody]);

fn block() -> BlockTable {
    // SAFETY: the macro wrote the table.
    unsafe { read(table().blocks).unwrap() }
}

#[test]
fn the_table_describes_the_controller() {
    let block = block();
    // SAFETY: the macro wrote the table.
    unsafe {
        assert_eq!(table().name.as_str(), Some("moody"));
        assert_eq!(table().version.as_str(), Some(env!("CARGO_PKG_VERSION")));
        assert_eq!(block.kind.as_str(), Some("Moody"));
        let parameters: Vec<_> = elements(block.parameters, block.parameter_count).flatten().collect();
        assert_eq!(parameters.len(), 2);
        assert!(!parameters[0].default_value.is_null() && parameters[1].default_value.is_null());
        assert_eq!((parameters[1].length, parameters[1].unit.as_str()), (2, Some("1/s")));
        let inputs: Vec<_> = elements(block.input_ports, block.input_count).flatten().collect();
        assert_eq!(*inputs[1].default_value, 0.5);
        let outputs: Vec<_> = elements(block.output_ports, block.output_count).flatten().collect();
        assert_eq!((outputs[0].reads, outputs[1].reads), (0b00, 0b11), "y sees the inputs through x only");
    }
}

#[test]
fn the_exported_function_gives_the_same_table() {
    assert_eq!(blocksim_controller::linked().filter(|&t| std::ptr::eq(t, table())).count(), 1);
}

#[test]
fn vectors_defaults_and_start_values_arrive_in_place() {
    let mut bench = Bench::new(table(), "Moody", &[("k.0", 10.0), ("k.1", 20.0)]).unwrap();
    assert_eq!(bench.period(), 0.0);
    assert_eq!(bench.continuous(), [1.0, 12.0], "the default of x, then what reset added");
    assert_eq!(bench.outputs(0.25, &[3.0, 4.0, 0.5]).unwrap(), [1.0, 12.0, 7.75]);
    assert_eq!(bench.derivatives(0.0, &[3.0, 4.0, 0.5]).unwrap(), [30.0, 80.0]);
    bench.sample(0.0, &[0.0; 3]).unwrap();
    assert_eq!(bench.discrete(), [7.0], "a state that update leaves alone stays");
}

#[test]
fn a_refusal_of_check_arrives_with_its_reason() {
    let failure = Bench::new(table(), "Moody", &[("k.0", 1.0), ("k.1", -1.0)]).unwrap_err();
    assert_eq!((failure.status, failure.message.as_str()), (ERROR, "`k` must not be negative"));
}

#[test]
fn errors_and_panics_are_told_apart_and_stay_behind_the_border() {
    for (mode, status, text) in
        [(1.0, ERROR, "mode is 1"), (2.0, PANICKED, "mode is 2"), (3.0, PANICKED, "a panic without a text")]
    {
        let mut bench = Bench::new(table(), "Moody", &[("mode", mode), ("k.0", 1.0), ("k.1", 1.0)]).unwrap();
        for failure in
            [bench.outputs(0.0, &[0.0; 3]).unwrap_err(), bench.derivatives(0.0, &[0.0; 3]).unwrap_err()]
        {
            assert_eq!((failure.status, failure.message.as_str()), (status, text));
        }
    }
}

#[test]
fn long_reasons_are_cut_to_the_buffer_and_no_buffer_is_fine() {
    let check = block().check.unwrap();
    let params = [0.0, 1.0, -1.0];
    let mut buffer = [0xff; 8];
    let short = Message::new(&mut buffer);
    // SAFETY: buffers as the table states; NULL messages are allowed.
    unsafe {
        assert_eq!(check(params.as_ptr(), &short), ERROR);
        assert_eq!(check(params.as_ptr(), null()), ERROR);
        assert_eq!(check(params.as_ptr(), &Message { size: 16, capacity: 0, text: null_mut() }), ERROR);
    }
    assert_eq!(message::written(&buffer), "`k` mus");
}

#[test]
fn a_host_that_forgets_a_buffer_gets_an_error() {
    let block = block();
    let mut buffer = [0; 64];
    let message = Message::new(&mut buffer);
    let (params, x, xd, u) = ([0.0; 3], [0.0; 2], [0.0; 1], [0.0; 3]);
    let mut y = [0.0; 3];
    // SAFETY: NULL is refused, the other buffers are as the table states.
    unsafe {
        let outputs = block.outputs.unwrap();
        let status = outputs(params.as_ptr(), 0.0, x.as_ptr(), xd.as_ptr(), null(), y.as_mut_ptr(), &message);
        assert_eq!((status, message::written(&buffer)), (ERROR, "the host gave no memory for the inputs"));
        let status = outputs(params.as_ptr(), 0.0, x.as_ptr(), xd.as_ptr(), u.as_ptr(), null_mut(), null());
        assert_eq!(status, ERROR);
        assert_eq!(block.check.unwrap()(null(), null()), ERROR);
        assert_eq!(block.sample_time.unwrap()(params.as_ptr(), null_mut(), null()), ERROR);
        assert_eq!(
            outputs(params.as_ptr(), 0.0, x.as_ptr(), xd.as_ptr(), u.as_ptr(), y.as_mut_ptr(), null()),
            OK
        );
    }
}

#[test]
#[should_panic = "not a table that `export_plugin!` wrote"]
fn the_bench_takes_tables_of_this_program_only() {
    let copy: &'static _ = Box::leak(Box::new(*table()));
    let _ = Bench::new(copy, "Moody", &[]);
}
