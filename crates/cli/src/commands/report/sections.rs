//! Which sections a page has, and who hands it in.

use blocksim_report::{Diagram, Report, Rows};
use clap::ValueEnum;

use crate::args::report::{ReportArgs, Section};
use crate::failure::Failure;

/// Longest name of an author.
const NAME: usize = 200;

/// Compares options that may contradict each other.
///
/// # Errors
/// The name is empty or too long, or 3D is both asked for and left out.
pub fn check(args: &ReportArgs) -> Result<(), Failure> {
    if args.no_3d && args.sections.contains(&Section::Space) {
        return Err(
            Failure::usage("--sections asks for 3d, and --no-3d leaves it out").help("keep one of both")
        );
    }
    match args.author.as_deref().map(str::trim) {
        Some("") => {
            Err(Failure::usage("the name of the author is empty").help("leave --author out, or give a name"))
        }
        Some(name) if name.chars().count() > NAME => {
            Err(Failure::usage(format!("the name of the author is longer than {NAME} signs"))
                .help("shorten it"))
        }
        _ => Ok(()),
    }
}

/// Names the author, and the sections where some are left out.
pub fn tell(args: &ReportArgs, report: &mut Report) {
    if let Some(author) = &args.author {
        report.facts.push(("Author".to_owned(), author.trim().to_owned()));
    }
    if !args.sections.is_empty() {
        let named = Section::value_variants().iter().filter(|section| args.has(**section));
        let named: Vec<String> =
            named.filter_map(|section| Some(section.to_possible_value()?.get_name().to_owned())).collect();
        report.facts.push(("Sections of this page".to_owned(), format!("summary, {}", named.join(", "))));
    }
}

/// Takes away what is not asked for. The 3D view is not read in the first place.
pub fn leave_out(args: &ReportArgs, report: &mut Report) {
    if !args.has(Section::Scopes) {
        report.panels.clear();
        report.overlays.clear();
        report.has_no_scopes = true;
    }
    if !args.has(Section::Planes) {
        report.planes.clear();
    }
    if !args.has(Section::Diagram) {
        report.diagram = Diagram::default();
        // Their pictures are asked for at its wires.
        report.unseen.clear();
    }
    if !args.has(Section::Tracking) {
        report.metrics = Rows::default();
    }
    if !args.has(Section::Parameters) {
        report.parameters = Rows::default();
        report.tables.clear();
    }
    if !args.has(Section::Events) {
        report.events.clear();
    }
}
