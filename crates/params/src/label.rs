//! What quantities are called in a sheet.

/// Names that words of paths stand for; the terms are those of the sheets' source.
const WORDS: &[(&str, &str)] = &[
    ("payload", "handling capacity"),
    ("reach", "reach"),
    ("tcp", "tool centre point"),
    ("tcp_limits", "TCP limits"),
    ("turn_about_y", "turn about y"),
    ("com", "centre of mass"),
    ("moi", "moments of inertia Ixx, Iyy, Izz"),
    ("poi", "products of inertia Iyz, Izx, Ixy"),
    ("centre", "centre of the drawn shape"),
    ("size", "size of the drawn shape"),
    ("lower", "lower limit"),
    ("upper", "upper limit"),
    ("start", "state target"),
    ("equilibrium", "equilibrium position"),
    ("stiffness", "spring stiffness"),
    ("damping", "damping coefficient"),
    ("breakaway", "breakaway friction torque"),
    ("breakaway_velocity", "breakaway friction velocity"),
    ("coulomb", "Coulomb friction torque"),
    ("viscous", "viscous friction coefficient"),
    ("asm", "asynchronous machine"),
    ("dc", "DC drive"),
    ("torque", "ideal torque drive"),
    ("rated_power", "rated apparent power"),
    ("rated_frequency", "rated electrical frequency"),
    ("pole_pairs", "number of pole pairs"),
    ("r_s", "stator resistance"),
    ("x_ls", "stator leakage reactance"),
    ("r_r", "rotor resistance"),
    ("x_lr", "rotor leakage reactance"),
    ("x_m", "magnetising reactance"),
    ("x_0", "zero-sequence reactance"),
    ("vdc", "DC link voltage"),
    ("r", "resistance"),
    ("l", "inductance"),
    ("k", "torque constant"),
    ("j", "rotor inertia"),
    ("largest", "largest torque"),
    ("disc_teeth", "number of disc teeth"),
    ("ring_teeth", "number of ring teeth"),
    ("efficiency_forward", "efficiency, motor drives"),
    ("efficiency_backward", "efficiency, load drives"),
];

/// `axis*.bearing.coulomb` is `Bearing: Coulomb friction torque`; words without another name keep their own.
pub(crate) fn label(key: &str) -> String {
    let path = key.strip_prefix("axis*.").unwrap_or(key);
    let path = path.strip_suffix("[*]").unwrap_or(path);
    let words: Vec<String> = path
        .split('.')
        .map(|word| match WORDS.iter().find(|(known, _)| *known == word) {
            Some((_, name)) => (*name).to_owned(),
            None => word.replace('_', " "),
        })
        .collect();
    let mut text = words.join(": ");
    if let Some(first) = text.get(..1) {
        let capital = first.to_uppercase();
        text.replace_range(..1, &capital);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_become_words() {
        assert_eq!(label("axis*.bearing.coulomb"), "Bearing: Coulomb friction torque");
        assert_eq!(label("link2.com[*]"), "Link2: centre of mass");
        assert_eq!(label("new_thing"), "New thing");
        assert_eq!(label("ölstand"), "ölstand");
        assert_eq!(label(""), "");
    }
}
