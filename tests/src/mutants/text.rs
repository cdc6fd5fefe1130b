//! Mistakes of people and of broken programs in texts.

use super::Dice;
use super::binary;

/// Numbers at and beyond the limits.
const NUMBERS: [&str; 24] = [
    "0",
    "-0.0",
    "1",
    "-1",
    "1e308",
    "1e309",
    "-1e308",
    "1e-308",
    "1e-320",
    "NaN",
    "inf",
    "-inf",
    "0.1",
    "1,5",
    "1_000",
    "0x10",
    "1e15",
    "18446744073709551616",
    "9223372036854775807",
    "-9223372036854775808",
    "4294967296",
    "1e",
    "1.2.3",
    "007",
];

/// Units, and what is none.
const UNITS: [&str; 24] = [
    "V", "kV", "A", "ohm", "H", "mH", "N*m", "kg*m^2", "rad", "deg", "rad/s", "1/min", "s", "ms", "Hz", "%",
    "degC", "m", "V/(m*s", "kg^99999", "m^-1/2", "furlong", "°", "Ω",
];

/// Signs that hurt where they land.
const SIGNS: [&str; 40] = [
    "(",
    ")",
    "[",
    "]",
    "{",
    "}",
    "<",
    ">",
    "\"",
    "'",
    "`",
    ",",
    ":",
    ";",
    "=",
    "->",
    "..",
    ".",
    "/",
    "//",
    "/*",
    "*/",
    "\\",
    "\\u{0}",
    "#",
    "&",
    "%",
    "$",
    "\0",
    "\u{1b}[2J",
    "\u{202e}",
    "\u{feff}",
    "ä",
    "Ö",
    "ß",
    "漢",
    "\u{1F600}",
    "\r",
    "\t",
    "-",
];

/// Names of kinds and members.
const NAMES: [&str; 32] = [
    "Diagram",
    "Integrator",
    "Gain",
    "Subsystem",
    "Variant",
    "File",
    "Plugin",
    "Scope",
    "Step",
    "Sine",
    "Sum",
    "Mux",
    "Demux",
    "Bus",
    "Pid",
    "Resistor",
    "Inertia",
    "Body",
    "World",
    "DcMotor",
    "blocks",
    "connections",
    "simulation",
    "parameters",
    "record",
    "Some",
    "None",
    "true",
    "false",
    "y",
    "u",
    "**",
];

/// Makes one change.
pub(super) fn change(bytes: &mut Vec<u8>, dice: &mut Dice) {
    match dice.below(16) {
        0 => binary::change(bytes, dice),
        1 => replace_token(bytes, dice, is_number, |dice| (*dice.one(&NUMBERS)).to_owned()),
        2 => replace_token(bytes, dice, is_word, |dice| (*dice.one(&NAMES)).to_owned()),
        3 => replace_token(bytes, dice, is_word, |dice| (*dice.one(&UNITS)).to_owned()),
        4 => swap_tokens(bytes, dice),
        5 => remove_token(bytes, dice),
        6 => double_token(bytes, dice),
        7 => insert(bytes, dice, SIGNS[..].as_ref()),
        8 => insert(bytes, dice, NUMBERS[..].as_ref()),
        9 => lines(bytes, dice, |lines, from, to| lines.swap(from, to)),
        10 => lines(bytes, dice, |lines, from, to| {
            let line = lines[from].clone();
            lines.insert(to, line);
        }),
        11 => lines(bytes, dice, |lines, from, _| drop(lines.remove(from))),
        12 => bracket(bytes, dice),
        13 => letter(bytes, dice),
        14 => nest(bytes, dice),
        _ => replace_number_by_neighbour(bytes, dice),
    }
}

fn is_word(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_' || byte >= 0x80
}

fn is_number(byte: u8) -> bool {
    byte.is_ascii_digit() || b".+-eE".contains(&byte)
}

/// Where runs of such bytes stand.
fn runs(bytes: &[u8], is_part: impl Fn(u8) -> bool) -> Vec<std::ops::Range<usize>> {
    let (mut found, mut begin) = (Vec::new(), None);
    for (at, byte) in bytes.iter().chain(std::iter::once(&b'\n')).enumerate() {
        match (is_part(*byte) && at < bytes.len(), begin) {
            (true, None) => begin = Some(at),
            (false, Some(from)) => {
                found.push(from..at);
                begin = None;
            }
            _ => {}
        }
    }
    found
}

