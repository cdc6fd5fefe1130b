//! The page of all projects. It has no scripts, and shows what projects say as text.

use blocksim_numbers::format::{duration, significant};
use blocksim_report::escape;

use super::{Graded, Verdict};
use crate::args::grade::GradeArgs;

const STYLE: &str = "body{font:15px system-ui,sans-serif;margin:24px auto;max-width:1100px;padding:0 16px;color:#0f172a;background:#f8fafc}\
table{border-collapse:collapse;width:100%;background:#fff}th,td{text-align:left;padding:6px 12px;border-bottom:1px solid #e2e8f0;vertical-align:top}\
.agrees{color:#0b6b3a}.bad{color:#b00020}h2{margin:32px 0 6px}img{max-width:100%;border:1px solid #e2e8f0;background:#fff}\
td.n{text-align:right;font-variant-numeric:tabular-nums}\
@media(prefers-color-scheme:dark){body{background:#0b1220;color:#e2e8f0}table{background:#0f172a}th,td{border-color:#334155}.agrees{color:#6fd99a}.bad{color:#ff8a80}a{color:#7cc4ff}}";

/// The page.
pub fn page(args: &GradeArgs, all: &[Graded]) -> String {
    let good = all.iter().filter(|graded| graded.verdict == Verdict::Agrees).count();
    let reference = escape(&args.against.display().to_string());
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta http-equiv=\"Content-Security-Policy\" content=\"default-src \
         'none'; style-src 'unsafe-inline'; img-src 'self' file: data:\">\n<meta name=\"viewport\" content=\"width=device-width, \
         initial-scale=1\">\n<meta name=\"color-scheme\" content=\"light dark\">\n<title>Graded against {reference}</title>\n<style>{STYLE}</style>\n\
         </head>\n<body>\n<h1>Graded against {reference}</h1>\n<p>{good} of {} agree.</p>\n<table><thead><tr><th scope=\"col\">project</th><th \
         scope=\"col\">verdict</th><th scope=\"col\">why</th><th scope=\"col\">took</th></tr></thead><tbody>\n",
        all.len()
    );
    for graded in all {
        let (name, file) = (escape(&graded.name), address(&graded.name));
        let link = if graded.compared.is_null() { name } else { format!("<a href=\"#{file}\">{name}</a>") };
        page.push_str(&format!(
            "<tr><th scope=\"row\">{link}</th><td class=\"{}\">{}</td><td>{}</td><td class=\"n\">{}</td></tr>\n",
            if graded.verdict == Verdict::Agrees { "agrees" } else { "bad" },
            graded.verdict.word(),
            escape(&graded.reason),
            duration(graded.took)
        ));
    }
    page.push_str("</tbody></table>\n");
    for graded in all.iter().filter(|graded| !graded.compared.is_null()) {
        let (name, file) = (escape(&graded.name), address(&graded.name));
        page.push_str(&format!(
            "<h2 id=\"{file}\">{name}: {}</h2>\n<p><a href=\"{file}.html\">page of both runs</a></p>\n<img src=\"{file}.svg\" alt=\"Signals of {name} and of the reference\" loading=\"lazy\">\n{}",
            graded.verdict.word(),
            signals(graded)
        ));
    }
    page.push_str("</body>\n</html>\n");
    page
}

/// Signals that differ.
fn signals(graded: &Graded) -> String {
    let all = graded.compared["signals"].as_array().map(Vec::as_slice).unwrap_or_default();
    let apart: Vec<_> = all.iter().filter(|signal| signal["agrees"] != true).collect();
    if apart.is_empty() {
        return String::new();
    }
    let number = |value: &serde_json::Value| value.as_f64().map_or("–".to_owned(), |x| significant(x, 4));
    let rows: String = apart
        .iter()
        .map(|signal| {
            let text = |name: &str| escape(signal[name].as_str().unwrap_or_default());
            let most = &signal["maximum"];
            format!(
                "<tr><td>{}</td><td>{}</td><td class=\"n\">{}</td><td>{}</td><td class=\"n\">{}</td></tr>\n",
                text("signal"),
                text("verdict"),
                number(&most["difference"]),
                text("unit"),
                number(&most["time"])
            )
        })
        .collect();
    format!(
        "<table><thead><tr><th scope=\"col\">signal</th><th scope=\"col\">verdict</th><th scope=\"col\">maximum difference</th><th \
         scope=\"col\">unit</th><th scope=\"col\">at [s]</th></tr></thead><tbody>\n{rows}</tbody></table>\n"
    )
}

/// The name of a folder in an address.
fn address(name: &str) -> String {
    let mut address = String::new();
    for byte in name.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' => address.push(char::from(byte)),
            other => address.push_str(&format!("%{other:02X}")),
        }
    }
    address
}
