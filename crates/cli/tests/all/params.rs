//! `blocksim params` as users call it: what is told, what is written and what is left alone.

use std::fs;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};

use crate::support::program;

const SET: &str =
    "// a set\n(\n    gain: (value: 2, note: \"estimated\"), // first\n    lag: \"250 ms\",\n)\n";
const MODEL: &str = r#"Diagram(
    parameters: { "set": File("set.ron") },
    simulation: (stop_time: "1 s"),
    blocks: { "one": Constant(value: 1.0), "lag": LowPass(tau: "set.lag"), "scope": Scope(inputs: ["y"]) },
    connections: ["one.y -> lag.u", "lag.y -> scope.y"],
)
"#;

struct Desk(PathBuf);

impl Desk {
    fn new() -> Desk {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let n = COUNT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("blocksim-params-{}-{n}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        fs::write(path.join("set.ron"), SET).unwrap();
        fs::write(path.join("model.ron"), MODEL).unwrap();
        Desk(path)
    }

    /// Exit code and everything that was said.
    fn call(&self, arguments: &str) -> (i32, String) {
        let mut command = program();
        command.current_dir(&self.0).arg("params").args(arguments.split(' ')).env_remove("CLICOLOR_FORCE");
        let output = command.output().unwrap();
        let said = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
        (output.status.code().unwrap(), said.concat())
    }

    fn set(&self) -> String {
        fs::read_to_string(self.0.join("set.ron")).unwrap()
    }

    /// Exports and changes the cells of the first sheet that hold this XML.
    fn book_with(&self, old: &str, new: &str) {
        assert_eq!(self.call("export set.ron --yes").0, 0);
        let path = self.0.join("set.xlsx");
        let mut parts = blocksim_params::unpack(&fs::read(&path).unwrap()).unwrap();
        let (_, page) = parts.iter_mut().find(|(name, _)| name.ends_with("sheet1.xml")).unwrap();
        assert!(page.contains(old), "{page}");
        *page = page.replace(old, new);
        fs::write(path, blocksim_params::pack(&parts).unwrap()).unwrap();
    }
}

impl Drop for Desk {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[test]
fn an_import_shows_first_and_writes_when_told() {
    let desk = Desk::new();
    desk.book_with("<v>250</v>", "<v>300</v>");
    let (code, said) = desk.call("import set.xlsx set.ron");
    assert_eq!(code, 1, "{said}");
    assert!(said.contains("Parameters!D5  lag        250  300  ms") && said.contains("add --yes"), "{said}");
    assert_eq!(desk.set(), SET);
    assert_eq!(desk.call("import set.xlsx set.ron --out new.ron").0, 0);
    assert_eq!(desk.set(), SET);
    assert_eq!(desk.call("import set.xlsx set.ron --out new.ron").0, 4, "a file that is there is kept");
    assert_eq!(desk.call("import set.xlsx set.ron --yes --model model.ron").0, 0);
    assert_eq!(desk.set(), SET.replace("250 ms", "300 ms"));
    let (code, said) = desk.call("import set.xlsx set.ron --yes");
    assert_eq!((code, said.contains("no number changes")), (0, true), "{said}");
    assert_eq!(desk.call("diff set.ron set.xlsx"), (0, String::new()));
    fs::write(desk.0.join("old.ron"), SET).unwrap();
    let (code, said) = desk.call("diff old.ron set.ron");
    assert_eq!((code, said.as_str()), (1, "parameter  old  new  unit\nlag        250  300  ms\n"));
}

#[test]
fn nothing_is_written_from_a_workbook_with_errors_or_against_the_model() {
    let desk = Desk::new();
    desk.book_with("<v>250</v>", "<v>#N/A</v>");
    let (code, said) = desk.call("import set.xlsx set.ron --yes");
    assert!(code == 3 && said.contains("error[workbook]: set.xlsx: Parameters, cell D5: "), "{said}");
    desk.book_with("<v>250</v>", "<v>-1</v>");
    for verb in ["check", "import --yes"] {
        let (code, said) = desk.call(&format!("{verb} set.xlsx set.ron --model model.ron"));
        assert_eq!(code, 3, "{said}");
        assert!(said.contains("changed in the workbook: Parameters, cell D5 (`lag`)"), "{said}");
    }
    assert_eq!(desk.set(), SET);
}

#[test]
fn what_was_changed_on_both_sides_is_told_and_left() {
    let desk = Desk::new();
    desk.book_with("<v>250</v>", "<v>300</v>");
    fs::write(desk.0.join("set.ron"), SET.replace("value: 2", "value: 3")).unwrap();
    let (code, said) = desk.call("check set.xlsx set.ron");
    assert!(code == 0 && said.contains("warning: the set has changed") && said.contains("gain"), "{said}");
    fs::write(desk.0.join("set.ron"), SET.replace("250", "100")).unwrap();
    let (code, said) = desk.call("import set.xlsx set.ron --yes");
    assert!(code == 3 && said.contains("Parameters!D5  lag             250  100       300  ms"), "{said}");
    assert!(desk.set().contains("100 ms"));
}

#[test]
fn a_number_that_became_an_expression_is_listed_and_its_changed_cell_is_not_dropped() {
    let desk = Desk::new();
    desk.book_with("<v>250</v>", "<v>250</v>");
    let computed = SET.replace("250 ms", "2 * 100 ms");
    fs::write(desk.0.join("set.ron"), &computed).unwrap();
    let (code, said) = desk.call("import set.xlsx set.ron --yes");
    assert!(code == 0 && said.contains("Parameters!D5  lag        250 ms  `2 * 100 ms`"), "{said}");
    fs::write(desk.0.join("set.ron"), SET).unwrap();
    desk.book_with("<v>250</v>", "<v>300</v>");
    fs::write(desk.0.join("set.ron"), &computed).unwrap();
    for verb in ["check", "import --yes"] {
        let (code, said) = desk.call(&format!("{verb} set.xlsx set.ron"));
        assert!(code == 3 && said.contains("lag          250 ms  `2 * 100 ms`    300 ms"), "{said}");
    }
    assert_eq!(desk.set(), computed);
}

#[test]
fn files_that_cannot_be_read_are_told() {
    let desk = Desk::new();
    for arguments in
        ["import set.ron set.ron", "check nothing.xlsx set.ron", "export nothing.ron", "check . set.ron"]
    {
        let (code, said) = desk.call(arguments);
        assert!(code == 4 && said.contains("error[unreadable]: cannot read"), "{arguments}: {said}");
    }
    let (code, said) = desk.call("check set.ron model.ron");
    assert!(code != 0, "{said}");
    assert_eq!(desk.call("export set.ron").0, 0);
    assert_eq!(desk.call("export set.ron").0, 4, "a workbook that is there is kept");
}

#[test]
fn a_model_has_a_sheet_for_its_top_level_its_subsystems_and_its_sets() {
    let desk = Desk::new();
    let inner = r#"Diagram(parameters: { "k": 3 }, inputs: { "u": () }, outputs: { "y": "gain.y" },
    blocks: { "gain": Gain(k: "k"), "add": Gain(k: 0.5) }, connections: ["in.u -> add.u", "add.y -> gain.u"])"#;
    fs::write(desk.0.join("inner.ron"), inner).unwrap();
    let model = MODEL
        .replace("\"scope\": ", "\"arm\": Subsystem(file: \"inner.ron\"), \"scope\": ")
        .replace("\"lag.y -> ", "\"lag.y -> arm.u\", \"arm.y -> ");
    fs::write(desk.0.join("model.ron"), &model).unwrap();
    assert_eq!(desk.call("export model.ron"), (0, "model.xlsx: 7 numbers in 3 sheets\n".to_owned()));
    assert_eq!(
        desk.call("check model.xlsx model.ron"),
        (0, "model.xlsx: no errors; 7 numbers, 0 changed\n".to_owned())
    );

