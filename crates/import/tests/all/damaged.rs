//! Damaged files: every reader answers with a mechanism or with faults, whatever it gets.

use std::io;
use std::path::Path;

use blocksim_import::{
    Files, Mechanism, Provenance, chain, diagram, meshes, model, parameters, robot, simscape, smidata, stl,
    urdf,
};

use blocksim_scene::mesh;

/// Numbers that look random, the same in every run.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % n.max(1)
    }
}

/// Pieces that hurt where they land.
const PIECES: [&str; 24] = [
    "nan",
    "inf",
    "-1",
    "0",
    "1e308",
    "-1e-320",
    "1,5",
    "\"",
    "'",
    "<",
    ">",
    "/>",
    "&a;",
    "<!DOCTYPE a [",
    "<!--",
    "]]>",
    "</link>",
    "<joint>",
    "\u{0}",
    "\u{ffff}",
    "name=\"\"",
    "fixed",
    "planar",
    "%;",
];

/// One to four changes: cut off, flip a bit, double a piece, take one out, swap two, put in something.
fn damaged(valid: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = valid.to_vec();
    for _ in 0..1 + random.below(4) {
        let at = random.below(bytes.len());
        let to = (at + random.below(80)).min(bytes.len());
        match random.below(7) {
            0 => bytes.truncate(at),
            1 if at < bytes.len() => bytes[at] ^= 1 << random.below(8),
            2 => {
                let piece = bytes[at..to].to_vec();
                let elsewhere = random.below(bytes.len() + 1);
                bytes.splice(elsewhere..elsewhere, piece);
            }
            3 => drop(bytes.drain(at..to)),
            4 => {
                let other = random.below(bytes.len());
                let n = random.below(40).min(bytes.len() - at.max(other));
                (0..n).for_each(|i| bytes.swap(at + i, other + i));
            }
            5 => {
                // A whole line once more: names that stand twice.
                let text = String::from_utf8_lossy(&bytes).into_owned();
                let lines: Vec<&str> = text.lines().collect();
                if !lines.is_empty() {
                    let mut lines = lines.clone();
                    let [from, to] = [random.below(lines.len()), random.below(lines.len())];
                    lines.insert(to, lines[from]);
                    bytes = lines.join("\n").into_bytes();
                }
            }
            _ => {
                let piece = PIECES[random.below(PIECES.len())].bytes();
                bytes.splice(at..(at + random.below(8)).min(bytes.len()), piece);
            }
        }
    }
    bytes
}

fn file(name: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data").join(name);
    std::fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// What follows on a mechanism that could be read must not fail either.
fn use_up(mut mechanism: Mechanism) {
    let nothing = |_: &Path| -> io::Result<Vec<u8>> { Err(io::ErrorKind::NotFound.into()) };
    let _ = meshes(&mut mechanism, Path::new("a"), Some(1000.0), &nothing);
    let _ = model(&mechanism);
    let provenance = Provenance { source: "a".into(), fingerprint: "0".into(), date: "2026-11-21".into() };
    let chain = chain(&mechanism, None).ok();
    let files = Files { source: "a", diagram: "a.ron", parameters: "p.ron", robot: None };
    assert!(parameters(&mechanism, chain.as_ref(), &provenance).ends_with(")\n"));
    assert!(diagram(&mechanism, &files).ends_with(")\n"));
    for chain in chain.iter() {
        assert!(robot(&mechanism, chain, &files).0.ends_with(")\n"));
    }
}

#[test]
fn damaged_robot_descriptions_are_read_or_refused() {
    let mut random = Random(1);
    let (mut read, mut refused) = (0, 0);
    for valid in [file("kinds.urdf"), file("irb2600.urdf")] {
        for _ in 0..2500 {
            match urdf::read(Path::new("a.urdf"), &damaged(&valid, &mut random), false) {
                Ok(mechanism) => {
                    use_up(mechanism);
                    read += 1;
                }
                Err(faults) => {
                    assert!(!faults.is_empty());
                    refused += 1;
                }
            }
        }
    }
    // Damage of both kinds occurs: such that hurts and such that does not.
    assert!(read > 100 && refused > 1000, "{read} read, {refused} refused");
}

#[test]
fn damaged_assemblies_are_read_or_refused() {
    let mut random = Random(2);
    let (mut read, mut refused) = (0, 0);
    let valid = file("crane.xml");
    for _ in 0..3000 {
        match simscape::read(Path::new("a.xml"), &damaged(&valid, &mut random)) {
            Ok(mechanism) => {
                use_up(mechanism);
                read += 1;
            }
            Err(faults) => {
                assert!(!faults.is_empty());
                refused += 1;
            }
        }
    }
    assert!(read > 50 && refused > 500, "{read} read, {refused} refused");
}

#[test]
fn damaged_data_files_are_read_or_refused() {
    let mut random = Random(3);
    let mut valid = String::new();
    for i in 1..4 {
        valid.push_str(&format!(
            "smiData.Solid({i}).mass = {i};  % kg\nsmiData.Solid({i}).CoM = [1 2 3];  % mm\nsmiData.Solid({i}).MoI = [9 8 7];  % kg*mm^2\nsmiData.Solid({i}).PoI = [0 0.5 0];  % kg*mm^2\nsmiData.Solid({i}).ID = 'part {i}';\nsmiData.RigidTransform({i}).translation = [1 0 2];  % mm\nsmiData.RigidTransform({i}).angle = 1;  % rad\nsmiData.RigidTransform({i}).axis = [0 1 0];\n"
        ));
    }
    assert!(smidata::read(Path::new("a.m"), valid.as_bytes()).is_ok());
    for _ in 0..2500 {
        if let Err(faults) = smidata::read(Path::new("a.m"), &damaged(valid.as_bytes(), &mut random)) {
            assert!(!faults.is_empty());
        }
    }
}

#[test]
fn damaged_meshes_are_read_or_refused() {
    let mut random = Random(4);
    let text = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n";
    let mut binary = vec![0; 80];
    binary.extend(3_u32.to_le_bytes());
    binary.extend([63; 150]);
    for valid in [text.as_bytes(), &binary] {
        assert!(stl::read(Path::new("a.stl"), valid).is_ok());
        for _ in 0..2500 {
            let bytes = damaged(valid, &mut random);
            if let Ok(triangles) = stl::read(Path::new("a.stl"), &bytes) {
                let _ = blocksim_import::solid(&triangles, [1e-3; 3]).inertia(1000.0);
            }
            if let Ok(surface) = mesh::read("a.stl", &bytes, [1e-3, -1.0, 1e3]) {
                let packed = mesh::Packed::of(&mesh::simplified(&surface, 1));
                assert!(packed.triangles.len() <= 3 && packed.step.iter().all(|step| step.is_finite()));
            }
        }
    }
}
