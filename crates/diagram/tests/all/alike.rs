//! Blocks that are written alike.

use std::path::Path;
use std::sync::Arc;

use blocksim_block::schedule::{Instance, Schedule};
use blocksim_diagram::{Reader, Sources, compile};

/// One text, whatever it is called.
struct Text(String);

impl Reader for Text {
    fn read(&self, _: &Path) -> Result<String, String> {
        Ok(self.0.clone())
    }
}

fn scheduled(blocks: &str, connections: &str) -> Schedule {
    let simulation = r#"(stop_time: "1 s", solver: Ode4(step: "1 ms"))"#;
    let text = format!(
        "Diagram(simulation: {simulation}, blocks: {{ {blocks} }}, connections: [{connections}], parameters: {{\"k\": \"3 V\"}})"
    );
    let reader = Text(text);
    let sources = Sources::new(&reader);
    let compiled = compile(&sources, Path::new("model.ron"), &[]);
    let problems: Vec<&str> = compiled.problems.iter().map(|problem| problem.message.as_str()).collect();
    assert_eq!(problems, Vec::<&str>::new());
    compiled.schedule.expect("a schedule")
}

fn block<'s>(schedule: &'s Schedule, path: &str) -> &'s Instance {
    schedule.blocks.iter().find(|block| block.path == path).expect("a block")
}

#[test]
fn blocks_that_are_written_alike_are_one_unless_their_place_makes_a_difference() {
    let blocks = r#"
        "one": Constant(value: "1 A"), "g1": Gain(k: "k"), "g2": Gain(k: "k"), "g3": Gain(k: "k"), "g4": Gain(k: "k", label: "last"),
        "other": Gain(k: "4 V"), "n1": Noise(std: 1, ts: 1), "n2": Noise(std: 1, ts: 1), "n3": Noise(std: 1, ts: 1),
        "n4": Noise(std: 1, ts: 1)"#;
    let schedule = scheduled(blocks, r#""one.y -> g1.u, g2.u, g3.u, other.u", "n1.y -> g4.u""#);
    let are_one = |a: &str, b: &str| Arc::ptr_eq(&block(&schedule, a).block, &block(&schedule, b).block);
    assert!(are_one("g1", "g2") && are_one("g2", "g3") && are_one("g2", "g4"));
    assert!(!are_one("g2", "other"));
    for (a, b) in [("n1", "n2"), ("n2", "n3"), ("n3", "n4"), ("n2", "n4")] {
        assert!(!are_one(a, b), "{a} and {b}");
    }
    // They are in different surroundings all the same.
    let unit = |path: &str| {
        let dimension = block(&schedule, path).interface.outputs[0].port_type.dimension;
        dimension.map(|dimension| dimension.to_string())
    };
    assert_eq!(unit("g2"), unit("g3"));
    assert_ne!(unit("g3"), unit("g4"));
    let law = |path: &str| block(&schedule, path).law.as_ref().expect("a law");
    assert!(Arc::ptr_eq(law("g2"), law("g3")));
    assert_ne!(law("g2").program.instructions, law("other").program.instructions);
}
