//! A program as statements of C.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use blocksim_block::law::{Binary, Domain, Draft, Id, Op, Relation, Root, Unary};

use super::Layout;

/// How the requirements of all programs are numbered: what each is, for the header.
#[derive(Debug, Default)]
pub(super) struct Requirements(pub Vec<String>);

/// What the code needs beside itself.
#[derive(Debug, Default)]
pub(super) struct Needs {
    /// Functions of this file: `clamp` ...
    pub helpers: BTreeSet<&'static str>,
    /// Functions of the mathematical library whose last digit is up to that.
    pub functions: BTreeSet<String>,
    /// Whether the header of the mathematical library is included.
    pub math: bool,
    /// Whether the time is read.
    pub time: bool,
}

/// Where a program stands.
pub(super) struct Place<'l> {
    pub layout: &'l Layout<'l>,
    /// What continuous states are elements of.
    pub states: &'static str,
    pub indent: &'static str,
}

impl Place<'_> {
    /// The statements of a program; `anywhere` says what each value that is wanted anywhere is assigned to.
    pub fn write(
        &self,
        draft: &Draft,
        anywhere: &[String],
        needs: &mut Needs,
        requirements: &mut Requirements,
    ) -> String {
        let ops: Vec<Op> = draft.program.instructions.iter().map(|instruction| instruction.op).collect();
        let wanted: Vec<&Root> = draft.roots.iter().filter(|root| self.is_kept(root)).collect();
        let id_of = |root: &Root| match *root {
            Root::Cell(id, _) | Root::Held(id, _) | Root::Anywhere(id) | Root::Met(id) => id,
        };
        let mut needed = vec![false; ops.len()];
        wanted.iter().for_each(|root| needed[id_of(root).0 as usize] = true);
        for at in (0..ops.len()).rev() {
            if needed[at] {
                ops[at].operands().for_each(|id| needed[id.0 as usize] = true);
            }
        }
        let mut text = String::new();
        let mut values = Values { place: self, ops: &ops, names: BTreeMap::new(), needs };
        // What is overwritten behind it is taken out of the way.
        let overwritten: BTreeSet<u32> = wanted
            .iter()
            .filter_map(|root| if let Root::Held(_, number) = root { Some(*number) } else { None })
            .collect();
        let mut block = None;
        let mut next = 0;
        for at in (0..ops.len()).filter(|at| needed[*at]) {
            let id = Id(at as u32);
            let is_copied = matches!(ops[at], Op::Memory(number) if overwritten.contains(&number));
            if ops[at].is_leaf() && !is_copied {
                continue;
            }
            let of = draft.program.instructions[at].block;
            if of != block && !is_copied {
                block = of;
                if let Some(of) = of {
                    let _ = writeln!(text, "{}/* {} */", self.indent, self.layout.title(of as usize));
                }
            }
            if let Op::Require(domain, holds, _) = ops[at] {
                let path = of.map_or(String::new(), |of| self.layout.path(of as usize));
                requirements.0.push(format!("{path}: {}", wanted_of(domain)));
                let number = requirements.0.len();
                let holds = values.truth(holds);
                let _ =
                    writeln!(text, "{}if (!{holds} && status == 0) {{ status = {number}; }}", self.indent);
                continue;
            }
            let (kind, expression) =
                if is_copied { (self.layout.real, values.leaf(ops[at])) } else { values.expression(ops[at]) };
            let name = format!("v{next}");
            next += 1;
            let _ = writeln!(text, "{}const {kind} {name} = {expression};", self.indent);
            values.names.insert(id.0, name);
        }
        let mut places = anywhere.iter();
        for root in wanted {
            let (to, id) = match *root {
                Root::Cell(id, cell) => (self.layout.signal(cell as usize), id),
                Root::Held(id, number) => (self.layout.memory(number as usize), id),
                Root::Anywhere(id) => (places.next().cloned().unwrap_or_default(), id),
                Root::Met(_) => continue,
            };
            let value = values.number(id);
            let _ = writeln!(text, "{}{to} = {};", self.indent, bare(&value));
        }
        text
    }

    /// Whether anybody reads what a root says.
    fn is_kept(&self, root: &Root) -> bool {
        match *root {
            Root::Cell(_, cell) => self.layout.keeps(cell as usize),
            Root::Held(_, number) => self.layout.memories.contains_key(&(number as usize)),
            _ => true,
        }
    }
}

