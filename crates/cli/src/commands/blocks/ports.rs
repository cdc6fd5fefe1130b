//! The ports of a kind of block.

use blocksim_block::{BlockInfo, Input, Interface, Output, PortType};
use blocksim_diagram::example_interface;
use blocksim_terminal::{Align, Table};
use serde_json::{Value, json};

use crate::terminal::prose::{one_line, wrapped};

/// The interface of the first example of a kind that can be built alone; `None` if none can, for example because it
/// reads a file.
pub fn interface(info: &BlockInfo) -> Option<Interface> {
    info.examples().into_iter().find_map(example_interface)
}

/// A row for each port: name, side, what it carries, unit, default, meaning.
pub fn table(interface: &Interface, width: usize) -> String {
    let rows = rows(interface);
    if rows.is_empty() {
        return String::new();
    }
    let headings = ["  name", "", "carries", "unit", "default"];
    // A column in which no port says anything is left out.
    let shown: Vec<usize> =
        (0..headings.len()).filter(|&n| rows.iter().any(|row| row.cells[n] != "-")).collect();
    let widest = |n: usize| rows.iter().map(|row| row.cells[n].chars().count()).max().unwrap_or(0);
    let taken: usize = shown.iter().map(|&n| widest(n).max(headings[n].len()) + 2).sum();
    let room = width.saturating_sub(taken).max(30);
    let mut columns: Vec<(&str, Align)> = shown.iter().map(|&n| (headings[n], Align::Left)).collect();
    columns.push(("", Align::Left));
    let mut table = Table::new(&columns);
    for row in &rows {
        let doc = wrapped(&one_line(row.doc), room);
        let mut lines = doc.lines().map(str::to_owned);
        table.row(shown.iter().map(|&n| row.cells[n].clone()).chain(lines.next()));
        lines.for_each(|line| table.row(shown.iter().map(|_| String::new()).chain([line])));
    }
    table.render()
}

/// Cells and meaning of each port.
#[cfg(feature = "site")]
pub fn plain_rows(interface: &Interface) -> Vec<([String; 5], &'static str)> {
    rows(interface).into_iter().map(|row| (row.cells.map(|cell| cell.trim().to_owned()), row.doc)).collect()
}

struct Row {
    cells: [String; 5],
    doc: &'static str,
}

fn rows(interface: &Interface) -> Vec<Row> {
    let row = |name: &str, side: &str, carries: String, unit: String, default: String, doc| Row {
        cells: [format!("  {name}"), side.to_owned(), carries, unit, default],
        doc,
    };
    let none = || "-".to_owned();
    let input = |i: &Input| {
        let default = i.default.map_or_else(|| "required".to_owned(), |value| value.to_string());
        let unit = i.dimension.map_or_else(|| "any".to_owned(), |dimension| dimension.to_string());
        row(&i.name, "input", taken(i), unit, default, i.doc)
    };
    let output = |o: &Output| {
        let follows = || "follows".to_owned();
        let carries = match follows_inputs(interface, o) {
            true => follows(),
            false => format!("{} {}", o.port_type.kind, o.port_type.shape),
        };
        let unit = o.port_type.dimension.map_or_else(follows, |dimension| dimension.to_string());
        row(&o.name, "output", carries, unit, none(), o.doc)
    };
    let inputs = interface.inputs.iter().map(input);
    let outputs = interface.outputs.iter().map(output);
    let conserving = interface
        .ports
        .iter()
        .map(|port| row(&port.name, "conserving", port.domain.to_string(), none(), none(), port.doc));
    inputs.chain(outputs).chain(conserving).collect()
}

/// Kind and shape that an input takes.
fn taken(input: &Input) -> String {
    match (input.kind, input.shape) {
        (None, None) => "any".to_owned(),
        (Some(kind), None) => format!("{kind}, any shape"),
        (None, Some(shape)) => format!("any {shape}"),
        (Some(kind), Some(shape)) => format!("{kind} {shape}"),
    }
}

/// Whether kind and shape of an output are those of inputs that take several.
fn follows_inputs(interface: &Interface, output: &Output) -> bool {
    let open = |input: &Input| input.kind.is_none() || input.shape.is_none();
    output.port_type == PortType::UNKNOWN && interface.inputs.iter().any(open)
}

/// The same as data; what is not fixed is null.
pub fn data(interface: &Interface) -> Value {
    let text = |value: &dyn std::fmt::Display| value.to_string();
    let inputs: Vec<Value> = interface
        .inputs
        .iter()
        .map(|i| {
            let (kind, shape) = (i.kind.map(|kind| text(&kind)), i.shape.map(|shape| text(&shape)));
            let unit = i.dimension.map(|dimension| text(&dimension));
            json!({"name": i.name, "kind": kind, "shape": shape, "unit": unit, "default": i.default, "doc": i.doc})
        })
        .collect();
    let outputs: Vec<Value> = interface
        .outputs
        .iter()
        .map(|o| {
            let fixed = Some(o.port_type).filter(|_| !follows_inputs(interface, o));
            let (kind, shape) = (fixed.map(|of| text(&of.kind)), fixed.map(|of| text(&of.shape)));
            let unit = o.port_type.dimension.map(|dimension| text(&dimension));
            json!({"name": o.name, "kind": kind, "shape": shape, "unit": unit, "doc": o.doc})
        })
        .collect();
    let conserving: Vec<Value> = interface
        .ports
        .iter()
        .map(|port| json!({"name": port.name, "domain": text(&port.domain), "doc": port.doc}))
        .collect();
    json!({"inputs": inputs, "outputs": outputs, "conserving": conserving})
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::kinds;
    use expect_test::expect;

    fn of(kind: &str) -> Interface {
        interface(BlockInfo::find(kind).unwrap()).unwrap()
    }

    /// The table without the indent of all its lines.
    fn shown(kind: &str) -> String {
        table(&of(kind), 100).replace("\n  ", "\n").trim_start().to_owned()
    }

    #[test]
    fn ports_are_told_with_all_that_is_known() {
        expect![[r#"
              name          carries          unit     default
              u     input   real, any shape  any      required
              y     output  follows          follows  -
        "#]]
        .assert_eq(&shown("Gain"));
        expect![[r#"
              name              carries      unit
              i     output      real scalar  A     current from p to n
              p     conserving  electrical   -     positive pin
              n     conserving  electrical   -     negative pin
              r     conserving  rotational   -     rotor
              c     conserving  rotational   -     housing
        "#]]
        .assert_eq(&shown("DcMotor"));
        expect![[r#"
              name             carries  unit     default
              u1       input   any      any      required  Passed while the control signal is true or at least
                                                           the threshold.
              control  input   any      any      required  Chooses; Bool or real.
              u3       input   any      any      required  Passed otherwise.
              y        output  follows  follows  -
        "#]]
        .assert_eq(&shown("Switch"));
    }

    #[test]
    fn as_data_what_is_open_is_null() {
        let motor = data(&of("DcMotor"));
        assert_eq!(motor["conserving"][0]["domain"], "electrical");
        let gain = data(&of("Gain"));
        assert_eq!((&gain["inputs"][0]["name"], &gain["inputs"][0]["shape"]), (&"u".into(), &Value::Null));
    }

    #[test]
    fn every_kind_shows_ports_or_needs_files() {
        for info in kinds().iter().filter(|info| !["Plugin", "FromFile"].contains(&info.kind)) {
            let interface = interface(info).unwrap_or_default();
            assert!(table(&interface, 100).lines().count() > 1, "{}", info.kind);
        }
    }
}