    let path = desk.0.join("model.xlsx");
    let mut parts = blocksim_params::unpack(&fs::read(&path).unwrap()).unwrap();
    for (_, page) in &mut parts {
        *page = page.replace("<v>0.5</v>", "<v>0.75</v>").replace("<v>250</v>", "<v>300</v>");
    }
    fs::write(&path, blocksim_params::pack(&parts).unwrap()).unwrap();
    let (code, said) = desk.call("import model.xlsx model.ron");
    assert!(code == 1 && said.contains("arm!D6  arm/add.k") && said.contains("set!D5  set.lag"), "{said}");
    assert!(said.contains("add --yes to change `set.ron`, `inner.ron`"), "{said}");
    let (code, said) = desk.call("import model.xlsx model.ron --out new.ron");
    assert!(code == 2 && said.contains("numbers change in `set.ron` too"), "{said}");
    assert_eq!(
        (desk.set().as_str(), fs::read_to_string(desk.0.join("inner.ron")).unwrap().as_str()),
        (SET, inner)
    );
    assert_eq!(desk.call("import model.xlsx model.ron --yes").0, 0);
    assert_eq!(desk.set(), SET.replace("250", "300"));
    assert_eq!(fs::read_to_string(desk.0.join("inner.ron")).unwrap(), inner.replace("0.5", "0.75"));
    assert_eq!(fs::read_to_string(desk.0.join("model.ron")).unwrap(), model);
}

#[test]
fn a_file_beside_a_set_names_its_sheets() {
    let desk = Desk::new();
    let sheets = desk.0.join("set.sheets.ron");
    fs::write(
        &sheets,
        "(sheets: [(name: \"Times\", holds: [\"lag\"]), (name: \"Gains\", holds: [\"gain\"])])",
    )
    .unwrap();
    assert_eq!(desk.call("export set.ron"), (0, "set.xlsx: 2 numbers in 2 sheets\n".to_owned()));
    fs::write(&sheets, "(sheets: [(name: \"Times\", holds: [\"lags\", \"*\"])])").unwrap();
    let (code, said) = desk.call("export set.ron --out other.xlsx");
    assert!(
        code == 3 && said.contains("set.sheets.ron:1:35") && said.contains("did you mean `lag`?"),
        "{said}"
    );
    assert!(!desk.0.join("other.xlsx").exists());
}
