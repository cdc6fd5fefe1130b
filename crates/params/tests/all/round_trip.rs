//! Sets of the project to workbooks and back, with a person's changes in between.

use std::collections::BTreeSet;
use std::path::Path;

use blocksim_params::{
    Arrangement, Change, Comparison, Known, Tables, compare, edited, open_workbook, pack, quantities, unpack,
};

fn beside(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../params").join(name);
    std::fs::read_to_string(path).expect("the robot's parameters")
}

fn flagship() -> String {
    beside("irb2600.ron")
}

/// The workbook of the robot, in the sheets of its own file.
fn exported(text: &str) -> Vec<u8> {
    let found = quantities(text).expect("a set");
    let sheets = Arrangement::read(&beside("irb2600.sheets.ron"), &found).expect("sheets");
    blocksim_params::export(&[text], "irb2600.ron", &found, &sheets).expect("a workbook")
}

fn tables(bytes: &[u8]) -> Tables {
    open_workbook(bytes).expect("a workbook")
}

fn compared(bytes: &[u8], text: &str) -> Comparison {
    compare(&tables(bytes), &[text], &quantities(text).expect("a set"))
}

fn changed_text(text: &str, found: &Comparison) -> String {
    let texts = edited(&[text], &quantities(text).expect("a set"), &found.edits).expect("a set");
    texts.concat()
}

/// The workbook with the content of some cells replaced, as if by a person: sheet number from 1, cell, new XML.
fn changed(bytes: &[u8], cells: &[(usize, &str, &str)]) -> Vec<u8> {
    let mut parts = unpack(bytes).expect("parts");
    for (sheet, cell, new) in cells {
        let name = format!("xl/worksheets/sheet{sheet}.xml");
        let (_, text) = parts.iter_mut().find(|(known, _)| *known == name).expect("the sheet");
        let start = text.find(&format!("<c r=\"{cell}\"")).expect("the cell");
        let end = start + text[start..].find("</c>").expect("its end") + 4;
        text.replace_range(start..end, new);
    }
    pack(&parts).expect("an archive")
}

/// Sheet from 1 and cell of a quantity.
fn place(bytes: &[u8], path: &str) -> (usize, String) {
    let tables = tables(bytes);
    let reading = tables.readings.get(path).unwrap_or_else(|| panic!("{path} is in the workbook"));
    let sheets = blocksim_params::read_book(bytes, |_| false).expect("a workbook").names;
    let number = sheets.iter().position(|name| *name == reading.spot.sheet).expect("the sheet");
    (number + 1, reading.spot.cell.to_string())
}

fn number(cell: &str, number: &str) -> String {
    format!("<c r=\"{cell}\"><v>{number}</v></c>")
}

fn words(cell: &str, text: &str) -> String {
    format!("<c r=\"{cell}\" t=\"inlineStr\"><is><t>{text}</t></is></c>")
}

/// The workbook of the robot with one cell replaced by what `xml` makes of its address.
fn with(path: &str, xml: impl Fn(&str) -> String) -> (String, Vec<u8>, String) {
    let text = flagship();
    let bytes = exported(&text);
    let (sheet, cell) = place(&bytes, path);
    let bytes = changed(&bytes, &[(sheet, &cell, &xml(&cell))]);
    (text, bytes, cell)
}

#[test]
fn an_exported_set_comes_back_unchanged_with_every_number_in_one_of_nine_sheets() {
    let text = flagship();
    let bytes = exported(&text);
    let found = compared(&bytes, &text);
    assert_eq!(found, Comparison { known: Known::Current, ..Comparison::default() });
    let all = quantities(&text).expect("a set");
    assert!(all.len() > 400, "{}", all.len());
    assert_eq!(tables(&bytes).readings.values().filter(|reading| reading.value.is_some()).count(), all.len());
    let sheets: BTreeSet<String> = tables(&bytes).readings.values().map(|r| r.spot.sheet.clone()).collect();
    let numbers: Vec<&str> = sheets.iter().map(|name| &name[..3]).collect();
    assert_eq!(numbers, ["(1)", "(2)", "(3)", "(4)", "(5)", "(6)", "(7)", "(8)", "(9)"]);
    assert_eq!(exported(&text), bytes, "the same text gives the same bytes");
}

#[test]
fn one_changed_cell_changes_one_numeral() {
    for xml in [|cell: &str| number(cell, "0.25"), |cell: &str| words(cell, "0,25")] {
        let (text, bytes, _) = with("axis3.gear.efficiency_backward", xml);
        let found = compared(&bytes, &text);
        assert!(found.faults.is_empty() && found.conflicts.is_empty() && found.since.is_empty(), "{found:?}");
        let [Change { path, old: Some(old), new: Some(new), .. }] = found.edits.as_slice() else {
            panic!("{found:?}");
        };
        assert_eq!((path.as_str(), *old, *new), ("axis3.gear.efficiency_backward", 0.75, 0.25));
        let out = changed_text(&text, &found);
        let lines: Vec<_> = text.lines().zip(out.lines()).filter(|(a, b)| a != b).collect();
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].1, lines[0].0.replace("0.75", "0.25"));
        assert_eq!(out.len(), text.len());
    }
}

