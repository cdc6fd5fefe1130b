//! Files of kinds that the project has none of, written into the folder of a worker.

use std::fs;
use std::io;
use std::path::Path;

/// Texts by their places.
const TEXTS: [(&str, &str); 9] = [
    ("names.txt", "angle.set=angle.set[rad]\nangle.actual=angle.actual[rad]\n"),
    (
        "crane_DataFile.m",
        "% a comment\nsmiData.RigidTransform(1).translation = [0 0 0.25];  % m\nsmiData.RigidTransform(1).angle = 0.5;  % rad\n\
         smiData.RigidTransform(1).axis = [0 0 1];\nsmiData.RigidTransform(1).ID = 'B[a:1:-:b:1]';\n\
         smiData.Solid(1).mass = 950;  % g\nsmiData.Solid(1).CoM = [0 5 -20];  % mm\n\
         smiData.Solid(1).MoI = [5e5 6e5 7e5];  % g*mm^2\nsmiData.Solid(1).PoI = [1e4 2e4 -3e4];  % g*mm^2\n\
         smiData.Solid(1).ID = 'trolley';\nsmiData.Solid(2).mass = 1;  % kg\nsmiData.Solid(2).CoM = [0 0 0];  % mm\n\
         smiData.Solid(2).MoI = [1 1 1];  % kg*mm^2\nsmiData.Solid(2).PoI = [0 0 0];  % kg*mm^2\n\
         smiData.Solid(2).ID = 'ballast';\n",
    ),
    ("rods.urdf", RODS),
    ("rod.stl", ROD),
    ("settings/plugin.toml", SETTINGS),
    ("settings/include/none.h", "/* nothing */\n"),
    ("boxed.ron", BOXED),
    ("strange/model.ron", STRANGE),
    ("session.jsonl", SESSION),
];

/// A rod that a mesh shows.
const RODS: &str = r#"<robot name="rods">
  <link name="stand"/>
  <joint name="hinge" type="revolute">
    <origin xyz="0 0 1"/><parent link="stand"/><child link="rod"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" velocity="2" effort="50"/>
  </joint>
  <link name="rod">
    <inertial>
      <origin xyz="0 0 0.3"/><mass value="2"/>
      <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.01"/>
    </inertial>
    <visual><geometry><mesh filename="rod.stl" scale="0.001 0.001 0.001"/></geometry></visual>
  </link>
</robot>
"#;

/// A tetrahedron as text, mm.
const ROD: &str = "solid rod
facet normal 0 0 -1
outer loop
vertex 0 0 0
vertex 0 200 0
vertex 200 0 0
endloop
endfacet
facet normal 0 -1 0
outer loop
vertex 0 0 0
vertex 200 0 0
vertex 0 0 900
endloop
endfacet
facet normal -1 0 0
outer loop
vertex 0 0 0
vertex 0 0 900
vertex 0 200 0
endloop
endfacet
facet normal 1 1 0.2
outer loop
vertex 200 0 0
vertex 0 200 0
vertex 0 0 900
endloop
endfacet
endsolid rod
";

/// Settings of a controller whose sources lie elsewhere.
const SETTINGS: &str = r#"# how it is built
name = "settings" # of the library
sources = [
    "../law/controller.c", # of the template
]
include = ["include"]
flags = ["-DGAIN=2"]
libraries = ["m"]
"#;

/// A diagram with a controller that is a module.
const BOXED: &str = r#"Diagram(
    simulation: (stop_time: "1 s"),
    blocks: {
        "demand": Step(time: "0.3 s", after: 1.0),
        "law": Plugin(library: "law.wasm", block: "Gain"),
        "seen": Scope(inputs: ["y"]),
    },
    connections: ["demand.y -> law.u", "law.y -> seen.y"],
)
"#;

/// A diagram with a library.
const STRANGE: &str = r#"Diagram(
    simulation: (stop_time: "1 s"),
    blocks: {
        "demand": Step(time: "0.3 s", after: 1.0),
        "law": Plugin(library: "../plugins/libpid.so", block: "Pid", parameters: { "kp": 2.0, "ts": "10 ms" }),
        "seen": Scope(inputs: ["y"]),
    },
    connections: ["demand.y -> law.e", "law.u -> seen.y"],
)
"#;

/// A gain as a module, in the text format: y = 2 u, sampled each 0.1 s.
const MODULE: &str = r#"(module
    (memory (export "memory") 1)
    (table (export "__indirect_function_table") 3 funcref)
    (elem (i32.const 1) $sample_time $outputs)
    (func (export "blocksim_plugin_v1") (result i32) i32.const 1024)
    (func $sample_time (param i32 i32 i32) (result i32) local.get 1 f64.const 0.1 f64.store i32.const 0)
    (func $outputs (param i32 f64 i32 i32 i32 i32 i32) (result i32)
        local.get 5 local.get 4 f64.load f64.const 2 f64.mul f64.store i32.const 0)
    (data (i32.const 1024) (i32 44) (i16 1 0) "BLKSIMP1" (i32 1400 5 0 0 1072 1 0))
    (data (i32.const 1072) (i32 84 0 1 1 0 0 1408 4 1416 11 0 1208 1256 0 0 0 1 0 2 0 0))
    (data (i32.const 1208) (i32 48 1 1432 1 0 0 0 0 0 0 0 0))
    (data (i32.const 1256) (i32 48 1 1433 1 0 0 0 0 0 0 1 0))
    (data (i32.const 1400) "boxed")
    (data (i32.const 1408) "Gain")
    (data (i32.const 1416) "y = 2 times")
    (data (i32.const 1432) "uy"))"#;

