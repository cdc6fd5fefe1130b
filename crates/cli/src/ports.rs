//! The ports of a kind of block.

use std::path::Path;

use blocksim_block::BlockInfo;
use blocksim_block::problem::Problem;
use blocksim_diagram::{Reader, Sources, compile};

/// A port name that no block has.
const NO_PORT: &str = "noSuchPort";

/// Ports of a block by their names in diagrams.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Ports {
    /// Signal inputs.
    pub inputs: Vec<String>,
    /// Signal outputs.
    pub outputs: Vec<String>,
    /// Conserving ports.
    pub conserving: Vec<String>,
}

/// The ports that the first example of a kind has; `None` where the example cannot be built alone, for example
/// because it reads a file.
///
/// The compiler is asked by using ports that are none: it answers with those that there are.
pub fn ports(info: &BlockInfo) -> Option<Ports> {
    let example = info.examples().into_iter().next()?;
    let diagram = format!(
        "Diagram(blocks: {{\"block\": {example}}}, connections: [\"block.{NO_PORT} -> block.{NO_PORT}\", \
         \"block.{NO_PORT} <-> block.{NO_PORT}\"])"
    );
    let reader = OneFile(diagram);
    let compiled = compile(&Sources::new(&reader), Path::new("example.ron"), &[]);
    let listed = |side: &str| {
        let message = format!("`block` has no {side} `{NO_PORT}`");
        let answer = compiled.problems.iter().find(|problem| problem.message == message)?;
        Some(names(answer, &format!("its {side}s are ")))
    };
    Some(Ports {
        inputs: listed("input")?,
        outputs: listed("output")?,
        conserving: listed("conserving port")?,
    })
}

/// The names between backticks behind `intro`.
fn names(answer: &Problem, intro: &str) -> Vec<String> {
    let help = answer.help.as_deref().unwrap_or_default();
    let Some((_, list)) = help.split_once(intro) else { return Vec::new() };
    list.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

/// The only file of a diagram.
struct OneFile(String);

impl Reader for OneFile {
    fn read(&self, path: &Path) -> Result<String, String> {
        if path == Path::new("example.ron") {
            Ok(self.0.clone())
        } else {
            Err("there is only the example".into())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::kinds;

    #[test]
    fn ports_have_the_names_of_the_example() {
        let of = |kind: &str| ports(BlockInfo::find(kind).unwrap()).unwrap();
        let gain = of("Gain");
        assert_eq!((gain.inputs, gain.outputs), (vec!["u".to_owned()], vec!["y".to_owned()]));
        assert!(gain.conserving.is_empty());
        let motor = of("DcMotor");
        for port in ["p", "n", "r", "c"] {
            assert!(motor.conserving.contains(&port.to_owned()), "{motor:?}");
        }
    }

    #[test]
    fn every_kind_shows_ports_or_needs_files() {
        for info in kinds().iter().filter(|info| !["Plugin", "FromFile"].contains(&info.kind)) {
            let ports = ports(info).unwrap_or_default();
            assert_ne!(ports, Ports::default(), "{}", info.kind);
        }
    }
}
