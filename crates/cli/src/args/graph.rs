//! The command line of `blocksim graph`.

use std::path::PathBuf;

use blocksim_drawing::Layer;

use super::model::ModelArgs;
use super::plot::ThemeName;

/// `blocksim graph`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Draws one level. Models with errors are drawn as far as they can be read.\n\nExamples:\n  \
                  blocksim graph servo.ron\n  blocksim graph servo.ron --png servo.png\n  \
                  blocksim graph irb2600.ron --path arm/link1 --svg link1.svg --theme dark\n  \
                  blocksim graph irb2600.ron --all --svg drawings\n  blocksim graph servo.ron --loop 1 --svg loop.svg\n  \
                  blocksim graph servo.ron --layers units,rates --svg servo.svg"
)]
pub struct GraphArgs {
    #[command(flatten)]
    pub model: ModelArgs,
    /// The level to draw, such as `arm/link1`; without it the top.
    #[arg(long, value_name = "PATH", default_value = "", hide_default_value = true)]
    pub path: String,
    /// Draws every level; files then are folders, with a drawing for each level.
    #[arg(long, conflicts_with = "path")]
    pub all: bool,
    /// Draws an algebraic loop, by its number in the notes of `blocksim check`: the level around it, with its blocks and wires
    /// marked.
    #[arg(long, value_name = "N", conflicts_with_all = ["path", "all"], value_parser = clap::value_parser!(u32).range(1..))]
    pub r#loop: Option<u32>,
    /// Layers over the drawing, separated by commas: units on the wires, sample times by colour, the order of evaluation, wires that
    /// lead back, algebraic loops.
    #[arg(long, value_enum, value_name = "LAYER", value_delimiter = ',', conflicts_with = "loop")]
    pub layers: Vec<LayerName>,
    /// Writes a drawing.
    #[arg(long, value_name = "FILE")]
    pub svg: Option<PathBuf>,
    /// Writes a picture.
    #[arg(long, value_name = "FILE")]
    pub png: Option<PathBuf>,
    /// Replace files that are there.
    #[arg(long)]
    pub yes: bool,
    /// Colours of drawing and picture.
    #[arg(long, value_enum, default_value_t = ThemeName::Light, value_name = "THEME")]
    pub theme: ThemeName,
    /// Dots of the picture for a dot of the drawing.
    #[arg(long, value_name = "X", default_value_t = 2.0, value_parser = scale)]
    pub scale: f64,
    /// Prints the places of blocks and wires as JSON, one object a level.
    #[arg(long)]
    pub json: bool,
}

/// A layer over a drawing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum LayerName {
    /// Units and shapes of signals, on the wires.
    Units,
    /// Sample times of blocks and wires.
    Rates,
    /// The order in which outputs are evaluated.
    Order,
    /// Wires that lead back.
    Feedback,
    /// Algebraic loops.
    Loops,
}

impl From<LayerName> for Layer {
    fn from(name: LayerName) -> Layer {
        match name {
            LayerName::Units => Layer::Units,
            LayerName::Rates => Layer::Rates,
            LayerName::Order => Layer::Order,
            LayerName::Feedback => Layer::Feedback,
            LayerName::Loops => Layer::Loops,
        }
    }
}

fn scale(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if (0.1..=16.0).contains(&x) => Ok(x),
        _ => Err("a number from 0.1 to 16".to_owned()),
    }
}