#[test]
fn another_unit_of_the_same_kind_is_converted_to_the_one_of_the_set() {
    let text = flagship();
    let bytes = exported(&text);
    let (sheet, cell) = place(&bytes, "axis1.limits.speed");
    let unit = format!("C{}", &cell[1..]);
    // All six speeds are now meant in rad/s; that of axis 1 is given anew.
    let bytes = changed(
        &bytes,
        &[(sheet, &unit, &words(&unit, "rad/s")), (sheet, &cell, &number(&cell, "3.0543261909900767"))],
    );
    let found = compared(&bytes, &text);
    assert!(found.faults.is_empty(), "{:?}", found.faults);
    assert_eq!(found.edits.len(), 5, "175 deg/s are 3.05 rad/s; the others grow: {:?}", found.edits);
    let speed = found.edits.iter().find(|change| change.path == "axis4.limits.speed").expect("a change");
    assert_eq!(speed.unit, "deg/s");
    assert!((speed.new.expect("a number") - 360.0 * 180.0 / std::f64::consts::PI).abs() < 1e-9);
}

#[test]
fn changes_of_the_set_since_the_export_are_kept_and_told() {
    let (text, bytes, _) = with("axis1.motor.inertia", |cell| number(cell, "0.002"));
    let newer = text.replacen("\"12 kg\"", "\"10 kg\"", 1);
    let found = compared(&bytes, &newer);
    assert_eq!(found.known, Known::Stale);
    assert_eq!(found.edits.iter().map(|c| c.path.as_str()).collect::<Vec<_>>(), ["axis1.motor.inertia"]);
    assert_eq!(
        found.since.iter().map(|c| c.difference.path.as_str()).collect::<Vec<_>>(),
        ["general.rated_payload"]
    );
    let out = changed_text(&newer, &found);
    assert!(out.contains("\"10 kg\"") && out.contains("\"0.002 kg*m^2\""));
}

#[test]
fn a_number_changed_on_both_sides_is_a_conflict_unless_both_agree() {
    let (text, bytes, _) = with("general.rated_payload", |cell| number(cell, "14"));
    let other = compared(&bytes, &text.replacen("\"12 kg\"", "\"10 kg\"", 1));
    assert_eq!(other.conflicts.len(), 1);
    let conflict = &other.conflicts[0];
    let sides = (conflict.exported.as_deref(), conflict.set.as_str(), conflict.sheet.as_str());
    assert_eq!((sides, conflict.unit.as_str()), ((Some("12"), "10", "14"), "kg"));
    let same = compared(&bytes, &text.replacen("\"12 kg\"", "\"14 kg\"", 1));
    assert!(same.conflicts.is_empty() && same.edits.is_empty(), "{same:?}");
}

#[test]
fn a_bad_cell_is_named_with_reason_and_remedy() {
    type Case<'a> = (&'a dyn Fn(&str) -> String, &'a str);
    let cases: [Case; 9] = [
        (&|cell| words(cell, "much"), "`much` is not a number"),
        (&|cell| words(cell, "1.500"), "thousands separator"),
        (&|cell| words(cell, "12 kg"), "more than a number"),
        (&|cell| format!("<c r=\"{cell}\" t=\"e\"><f>1/0</f><v>#DIV/0!</v></c>"), "fails with #DIV/0!"),
        (&|cell| format!("<c r=\"{cell}\"><f>A1*2</f></c>"), "has no result"),
        (&|cell| format!("<c r=\"{cell}\"><f>[1]Sheet1!A1</f><v>3</v></c>"), "another workbook"),
        (&|cell| format!("<c r=\"{cell}\" t=\"b\"><v>1</v></c>"), "TRUE or FALSE"),
        (&|cell| format!("<c r=\"{cell}\" t=\"d\"><v>2026-01-05</v></c>"), "a date"),
        (&|cell| format!("<c r=\"{cell}\" s=\"3\"></c>"), "is empty"),
    ];
    for (xml, message) in cases {
        let (text, bytes, cell) = with("axis2.asm.r_s", xml);
        let found = compared(&bytes, &text);
        assert_eq!(found.faults.len(), 1, "{message}: {found:?}");
        let fault = &found.faults[0];
        assert!(fault.message.contains(message), "{fault:?}");
        assert_eq!(fault.place(), format!("(7) Motor Parameters, cell {cell}"));
        assert!(!fault.help.is_empty() && found.edits.is_empty());
    }
}

#[test]
fn a_result_of_a_formula_is_a_number() {
    let (text, bytes, _) =
        with("axis2.asm.r_s", |cell| format!("<c r=\"{cell}\"><f>0.25*2</f><v>0.5</v></c>"));
    assert_eq!(compared(&bytes, &text).edits[0].new, Some(0.5));
}

