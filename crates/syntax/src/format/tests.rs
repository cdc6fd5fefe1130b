//! The layout against texts that are laid out by hand.

use super::format;

/// Formats, and formats what came out once more.
#[track_caller]
fn formatted(text: &str) -> String {
    let once = format(text).expect("RON");
    assert_eq!(format(&once).expect("RON"), once, "the second time changes nothing");
    once
}

#[test]
fn blanks_commas_and_indentation_follow_the_rules() {
    let text = "Diagram(title:\"T\",\n  blocks:{\"a\":Gain( k:2 ),\"b\" : Clock ,},\nlist : [ 1,2 ,3, ], empty: { }, pair: ( ),\n)";
    let expected = "\
Diagram(
    title: \"T\",
    blocks: { \"a\": Gain(k: 2), \"b\": Clock },
    list: [1, 2, 3], empty: {}, pair: (),
)
";
    assert_eq!(formatted(text), expected);
}

#[test]
fn lines_are_ended_where_the_author_ended_them() {
    let text = "\
Diagram(
    blocks: {
        \"a\": Variant(choice: \"c\", of: {
            \"x\": Gain(k: 2), \"y\": Clock,
            \"z\": Clock,
        }),

        \"b\": Table(rows: [
            [1, 2],
            [3, 4],
        ]),
    },
)
";
    assert_eq!(formatted(text), text);
}

#[test]
fn what_has_a_name_and_spans_lines_begins_one() {
    let text = "Diagram(\ntitle: \"T\", blocks: {\"a\": Clock, \"b\": Gain(\nk: 2)})";
    let expected = "\
Diagram(
    title: \"T\",
    blocks: {
        \"a\": Clock,
        \"b\": Gain(
            k: 2,
        ),
    },
)
";
    assert_eq!(formatted(text), expected);
}

#[test]
fn every_comment_keeps_its_text_and_its_place() {
    let text = "\
// above

/* a block
   of lines */
Diagram( // behind a bracket
  title: \"T // none\",   // of the title
  // of the blocks


  blocks: { \"a\" /* name */ : Gain(k: /* gain */ 2), /* b is next */
     /* before b */ \"b\": Clock /* after */, \"c\": Clock // no comma
     // the last
  }
  // the end
)
// below
";
    let expected = "\
// above

/* a block
   of lines */
Diagram(
    // behind a bracket
    title: \"T // none\",   // of the title
    // of the blocks

    blocks: {
        \"a\": /* name */ Gain(k: /* gain */ 2), /* b is next */
        /* before b */ \"b\": Clock /* after */, \"c\": Clock, // no comma
        // the last
    },
    // the end
)
// below
";
    assert_eq!(formatted(text), expected);
}

#[test]
fn comments_that_stand_in_a_column_stay_there_while_there_is_room() {
    let text =
        "(\n  a: 1,      // one\n  bc: 22, // two\n  d: \"long enough\",  // three\n  e: 1,// four\n)\n";
    let expected = "\
(
    a: 1,      // one
    bc: 22, // two
    d: \"long enough\",  // three
    e: 1, // four
)
";
    assert_eq!(formatted(text), expected);
}

#[test]
fn a_line_that_is_too_long_is_broken_at_its_outermost_bracket() {
    let item = "\"gear\": CycloidalDrive(disc_teeth: 50, ring_teeth: 51, direction: Same, efficiency_forward: 0.75, efficiency_backward: 0.70)";
    let expected = "\
{
    \"gear\": CycloidalDrive(
        disc_teeth: 50, ring_teeth: 51, direction: Same, efficiency_forward: 0.75, efficiency_backward: 0.70,
    ),
}
";
    assert_eq!(formatted(&format!("{{\n{item}\n}}")), expected);
    let listed = formatted(&format!("{{{item}, {}}}", item.replace("gear", "other")));
    assert!(listed.lines().all(|line| line.len() <= 120) && listed.lines().count() == 8, "{listed}");
}

#[test]
fn long_rows_of_numbers_fill_their_lines() {
    let row: Vec<String> = (0..100).map(|n| n.to_string()).collect();
    let text = formatted(&format!("[{}]", row.join(",")));
    assert_eq!(text.lines().count(), 6);
    assert!(text.lines().all(|line| line.len() <= 120));
    let set = format!("(a: [{0}], b: [{0}], c: [{0}])", ["1.5"; 9].join(", "));
    assert_eq!(formatted(&set).lines().count(), 4, "two sets on a line, one on the next");
    let connections = formatted(&format!("[{}]", ["\"a.y -> b.u\""; 20].join(", ")));
    assert_eq!(connections.lines().count(), 22, "each has a line of its own");
    // Three texts on each line are too many; two on each is better than two, one, two, one.
    let word = format!("\"{}\"", "x".repeat(40));
    let line = format!("    {word}, {word}, {word},\n");
    let text = formatted(&format!("[\n{line}{line}]"));
    assert!(text.lines().skip(1).take(3).all(|line| line.matches('x').count() == 80), "{text}");
}

#[test]
fn texts_and_characters_may_hold_anything() {
    let text = "(a: \"\\\" // [\", b: r#\"raw \" /* \"#, c: '\"', d: '\\'', e: ',', f: [r\"x\", \"ü\"])\n";
    assert_eq!(formatted(text), text);
    let lines = "(\n    a: \"one\n  two\", b: 1,\n)\n";
    assert_eq!(formatted(lines), "(\n    a: \"one\n  two\",\n    b: 1,\n)\n");
}

#[test]
fn ends_of_lines_stay_those_of_the_file() {
    assert_eq!(formatted("(\r\n  a: 1, // one\r\n)\r\n"), "(\r\n    a: 1, // one\r\n)\r\n");
}

#[test]
fn text_that_is_no_ron_is_refused_with_its_place() {
    let error = format("Diagram(\n  title: \"x\"\n  blocks: {},\n)").expect_err("a comma is missing");
    assert!(error.span.start >= 20, "{error:?}");
    assert!(format("").is_err() && format("// nothing").is_err());
}

#[test]
fn attributes_stay_on_lines_of_their_own() {
    assert_eq!(
        formatted("#![enable(implicit_some)] // why\n(a:1)"),
        "#![enable(implicit_some)]\n// why\n(a: 1)\n"
    );
}

/// What is behind its comma does not make an item wider or narrower: it goes to the next line where it does not fit.
#[test]
fn an_item_with_a_comment_begins_a_line_where_it_does_not_fit() {
    let text = "\
Diagram(
    blocks: {
        \"motor\": DcMotor(r: \"0.6 ohm\", l: \"0.8 mH\", k: \"0.06 N*m/A\", j: \"3e-5 kg*m^2\"), \"shaft\":
         Inertia(j: \"2e-5 kg*m^2\"), // coupling and screw
    },
)";
    let expected = "\
Diagram(
    blocks: {
        \"motor\": DcMotor(r: \"0.6 ohm\", l: \"0.8 mH\", k: \"0.06 N*m/A\", j: \"3e-5 kg*m^2\"),
        \"shaft\": Inertia(j: \"2e-5 kg*m^2\"), // coupling and screw
    },
)
";
    assert_eq!(formatted(text), expected);
}
