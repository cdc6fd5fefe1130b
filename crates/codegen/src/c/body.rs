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
    /// Functions of this file: `clamp` ..., and whether they are those that stay in double precision.
    pub helpers: BTreeSet<(&'static str, bool)>,
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
        let is_single = self.layout.is_single();
        let wide = if is_single { self.layout.wide.values(draft) } else { vec![false; ops.len()] };
        let mut values = Values { place: self, ops: &ops, wide: &wide, names: BTreeMap::new(), needs };
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
            let (kind, expression) = if is_copied {
                (self.layout.kind(wide[at]), values.leaf(ops[at], wide[at]))
            } else {
                values.expression(id)
            };
            let name = format!("v{next}");
            next += 1;
            let _ = writeln!(text, "{}const {kind} {name} = {expression};", self.indent);
            values.names.insert(id.0, name);
        }
        let mut places = anywhere.iter();
        for root in wanted {
            let (kept, stored) = (&self.layout.wide, |is_wide: bool| is_single && is_wide);
            let (to, id, is_wide) = match *root {
                Root::Cell(id, cell) => {
                    (self.layout.signal(cell as usize), id, stored(kept.cells.contains(&cell)))
                }
                Root::Held(id, number) => {
                    (self.layout.memory(number as usize), id, stored(kept.memories.contains(&number)))
                }
                Root::Anywhere(id) => (places.next().cloned().unwrap_or_default(), id, false),
                Root::Met(_) => continue,
            };
            let value = values.number(id, is_wide);
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
    /// What stays in double precision where the code is in single precision.
    wide: &'v [bool],
    names: BTreeMap<u32, String>,
    needs: &'v mut Needs,
}

