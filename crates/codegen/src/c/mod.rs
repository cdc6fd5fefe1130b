//! Programs as C99: a header, a source, a test and how to run it.

mod body;
mod layout;
mod names;
mod wide;

use std::fmt::Write;

use body::{Needs, Place, Requirements, helper};
use layout::{Layout, comment};
use names::identifier;

use blocksim_signal::{Dimension, Kind, Shape};

use crate::part::Selected;
use crate::programs::{Due, Programs};
use crate::replay::{Record, Start};
use crate::{Generated, Method, Port};

/// What is written in several files.
struct Writer<'w> {
    layout: Layout<'w>,
    programs: &'w Programs,
    /// What the names of the code begin with.
    name: String,
    needs: Needs,
    requirements: Requirements,
}

/// The files of a part.
pub(crate) fn write(selected: &Selected, start: &Start, programs: &Programs, record: &Record) -> Generated {
    let name = identifier(&selected.target.name);
    let layout = Layout::new(selected, start, programs);
    let mut writer =
        Writer { layout, programs, name, needs: Needs::default(), requirements: Requirements::default() };
    let source = writer.source();
    let header = writer.header();
    let test = writer.test(record);
    let readme = writer.readme(record);
    let name = writer.name.clone();
    Generated {
        files: vec![
            (format!("{name}.h"), header),
            (format!("{name}.c"), source),
            (format!("{name}_test.c"), test),
            (format!("{name}.md"), readme),
        ],
        test_steps: record.outputs.len(),
        functions: writer.needs.functions.iter().cloned().collect(),
        warnings: record.warnings.clone(),
        name,
    }
}

