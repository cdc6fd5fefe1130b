/// One level of a diagram.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Graph {
    /// Blocks, in the order of the file: a wire to an earlier block that closes a loop is feedback.
    pub nodes: Vec<Node>,
    /// Connections; each port belongs to one net at most.
    pub nets: Vec<Net>,
}

/// A block.
#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    /// Least width of the box.
    pub width: f64,
    /// Least height of the box; ports may need more.
    pub height: f64,
    /// Width of the name beside the box.
    pub label_width: f64,
    /// Height of the name below the box, or above it where something leaves below.
    pub label_height: f64,
    /// What it looks like.
    pub form: Form,
    /// Where it stands.
    pub standing: Standing,
    /// Ports from top to bottom.
    pub ports: Vec<PortKind>,
}

impl Node {
    /// Whether signals only begin here.
    pub(crate) fn is_source(&self) -> bool {
        self.ports.iter().all(|port| *port == PortKind::Output)
    }

    /// Whether signals only end here, as in a scope. Such a block stands where there is room and moves nothing else.
    pub(crate) fn is_sink(&self) -> bool {
        self.standing == Standing::Free
            && !self.ports.is_empty()
            && self.ports.iter().all(|port| *port == PortKind::Input)
    }
}

/// What a block looks like, as far as ports depend on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Form {
    /// Inputs left, outputs right.
    Box,
    /// The same, thin: its ends are close to its ports.
    Bar,
    /// A circle: feedback enters from below, a second input from above.
    Circle,
    /// Hangs from a wire by its only port, such as ground.
    Hanging,
}

/// Where a block stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// Where its connections want it.
    Free,
    /// In the leftmost layer.
    First,
    /// In the rightmost layer.
    Last,
}

/// Which way a port is used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PortKind {
    /// A signal enters.
    Input,
    /// A signal leaves.
    Output,
    /// Conserving: may sit on either side.
    Free,
}

/// Ports joined by a wire.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Net {
    /// The ports; the output comes first.
    pub ends: Vec<End>,
    /// A signal, from the first end to the others; otherwise a conserving connection.
    pub directed: bool,
}

/// A port of a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct End {
    /// Index of the node.
    pub node: usize,
    /// Index of the port.
    pub port: usize,
}

/// A side of a box.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Left.
    West,
    /// Right.
    East,
    /// Above.
    North,
    /// Below.
    South,
}

/// A place in the drawing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Point {
    /// To the right.
    pub x: f64,
    /// Down.
    pub y: f64,
}

/// A level with all places known. The corner at the top left is (0, 0).
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Layout {
    /// Width of the whole.
    pub width: f64,
    /// Height of the whole.
    pub height: f64,
    /// The nodes of the graph.
    pub nodes: Vec<Placed>,
    /// The nets of the graph.
    pub wires: Vec<Wire>,
}

/// A node with its place.
#[derive(Debug, Clone, PartialEq)]
pub struct Placed {
    /// Left edge of the box.
    pub x: f64,
    /// Upper edge of the box.
    pub y: f64,
    /// Width of the box.
    pub width: f64,
    /// Height of the box.
    pub height: f64,
    /// Inputs are right and outputs left.
    pub mirrored: bool,
    /// The name stands above the box.
    pub label_above: bool,
    /// The ports of the node.
    pub ports: Vec<PlacedPort>,
}

/// A port with its place on the edge of the box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlacedPort {
    /// The place.
    pub at: Point,
    /// The edge.
    pub side: Side,
}

/// A net with its lines.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Wire {
    /// Lines along the axes, none of which overlap.
    pub segments: Vec<Segment>,
    /// Where the wire branches.
    pub junctions: Vec<Point>,
}

/// A line along an axis, from left to right or from top to bottom.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Start.
    pub from: Point,
    /// End.
    pub to: Point,
}
