//! What a plug-in offers, as text: written when it is loaded, so that diagrams can be read later without loading it.
//!
//! Such a text may come from a stranger, with a run for example. It is data: nothing in it is run, and it is held to the rules for
//! the tables of libraries.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};

use serde::{Deserialize, Serialize};

use crate::kind::{Calls, Kind, Quantity, Sizes, numbers};
use crate::open::Library;
use crate::table::{MOST_ELEMENTS, MOST_NUMBERS, dimension, is_name, whole};

/// Version of the text.
const VERSION: u32 = 1;
/// Sample times that are kept, each for other parameters.
const MOST_PERIODS: usize = 256;

/// A plug-in without its functions.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Offer {
    v: u32,
    name: String,
    version: String,
    blocks: Vec<OfferedKind>,
    periods: Vec<Period>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct OfferedKind {
    name: String,
    doc: String,
    parameters: Vec<Described>,
    inputs: Vec<Described>,
    outputs: Vec<Described>,
    continuous: Vec<Described>,
    discrete: Vec<Described>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Described {
    name: String,
    unit: String,
    length: usize,
    doc: String,
    /// As text, since JSON has no infinite numbers.
    default: Option<Vec<String>>,
    reads: Vec<usize>,
}

/// The sample time of a block with certain parameters, s; 0: continuous. Only the plug-in can work it out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Period {
    block: String,
    parameters: Vec<String>,
    period: f64,
}

impl Period {
    pub fn new(block: &str, parameters: &[f64], period: f64) -> Period {
        Period { block: block.to_owned(), parameters: texts(parameters), period }
    }
}

/// What a loaded plug-in offers.
pub fn offer(library: &Library) -> String {
    let offer = Offer {
        v: VERSION,
        name: library.name.to_owned(),
        version: library.version.to_owned(),
        blocks: library.blocks.iter().map(offered).collect(),
        periods: library.periods.lock().unwrap_or_else(PoisonError::into_inner).clone(),
    };
    text(&offer)
}

/// The later of two offers, with what the earlier one knows beyond it.
pub fn merged(earlier: &str, later: &str) -> String {
    let (Ok(earlier), Ok(mut both)) = (read(earlier), read(later)) else { return later.to_owned() };
    if earlier.blocks == both.blocks {
        let is_new = |period: &&Period| !earlier.periods.contains(period);
        // Of what is known nothing changes its place, so that nobody writes it anew.
        if earlier.version == both.version && !both.periods.iter().any(|period| is_new(&period)) {
            return text(&earlier);
        }
        let known = |period: &Period| both.periods.iter().any(|later| same_question(later, period));
        let more: Vec<Period> = earlier.periods.into_iter().filter(|period| !known(period)).collect();
        both.periods.extend(more);
        both.periods.truncate(MOST_PERIODS);
    }
    text(&both)
}

/// The plug-in that a text describes; its blocks can be looked at, not run. `shown` stands for its path.
///
/// # Errors
/// The text is no offer, or breaks the rules for plug-ins.
pub fn recalled(shown: &str, offer: &str) -> Result<&'static Library, String> {
    static RECALLED: Mutex<BTreeMap<(String, String), &'static Library>> = Mutex::new(BTreeMap::new());
    let key = (shown.to_owned(), offer.to_owned());
    let mut recalled = RECALLED.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(known) = recalled.get(&key) {
        return Ok(known);
    }
    // As those of a loaded library, texts live as long as the process.
    let library: &'static Library = Box::leak(Box::new(library(shown, read(offer)?)?));
    recalled.insert(key, library);
    Ok(library)
}

/// The plug-in that another process has loaded, without its functions.
///
/// # Errors
/// As for one that is recalled.
pub(crate) fn served(shown: &str, offer: &str) -> Result<Library, String> {
    library(shown, read(offer)?)
}

/// The sample time of a block with these parameters, s, where it was ever worked out.
pub(crate) fn period(library: &Library, block: &str, parameters: &[f64]) -> Option<f64> {
    let asked = Period::new(block, parameters, 0.0);
    let periods = library.periods.lock().unwrap_or_else(PoisonError::into_inner);
    periods.iter().find(|known| same_question(known, &asked)).map(|known| known.period)
}

