//! A quantity at the export, in the set and in the workbook: every combination, beside a table of what must come of it.

use blocksim_params::{
    Address, Arrangement, Book, Cell, Comparison, Content, Known, MEMORY, compare, edited, export,
    quantities, read_book, read_tables,
};

/// What one side has of the quantity; numbers in SI, with a letter for their dimension.
#[derive(Debug, Clone, PartialEq)]
enum Side {
    Nothing,
    Number(char, f64),
    Words(String),
}

/// Dimension and factor of a unit.
fn factor(unit: &str) -> (char, f64) {
    match unit {
        "" => ('1', 1.0),
        "ohm" => ('R', 1.0),
        "kohm" => ('R', 1e3),
        "V" => ('U', 1.0),
        _ => ('?', 1.0),
    }
}

fn number(value: f64, unit: &str) -> Side {
    let (dimension, factor) = factor(unit);
    Side::Number(dimension, value * factor)
}

/// Contents of the set: as written, what it is, and the unit of the row that it is exported to.
fn contents() -> Vec<(&'static str, Side, &'static str)> {
    let words = |text: &str| Side::Words(text.to_owned());
    vec![
        ("", Side::Nothing, ""),
        ("5", number(5.0, ""), ""),
        ("\"5 ohm\"", number(5.0, "ohm"), "ohm"),
        ("\"7 ohm\"", number(7.0, "ohm"), "ohm"),
        ("\"0.005 kohm\"", number(5.0, "ohm"), "kohm"),
        ("\"5 V\"", number(5.0, "V"), "V"),
        ("\"1 + 2\"", words("1 + 2"), ""),
        ("\"2 * 3 ohm\"", words("2 * 3 ohm"), ""),
        ("\"1,5\"", words("1,5"), ""),
        ("\"2 *\r\n l\"", words("2 *\r\n l"), ""),
        ("\"\"", words(""), ""),
    ]
}

fn set(content: &str) -> String {
    let member = if content.is_empty() { String::new() } else { format!("r: {content}, ") };
    format!("(l: \"3 mH\", {member}twice: \"2 * l\")")
}

fn exported(text: &str) -> Book {
    let all = quantities(text).expect("a set");
    let bytes = export(&[text], "set.ron", &all, &Arrangement::by_group(&all)).expect("a workbook");
    read_book(&bytes, |_| true).expect("a workbook")
}

/// What a person does to the cell of the value.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Deed {
    Leave,
    Number(f64),
    Text(&'static str),
    Empty,
    DeleteRow,
}

