//! The command line of `blocksim import`.

use std::path::PathBuf;

use blocksim_signal::{Unit, evaluate};
use clap::ValueEnum;

use super::values::NoNames;

/// `blocksim import`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Writes a diagram, a file of its numbers and, where axes follow each other, a description of the robot. \
                  Where they exist only the numbers are brought up to date, if the structure is the same; the others are \
                  yours.\n\nExamples:\n  \
                  blocksim import arm.urdf --out arm\n  blocksim import arm.urdf --out arm --tip tool0\n  \
                  blocksim import arm.xml --data arm_DataFile.m --out arm"
)]
pub struct ImportArgs {
    /// The file.
    pub file: PathBuf,
    /// Kind of file; detected from the file if absent.
    #[arg(long = "as", value_enum, value_name = "KIND")]
    pub kind: Option<Kind>,
    /// Folder for the diagram and its parameters.
    #[arg(short, long, value_name = "DIR")]
    pub out: PathBuf,
    /// Data file (`*_DataFile.m`) that was exported with an assembly: its numbers count.
    #[arg(long, value_name = "FILE")]
    pub data: Option<PathBuf>,
    /// Body at the end of the robot, where joints branch or several frames end it.
    #[arg(long, value_name = "BODY")]
    pub tip: Option<String>,
    /// Density for links without mass, which then is that of their meshes and other shapes, such as `2700` or `"7850 kg/m^3"`.
    #[arg(long, value_name = "DENSITY", value_parser = density)]
    pub density: Option<f64>,
    /// Leave meshes where they are, unread.
    #[arg(long, conflicts_with = "density")]
    pub no_meshes: bool,
    /// Overwrite a parameter file even if it was changed by hand or has another structure.
    #[arg(long)]
    pub yes: bool,
}

/// Kinds of file that can be imported.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Kind {
    /// Robot description.
    Urdf,
    /// Assembly, exported for Simscape Multibody as import XML 2.0.
    Simscape,
    /// Numbers of such an assembly, a script that fills `smiData`: parameters only.
    Smidata,
}

/// A density above zero, kg/m³.
fn density(text: &str) -> Result<f64, String> {
    let value = evaluate(text, &NoNames).map_err(|error| error.message)?;
    let quantity = value.as_number().ok_or("a density is a number, such as 2700 or \"2700 kg/m^3\"")?;
    let fits = Unit::parse("kg/m^3").is_ok_and(|unit| quantity.dimension == unit.dimension);
    match quantity.value {
        _ if !fits && !quantity.dimension.is_none() => Err("a density has a unit such as kg/m^3".to_owned()),
        x if x > 0.0 && x.is_finite() => Ok(x),
        _ => Err("a density is above zero".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn densities_have_units_or_are_kilograms_per_cubic_metre() {
        assert_eq!(density("2700"), Ok(2700.0));
        assert_eq!(density("7850 kg/m^3"), Ok(7850.0));
        for wrong in ["0", "-1", "3 kg", "steel"] {
            assert!(density(wrong).is_err(), "{wrong}");
        }
    }
}
