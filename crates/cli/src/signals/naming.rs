//! What distinguishes paths from each other.

/// The paths without the leading and trailing parts (between `/`) that all of them share; at least one part stays.
pub fn short_names<'a>(paths: &[&'a str]) -> Vec<&'a str> {
    let parts: Vec<Vec<&str>> = paths.iter().map(|path| path.split('/').collect()).collect();
    let fewest = parts.iter().map(Vec::len).min().unwrap_or(0);
    if paths.len() < 2 {
        return paths.to_vec();
    }
    let same = |part: &dyn Fn(&[&'a str]) -> Option<&'a str>| {
        let first = part(&parts[0]);
        parts.iter().all(|other| part(other) == first)
    };
    let front = (0..fewest - 1).take_while(|&n| same(&|p| p.get(n).copied())).count();
    let back = (0..fewest - 1 - front).take_while(|&n| same(&|p| p.get(p.len() - 1 - n).copied())).count();
    let shorten = |path: &'a str, parts: &[&str]| {
        let length = |parts: &[&str]| parts.iter().map(|part| part.len() + 1).sum::<usize>();
        let (start, end) = (length(&parts[..front]), length(&parts[parts.len() - back..]));
        &path[start..path.len() - end]
    };
    paths.iter().zip(&parts).map(|(path, parts)| shorten(path, parts)).collect()
}

/// What people would call these scopes: the paths without what all of them share and without a last part `scope`, which
/// tells nothing, each from the last part on from which no other path ends alike. Equal paths have equal names.
pub fn distinct_names<'a>(paths: &[&'a str]) -> Vec<&'a str> {
    let plain = |path: &&'a str| path.strip_suffix("/scope").unwrap_or(path);
    let short = short_names(&paths.iter().map(plain).collect::<Vec<_>>());
    let ends_like = |path: &str, ending: &str| {
        path.strip_suffix(ending).is_some_and(|front| front.is_empty() || front.ends_with('/'))
    };
    let is_shared =
        |own: &str, ending: &str| short.iter().any(|other| *other != own && ends_like(other, ending));
    let shorten = |own: &&'a str| -> &'a str {
        let starts = own.rmatch_indices('/').map(|(slash, _)| slash + 1);
        starts.map(|start| &own[start..]).find(|ending| !is_shared(own, ending)).unwrap_or(own)
    };
    short.iter().map(shorten).collect()
}

/// Name and number of the last part of a path that has both: `control/Joint3OutBus/scope` gives `joint`, 3.
pub fn numbered_part(path: &str) -> Option<(String, u32)> {
    path.split(['/', '.']).rev().find_map(name_and_number)
}

/// Whether some part of a path bears this name and number: `arm.signals.Joint3OutBus.Torque` is of `joint`, 3.
pub fn is_of(path: &str, name: &str, number: u32) -> bool {
    let same = |part| name_and_number(part).is_some_and(|(n, k)| n == name && k == number);
    path.split(['/', '.']).any(same)
}

/// The number of a name that has one: `axis3` gives 3.
pub fn name_number(name: &str) -> Option<u32> {
    name_and_number(name).map(|(_, number)| number)
}

/// Letters in lower case before the first digits, and the number that these are.
fn name_and_number(part: &str) -> Option<(String, u32)> {
    let start = part.find(|c: char| c.is_ascii_digit())?;
    let (name, rest) = part.split_at(start);
    let end = rest.find(|c: char| !c.is_ascii_digit()).unwrap_or(rest.len());
    let name = name.trim_end_matches(['_', '[', '-']).to_lowercase();
    if name.is_empty() { None } else { Some((name, rest[..end].parse().ok()?)) }
}

/// Whether a path fits a pattern. Without `*` the pattern is a part of the path. With it the whole path must
/// fit: `*` stands for anything but `/`, `**` for anything.
pub fn fits(path: &str, pattern: &str) -> bool {
    if pattern.contains('*') { fits_whole(path, pattern) } else { path.contains(pattern) }
}

fn fits_whole(path: &str, pattern: &str) -> bool {
    let Some((literal, rest)) = pattern.split_once('*') else { return path == pattern };
    let Some(tail) = path.strip_prefix(literal) else { return false };
    let (rest, deep) = match rest.strip_prefix('*') {
        Some(rest) => (rest.trim_start_matches('*'), true),
        None => (rest, false),
    };
    let ends = tail.char_indices().map(|(at, c)| (at, c == '/')).chain([(tail.len(), true)]);
    for (at, stops) in ends {
        if fits_whole(&tail[at..], rest) {
            return true;
        }
        if stops && !deep {
            return false;
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_as_short_as_they_differ() {
        let control = ["control/joint1/scope", "control/joint2/scope", "control/joint10/scope"];
        assert_eq!(short_names(&control), ["joint1", "joint2", "joint10"]);
        assert_eq!(short_names(&["a/x", "b"]), ["a/x", "b"]);
        assert_eq!(short_names(&["a/x", "a/x"]), ["x", "x"]);
        assert_eq!(short_names(&["a/b/x", "a/c"]), ["b/x", "c"]);
        assert_eq!(short_names(&["servo/angle"]), ["servo/angle"]);
        assert!(short_names(&[]).is_empty());
    }

    #[test]
    fn names_are_the_last_parts_that_tell_them_apart() {
        let robot = ["control/joint1/scope", "control/joint2/scope", "measurements/tool/orientation"];
        assert_eq!(distinct_names(&robot), ["joint1", "joint2", "orientation"]);
        assert_eq!(
            distinct_names(&["a/joint1/pid", "a/joint2/pid", "b/tool"]),
            ["joint1/pid", "joint2/pid", "tool"]
        );
        assert_eq!(distinct_names(&["a/x", "b/x", "x"]), ["a/x", "b/x", "x"]);
        assert_eq!(distinct_names(&["arm/x", "arm/x", "arm/y"]), ["x", "x", "y"]);
        assert_eq!(distinct_names(&["loop/angle"]), ["angle"]);
        assert_eq!(distinct_names(&["scope", "arm/scope"]), ["scope", "arm"]);
        assert!(distinct_names(&[]).is_empty());
    }

    #[test]
    fn joints_are_known_by_name_and_number() {
        assert_eq!(numbered_part("control/joint3/scope"), Some(("joint".into(), 3)));
        assert_eq!(numbered_part("a/axis_12/b1/scope"), Some(("b".into(), 1)));
        assert_eq!(numbered_part("servo/angle"), None);
        assert!(is_of("arm.signals.Joint3OutBus.Torque", "joint", 3));
        assert!(!is_of("arm.signals.Joint13OutBus.Torque", "joint", 3));
        assert!(!is_of("arm.signals.Joint3OutBus.Torque", "joint", 31));
        assert!(!is_of("arm/link3.torque", "joint", 3));
    }

    #[test]
    fn patterns_name_parts_or_whole_paths() {
        assert!(fits("control/joint1/scope.set", "joint1"));
        assert!(fits("control/joint1/scope.set", "control/*/scope.set"));
        assert!(fits("control/joint1/scope.set", "**.set"));
        assert!(fits("control/joint1/scope.set", "control/**"));
        assert!(fits("angle.set", "*.set") && fits("angle.set", "angle.*") && fits("angle.set", "*"));
        assert!(!fits("control/joint1/scope.set", "*.set"));
        assert!(!fits("control/joint1/scope.set", "control/*.set"));
        assert!(!fits("angle.set", "*.sets") && !fits("angle.set", "q1"));
    }
}
