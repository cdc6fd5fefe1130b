//! The robot's numbers by way of a workbook.

use blocksim_params::{Arrangement, compare, edited, export, open_workbook, pack, quantities, unpack};
use blocksim_tests::{Desk, Run, compile_with, root, run};

const SET: &str = "params/irb2600.ron";
const MODEL: &str = "diagrams/irb2600/irb2600.ron";

/// The first 50 ms with ideal torques and this text for the set.
fn begun(text: &str, overrides: &[&str]) -> Run {
    let set = root().join(SET);
    let desk = Desk::new().with(set.to_str().expect("a path"), text);
    let overrides: Vec<&str> = [&["drive=torque"], overrides].concat();
    let (compiled, problems) = compile_with(&desk, &root().join(MODEL), &overrides);
    let mut schedule = compiled.schedule.unwrap_or_else(|| panic!("{problems}"));
    schedule.settings.stop_time = 0.05;
    let run = run(schedule);
    assert!(run.error.is_none(), "{:?}", run.error);
    run
}

#[test]
fn a_changed_cell_changes_the_run_as_the_command_line_does() {
    let text = std::fs::read_to_string(root().join(SET)).expect("the set");
    let numbers = quantities(&text).expect("a set");
    let sheets = std::fs::read_to_string(root().join("params/irb2600.sheets.ron")).expect("the sheets");
    let sheets = Arrangement::read(&sheets, &numbers).expect("sheets");
    let book = export(&[&text], "irb2600.ron", &numbers, &sheets).expect("a workbook");

    // A person writes 120 with a comma into the cell of a friction torque.
    let cell = open_workbook(&book).expect("a workbook").readings["axis2.bearing.viscous"].spot.clone();
    let mut parts = unpack(&book).expect("parts");
    let number = sheets.sheets.iter().position(|name| *name == cell.sheet).expect("the sheet") + 1;
    let page = format!("xl/worksheets/sheet{number}.xml");
    let (_, xml) = parts.iter_mut().find(|(name, _)| *name == page).expect("the sheet");
    let start = xml.find(&format!("<c r=\"{}\"", cell.cell)).expect("the cell");
    let end = start + xml[start..].find("</c>").expect("its end") + 4;
    let typed = format!("<c r=\"{}\" t=\"inlineStr\"><is><t>120,0</t></is></c>", cell.cell);
    xml.replace_range(start..end, &typed);

    let tables = open_workbook(&pack(&parts).expect("an archive")).expect("a workbook");
    let found = compare(&tables, &[&text], &numbers);
    assert!(found.faults.is_empty() && found.edits.len() == 1, "{found:?}");
    let imported = begun(&edited(&[&text], &numbers, &found.edits).expect("a set").concat(), &[]);

    let set = begun(&text, &["robot.axis2.bearing.viscous=120 N*m*s/rad"]);
    let before = begun(&text, &[]);
    assert_eq!(imported.columns, set.columns, "bit by bit");
    assert_ne!(imported.columns, before.columns);
}