fn wanted_of(domain: Domain) -> String {
    match domain {
        Domain::NotZero => "a division by zero".to_owned(),
        domain => format!("a number must be {}", domain.wanted()),
    }
}

/// Without parentheses around the whole.
fn bare(text: &str) -> &str {
    let inner = text.strip_prefix('(').and_then(|rest| rest.strip_suffix(')'));
    inner.filter(|inner| !inner.contains(['(', ')'])).unwrap_or(text)
}

struct Values<'v> {
    place: &'v Place<'v>,
    ops: &'v [Op],
    names: BTreeMap<u32, String>,
    needs: &'v mut Needs,
}

impl Values<'_> {
    fn layout(&self) -> &Layout<'_> {
        self.place.layout
    }

    /// A value from outside.
    fn leaf(&mut self, op: Op) -> String {
        match op {
            Op::Constant(bits) => {
                let value = f64::from_bits(bits);
                self.needs.math |= !value.is_finite();
                self.layout().literal(value)
            }
            Op::Time => {
                self.needs.time = true;
                "t".to_owned()
            }
            Op::Input(cell) => self.layout().read(cell as usize),
            Op::State(number) => format!("{}[{}]", self.place.states, self.layout().state(number as usize)),
            Op::Memory(number) => self.layout().memory(number as usize),
            _ => String::new(),
        }
    }

    fn is_truth(&self, id: Id) -> bool {
        matches!(self.ops[id.0 as usize], Op::Compare(..) | Op::Not(_) | Op::And(..) | Op::Or(..))
    }

    fn raw(&mut self, id: Id) -> String {
        match self.names.get(&id.0) {
            Some(name) => name.clone(),
            None => self.leaf(self.ops[id.0 as usize]),
        }
    }

    /// A value as a number.
    fn number(&mut self, id: Id) -> String {
        let raw = self.raw(id);
        if self.is_truth(id) { format!("({}){raw}", self.layout().real) } else { raw }
    }

    /// A value as a condition.
    fn truth(&mut self, id: Id) -> String {
        let raw = self.raw(id);
        if self.is_truth(id) { raw } else { format!("({raw} != {})", self.layout().literal(0.0)) }
    }

    fn call(&mut self, name: &str, is_exact: bool) -> String {
        self.needs.math = true;
        let name = if self.layout().is_single() { format!("{name}f") } else { name.to_owned() };
        if !is_exact {
            self.needs.functions.insert(name.clone());
        }
        name
    }

    fn helper(&mut self, name: &'static str) -> &'static str {
        self.needs.helpers.insert(name);
        name
    }

    /// Type and text of an operation.
    fn expression(&mut self, op: Op) -> (&'static str, String) {
        let real = self.layout().real;
        let text = match op {
            Op::Neg(a) => format!("-{}", self.number(a)),
            Op::Add(a, b) => format!("{} + {}", self.number(a), self.number(b)),
            Op::Sub(a, b) => format!("{} - {}", self.number(a), self.number(b)),
            Op::Mul(a, b) => format!("{} * {}", self.number(a), self.number(b)),
            Op::Div(a, b) => format!("{} / {}", self.number(a), self.number(b)),
            Op::Power(a, n) => format!("{}({}, {n})", self.helper("power"), bare(&self.number(a))),
            Op::Unary(Unary::Sign, a) => format!("{}({})", self.helper("sign"), bare(&self.number(a))),
            Op::Unary(function, a) => {
                let (name, is_exact) = function_name(function);
                let name = self.call(name, is_exact);
                format!("{name}({})", bare(&self.number(a)))
            }
            Op::Binary(function, a, b) => {
                let name = match function {
                    Binary::Min => self.helper("minimum").to_owned(),
                    Binary::Max => self.helper("maximum").to_owned(),
                    Binary::Pow => self.call("pow", false),
                    Binary::Hypot => self.call("hypot", false),
                    Binary::Atan2 => self.call("atan2", false),
                };
                let (a, b) = (self.number(a), self.number(b));
                format!("{name}({}, {})", bare(&a), bare(&b))
            }
            Op::Clamp(a, lower, upper) => {
                let name = self.helper("clamp");
                let [a, lower, upper] = [a, lower, upper].map(|id| self.number(id));
                format!("{name}({}, {}, {})", bare(&a), bare(&lower), bare(&upper))
            }
            Op::Compare(relation, a, b) => {
                let sign = match relation {
                    Relation::Less => "<",
                    Relation::LessEqual => "<=",
                    Relation::Greater => ">",
                    Relation::GreaterEqual => ">=",
                    Relation::Equal => "==",
                    Relation::NotEqual => "!=",
                };
                return ("bool", format!("{} {sign} {}", self.number(a), self.number(b)));
            }
            Op::Not(a) => return ("bool", format!("!{}", self.truth(a))),
            Op::And(a, b) => return ("bool", format!("{} && {}", self.truth(a), self.truth(b))),
            Op::Or(a, b) => return ("bool", format!("{} || {}", self.truth(a), self.truth(b))),
            Op::Select(condition, a, b) => {
                let condition = self.truth(condition);
                format!("{condition} ? {} : {}", self.number(a), self.number(b))
            }
            leaf => self.leaf(leaf),
        };
        (real, text)
    }
}

