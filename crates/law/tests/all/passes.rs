//! Each pass alone, on printed programs.

use blocksim_law::{Code, Domain, Program, Recorder, Relation, Sources, passes};
use expect_test::expect;

fn sample() -> Program {
    let recorder = Recorder::new();
    let u = recorder.input("u");
    let p = recorder.parameter("p", 2.0);
    recorder.at(0..6);
    let sine = u.sin();
    recorder.at(9..15);
    let again = u.sin();
    recorder.at(0..21);
    let y = sine + again * (p * 3.0);
    let _unused = u.exp();
    recorder.output("y", y);
    recorder.finish()
}

#[test]
fn a_program_prints_with_types_and_places() {
    expect![[r#"
        %0: real = input u
        %1: real = parameter p
        %2: real = sin %0    // 0..6
        %3: real = sin %0    // 9..15
        %4: real = 3.0    // 0..21
        %5: real = %1 * %4    // 0..21
        %6: real = %3 * %5    // 0..21
        %7: real = %2 + %6    // 0..21
        %8: real = exp %0    // 0..21
        output y = %7
    "#]]
    .assert_eq(&sample().to_string());
}

#[test]
fn constants_are_folded_once_parameters_are_bound() {
    expect![[r#"
        %0: real = input u
        %1: real = 2.0
        %2: real = sin %0    // 0..6
        %3: real = sin %0    // 9..15
        %4: real = 3.0    // 0..21
        %5: real = 6.0    // 0..21
        %6: real = %3 * %5    // 0..21
        %7: real = %2 + %6    // 0..21
        %8: real = exp %0    // 0..21
        output y = %7
    "#]]
    .assert_eq(&passes::fold_constants(passes::bind_parameters(sample())).to_string());
}

#[test]
fn the_same_expression_is_computed_once() {
    expect![[r#"
        %0: real = input u
        %1: real = parameter p
        %2: real = sin %0    // 0..6
        %3: real = 3.0    // 0..21
        %4: real = %1 * %3    // 0..21
        %5: real = %2 * %4    // 0..21
        %6: real = %2 + %5    // 0..21
        %7: real = exp %0    // 0..21
        output y = %6
    "#]]
    .assert_eq(&passes::share_equal(sample()).to_string());
}

#[test]
fn what_nobody_asks_for_is_dropped() {
    let dropped = passes::drop_unused(sample());
    assert_eq!(dropped.instructions.len(), sample().instructions.len() - 1);
    assert!(!dropped.to_string().contains("exp"));
    expect![[r#"
        %0: real = input u
        %1: real = sin %0    // 0..6
        %2: real = 6.0    // 0..21
        %3: real = %1 * %2    // 0..21
        %4: real = %1 + %3    // 0..21
        output y = %4
    "#]]
    .assert_eq(&passes::bind_parameters(sample()).optimised().to_string());
}

#[test]
fn equal_modes_become_one_and_constant_ones_none() {
    let recorder = Recorder::new();
    let (u, one) = (recorder.input("u"), recorder.constant(1.0));
    let first = u.is(Relation::Less, one).select(u, one);
    let second = u.is(Relation::Less, one).select(one, u);
    let constant = one.is(Relation::Less, one).select(u, one);
    recorder.output("y", first + second + constant + (one + 1.5).floor());
    expect![[r#"
        %0: real = input u
        %1: real = 1.0
        %2: bool = %0 < %1
        %3: bool = mode 0
        %4: real = %0 - %1
        %5: real = if %3 then %0 else %1
        %6: real = if %3 then %1 else %0
        %7: real = %5 + %6
        %8: real = %7 + %1
        %9: real = 2.0
        %10: real = %8 + %9
        mode 0 is %2 from zero to zero of %4 (compare)
        output y = %10
    "#]]
    .assert_eq(&recorder.finish().optimised().to_string());
}

#[test]
fn requirements_that_hold_are_dropped_and_others_name_their_place() {
    let recorder = Recorder::new();
    let u = recorder.input("u");
    recorder.at(4..9);
    let y = u / 2.0 + u.sqrt();
    recorder.output("y", y);
    let program = recorder.finish().optimised();
    assert_eq!(program.requirements.len(), 1);
    let wanted: Vec<_> = program.output_values().into_iter().chain(program.requirements.clone()).collect();
    let code = Code::new(&program, &wanted);
    let run = |u: f64| {
        let mut registers = vec![0.0; code.registers()];
        code.run(&Sources { inputs: &[u], ..Sources::default() }, &mut registers)
    };
    assert_eq!((run(4.0), run(0.0), run(f64::NAN)), (None, None, None));
    let failure = run(-4.0).unwrap();
    assert_eq!((failure.domain, failure.value), (Domain::NotNegative, -4.0));
    assert_eq!(program.instructions[failure.at.0 as usize].place, Some(4..9));
}

#[test]
fn registers_are_used_again() {
    let recorder = Recorder::new();
    let u = recorder.input("u");
    let y = (0..1000).fold(u, |y, i| (y + f64::from(i)).sin());
    recorder.output("y", y);
    let program = recorder.finish().optimised();
    let code = Code::new(&program, &program.output_values());
    // The constants and the input have places of their own.
    let sources = 1000 + 1;
    assert!(code.len() > 1900 && code.registers() <= sources + 2, "{} in {}", code.len(), code.registers());
}
