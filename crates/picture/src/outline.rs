//! Texts of a drawing replaced by their outlines.

use std::fmt::Write;

use roxmltree::{Document, Node};

use crate::error::PictureError;
use crate::font::text_width;
use crate::glyphs::outline;

/// Font size where nothing says one, as in browsers.
const SIZE: f64 = 16.0;
/// How far a bold letter is drawn a second time beside itself, em.
const BOLD: f64 = 0.045;

/// The drawing with a `path` in the place of each `text`, which keeps all attributes that do not concern letters.
///
/// # Errors
/// [`PictureError::NotSvg`] where the text is not well-formed.
pub(crate) fn outlined(svg: &str) -> Result<String, PictureError> {
    let document = Document::parse(svg).map_err(|error| PictureError::NotSvg(error.to_string()))?;
    let mut drawing = String::with_capacity(svg.len() * 2);
    let mut done = 0;
    for text in document.descendants().filter(|node| node.tag_name().name() == "text") {
        let place = text.range();
        // A text within a text is part of it.
        if place.start < done {
            continue;
        }
        drawing.push_str(&svg[done..place.start]);
        push_path(&mut drawing, text);
        done = place.end;
    }
    drawing.push_str(&svg[done..]);
    Ok(drawing)
}

/// Appends the outlines of a text as an element.
fn push_path(drawing: &mut String, text: Node) {
    let size = inherited(text, "font-size").map_or(SIZE, number);
    let place = |name: &str| text.attribute(name).map_or(0.0, number);
    let content: String =
        text.descendants().filter(Node::is_text).filter_map(|part| part.text()).collect::<Vec<_>>().concat();
    let content = content.split_whitespace().collect::<Vec<_>>().join(" ");
    // Share of the width that lies left of `x`.
    let left = match inherited(text, "text-anchor") {
        Some("middle") => 0.5,
        Some("end") => 1.0,
        _ => 0.0,
    };
    let (x, y) = (place("x") - left * text_width(&content, size), place("y"));
    let mut data = outline(&content, x, y, size);
    if inherited(text, "font-weight").is_some_and(|weight| weight == "bold" || number(weight) >= 600.0) {
        data.push_str(&outline(&content, x + BOLD * size, y, size));
    }
    drawing.push_str("<path");
    let of_letters = ["x", "y", "dx", "dy", "font-size", "font-family", "font-weight", "text-anchor"];
    for attribute in text.attributes().filter(|a| a.namespace().is_none() && !of_letters.contains(&a.name()))
    {
        // Writing to a string cannot fail.
        let _ = write!(drawing, " {}=\"{}\"", attribute.name(), escaped(attribute.value()));
    }
    let _ = write!(drawing, " d=\"{data}\"/>");
}

/// The attribute of the element or the nearest one around it.
fn inherited<'a>(node: Node<'a, '_>, name: &str) -> Option<&'a str> {
    node.ancestors().find_map(|node| node.attribute(name))
}

/// A number, with or without `px`; 0 for what is none.
fn number(text: &str) -> f64 {
    text.trim().trim_end_matches("px").parse().ok().filter(|x: &f64| x.is_finite()).unwrap_or(0.0)
}

/// A text for use in an attribute.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_becomes_a_path_that_keeps_its_colour_and_place() {
        let svg = r#"<svg><g font-size="10"><text x="5" y="20" fill="red" transform="rotate(90)">l</text></g></svg>"#;
        let expected = format!(
            r#"<svg><g font-size="10"><path fill="red" transform="rotate(90)" d="{}"/></g></svg>"#,
            outline("l", 5.0, 20.0, 10.0)
        );
        assert_eq!(outlined(svg).unwrap(), expected);
    }

    #[test]
    fn anchors_and_sizes_are_inherited_and_references_resolved() {
        let svg = r#"<svg><g text-anchor="end" font-size="8px"><text x="50">a&lt;&#966;</text></g><text>a</text></svg>"#;
        let text = outlined(svg).unwrap();
        assert!(text.contains(&outline("a<φ", 50.0 - text_width("a<φ", 8.0), 0.0, 8.0)), "{text}");
        assert!(text.contains(&outline("a", 0.0, 0.0, SIZE)), "{text}");
    }

    #[test]
    fn what_is_not_well_formed_is_refused() {
        for wrong in ["<svg><g></svg>", "<svg a=1></svg>", "<svg><text x='1></text>"] {
            // Either here or by the rasteriser.
            assert!(crate::png(wrong, 1.0).is_err(), "{wrong}");
        }
        assert!(outlined(&"<g>".repeat(100_000)).is_err(), "too deep");
    }
}
