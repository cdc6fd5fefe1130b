//! Which of the recorded signals are kept, and at which rates.

use blocksim_block::schedule::{Keep, Recorded, Settings};
use blocksim_diagram::off_grid;
use blocksim_recording::{Layout, Rate};
use blocksim_signal::closest;

use crate::args::values::time;
use crate::failure::Failure;
use crate::signals::{display, naming};

/// What `--signals` names: a pattern, and a rate behind `@`.
#[derive(Debug, Clone, PartialEq)]
pub struct Wanted {
    /// Parts of paths, or a pattern with `*`.
    pub pattern: String,
    /// All rows unless something else is said.
    pub rate: Rate,
    /// As it was written.
    pub text: String,
}

/// `arm/**`, `arm/**@10ms`, `arm/**@10rows`, `arm/**@minmax:10ms`.
///
/// # Errors
/// What is wrong with it.
pub fn wanted(text: &str) -> Result<Wanted, String> {
    let (pattern, rate) = match text.rsplit_once('@') {
        None => (text, Rate::All),
        Some((pattern, rate)) => (pattern, rate_of(rate.trim())?),
    };
    match pattern.trim() {
        "" => Err("write a pattern, such as 'arm/**', with or without a rate behind @".to_owned()),
        pattern => Ok(Wanted { pattern: pattern.to_owned(), rate, text: text.trim().to_owned() }),
    }
}

fn rate_of(text: &str) -> Result<Rate, String> {
    let advice = "a rate is a time (@10ms), a number of rows (@10rows) or the minimum and maximum in a time (@minmax:10ms)";
    if let Some(n) = text.strip_suffix("rows") {
        let n: u32 = n.trim().parse().map_err(|_| advice.to_owned())?;
        return if n > 0 { Ok(Rate::Nth(n)) } else { Err(advice.to_owned()) };
    }
    let of = |text: &str| time(text.trim()).map_err(|error| format!("{error}; {advice}"));
    match text.strip_prefix("minmax:") {
        Some(window) => of(window).map(Rate::Extremes),
        None => of(text).map(Rate::Every),
    }
}

/// What is kept: the layout of the recording, and which value of a row each of its signals is.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Selection {
    /// Signals and their time bases.
    pub layout: Layout,
    /// Positions among what the diagram wants recorded.
    pub sources: Vec<usize>,
    /// How many of them no pattern asked for.
    pub unasked: usize,
}

/// All signals that a diagram wants recorded, at the rates that it says, or those that fit something wanted; of several that
/// fit the last one says the rate. What is `needed` is kept in any case, at the first rate that is wanted.
///
/// # Errors
/// The first pattern that nothing fits, with signals that may be meant, or a time that is not a multiple of the spacing
/// of the rows.
pub fn select(
    recorded: &[Recorded],
    wanted: &[Wanted],
    needed: &[&str],
    settings: &Settings,
) -> Result<Selection, Failure> {
    let fits = |wanted: &Wanted, r: &Recorded| naming::fits(&r.path, &wanted.pattern);
    for Wanted { pattern, rate, .. } in wanted {
        if !recorded.iter().any(|r| naming::fits(&r.path, pattern)) {
            return Err(lost(pattern, recorded));
        }
        if let Rate::Every(time) = rate
            && let Some((spacing, what)) = off_grid(*time, settings)
        {
            let near = (time / spacing).round().max(1.0) * spacing;
            // What conversion has added behind the ninth digit is not shown.
            let [time, spacing, near] =
                [*time, spacing, near].map(|t| format!("{} ms", (t * 1e12).round() / 1e9));
            let said = format!("the rate of `{pattern}`, {time}, is not a multiple of the {what}, {spacing}");
            let help = format!("write {near}, or a number of rows such as `{pattern}@10rows`");
            return Err(Failure::usage(said).help(help));
        }
    }
    let windowed = |rate: &Rate| matches!(rate, Rate::Extremes(_));
    let others = wanted.iter().map(|wanted| wanted.rate).find(|rate| !windowed(rate)).unwrap_or(Rate::All);
    let mut selection = Selection::default();
    for (source, (r, mut info)) in recorded.iter().zip(display::layout(recorded).signals).enumerate() {
        let asked = wanted.iter().rev().find(|wanted| fits(wanted, r)).map(|wanted| wanted.rate);
        let rate = match asked {
            Some(rate) => rate,
            None if wanted.is_empty() => rate_kept(r.keep),
            None if needed.contains(&r.path.as_str()) => {
                selection.unasked += 1;
                others
            }
            None => continue,
        };
        let rates = &mut selection.layout.rates;
        // Least and largest values have times of their own for each signal.
        info.base = rates.iter().position(|known| *known == rate && !windowed(known)).unwrap_or_else(|| {
            rates.push(rate);
            rates.len() - 1
        });
        selection.layout.signals.push(info);
        selection.sources.push(source);
    }
    if selection.layout.rates.is_empty() {
        selection.layout.rates.push(Rate::All);
    }
    Ok(selection)
}

