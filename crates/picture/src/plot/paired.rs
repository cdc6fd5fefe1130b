//! Set values and actual values, known by their names.

/// Words for what should be.
const SET: [&str; 10] =
    ["set", "ref", "reference", "setpoint", "target", "desired", "demand", "cmd", "command", "soll"];
/// Words for what is.
const ACTUAL: [&str; 8] = ["actual", "act", "measured", "meas", "feedback", "fb", "out", "ist"];

/// Positions of set values and of the actual values that follow them: `set` and `actual`, `q_set` and `q`,
/// `speed.ref` and `speed.measured`, `set[2]` and `actual[2]`. A name without a partner is in no pair, and each is in one at most.
///
/// ```
/// use blocksim_picture::pairs;
///
/// assert_eq!(pairs(&["w_ref", "w", "torque"]), [(0, 1)]);
/// ```
pub fn pairs(names: &[&str]) -> Vec<(usize, usize)> {
    let split: Vec<(String, Role)> = names.iter().map(|name| role(name)).collect();
    let mut taken = vec![false; names.len()];
    let mut found = Vec::new();
    for (set, (stem, _)) in split.iter().enumerate().filter(|(_, (_, role))| *role == Role::Set) {
        let follows = |wanted: Role| {
            let fits = |&at: &usize| !taken[at] && split[at].0 == *stem && split[at].1 == wanted;
            (0..names.len()).find(fits)
        };
        if let Some(actual) = follows(Role::Actual).or_else(|| follows(Role::Plain)) {
            taken[actual] = true;
            found.push((set, actual));
        }
    }
    found
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Role {
    Set,
    Actual,
    Plain,
}

/// What is left of a name without the words that say its role.
fn role(name: &str) -> (String, Role) {
    let lower = name.to_lowercase();
    let words: Vec<&str> =
        lower.split(['_', '.', '/', ' ', '-', '[', ']']).filter(|word| !word.is_empty()).collect();
    let has = |list: &[&str]| words.iter().any(|word| list.contains(word));
    let role = if has(&SET) {
        Role::Set
    } else if has(&ACTUAL) {
        Role::Actual
    } else {
        Role::Plain
    };
    let stem: Vec<&str> = words
        .into_iter()
        .filter(|word| !SET.contains(word) && !ACTUAL.contains(word) && !["value", "values"].contains(word))
        .collect();
    (stem.join("_"), role)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn set_values_find_what_follows_them() {
        assert_eq!(pairs(&["set", "actual"]), [(0, 1)]);
        assert_eq!(pairs(&["q1", "q2", "q2_ref", "q1_ref"]), [(2, 1), (3, 0)]);
        assert_eq!(pairs(&["speed.ref", "speed.measured", "speed"]), [(0, 1)]);
        assert_eq!(pairs(&["set value", "actual value"]), [(0, 1)]);
        assert_eq!(pairs(&["set[0]", "set[1]", "actual[0]", "actual[1]"]), [(0, 2), (1, 3)]);
        assert_eq!(pairs(&["desired", "y"]), []);
        assert_eq!(pairs(&["axis1", "axis2", "axis3"]), []);
        assert_eq!(pairs(&["set", "set"]), []);
    }
}