impl Writer<'_> {
    fn selected(&self) -> &Selected<'_> {
        self.layout.selected
    }

    fn what(&self) -> String {
        let title = comment(&self.selected().schedule.title);
        match self.selected().part.path.as_str() {
            "" => format!("the diagram \"{title}\""),
            path => format!("{} of the diagram \"{title}\"", comment(path)),
        }
    }

    /// The step in seconds.
    fn step(&self) -> String {
        format!("{:?}", self.selected().target.step)
    }

    fn has_inputs(&self) -> bool {
        !self.layout.inputs.is_empty()
    }

    /// The parameters of the function that makes a step.
    fn parameters(&self) -> String {
        let name = &self.name;
        let inputs = if self.has_inputs() { format!("const {name}_Inputs *in, ") } else { String::new() };
        format!("{name}_State *self, {inputs}{name}_Outputs *out")
    }

    fn header(&self) -> String {
        let Self { name, layout, .. } = self;
        let (what, step) = (self.what(), self.step());
        let guard = format!("{}_H", name.to_uppercase());
        let mut text = format!(
            "/* {what}, a step of {step} s.\n *\n \
             * Made by blocksim. Call {name}_init once, then {name}_step every {step} s. All values are in SI units.\n \
             * There are no globals and no allocation; each {name}_State is an instance of its own. */\n\
             #ifndef {guard}\n#define {guard}\n\n#include <stdbool.h>\n#include <stdint.h>\n\n"
        );
        if self.has_inputs() {
            text += "typedef struct {\n";
            for (field, port) in &layout.inputs {
                text += &layout.field(field, &self.selected().part.inputs[*port]);
            }
            let _ = write!(text, "}} {name}_Inputs;\n\n");
        }
        text += "typedef struct {\n";
        for (field, port) in &layout.outputs {
            text += &layout.field(field, &self.selected().part.outputs[*port]);
        }
        let _ =
            write!(text, "}} {name}_Outputs;\n\n/* What is kept from step to step. */\ntypedef struct {{\n");
        text += "    uint64_t step; /* number of steps made */\n";
        for field in layout.counters.values() {
            let _ = writeln!(text, "    uint32_t {field}; /* steps to the next sample */");
        }
        if !layout.states.is_empty() {
            let paths: Vec<String> =
                layout.states.iter().map(|state| comment(&layout.state_path(*state))).collect();
            let _ = writeln!(text, "    {} x[{}]; /* {} */", layout.real, paths.len(), paths.join(", "));
        }
        for (number, field) in &layout.memories {
            let _ = writeln!(
                text,
                "    {} {field}; /* {} */",
                layout.memory_type(*number),
                comment(&layout.memory_path(*number))
            );
        }
        for (cell, field) in &layout.signals {
            let _ = writeln!(
                text,
                "    {} {field}; /* signal {} */",
                layout.signal_type(*cell),
                comment(&layout.signal_path(*cell))
            );
        }
        let _ = write!(
            text,
            "}} {name}_State;\n\n/* The state at the start. */\nvoid {name}_init({name}_State *self);\n\n"
        );
        text += "/* One step: outputs from inputs and state, then the state of the next step. Returns 0";
        if self.requirements.0.is_empty() {
            text += ". */\n";
        } else {
            text += ", or the first of these that went wrong;\n * the outputs are then of no use:\n";
            for (i, requirement) in self.requirements.0.iter().enumerate() {
                let _ = writeln!(text, " * {} {requirement}", i + 1);
            }
            text += " */\n";
        }
        let _ = write!(text, "int {name}_step({});\n\n#endif\n", self.parameters());
        text
    }

    fn source(&mut self) -> String {
        let init = self.init();
        let derivatives = self.derivatives();
        let step = self.step_function();
        let name = &self.name;
        let mut text = format!(
            "/* {}. Made by blocksim; compile it without contraction of products and sums\n \
             * (-ffp-contract=off), so that it gives the same bits everywhere. */\n#include \"{name}.h\"\n",
            self.what()
        );
        if self.needs.math {
            text += "\n#include <math.h>\n";
        }
        for (name, is_wide) in &self.needs.helpers {
            text.push('\n');
            text += &helper(name, *is_wide, &self.layout);
        }
        for function in [init, derivatives, step].iter().filter(|function| !function.is_empty()) {
            text.push('\n');
            text += function;
        }
        text
    }

    fn init(&self) -> String {
        let Self { name, layout, .. } = self;
        let mut text = format!("void {name}_init({name}_State *self)\n{{\n    self->step = 0u;\n");
        for (rate, field) in &layout.counters {
            let offset = self.selected().divisor(*rate).map_or(0, |(_, offset)| offset);
            let _ = writeln!(text, "    self->{field} = {offset}u;");
        }
        for (i, state) in layout.states.iter().enumerate() {
            let _ = writeln!(text, "    self->x[{i}] = {};", layout.literal(layout.start.x[*state]));
        }
        for (number, field) in &layout.memories {
            let initial = layout.literal_of(layout.start.d[*number], layout.memory_type(*number));
            let _ = writeln!(text, "    self->{field} = {initial};");
        }
        for (cell, field) in &layout.signals {
            let initial = self.selected().schedule.initial_signals[*cell];
            let initial = layout.literal_of(initial, layout.signal_type(*cell));
            let _ = writeln!(text, "    self->{field} = {initial};");
        }
        text += "}\n";
        text
    }

    /// The function of the derivatives; nothing without states.
    fn derivatives(&mut self) -> String {
        let Self { layout, programs, needs, requirements, name } = self;
        let Some((draft, states)) = &programs.derivatives else { return String::new() };
        let places: Vec<String> = (0..states.len()).map(|i| format!("dx[{i}]")).collect();
        let reads_time = std::mem::replace(&mut needs.time, false);
        let place = Place { layout, states: "x", indent: "    " };
        let body = place.write(draft, &places, needs, requirements);
        let real = layout.real;
        let reads = |word: &str| body.contains(word);
        let mut text = format!(
            "/* Derivatives of the continuous states. */\nstatic int derivatives(const {name}_State *self, "
        );
        let has_inputs = !layout.inputs.is_empty();
        if has_inputs {
            let _ = write!(text, "const {name}_Inputs *in, ");
        }
        let _ = writeln!(text, "double t, const {real} *x, {real} *dx)\n{{\n    int status = 0;");
        // What this law happens not to read is a parameter all the same.
        let unread = [
            (!reads("self->"), "self"),
            (has_inputs && !reads("in->"), "in"),
            (!needs.time, "t"),
            (!reads(" x[") && !reads("(x["), "x"),
        ];
        for (_, name) in unread.iter().filter(|(is_unread, _)| *is_unread) {
            let _ = writeln!(text, "    (void){name};");
        }
        text += &body;
        text += "    return status;\n}\n";
        needs.time = reads_time;
        text
    }

    fn step_function(&mut self) -> String {
        let head = format!("int {}_step({})\n{{\n    int status = 0;\n", self.name, self.parameters());
        let mut text = String::new();
        for (due, draft) in &self.programs.steps {
            let place = Place { layout: &self.layout, states: "self->x", indent: "        " };
            let body = place.write(draft, &[], &mut self.needs, &mut self.requirements);
            if body.is_empty() {
                continue;
            }
            match due {
                Due::Rate(rate) if self.layout.counters.contains_key(rate) => {
                    let _ = writeln!(text, "    if (self->{} == 0u) {{", self.layout.counters[rate]);
                }
                _ => text += "    {\n",
            }
            text += &body;
            text += "    }\n";
        }
        text += &self.output_assignments();
        if !self.layout.states.is_empty() {
            text += &self.integration();
        }
        for (rate, field) in &self.layout.counters {
            let period = self.layout.selected.divisor(*rate).map_or(1, |(period, _)| period);
            let _ = writeln!(
                text,
                "    self->{field} = self->{field} == 0u ? {}u : self->{field} - 1u;",
                period - 1
            );
        }
        text += "    self->step += 1u;\n    return status;\n}\n";
        let mut before = String::new();
        if self.needs.time || !self.layout.states.is_empty() {
            let _ = writeln!(before, "    const double t = {};", self.time("self->step"));
        }
        if self.has_inputs() && !text.contains("in->") && self.layout.states.is_empty() {
            before += "    (void)in;\n";
        }
        format!("{head}{before}{text}")
    }

    /// The time of a step as `Clock::time` computes it.
    fn time(&self, step: &str) -> String {
        let tick = self.selected().target.step;
        let per_second = 1.0 / tick;
        let whole = per_second.round();
        if (per_second - whole).abs() <= 1e-9 * whole {
            format!("(double){step} / {whole:?}")
        } else {
            format!("(double){step} * {tick:?}")
        }
    }

    fn output_assignments(&self) -> String {
        let layout = &self.layout;
        let mut text = String::new();
        for (field, number) in &layout.outputs {
            let port = &self.selected().part.outputs[*number];
            for (element, cell) in port.cells().enumerate() {
                let at = index(port, element);
                let value = layout.read(cell);
                let value = match port.kind {
                    _ if layout.is_single() && layout.signal_type(cell) == "double" => {
                        format!("({}){value}", layout.real)
                    }
                    Kind::Bool => format!("({value} != {})", layout.literal(0.0)),
                    _ => value,
                };
                let _ = writeln!(text, "    out->{field}{at} = {value};");
            }
        }
        text
    }

    /// The step of the method, in the order of operations of the engine.
    fn integration(&self) -> String {
        let layout = &self.layout;
        let (n, real) = (layout.states.len(), layout.real);
        let inputs = if self.has_inputs() { "in, " } else { "" };
        let next = self.time("(self->step + 1u)");
        let length = cast("t1 - t".to_owned(), layout.is_single());
        let mut text =
            format!("    {{\n        const double t1 = {next};\n        const {real} h = {length};\n");
        match self.selected().target.method.unwrap_or(Method::Euler) {
            Method::Euler => {
                let _ = write!(
                    text,
                    "        {real} dx[{n}];\n        \
                     const int failed = derivatives(self, {inputs}t, self->x, dx);\n        \
                     status = status != 0 ? status : failed;\n        \
                     for (int i = 0; i < {n}; i++) {{\n            self->x[i] += h * dx[i];\n        }}\n    }}\n"
                );
            }
            Method::Rk4 => {
                let [zero, half, one] = [0.0, 0.5, 1.0].map(|value| layout.literal(value));
                let [sixth, third] = [1.0 / 6.0, 1.0 / 3.0].map(|value| layout.literal(value));
                let _ = write!(
                    text,
                    "        static const {real} a[4][3] = {{\n            \
                     {{{zero}, {zero}, {zero}}}, {{{half}, {zero}, {zero}}}, {{{zero}, {half}, {zero}}}, {{{zero}, {zero}, {one}}}\n        }};\n        \
                     static const {real} b[4] = {{{sixth}, {third}, {third}, {sixth}}};\n        \
                     const double times[4] = {{t, t + 0.5 * h, t + 0.5 * h, t1}};\n        \
                     {real} k[4][{n}];\n        \
                     {real} x[{n}];\n        \
                     for (int stage = 0; stage < 4; stage++) {{\n            \
                     for (int i = 0; i < {n}; i++) {{\n                \
                     x[i] = self->x[i];\n                \
                     for (int j = 0; j < stage; j++) {{\n                    \
                     x[i] += (h * a[stage][j]) * k[j][i];\n                \
                     }}\n            }}\n            \
                     const int failed = derivatives(self, {inputs}times[stage], x, k[stage]);\n            \
                     status = status != 0 ? status : failed;\n        }}\n        \
                     for (int i = 0; i < {n}; i++) {{\n            \
                     for (int j = 0; j < 4; j++) {{\n                \
                     self->x[i] += (h * b[j]) * k[j][i];\n            \
                     }}\n        }}\n    }}\n"
                );
            }
        }
        text
    }

    fn test(&self, record: &Record) -> String {
        let Self { name, layout, .. } = self;
        let steps = record.outputs.len();
        let part = self.selected().part;
        let mut text = format!(
            "/* Holds {name}.c against a simulation of {steps} steps. Compile and run it:\n *\n *     {}\n *     ./{name}_test\n */\n\
             #include \"{name}.h\"\n\n#include <math.h>\n#include <stdio.h>\n#include <stdlib.h>\n\n",
            compile_line(name)
        );
        let rows = |rows: &mut dyn Iterator<Item = Vec<f64>>| -> String {
            rows.map(|row| {
                let numbers: Vec<String> = row.iter().map(|value| double(*value)).collect();
                format!("    {{{}}},\n", numbers.join(", "))
            })
            .collect()
        };
        // Inputs that nothing outside drives are no fields.
        let mut columns = Vec::new();
        let mut column = 0;
        for (number, port) in part.inputs.iter().enumerate() {
            if layout.inputs.iter().any(|(_, of)| *of == number) {
                columns.extend(column..column + port.shape.len());
            }
            column += port.shape.len();
        }
        if self.has_inputs() {
            let mut picked = record.inputs.iter().map(|row| columns.iter().map(|at| row[*at]).collect());
            let _ = write!(
                text,
                "static const double inputs[{steps}][{}] = {{\n{}}};\n\n",
                columns.len(),
                rows(&mut picked)
            );
        }
        let width: usize = part.outputs.iter().map(|port| port.shape.len()).sum();
        let _ = write!(
            text,
            "static const double outputs[{steps}][{width}] = {{\n{}}};\n\n",
            rows(&mut record.outputs.iter().cloned())
        );
        let mut set = String::new();
        let mut at = 0;
        for (field, number) in &layout.inputs {
            let port = &part.inputs[*number];
            for element in 0..port.shape.len() {
                let place = index(port, element);
                let value = match port.kind {
                    Kind::Bool => format!("inputs[k][{at}] != 0.0"),
                    _ => format!("({})inputs[k][{at}]", layout.real),
                };
                let _ = writeln!(set, "        in.{field}{place} = {value};");
                at += 1;
            }
        }
        let mut get = Vec::new();
        for (field, number) in &layout.outputs {
            let port = &part.outputs[*number];
            for element in 0..port.shape.len() {
                let place = index(port, element);
                get.push(format!("(double)out.{field}{place}"));
            }
        }
        let names: Vec<String> = part
            .outputs
            .iter()
            .flat_map(|port| {
                (0..port.shape.len())
                    .map(move |_| format!("\"{}\"", port.name.replace('\\', "\\\\").replace('"', "\\\"")))
            })
            .collect();
        let (declare, pass) = if self.has_inputs() {
            (format!("    {name}_Inputs in;\n"), "&in, ")
        } else {
            (String::new(), "")
        };
        let compare = if layout.is_single() {
            "            /* Single precision has seven digits; errors grow from step to step. */\n            \
             const double error = fabs(got[i] - outputs[k][i]);\n            \
             const double size = fabs(outputs[k][i]) > largest[i] ? fabs(outputs[k][i]) : largest[i];\n            \
             largest[i] = size;\n            \
             const bool same = error <= 1e-3 * size || (isnan(got[i]) && isnan(outputs[k][i]));\n"
        } else {
            "            /* The same number, and the same sign of zero. */\n            \
             const bool same = (got[i] == outputs[k][i] && !signbit(got[i]) == !signbit(outputs[k][i]))\n                \
             || (isnan(got[i]) && isnan(outputs[k][i]));\n"
        };
        let largest = if layout.is_single() {
            let least: Vec<String> = self.least_sizes(record).into_iter().map(double).collect();
            format!("    double largest[{width}] = {{{}}};\n", least.join(", "))
        } else {
            String::new()
        };
        let _ = write!(
            text,
            "static const char *const names[{width}] = {{{}}};\n\n\
             int main(void)\n{{\n    {name}_State state;\n{declare}    {name}_Outputs out;\n{largest}    {name}_init(&state);\n    \
             for (int k = 0; k < {steps}; k++) {{\n{set}        \
             const int status = {name}_step(&state, {pass}&out);\n        \
             if (status != 0) {{\n            \
             printf(\"step %d: requirement %d is not met\\n\", k, status);\n            return EXIT_FAILURE;\n        }}\n        \
             const double got[{width}] = {{{}}};\n        \
             for (int i = 0; i < {width}; i++) {{\n{compare}            \
             if (!same) {{\n                \
             printf(\"step %d: %s is %.17g, but %.17g in the simulation\\n\", k, names[i], got[i], outputs[k][i]);\n                \
             return EXIT_FAILURE;\n            }}\n        }}\n    }}\n    \
             printf(\"{steps} steps as in the simulation\\n\");\n    return EXIT_SUCCESS;\n}}\n",
            names.join(", "),
            get.join(", ")
        );
        text
    }

    /// Sizes that the elements of the outputs count as at least in single precision: a thousandth of the largest number of the same
    /// dimension that comes in or out, so that what is a difference of such numbers and nearly zero may have their rounding.
    fn least_sizes(&self, record: &Record) -> Vec<f64> {
        let part = self.selected().part;
        let mut largest: Vec<(Option<Dimension>, f64)> = Vec::new();
        for (ports, rows) in [(&part.inputs, &record.inputs), (&part.outputs, &record.outputs)] {
            let mut at = 0;
            for port in ports {
                let cells = at..at + port.shape.len();
                at = cells.end;
                let values = rows.iter().filter_map(|row| row.get(cells.clone())).flatten();
                let size = values
                    .filter(|value| value.is_finite())
                    .fold(0.0_f64, |most, value| most.max(value.abs()));
                match largest.iter_mut().find(|(dimension, _)| *dimension == port.dimension) {
                    Some((_, most)) => *most = most.max(size),
                    None => largest.push((port.dimension, size)),
                }
            }
        }
        let least = |port: &Port| {
            let same = largest.iter().find(|(dimension, _)| *dimension == port.dimension);
            std::iter::repeat_n(1e-3 * same.map_or(0.0, |(_, size)| *size), port.shape.len())
        };
        part.outputs.iter().flat_map(least).collect()
    }

    fn readme(&self, record: &Record) -> String {
        let Self { name, .. } = self;
        let method = match self.selected().target.method {
            Some(Method::Euler) => " by Euler's method, as the code has it",
            Some(Method::Rk4) => " by the method of Runge and Kutta, as the code has it",
            None => "",
        };
        let doubts: String = record
            .warnings
            .iter()
            .map(|warning| format!("\nThis is not what the model does: {}.\n", warning.message))
            .collect();
        let functions: Vec<String> =
            self.needs.functions.iter().map(|function| format!("`{function}`")).collect();
        let accuracy = if self.layout.is_single() {
            "The code is in single precision and follows the simulation, which is in double precision, to about a thousandth of the \
             size of each output. Where a condition stands at its edge, both may decide it differently."
                .to_owned()
        } else if functions.is_empty() {
            "The test expects the same bits as the simulation in every output.".to_owned()
        } else {
            format!(
                "The test expects the same bits as the simulation in every output. The last digit of {} is up to the mathematical \
                 library: it is the same where the code runs on the library that blocksim ran on, and may differ with another one.",
                functions.join(", ")
            )
        };
        format!(
            "# {name}: {}\n\n\
             `{name}.h` and `{name}.c` are C99 for a target: `{name}_init` once, then `{name}_step` every {} s. All values are in SI \
             units.\n\n\
             `{name}_test.c` holds the code against {} steps of a simulation of the same part{method}, whose inputs are held for a step. \
             Compile and run it:\n\n```\n{}\n./{name}_test\n```\n\n{accuracy}\n{doubts}",
            self.what(),
            self.step(),
            record.outputs.len(),
            compile_line(name),
        )
    }
}

/// A number of double precision in the precision of the code.
fn cast(text: String, is_single: bool) -> String {
    if is_single { format!("(float)({text})") } else { text }
}

/// The element of a port that is an array.
fn index(port: &Port, element: usize) -> String {
    if port.shape == Shape::Scalar { String::new() } else { format!("[{element}]") }
}

fn compile_line(name: &str) -> String {
    format!("cc -std=c99 -Wall -Wextra -Werror -ffp-contract=off {name}.c {name}_test.c -lm -o {name}_test")
}

/// A number of the test, in double precision whatever the code is in.
fn double(value: f64) -> String {
    match value {
        _ if value.is_finite() => format!("{value:?}"),
        _ if value.is_nan() => "NAN".to_owned(),
        _ if value < 0.0 => "-INFINITY".to_owned(),
        _ => "INFINITY".to_owned(),
    }
}