/// Notes a sample time that the plug-in has worked out.
pub(crate) fn note_period(library: &Library, period: Period) {
    let mut periods = library.periods.lock().unwrap_or_else(PoisonError::into_inner);
    // What is known keeps its place, so that the offer stays the same text.
    if periods.contains(&period) {
        return;
    }
    periods.retain(|known| !same_question(known, &period));
    periods.insert(0, period);
    periods.truncate(MOST_PERIODS);
}

fn same_question(a: &Period, b: &Period) -> bool {
    a.block == b.block && a.parameters == b.parameters
}

fn read(text: &str) -> Result<Offer, String> {
    let offer: Offer = serde_json::from_str(text).map_err(|error| error.to_string())?;
    if offer.v == VERSION { Ok(offer) } else { Err(format!("it has version {}", offer.v)) }
}

fn text(offer: &Offer) -> String {
    // Numbers, texts and lists always become JSON.
    serde_json::to_string(offer).unwrap_or_default()
}

fn texts(numbers: &[f64]) -> Vec<String> {
    numbers.iter().map(f64::to_string).collect()
}

fn offered(kind: &Kind) -> OfferedKind {
    let list = |quantities: &[Quantity]| quantities.iter().map(described).collect();
    OfferedKind {
        name: kind.name.to_owned(),
        doc: kind.doc.to_owned(),
        parameters: list(&kind.parameters),
        inputs: list(&kind.inputs),
        outputs: list(&kind.outputs),
        continuous: list(&kind.continuous),
        discrete: list(&kind.discrete),
    }
}

fn described(quantity: &Quantity) -> Described {
    Described {
        name: quantity.name.to_owned(),
        unit: quantity.unit.to_owned(),
        length: quantity.length,
        doc: quantity.doc.to_owned(),
        default: quantity.default.map(texts),
        reads: quantity.reads.clone(),
    }
}

fn library(shown: &str, offer: Offer) -> Result<Library, String> {
    let too_many = |n: usize| n > MOST_ELEMENTS as usize;
    if too_many(offer.blocks.len()) || offer.periods.len() > MOST_PERIODS {
        return Err("it has too many blocks or sample times".to_owned());
    }
    if let Some(wrong) = offer.periods.iter().find(|known| !(known.period.is_finite() && known.period >= 0.0))
    {
        return Err(format!("a sample time is {} s", wrong.period));
    }
    let blocks = offer.blocks.into_iter().map(kind).collect::<Result<Vec<_>, _>>()?;
    Ok(Library {
        path: PathBuf::from(shown),
        name: leaked(offer.name),
        version: leaked(offer.version),
        blocks,
        periods: Mutex::new(offer.periods),
    })
}

fn kind(offered: OfferedKind) -> Result<Kind, String> {
    let parameters = quantities(offered.parameters)?;
    let inputs = quantities(offered.inputs)?;
    let outputs = quantities(offered.outputs)?;
    let continuous = quantities(offered.continuous)?;
    let discrete = quantities(offered.discrete)?;
    let sizes = Sizes {
        params: numbers(&parameters),
        u: numbers(&inputs),
        y: numbers(&outputs),
        x: numbers(&continuous),
        xd: numbers(&discrete),
    };
    if !is_name(&offered.name) {
        return Err(format!("`{}` is not a valid name", offered.name));
    }
    let (name, doc) = (leaked(offered.name), leaked(offered.doc));
    let kind =
        Kind { name, doc, parameters, inputs, outputs, continuous, discrete, calls: Calls::Nowhere, sizes };
    whole(&kind).map_err(|reason| format!("`{name}` {reason}"))?;
    Ok(kind)
}

fn quantities(list: Vec<Described>) -> Result<Vec<Quantity>, String> {
    if list.len() > MOST_ELEMENTS as usize {
        return Err(format!("a block has {} quantities of one sort", list.len()));
    }
    let list = list.into_iter().map(quantity).collect::<Result<Vec<_>, _>>()?;
    let is_twice = |(at, one): (usize, &Quantity)| list[..at].iter().any(|other| other.name == one.name);
    if numbers(&list) > MOST_NUMBERS || list.iter().enumerate().any(is_twice) {
        return Err("a block has too many numbers, or two quantities of one name".to_owned());
    }
    Ok(list)
}

