/// A unit as it is set in print: `deg/s^2` is `°/s²`, `N*m` is `N·m`; empty for `1`.
pub fn pretty_unit(unit: &str) -> String {
    if unit == "1" {
        return String::new();
    }
    let mut text = String::new();
    let mut raised = false;
    for sign in unit.replace("deg", "°").chars() {
        match sign {
            '^' => raised = true,
            '*' => text.push('·'),
            '0'..='9' | '-' | '+' if raised => text.push(superscript(sign)),
            _ => text.push(sign),
        }
        raised &= sign == '^' || sign == '-' || sign == '+' || sign.is_ascii_digit();
    }
    text
}

fn superscript(sign: char) -> char {
    match sign {
        '0' => '⁰',
        '1' => '¹',
        '2' => '²',
        '3' => '³',
        '4' => '⁴',
        '5' => '⁵',
        '6' => '⁶',
        '7' => '⁷',
        '8' => '⁸',
        '9' => '⁹',
        '-' => '⁻',
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_set_as_in_print() {
        for (unit, expected) in [
            ("deg", "°"),
            ("deg/s^2", "°/s²"),
            ("N*m", "N·m"),
            ("kg*m^2", "kg·m²"),
            ("s^-1", "s⁻¹"),
            ("m^10*s", "m¹⁰·s"),
            ("1", ""),
            ("rpm", "rpm"),
        ] {
            assert_eq!(pretty_unit(unit), expected);
        }
    }
}
