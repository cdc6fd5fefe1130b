//! Runs all benchmarks and prints one table of them, with ratios to an earlier table:
//! `cargo run --release -p blocksim-tests --features bench_table --bin bench_table -- --against before.txt --out now.txt`.
//!
//! | flag | meaning |
//! |---|---|
//! | `--out FILE` | where the table is written, `target/benches.txt` if absent |
//! | `--against FILE` | a table of before: each median is divided by the one there |
//! | `--only PACKAGE` | the benchmarks of one crate |
//! | `--read FILE` | reads what `cargo bench` has printed before, and runs nothing |
//!
//! Medians are those of the tables that divan prints; a benchmark without it prints lines `time PATH NUMBER UNIT` for the table, a
//! path without spaces. A ratio below 1 is faster than before. The exit code is that of the benchmarks.

use std::collections::BTreeMap;
use std::fs;
use std::io::{self, BufRead, BufReader, Write};
use std::process::{Command, ExitCode, Stdio};

/// Prints a line for whoever waits.
macro_rules! say {
    ($($text:tt)*) => {
        drop(writeln!(io::stderr(), $($text)*))
    };
}

fn main() -> io::Result<ExitCode> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let word =
        |flag: &str| arguments.iter().skip_while(|argument| *argument != flag).nth(1).map(String::as_str);
    let (medians, worked) = match word("--read") {
        Some(file) => (medians(fs::read_to_string(file)?.lines()), true),
        None => run(word("--only"))?,
    };
    if medians.is_empty() {
        say!("no benchmark printed a time");
        return Ok(ExitCode::FAILURE);
    }
    let before = word("--against").map(fs::read_to_string).transpose()?;
    let before = before.as_deref().map(read_table).unwrap_or_default();
    let table = table(&medians, &before);
    io::stdout().write_all(table.as_bytes())?;
    fs::write(word("--out").unwrap_or("target/benches.txt"), table)?;
    Ok(if worked { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Runs the benchmarks, shows what they print, and gathers it.
fn run(only: Option<&str>) -> io::Result<(BTreeMap<String, f64>, bool)> {
    let mut cargo = Command::new("cargo");
    cargo.args(["bench", "--benches"]);
    match only {
        Some(package) => cargo.args(["-p", package]),
        None => cargo.arg("--workspace"),
    };
    let mut child = cargo.stdout(Stdio::piped()).spawn()?;
    let mut lines = Vec::new();
    if let Some(out) = child.stdout.take() {
        for line in BufReader::new(out).lines() {
            let line = line?;
            say!("{line}");
            lines.push(line);
        }
    }
    let status = child.wait()?;
    Ok((medians(lines.iter().map(String::as_str)), status.success()))
}

/// Medians in s by the path of a benchmark: `chain/engine`. The lines are those of divan: a tree of names, and behind each leaf
/// fastest, slowest, median and mean between bars. Other benchmarks print `time PATH NUMBER UNIT`.
fn medians<'a>(lines: impl Iterator<Item = &'a str>) -> BTreeMap<String, f64> {
    let (mut found, mut path) = (BTreeMap::new(), Vec::<String>::new());
    for line in lines {
        if let Some((name, time)) = line.strip_prefix("time ").and_then(|rest| rest.split_once(' ')) {
            found.extend(seconds(time).map(|time| (name.to_owned(), time)));
            continue;
        }
        let cells: Vec<&str> = line.split('│').collect();
        // Bars of the tree before the name are bars, too.
        let bars = line.chars().take_while(|c| matches!(c, '│' | ' ')).filter(|c| *c == '│').count();
        let (head, rest) =
            (cells.get(bars).copied().unwrap_or_default(), cells.get(bars + 1..).unwrap_or(&[]));
        if head.contains("fastest") {
            path = head.split_whitespace().next().map(|name| vec![name.to_owned()]).unwrap_or_default();
            continue;
        }
        let Some(branch) = line.chars().position(|c| matches!(c, '├' | '╰')) else { continue };
        if rest.len() < 4 || path.is_empty() {
            continue;
        }
        let head = head.trim_start_matches([' ', '├', '╰', '─']);
        let Some(name) = head.split_whitespace().next() else { continue };
        // Each level is three signs further in.
        path.truncate(1 + branch / 3);
        path.push(name.to_owned());
        if let Some(median) = rest.get(1).and_then(|text| seconds(text)) {
            found.insert(path.join("/"), median);
        }
    }
    found
}

/// A time such as `1.25 ms`, in s.
fn seconds(text: &str) -> Option<f64> {
    let mut words = text.split_whitespace();
    let number: f64 = words.next()?.parse().ok()?;
    let factor = match words.next()? {
        "ns" => 1e-9,
        "µs" | "us" => 1e-6,
        "ms" => 1e-3,
        "s" => 1.0,
        _ => return None,
    };
    Some(number * factor)
}

/// A line for each benchmark: name, median in s, ratio to the one of before.
fn table(medians: &BTreeMap<String, f64>, before: &BTreeMap<String, f64>) -> String {
    let width = medians.keys().map(|name| name.chars().count()).max().unwrap_or_default().max(9);
    let mut text = format!("{:width$}  median [s]  ratio\n", "benchmark");
    for (name, median) in medians {
        let ratio =
            before.get(name).map_or_else(|| "-".to_owned(), |before| format!("{:.2}", median / before));
        text += &format!("{name:width$}  {median:10.3e}  {ratio:>5}\n");
    }
    text
}

fn read_table(text: &str) -> BTreeMap<String, f64> {
    let line = |line: &str| {
        let mut words = line.split_whitespace();
        Some((words.next()?.to_owned(), words.next()?.parse().ok()?))
    };
    text.lines().skip(1).filter_map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const PRINTED: &str = "\
chain                fastest       │ slowest       │ median        │ mean          │ samples │ iters
├─ engine            1.2 µs        │ 3 µs          │ 1.5 µs        │ 1.6 µs        │ 100     │ 100
├─ loops                           │               │               │               │         │
│  ├─ blocks         10 ms         │ 12 ms         │ 11 ms         │ 11.1 ms       │ 100     │ 100
│  ╰─ objects        1 s           │ 2 s           │ 1.25 s        │ 1.3 s         │ 10      │ 10
╰─ plain             7 ns          │ 9 ns          │ 8 ns          │ 8 ns          │ 100     │ 100
";

    /// Lines of `cargo bench` as they come: two programs of benchmarks, the second without divan.
    const WHOLE: &str = "\
running 2 tests
test inertia::tests::two_half_boxes_make_a_box ... ignored

test result: ok. 0 passed; 0 failed; 2 ignored; 0 measured; 0 filtered out; finished in 0.00s

rnea 331 ns
Timer precision: 20 ns
mass_and_bias + Cholesky 575 ns, 1.74 x rnea
dynamics                       fastest       │ slowest       │ median        │ mean          │ samples │ iters
├─ aba                         649.7 ns      │ 5.888 µs      │ 660.7 ns      │ 713.2 ns      │ 100     │ 100
├─ forward_kinematics          140.5 ns      │ 141.8 ns      │ 141.1 ns      │ 141.2 ns      │ 100     │ 1600
╰─ rnea                        333.9 ns      │ 338.9 ns      │ 335.2 ns      │ 335.8 ns      │ 100     │ 800

  50 blocks      11.5 ms, 80 crossings, 2130 x 618 dots
time large/50 1.1530e-2 s
time of nothing
";

    #[test]
    fn what_stands_around_the_figures_is_no_figure() {
        let found = medians(WHOLE.lines());
        let names: Vec<&str> = found.keys().map(String::as_str).collect();
        assert_eq!(names, ["dynamics/aba", "dynamics/forward_kinematics", "dynamics/rnea", "large/50"]);
        assert_eq!((found["dynamics/rnea"] * 1e10).round(), 3352.0);
        assert_eq!(found["large/50"], 1.153e-2);
    }

    #[test]
    fn medians_are_read_with_the_names_above_them() {
        let found = medians(PRINTED.lines());
        let names: Vec<&str> = found.keys().map(String::as_str).collect();
        assert_eq!(names, ["chain/engine", "chain/loops/blocks", "chain/loops/objects", "chain/plain"]);
        assert_eq!(found["chain/loops/objects"], 1.25);
        assert!((found["chain/engine"] - 1.5e-6).abs() < 1e-18);
    }

    #[test]
    fn a_table_that_was_written_is_read_and_compared() {
        let now = medians(PRINTED.lines());
        let first = table(&now, &BTreeMap::new());
        assert!(first.contains("chain/plain") && first.contains("    -\n"), "{first}");
        let second = table(&now, &read_table(&first));
        assert_eq!(second.matches(" 1.00\n").count(), 4, "{second}");
    }
}
