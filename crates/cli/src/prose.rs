//! Markdown of the manual as text for a terminal.

/// Commands of LaTeX that have a sign of their own.
const SIGNS: [(&str, &str); 46] = [
    ("alpha", "α"),
    ("beta", "β"),
    ("gamma", "γ"),
    ("delta", "δ"),
    ("Delta", "Δ"),
    ("varepsilon", "ε"),
    ("epsilon", "ε"),
    ("zeta", "ζ"),
    ("eta", "η"),
    ("theta", "θ"),
    ("vartheta", "ϑ"),
    ("lambda", "λ"),
    ("mu", "μ"),
    ("pi", "π"),
    ("rho", "ρ"),
    ("sigma", "σ"),
    ("tau", "τ"),
    ("phi", "φ"),
    ("varphi", "φ"),
    ("psi", "ψ"),
    ("omega", "ω"),
    ("Omega", "Ω"),
    ("Phi", "Φ"),
    ("Psi", "Ψ"),
    ("cdot", "·"),
    ("times", "×"),
    ("mp", "∓"),
    ("pm", "±"),
    ("le", "≤"),
    ("leq", "≤"),
    ("ge", "≥"),
    ("geq", "≥"),
    ("ne", "≠"),
    ("approx", "≈"),
    ("to", "→"),
    ("rightarrow", "→"),
    ("infty", "∞"),
    ("int", "∫"),
    ("sum", "Σ"),
    ("partial", "∂"),
    ("quad", "  "),
    ("qquad", "    "),
    ("ldots", "..."),
    ("dots", "..."),
    ("in", "∈"),
    ("top", "ᵀ"),
];

/// Commands whose argument is all that matters.
const BARE: [&str; 14] = [
    "mathrm",
    "text",
    "operatorname",
    "mathbf",
    "boldsymbol",
    "left",
    "right",
    "bigl",
    "bigr",
    "Bigl",
    "Bigr",
    "bigg",
    "Bigg",
    "displaystyle",
];

/// Functions by name: what follows is their argument.
const FUNCTIONS: [&str; 12] =
    ["sin", "cos", "tan", "tanh", "sinh", "cosh", "exp", "ln", "log", "max", "min", "det"];

/// Readable text: formulas in signs instead of commands, code indented, links by their words.
pub fn prose(markdown: &str) -> String {
    let mut text = String::new();
    for (n, part) in markdown.split("```").enumerate() {
        if n % 2 == 0 {
            // Formulas may reach over several lines, but not over an empty one.
            let paragraphs: Vec<String> = part.split("\n\n").map(|p| formulas(&links(p))).collect();
            text.push_str(&paragraphs.join("\n\n"));
        } else {
            let code = part.lines().skip(1).map(|line| format!("    {line}").trim_end().to_owned());
            text.push_str(&code.collect::<Vec<_>>().join("\n"));
        }
    }
    let lines = text.trim_end().lines().map(|line| format!("{}\n", line.trim_end()));
    lines.collect()
}

/// The first sentence of a comment, formulas included, in one line.
pub fn first_sentence(markdown: &str) -> String {
    let paragraph: Vec<&str> = markdown.trim().lines().take_while(|line| !line.trim().is_empty()).collect();
    let text = formulas(&links(&paragraph.join(" ")));
    let text = text.trim();
    // A point ends a sentence if a space follows, and not within "e.g." or behind a number of a formula.
    let mut points = text.match_indices(". ").map(|(at, _)| at);
    match points.find(|&at| !text[..at].ends_with('.')) {
        Some(end) => text[..=end].to_owned(),
        None => text.to_owned(),
    }
}

/// The text cut behind a word, with dots, where it has more than `room` signs.
pub fn shortened(text: &str, room: usize) -> String {
    if text.chars().count() <= room {
        return text.to_owned();
    }
    let start: String = text.chars().take(room.saturating_sub(3)).collect();
    let words = start.rsplit_once(' ').map_or(start.as_str(), |(words, _)| words);
    format!("{} ...", words.trim_end_matches([',', ':', ' ']))
}

/// A comment in one line.
pub fn one_line(markdown: &str) -> String {
    prose(markdown).split_whitespace().collect::<Vec<_>>().join(" ")
}

