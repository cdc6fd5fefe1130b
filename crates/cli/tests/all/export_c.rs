//! Code for targets, as users make it.

use expect_test::expect;

use crate::desk::Desk;

const LOOP: &str = r#"Diagram(
    title: "Loop",
    simulation: (stop_time: "1 s"),
    blocks: {
        "set": Constant(value: 1.0),
        "control": Subsystem(file: "control.ron"),
        "plant": LowPass(tau: "0.2 s"),
        "late": TransportDelay(delay: "1 ms"),
        "show": Scope(inputs: ["set", "actual"]),
    },
    connections: [
        "set.y -> control.set, show.set", "control.u -> plant.u", "plant.y -> late.u", "late.y -> control.actual, show.actual",
    ],
)
"#;

const CONTROL: &str = r#"Diagram(
    inputs: { "set": (), "actual": () },
    outputs: { "u": "limit.y" },
    blocks: {
        "error": Sum(signs: "+-"),
        "sum": DiscreteIntegrator(ts: "10 ms"),
        "limit": Saturation(lower: -2.0, upper: 2.0),
        "unused": Terminator,
    },
    connections: ["in.set -> error.u1", "in.actual -> error.u2", "error.y -> sum.u", "sum.y -> limit.u, unused.u"],
)
"#;

fn desk() -> Desk {
    Desk::with(&[("loop.ron", LOOP), ("control.ron", CONTROL)])
}

#[test]
fn files_are_written_once_and_replaced_when_that_is_said() {
    let desk = desk();
    let export = ["export", "c", "loop.ron", "--subsystem", "control", "--rate", "10ms", "--out", "code"];
    let answer = desk.call(&export);
    assert_eq!(answer.code, Some(0), "{answer:?}");
    assert_eq!(answer.out, "code/control.h\ncode/control.c\ncode/control_test.c\ncode/control.md\n");
    let header = desk.read("code/control.h");
    assert!(header.contains("double actual; /* "), "{header}");
    assert!(
        header.contains(
            "int control_step(control_State *self, const control_Inputs *in, control_Outputs *out);"
        )
    );
    std::fs::write(desk.0.join("code/control.c"), "mine").expect("a file");
    let again = desk.call(&export);
    assert_eq!(again.code, Some(4), "{again:?}");
    assert!(again.err.contains("error[exists]: `code/control.h` already exists"), "{}", again.err);
    assert_eq!(desk.read("code/control.c"), "mine");
    let replaced = desk.call(&[&export[..], &["--yes"]].concat());
    assert_eq!(replaced.code, Some(0), "{replaced:?}");
    assert!(desk.read("code/control.c").contains("void control_init"));
}

#[test]
fn all_that_cannot_leave_is_listed_and_nothing_written() {
    let desk = desk();
    let answer = desk.call(&["export", "c", "loop.ron", "--rate", "4ms", "--out", "code"]);
    assert_eq!(answer.code, Some(3), "{answer:?}");
    let messages: String =
        answer.err.lines().filter(|line| line.starts_with("error")).map(|line| format!("{line}\n")).collect();
    expect![[r#"
        error[export]: `control/sum` (DiscreteIntegrator) samples every 0.01 s, which is not a multiple of the step of 0.004 s
        error[export]: `late` (TransportDelay) remembers what it saw over time
        error[export]: `plant` (LowPass) has a continuous state
    "#]].assert_eq(&messages);
    assert!(!desk.0.join("code").exists());
    let unknown =
        desk.call(&["export", "c", "loop.ron", "--subsystem", "contrl", "--rate", "1ms", "--out", "code"]);
    assert_eq!(unknown.code, Some(2), "{unknown:?}");
    assert!(
        unknown.err.contains("there is no subsystem `contrl`") && unknown.err.contains("it has `control`"),
        "{}",
        unknown.err
    );
    let block =
        desk.call(&["export", "c", "loop.ron", "--subsystem", "plant", "--rate", "1ms", "--out", "code"]);
    assert!(block.err.contains("`plant` is not a subsystem but a single block (LowPass)"), "{}", block.err);
}

#[test]
fn a_run_is_still_exported_by_its_name() {
    let desk = desk();
    assert_eq!(desk.call(&["run", "loop.ron", "--out", "kept", "--quiet"]).code, Some(0));
    assert_eq!(desk.call(&["export", "kept", "--csv", "table.csv"]).code, Some(0));
    assert!(desk.0.join("table.csv").exists());
    let bare = desk.call(&["export"]);
    assert_eq!(bare.code, Some(2), "{bare:?}");
}

#[test]
fn what_the_engine_runs_is_printed() {
    let desk = desk();
    let answer = desk.call(&["emit", "program", "loop.ron"]);
    assert_eq!(answer.code, Some(0), "{answer:?}");
    expect![[r#"
        major step
          program every 0.01 s, of control/sum
            %0: real = memory control/sum.x[0]           // control/sum
            %1: real = -inf                              // control/sum
            %2: real = inf                               // control/sum
            %3: real = %0 from %1 to %2                  // control/sum
            control/sum.y = %3
          program at each major step, of control/limit
            %0: real = input control/sum.y               // control/limit
            %1: real = -2.0                              // control/limit
            %2: real = 2.0                               // control/limit
            %3: real = %0 from %1 to %2                  // control/limit
            control/limit.y = %3
          call late (TransportDelay, records no law)
          program, of plant
            %0: real = state plant.x                     // plant
            plant.y = %0
          program at the start, of set
            %0: real = 1.0                               // set
            set.y = %0
          program, of control/error
            %0: real = input set.y                       // control/error
            %1: real = input late.y                      // control/error
            %2: real = %0 - %1                           // control/error
            control/error.y = %2

        outputs between major steps
          call late (TransportDelay, records no law)
          program, of plant, control/error
            %0: real = state plant.x                     // plant
            %1: real = input set.y                       // control/error
            %2: real = input late.y                      // control/error
            %3: real = %1 - %2                           // control/error
            plant.y = %0
            control/error.y = %3

        outputs for derivatives and guards: nothing

        derivatives
          program, of plant
            %0: real = input control/limit.y             // plant
            %1: real = state plant.x                     // plant
            %2: real = %0 - %1                           // plant
            %3: real = 0.2                               // plant
            %4: real = %2 / %3                           // plant
            d plant.x = %4

        guards: nothing

        updates at sample hits
          call control/sum (DiscreteIntegrator)
    "#]]
    .assert_eq(&answer.out);
}
