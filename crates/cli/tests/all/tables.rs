//! Tables and runs as they come from other programs and other days: what is understood, and what is refused with place, reason
//! and remedy.

use std::fs;

use crate::desk::Desk;
use expect_test::expect;

/// What is right: eleven rows of an angle.
fn baseline() -> String {
    rows("time [s],q [deg]\n", 11, |k, t| format!("{t},{k}\n"))
}

fn rows(heading: &str, count: u32, row: impl Fn(u32, f64) -> String) -> String {
    heading.to_owned() + &(0..count).map(|k| row(k, f64::from(k) / 10.0)).collect::<String>()
}

/// The answers to a comparison with each of these tables, one behind the other.
fn compared(tables: &[(&str, Vec<u8>)]) -> String {
    let desk = Desk::with(&[("base.csv", &baseline())]);
    let answer = |(name, bytes): &(&str, Vec<u8>)| {
        fs::write(desk.0.join(name), bytes).unwrap();
        format!("{name}\n{}\n", desk.said(&["compare", "base.csv", name]))
    };
    tables.iter().map(answer).collect()
}

fn text(text: impl Into<String>) -> Vec<u8> {
    text.into().into_bytes()
}

#[test]
fn the_same_table_is_understood_however_it_is_written() {
    let same = baseline();
    let with_commas = same.replace(',', ";").replace('.', ",");
    let tables: [(&str, Vec<u8>); 8] = [
        ("byte_order_mark.csv", text(format!("\u{feff}{same}"))),
        ("windows.csv", text(same.replace('\n', "\r\n"))),
        ("decimal_commas.csv", text(with_commas.clone())),
        ("tabs.csv", text(same.replace(',', "\t"))),
        ("excel.csv", text(format!("sep=;\r\n{with_commas}"))),
        ("comments.csv", text(format!("# logged by \"X\n# on Monday\n{same}"))),
        ("line_of_units.csv", text(same.replace("time [s],q [deg]", "time,q\ns,deg"))),
        ("degree_sign.csv", text(same.replace("[deg]", "[°]"))),
    ];
    let answers = compared(&tables);
    assert_eq!(answers.matches("1 signal agrees").count(), tables.len(), "{answers}");
}