/// The text with line feeds instead of some spaces, so that no line is longer than `width` unless a word is.
pub fn wrapped(text: &str, width: usize) -> String {
    let mut out = String::with_capacity(text.len());
    let mut column = 0;
    for word in text.split_inclusive([' ', '\n']) {
        let length = word.trim_end().chars().count();
        if column > 0 && column + length > width {
            out.truncate(out.trim_end().len());
            out.push('\n');
            column = 0;
        }
        out.push_str(word);
        column = if word.ends_with('\n') { 0 } else { column + word.chars().count() };
    }
    out
}

/// Links to names, with or without an address, become the names.
fn links(line: &str) -> String {
    let mut text = String::new();
    let mut rest = line;
    while let Some(start) = rest.find("[`") {
        let Some(end) = rest[start..].find("`]").map(|end| start + end) else { break };
        text.push_str(&rest[..start]);
        text.push_str(&rest[start + 1..=end]);
        rest = &rest[end + 2..];
        if let Some(address) = rest.strip_prefix('(')
            && let Some(close) = address.find(')')
        {
            rest = &address[close + 1..];
        }
    }
    text + rest
}

/// Replaces what stands between dollars.
fn formulas(line: &str) -> String {
    let parts: Vec<&str> = line.split("$$").flat_map(|part| part.split('$')).collect();
    if parts.len().is_multiple_of(2) {
        // A lone dollar is a dollar.
        return line.to_owned();
    }
    let formula = |(n, part): (usize, &&str)| if n % 2 == 1 { formula(part) } else { (*part).to_owned() };
    parts.iter().enumerate().map(formula).collect()
}

fn formula(tex: &str) -> String {
    let mut text = String::new();
    let mut rest = tex;
    while let Some(at) = rest.find('\\') {
        text.push_str(&rest[..at]);
        rest = &rest[at + 1..];
        let length = rest.bytes().take_while(u8::is_ascii_alphabetic).count();
        let (command, after) = rest.split_at(length);
        rest = after;
        if command.is_empty() {
            // `\,` and its like are spaces, `\{` is a brace.
            let mut signs = rest.chars();
            match signs.next() {
                Some(sign @ ('{' | '}' | '%' | '_' | '$')) => text.push(sign),
                Some(_) => text.push(' '),
                None => {}
            }
            rest = signs.as_str();
        } else if command == "frac" {
            let (above, after) = argument(rest);
            let (below, after) = argument(after);
            text.push_str(&format!("{}/{}", grouped(&formula(above)), grouped(&formula(below))));
            rest = after;
        } else if command == "dot" || command == "ddot" {
            let (of, after) = argument(rest);
            // A combining sign stands behind the letter that it belongs to.
            let of = formula(of);
            let (letter, index) = of.split_at(of.chars().next().map_or(0, char::len_utf8));
            let dots = if command == "dot" { '\u{307}' } else { '\u{308}' };
            text.push_str(&format!("{letter}{dots}{index}"));
            rest = after;
        } else if FUNCTIONS.contains(&command) {
            text.push_str(command);
            let follows = rest.trim_start();
            if let Some(fraction) = follows.strip_prefix("\\frac") {
                let (above, after) = argument(fraction);
                let (below, after) = argument(after);
                let (above, below) = (grouped(&formula(above)), grouped(&formula(below)));
                text.push_str(&format!("({above}/{below})"));
                rest = after;
            } else if follows.starts_with(|c: char| c.is_alphanumeric() || c == '\\') {
                text.push(' ');
                rest = follows;
            }
        } else if let Some((_, sign)) = SIGNS.iter().find(|(name, _)| *name == command) {
            text.push_str(sign);
        } else if !BARE.contains(&command) {
            text.push_str(command);
        }
    }
    text.push_str(rest);
    ungrouped(&text)
}

/// Without braces; what is raised or lowered and has several parts gets parentheses: `y_{k-n}` is y_(k-n).
fn ungrouped(tex: &str) -> String {
    let mut text = String::new();
    let mut rest = tex;
    while let Some(at) = rest.find(['{', '}']) {
        let (before, from) = rest.split_at(at);
        text.push_str(before);
        let is_script = before.ends_with(['_', '^']) && from.starts_with('{');
        let (inside, after) = if is_script { argument(from) } else { ("", &from[1..]) };
        if is_script {
            text.push_str(&grouped(&ungrouped(inside)));
        }
        rest = after;
    }
    text + rest
}