/// Does it, and writes a unit beside it; where there is no row, one is added. What the workbook has then.
fn change(book: &mut Book, deed: Deed, unit: Option<&str>, base: &Side, exported_unit: &str) -> Side {
    let sheet = book.sheets.iter_mut().find(|sheet| sheet.name != MEMORY).expect("a sheet");
    let at = |row, column| Address { row, column };
    let known =
        sheet.cells.keys().find(|at| at.column == 1 && sheet.text(**at) == Some("r")).map(|at| at.row);
    let row = known.unwrap_or(40);
    let text = |text: &str| Cell::Text(text.to_owned());
    if known.is_none() && deed != Deed::Leave {
        sheet.cells.insert(at(row, 1), text("r"));
    }
    match deed {
        Deed::Leave => {}
        Deed::Number(value) => drop(sheet.cells.insert(at(row, 3), Cell::Number(value))),
        Deed::Text(words) => drop(sheet.cells.insert(at(row, 3), text(words))),
        Deed::Empty => drop(sheet.cells.remove(&at(row, 3))),
        Deed::DeleteRow => sheet.cells.retain(|at, _| at.row != row),
    }
    if let Some(unit) = unit.filter(|_| deed != Deed::DeleteRow) {
        sheet.cells.insert(at(row, 2), text(unit));
    }
    let unit_now = unit.unwrap_or(exported_unit);
    // An expression is exported without a unit: whoever writes one there has changed something.
    let beside = |words: &str| match (base, unit) {
        (Side::Words(_), Some(unit)) => Side::Words(format!("{words} in {unit}")),
        _ => Side::Words(words.to_owned()),
    };
    match (deed, base) {
        (Deed::Number(value), _) => number(value, unit_now),
        (Deed::Text(words), _) => beside(words),
        (Deed::Leave, Side::Number(..)) => {
            let Some(Cell::Number(value)) = sheet.cells.get(&at(row, 3)) else { panic!("a number") };
            number(*value, unit_now)
        }
        (Deed::Leave, Side::Words(words)) => beside(words),
        // An empty text has an empty cell.
        (Deed::Empty, Side::Words(words)) if words.is_empty() => beside(words),
        _ => Side::Nothing,
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Outcome {
    Nothing,
    Taken,
    Kept,
    Refused,
    Conflict,
}

/// The table.
fn expected(base: &Side, set: &Side, sheet: &Side) -> Outcome {
    let alike = |a: &Side, b: &Side| matches!((a, b), (Side::Number(a, _), Side::Number(b, _)) if a == b);
    match (sheet == base, set == base) {
        (true, true) => Outcome::Nothing,
        (true, false) => Outcome::Kept,
        _ if sheet == set => Outcome::Nothing,
        (false, true) if alike(base, sheet) => Outcome::Taken,
        (false, true) => Outcome::Refused,
        (false, false) if alike(base, sheet) && *set != Side::Nothing => Outcome::Conflict,
        (false, false) => Outcome::Refused,
    }
}

fn outcome(found: &Comparison) -> Outcome {
    let counts = [found.faults.len(), found.conflicts.len(), found.edits.len(), found.since.len()];
    match counts {
        [0, 0, 0, 0] => Outcome::Nothing,
        [0, 0, 1, 0] => Outcome::Taken,
        [0, 0, 0, 1] => Outcome::Kept,
        [0, 1, 0, 0] => Outcome::Conflict,
        [faults, _, 0, _] if faults > 0 => Outcome::Refused,
        _ => panic!("{found:?}"),
    }
}

/// The quantity of a set as a side.
fn side_of(text: &str) -> Side {
    let all = quantities(text).expect("a set");
    match all.iter().find(|quantity| quantity.path == "r").map(|quantity| &quantity.content) {
        None => Side::Nothing,
        Some(Content::Number { value, unit, .. }) => number(*value, unit),
        Some(Content::Expression(text)) => Side::Words(text.clone()),
    }
}

#[test]
fn what_changed_on_one_side_is_taken_kept_or_refused_and_on_both_must_agree() {
    let deeds = [
        Deed::Leave,
        Deed::Number(5.0),
        Deed::Number(7.0),
        Deed::Text("1 + 2"),
        Deed::Text("2 * 3 ohm"),
        Deed::Text("much"),
        Deed::Empty,
        Deed::DeleteRow,
    ];
    let mut seen = [0; 5];
    for (before, base, exported_unit) in contents() {
        let exported = exported(&set(before));
        for (now, side, _) in contents() {
            for deed in deeds {
                for unit in [None, Some("ohm"), Some("kohm"), Some("V"), Some("furlong")] {
                    let is_same_unit = unit == Some(exported_unit);
                    if is_same_unit || unit.is_some() && base == Side::Nothing && deed == Deed::Leave {
                        continue;
                    }
                    let mut book = exported.clone();
                    let mut sheet = change(&mut book, deed, unit, &base, exported_unit);
                    // An empty cell is what nothing and an empty text are exported as.
                    let empty = Side::Words(String::new());
                    let is_blank = deed == Deed::Empty || deed == Deed::Leave && base == empty;
                    if is_blank && (side == Side::Nothing || side == empty && sheet == Side::Nothing) {
                        sheet = side.clone();
                    }
                    let text = set(now);
                    let all = quantities(&text).expect("a set");
                    let found = compare(&read_tables(&book), &[&text], &all);
                    let case = format!("{before} now {now}, the cell {deed:?} in {unit:?}: {found:#?}");
                    let is = outcome(&found);
                    let should = expected(&base, &side, &sheet);
                    let both = [Outcome::Refused, Outcome::Conflict];
                    assert!(is == should || should == Outcome::Refused && both.contains(&is), "{case}");
                    assert_eq!(found.known == Known::Current, before == now, "{case}");
                    assert!(found.faults.iter().all(|fault| !fault.help.is_empty()), "{case}");
                    if is == Outcome::Taken {
                        let new = edited(&[&text], &all, &found.edits).expect("a set").concat();
                        let Side::Number(dimension, value) = side_of(&new) else { panic!("{case}") };
                        let Side::Number(_, meant) = sheet else { panic!("{case}") };
                        assert!((value - meant).abs() < 1e-9 * meant, "{case}");
                        assert!(matches!(side, Side::Number(known, _) if known == dimension), "{case}");
                    }
                    seen[is as usize] += 1;
                }
            }
        }
    }
    assert!(seen.iter().all(|count| *count > 20), "{seen:?}");
}

#[test]
fn numbers_that_became_expressions_and_the_reverse_are_shown_as_they_are_written() {
    let mut book = exported("(l: \"3 mH\", r: \"5 ohm\", e: \"1 + 2\")");
    let now = "(l: \"2 V\", r: \"2 * 3 ohm\", e: 7)";
    let compared = |book: &Book| compare(&read_tables(book), &[now], &quantities(now).expect("a set"));
    let sides = |old: Option<&str>, new: Option<&str>| [old, new].map(|side| side.map(str::to_owned));
    let since: Vec<_> = compared(&book)
        .since
        .into_iter()
        .map(|since| (since.difference.path, [since.difference.old, since.difference.new]))
        .collect();
    let expected = [
        ("l".to_owned(), sides(Some("3 mH"), Some("2 V"))),
        ("r".to_owned(), sides(Some("5 ohm"), Some("`2 * 3 ohm`"))),
        ("e".to_owned(), sides(Some("`1 + 2`"), Some("7"))),
    ];
    assert_eq!(since, expected);
    // The rows of `l`, `r` and `e` are the fourth to the sixth.
    for (row, value) in [(3, 4.0), (4, 8.0), (5, 9.0)] {
        let sheet = book.sheets.iter_mut().find(|sheet| sheet.name != MEMORY).expect("a sheet");
        sheet.cells.insert(Address { row, column: 3 }, Cell::Number(value));
    }
    let conflicts: Vec<_> = compared(&book)
        .conflicts
        .into_iter()
        .map(|one| {
            (one.cell.cell.to_string(), one.exported.unwrap_or_default(), one.set, one.sheet, one.unit)
        })
        .collect();
    let expected = [
        ("D4", "3 mH", "2 V", "4 mH", ""),
        ("D5", "5 ohm", "`2 * 3 ohm`", "8 ohm", ""),
        ("D6", "`1 + 2`", "7", "9", ""),
    ];
    let owned = |(a, b, c, d, e): (&str, &str, &str, &str, &str)| {
        (a.to_owned(), b.to_owned(), c.to_owned(), d.to_owned(), e.to_owned())
    };
    assert_eq!(conflicts, expected.map(owned));
}
