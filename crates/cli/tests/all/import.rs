//! `blocksim import` as users call it.

use std::fs;
use std::path::{Path, PathBuf};

use crate::support::program;

/// A folder that goes away, with files of the tests.
struct Desk(PathBuf);

impl Desk {
    fn with(name: &str, files: &[(&str, &str)]) -> Desk {
        let folder = std::env::temp_dir().join(format!("blocksim-import-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        files.iter().for_each(|(name, text)| fs::write(folder.join(name), text).unwrap());
        Desk(folder)
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.0.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    fn write(&self, name: &str, text: &str) {
        fs::write(self.0.join(name), text).unwrap();
    }

    /// Exit code, standard output and standard error.
    fn call(&self, arguments: &[&str]) -> (i32, String, String) {
        let mut command = program();
        let output =
            command.current_dir(&self.0).args(arguments).env_remove("CLICOLOR_FORCE").output().unwrap();
        let [out, err] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
        (output.status.code().unwrap(), out, err)
    }

    fn done(&self, arguments: &[&str]) -> String {
        let (code, out, err) = self.call(arguments);
        assert_eq!(code, 0, "{arguments:?}: {out}{err}");
        out + &err
    }
}

impl Drop for Desk {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn data(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/data").join(name);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[test]
fn an_imported_robot_is_planned_and_solved_right_away() {
    let desk = Desk::with("plan", &[("irb2600.urdf", &data("irb2600.urdf"))]);
    let told = desk.done(&["import", "irb2600.urdf", "--out", "arm"]);
    assert!(told.contains("wrote arm/irb2600_robot.ron"), "{told}");
    assert!(
        told.contains(
            "does not state accelerations and how fast the tool may be: irb2600_robot.ron assumes them"
        ),
        "{told}"
    );
    let target = "60 deg, 30 deg, -20 deg, 45 deg, 60 deg, 90 deg";
    let robot = ["--robot", "arm/irb2600.ron"];
    let joint = [&["plan", "joint", "--to", target, "--out", "pick.ron"][..], &robot].concat();
    let planned = desk.done(&joint);
    assert!(planned.contains("joint_1") || planned.contains("   1  "), "{planned}");
    assert!(desk.read("pick.ron").contains("result: ("));
    let line = [
        &["plan", "linear", "--from-point", "1 m, 100 mm, 1.3 m", "--to", "1.1 m, -200 mm, 1.1 m"][..],
        &robot,
    ]
    .concat();
    desk.done(&line);
    // Inverse kinematics in the diagram itself, beside what was imported.
    let solved = desk
        .read("arm/irb2600.ron")
        .replace(
            "    blocks: {\n",
            "    blocks: {\n        \"where\": ForwardKinematics(robot: \"manipulator\"),\n        \
             \"bent\": Constant(value: [\"10 deg\", \"20 deg\", \"-30 deg\", \"40 deg\", \"50 deg\", \"60 deg\"]),\n        \
             \"seen\": Scope(inputs: [\"p\"]),\n",
        )
        .replace(
            "    connections: [\n",
            "    connections: [\n        \"bent.y -> where.q\",\n        \"where.p -> seen.p\",\n",
        );
    desk.write("arm/solved.ron", &solved);
    desk.done(&["run", "arm/solved.ron", "--out", "r", "--quiet"]);
}

/// A robot with shapes: a foot, an upper arm on a weld, and a forearm that can hit the foot.
const SHAPES: &str = r#"<robot name="shapes">
  <link name="foot"><inertial><mass value="9"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>
    <collision><origin xyz="0 0 0.1"/><geometry><box size="0.6 0.2 0.2"/></geometry></collision></link>
  <joint name="a" type="revolute"><parent link="foot"/><child link="carrier"/><origin xyz="0 0 0.5"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" velocity="2" effort="9"/></joint>
  <link name="carrier"/>
  <joint name="weld" type="fixed"><parent link="carrier"/><child link="upper"/><origin xyz="0 0 0.2" rpy="0 0 0.5"/></joint>
  <link name="upper"><inertial><mass value="2"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
    <collision><geometry><cylinder radius="0.04" length="0.4"/></geometry></collision></link>
  <joint name="b" type="revolute"><parent link="carrier"/><child link="fore"/><origin xyz="0 0 0.5"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" velocity="2" effort="9"/></joint>
  <link name="fore"><inertial><origin xyz="0 0 0.3"/><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
    <collision><origin xyz="0 0 0.45"/><geometry><cylinder radius="0.03" length="0.8"/></geometry></collision></link>
</robot>
"#;

#[test]
fn an_imported_robot_that_hits_itself_is_told() {
    let desk = Desk::with("shapes", &[("arm.urdf", SHAPES)]);
    desk.done(&["import", "arm.urdf", "--out", "arm"]);
    let (described, numbers) = (desk.read("arm/arm_robot.ron"), desk.read("arm/arm_parameters.ron"));
    assert!(described.contains("pedestal: [\"model.bodies.foot\"]"), "{described}");
    assert!(described.contains("\"model.chain.axes.a.bodies.upper\""), "{described}");
    assert!(numbers.matches("kind: Text(\"cylinder\")").count() == 3, "upper stands twice: {numbers}");
    let plan = |to: &str| desk.call(&["plan", "joint", "--robot", "arm/arm.ron", "--to", to]);
    let (code, out, err) = plan("20 deg, 30 deg");
    assert_eq!(code, 0, "{out}{err}");
    // The forearm folds down onto the foot.
    let (code, out, err) = plan("0 deg, 170 deg");
    assert_eq!(code, 1, "{out}{err}");
}

/// A pendulum of two rods whose file somebody works on.
const RODS: &str = r#"<robot name="rods">
  <link name="stand"/>
  <joint name="hinge" type="revolute">
    <origin xyz="0 0 1"/><parent link="stand"/><child link="rod"/><axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" velocity="2" effort="50"/>
  </joint>
  <link name="rod">
    <inertial>
      <origin xyz="0 0 -0.5"/><mass value="2"/>
      <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.01"/>
    </inertial>
    <visual><geometry><mesh filename="rod.stl" scale="0.001 0.001 0.001"/></geometry></visual>
  </link>
</robot>
"#;

fn triangle(height: f64) -> String {
    format!(
        "solid rod\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 50 0 0\nvertex 0 0 {height}\nendloop\nendfacet\nendsolid rod\n"
    )
}

#[test]
fn importing_a_changed_file_brings_numbers_and_meshes_and_leaves_all_that_was_wired() {
    let desk = Desk::with("again", &[("rods.urdf", RODS), ("rod.stl", &triangle(-1000.0))]);
    let first = desk.done(&["import", "rods.urdf", "--out", "m"]);
    assert!(first.contains("wrote 1 mesh\n"), "{first}");
    // Wiring, a comment, further blocks, a renamed scope, in the diagram and in the description.
    let mine = desk
        .read("m/rods.ron")
        .replace("// rods, imported", "// My test stand.\n// rods, imported")
        .replace("\"angles\": Scope(", "\"swing\": Scope(")
        .replace("angles.hinge", "swing.hinge")
        .replace(
            "    blocks: {\n",
            "    blocks: {\n        \"push\": Step(time: \"0.1 s\", after: \"3 N*m\"),\n",
        )
        .replace(
            "    connections: [\n",
            "    connections: [\n        \"push.y -> hinge.torque\",  // mine\n",
        );
    let drive = "            drive: (motor: (inertia: \"1e-3 kg*m^2\")),\n            bodies";
    let described = desk.read("m/rods_robot.ron").replace("            bodies", drive);
    desk.write("m/rods.ron", &mine);
    desk.write("m/rods_robot.ron", &described);
    desk.done(&["run", "m/rods.ron", "--out", "before", "--quiet"]);

    let changed = RODS.replace("mass value=\"2\"", "mass value=\"3\"").replace("0 0 1\"/>", "0 0 1.5\"/>");
    desk.write("rods.urdf", &changed);
    desk.write("rod.stl", &triangle(-1100.0));
    let again = desk.done(&["import", "rods.urdf", "--out", "m"]);
    for word in
        ["updated 1 mesh\n", "2 changed, 0 new, 0 gone", "left m/rods.ron as it is", "left m/rods_robot.ron"]
    {
        assert!(again.contains(word), "{word}: {again}");
    }
    assert_eq!(desk.read("m/rods.ron"), mine);
    assert_eq!(desk.read("m/rods_robot.ron"), described);
    let numbers = desk.read("m/rods_parameters.ron");
    assert!(numbers.contains("mass: \"3 kg\"") && numbers.contains("\"1.5 m\""), "{numbers}");
    assert!(desk.read("m/meshes/rod.stl").contains("-1100"));
    // What was wired still runs, with the new mass: it swings differently.
    desk.done(&["run", "m/rods.ron", "--out", "after", "--quiet"]);
    let [before, after] = ["before", "after"].map(|run| {
        desk.done(&["export", run, "--csv", &format!("{run}.csv")]);
        desk.read(&format!("{run}.csv"))
    });
    assert_ne!(before.lines().last(), after.lines().last());
    // And once more: nothing differs.
    let third = desk.done(&["import", "rods.urdf", "--out", "m"]);
    assert!(third.contains("no number differs") && !third.contains("mesh"), "{third}");
}

/// An arm of two links: `fore` hangs on `from`.
fn arm(from: &str) -> String {
    let link = |name: &str| {
        format!(
            "<link name='{name}'><inertial><mass value='1'/>\
             <inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial></link>"
        )
    };
    let joint = |name: &str, parent: &str, child: &str| {
        format!(
            "<joint name='{name}' type='continuous'><parent link='{parent}'/><child link='{child}'/>\
             <origin xyz='0.3 0 0'/><axis xyz='0 1 0'/></joint>"
        )
    };
    let links = ["<link name='base'/>".to_owned(), link("upper"), link("fore")].concat();
    format!("<robot name='arm'>{links}{}{}</robot>", joint("a", "base", "upper"), joint("b", from, "fore"))
}

#[test]
fn numbers_of_another_structure_are_not_put_into_a_diagram_without_a_word() {
    let desk = Desk::with("structure", &[("arm.urdf", &arm("upper"))]);
    desk.done(&["import", "arm.urdf", "--out", "m"]);
    let before = desk.read("m/arm_parameters.ron");
    desk.write("arm.urdf", &arm("base"));
    let (code, _, err) = desk.call(&["import", "arm.urdf", "--out", "m"]);
    assert_eq!(code, 4, "{err}");
    let wired = desk.read("m/arm.ron");
    let line = |text: &str| wired.lines().position(|line| line.contains(text)).unwrap() + 1;
    let lines = [
        line("\"b_seat\": Transform("),
        line("model.joints.b.axis"),
        line("model.joints.b.position"),
        line("model.joints.b.damping"),
        line("a.follower <-> upper.frame <-> b_seat.base"),
        line("b_seat.follower <-> b.base"),
        line("b.follower <-> fore.frame"),
    ];
    let lines = lines.map(|line| line.to_string()).join(", ");
    for words in [
        "error[exists]: `m/arm_parameters.ron` does not have the structure of `arm.urdf`",
        &format!("`b` is carried by `base` (before by `upper`); arm.ron, line {lines}"),
        "import into another folder",
        "nothing has been written",
    ] {
        assert!(err.contains(words), "{words}: {err}");
    }
    assert_eq!(desk.read("m/arm_parameters.ron"), before);
    // Elsewhere the diagram is made anew; here the numbers are taken over knowingly, with the lines to change.
    desk.done(&["import", "arm.urdf", "--out", "n"]);
    assert!(desk.read("n/arm.ron").contains("world.frame <-> a_seat.base <-> b_seat.base"));
    let taken = desk.done(&["import", "arm.urdf", "--out", "m", "--yes"]);
    assert!(
        taken.contains(&format!(
            "other structure: `b` is carried by `base` (before by `upper`); arm.ron, line {lines}"
        )),
        "{taken}"
    );
    assert_eq!(desk.read("m/arm.ron"), wired);
    let same = desk.done(&["import", "arm.urdf", "--out", "m"]);
    assert!(same.contains("no number differs") && !same.contains("structure"), "{same}");
}

#[test]
fn a_parameter_file_that_was_changed_and_has_another_structure_is_refused_for_both() {
    let desk = Desk::with("both", &[("arm.urdf", &arm("upper"))]);
    desk.done(&["import", "arm.urdf", "--out", "m"]);
    desk.write("m/arm_parameters.ron", &desk.read("m/arm_parameters.ron").replace("\"1 kg\"", "\"2 kg\""));
    desk.write("arm.urdf", &arm("base"));
    let (code, _, err) = desk.call(&["import", "arm.urdf", "--out", "m"]);
    assert_eq!(code, 4, "{err}");
    for words in ["was changed since the last import", "`b` is carried by `base` (before by `upper`)"] {
        assert!(err.contains(words), "{words}: {err}");
    }
}

#[test]
fn a_description_that_came_later_is_written_and_told_to_a_diagram_that_does_not_name_it() {
    let desk = Desk::with("later", &[("rods.urdf", RODS)]);
    desk.done(&["import", "rods.urdf", "--out", "m", "--no-meshes"]);
    fs::remove_file(desk.0.join("m/rods_robot.ron")).unwrap();
    let mine = desk.read("m/rods.ron").replace("        \"manipulator\": File(\"rods_robot.ron\"),\n", "");
    desk.write("m/rods.ron", &mine);
    let told = desk.done(&["import", "rods.urdf", "--out", "m", "--no-meshes"]);
    assert!(told.contains("wrote m/rods_robot.ron"), "{told}");
    assert!(told.contains("add \"manipulator\": File(\"rods_robot.ron\") to its parameters"), "{told}");
    let (code, _, err) = desk.call(&["import", "rods.urdf", "--out", "m", "--no-meshes", "--tip", "hand"]);
    assert_eq!(code, 2);
    assert!(err.contains("there is no body `hand`; there are stand, rod"), "{err}");
}

/// Numbers of the crane as a data file has them: another mass, the hook pin where the assembly has it, the mast 2 mm off.
const CRANE: &str = "smiData.Solid(1).mass = 950;  % g
smiData.Solid(1).CoM = [0 5 -20];  % mm
smiData.Solid(1).MoI = [5e5 6e5 7e5];  % g*mm^2
smiData.Solid(1).PoI = [1e4 2e4 -3e4];  % g*mm^2
smiData.Solid(1).ID = 'trolley';
smiData.Solid(2).mass = 1;  % kg
smiData.Solid(2).CoM = [0 0 0];  % mm
smiData.Solid(2).MoI = [1 1 1];  % kg*mm^2
smiData.Solid(2).PoI = [0 0 0];  % kg*mm^2
smiData.Solid(2).ID = 'ballast';
";

#[test]
fn a_data_file_joins_its_assembly_in_one_import_and_says_where_it_differs() {
    let desk = Desk::with("data", &[("crane.xml", &data("crane.xml")), ("crane_DataFile.m", CRANE)]);
    let alone = desk.done(&["import", "crane.xml", "--out", "a", "--no-meshes"]);
    assert!(
        alone.contains("note: crane_DataFile.m lies beside it and is not read; name it with --data"),
        "{alone}"
    );
    let arguments = ["import", "crane.xml", "--data", "crane_DataFile.m", "--out", "b", "--no-meshes"];
    let both = desk.done(&arguments);
    assert!(
        both.contains(
            "crane_DataFile.m:1: `trolley` has 0.95 kg, in the assembly 0.9 kg; the data file counts"
        ),
        "{both}"
    );
    assert!(both.contains("crane_DataFile.m:6: the assembly has no part `ballast`: left out"), "{both}");
    assert!(desk.read("a/crane_parameters.ron").contains("mass: \"0.9 kg\""));
    let numbers = desk.read("b/crane_parameters.ron");
    assert!(numbers.contains("mass: \"0.95 kg\""), "{numbers}");
    assert!(numbers.contains("numbers from crane.xml and crane_DataFile.m"), "{numbers}");
    assert_eq!(desk.done(&["check", "b/crane.ron"]).matches("error").count(), 0);
    let (code, _, err) =
        desk.call(&["import", "crane_DataFile.m", "--data", "crane_DataFile.m", "--out", "c"]);
    assert_eq!(code, 2);
    assert!(err.contains("--data belongs to an assembly"), "{err}");
}
