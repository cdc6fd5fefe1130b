//! Whether values meet the requirements of their parameters.

use blocksim_signal::Unit;

use super::{Bound, Inspect, Requirement, Requirements, Shown};
use crate::{ParamError, ParamErrors, ParameterInfo};

/// Most numbers of one list that are reported one by one.
const MOST: usize = 4;

/// Looks at the value of each parameter, as far as there is one, and reports all that do not meet their requirements. What relates two
/// parameters comes behind what is required of each, and is passed over where one of them is wrong already. `written` is the unit in which a
/// parameter is written, for messages.
pub(crate) fn check<'v>(
    infos: &[ParameterInfo],
    value: &dyn Fn(usize) -> Option<&'v dyn Inspect>,
    written: &dyn Fn(&str) -> Option<Unit>,
    errors: &mut ParamErrors,
) {
    let required = || infos.iter().enumerate().filter(|(_, info)| !info.requires.list.is_empty());
    for (index, info) in required() {
        if let Some(value) = value(index)
            && errors.is_right(info.name)
        {
            alone(info, value, written, errors);
        }
    }
    let other = |name: &str| {
        let index = infos.iter().position(|info| info.name == name)?;
        value(index)
    };
    let relations =
        || required().flat_map(|(index, info)| info.requires.list.iter().map(move |one| (index, info, one)));
    // What others are compared with comes first: of limits that cross, those that lie beyond one of them are no further mistake.
    let is_bound = |name: &str| relations().any(|(_, _, requirement)| requirement.other() == Some(name));
    let (bounds, rest): (Vec<_>, Vec<_>) = relations().partition(|(_, info, _)| is_bound(info.name));
    for (index, info, requirement) in bounds.into_iter().chain(rest) {
        if let (Some(value), Some(name)) = (value(index), requirement.other())
            && errors.are_right(&[info.name, name])
            && let Some(other) = other(name)
        {
            beside(info, requirement, value, (name, other), written, errors);
        }
    }
}

/// What is required of a parameter whatever the others are.
fn alone(
    info: &ParameterInfo,
    value: &dyn Inspect,
    written: &dyn Fn(&str) -> Option<Unit>,
    errors: &mut ParamErrors,
) {
    let requires = &info.requires;
    if requires.list.contains(&Requirement::NotEmpty) && value.length() == Some(0) {
        let error = ParamError::new(info.name, format!("`{}` is empty", info.name));
        errors.add(error.help(or(requires.at_nothing, "give at least one value")));
        return;
    }
    if requires.list.contains(&Requirement::Unit)
        && let Some(Err(error)) = value.text().map(Unit::parse)
    {
        let wrong = ParamError::new(info.name, error.message);
        errors.add(error.help.into_iter().fold(wrong, ParamError::help));
        return;
    }
    let limit = |bound| match bound {
        Bound::Number(limit) => limit,
        Bound::Parameter(_) => f64::NAN,
    };
    let mut of_numbers = requires.list.iter().filter(|one| one.is_of_numbers()).peekable();
    if of_numbers.peek().is_some() {
        let list: Vec<&Requirement> = of_numbers.collect();
        let mut wrong: Vec<(String, f64)> = Vec::new();
        value.numbers(&mut Vec::new(), &mut |place, number| {
            if !list.iter().all(|one| one.allows(number, limit)) {
                wrong.push((path(info.name, place), number));
            }
        });
        let more = if wrong.len() > MOST { wrong.len() - 1 } else { 0 };
        let unit = if wrong.is_empty() { None } else { written(info.name) };
        for (path, number) in wrong.iter().take(if more > 0 { 1 } else { MOST }) {
            errors.add(refused(info, path, *number, more, unit.as_ref()));
        }
    }
    if requires.list.contains(&Requirement::Direction) && errors.is_right(info.name) {
        let mut is_zero = true;
        value.numbers(&mut Vec::new(), &mut |_, number| is_zero &= number == 0.0);
        if is_zero {
            let message = format!("`{}` has no length, so it has no direction", info.name);
            let remedy = or(requires.remedy, "write one such as [0.0, 0.0, 1.0]");
            errors.add(ParamError::new(info.name, message).help(remedy));
        }
    }
    if requires.list.contains(&Requirement::Increasing) && errors.is_right(info.name) {
        let mut before: Option<f64> = None;
        let mut wrong = None;
        value.numbers(&mut Vec::new(), &mut |place, number| {
            if before.is_some_and(|before| number <= before) && wrong.is_none() {
                wrong = Some((path(info.name, place), number, before.unwrap_or(f64::NAN)));
            }
            before = Some(number);
        });
        if let Some((path, number, before)) = wrong {
            let unit = written(info.name);
            let shown = Shown::si(info.unit).written(unit.as_ref());
            let [number, before] = [number, before].map(|number| shown.value(number));
            let message = format!("`{path}` is {number}, but must be greater than {before} before it");
            let remedy = or(requires.remedy, "write the numbers in increasing order, each once");
            errors.add(ParamError::new(path, message).help(remedy));
        }
    }
}

