//! How long the layout of a large level takes: blocks in chains with branches, feedback, scopes and a network.
//!
//! `cargo bench -p blocksim-layout --bench large`.

use std::hint::black_box;
use std::time::Instant;

use blocksim_layout::{End, Form, Graph, Net, Node, PortKind, Standing, layout, metrics};

/// A level of `n` blocks: chains of ten, each joined to the one before, every fourth block with a scope, every tenth with
/// feedback, and rails of conserving connections.
fn level(n: usize) -> Graph {
    let mut seed = 1_u64;
    let mut random = move |n: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % n
    };
    let mut graph = Graph::default();
    let mut outputs: Vec<Vec<End>> = Vec::new();
    for node in 0..n {
        let sink = node % 4 == 3;
        let mut ports = vec![PortKind::Input; 1 + random(3)];
        if !sink {
            ports.extend([PortKind::Output, PortKind::Free]);
        }
        for (port, kind) in ports.iter().enumerate() {
            let end = End { node, port };
            match kind {
                PortKind::Output => outputs.push(vec![end]),
                PortKind::Input if !outputs.is_empty() => {
                    // Mostly what stands near in the text.
                    let back = 1 + if random(8) == 0 { random(40) } else { random(4) };
                    let from = outputs.len().saturating_sub(back);
                    outputs[from].push(end);
                }
                PortKind::Input | PortKind::Free => {}
            }
        }
        graph.nodes.push(Node {
            width: 50.0,
            height: 36.0,
            label_width: 40.0,
            label_height: 14.0,
            form: Form::Box,
            standing: Standing::Free,
            ports,
        });
    }
    graph.nets.extend(outputs.into_iter().map(|ends| Net { ends, directed: true }));
    let mut pins: Vec<End> = Vec::new();
    for (node, look) in graph.nodes.iter().enumerate() {
        pins.extend(
            look.ports.iter().position(|port| *port == PortKind::Free).map(|port| End { node, port }),
        );
    }
    for ends in pins.chunks(3) {
        graph.nets.push(Net { ends: ends.to_vec(), directed: false });
    }
    graph
}

#[expect(clippy::print_stdout, reason = "a benchmark shows its figures")]
fn main() {
    for n in [50, 100, 200, 500] {
        let graph = level(n);
        let start = Instant::now();
        let drawing = layout(black_box(&graph));
        let took = start.elapsed();
        let found = metrics(&graph, &drawing);
        println!(
            "{n:4} blocks {:9.1} ms, {} crossings, {:.0} x {:.0} dots",
            took.as_secs_f64() * 1e3,
            found.crossings,
            drawing.width,
            drawing.height
        );
        println!("time large/{n} {:.4e} s", took.as_secs_f64());
    }
}
