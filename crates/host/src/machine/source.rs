//! The tapes of a simulation as one source in C, for this computer: the same bits, without an interpreter.

use std::collections::{BTreeMap, HashMap};
use std::fmt::Write;

use blocksim_block::law::{Binary, Relation, Tape, Unary, Word, WordCode};

/// What the functions of [`source`] are called before their number.
pub(super) const FUNCTION: &str = "blocksim_tape_";

/// Instructions of one function: the time for compiling grows linearly with their number, and faster with the length of functions.
const CHUNK: usize = 300;

/// What all functions need.
const HEAD: &str = "\
#include <math.h>

struct ran { double about; long failed; int changed; };

static inline double power(double base, int n) {
    unsigned left = n < 0 ? 0u - (unsigned)n : (unsigned)n;
    double square = base, product = 1.0;
    while (left > 0) {
        if (left & 1) { product *= square; }
        left >>= 1;
        if (left > 0) { square *= square; }
    }
    return n < 0 ? 1.0 / product : product;
}
";

/// A source in C99 with a function for each tape, `void NAME(double *cells, double *held, struct ran *ran)`, named
/// [`FUNCTION`] and the number of the tape. It is to be compiled without contraction of products and sums, and without
/// knowledge of the functions of the mathematical library, which the interpreter calls as well.
pub(super) fn source(tapes: &[&Tape]) -> String {
    let mut text = HEAD.to_owned();
    for (number, tape) in tapes.iter().enumerate() {
        let words = tape.words().iter().enumerate();
        let reads = words.flat_map(|(at, word)| [word.a, word.b, word.c].map(|cell| (cell, at)));
        let last_reads: HashMap<u32, usize> = reads.collect();
        for (part, words) in tape.words().chunks(CHUNK).enumerate() {
            // What only this function reads need not be written.
            let is_read_behind =
                |cell: &u32| last_reads.get(cell).is_some_and(|at| *at >= (part + 1) * CHUNK);
            let is_written = |cell: u32| tape.is_result(cell) || is_read_behind(&cell);
            let _ = writeln!(
                text,
                "\nstatic void tape_{number}_{part}(double *restrict c, double *restrict h, struct ran *restrict ran) {{"
            );
            text.push_str(&statements(words, part * CHUNK, is_written));
            text.push_str("}\n");
        }
        let _ = writeln!(
            text,
            "\nvoid {FUNCTION}{number}(double *c, double *h, struct ran *ran) {{\n    ran->failed = -1;\n    \
             ran->changed = 0;\n    ran->about = 0.0;"
        );
        for part in 0..tape.len().div_ceil(CHUNK) {
            let _ = writeln!(text, "    tape_{number}_{part}(c, h, ran);");
        }
        text.push_str("}\n");
    }
    text
}

fn statements(words: &[Word], first: usize, is_written: impl Fn(u32) -> bool) -> String {
    // What a cell that has been written in here holds, by name.
    let mut names: BTreeMap<u32, String> = BTreeMap::new();
    let mut text = String::from("    (void)c;\n    (void)h;\n    (void)ran;\n");
    for (at, word) in words.iter().enumerate() {
        let Word { code, to, a, b, .. } = *word;
        let r = |cell: u32| names.get(&cell).cloned().unwrap_or_else(|| format!("c[{cell}]"));
        match code {
            WordCode::Hold => {
                let value = r(a);
                let _ = writeln!(text, "    ran->changed |= !(h[{to}] == {value});\n    h[{to}] = {value};");
            }
            WordCode::Require => {
                let (holds, about, number) = (r(a), r(b), first + at);
                let _ = writeln!(
                    text,
                    "    if ({holds} == 0.0 && ran->failed < 0) {{ ran->failed = {number}; ran->about = {about}; }}"
                );
            }
            _ => {
                let value = expression(word, r);
                let _ = writeln!(text, "    const double v{at} = {value};");
                if is_written(to) {
                    let _ = writeln!(text, "    c[{to}] = v{at};");
                }
                names.insert(to, format!("v{at}"));
            }
        }
    }
    text
}

