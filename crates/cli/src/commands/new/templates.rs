//! What projects begin with: models that ship with blocksim, so that they stay right.

use crate::args::plugin::Language;
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
    replaced: Vec<(&'static str, &'static str)>,
    /// The sources of a controller stand beside the model, in this language.
    pub plugin: Option<Language>,
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
            replaced: Vec::new(),
            plugin: None,
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
            replaced: vec![("diagrams/scara/", "")],
            plugin: None,
        },
        TemplateName::Plugin => with_plugin(Language::Rust),
        TemplateName::C => with_plugin(Language::C),
        TemplateName::Cpp => with_plugin(Language::Cpp),
        TemplateName::Empty => Template {
            about: "A step and a scope, to begin with.",
            files: &[File { name: "model.ron", text: EMPTY, about: "the model" }],
            model: "model.ron",
            change: "",
            replaced: Vec::new(),
            plugin: None,
        },
    }
}

/// A loop with a controller of one's own.
fn with_plugin(language: Language) -> Template {
    let (about, source) = match language {
        Language::Rust => (
            "A controller in Rust, `controller/src/lib.rs`, in a loop with two lags. A run builds it first.",
            "controller/src/lib.rs",
        ),
        Language::C => (
            "A controller in C, `controller/controller.c`, in a loop with two lags. A run compiles it first.",
            "controller/controller.c",
        ),
        Language::Cpp => (
            "A controller in C++, `controller/controller.cpp`, in a loop with two lags. A run compiles it first.",
            "controller/controller.cpp",
        ),
    };
    Template {
        about,
        files: &[File {
            name: "loop.ron",
            text: include_str!("../plugin/template/demo.ron"),
            about: "the model: the controller and a plant",
        }],
        model: "loop.ron",
        change: "",
        replaced: vec![
            ("library: \".\"", "library: \"controller\""),
            ("MyController", "Controller"),
            ("my_controller", "controller"),
            ("src/lib.rs", source),
            ("demo.ron", "loop.ron"),
        ],
        plugin: Some(language),
    }
}
