//! Runs random models against the reference:
//! `cargo run --release -p blocksim-tests --features random_models --bin random_models -- --count 2000`.
//!
//! `--class sampled` or `mechanisms` takes those instead of models of any signals; `--settings TEXT` follows their stop time.
//! `--seed N` is the first seed, `--variants` tries all methods and orders, `--show SEED` prints a model. What fails is shrunk and
//! printed as a diagram with what was expected and found.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::ops::Range;

use blocksim_tests::random::{
    Finding, Mechanisms, Model, Puzzle, Sampled, Variant, Verdict, diagram, generate, judge, least, shrink,
    vary,
};

fn main() -> io::Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |flag: &str, default: u64| {
        let at = arguments.iter().position(|argument| argument == flag);
        at.and_then(|at| arguments.get(at + 1)).and_then(|text| text.parse().ok()).unwrap_or(default)
    };
    let has = |flag: &str| arguments.iter().any(|argument| argument == flag);
    let out = &mut io::stdout().lock();
    let (first, count, most) = (number("--seed", 1), number("--count", 200), number("--shrink", 10));
    let word = |flag: &str| arguments.iter().skip_while(|argument| *argument != flag).nth(1).cloned();
    let settings = word("--settings").unwrap_or_default();
    match word("--class").as_deref() {
        Some("mechanisms") => return solve::<Mechanisms>(first..first + count, &settings, most, out),
        Some("sampled") => return solve::<Sampled>(first..first + count, &settings, most, out),
        Some(other) => return writeln!(out, "no class `{other}`"),
        None => {}
    }
    if has("--show") {
        let model = generate(number("--show", 1));
        writeln!(
            out,
            "{}\n{model:?}\n{:?}",
            diagram(&model, &Variant::plain()),
            judge(&model, &Variant::plain())
        )?;
        return Ok(());
    }
    let variants = match () {
        () if has("--variants") => vary(),
        () if has("--fine") => vec![Variant::fine()],
        () => vec![Variant::plain()],
    };
    let mut tally: BTreeMap<String, u32> = BTreeMap::new();
    let mut shrunk = 0;
    for seed in first..first + count {
        let model = generate(seed);
        for variant in &variants {
            let verdict = judge(&model, variant);
            let what = match &verdict {
                Verdict::Right => "right".to_owned(),
                Verdict::Undecided(why) => format!("undecided: {why:?}"),
                Verdict::Wrong(faults) => format!("wrong: {}", faults[0].class()),
            };
            *tally.entry(format!("{}: {what}", variant.name)).or_default() += 1;
            if matches!(verdict, Verdict::Undecided(_)) {
                break;
            }
            if let Verdict::Wrong(faults) = &verdict {
                writeln!(out, "seed {seed}, {}: {:?}", variant.name, faults[0])?;
                if shrunk < most {
                    shrunk += 1;
                    let least = shrink(&model, variant);
                    *tally.entry(format!("    {}: {}", variant.name, kinds(&least))).or_default() += 1;
                    tell(out, &least, variant)?;
                }
            }
        }
    }
    tally.iter().try_for_each(|(what, count)| writeln!(out, "{count:6}  {what}"))
}

/// Runs models of one class.
fn solve<P: Puzzle>(seeds: Range<u64>, settings: &str, most: u64, out: &mut impl Write) -> io::Result<()> {
    let mut tally: BTreeMap<String, u32> = BTreeMap::new();
    let mut shrunk = 0;
    for seed in seeds {
        let model = P::of(seed);
        let finding = model.judge(settings);
        let class = match &finding {
            Finding::Right => "right".to_owned(),
            Finding::Undecided(why) => format!("undecided: {why}"),
            Finding::Wrong(kind, _) => format!("wrong: {kind}"),
        };
        *tally.entry(class).or_default() += 1;
        let Finding::Wrong(_, what) = finding else { continue };
        writeln!(out, "seed {seed}: {what}")?;
        if shrunk < most {
            shrunk += 1;
            let least = least(&model, settings);
            writeln!(out, "{least:?}\n{:?}\n{}", least.judge(settings), least.text(settings))?;
        }
    }
    tally.iter().try_for_each(|(what, count)| writeln!(out, "{count:6}  {what}"))
}

/// The kinds of the nodes of a model.
fn kinds(model: &Model) -> String {
    let mut kinds: Vec<&str> = model.nodes.iter().map(|node| node.law.kind()).collect();
    kinds.sort_unstable();
    kinds.join(" ")
}

/// A model and what is wrong with it.
fn tell(out: &mut impl Write, model: &Model, variant: &Variant) -> io::Result<()> {
    if let Verdict::Wrong(faults) = judge(model, variant) {
        faults.iter().try_for_each(|fault| writeln!(out, "    {fault:?}"))?;
    }
    writeln!(out, "{}", diagram(model, variant))
}