/// What an editor sends, a message a line.
const SESSION: &str = r#"{"jsonrpc":"2.0","id":1,"method":"initialize","params":{"capabilities":{"textDocument":{"completion":{"completionItem":{"snippetSupport":true}}}}}}
{"jsonrpc":"2.0","method":"initialized","params":{}}
{"jsonrpc":"2.0","method":"textDocument/didOpen","params":{"textDocument":{"uri":"file:///tmp/mutant/a.ron","languageId":"ron","version":1,"text":"Diagram(\n    simulation: (stop_time: \"1 s\"),\n    parameters: { \"tau\": \"0.1 s\" },\n    blocks: {\n        \"demand\": Step(time: \"0.3 s\", after: 1.0),\n        \"lag\": LowPass(tau: \"tau\"),\n        \"seen\": Scope(inputs: [\"y\"]),\n    },\n    connections: [\"demand.y -> lag.u\", \"lag.y -> seen.y\"],\n)\n"}}}
{"jsonrpc":"2.0","method":"textDocument/didChange","params":{"textDocument":{"uri":"file:///tmp/mutant/a.ron","version":2},"contentChanges":[{"range":{"start":{"line":5,"character":15},"end":{"line":5,"character":22}},"text":"LowPäss"}]}}
{"jsonrpc":"2.0","id":2,"method":"textDocument/hover","params":{"textDocument":{"uri":"file:///tmp/mutant/a.ron"},"position":{"line":4,"character":20}}}
{"jsonrpc":"2.0","id":3,"method":"textDocument/completion","params":{"textDocument":{"uri":"file:///tmp/mutant/a.ron"},"position":{"line":5,"character":24}}}
{"jsonrpc":"2.0","id":4,"method":"textDocument/definition","params":{"textDocument":{"uri":"file:///tmp/mutant/a.ron"},"position":{"line":8,"character":22}}}
{"jsonrpc":"2.0","id":5,"method":"textDocument/references","params":{"textDocument":{"uri":"file:///tmp/mutant/a.ron"},"position":{"line":8,"character":22},"context":{"includeDeclaration":true}}}
{"jsonrpc":"2.0","id":6,"method":"textDocument/rename","params":{"textDocument":{"uri":"file:///tmp/mutant/a.ron"},"position":{"line":5,"character":11},"newName":"slow"}}
{"jsonrpc":"2.0","id":7,"method":"textDocument/formatting","params":{"textDocument":{"uri":"file:///tmp/mutant/a.ron"},"options":{"tabSize":4,"insertSpaces":true}}}
{"jsonrpc":"2.0","id":8,"method":"textDocument/documentSymbol","params":{"textDocument":{"uri":"file:///tmp/mutant/a.ron"}}}
{"jsonrpc":"2.0","id":9,"method":"textDocument/codeAction","params":{"textDocument":{"uri":"file:///tmp/mutant/a.ron"},"range":{"start":{"line":0,"character":0},"end":{"line":9,"character":0}},"context":{"diagnostics":[]}}}
{"jsonrpc":"2.0","method":"textDocument/didClose","params":{"textDocument":{"uri":"file:///tmp/mutant/a.ron"}}}
{"jsonrpc":"2.0","id":10,"method":"shutdown","params":null}
{"jsonrpc":"2.0","method":"exit","params":null}
"#;

/// Writes all of them below a folder.
///
/// # Errors
/// A file that cannot be written.
pub(super) fn write(folder: &Path) -> io::Result<()> {
    for (name, text) in TEXTS {
        let place = folder.join(name);
        fs::create_dir_all(place.parent().unwrap_or(folder))?;
        fs::write(place, text)?;
    }
    fs::write(folder.join("session.txt"), framed(SESSION.as_bytes()))?;
    fs::write(folder.join("block.stl"), block())?;
    // Mass and inertia of these are those of their meshes.
    let (head, rest) = RODS.split_once("    <inertial>").unwrap_or((RODS, ""));
    let tail = rest.split_once("</inertial>\n").map_or("", |(_, tail)| tail);
    let weightless = [head, tail].concat();
    fs::write(folder.join("weightless.urdf"), &weightless)?;
    fs::write(folder.join("block.urdf"), weightless.replace("rod.stl", "block.stl"))?;
    fs::write(folder.join("law.wasm"), wat::parse_str(MODULE).map_err(io::Error::other)?)
}

/// Lines as messages of the Language Server Protocol, each with its length before it.
pub(super) fn framed(lines: &[u8]) -> Vec<u8> {
    let mut all = Vec::new();
    for line in lines.split(|byte| *byte == b'\n').filter(|line| !line.is_empty()) {
        all.extend(format!("Content-Length: {}\r\n\r\n", line.len()).bytes());
        all.extend(line);
    }
    all
}

/// A box of twelve triangles as a binary file, mm.
fn block() -> Vec<u8> {
    let corner = |n: usize| [0, 1, 2].map(|axis| if n >> axis & 1 == 1 { 80.0_f32 } else { -80.0 });
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles: Vec<[usize; 3]> =
        faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    let mut bytes = b"a block".to_vec();
    bytes.resize(80, b' ');
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for triangle in triangles {
        let numbers = [0.0; 3].into_iter().chain(triangle.into_iter().flat_map(corner));
        bytes.extend(numbers.flat_map(f32::to_le_bytes));
        bytes.extend([0, 0]);
    }
    bytes
}