/// What stands in the braces at the start, or the first command or sign, and the rest.
fn argument(tex: &str) -> (&str, &str) {
    let tex = tex.trim_start();
    if let Some(command) = tex.strip_prefix('\\') {
        return tex.split_at(1 + command.bytes().take_while(u8::is_ascii_alphabetic).count());
    }
    let mut depth = 0;
    for (at, sign) in tex.char_indices() {
        depth += i32::from(sign == '{') - i32::from(sign == '}');
        if depth == 0 {
            let end = at + sign.len_utf8();
            return if sign == '}' { (&tex[1..at], &tex[end..]) } else { (&tex[..end], &tex[end..]) };
        }
    }
    (tex, "")
}

/// In parentheses if it is more than one term or factor.
fn grouped(text: &str) -> String {
    let text = text.trim();
    let single = text.chars().all(|c| c.is_alphanumeric() || "_^".contains(c));
    if single { text.to_owned() } else { format!("({text})") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_are_readable() {
        assert_eq!(formulas("Law: $y = k \\cdot u$ holds."), "Law: y = k · u holds.");
        assert_eq!(formulas("$\\frac{1}{1 + \\tau s}$"), "1/(1 + τ s)");
        assert_eq!(formulas("$\\dot{x} = \\frac{u - x}{\\tau}$"), "x\u{307} = (u - x)/τ");
        assert_eq!(formulas("$\\tau = J \\ddot\\omega$, $\\dot x_i$"), "τ = J ω\u{308}, x\u{307}_i");
        assert_eq!(formulas("$\\tanh\\frac{w}{w_{th}}$, $\\max(a)$"), "tanh(w/w_th), max(a)");
        assert_eq!(formulas("$\\sin\\phi \\cdot \\Bigl(a\\Bigr)$"), "sin φ · (a)");
        assert_eq!(formulas("costs 5 $ or more"), "costs 5 $ or more");
        assert_eq!(formulas("$$\\omega_{ref}$$"), "ω_ref");
        assert_eq!(formulas("$y_{k-n} + x_{ref}^2$"), "y_(k-n) + x_ref^2");
        assert_eq!(formulas("$$ a = \\frac{b}{c},\n  d = e $$"), " a = b/c,\n  d = e ");
        assert_eq!(formulas("$\\left(a\\right)\\,b$"), "(a) b");
        for broken in ["$\\", "$\\frac{a$", "$\\frac$ $", "$}{$", "$\\dot$"] {
            formulas(broken);
        }
    }

    #[test]
    fn code_is_indented_and_links_are_words() {
        let text = "See [`Gain`] and [`Sum`](crate::Sum).\n\n```ron\nGain(k: 2)\n```\n";
        assert_eq!(prose(text), "See `Gain` and `Sum`.\n\n    Gain(k: 2)\n");
    }

    #[test]
    fn the_first_sentence_ends_at_its_point() {
        let doc = "Multiplies by a constant: $y = 1.5 u$, element\nby element. More.\n\nSecond.";
        assert_eq!(first_sentence(doc), "Multiplies by a constant: y = 1.5 u, element by element.");
        assert_eq!(first_sentence("No point"), "No point");
        assert_eq!(first_sentence("From `a` ... `b`. More."), "From `a` ... `b`.");
    }

    #[test]
    fn a_long_sentence_is_cut_behind_a_word() {
        assert_eq!(shortened("Limits, and protection", 30), "Limits, and protection");
        assert_eq!(shortened("Limits, and protection", 12), "Limits ...");
        assert!(shortened("Limits, and protection", 20).chars().count() <= 20);
    }

    #[test]
    fn long_texts_are_wrapped_at_spaces() {
        let list: Vec<String> = (0..40).map(|n| format!("`input_{n}` = {n}")).collect();
        let text = wrapped(&list.join(", "), 100);
        assert!(text.lines().all(|line| line.chars().count() <= 100) && text.lines().count() > 5, "{text}");
        assert_eq!(text.replace('\n', " "), list.join(", "));
        let long = "x".repeat(300);
        assert_eq!(wrapped(&long, 100), long);
        assert_eq!(wrapped("two\nlines", 100), "two\nlines");
    }
}
