//! The command lines of `blocksim new`, `completions` and `doctor`.

use std::path::PathBuf;

use clap::ValueEnum;

/// `blocksim new`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  blocksim new lab\n  blocksim new arm --template robot\n  blocksim new --list"
)]
pub struct NewArgs {
    /// Folder of the project, which must be new or empty.
    #[arg(required_unless_present = "list")]
    pub folder: Option<PathBuf>,
    /// What to begin with.
    #[arg(long, value_enum, default_value_t = TemplateName::Servo, value_name = "TEMPLATE")]
    pub template: TemplateName,
    /// List the templates.
    #[arg(long, conflicts_with_all = ["folder", "template"])]
    pub list: bool,
    /// Clone of blocksim that a plug-in is built against; without it the one that this program was built from.
    #[arg(long, value_name = "DIR")]
    pub blocksim: Option<PathBuf>,
}

/// What a project begins with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum TemplateName {
    /// A PID controller turns a load through a DC motor and a gear; the motor has a file of its own.
    Servo,
    /// A SCARA robot with a move of its tool.
    Robot,
    /// A controller that you write in Rust, in a loop with a plant.
    Plugin,
    /// A controller that you write in C, in the same loop.
    C,
    /// A controller that you write in C++, in the same loop.
    Cpp,
    /// A step and a scope.
    Empty,
}

/// `blocksim completions`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:\n  \
    blocksim completions bash > ~/.local/share/bash-completion/completions/blocksim\n  \
    blocksim completions zsh > ~/.zfunc/_blocksim        with `fpath+=~/.zfunc` before compinit in ~/.zshrc\n  \
    blocksim completions fish > ~/.config/fish/completions/blocksim.fish\n  \
    blocksim completions powershell >> $PROFILE")]
pub struct CompletionsArgs {
    /// The shell.
    #[arg(value_enum)]
    pub shell: Shell,
}

/// Shells whose completion can be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Shell {
    Bash,
    Zsh,
    Fish,
    Powershell,
}

/// `blocksim doctor`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Exit codes: 0 all is well, 1 something is missing that a run or a plug-in needs.")]
pub struct DoctorArgs {
    /// As JSON, an object for each line.
    #[arg(long)]
    pub json: bool,
}
