//! Graphs of any form keep the promises, not only those of diagrams that ship.

use blocksim_layout::{End, Form, Graph, Net, Node, PortKind, Standing, layout, metrics};

#[test]
fn graphs_made_at_random_are_drawn_without_faults() {
    let mut seed = 7_u64;
    let mut random = move |n: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % n
    };
    for round in 0..150 {
        let n = 2 + random(14);
        let mut graph = Graph::default();
        for _ in 0..n {
            let form = match random(7) {
                6 => Form::Bar,
                0 => Form::Circle,
                1 => Form::Hanging,
                _ => Form::Box,
            };
            let ports = match form {
                Form::Circle => vec![PortKind::Input, PortKind::Input, PortKind::Output],
                Form::Hanging => vec![PortKind::Free],
                Form::Box | Form::Bar => (0..1 + random(5))
                    .map(|_| [PortKind::Input, PortKind::Output, PortKind::Free][random(3)])
                    .collect(),
            };
            let standing = [Standing::Free, Standing::Free, Standing::First, Standing::Last][random(4)];
            let (width, height) = if form == Form::Box { (50.0, 36.0) } else { (26.0, 26.0) };
            graph.nodes.push(Node {
                width,
                height,
                label_width: random(70) as f64,
                label_height: 14.0,
                form,
                standing,
                ports,
            });
        }
        let ports_of = |kind: PortKind| -> Vec<End> {
            let nodes = graph.nodes.iter().enumerate();
            nodes
                .flat_map(|(node, about)| (0..about.ports.len()).map(move |port| End { node, port }))
                .filter(|end| graph.nodes[end.node].ports[end.port] == kind)
                .collect()
        };
        let (outputs, free) = (ports_of(PortKind::Output), ports_of(PortKind::Free));
        let mut nets: Vec<Net> =
            outputs.iter().map(|output| Net { ends: vec![*output], directed: true }).collect();
        for input in ports_of(PortKind::Input) {
            if !nets.is_empty() {
                let net = random(nets.len());
                nets[net].ends.push(input);
            }
        }
        let mut groups = vec![Net { ends: Vec::new(), directed: false }; 1 + free.len() / 3];
        for end in free {
            let group = random(groups.len());
            groups[group].ends.push(end);
        }
        nets.extend(groups);
        graph.nets = nets;
        let found = metrics(&graph, &layout(&graph));
        let faults = [found.overlaps, found.through, found.shared, found.loose];
        assert_eq!(faults, [0; 4], "round {round}: {found:?}\n{graph:#?}");
    }
}