fn quantity(described: Described) -> Result<Quantity, String> {
    let Described { name, unit, length, doc, default, reads } = described;
    let default =
        default.map(|texts| texts.iter().map(|text| text.parse::<f64>()).collect::<Result<Vec<_>, _>>());
    let default = default.transpose().map_err(|error| format!("the default of `{name}`: {error}"))?;
    let fits = default.as_ref().is_none_or(|default| default.len() == length);
    if !is_name(&name) || length == 0 || length > MOST_NUMBERS || !fits {
        return Err(format!("`{name}` has no valid name, length or default"));
    }
    Ok(Quantity {
        dimension: dimension(&name, &unit)?,
        name: leaked(name),
        unit: leaked(unit),
        length,
        doc: leaked(doc),
        default: default.map(|default| &*Box::leak(default.into_boxed_slice())),
        reads,
    })
}

fn leaked(text: String) -> &'static str {
    Box::leak(text.into_boxed_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"{"v":1,"name":"low_pass","version":"0.1.0","blocks":[{"name":"LowPass","doc":"law",
        "parameters":[{"name":"a","unit":"1","length":1,"doc":"","default":["inf"],"reads":[]}],
        "inputs":[{"name":"u","unit":"rad","length":2,"doc":"","default":null,"reads":[]}],
        "outputs":[],"continuous":[],"discrete":[]}],
        "periods":[{"block":"LowPass","parameters":["0.1"],"period":0.002}]}"#;

    #[test]
    fn what_was_written_reads_back() {
        let library = recalled("here", TEXT).unwrap();
        assert_eq!((library.name, library.blocks[0].inputs[0].length), ("low_pass", 2));
        assert_eq!(library.blocks[0].parameters[0].default, Some(&[f64::INFINITY][..]));
        assert_eq!(read(&offer(library)), read(TEXT));
        assert_eq!(period(library, "LowPass", &[0.1]), Some(0.002));
        assert_eq!(period(library, "LowPass", &[0.2]), None);
    }

    #[test]
    fn what_is_remembered_cannot_be_run() {
        let kind = &recalled("here", TEXT).unwrap().blocks[0];
        let failure = kind.check(&[1.0]).unwrap_err();
        assert_eq!(failure.to_string(), "the plug-in was never loaded");
    }

    #[test]
    fn an_offer_that_breaks_the_rules_is_refused() {
        for (from, to) in [
            ("\"v\":1", "\"v\":2"),
            ("\"LowPass\",\"doc\"", "\"Low\\u001b[2J\",\"doc\""),
            ("\"length\":2", "\"length\":0"),
            ("\"length\":2", "\"length\":100000000"),
            ("\"rad\"", "\"parsec\""),
            ("[\"inf\"]", "[\"1\",\"2\"]"),
            ("0.002", "-1"),
            ("{", "["),
        ] {
            assert!(TEXT.contains(from), "{from}");
            assert!(recalled("there", &TEXT.replacen(from, to, 1)).is_err(), "{from} -> {to}");
        }
    }

    #[test]
    fn sample_times_are_gathered_as_long_as_the_blocks_are_the_same() {
        let later = TEXT.replace("0.1\"]", "0.2\"]").replace("0.002", "0.004");
        let both = recalled("both", &merged(TEXT, &later)).unwrap();
        assert_eq!(period(both, "LowPass", &[0.1]), Some(0.002));
        assert_eq!(period(both, "LowPass", &[0.2]), Some(0.004));
        let other = later.replace("\"length\":2", "\"length\":3");
        assert_eq!(period(recalled("new", &merged(TEXT, &other)).unwrap(), "LowPass", &[0.1]), None);
        assert_eq!(merged("", &later), later);
        // Instances that ask in turn leave what is known as it is.
        let known = merged(TEXT, &later);
        assert_eq!(merged(&known, TEXT), known);
        assert_eq!(merged(&known, &later), known);
    }
}
