//! Random expressions: the program against a walk over the tree, bit by bit, and its slopes against differences.

use blocksim_law::{Code, Leaf, Op, Program, Recorder, Relation, Root, Sources, Tape, Value, passes, slopes};

/// Numbers from a seed (xorshift).
pub struct Dice(pub u64);

impl Dice {
    pub fn below(&mut self, n: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) % n
    }

    /// From -3 to 3 in steps of 1/64, so that equal numbers and zeros occur.
    pub fn number(&mut self) -> f64 {
        self.below(385) as f64 / 64.0 - 3.0
    }
}

/// An expression as people draw it.
#[derive(Debug)]
enum Tree {
    Number(f64),
    Input(usize),
    Parameter(usize),
    One(&'static str, Box<Tree>),
    Two(&'static str, Box<Tree>, Box<Tree>),
    Whole(Box<Tree>, i32),
    If(&'static str, Box<[Tree; 4]>),
}

const ONE: [&str; 14] =
    ["neg", "sqrt", "exp", "ln", "log10", "sin", "cos", "tan", "asin", "atan", "sinh", "cosh", "tanh", "abs"];
const STEPS: [&str; 4] = ["sign", "floor", "ceil", "round"];
const TWO: [&str; 9] = ["+", "-", "*", "/", "min", "max", "pow", "hypot", "atan2"];
const RELATIONS: [&str; 6] = ["<", "<=", ">", ">=", "==", "!="];

fn tree(dice: &mut Dice, depth: u32) -> Tree {
    let inner = |dice: &mut Dice| Box::new(tree(dice, depth.saturating_sub(1)));
    match dice.below(if depth == 0 { 3 } else { 12 }) {
        0 => Tree::Number(dice.number()),
        1 => Tree::Input(dice.below(3) as usize),
        2 => Tree::Parameter(dice.below(2) as usize),
        3..6 => Tree::One(ONE[dice.below(14) as usize], inner(dice)),
        6 => Tree::One(STEPS[dice.below(4) as usize], inner(dice)),
        7 => Tree::Whole(inner(dice), dice.below(9) as i32 - 4),
        8 => {
            let relation = RELATIONS[dice.below(6) as usize];
            Tree::If(relation, Box::new([(); 4].map(|()| *inner(dice))))
        }
        _ => Tree::Two(TWO[dice.below(9) as usize], inner(dice), inner(dice)),
    }
}

fn compares(relation: &str, a: f64, b: f64) -> bool {
    match relation {
        "<" => a < b,
        "<=" => a <= b,
        ">" => a > b,
        ">=" => a >= b,
        "==" => a == b,
        _ => a != b,
    }
}

/// The value by a walk over the tree.
fn walk(tree: &Tree, u: &[f64], p: &[f64]) -> f64 {
    match tree {
        Tree::Number(value) => *value,
        Tree::Input(i) => u[*i],
        Tree::Parameter(i) => p[*i],
        Tree::One(name, a) => {
            let a = walk(a, u, p);
            match *name {
                "neg" => -a,
                "sqrt" => a.sqrt(),
                "exp" => a.exp(),
                "ln" => a.ln(),
                "log10" => a.log10(),
                "sin" => a.sin(),
                "cos" => a.cos(),
                "tan" => a.tan(),
                "asin" => a.asin(),
                "atan" => a.atan(),
                "sinh" => a.sinh(),
                "cosh" => a.cosh(),
                "tanh" => a.tanh(),
                "abs" => a.abs(),
                "sign" if a > 0.0 => 1.0,
                "sign" if a < 0.0 => -1.0,
                "sign" => a,
                "floor" => a.floor(),
                "ceil" => a.ceil(),
                _ => a.round(),
            }
        }
        Tree::Two(name, a, b) => {
            let (a, b) = (walk(a, u, p), walk(b, u, p));
            let nan = a.is_nan() || b.is_nan();
            match *name {
                "+" => a + b,
                "-" => a - b,
                "*" => a * b,
                "/" => a / b,
                "min" | "max" if nan => f64::NAN,
                "min" => {
                    if a <= b {
                        a
                    } else {
                        b
                    }
                }
                "max" => {
                    if a >= b {
                        a
                    } else {
                        b
                    }
                }
                "pow" => a.powf(b),
                "hypot" => a.hypot(b),
                _ => a.atan2(b),
            }
        }
        Tree::Whole(a, n) => {
            // Square and multiply from the lowest bit, as the law promises.
            let a = walk(a, u, p);
            let product = whole(a, n.unsigned_abs());
            if *n < 0 { 1.0 / product } else { product }
        }
        Tree::If(relation, parts) => {
            let [a, b, c, d] = &**parts;
            if compares(relation, walk(a, u, p), walk(b, u, p)) { walk(c, u, p) } else { walk(d, u, p) }
        }
    }
}

fn whole(a: f64, n: u32) -> f64 {
    match n {
        0 => 1.0,
        1 => a,
        2 => a * a,
        3 => a * (a * a),
        _ => (a * a) * (a * a),
    }
}

fn record<'r>(tree: &Tree, u: &[Value<'r>], p: &[Value<'r>], recorder: &'r Recorder) -> Value<'r> {
    let of = |tree: &Tree| record(tree, u, p, recorder);
    match tree {
        Tree::Number(value) => recorder.constant(*value),
        Tree::Input(i) => u[*i],
        Tree::Parameter(i) => p[*i],
        Tree::One(name, a) => {
            let a = of(a);
            match *name {
                "neg" => -a,
                "sqrt" => a.sqrt(),
                "exp" => a.exp(),
                "ln" => a.ln(),
                "log10" => a.log10(),
                "sin" => a.sin(),
                "cos" => a.cos(),
                "tan" => a.tan(),
                "asin" => a.asin(),
                "atan" => a.atan(),
                "sinh" => a.sinh(),
                "cosh" => a.cosh(),
                "tanh" => a.tanh(),
                "abs" => a.abs(),
                "sign" => a.sign(),
                "floor" => a.floor(),
                "ceil" => a.ceil(),
                _ => a.round(),
            }
        }
        Tree::Two(name, a, b) => {
            let (a, b) = (of(a), of(b));
            match *name {
                "+" => a + b,
                "-" => a - b,
                "*" => a * b,
                "/" => a / b,
                "min" => a.min(b),
                "max" => a.max(b),
                "pow" => a.pow(b),
                "hypot" => a.hypot(b),
                _ => a.atan2(b),
            }
        }
        Tree::Whole(a, n) => of(a).powi(*n),
        Tree::If(relation, parts) => {
            let [a, b, c, d] = &**parts;
            let relation = match *relation {
                "<" => Relation::Less,
                "<=" => Relation::LessEqual,
                ">" => Relation::Greater,
                ">=" => Relation::GreaterEqual,
                "==" => Relation::Equal,
                _ => Relation::NotEqual,
            };
            let condition = of(a).is(relation, of(b));
            recorder.enter(condition);
            let first = of(c);
            recorder.leave();
            recorder.enter(!condition);
            let second = of(d);
            recorder.leave();
            condition.select(first, second)
        }
    }
}

fn program(tree: &Tree, p: [f64; 2]) -> Program {
    let recorder = Recorder::new();
    let u = ["u1", "u2", "u3"].map(|name| recorder.input(name));
    let parameters = [recorder.parameter("p", p[0]), recorder.parameter("q", p[1])];
    let y = record(tree, &u, &parameters, &recorder);
    recorder.output("y", y);
    recorder.finish()
}

/// The output where modes are chosen anew, as at a major step.
fn value(program: &Program, u: &[f64], p: &[f64]) -> f64 {
    let mut modes = vec![0.0; program.modes.len()];
    let released = passes::release_modes(program.clone());
    let chosen = Code::new(&released, &released.mode_values());
    let mut registers = vec![f64::NAN; chosen.registers()];
    chosen.run(&Sources { inputs: u, parameters: p, ..Sources::default() }, &mut registers);
    modes.iter_mut().enumerate().for_each(|(i, mode)| *mode = chosen.result(&registers, i));
    let code = Code::new(program, &program.output_values());
    let mut registers = vec![f64::NAN; code.registers()];
    code.run(&Sources { inputs: u, parameters: p, modes: &modes, ..Sources::default() }, &mut registers);
    code.result(&registers, 0)
}

fn same(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan()
}

#[test]
fn programs_and_all_passes_give_the_bits_of_a_walk_over_the_tree() {
    let mut dice = Dice(0x9E37_79B9_7F4A_7C15);
    let (mut numbers, mut shorter) = (0, 0);
    for case in 0..3000 {
        let tree = tree(&mut dice, 1 + case % 7);
        let p = [dice.number(), dice.number()];
        let raw = program(&tree, p);
        let bound = passes::bind_parameters(raw.clone());
        let stages = [
            passes::fold_constants(raw.clone()),
            passes::share_equal(raw.clone()),
            passes::drop_unused(raw.clone()),
            bound.clone(),
            bound.clone().optimised(),
            raw.clone().optimised(),
            raw.clone(),
        ];
        shorter += usize::from(bound.optimised().instructions.len() < raw.instructions.len());
        for _ in 0..5 {
            let u = [dice.number(), dice.number(), dice.number()];
            let expected = walk(&tree, &u, &p);
            numbers += usize::from(expected.is_finite());
            for (stage, program) in stages.iter().enumerate() {
                let found = value(program, &u, &p);
                assert!(
                    same(found, expected),
                    "{stage}: {found} for {expected}, {u:?}, {p:?}\n{tree:?}\n{program}"
                );
            }
        }
    }
    assert!(
        numbers > 5000 && shorter > 1500,
        "{numbers} results are numbers, {shorter} programs became shorter"
    );
}

#[test]
fn passes_that_are_done_change_nothing_more() {
    let mut dice = Dice(77);
    for case in 0..300 {
        let tree = tree(&mut dice, 1 + case % 6);
        let once = passes::bind_parameters(program(&tree, [1.5, -0.25])).optimised();
        assert_eq!(once.clone().optimised(), once, "{tree:?}");
    }
}

#[test]
fn slopes_agree_with_differences_where_the_law_is_smooth() {
    let mut dice = Dice(4711);
    let mut compared = 0;
    for case in 0..3000 {
        let tree = tree(&mut dice, 1 + case % 4);
        let p = [1.25, -0.5];
        let program = program(&tree, p);
        let u = [0.731 + dice.number() / 5.0, -0.417 + dice.number() / 5.0, 1.113];
        let at = |u: &[f64]| walk(&tree, u, &p);
        let mut modes = vec![0.0; program.modes.len()];
        let released = passes::release_modes(program.clone());
        let chosen = Code::new(&released, &released.mode_values());
        let mut registers = vec![0.0; chosen.registers()];
        chosen.run(&Sources { inputs: &u, parameters: &p, ..Sources::default() }, &mut registers);
        modes.iter_mut().enumerate().for_each(|(i, mode)| *mode = chosen.result(&registers, i));
        let sources = Sources { inputs: &u, parameters: &p, modes: &modes, ..Sources::default() };
        // Where the law has no value, it has no slope.
        let checked = Code::new(&program, &program.requirements);
        let mut registers = vec![0.0; checked.registers()];
        if checked.run(&sources, &mut registers).is_some() {
            continue;
        }
        let exact = &slopes(&program, &sources)[0];
        for (i, exact) in exact.iter().enumerate() {
            let difference = |h: f64| {
                let (mut above, mut below) = (u, u);
                above[i] += h;
                below[i] -= h;
                (at(&above) - at(&below)) / (2.0 * h)
            };
            // Richardson's extrapolation, and whether it is to be trusted: kinks and poles are near where it is not.
            let (coarse, fine, finer) = (difference(1e-3), difference(5e-4), difference(2.5e-4));
            let better = |fine: f64, coarse: f64| (4.0 * fine - coarse) / 3.0;
            let (first, second) = (better(fine, coarse), better(finer, fine));
            if !(first - second).is_finite()
                || (first - second).abs() > 1e-7 * (1.0 + second.abs())
                || at(&u).abs() > 1e3
            {
                continue;
            }
            compared += 1;
            assert!(
                (exact - second).abs() < 1e-5 * (1.0 + second.abs()),
                "{exact} for {second}: {tree:?} at {u:?}"
            );
        }
    }
    assert!(compared > 3000, "{compared}");
}

#[test]
fn tapes_write_where_they_are_told_also_over_what_they_read() {
    let mut dice = Dice(0x51_7C_C1_B7_27_22_0A_95);
    let mut overwritten = 0;
    for case in 0..1000 {
        let recorder = Recorder::new();
        let u = ["u1", "u2", "u3"].map(|name| recorder.input(name));
        let held = [recorder.memory("d1", 0.0), recorder.memory("d2", 0.0)];
        let count = 1 + dice.below(5);
        for k in 0..count {
            let tree = tree(&mut dice, 1 + case % 5);
            recorder.output(&format!("y{k}"), record(&tree, &u, &held, &recorder));
        }
        let program = passes::release_modes(recorder.finish()).optimised();
        let (inputs, memories) = ([(); 3].map(|()| dice.number()), [(); 2].map(|()| dice.number()));
        let code = Code::new(&program, &program.output_values());
        let mut registers = vec![f64::NAN; code.registers()];
        let sources = Sources { inputs: &inputs, memories: &memories, ..Sources::default() };
        code.run(&sources, &mut registers);

        // Cells 0 to 2 are the inputs, 3 to 9 are free, 10 and up hold constants and what is computed on the way.
        let ops: Vec<Op> = program.instructions.iter().map(|instruction| instruction.op).collect();
        let mut constants: Vec<u64> = Vec::new();
        for op in &ops {
            if let Op::Constant(bits) = op
                && !constants.contains(bits)
            {
                constants.push(*bits);
            }
        }
        let place =
            |bits: u64| 10 + constants.iter().position(|known| *known == bits).expect("a constant") as u32;
        let leaf = |op: Op| match op {
            Op::Input(i) => Leaf::Cell(i),
            Op::Memory(i) => Leaf::Held(i),
            Op::Constant(bits) => Leaf::Cell(place(bits)),
            other => panic!("{other:?} comes from nowhere"),
        };
        let mut free: Vec<u32> = (0..10).collect();
        let mut roots: Vec<Root> = Vec::new();
        let mut to_held = vec![0, 1];
        for id in program.output_values() {
            roots.push(match dice.below(4) {
                0 if !to_held.is_empty() => Root::Held(id, to_held.remove(0)),
                1 => Root::Anywhere(id),
                _ => Root::Cell(id, free.remove(dice.below(free.len() as u64) as usize)),
            });
        }
        overwritten += roots.iter().filter(|root| matches!(root, Root::Cell(_, 0..3))).count();
        let made = Tape::make(&ops, &roots, &leaf, 10 + constants.len() as u32);
        let mut cells = vec![f64::NAN; made.end as usize];
        cells[..3].copy_from_slice(&inputs);
        constants.iter().for_each(|bits| cells[place(*bits) as usize] = f64::from_bits(*bits));
        let mut now = memories;
        made.tape.run(&mut cells, &mut now);
        let mut anywhere = made.places.iter();
        for (k, root) in roots.iter().enumerate() {
            let found = match root {
                Root::Cell(_, cell) => cells[*cell as usize],
                Root::Held(_, number) => now[*number as usize],
                Root::Anywhere(_) | Root::Met(_) => cells[*anywhere.next().expect("a place") as usize],
            };
            let wanted = code.result(&registers, k);
            assert!(
                same(found, wanted),
                "case {case}, {root:?}: {found} in the place of {wanted}\n{program}"
            );
        }
    }
    assert!(overwritten > 300, "only {overwritten} inputs were overwritten");
}
