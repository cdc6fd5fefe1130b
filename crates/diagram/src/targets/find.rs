//! Targets by name.

use blocksim_signal::closest;

use super::Target;

/// What a name means.
#[derive(Debug)]
pub enum Found<'t> {
    /// This one.
    One(&'t Target),
    /// A set or a block with these below it.
    Several(Vec<&'t Target>),
    /// Nothing; a sentence what may be meant.
    Nothing(String),
}

/// What lies below a set, a file or a block; items of lists are left out.
pub fn below<'t>(targets: &'t [Target], name: &str) -> Vec<&'t Target> {
    let is_below = |target: &&Target| {
        target.name.strip_prefix(name).is_some_and(|rest| rest.starts_with(['.', '/', '[']))
    };
    targets.iter().filter(|target| !target.is_item).filter(is_below).collect()
}

/// Finds what a name means.
pub fn find<'t>(targets: &'t [Target], name: &str) -> Found<'t> {
    if let Some(one) = targets.iter().find(|target| target.name == name) {
        return Found::One(one);
    }
    let below = below(targets, name);
    if !below.is_empty() {
        return Found::Several(below);
    }
    // `arm/link3.axis.gear.ring_teeth`, where `arm/link3.axis` is `robot.axis3`.
    let above = targets.iter().find_map(|target| {
        let rest = name.strip_prefix(target.name.as_str())?;
        let path = target.written.strip_prefix('"')?.strip_suffix('"')?;
        let is_path = path.chars().all(|c| c.is_ascii_alphanumeric() || "_.[]".contains(c));
        let meant = format!("{path}{rest}");
        let known = targets.iter().any(|target| target.name == meant);
        (rest.starts_with(['.', '[']) && is_path).then(|| match known {
            true => format!("`{}` is `{path}` there: name `{meant}`", target.name),
            false => format!("`{}` is `{path}` there, a name of the diagram around it", target.name),
        })
    });
    Found::Nothing(above.unwrap_or_else(|| {
        match closest(name, targets.iter().map(|target| target.name.as_str())) {
            Some(close) => format!("did you mean `{close}`?"),
            None => "`blocksim params list MODEL` lists all names".to_owned(),
        }
    }))
}