impl Values<'_> {
    fn layout(&self) -> &Layout<'_> {
        self.place.layout
    }

    /// A value from outside; a constant as it is among those that stay in double precision, or among the others.
    fn leaf(&mut self, op: Op, is_wide: bool) -> String {
        match op {
            Op::Constant(bits) => {
                let value = f64::from_bits(bits);
                self.needs.math |= !value.is_finite();
                self.layout().literal_of(value, self.layout().kind(is_wide))
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

    fn raw(&mut self, id: Id, is_wide: bool) -> String {
        match self.names.get(&id.0) {
            Some(name) => name.clone(),
            None => self.leaf(self.ops[id.0 as usize], is_wide),
        }
    }

    /// A value as a number that stays in double precision, or does not.
    fn number(&mut self, id: Id, is_wide: bool) -> String {
        let raw = self.raw(id, is_wide);
        let is_constant = matches!(self.ops[id.0 as usize], Op::Constant(_));
        match self.is_truth(id) || (self.wide[id.0 as usize] != is_wide && !is_constant) {
            true => format!("({}){raw}", self.layout().kind(is_wide)),
            false => raw,
        }
    }

    /// A value as a condition.
    fn truth(&mut self, id: Id) -> String {
        let raw = self.raw(id, false);
        if self.is_truth(id) { raw } else { format!("({raw} != {})", self.layout().literal(0.0)) }
    }

    fn call(&mut self, name: &str, is_exact: bool, is_wide: bool) -> String {
        self.needs.math = true;
        let is_single = self.layout().kind(is_wide) == "float";
        let name = if is_single { format!("{name}f") } else { name.to_owned() };
        if !is_exact {
            self.needs.functions.insert(name.clone());
        }
        name
    }

    fn helper(&mut self, name: &'static str, is_wide: bool) -> String {
        self.needs.helpers.insert((name, is_wide));
        helper_name(name, is_wide)
    }

    /// Type and text of an operation, which has double precision where an operand does.
    fn expression(&mut self, id: Id) -> (&'static str, String) {
        let op = self.ops[id.0 as usize];
        let inside = match op {
            Op::Select(_, a, b) => self.wide[a.0 as usize] || self.wide[b.0 as usize],
            _ => op.operands().any(|id| self.wide[id.0 as usize]),
        };
        let stays = self.wide[id.0 as usize];
        let text = match op {
            Op::Neg(a) => format!("-{}", self.number(a, inside)),
            Op::Add(a, b) => format!("{} + {}", self.number(a, inside), self.number(b, inside)),
            Op::Sub(a, b) => format!("{} - {}", self.number(a, inside), self.number(b, inside)),
            Op::Mul(a, b) => format!("{} * {}", self.number(a, inside), self.number(b, inside)),
            Op::Div(a, b) => format!("{} / {}", self.number(a, inside), self.number(b, inside)),
            Op::Power(a, n) => {
                format!("{}({}, {n})", self.helper("power", inside), bare(&self.number(a, inside)))
            }
            Op::Unary(Unary::Sign, a) => {
                format!("{}({})", self.helper("sign", inside), bare(&self.number(a, inside)))
            }
            Op::Unary(function, a) => {
                let (name, is_exact) = function_name(function);
                let name = self.call(name, is_exact, inside);
                format!("{name}({})", bare(&self.number(a, inside)))
            }
            Op::Binary(function, a, b) => {
                let name = match function {
                    Binary::Min => self.helper("minimum", inside),
                    Binary::Max => self.helper("maximum", inside),
                    Binary::Pow => self.call("pow", false, inside),
                    Binary::Hypot => self.call("hypot", false, inside),
                    Binary::Atan2 => self.call("atan2", false, inside),
                };
                let (a, b) = (self.number(a, inside), self.number(b, inside));
                format!("{name}({}, {})", bare(&a), bare(&b))
            }
            Op::Clamp(a, lower, upper) => {
                let name = self.helper("clamp", inside);
                let [a, lower, upper] = [a, lower, upper].map(|id| self.number(id, inside));
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
                return ("bool", format!("{} {sign} {}", self.number(a, inside), self.number(b, inside)));
            }
            Op::Not(a) => return ("bool", format!("!{}", self.truth(a))),
            Op::And(a, b) => return ("bool", format!("{} && {}", self.truth(a), self.truth(b))),
            Op::Or(a, b) => return ("bool", format!("{} || {}", self.truth(a), self.truth(b))),
            Op::Select(condition, a, b) => {
                let condition = self.truth(condition);
                format!("{condition} ? {} : {}", self.number(a, inside), self.number(b, inside))
            }
            leaf => self.leaf(leaf, stays),
        };
        let kind = self.layout().kind(stays);
        (kind, if inside == stays { text } else { format!("({kind})({text})") })
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

/// The name of a function of this file, or of the one beside it that stays in double precision.
fn helper_name(name: &str, is_wide: bool) -> String {
    if is_wide { format!("{name}_wide") } else { name.to_owned() }
}

/// The text of a function of this file, or of the one beside it that stays in double precision.
pub(super) fn helper(name: &str, is_wide: bool, layout: &Layout) -> String {
    let real = layout.kind(is_wide);
    let [zero, one] = [0.0, 1.0].map(|value| layout.literal_of(value, real));
    let called = helper_name(name, is_wide);
    match name {
        "clamp" => format!(
            "/* What is not a number stays so. */\n\
             static {real} {called}({real} u, {real} lower, {real} upper)\n{{\n    \
             return u > upper ? upper : (u < lower ? lower : u);\n}}\n"
        ),
        "sign" => format!(
            "static {real} {called}({real} u)\n{{\n    \
             return u > {zero} ? {one} : (u < {zero} ? -{one} : u);\n}}\n"
        ),
        "minimum" => format!(
            "/* Not a number if one of both is not. */\n\
             static {real} {called}({real} a, {real} b)\n{{\n    return (b < a || b != b) ? b : a;\n}}\n"
        ),
        "maximum" => format!(
            "/* Not a number if one of both is not. */\n\
             static {real} {called}({real} a, {real} b)\n{{\n    return (b > a || b != b) ? b : a;\n}}\n"
        ),
        _ => format!(
            "/* By repeated squaring. */\n\
             static {real} {called}({real} base, int n)\n{{\n    \
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