/// The value of a word that has one, of operands by their cells.
fn expression(word: &Word, r: impl Fn(u32) -> String) -> String {
    let Word { code, a, b, c, .. } = *word;
    match code {
        WordCode::Copy => r(a),
        WordCode::Load => format!("h[{a}]"),
        WordCode::Neg => format!("-{}", r(a)),
        WordCode::Add => format!("{} + {}", r(a), r(b)),
        WordCode::Sub => format!("{} - {}", r(a), r(b)),
        WordCode::Mul => format!("{} * {}", r(a), r(b)),
        WordCode::Div => format!("{} / {}", r(a), r(b)),
        WordCode::MulAdd => format!("{} + {} * {}", r(c), r(a), r(b)),
        WordCode::MulSub => format!("{} * {} - {}", r(a), r(b), r(c)),
        WordCode::SubMul => format!("{} - {} * {}", r(c), r(a), r(b)),
        WordCode::Power => format!("power({}, {})", r(a), b as i32),
        WordCode::Clamp => {
            let (u, lower, upper) = (r(a), r(b), r(c));
            format!("{u} > {upper} ? {upper} : {u} < {lower} ? {lower} : {u}")
        }
        WordCode::Unary(function) => unary(function, &r(a)),
        WordCode::Binary(function) => binary(function, &r(a), &r(b)),
        WordCode::Compare(relation) => format!("(double)({} {} {})", r(a), sign(relation), r(b)),
        WordCode::Not => format!("(double)({} == 0.0)", r(a)),
        WordCode::And => format!("(double)({} != 0.0 && {} != 0.0)", r(a), r(b)),
        WordCode::Or => format!("(double)({} != 0.0 || {} != 0.0)", r(a), r(b)),
        WordCode::Select => format!("{} != 0.0 ? {} : {}", r(a), r(b), r(c)),
        // They have no value.
        WordCode::Hold | WordCode::Require => "0.0".to_owned(),
    }
}

fn sign(relation: Relation) -> &'static str {
    match relation {
        Relation::Less => "<",
        Relation::LessEqual => "<=",
        Relation::Greater => ">",
        Relation::GreaterEqual => ">=",
        Relation::Equal => "==",
        Relation::NotEqual => "!=",
    }
}

fn unary(function: Unary, u: &str) -> String {
    let name = match function {
        Unary::Sign => return format!("({u} == 0.0 || {u} != {u}) ? {u} : {u} < 0.0 ? -1.0 : 1.0"),
        // These are instructions and the same everywhere.
        Unary::Abs => "__builtin_fabs",
        Unary::Sqrt => "__builtin_sqrt",
        Unary::Exp => "exp",
        Unary::Ln => "log",
        Unary::Log10 => "log10",
        Unary::Sin => "sin",
        Unary::Cos => "cos",
        Unary::Tan => "tan",
        Unary::Asin => "asin",
        Unary::Acos => "acos",
        Unary::Atan => "atan",
        Unary::Sinh => "sinh",
        Unary::Cosh => "cosh",
        Unary::Tanh => "tanh",
        Unary::Floor => "floor",
        Unary::Ceil => "ceil",
        Unary::Round => "round",
    };
    format!("{name}({u})")
}

fn binary(function: Binary, a: &str, b: &str) -> String {
    match function {
        Binary::Min => format!("({b} < {a} || {b} != {b}) ? {b} : {a}"),
        Binary::Max => format!("({b} > {a} || {b} != {b}) ? {b} : {a}"),
        Binary::Pow => format!("pow({a}, {b})"),
        Binary::Hypot => format!("hypot({a}, {b})"),
        Binary::Atan2 => format!("atan2({a}, {b})"),
    }
}