/// A requirement that relates a parameter to another one.
fn beside(
    info: &ParameterInfo,
    requirement: &Requirement,
    value: &dyn Inspect,
    (name, other): (&str, &dyn Inspect),
    written: &dyn Fn(&str) -> Option<Unit>,
    errors: &mut ParamErrors,
) {
    let Requirements { remedy, .. } = info.requires;
    if let Requirement::AsManyAs(_) = requirement {
        if let (Some(n), Some(of_other)) = (value.length(), other.length())
            && n != of_other
        {
            let message = format!("`{}` has {n} values, but `{name}` has {of_other}", info.name);
            let help = or(remedy, &format!("give one for each value of `{name}`"));
            errors.add(ParamError::new(info.name, message).beside(&[name]).help(help));
        }
        return;
    }
    let mut limit = None;
    other.numbers(&mut Vec::new(), &mut |place, number| limit = limit.or(place.is_empty().then_some(number)));
    let Some(limit) = limit else { return };
    let mut wrong = None;
    value.numbers(&mut Vec::new(), &mut |place, number| {
        if wrong.is_none() && !requirement.allows(number, |_| limit) {
            wrong = Some((path(info.name, place), number));
        }
    });
    let Some((path, number)) = wrong else { return };
    let (own, of_other) = (written(info.name), written(name));
    let shown = Shown::si(info.unit);
    let message = format!(
        "`{path}` is {}, but must be {}, which is {}",
        shown.written(own.as_ref()).value(number),
        requirement.words(shown),
        shown.written(of_other.as_ref()).value(limit),
    );
    let exchanged = match requirement {
        Requirement::Above(_) | Requirement::AtLeast(_) if number < limit => true,
        Requirement::Below(_) | Requirement::AtMost(_) => number > limit,
        _ => false,
    };
    let swap = format!("are `{}` and `{name}` exchanged?", info.name);
    let error = ParamError::new(path, message).beside(&[name]);
    errors.add(match remedy {
        "" if exchanged => error.help(swap),
        "" => error,
        remedy => error.help(remedy),
    });
}

/// The error of a number that is not allowed, and of `more` others of the same list.
fn refused(info: &ParameterInfo, path: &str, number: f64, more: usize, unit: Option<&Unit>) -> ParamError {
    let Requirements { list, remedy, at_nothing } = info.requires;
    let shown = Shown::si(info.unit).written(unit);
    let demand = info.requires.demand(shown);
    let rest = if more > 0 { format!(", as {more} others of `{}`", info.name) } else { String::new() };
    let message = format!("`{path}` is {}, but {demand}{rest}", shown.value(number));
    let error = ParamError::new(path, message);
    let usual = match demand.as_str() {
        "must be positive" => "write a number above 0",
        "must not be negative" => "write 0 or more; signs and directions come from connections and signals",
        "must be negative" => "write it with its sign",
        _ if list.contains(&Requirement::Finite) && !number.is_finite() => "write a finite number",
        _ => "",
    };
    let remedy = if number == 0.0 { or(at_nothing, remedy) } else { remedy.to_owned() };
    match or(&remedy, usual) {
        remedy if remedy.is_empty() => error,
        remedy => error.help(remedy),
    }
}

/// `table[2][0]`.
fn path(name: &str, place: &[usize]) -> String {
    place.iter().fold(name.to_owned(), |path, index| format!("{path}[{index}]"))
}

