//! Ends of wires as a person names them: `arm/link1/motor.r`, `controller/in.set`.

use blocksim_diagram::{PortKind, Reference};

use crate::project::Level;
use crate::refusal::Refusal;

/// An end of a wire within a diagram.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum End {
    /// A port of a block, or an element of a bus behind it.
    Block {
        block: String,
        port: String,
        /// As in `connections`: `motor.r`, `arm.signals.Angle`.
        text: String,
    },
    /// An input of the diagram.
    Input(String),
    /// An output of the diagram.
    Output(String),
    /// A conserving port of the diagram.
    Port(String),
}

/// The path of the diagram and the rest of an end that is named from the top.
pub(crate) fn split_end(end: &str) -> (&str, &str) {
    let blocks = end.find('.').unwrap_or(end.len());
    match end[..blocks].rfind('/') {
        Some(slash) => (&end[..slash], &end[slash + 1..]),
        None => ("", end),
    }
}

/// A reference as connections write it.
pub(crate) fn written(reference: &Reference) -> String {
    let mut text = format!("{}.{}", reference.block, reference.port);
    reference.elements.iter().for_each(|element| text.push_str(&format!(".{element}")));
    text
}

impl End {
    /// Reads an end within a diagram.
    pub(crate) fn read(level: &Level, text: &str) -> Result<End, Refusal> {
        let text = text.trim();
        let Some((block, rest)) = text.split_once('.') else {
            return Err(Refusal::new(format!("`{text}` does not name a port"))
                .help("write `block.port`; most outputs are called `y`, most inputs `u`"));
        };
        let port = rest.split('.').next().unwrap_or_default();
        let ast = &level.model.ast;
        if block == "in" {
            return match ast.inputs.iter().any(|(name, _)| name.text == port) {
                true => Ok(End::Input(rest.to_owned())),
                false => Err(Refusal::new(format!("this diagram has no input `{port}`"))),
            };
        }
        if block == "out" && level.model.block("out").is_none() {
            let is_output = ast.outputs.iter().any(|(name, _)| name.text == port);
            let is_port = ast.ports.iter().any(|(name, _)| name.text == port);
            return match (is_output, is_port) {
                (true, _) => Ok(End::Output(port.to_owned())),
                (_, true) => Ok(End::Port(port.to_owned())),
                _ => Err(Refusal::new(format!("this diagram has no output and no port `{port}`"))),
            };
        }
        level.block(block)?;
        Ok(End::Block { block: block.to_owned(), port: port.to_owned(), text: text.to_owned() })
    }

    /// As connections write it; nothing for what is no end of a connection.
    pub(crate) fn written(&self) -> Option<String> {
        match self {
            End::Block { text, .. } => Some(text.clone()),
            End::Input(name) => Some(format!("in.{name}")),
            End::Output(_) | End::Port(_) => None,
        }
    }

    /// As a person names it.
    pub(crate) fn shown(&self) -> String {
        match self {
            End::Output(name) | End::Port(name) => format!("out.{name}"),
            other => other.written().unwrap_or_default(),
        }
    }

    /// What it is, seen from within the diagram: an input of the diagram drives signals there.
    pub(crate) fn kind(&self, level: &Level) -> Result<PortKind, Refusal> {
        match self {
            End::Input(_) => Ok(PortKind::Output),
            End::Output(_) => Ok(PortKind::Input),
            End::Port(name) => {
                Ok(level.model.port_domain(name).map_or(PortKind::Anything, PortKind::Conserving))
            }
            End::Block { block, port, .. } => {
                let known = level.block(block)?;
                known.port(port).ok_or_else(|| {
                    let all: Vec<String> =
                        known.inputs().into_iter().chain(known.outputs()).chain(known.ports()).collect();
                    let help = match all.is_empty() {
                        true => format!("`{block}` has no ports"),
                        false => format!("its ports are {}", all.join(", ")),
                    };
                    Refusal::new(format!("`{block}` has no port `{port}`")).help(help)
                })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_level_stands_before_the_last_slash_of_the_blocks() {
        assert_eq!(split_end("pid.e"), ("", "pid.e"));
        assert_eq!(split_end("arm/link1/motor.r"), ("arm/link1", "motor.r"));
        assert_eq!(split_end("arm/bus.y.a"), ("arm", "bus.y.a"));
        assert_eq!(split_end("arm"), ("", "arm"));
        assert_eq!(split_end(""), ("", ""));
    }
}
