//! Finding: `blocksim help`, `manual` and `blocks` with words.

use crate::desk::Desk;
use crate::support::root;
use expect_test::expect;

fn out(words: &[&str]) -> String {
    let desk = Desk::with(&[]);
    let answer = desk.call(words);
    assert_eq!(answer.code, Some(0), "{words:?}: {}", answer.text());
    answer.out
}

#[test]
fn words_find_commands_options_pages_blocks_and_problems() {
    expect![[r#"
        Commands and options
          blocksim identify friction --drive NAME     Drive of the axes; without ...
          blocksim run --set TARGET=VALUE             Sets a parameter for this ...
          blocksim edit add --into PORT               Ends of the wire that it ...
          blocksim identify friction --motor PATTERN  Signals with the torques ...

        Pages of the manual
          blocksim manual irb2600           Drives
          blocksim manual operation         3. Choose drives and control
          blocksim manual tutorials/drives  Asynchronous machines against ...

        Blocks
          blocksim blocks CycloidalDrive                  Cycloidal gear: a disc ...
          blocksim blocks HarmonicDrive                   Harmonic drive: a wave ...
          blocksim blocks StepperDriver                   Commands for the two ...
          blocksim blocks DirectionReverser               Splits a signed command ...
          blocksim blocks Differential                    Differential: the drive ...
          blocksim blocks AsynchronousMachine             Three-phase induction ...
          blocksim blocks AsynchronousMachineByNamePlate  Three-phase induction ...
          blocksim blocks DcMotor                         Brushed motor with ...
          and 29 more: add a word to see fewer

        Problems
          blocksim explain second_driver      Two signals are connected to ...
          blocksim explain open_derivative    A source of speed moves what ...
          blocksim explain unconnected_input  An input has no driver and ...
          blocksim explain domain_mismatch    Two conserving ports of ...
          blocksim explain missing_supply     Three-phase machines are ...
          blocksim explain move_limits        A warning: a move exceeds a ...
          blocksim explain unconnected_port   A conserving port that must ...
    "#]]
    .assert_eq(&out(&["help", "drive"]));
    expect![[r#"
        Commands and options
          blocksim params                      Parameters of a model ...
          blocksim params export               Write the parameters of a ...
          blocksim params import               Take changed numbers from a ...
          blocksim params diff                 List the numbers that ...
          blocksim params check                Report what is wrong in a ...
          blocksim params export --out FILE    The workbook; without it ...
          blocksim params export --yes         Replace a workbook that is ...
          blocksim params check --model MODEL  Check this model with the ...

        Pages of the manual
          blocksim manual params     Parameters in a workbook
          blocksim manual operation  Prerequisites

        Problems
          blocksim explain workbook  A cell of a workbook does not contain ...
          blocksim explain left_out  The program was built without a part ...
    "#]]
    .assert_eq(&out(&["help", "excel"]));
}

#[test]
fn the_words_of_a_command_give_its_help() {
    assert_eq!(out(&["help"]), out(&["--help"]));
    for command in [&["run"][..], &["params", "set"], &["plugin", "new"]] {
        let help = out(&[&["help"][..], command].concat());
        assert_eq!(help, out(&[command, &["--help"]].concat()), "{command:?}");
    }
}

#[test]
fn blocks_are_found_by_what_they_are() {
    expect![[r#"
          FrameSpringDamper          A spring and a damper between the ...
          RotationalSpring           Torsion spring between two turning parts.
          RotationalSpringDamper     Elastic shaft: a torsion spring and a ...
          TranslationalSpring        Spring between two sliding parts.
          TranslationalSpringDamper  Elastic link: a spring and a damper ...
          ElasticGear                Gear whose teeth and shafts give way ...
          RotationalHardStop         End of travel between two turning ...
          TranslationalHardStop      End of travel between two sliding ...

        `blocksim blocks KIND` describes one of them.
    "#]]
    .assert_eq(&out(&["blocks", "spring"]));
    let page = out(&["blocks", "delay"]);
    assert!(
        page.starts_with("Delay (Discrete)")
            && page.contains("\nSee also ")
            && page.contains("TransportDelay"),
        "{page}"
    );
    let found = out(&["blocks", "coil", "--json"]);
    let first: serde_json::Value = serde_json::from_str(found.lines().next().expect("a line")).expect("JSON");
    assert_eq!(first["type"], "block");
    assert!(found.contains("\"kind\":\"Inductor\""), "{found}");
}

#[test]
fn every_page_of_the_manual_is_printed_whole_or_by_sections() {
    let list = out(&["manual"]);
    let docs =
        std::fs::read_dir(root().join("docs")).expect("the manual").map(|page| page.expect("a page").path());
    let pages: Vec<_> = docs.filter(|path| path.extension().is_some_and(|ending| ending == "md")).collect();
    assert!(pages.len() > 20);
    for path in pages {
        let name = path.file_stem().and_then(|name| name.to_str()).expect("a name");
        let page = out(&["manual", name]);
        let text = std::fs::read_to_string(&path).expect("a page");
        // Code is indented on the page, so that its comments are no headings.
        let plain: String = text.split("```").step_by(2).collect();
        let headings = |text: &str| text.lines().filter(|line| line.starts_with('#')).count();
        assert_eq!(page.lines().next(), text.lines().next(), "{name}");
        assert_eq!(headings(&page), headings(&plain), "{name}: {page}");
        assert!(!page.contains("]("), "{name} shows an address: {page}");
        assert!(name == "README" || list.contains(&format!("{name} ")), "{list}");
    }
    let units = out(&["manual", "docs/language.md", "units"]);
    assert!(units.starts_with("### Units\n") && !units.contains("# The diagram language"), "{units}");
}

#[test]
fn the_manual_is_written_as_a_site_and_replaced_on_request_alone() {
    let desk = Desk::with(&[("notes.txt", "mine")]);
    let answer = desk.call(&["manual", "--site", "site"]);
    assert_eq!((answer.code, answer.err.as_str()), (Some(0), ""), "{answer:?}");
    assert!(answer.out.contains(" pages, open site") && answer.out.contains("index.html"), "{}", answer.out);
    let page = desk.read("site/blocks/LowPass.html");
    for part in
        ["<h1 id=\"lowpass\">LowPass</h1>", "<math", "id=\"parameters\"", "<svg", "pictures/LowPass-dark.svg"]
    {
        assert!(page.contains(part), "{part}: {page}");
    }
    assert!(desk.read("site/search-index.js").contains("blocks/LowPass.html"));
    let said = desk.said(&["manual", "--site", "site"]);
    assert!(said.contains("error[exists]: `site` already exists") && said.contains("add --yes"), "{said}");
    assert_eq!(desk.call(&["manual", "--site", "site", "--yes"]).code, Some(0));
    let said = desk.said(&["manual", "--site", ".", "--yes"]);
    assert!(
        said.contains("is not a manual, and is left alone") && desk.read("notes.txt") == "mine",
        "{said}"
    );
}

#[test]
fn what_is_not_found_gets_a_remedy() {
    let desk = Desk::with(&[]);
    let said = |words: &[&str]| desk.said(words);
    expect![[r#"
        error[usage]: nothing is about `zzzz`
          = help: `blocksim help` lists the commands, `blocksim manual` the pages, `blocksim blocks` the blocks
        exit code 2
        error[usage]: nothing is about `pramas`
          = help: did you mean `blocksim help params`?
        exit code 2
        error[usage]: the manual has no page `langauge`
          = help: did you mean `language`?
        exit code 2
        error[usage]: the manual has no page `zzzz`
          = help: `blocksim manual` lists all pages, `blocksim help zzzz` finds what is about it
        exit code 2
        error[usage]: no section of `editors` is about `zzzz`
          = help: its sections are `Rename`, `Visual Studio Code`, `Helix and Neovim`, `Other editors`
        exit code 2
        error[usage]: there is no block `Intergrator`
          = help: did you mean `Integrator`?
        exit code 2
    "#]].assert_eq(
        &[
            said(&["help", "zzzz"]),
            said(&["help", "pramas"]),
            said(&["manual", "langauge"]),
            said(&["manual", "zzzz"]),
            said(&["manual", "editors", "zzzz"]),
            said(&["blocks", "Intergrator"]),
        ]
        .concat(),
    );
}
