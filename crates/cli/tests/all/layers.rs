//! Layers over drawings: what a compiled model knows of its wires and blocks.

use serde_json::Value;

use crate::desk::Desk;

/// A sampled loop, with an algebraic loop beside it.
const MODEL: &str = r#"Diagram(
    simulation: (stop_time: "1 s"),
    blocks: {
        "demand": Constant(value: "1 V"),
        "error": Sum(signs: "+-"),
        "law": DiscretePid(ts: "10 ms", kp: 2.0),
        "plant": LowPass(tau: "0.1 s"),
        "half": Gain(k: 0.5),
        "both": Sum(signs: "++"),
        "many": Constant(value: ["1 m", "2 m"]),
        "show": Scope(inputs: ["a", "b", "c"]),
    },
    connections: [
        "demand.y -> error.u1", "error.y -> law.e", "law.u -> plant.u", "plant.y -> error.u2, both.u1, show.a",
        "both.y -> half.u, show.b", "half.y -> both.u2", "many.y -> show.c",
    ],
)"#;

fn wire<'v>(found: &'v Value, title: &str) -> &'v Value {
    let wires = found["wires"].as_array().expect("wires");
    wires.iter().find(|wire| wire["title"].as_str().is_some_and(|text| text.starts_with(title))).expect(title)
}

fn block<'v>(found: &'v Value, name: &str) -> &'v Value {
    let blocks = found["blocks"].as_array().expect("blocks");
    blocks.iter().find(|block| block["name"] == name).expect(name)
}

#[test]
fn units_rates_order_feedback_and_loops_are_those_of_the_schedule() {
    let desk = Desk::with(&[("model.ron", MODEL)]);
    let answer = desk.call(&["graph", "model.ron", "--json", "--layers", "units,rates,order,feedback,loops"]);
    assert_eq!(answer.code, Some(0), "{}", answer.err);
    // A note tells of the loop.
    let line = answer.out.lines().find(|line| line.contains("\"blocks\":")).expect("a level");
    let found: Value = serde_json::from_str(line).expect("JSON");
    assert_eq!(wire(&found, "demand.y")["unit"], "V");
    assert_eq!(wire(&found, "many.y")["unit"], "m [2]");
    assert_eq!(wire(&found, "demand.y")["rate"], "constant");
    assert_eq!(wire(&found, "law.u")["rate"], "10 ms");
    assert_eq!(wire(&found, "plant.y")["rate"], "continuous");
    assert_eq!(
        (&block(&found, "law")["rate"], &block(&found, "plant")["rate"]),
        (&"10 ms".into(), &"continuous".into())
    );
    assert_eq!(wire(&found, "plant.y")["feedback"], true);
    assert_eq!(wire(&found, "error.y")["feedback"], false);
    for name in ["half", "both"] {
        assert_eq!(block(&found, name)["loops"], serde_json::json!([1]), "{name}");
    }
    assert_eq!(block(&found, "plant")["loops"], serde_json::json!([]));
    assert_eq!(
        (&wire(&found, "both.y")["loops"], &wire(&found, "law.u")["loops"]),
        (&serde_json::json!([1]), &serde_json::json!([]))
    );
    // Whoever is read at the same instant comes before.
    let order = |name: &str| block(&found, name)["order"][0].as_u64().expect(name);
    assert!(order("demand") < order("error") && order("plant") < order("error"));
    // As text, and as a drawing in which each layer is.
    let text = desk.call(&["graph", "model.ron", "--layers", "rates,loops"]).out;
    assert!(text.contains("10 ms") && text.contains("loop 1"), "{text}");
    let drawn = desk.call(&[
        "graph",
        "model.ron",
        "--layers",
        "units,rates,order,feedback,loops",
        "--svg",
        "model.svg",
    ]);
    assert_eq!(drawn.code, Some(0), "{}", drawn.err);
    let svg = desk.read("model.svg");
    for layer in ["units", "rates", "order", "feedback", "loops"] {
        assert!(svg.contains(&format!("layer-{layer}")), "{layer}");
    }
    assert!(svg.contains("class=\"halo pace-0\"") && svg.contains(">10 ms<"), "{svg}");
    // Without layers the drawing is as ever.
    desk.call(&["graph", "model.ron", "--svg", "plain.svg"]);
    assert!(!desk.read("plain.svg").contains("layer"));
}

#[test]
fn a_model_with_errors_has_feedback_alone() {
    let desk = Desk::with(&[("model.ron", &MODEL.replace("law.e", "law.q"))]);
    let feedback = desk.call(&["graph", "model.ron", "--json", "--layers", "feedback"]);
    assert_eq!(feedback.code, Some(3), "{}", feedback.err);
    assert!(
        feedback.out.contains("\"feedback\":true") || feedback.out.contains("\"feedback\":false"),
        "{}",
        feedback.out
    );
    let order = desk.call(&["graph", "model.ron", "--layers", "order"]);
    assert_eq!(order.code, Some(3), "{}", order.err);
    assert!(order.err.contains("has no input `q`"), "{}", order.err);
}
