//! Runs random models of a class against their reference:
//! `cargo run --release -p blocksim-tests --features random_models --bin random_models -- --class circuits --count 2000`.
//!
//! | flag | meaning |
//! |---|---|
//! | `--class NAME` | `signals` (default), `sampled`, `mechanisms`, `circuits` or `shafts` |
//! | `--seed N` | first seed, 1 if absent |
//! | `--count N` | number of models, 200 if absent |
//! | `--settings TEXT` | what follows the stop time, such as `, solver: Ode23()` |
//! | `--audit` | looks at watched conditions on a fine grid instead of comparing with the reference |
//! | `--variants` | all methods and orders, one after the other |
//! | `--shrink N` | number of failures that are shrunk to the least model, 10 if absent |
//! | `--undecided` | prints the seeds that nobody can decide, too |
//! | `--show` | prints the model of the first seed, its diagram and what becomes of it |

use std::io::{self, Write};

use blocksim_tests::random::{
    Circuit, Finding, Judge, Mechanisms, Puzzle, Sampled, Shafts, Signals, Variant, least, survey, vary,
};

fn main() -> io::Result<()> {
    let orders = Orders { arguments: std::env::args().skip(1).collect() };
    let out = &mut io::stdout().lock();
    match orders.word("--class").unwrap_or("signals") {
        "signals" => orders.follow::<Signals>(out),
        "sampled" => orders.follow::<Sampled>(out),
        "mechanisms" => orders.follow::<Mechanisms>(out),
        "circuits" => orders.follow::<Circuit>(out),
        "shafts" => orders.follow::<Shafts>(out),
        other => writeln!(out, "there is no class `{other}`"),
    }
}

/// What is asked for.
struct Orders {
    arguments: Vec<String>,
}

impl Orders {
    fn word(&self, flag: &str) -> Option<&str> {
        self.arguments.iter().skip_while(|argument| *argument != flag).nth(1).map(String::as_str)
    }

    fn number(&self, flag: &str, default: u64) -> u64 {
        self.word(flag).and_then(|text| text.parse().ok()).unwrap_or(default)
    }

    fn has(&self, flag: &str) -> bool {
        self.arguments.iter().any(|argument| argument == flag)
    }

    fn follow<P: Puzzle>(&self, out: &mut impl Write) -> io::Result<()> {
        let (first, count) = (self.number("--seed", 1), self.number("--count", 200));
        let variants = match self.word("--settings") {
            Some(settings) => vec![Variant::with(settings)],
            None if self.has("--variants") => vary(),
            None => vec![Variant::plain()],
        };
        let judge: Judge<P> = if self.has("--audit") { P::audit } else { P::judge };
        if self.has("--show") {
            let model = P::of(first);
            let variant = &variants[0];
            return writeln!(out, "{}\n{model:?}\n{:?}", model.text(variant), judge(&model, variant));
        }
        let mut left = self.number("--shrink", 10);
        for variant in &variants {
            let mut told = Ok(());
            let mut tell = |seed: u64, model: &P, finding: &Finding| match finding {
                Finding::Right => Ok(()),
                Finding::Undecided(why) if self.has("--undecided") => writeln!(out, "seed {seed}: {why}"),
                Finding::Undecided(_) => Ok(()),
                Finding::Wrong(fault) => {
                    writeln!(out, "seed {seed}, {}: {}: {}", variant.name, fault.kind, fault.what)?;
                    if left == 0 {
                        return Ok(());
                    }
                    left -= 1;
                    let least = least(model, variant, judge);
                    let finding = judge(&least, variant);
                    writeln!(out, "{least:?}\n{finding:?}\n{}", least.text(variant))?;
                    out.flush()
                }
            };
            let survey = survey::<P>(first..first + count, variant, judge, |seed, model, finding| {
                if told.is_ok() {
                    told = tell(seed, model, finding);
                }
            });
            told?;
            writeln!(out, "{}:\n{survey}", variant.name)?;
        }
        Ok(())
    }
}
