//! Text becomes a tree with places, or an error at the most likely mistake.

use crate::error::SyntaxError;
use crate::mistakes;
use crate::parse::parse;
use crate::tree::Node;

/// Reads a text: values of any kind, each with its place.
///
/// # Errors
/// The first place that is not RON.
pub fn read(text: &str) -> Result<Node, SyntaxError> {
    parse(text).map_err(|error| mistakes::explained(text, error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Shape;

    const TEXT: &str = r#"
// a diagram
Diagram(
    title: "T /* no comment */", // a title
    blocks: {
        "a": Gain(k: 2), /* b is next */
        "b": Clock,
        "c": Step(), "d": Sum(signs: ["+", "-"]),
    },
    empty: (), pair: (1, -2.5e3), flag: true,
)
"#;

    #[test]
    fn every_value_and_every_name_knows_its_place() {
        let root = read(TEXT).unwrap();
        assert_eq!(root.word(), Some("Diagram"));
        let members = root.members().unwrap();
        let names: Vec<_> = members.iter().map(|(name, _)| &TEXT[name.span.clone()]).collect();
        assert_eq!(names, ["title", "blocks", "empty", "pair", "flag"]);
        let blocks = members[1].1.members().unwrap();
        let texts: Vec<_> =
            blocks.iter().map(|(name, node)| (&TEXT[name.span.clone()], &TEXT[node.span.clone()])).collect();
        assert_eq!(
            texts,
            [
                ("\"a\"", "Gain(k: 2)"),
                ("\"b\"", "Clock"),
                ("\"c\"", "Step()"),
                ("\"d\"", "Sum(signs: [\"+\", \"-\"])")
            ]
        );
        assert_eq!(members[0].1.value, Shape::Text("T /* no comment */".to_owned()));
    }

    #[test]
    fn a_decimal_comma_is_recognised() {
        let error = read("Diagram(\n  blocks: {\n    \"pid\": Pid(kp: 1,05, ki: 2.0),\n  },\n)").unwrap_err();
        assert_eq!(error.message, "`1,05` is not a number");
        assert_eq!(error.help.as_deref(), Some("decimal comma? write 1.05"));
        // Thousands are as likely there, so nothing is written.
        let error = read("Diagram(\n  blocks: {\n    \"n\": Constant(value: 10,000),\n  },\n)").unwrap_err();
        assert_eq!(error.help.as_deref(), Some("write 10.000 or 10000, whichever is meant"));
        assert!(error.remedy.is_none());
    }

    #[test]
    fn a_missing_comma_is_found_where_it_belongs() {
        let text = "(\n  a: \"x\" // the first\n  b: [1 2],\n)";
        let error = read(text).unwrap_err();
        assert_eq!(
            (error.message.as_str(), &text[error.span.start..][..1]),
            ("a comma is missing before this", "b")
        );
        let remedy = error.remedy.expect("a comma");
        assert_eq!((remedy.span, remedy.new.as_str()), (10..10, ","));
        let error = read(&text.replace("\"x\"", "\"x\",")).unwrap_err();
        assert_eq!(error.remedy.map(|remedy| remedy.span), Some(32..32));
        for other in ["(a: 1", "[1, 2)", "(a: )", "(a: 1, b)"] {
            assert_eq!(read(other).unwrap_err().remedy, None, "{other}");
        }
    }

    #[test]
    fn repeated_names_are_kept_for_a_better_message() {
        assert_eq!(read("{\"a\": 1, \"a\": 2}").unwrap().members().unwrap().len(), 2);
    }

    #[test]
    fn text_that_is_no_ron_is_refused_with_a_place() {
        let error = read("Diagram(\n  title: \"x\"\n  blocks: {},\n)").unwrap_err();
        assert!(error.span.start >= 20, "{error:?}");
    }

    #[test]
    fn deeply_nested_brackets_are_refused_without_taking_the_stack() {
        for (open, close) in
            [("[", "]"), ("(", ")"), ("{\"a\": ", "}"), ("A(a: ", ")"), ("A(", ")"), ("/*", "*/")]
        {
            let text = format!("{}1{}", open.repeat(10_000), close.repeat(10_000));
            assert!(read(&text).is_err(), "{open}");
            assert!(read(&open.repeat(10_000)).is_err(), "{open}");
        }
    }

    #[test]
    fn what_a_person_writes_is_not_too_deep() {
        let text = format!("{}1{}", "[".repeat(60), "]".repeat(60));
        assert!(read(&text).is_ok());
    }

    #[test]
    fn a_list_of_a_hundred_thousand_numbers_is_read() {
        let node = read(&format!("[{}]", "1.5, ".repeat(100_000))).expect("RON");
        assert!(matches!(node.value, Shape::List(items) if items.len() == 100_000));
    }
}
