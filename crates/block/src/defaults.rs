//! Defaults of parameters as a diagram would write them.

/// Turns the Rust of a default into RON: `vec!["u".to_owned()]` is `["u"]`, `After::Hold` is `Hold`. `None` for what
/// may be absent and is.
pub fn in_diagram(rust: &str) -> Option<String> {
    let rust = rust.trim();
    if rust == "None" { None } else { Some(value(rust)) }
}

fn value(rust: &str) -> String {
    let rust = rust.trim().trim_start_matches('&');
    for ending in [".to_owned()", ".to_string()", ".into()"] {
        if let Some(inside) = rust.strip_suffix(ending) {
            return value(inside);
        }
    }
    if rust.starts_with('"') {
        return rust.to_owned();
    }
    for start in ["Some(", "String::from(", "Vec::from("] {
        if let Some(inside) = rust.strip_prefix(start).and_then(|rest| rest.strip_suffix(')')) {
            return value(inside);
        }
    }
    let list = rust.strip_prefix("vec!").unwrap_or(rust);
    if let Some(inside) = list.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
        let items: Vec<String> = items(inside).into_iter().map(value).collect();
        return format!("[{}]", items.join(", "));
    }
    match rust {
        "Vec::new()" | "Vec::default()" => "[]".to_owned(),
        "String::new()" | "String::default()" => "\"\"".to_owned(),
        "BTreeMap::new()" | "BTreeMap::default()" => "{}".to_owned(),
        _ => constant(rust.rsplit("::").next().unwrap_or(rust)),
    }
}

/// A word without its path. Numbers of mathematics are expressions.
fn constant(word: &str) -> String {
    let known = [
        ("PI", "\"pi\""),
        ("TAU", "\"2*pi\""),
        ("FRAC_PI_2", "\"pi/2\""),
        ("INFINITY", "inf"),
        ("NEG_INFINITY", "-inf"),
    ];
    let found = known.iter().find(|(name, _)| *name == word);
    found.map_or(word, |(_, text)| text).to_owned()
}

/// What stands between the commas of the outermost level.
fn items(list: &str) -> Vec<&str> {
    let (mut depth, mut quoted, mut start) = (0, false, 0);
    let mut items = Vec::new();
    for (at, sign) in list.char_indices() {
        match sign {
            '"' => quoted = !quoted,
            '(' | '[' if !quoted => depth += 1,
            ')' | ']' if !quoted => depth -= 1,
            ',' if !quoted && depth == 0 => {
                items.push(&list[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    items.push(&list[start..]);
    items.retain(|item| !item.trim().is_empty());
    items
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rust_becomes_ron() {
        for (rust, ron) in [
            ("1.0", "1.0"),
            ("-5.73e5", "-5.73e5"),
            ("false", "false"),
            ("After::Hold", "Hold"),
            ("Reset::None", "None"),
            ("vec![\"u\".to_owned()]", "[\"u\"]"),
            ("[0.0,0.0,-9.80665]", "[0.0, 0.0, -9.80665]"),
            ("vec![vec![1.0,2.0],vec![3.0,4.0]]", "[[1.0, 2.0], [3.0, 4.0]]"),
            ("Vec::new()", "[]"),
            ("BTreeMap::new()", "{}"),
            ("Some(Kind::A)", "A"),
            ("std::f64::consts::PI", "\"pi\""),
            ("\"a::b, [c]\".to_owned()", "\"a::b, [c]\""),
            ("vec![\"a,b\".into(),\"c\".into()]", "[\"a,b\", \"c\"]"),
        ] {
            assert_eq!(in_diagram(rust).as_deref(), Some(ron), "{rust}");
        }
        assert_eq!(in_diagram("None"), None);
    }
}