/// The function of C, and whether its result is exact or rounded correctly in any library.
fn function_name(function: Unary) -> (&'static str, bool) {
    match function {
        Unary::Abs => ("fabs", true),
        Unary::Sign => ("sign", true),
        Unary::Sqrt => ("sqrt", true),
        Unary::Exp => ("exp", false),
        Unary::Ln => ("log", false),
        Unary::Log10 => ("log10", false),
        Unary::Sin => ("sin", false),
        Unary::Cos => ("cos", false),
        Unary::Tan => ("tan", false),
        Unary::Asin => ("asin", false),
        Unary::Acos => ("acos", false),
        Unary::Atan => ("atan", false),
        Unary::Sinh => ("sinh", false),
        Unary::Cosh => ("cosh", false),
        Unary::Tanh => ("tanh", false),
        Unary::Floor => ("floor", true),
        Unary::Ceil => ("ceil", true),
        Unary::Round => ("round", true),
    }
}

/// The text of the functions of this file, in single or double precision.
pub(super) fn helper(name: &str, real: &str, literal: &dyn Fn(f64) -> String) -> String {
    let (zero, one) = (literal(0.0), literal(1.0));
    match name {
        "clamp" => format!(
            "/* What is not a number stays so. */\n\
             static {real} clamp({real} u, {real} lower, {real} upper)\n{{\n    \
             return u > upper ? upper : (u < lower ? lower : u);\n}}\n"
        ),
        "sign" => format!(
            "static {real} sign({real} u)\n{{\n    \
             return u > {zero} ? {one} : (u < {zero} ? -{one} : u);\n}}\n"
        ),
        "minimum" => format!(
            "/* Not a number if one of both is not. */\n\
             static {real} minimum({real} a, {real} b)\n{{\n    return (b < a || b != b) ? b : a;\n}}\n"
        ),
        "maximum" => format!(
            "/* Not a number if one of both is not. */\n\
             static {real} maximum({real} a, {real} b)\n{{\n    return (b > a || b != b) ? b : a;\n}}\n"
        ),
        _ => format!(
            "/* By repeated squaring. */\n\
             static {real} power({real} base, int n)\n{{\n    \
             unsigned int left = n < 0 ? 0u - (unsigned int)n : (unsigned int)n;\n    \
             {real} square = base;\n    {real} product = {one};\n    \
             while (left > 0u) {{\n        \
             if ((left & 1u) == 1u) {{\n            product *= square;\n        }}\n        \
             left >>= 1;\n        \
             if (left > 0u) {{\n            square *= square;\n        }}\n    }}\n    \
             return n < 0 ? {one} / product : product;\n}}\n"
        ),
    }
}