fn rate_kept(keep: Keep) -> Rate {
    match keep {
        Keep::All => Rate::All,
        Keep::Every(time) => Rate::Every(time),
        Keep::Rows(n) => Rate::Nth(n),
        Keep::Extremes(time) => Rate::Extremes(time),
    }
}

fn lost(pattern: &str, recorded: &[Recorded]) -> Failure {
    let paths = || recorded.iter().map(|r| r.path.as_str());
    let some: Vec<&str> = paths().take(5).collect();
    if some.is_empty() {
        return Failure::usage("nothing is recorded")
            .help("add a Scope, or `record: [\"...\"]` to the diagram");
    }
    let plain = pattern.trim_matches('*').trim_matches('/');
    let wider = [format!("**{plain}**"), format!("**{}**", plain.replace('*', "**"))];
    let meant = wider.iter().find(|wider| !plain.is_empty() && paths().any(|path| naming::fits(path, wider)));
    let help = match meant.map(String::as_str).or_else(|| closest(pattern, paths())) {
        Some(meant) => format!("did you mean '{meant}'?"),
        None => {
            let more = if some.len() < recorded.len() { ", ..." } else { "" };
            format!("recorded are {}{more}; `record: [...]` in the diagram records others", some.join(", "))
        }
    };
    Failure::usage(format!("no recorded signal fits `{pattern}`")).help(help)
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::schedule::{LoopPolicy, OutputTimes, Solver, Start, VariableMethod};
    use expect_test::expect;

    fn recorded(path: &str) -> Recorded {
        Recorded {
            path: path.into(),
            cell: 0,
            kind: blocksim_signal::Kind::Real,
            dimension: None,
            display: None,
            title: Vec::new(),
            legend: None,
            over: None,
            keep: Keep::All,
            held: false,
        }
    }

    #[test]
    fn a_pattern_may_have_a_rate() {
        let rate = |text: &str| wanted(text).map(|wanted| wanted.rate);
        assert_eq!(rate("arm/**"), Ok(Rate::All));
        assert_eq!(rate("arm/**@10ms"), Ok(Rate::Every(0.01)));
        assert_eq!(rate("arm/** @ 10 rows"), Ok(Rate::Nth(10)));
        assert_eq!(rate("*@minmax:1s"), Ok(Rate::Extremes(1.0)));
        for wrong in ["", "@1s", "a@", "a@0rows", "a@xrows", "a@-1s", "a@1m", "a@minmax:"] {
            assert!(wanted(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn signals_are_chosen_and_those_of_one_rate_share_their_times() {
        let recorded = ["arm.q", "arm.tau", "ctrl.u", "ctrl.e"].map(recorded);
        let wanted: Vec<Wanted> =
            ["arm@10ms", "ctrl@minmax:1s", "tau@10ms"].iter().map(|text| wanted(text).unwrap()).collect();
        let steps = settings(OutputTimes::Steps);
        let select = |wanted: &[Wanted], needed: &[&str]| select(&recorded, wanted, needed, &steps);
        let Selection { layout, sources, .. } = select(&wanted, &[]).unwrap();
        assert_eq!(layout.rates, [Rate::Every(0.01), Rate::Extremes(1.0), Rate::Extremes(1.0)]);
        assert_eq!(layout.signals.iter().map(|signal| signal.base).collect::<Vec<_>>(), [0, 0, 1, 2]);
        assert_eq!(sources, [0, 1, 2, 3]);
        let one = select(&[super::wanted("*.e").unwrap()], &[]).unwrap();
        assert_eq!((one.layout.rates, one.sources), (vec![Rate::All], vec![3]));
        let all = select(&[], &[]).unwrap();
        assert_eq!((all.layout.rates.len(), all.sources.len()), (1, 4));
        let seen = select(&[super::wanted("ctrl@20ms").unwrap()], &["arm.q", "ctrl.u"]).unwrap();
        assert_eq!(
            (seen.layout.rates, seen.sources, seen.unasked),
            (vec![Rate::Every(0.02)], vec![0, 2, 3], 1)
        );
    }

    #[test]
    fn the_rates_of_the_diagram_hold_until_the_command_line_says_others() {
        let mut recorded = ["arm.q", "arm.tau", "ctrl.u", "ctrl.e"].map(recorded);
        recorded[0].keep = Keep::Every(0.01);
        recorded[1].keep = Keep::Rows(3);
        recorded[3].keep = Keep::Extremes(1.0);
        let steps = settings(OutputTimes::Steps);
        let kept = select(&recorded, &[], &[], &steps).unwrap();
        assert_eq!(kept.layout.rates, [Rate::Every(0.01), Rate::Nth(3), Rate::All, Rate::Extremes(1.0)]);
        let kept = select(&recorded, &[wanted("arm").unwrap()], &[], &steps).unwrap();
        assert_eq!((kept.layout.rates, kept.sources), (vec![Rate::All], vec![0, 1]));
        assert_eq!(select(&[], &[], &[], &steps).unwrap().layout.rates, [Rate::All]);
    }

    #[test]
    fn what_cannot_be_kept_is_told_with_a_remedy() {
        let recorded = ["arm/base/joint.q", "arm/base/joint.tau", "ctrl.u"].map(recorded);
        let grid = settings(OutputTimes::Every(0.01));
        let told = |text: &str| select(&recorded, &[wanted(text).unwrap()], &[], &grid).unwrap_err().text();
        expect![[r#"
            no recorded signal fits `leg`
              = help: recorded are arm/base/joint.q, arm/base/joint.tau, ctrl.u; `record: [...]` in the diagram records others
            no recorded signal fits `ctrl.v`
              = help: did you mean 'ctrl.u'?
            no recorded signal fits `arm/*.q`
              = help: did you mean '**arm/**.q**'?
            the rate of `ctrl.u`, 15 ms, is not a multiple of the output interval, 10 ms
              = help: write 20 ms, or a number of rows such as `ctrl.u@10rows`
        "#]]
        .assert_eq(&["leg", "ctrl.v", "arm/*.q", "ctrl.u@15ms"].map(|text| told(text) + "\n").concat());
        let nothing = select(&[], &[wanted("a").unwrap()], &[], &grid).unwrap_err().text();
        assert_eq!(
            nothing,
            "nothing is recorded\n  = help: add a Scope, or `record: [\"...\"]` to the diagram"
        );
    }

    fn settings(output: OutputTimes) -> Settings {
        let (method, max_step) = (VariableMethod::Ode45, f64::INFINITY);
        let solver = Solver::Variable { method, rtol: 1e-6, atol: Some(1e-6), max_step };
        Settings {
            stop_time: 1.0,
            solver,
            output,
            seed: 0,
            start: Start::Given,
            atol: Vec::new(),
            algebraic_loops: LoopPolicy::default(),
        }
    }
}
