//! What projects begin with: models that ship with blocksim, so that they stay right.

use crate::args::start::TemplateName;

/// A file of a template.
pub struct File {
    pub name: &'static str,
    pub text: &'static str,
    pub about: &'static str,
}

/// A project.
pub struct Template {
    /// A sentence for its README.
    pub about: &'static str,
    pub files: &'static [File],
    /// The model that is run.
    pub model: &'static str,
    /// Options of the first command.
    pub change: &'static str,
    /// Texts of the shipped models that are other here.
    replaced: &'static [(&'static str, &'static str)],
    /// The crate of a controller stands beside the model.
    pub has_plugin: bool,
}

impl Template {
    /// The text of a file.
    pub fn text(&self, file: &File) -> String {
        self.replaced.iter().fold(file.text.to_owned(), |text, (old, new)| text.replace(old, new))
    }
}

const EMPTY: &str = r#"// A model to begin with: `blocksim blocks` lists what else there is.
Diagram(
    title: "Model",
    simulation: (stop_time: "2 s"),
    blocks: {
        "demand": Step(time: "0.5 s", after: 1.0),
        "scope": Scope(inputs: ["value"]),
    },
    connections: [
        "demand.y -> scope.value",
    ],
)
"#;

/// The template of a name.
pub fn template(name: TemplateName) -> Template {
    match name {
        TemplateName::Servo => Template {
            about: "A PID controller turns a load by 90 degrees through a DC motor and a gear.",
            files: &[
                File {
                    name: "servo.ron",
                    text: include_str!("../../../../../diagrams/servo.ron"),
                    about: "the model: blocks and connections",
                },
                File {
                    name: "dc_motor.ron",
                    text: include_str!("../../../../../diagrams/dc_motor.ron"),
                    about: "the numbers of the motor",
                },
            ],
            model: "servo.ron",
            change: "",
            replaced: &[],
            has_plugin: false,
        },
        TemplateName::Robot => Template {
            about: "A SCARA robot carries a part along a move of its tool, led by computed torque.",
            files: &[
                File {
                    name: "scara.ron",
                    text: include_str!("../../../../../diagrams/scara/scara.ron"),
                    about: "the model: robot, controller, move",
                },
                File {
                    name: "manipulator.ron",
                    text: include_str!("../../../../../diagrams/scara/manipulator.ron"),
                    about: "links, axes, limits and shapes of the robot",
                },
                File {
                    name: "pick.ron",
                    text: include_str!("../../../../../diagrams/scara/pick.ron"),
                    about: "the move",
                },
            ],
            model: "scara.ron",
            change: " --report",
            replaced: &[("diagrams/scara/", "")],
            has_plugin: false,
        },
        TemplateName::Plugin => Template {
            about: "A controller in Rust, `controller/src/lib.rs`, in a loop with two lags. A run builds it first.",
            files: &[File {
                name: "loop.ron",
                text: include_str!("../plugin/template/demo.ron"),
                about: "the model: the controller and a plant",
            }],
            model: "loop.ron",
            change: "",
            replaced: &[
                ("library: \".\"", "library: \"controller\""),
                ("MyController", "Controller"),
                ("my_controller", "controller"),
                ("src/lib.rs", "controller/src/lib.rs"),
                ("demo.ron", "loop.ron"),
            ],
            has_plugin: true,
        },
        TemplateName::Empty => Template {
            about: "A step and a scope, to begin with.",
            files: &[File { name: "model.ron", text: EMPTY, about: "the model" }],
            model: "model.ron",
            change: "",
            replaced: &[],
            has_plugin: false,
        },
    }
}
