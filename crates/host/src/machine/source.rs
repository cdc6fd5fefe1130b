//! The tapes of a simulation as sources in C, for this computer: the same bits, without an interpreter.

use std::collections::{HashMap, HashSet};
use std::fmt::Write;

use blocksim_block::law::{Binary, Relation, Tape, Unary, Word, WordCode};

/// What the functions of the tapes are called before their number.
pub(super) const FUNCTION: &str = "blocksim_tape_";

/// Instructions of one function: the time for compiling grows linearly with their number, and faster with the length of functions.
const CHUNK: usize = 300;

/// Instructions that take a compiler as long as what each function takes beside its own.
const HEADING: usize = 8;

/// What all functions need. The functions of parts are called within the library alone.
const HEAD: &str = "\
#include <math.h>

struct ran { double about; long failed; int changed; };

#if defined(__GNUC__)
#define PART __attribute__((visibility(\"hidden\")))
#else
#define PART
#endif

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

/// Tapes as functions in C99: for each tape one `void NAME(double *cells, double *held, struct ran *ran)`, named [`FUNCTION`] and the
/// number of the tape. They are to be compiled without contraction of products and sums, and without knowledge of the functions of
/// the mathematical library, which the interpreter calls as well.
pub(super) struct Source {
    functions: Vec<Text>,
}

/// A function.
struct Text {
    body: String,
    /// How long it takes to compile, in instructions.
    cost: usize,
    /// What it calls: the number of a tape, and of how many parts.
    calls: Option<(usize, usize)>,
}

impl Source {
    /// The functions of these tapes: of a long one its parts and one that calls them.
    pub fn new(tapes: &[&Tape]) -> Self {
        let mut functions = Vec::new();
        for (number, tape) in tapes.iter().enumerate() {
            let stores = stores(tape);
            let parts = tape.len().div_ceil(CHUNK);
            for (part, words) in tape.words().chunks(CHUNK).enumerate() {
                let name = if parts == 1 { format!("{FUNCTION}{number}") } else { part_name(number, part) };
                let first = part * CHUNK;
                let mut body = heading(if parts == 1 { "" } else { "PART " }, &name);
                body.push_str(&statements(words, first, &stores[first..]));
                body.push_str("}\n");
                functions.push(Text { body, cost: HEADING + words.len(), calls: None });
            }
            if parts != 1 {
                let mut body = heading("", &format!("{FUNCTION}{number}"));
                for part in 0..parts {
                    let _ = writeln!(body, "    {}(c, h, ran);", part_name(number, part));
                }
                body.push_str("}\n");
                functions.push(Text { body, cost: HEADING + parts, calls: Some((number, parts)) });
            }
        }
        Self { functions }
    }

    /// All of it as one file, which says what the machine code is made of.
    pub fn whole(&self) -> String {
        file(&self.functions)
    }

    /// How long it takes to compile, in instructions.
    pub fn cost(&self) -> usize {
        self.functions.iter().map(|function| function.cost).sum()
    }

    /// The same as so many files that take about as long each, or as fewer; no function needs to be in the file of another one.
    pub fn files(&self, count: usize) -> Vec<String> {
        let mut files = Vec::new();
        let (mut left, mut rest) = (self.cost(), &self.functions[..]);
        while !rest.is_empty() || files.is_empty() {
            let share = left / count.saturating_sub(files.len()).max(1);
            let (mut cost, mut end) = (0, 0);
            // Up to where the share is nearest.
            while end < rest.len() && (end == 0 || cost + rest[end].cost / 2 <= share) {
                cost += rest[end].cost;
                end += 1;
            }
            // Nothing is left over behind the last one.
            if files.len() + 1 >= count {
                (cost, end) = (left, rest.len());
            }
            files.push(file(&rest[..end]));
            (left, rest) = (left - cost, &rest[end..]);
        }
        files
    }
}

fn part_name(number: usize, part: usize) -> String {
    format!("blocksim_part_{number}_{part}")
}

fn heading(visibility: &str, name: &str) -> String {
    format!(
        "\n{visibility}void {name}(double *restrict c, double *restrict h, struct ran *restrict ran) {{\n"
    )
}

/// A file of functions, with those of other files declared.
fn file(functions: &[Text]) -> String {
    let mut text = HEAD.to_owned();
    for (number, parts) in functions.iter().filter_map(|function| function.calls) {
        for part in 0..parts {
            let _ =
                writeln!(text, "PART void {}(double *, double *, struct ran *);", part_name(number, part));
        }
    }
    functions.iter().for_each(|function| text.push_str(&function.body));
    text
}

/// Which words write their cell to memory: the last one of its part to write what is a result, or what a later part reads.
fn stores(tape: &Tape) -> Vec<bool> {
    let mut stores = vec![false; tape.len()];
    // Cells that somebody reads behind a word before they are written again.
    let mut read_behind: HashSet<u32> = HashSet::new();
    for (part, words) in tape.words().chunks(CHUNK).enumerate().rev() {
        let read_by_others = read_behind.clone();
        let mut written = HashSet::new();
        for (at, word) in words.iter().enumerate().rev() {
            if let Some(cell) = word.writes() {
                let is_last = written.insert(cell);
                stores[part * CHUNK + at] =
                    is_last && (tape.is_result(cell) || read_by_others.contains(&cell));
                read_behind.remove(&cell);
            }
            read_behind.extend(word.reads());
        }
    }
    stores
}

/// The words of a part, of which the first one has this number in its tape.
fn statements(words: &[Word], first: usize, stores: &[bool]) -> String {
    // Which word has written a cell last in here.
    let mut writers: HashMap<u32, usize> = HashMap::new();
    let mut text = String::new();
    for (at, word) in words.iter().enumerate() {
        let Word { code, to, a, b, .. } = *word;
        let r = |cell: u32| match writers.get(&cell) {
            Some(word) => format!("v{word}"),
            None => format!("c[{cell}]"),
        };
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
                let store = if stores[at] { format!("c[{to}] = ") } else { String::new() };
                let _ = writeln!(text, "    const double v{at} = {store}{value};");
                writers.insert(to, at);
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