/// Words and single signs.
fn tokens(bytes: &[u8]) -> Vec<std::ops::Range<usize>> {
    let mut found = runs(bytes, is_word);
    let signs = bytes.iter().enumerate().filter(|(_, byte)| !is_word(**byte) && !byte.is_ascii_whitespace());
    found.extend(signs.map(|(at, _)| at..at + 1));
    found.sort_by_key(|range| range.start);
    found
}

fn replace_token(
    bytes: &mut Vec<u8>,
    dice: &mut Dice,
    is_part: impl Fn(u8) -> bool,
    by: impl Fn(&mut Dice) -> String,
) {
    let mut found = runs(bytes, is_part);
    found.retain(|range| bytes[range.clone()].iter().any(u8::is_ascii_alphanumeric));
    if !found.is_empty() {
        let range = found[dice.below(found.len())].clone();
        let text = by(dice);
        bytes.splice(range, text.bytes());
    }
}

/// Puts one number of the file in the place of another.
fn replace_number_by_neighbour(bytes: &mut Vec<u8>, dice: &mut Dice) {
    let mut found = runs(bytes, is_number);
    found.retain(|range| bytes[range.clone()].iter().any(u8::is_ascii_digit));
    if !found.is_empty() {
        let other = bytes[found[dice.below(found.len())].clone()].to_vec();
        bytes.splice(found[dice.below(found.len())].clone(), other);
    }
}

fn swap_tokens(bytes: &mut Vec<u8>, dice: &mut Dice) {
    let found = tokens(bytes);
    if found.len() < 2 {
        return;
    }
    let mut places = [dice.below(found.len()), dice.below(found.len())];
    places.sort_unstable();
    let [first, second] = places.map(|place| found[place].clone());
    let texts = [first.clone(), second.clone()].map(|range| bytes[range].to_vec());
    if first.start != second.start {
        let [early, late] = texts;
        bytes.splice(second, early);
        bytes.splice(first, late);
    }
}

fn remove_token(bytes: &mut Vec<u8>, dice: &mut Dice) {
    let found = tokens(bytes);
    if !found.is_empty() {
        bytes.drain(found[dice.below(found.len())].clone());
    }
}

fn double_token(bytes: &mut Vec<u8>, dice: &mut Dice) {
    let found = tokens(bytes);
    if !found.is_empty() {
        let range = found[dice.below(found.len())].clone();
        let text = bytes[range.clone()].to_vec();
        bytes.splice(range.end..range.end, text);
    }
}

fn insert(bytes: &mut Vec<u8>, dice: &mut Dice, all: &[&str]) {
    let at = dice.below(bytes.len() + 1);
    bytes.splice(at..at, dice.one(all).bytes());
}

fn lines(bytes: &mut Vec<u8>, dice: &mut Dice, change: impl Fn(&mut Vec<Vec<u8>>, usize, usize)) {
    let mut all: Vec<Vec<u8>> = bytes.split(|byte| *byte == b'\n').map(<[u8]>::to_vec).collect();
    let [from, to] = [dice.below(all.len()), dice.below(all.len())];
    change(&mut all, from, to);
    *bytes = all.join(&b'\n');
}

/// Turns a bracket into another one.
fn bracket(bytes: &mut [u8], dice: &mut Dice) {
    let places: Vec<usize> = (0..bytes.len()).filter(|at| b"()[]{}<>\"".contains(&bytes[*at])).collect();
    if !places.is_empty() {
        bytes[places[dice.below(places.len())]] = *dice.one(b"()[]{}<>\" ");
    }
}

/// A slip within a word: a letter doubled, lost, exchanged with its neighbour, or with a dot on it.
fn letter(bytes: &mut Vec<u8>, dice: &mut Dice) {
    let places: Vec<usize> = (1..bytes.len()).filter(|at| bytes[*at].is_ascii_alphabetic()).collect();
    if places.is_empty() {
        return;
    }
    let at = places[dice.below(places.len())];
    match dice.below(4) {
        0 => bytes.insert(at, bytes[at]),
        1 => drop(bytes.remove(at)),
        2 => bytes.swap(at - 1, at),
        _ => drop(bytes.splice(at..=at, dice.one(&["ä", "ö", "ü", "é", "Ä", "\u{301}"]).bytes())),
    }
}

/// Opens very many brackets, or repeats a piece very often.
fn nest(bytes: &mut Vec<u8>, dice: &mut Dice) {
    let at = dice.below(bytes.len() + 1);
    let piece = *dice.one::<&str>(&["(", "[", "{", "a(", "[[", "\"", "-", "<a>", "/*"]);
    let times = *dice.one(&[3, 30, 300, 3000, 30_000]);
    bytes.splice(at..at, piece.repeat(times).into_bytes());
}