#[test]
fn a_unit_of_another_kind_is_a_fault_of_its_cell_and_told_once() {
    let text = flagship();
    let bytes = exported(&text);
    let (sheet, cell) = place(&bytes, "axis1.limits.speed");
    let unit = format!("C{}", &cell[1..]);
    for wrong in ["m/s", "furlong", "deg"] {
        let found = compared(&changed(&bytes, &[(sheet, &unit, &words(&unit, wrong))]), &text);
        assert_eq!(found.faults.len(), 1, "{found:?}");
        assert_eq!(found.faults[0].place(), format!("(3) Axis Speed Limits, cell {unit}"));
    }
}

/// A workbook whose parts were changed as texts.
fn rewritten(bytes: &[u8], part: &str, change: impl Fn(&str) -> String) -> Vec<u8> {
    let mut parts = unpack(bytes).expect("parts");
    let (_, text) = parts.iter_mut().find(|(name, _)| name == part).expect("the part");
    *text = change(text);
    pack(&parts).expect("an archive")
}

#[test]
fn missing_sheets_rows_headings_and_merged_cells_are_told() {
    let text = flagship();
    let bytes = exported(&text);
    let faults = |bytes: &[u8]| compared(bytes, &text).faults;

    let renamed = faults(&rewritten(&bytes, "xl/workbook.xml", |book| {
        book.replace("(7) Motor Parameters", "(7) Motors")
    }));
    assert_eq!(renamed.len(), 1, "{renamed:?}");
    assert_eq!(
        (renamed[0].place().as_str(), renamed[0].message.as_str()),
        ("(7) Motor Parameters", "the sheet is missing")
    );

    // The column of keys is B; its heading stands in the third row.
    let key = |path: &str| format!("B{}", &place(&bytes, path).1[1..]);
    let inertia = key("axis1.gear.inertia");
    let lost = faults(&changed(&bytes, &[(8, &inertia, &words(&inertia, "axis*.gear.inertial"))]));
    assert_eq!(lost.len(), 12, "six lost and six of another name: {lost:?}");
    assert!(lost.iter().any(|fault| fault.help.contains("did you mean `axis1.gear.inertia`?")));

    let headless = faults(&changed(&bytes, &[(8, "B3", &words("B3", ""))]));
    assert_eq!(headless.len(), 1, "{headless:?}");

    let merge = "</sheetData><mergeCells count=\"1\"><mergeCell ref=\"D5:E5\"/></mergeCells>";
    let sheet = "xl/worksheets/sheet8.xml";
    let merged = faults(&rewritten(&bytes, sheet, |page| page.replace("</sheetData>", merge)));
    assert!(
        merged.iter().any(|fault| fault.place().ends_with("cell D5") && fault.message.contains("merged")),
        "{merged:?}"
    );

    let discs = key("axis1.gear.disc_teeth");
    let twice = faults(&changed(&bytes, &[(8, &discs, &words(&discs, "axis*.gear.ring_teeth"))]));
    assert!(twice.iter().any(|fault| fault.message.contains("stands here and in")), "{twice:?}");
}

#[test]
fn without_the_hidden_sheet_cells_are_compared_with_the_set_as_it_is() {
    let (text, bytes, _) = with("general.rated_payload", |cell| number(cell, "14"));
    let bytes =
        rewritten(&bytes, "xl/workbook.xml", |book| book.replace("name=\"blocksim\"", "name=\"mine\""));
    let found = compared(&bytes, &text);
    assert_eq!((found.known, found.edits.len()), (Known::Nothing, 1));
}

#[test]
fn own_rows_do_no_harm() {
    let text = flagship();
    let bytes = exported(&text);
    let own =
        "<row r=\"900\"><c r=\"A900\" t=\"inlineStr\"><is><t>my own remark</t></is></c></row></sheetData>";
    let bytes = rewritten(&bytes, "xl/worksheets/sheet2.xml", |page| page.replace("</sheetData>", own));
    assert_eq!(compared(&bytes, &text).faults, []);
}

#[test]
fn expressions_and_mixed_units_survive_the_way() {
    let text =
        "(axis1: (limits: (lower: \"-1 deg\")), axis2: (limits: (lower: \"-1 rad\")), m: 2, twice: \"2 * m\",
        long: [1, 2, 3, 4], tcp_limits: (speed: \"1 m/s\"))";
    let found = quantities(text).expect("a set");
    let sheets = Arrangement::by_group(&found);
    let bytes = blocksim_params::export(&[text], "set.ron", &found, &sheets).expect("a workbook");
    assert_eq!(compared(&bytes, text), Comparison { known: Known::Current, ..Comparison::default() });
    let (sheet, cell) = place(&bytes, "twice");
    let bytes = changed(&bytes, &[(sheet, &cell, &number(&cell, "4"))]);
    let found = compared(&bytes, text);
    assert!(found.faults[0].message.contains("is computed in the set"), "{found:?}");
}
