//! Formulas of the manual, which are written in LaTeX, in signs for a terminal.

/// Commands of LaTeX that have a sign of their own.
const SIGNS: [(&str, &str); 50] = [
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
    ("nu", "ν"),
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
    ("leftarrow", "←"),
    ("infty", "∞"),
    ("int", "∫"),
    ("sum", "Σ"),
    ("partial", "∂"),
    ("circ", "∘"),
    ("bmod", "mod"),
    ("quad", "  "),
    ("qquad", "    "),
    ("ldots", "..."),
    ("dots", "..."),
    ("in", "∈"),
    ("top", "ᵀ"),
];

/// Commands whose argument is all that matters.
const BARE: [&str; 16] = [
    "mathrm",
    "text",
    "operatorname",
    "mathbf",
    "mathtt",
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
    "textstyle",
];

/// Functions by name: what follows is their argument.
const FUNCTIONS: [&str; 12] =
    ["sin", "cos", "tan", "tanh", "sinh", "cosh", "exp", "ln", "log", "max", "min", "det"];

/// Commands that put a mark on a letter, as a combining sign.
const MARKS: [(&str, char); 3] = [("dot", '\u{307}'), ("ddot", '\u{308}'), ("hat", '\u{302}')];

/// Replaces what stands between dollars.
pub fn formulas(line: &str) -> String {
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
                Some('\\') => text.push_str("; "),
                Some(_) => text.push(' '),
                None => {}
            }
            rest = signs.as_str();
        } else if command == "begin" || command == "end" {
            // Cases, which are the only environment: "a & if b \\ c & if d".
            (_, rest) = argument(rest);
        } else if command == "sqrt" {
            let (of, after) = argument(rest);
            text.push_str(&format!("√{}", grouped(&formula(of))));
            rest = after;
        } else if command == "frac" || command == "tfrac" {
            let (above, after) = argument(rest);
            let (below, after) = argument(after);
            text.push_str(&format!("{}/{}", grouped(&formula(above)), grouped(&formula(below))));
            rest = after;
        } else if let Some((_, mark)) = MARKS.iter().find(|(name, _)| *name == command) {
            let (of, after) = argument(rest);
            // A combining sign stands behind the letter that it belongs to.
            let of = formula(of);
            let (letter, index) = of.split_at(of.chars().next().map_or(0, char::len_utf8));
            text.push_str(&format!("{letter}{mark}{index}"));
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
    ungrouped(&text).replace(" & ", ", if ")
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
        assert_eq!(formulas("$\\sqrt{\\tfrac23}\\,V$, $\\sqrt3 \\beta$"), "√(2/3) V, √3 β");
        assert_eq!(formulas("$\\hat v_a = \\mathtt{level}$"), "v\u{302}_a = level");
        assert_eq!(
            formulas("$\\begin{cases} 1 & t < 2 \\\\ 0 & \\text{else} \\end{cases}$").trim(),
            "1, if t < 2 ;  0, if else"
        );
        for broken in ["$\\", "$\\frac{a$", "$\\frac$ $", "$}{$", "$\\dot$"] {
            formulas(broken);
        }
    }

    #[test]
    fn every_command_in_the_manual_is_known() {
        let structured = ["frac", "tfrac", "sqrt", "begin", "end"];
        for info in blocksim_block::kinds() {
            for text in [info.doc].into_iter().chain(info.parameters.iter().map(|parameter| parameter.doc)) {
                for piece in text.split('\\').skip(1) {
                    let command = &piece[..piece.bytes().take_while(u8::is_ascii_alphabetic).count()];
                    let known = structured.contains(&command)
                        || BARE.contains(&command)
                        || FUNCTIONS.contains(&command)
                        || SIGNS.iter().any(|(name, _)| *name == command)
                        || MARKS.iter().any(|(name, _)| *name == command);
                    assert!(command.is_empty() || known, "\\{command} in {}", info.kind);
                }
            }
        }
    }
}