#[test]
fn what_cannot_be_understood_is_told_with_place_reason_and_remedy() {
    let same = baseline();
    let utf16: Vec<u8> = same.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let tables = [
        ("latin1.csv", b"time [s],q [\xb0]\n0,1\n".to_vec()),
        ("utf16.csv", [b"\xff\xfe".to_vec(), utf16].concat()),
        ("old_mac.csv", text(same.replace('\n', "\r"))),
        ("cut_off.csv", text("time [s],q [deg]\n0,1\n0.1")),
        ("quote.csv", text("time [s],\"q [deg]\n0,1\n")),
        ("thousands.csv", text("time [s];q [deg]\n0;1.234,5\n")),
        ("mixed.csv", text("time [s];q [deg]\n0;1,5\n1;1.5\n")),
        ("excel_error.csv", text("time [s],q [deg]\n0,#DIV/0!\n")),
        ("clock.csv", text("time,q [deg]\n18:00:00.0,1\n")),
        ("back.csv", text("time [s],q [deg]\n0,1\n1,2\n0.5,3\n")),
        ("no_time.csv", text("time [s],q [deg]\n0,1\nNaN,2\n")),
        ("endless.csv", text("time [s],q [deg]\n0,1\ninf,2\n")),
        ("no_names.csv", text("0,1\n1,2\n")),
        ("which_time.csv", text("a,b\n0,1\n")),
        ("no_signals.csv", text("time [s]\n0\n1\n")),
        ("no_rows.csv", text("time [s],q [deg]\n")),
        ("empty.csv", text("")),
        ("time_unit.csv", text("time [deg],q [deg]\n0,1\n1,2\n")),
        ("unit.csv", text("time [s],q [foo]\n0,1\n1,2\n")),
        ("escape.csv", text("time [s],q\u{1b}[31m [deg]\n0,1\n1,2\n")),
        ("nul.csv", text("time [s],q [deg]\n0,1\0\n")),
    ];
    expect![[r#"
        latin1.csv
        error[unreadable]: cannot read `latin1.csv`: line 1: the line is not UTF-8 text; save the file as UTF-8 (`CSV UTF-8` in Excel)
          = help: correct the file, or export it again
        exit code 4

        utf16.csv
        error[unreadable]: cannot read `utf16.csv`: line 1: the text is UTF-16; save the file as UTF-8 (`CSV UTF-8` in Excel)
          = help: correct the file, or export it again
        exit code 4

        old_mac.csv
        error[unreadable]: cannot read `old_mac.csv`: line 1: lines end in carriage returns alone; save the file with line feeds (CSV for Windows or Unix)
          = help: correct the file, or export it again
        exit code 4

        cut_off.csv
        error[unreadable]: cannot read `cut_off.csv`: line 3: 1 column, but the first line names 2; was the line cut off?
          = help: correct the file, or export it again
        exit code 4

        quote.csv
        error[unreadable]: cannot read `quote.csv`: line 1: a quoted field is not closed; add the missing "
          = help: correct the file, or export it again
        exit code 4

        thousands.csv
        error[unreadable]: cannot read `thousands.csv`: line 2, column 2: `1.234,5` has both `.` and `,`; write no marks between thousands
          = help: correct the file, or export it again
        exit code 4

        mixed.csv
        error[unreadable]: cannot read `mixed.csv`: line 3, column 2: `1.5` has a `.` where others have a `,` before the decimals; write no marks between thousands
          = help: correct the file, or export it again
        exit code 4

        excel_error.csv
        error[unreadable]: cannot read `excel_error.csv`: line 2, column 2: `#DIV/0!` is not a number; leave the field empty for a missing one
          = help: correct the file, or export it again
        exit code 4

        clock.csv
        error[unreadable]: cannot read `clock.csv`: line 2, column 1: `18:00:00.0` is not a number; write times as numbers, such as seconds from the start
          = help: correct the file, or export it again
        exit code 4

        back.csv
        error[unreadable]: cannot read `back.csv`: line 4, column 1: the time 0.5 follows 1; times must not fall
          = help: correct the file, or export it again
        exit code 4

        no_time.csv
        error[unreadable]: cannot read `no_time.csv`: line 3, column 1: there is no time in this line
          = help: correct the file, or export it again
        exit code 4

        endless.csv
        error[unreadable]: cannot read `endless.csv`: line 3, column 1: the time is infinite
          = help: correct the file, or export it again
        exit code 4

        no_names.csv
        error[unreadable]: cannot read `no_names.csv`: line 1: the first line has numbers; it must name the columns, such as `time [s]`
          = help: correct the file, or export it again
        exit code 4

        which_time.csv
        error[unreadable]: cannot read `which_time.csv`: line 1: which column is the time? the columns are `a`, `b`; name it, such as `--map 'COLUMN=time[s]'`
          = help: correct the file, or export it again
        exit code 4

        no_signals.csv
        error[unreadable]: `no_signals.csv` has times, but no signals
          = help: export the table again with a column for each signal
        exit code 4

        no_rows.csv
        error[unreadable]: `no_rows.csv` has no values
          = help: run the model, or export the table, again
        exit code 4

        empty.csv
        error[unreadable]: cannot read `empty.csv`: line 1: the file is empty; the first line must name the columns
          = help: correct the file, or export it again
        exit code 4

        time_unit.csv
        error[unreadable]: the time in `time_unit.csv` is in deg, which is not a time
          = help: give its unit, such as --map 'COLUMN=time[ms]'
        exit code 4

        unit.csv
        error[unreadable]: the unit of column `q` in `unit.csv` is not known: unknown unit `foo`
          = help: units are SI symbols with prefixes, such as mm, kg, ms, kW, mH, kOhm, N*m, rad/s, deg, rpm, %, or
                  give it with --map 'q=q[UNIT]'
        exit code 4

        escape.csv
        error[usage]: `escape.csv` has none of the requested signals
          = help: it has `q�[31m`; name them, such as --map 'q�[31m=q'
        exit code 2

        nul.csv
        error[unreadable]: cannot read `nul.csv`: line 2, column 2: `1�` is not a number; leave the field empty for a missing one
          = help: correct the file, or export it again
        exit code 4

    "#]].assert_eq(&compared(&tables));
}

#[test]
fn values_that_are_no_numbers_and_times_that_differ_are_told() {
    let odd = |value: &str| {
        text(rows("time [s],q [deg]\n", 11, |k, t| match k {
            4 => format!("{t},{value}\n"),
            _ => format!("{t},{k}\n"),
        }))
    };
    let tables = [
        ("nan.csv", odd("NaN")),
        ("gap.csv", odd("")),
        ("infinite.csv", odd("-inf")),
        ("all_nan.csv", text(rows("time [s],q [deg]\n", 11, |_, t| format!("{t},NaN\n")))),
        ("one_instant.csv", text("time [s],q [deg]\n0,0\n")),
        ("later.csv", text("time [s],q [deg]\n5,1\n6,1\n")),
        (
            "milliseconds.csv",
            text(rows("time [ms],q [deg]\n", 5, |k, t| format!("{},{}\n", 2500.0 * t, 2.5 * f64::from(k)))),
        ),
        ("other_unit.csv", text("time [s],q [m]\n0,1\n1,2\n")),
        (
            "twice.csv",
            text(
                baseline()
                    .replace("q [deg]", "q [deg],q [deg]")
                    .replace('\n', ",7\n")
                    .replacen(",7\n", "\n", 1),
            ),
        ),
    ];
    expect![[r#"
        nan.csv
        signal  verdict  maximum difference  at [s]  first beyond, at [s]  baseline  compared  allowed
        q       DIFFERS             NaN deg     0.4                   0.4   4.00000       NaN        0

        1 of 1 signal does not agree
        exit code 1

        gap.csv
        signal  verdict  maximum difference  at [s]  first beyond, at [s]  baseline  compared  allowed
        q       DIFFERS             NaN deg     0.4                   0.4   4.00000       NaN        0

        1 of 1 signal does not agree
        exit code 1

        infinite.csv
        signal  verdict  maximum difference  at [s]  first beyond, at [s]  baseline   compared  allowed
        q       DIFFERS       -infinite deg     0.4                   0.4   4.00000  -infinite        0

        1 of 1 signal does not agree
        exit code 1

        all_nan.csv
        signal  verdict  maximum difference  at [s]  first beyond, at [s]  baseline  compared  allowed
        q       DIFFERS             NaN deg       0                     0         0       NaN        0

        1 of 1 signal does not agree
        exit code 1

        one_instant.csv
        signal  verdict                 maximum difference  at [s]  first beyond, at [s]  baseline  compared  allowed
        q       SHORT, only 0 s to 0 s               0 deg       0                     -         -         -        -

        1 of 1 signal does not agree
        exit code 1

        later.csv
        signal  verdict         maximum difference  at [s]  first beyond, at [s]  baseline  compared  allowed
        q       NO COMMON TIME                   -       -                     -         -         -        -

        1 of 1 signal does not agree
        exit code 1

        milliseconds.csv
        signal  verdict  maximum difference  at [s]  first beyond, at [s]  baseline  compared  allowed
        q       DIFFERS      -1.590e-15 deg     0.6                  0.25   2.50000   2.50000        0

        1 of 1 signal does not agree
        they differ by rounding alone, as units and times bring it; `--rel 1e-9` allows that
        exit code 1

        other_unit.csv
        signal  verdict             maximum difference  at [s]  first beyond, at [s]  baseline  compared  allowed
        q       in m, another UNIT                   -       -                     -         -         -        -

        1 of 1 signal does not agree
        exit code 1

        twice.csv
        1 signal is in `twice.csv` alone
        1 signal agrees: 1 exactly, 0 within the tolerances
        note: in `twice.csv` `q` stands above several columns; column 3 is `q (2)` here
        exit code 0

    "#]].assert_eq(&compared(&tables));
}

#[test]
fn tables_that_plots_can_do_little_with_are_told() {
    let desk = Desk::with(&[
        ("all_nan.csv", "time [s],q [deg]\n0,NaN\n1,NaN\n"),
        ("one_instant.csv", "time [s],q [deg]\n0,1\n"),
        ("twice.csv", "time [s],q [deg],q [deg]\n0,1,2\n1,2,3\n"),
        ("no_signals.csv", "time [s]\n0\n1\n"),
        ("no_rows.csv", "time [s],q [deg]\n"),
        ("unit.csv", "time [s],q [foo]\n0,1\n1,2\n"),
    ]);
    let names = desk.names(".");
    let answers: String =
        names.iter().map(|name| format!("{name}\n{}\n", desk.said(&["plot", name, "--ascii"]))).collect();
    expect![[r#"
        all_nan.csv
        [deg]
          nothing to draw
          q: NaN first at 0; 2 of 2 values are not finite
        exit code 0

        no_rows.csv
        error[unreadable]: `no_rows.csv` has no values
          = help: run the model, or export the table, again
        exit code 4

        no_signals.csv
        error[unreadable]: `no_signals.csv` has times, but no signals
          = help: export the table again with a column for each signal
        exit code 4

        one_instant.csv
        [deg]
          1.10 +
               |
               |
          1.05 +
               |
               |
          1.00 +                            *                              * q
               |
          0.95 +
               |
               |
          0.90 +
               ++-------------+-------------+-------------+-------------+
              -1.0          -0.5           0.0           0.5           1.0  time [s]
        exit code 0

        twice.csv
        [deg]
          3.0 +                                                 +++++  + q (2)
              |                                        +++++++++
              |                               +++++++++
          2.5 +                       ++++++++
              |              +++++++++
              |     +++++++++
          2.0 ++++++                                           ******  * q
              |                                      **********
          1.5 +                           ***********
              |                ***********
              |      **********
          1.0 +******
              ++----------+---------+----------+---------+----------+
              0.0        0.2       0.4        0.6       0.8        1.0  time [s]
        note: in `twice.csv` `q` stands above several columns; column 3 is `q (2)` here
        exit code 0

        unit.csv
        error[unreadable]: the unit of column `q` in `unit.csv` is not known: unknown unit `foo`
          = help: units are SI symbols with prefixes, such as mm, kg, ms, kW, mH, kOhm, N*m, rad/s, deg, rpm, %, or
                  give it with --map 'q=q[UNIT]'
        exit code 4

    "#]].assert_eq(&answers);
}

/// A run of 3000 rows, in one chunk.
const MODEL: &str = r#"Diagram(
    simulation: (stop_time: "3 s", solver: Ode4(step: "1 ms")),
    blocks: { "wave": Sine(amplitude: 1.0, frequency: "1 Hz"), "scope": Scope(inputs: ["x"]) },
    connections: ["wave.y -> scope.x"],
)
"#;

/// A desk with the run `long`.
fn with_run() -> Desk {
    let desk = Desk::with(&[("long.ron", MODEL)]);
    let said = desk.said(&["run", "long.ron", "--out", "long", "--quiet", "--no-csv"]);
    assert_eq!(said, "long\nexit code 0\n");
    desk
}

#[test]
fn runs_that_are_damaged_or_hardly_there_are_told() {
    let desk = with_run();
    let whole = fs::read(desk.0.join("long/signals.rec")).unwrap();
    let flipped = |at: usize| {
        let mut bytes = whole.clone();
        bytes[at] ^= 255;
        bytes
    };
    for (name, bytes) in [
        ("begun", whole[..whole.len() / 2].to_vec()),
        ("flipped", flipped(whole.len() / 2)),
        ("header", flipped(40)),
        ("other", b"something else\n".to_vec()),
    ] {
        fs::create_dir(desk.0.join(name)).unwrap();
        fs::write(desk.0.join(name).join("signals.rec"), bytes).unwrap();
    }
    fs::create_dir(desk.0.join("none")).unwrap();
    fs::create_dir(desk.0.join("unread")).unwrap();
    fs::write(desk.0.join("unread/signals.rec"), &whole).unwrap();
    fs::write(desk.0.join("unread/manifest.json"), "{").unwrap();

    let mut answers = String::new();
    for name in ["begun", "flipped", "header", "other", "none", "unread", "nothing"] {
        let export = desk.said(&["export", name, "--csv", &format!("{name}.csv")]);
        let compare = desk.said(&["compare", "long", name]);
        let plot = desk.said(&["plot", name, "--json"]);
        answers.push_str(&format!("{name}\n{export}{compare}{plot}\n"));
    }
    expect![[r#"
        begun
        begun.csv
        note: the run is not complete: its recording was not closed: the program still runs, or was ended by force
        1 signal of begun
        exit code 0
        warning: `begun` is not whole: its recording was not closed: the program still runs, or was ended by force
        error[unreadable]: `begun` has no values
          = help: run the model, or export the table, again
        exit code 4
        {"code":"unreadable","edit":null,"exit":4,"help":"run the model, or export the table, again","labels":[],"message":"`begun` has no values","notes":[],"severity":"error","type":"diagnostic","v":1}
        warning: `begun` is not whole: its recording was not closed: the program still runs, or was ended by force
        exit code 4

        flipped
        error[unreadable]: cannot read `flipped/signals.rec`: it is damaged at byte 116, from t = 0 s to 3 s; what is before and behind can be read
          = help: take a copy of the file if there is one, or run the model again; `signals.csv` beside it may be
                  whole
        exit code 4
        error[unreadable]: cannot read `flipped/signals.rec`: it is damaged at byte 116, from t = 0 s to 3 s; what is before and behind can be read
          = help: take a copy of the file if there is one, or run the model again; `signals.csv` beside it may be
                  whole
        exit code 4
        {"code":"unreadable","edit":null,"exit":4,"help":"take a copy of the file if there is one, or run the model again; `signals.csv` beside it may be whole","labels":[],"message":"cannot read `flipped/signals.rec`: it is damaged at byte 116, from t = 0 s to 3 s; what is before and behind can be read","notes":[],"severity":"error","type":"diagnostic","v":1}
        exit code 4

        header
        error[unreadable]: cannot read `header/signals.rec`: its header is damaged
          = help: take a copy of the file if there is one, or run the model again; `signals.csv` beside it may be
                  whole
        exit code 4
        error[unreadable]: cannot read `header/signals.rec`: its header is damaged
          = help: take a copy of the file if there is one, or run the model again; `signals.csv` beside it may be
                  whole
        exit code 4
        {"code":"unreadable","edit":null,"exit":4,"help":"take a copy of the file if there is one, or run the model again; `signals.csv` beside it may be whole","labels":[],"message":"cannot read `header/signals.rec`: its header is damaged","notes":[],"severity":"error","type":"diagnostic","v":1}
        exit code 4

        other
        error[unreadable]: cannot read `other/signals.rec`: it is not a recording of blocksim, or only the first bytes of one
          = help: take a copy of the file if there is one, or run the model again; `signals.csv` beside it may be
                  whole
        exit code 4
        error[unreadable]: cannot read `other/signals.rec`: it is not a recording of blocksim, or only the first bytes of one
          = help: take a copy of the file if there is one, or run the model again; `signals.csv` beside it may be
                  whole
        exit code 4
        {"code":"unreadable","edit":null,"exit":4,"help":"take a copy of the file if there is one, or run the model again; `signals.csv` beside it may be whole","labels":[],"message":"cannot read `other/signals.rec`: it is not a recording of blocksim, or only the first bytes of one","notes":[],"severity":"error","type":"diagnostic","v":1}
        exit code 4

        none
        error[unreadable]: cannot read `none`: there is no recording in this folder
          = help: name a folder that `blocksim run` wrote, or a table
        exit code 4
        error[unreadable]: cannot read `none`: there is no recording in this folder
          = help: name a folder that `blocksim run` wrote, or a table
        exit code 4
        {"code":"unreadable","edit":null,"exit":4,"help":"name a folder that `blocksim run` wrote, or a table","labels":[],"message":"cannot read `none`: there is no recording in this folder","notes":[],"severity":"error","type":"diagnostic","v":1}
        exit code 4

        unread
        unread.csv
        note: the run is not complete: its manifest cannot be read: EOF while parsing an object at line 1 column 1
        1 signal of unread
        exit code 0
        1 signal agrees: 1 exactly, 0 within the tolerances
        warning: `unread` is not whole: its manifest cannot be read: EOF while parsing an object at line 1 column 1
        exit code 0
        {"tracking":[{"begin":0.0,"disturbed_at":null,"final_error":null,"follows":false,"iae":null,"ise":null,"maximum_error":null,"maximum_error_at":null,"overshoot":null,"rise":null,"run":"unread","settling":null,"signal":"scope.x","step":0.0,"unit":"1"}],"type":"metrics","v":3}
        warning: `unread` is not whole: its manifest cannot be read: EOF while parsing an object at line 1 column 1
        exit code 0

        nothing
        error[unreadable]: cannot read `nothing`: no folder, file or run in `runs` has this name
          = help: `blocksim runs` lists what there is; `blocksim run MODEL` makes a new one
        exit code 4
        error[unreadable]: cannot read `nothing`: no folder, file or run in `runs` has this name
          = help: `blocksim runs` lists what there is; `blocksim run MODEL` makes a new one
        exit code 4
        {"code":"unreadable","edit":null,"exit":4,"help":"`blocksim runs` lists what there is; `blocksim run MODEL` makes a new one","labels":[],"message":"cannot read `nothing`: no folder, file or run in `runs` has this name","notes":[],"severity":"error","type":"diagnostic","v":1}
        exit code 4

    "#]].assert_eq(&answers);
    // Nothing half written lies about.
    assert!(desk.names(".").iter().all(|name| !name.contains("tmp")), "{:?}", desk.names("."));
}
