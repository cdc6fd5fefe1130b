//! The one page: a frame whose sections scripts fill.

use blocksim_report::escape;

use crate::assets::{scripts, styles};

/// Screens: the name in the address, and what it is called.
const SCREENS: [(&str, &str); 9] = [
    ("project", "Project"),
    ("diagram", "Diagram"),
    ("values", "Parameters"),
    ("motion", "Motion"),
    ("run", "Run"),
    ("runs", "Results"),
    ("sweep", "Sweep"),
    ("linear", "Linear analysis"),
    ("plugins", "Plug-ins"),
];

/// The scripts of the page of a run expect data; the studio brings it later.
const NO_DATA: &str = r#"{"v":1,"panels":[],"overlays":[],"unseen":{"counts":[],"time":[0,0,8],"values":[0,0,8],"off":[0,0,8]}}"#;

/// The page; `title` is the name of the project.
pub(crate) fn page(title: &str) -> String {
    let title = escape(title);
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width, \
         initial-scale=1\">\n<meta name=\"color-scheme\" content=\"light dark\">\n<title>{title} – blocksim</title>\n<link rel=\"icon\" href=\"data:,\">\n"
    );
    for style in styles() {
        page.push_str(&format!("<link rel=\"stylesheet\" href=\"/assets/{style}\">\n"));
    }
    page.push_str("<style id=\"drawing-style\"></style>\n</head>\n<body class=\"studio\">\n");
    page.push_str("<a class=\"skip\" href=\"#screen\">To the content</a>\n<header class=\"bar\"><strong class=\"brand\">blocksim</strong><nav id=\"rail\" aria-label=\"Screens\">");
    for (id, name) in SCREENS {
        page.push_str(&format!("<a href=\"#{id}\">{name}</a>"));
    }
    page.push_str(
        "</nav><span class=\"tools\"><select id=\"models\" aria-label=\"Model\" title=\"Model\"></select>\
         <button type=\"button\" id=\"start\" class=\"main\" title=\"Run (F5)\">▶ Run</button>\
         <button type=\"button\" id=\"end\" title=\"End the run; what it has recorded is kept\" hidden>■ Stop</button>\
         <button type=\"button\" id=\"theme\" title=\"Light or dark (D)\">Theme</button>\
         <button type=\"button\" id=\"help\" title=\"All keys (?)\">Keys</button></span></header>\n\
         <p id=\"lost\" class=\"warning\" role=\"alert\" hidden>The program does not answer any more; what is here stays. \
         <code>blocksim studio</code> starts it again, and this page finds it if it has the same port.</p>\n\
         <main id=\"screen\" tabindex=\"-1\">\n<div id=\"trouble\" role=\"alert\"></div>\n",
    );
    for (id, name) in SCREENS {
        let view = match id {
            "diagram" => "<div id=\"problems\"></div><div id=\"diagram-view\"></div>".to_owned(),
            "run" => "<div id=\"run-bar\"></div><div class=\"run-parts\"><div id=\"panel\" role=\"group\" aria-label=\"Panel\"></div>\
                      <div id=\"movement\" role=\"group\" aria-label=\"Mechanism\" hidden></div><div id=\"plots\"></div></div>"
                .to_owned(),
            other => format!("<div id=\"{other}-view\"></div>"),
        };
        page.push_str(&format!(
            "<section id=\"{id}\" aria-label=\"{name}\" hidden><h1>{name}</h1>{view}</section>\n"
        ));
    }
    page.push_str(&format!(
        "</main>\n<footer id=\"state\"><output id=\"status\" role=\"status\"></output></footer>\n<dialog id=\"keys\" aria-label=\"Keys\"></dialog>\n\
         <div id=\"announcement\" class=\"unseen\" aria-live=\"polite\"></div>\n<script type=\"application/json\" id=\"report-data\">{NO_DATA}</script>\n"
    ));
    for script in scripts() {
        page.push_str(&format!("<script src=\"/assets/{script}\"></script>\n"));
    }
    page.push_str("</body>\n</html>\n");
    page
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_of_a_folder_is_text() {
        let page = page("<script>alert(1)</script>");
        assert!(page.contains("<title>&lt;script&gt;alert(1)&lt;/script&gt; – blocksim</title>"), "{page}");
        assert!(page.contains("<script src=\"/assets/studio.js\"></script>"));
    }
}
