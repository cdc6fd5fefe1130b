//! Which of the recorded signals are kept, and at which rates.

use blocksim_block::schedule::Recorded;
use blocksim_results::{Layout, Rate};

use crate::args::values::time;
use crate::signals::{naming, shown};

/// What `--signals` names: a pattern, and a rate behind `@`.
#[derive(Debug, Clone, PartialEq)]
pub struct Wanted {
    /// Parts of paths, or a pattern with `*`.
    pub pattern: String,
    /// All rows unless something else is said.
    pub rate: Rate,
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
        pattern => Ok(Wanted { pattern: pattern.to_owned(), rate }),
    }
}

fn rate_of(text: &str) -> Result<Rate, String> {
    let advice = "a rate is a time (@10ms), a number of rows (@10rows) or the least and largest in a time (@minmax:10ms)";
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
#[derive(Debug, PartialEq)]
pub struct Selection {
    /// Signals and their time bases.
    pub layout: Layout,
    /// Positions among what the diagram wants recorded.
    pub sources: Vec<usize>,
}

/// All signals that a diagram wants recorded, or those that fit something wanted; of several that fit the last one says
/// the rate.
///
/// # Errors
/// The first pattern that nothing fits, with some signals that there are.
pub fn select(recorded: &[Recorded], wanted: &[Wanted]) -> Result<Selection, String> {
    let all = shown::layout(recorded);
    if wanted.is_empty() {
        return Ok(Selection { layout: all, sources: (0..recorded.len()).collect() });
    }
    let fits = |wanted: &Wanted, r: &Recorded| naming::fits(&r.path, &wanted.pattern);
    if let Some(lost) = wanted.iter().find(|wanted| !recorded.iter().any(|r| fits(wanted, r))) {
        let some: Vec<&str> = recorded.iter().take(5).map(|r| r.path.as_str()).collect();
        return Err(match some.is_empty() {
            true => "nothing is recorded; add a Scope, or `record: [\"...\"]` to the diagram".to_owned(),
            false => {
                format!("no recorded signal fits `{}`; recorded are {}", lost.pattern, some.join(", "))
                    + if some.len() < recorded.len() { ", ..." } else { "" }
            }
        });
    }
    let mut selection =
        Selection { layout: Layout { rates: Vec::new(), signals: Vec::new() }, sources: Vec::new() };
    for (source, (r, mut info)) in recorded.iter().zip(all.signals).enumerate() {
        let Some(Wanted { rate, .. }) = wanted.iter().rev().find(|wanted| fits(wanted, r)) else { continue };
        let rates = &mut selection.layout.rates;
        // Least and largest values have times of their own for each signal.
        let is_shared = |known: &Rate| known == rate && !matches!(rate, Rate::Extremes(_));
        info.base = rates.iter().position(is_shared).unwrap_or_else(|| {
            rates.push(*rate);
            rates.len() - 1
        });
        selection.layout.signals.push(info);
        selection.sources.push(source);
    }
    Ok(selection)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recorded(path: &str) -> Recorded {
        Recorded {
            path: path.into(),
            cell: 0,
            kind: blocksim_signal::Kind::Real,
            dimension: None,
            display: None,
            title: Vec::new(),
            legend: None,
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
        let Selection { layout, sources } = select(&recorded, &wanted).unwrap();
        assert_eq!(layout.rates, [Rate::Every(0.01), Rate::Extremes(1.0), Rate::Extremes(1.0)]);
        assert_eq!(layout.signals.iter().map(|signal| signal.base).collect::<Vec<_>>(), [0, 0, 1, 2]);
        assert_eq!(sources, [0, 1, 2, 3]);
        let one = select(&recorded, &[super::wanted("*.e").unwrap()]).unwrap();
        assert_eq!((one.layout.rates, one.sources), (vec![Rate::All], vec![3]));
        let all = select(&recorded, &[]).unwrap();
        assert_eq!((all.layout.rates.len(), all.sources.len()), (1, 4));
        let error = select(&recorded, &[super::wanted("leg").unwrap()]).unwrap_err();
        assert_eq!(error, "no recorded signal fits `leg`; recorded are arm.q, arm.tau, ctrl.u, ctrl.e");
    }
}
