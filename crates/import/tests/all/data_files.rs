//! An assembly with its data file: structure from the one, numbers from the other, and a word wherever they differ.

use std::path::Path;

use blocksim_import::simscape::{self, DataFile};
use blocksim_import::{Mechanism, Motion, Start, smidata};

/// The hinge of the crane's boom as a data file has it: z along -y, where the constraints leave y.
const HINGE: &str = "smiData.RigidTransform(1).translation = [0 50 10];  % mm
smiData.RigidTransform(1).angle = 90;  % deg
smiData.RigidTransform(1).axis = [1 0 0];
smiData.RigidTransform(1).ID = 'B[cover-1:-:boom-1]';
smiData.RigidTransform(2).translation = [0 0 0];  % mm
smiData.RigidTransform(2).angle = 180;  % deg
smiData.RigidTransform(2).axis = [1 0 0];
smiData.RigidTransform(2).ID = 'F[cover-1:-:boom-1]';
smiData.RigidTransform(3).translation = [0 0 0];  % mm
smiData.RigidTransform(3).angle = 0;  % deg
smiData.RigidTransform(3).axis = [0 0 1];
smiData.RigidTransform(3).ID = 'RootGround[base-1]';
smiData.RigidTransform(4).translation = [30 0 200];  % mm
smiData.RigidTransform(4).angle = 0;  % deg
smiData.RigidTransform(4).axis = [0 0 1];
smiData.RigidTransform(4).ID = 'B[base-1:-:cover-1]';
smiData.RigidTransform(5).translation = [30 0 0];  % mm
smiData.RigidTransform(5).angle = 0;  % deg
smiData.RigidTransform(5).axis = [0 0 1];
smiData.RigidTransform(5).ID = 'F[base-1:-:cover-1]';
smiData.RevoluteJoint(1).Rz.Pos = 0.0;  % deg
smiData.RevoluteJoint(1).ID = '[cover-1:-:boom-1]';
";

fn crane(data: &str) -> Mechanism {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data/crane.xml");
    let bytes = std::fs::read(&file).expect("a file of the tests");
    let data =
        smidata::read(Path::new("crane.m"), data.as_bytes()).unwrap_or_else(|faults| panic!("{}", faults[0]));
    let data = DataFile { file: Path::new("crane.m"), data: &data };
    simscape::read_with(&file, &bytes, Some(data)).unwrap_or_else(|faults| panic!("{}", faults[0]))
}

#[test]
fn frames_and_start_of_a_joint_are_those_of_the_data_file() {
    let mechanism = crane(HINGE);
    let silent =
        ["the data file has no `base`, `boom`, `cover` and 2 others: the masses of the assembly count"];
    assert_eq!(mechanism.notes, silent);
    let hinge = mechanism.joints.iter().find(|joint| joint.name == "world_to_boom_1").expect("the hinge");
    assert!(matches!(hinge.motion, Motion::Revolute { .. }));
    assert_eq!(hinge.in_base.rotation.column(2).as_slice(), [0.0, -1.0, 0.0]);
    assert!((hinge.in_base.translation - nalgebra::Vector3::new(0.0, 0.05, 0.21)).norm() < 1e-12);
    assert_eq!(hinge.start, Start::Position(0.0));
    // What hangs together is that of the assembly alone.
    let alone = crane(
        "smiData.Solid(1).ID = '';\nsmiData.Solid(1).mass = 0;\nsmiData.Solid(1).CoM = [0 0 0];\nsmiData.Solid(1).MoI = [0 0 0];\nsmiData.Solid(1).PoI = [0 0 0];\n",
    );
    let names = |mechanism: &Mechanism| -> Vec<(String, Option<usize>, usize)> {
        mechanism.joints.iter().map(|joint| (joint.name.clone(), joint.base, joint.follower)).collect()
    };
    assert_eq!(names(&alone), names(&mechanism));
}

#[test]
fn what_differs_from_the_assembly_is_told_with_its_line() {
    for (from, to, told) in [
        (
            "[0 50 10];  % mm",
            "[2 50 10];  % mm",
            "crane.m:1: the axis of `cover-1:-:boom-1` is 2.000 mm from where the constraints of the assembly put it; the data file counts",
        ),
        // Along the axis is where the joint may be anyway.
        ("[0 50 10];  % mm", "[0 70 10];  % mm", ""),
        (
            "Rz.Pos = 0.0",
            "Rz.Pos = 20.0",
            "`world_to_boom_1` starts at 0.349066 by the data file and was drawn at 0.000000; the data file counts",
        ),
        (
            "RevoluteJoint(1)",
            "CylindricalJoint(1)",
            "crane.m:1: `cover-1:-:boom-1` is a CylindricalJoint, by the assembly a RevoluteJoint, which counts",
        ),
        (
            "translation = [0 0 0];  % mm\nsmiData.RigidTransform(3).angle = 0;",
            "translation = [0 0 3];  % mm\nsmiData.RigidTransform(3).angle = 90;",
            "crane.m:9: `base-1` stands 3.000 mm and 90.0000 deg from its place in the assembly, which counts: export both files again",
        ),
        (
            "[30 0 200]",
            "[30 0 201]",
            "crane.m:13: `base-1:-:cover-1` holds its parts 1.000 mm from where they stand in the assembly, which counts: export both files again",
        ),
        (
            "B[base-1:-:",
            "B[basis-1:-:",
            "crane.m:13: the assembly has no place for `B[basis-1:-:cover-1]`, `F[base-1:-:cover-1]`: left out",
        ),
    ] {
        let changed = HINGE.replace(from, to);
        assert_ne!(changed, HINGE, "{from}");
        let notes = crane(&changed).notes;
        match told.is_empty() {
            true => assert_eq!(notes.len(), 1, "{notes:?}"),
            false => assert!(notes.iter().any(|note| note == told), "{told}\n{notes:#?}"),
        }
    }
}