fn or(own: &str, usual: &str) -> String {
    if own.is_empty() { usual.to_owned() } else { own.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn info(name: &'static str, unit: &'static str, list: &'static [Requirement]) -> ParameterInfo {
        let requires = Requirements { list, ..Requirements::NONE };
        ParameterInfo { name, unit, requires, ..ParameterInfo::NONE }
    }

    const POSITIVE: &[Requirement] = &[Requirement::Finite, Requirement::Above(Bound::Number(0.0))];
    const ABOVE_LOWER: &[Requirement] = &[Requirement::Above(Bound::Parameter("lower"))];

    fn found(infos: &[ParameterInfo], values: &[&dyn Inspect]) -> Vec<String> {
        let mut errors = ParamErrors::default();
        check(infos, &|index| Some(values[index]), &|_| None, &mut errors);
        errors.iter().map(|error| format!("{}: {}", error.param, error.message)).collect()
    }

    #[test]
    fn every_wrong_parameter_is_reported_with_its_value() {
        let infos =
            [info("a", "s", POSITIVE), info("b", "", POSITIVE), info("c", "", &[Requirement::Finite])];
        assert_eq!(
            found(&infos, &[&-0.5, &f64::NAN, &vec![1.0, f64::INFINITY]]),
            [
                "a: `a` is -0.5 s, but must be positive",
                "b: `b` is NaN, but must be positive",
                "c[1]: `c[1]` is inf, but must be finite",
            ]
        );
        assert!(found(&infos, &[&0.5, &None::<f64>, &vec![[1.0, 2.0]]]).is_empty());
    }

    #[test]
    fn a_relation_is_looked_at_where_both_are_right() {
        let infos = [info("lower", "m", &[Requirement::Finite]), info("upper", "m", ABOVE_LOWER)];
        assert_eq!(
            found(&infos, &[&2.0, &1.0]),
            ["upper: `upper` is 1 m, but must be above `lower`, which is 2 m"]
        );
        assert_eq!(found(&infos, &[&f64::NAN, &1.0]), ["lower: `lower` is NaN m, but must be finite"]);
        assert!(found(&infos, &[&None::<f64>, &1.0]).is_empty() && found(&infos, &[&0.0, &1.0]).is_empty());
        assert_eq!(found(&infos, &[&0.0, &f64::NAN]).len(), 1);
    }

    #[test]
    fn limits_that_cross_come_before_what_lies_beyond_them() {
        let within = &[
            Requirement::AtLeast(Bound::Parameter("lower")),
            Requirement::AtMost(Bound::Parameter("upper")),
        ];
        let infos = [info("x", "", within), info("lower", "", &[]), info("upper", "", ABOVE_LOWER)];
        assert_eq!(
            found(&infos, &[&2.0, &1.0, &0.0]),
            ["upper: `upper` is 0, but must be above `lower`, which is 1"]
        );
        assert_eq!(
            found(&infos, &[&2.0, &0.0, &1.0]),
            ["x: `x` is 2, but must be at most `upper`, which is 1"]
        );
    }

    #[test]
    fn lists_increase_and_have_the_length_of_others() {
        let infos = [
            info("x", "", &[Requirement::NotEmpty, Requirement::Increasing]),
            info("y", "", &[Requirement::AsManyAs("x")]),
        ];
        assert_eq!(
            found(&infos, &[&vec![1.0, 3.0, 3.0], &vec![1.0]]),
            ["x[2]: `x[2]` is 3, but must be greater than 3 before it"]
        );
        assert_eq!(found(&infos, &[&vec![1.0, 2.0], &vec![1.0]]), ["y: `y` has 1 values, but `x` has 2"]);
        assert_eq!(found(&infos, &[&Vec::<f64>::new(), &vec![1.0]]), ["x: `x` is empty"]);
    }

    #[test]
    fn a_list_of_wrong_numbers_is_one_mistake() {
        let infos = [info("x", "", &[Requirement::Finite])];
        assert_eq!(
            found(&infos, &[&vec![f64::NAN; 7]]),
            ["x[0]: `x[0]` is NaN, but must be finite, as 6 others of `x`"]
        );
        assert_eq!(found(&infos, &[&vec![f64::NAN; 3]]).len(), 3);
    }
}
