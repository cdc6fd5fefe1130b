//! What is kept of a run, and what is said about it.

use crate::commands::tell;
use blocksim_block::schedule::Recorded;
use blocksim_block::shell::quoted_text;
use blocksim_numbers::format::ordinal;
use blocksim_recording::STORE;

use super::prepare::Setup;
use super::simulate::Simulated;
use super::unwritten;
use crate::args::model::RunArgs;
use crate::exit::Exit;
use crate::failure::Failure;
use crate::running::keep::{Csv, Kept, Rest, is_csv_written, keep};
use crate::running::report::{Report, log};
use crate::scene;
use crate::terminal::console::Console;
use crate::terminal::render::plural;

/// Keeps a run and tells what it was; returns where it is.
///
/// # Errors
/// If it cannot be kept.
pub fn keep_and_tell(
    args: &RunArgs,
    setup: Setup,
    simulated: Simulated,
    console: Console,
) -> Result<(String, Exit), Failure> {
    let Setup { loaded, schedule, selection, folder, .. } = setup;
    let Simulated { run, seen, events, manifest, counts, warnings, began, findings, rows, lost, mut exit } =
        simulated;
    let source = |at: &usize| schedule.recorded[selection.sources[*at]].clone();
    let recorded: Vec<Recorded> = seen.signals.iter().map(source).collect();
    let report = Report {
        schedule: &schedule,
        manifest: &manifest,
        counts,
        recorded: &recorded,
        recording: &seen.recording,
        signals: run.signals().len(),
        rows,
        warnings,
        began,
        events: &events,
    };
    for file in loaded.scene().into_iter().flat_map(scene::missing_meshes) {
        console.say(&format!(
            "warning: the mesh `{file}` is missing and will not be drawn\n  = help: put it there, or correct `file` of the shape"
        ));
    }
    let csv = match (args.csv, args.no_csv) {
        (true, _) => Csv::Always,
        (_, true) => Csv::Never,
        _ => Csv::Sensibly,
    };
    let log = log(&report, &loaded);
    let kept = selection.sources.iter().map(|at| &schedule.recorded[*at]);
    let scene = loaded.scene().map(|scene| scene::with_actuators(scene, &schedule, kept));
    let rest = Rest { csv, events: &events, log: &log, manifest: &manifest, scene: scene.as_ref() };
    let partial = folder.partial_path().to_owned();
    let Kept { folder: place, untold } = match keep(folder, &run, rest) {
        Ok(kept) => kept,
        Err(error) => {
            // What was recorded can at least be seen.
            if !args.quiet && !args.json {
                console.data(&report.text(None, args, console))?;
            }
            // A disk that is full is told once.
            let failure = if lost.is_none() { unwritten(&error) } else { Failure::told(Exit::Files) };
            return Err(match partial.exists() {
                true => failure.last(format!("what was recorded is kept in {}", partial.display())),
                false => failure,
            });
        }
    };
    // What is on disk is safe, however long this takes.
    let verified = (args.verify && exit == Exit::Done).then(|| super::verify::verify(&schedule));
    // As the user wrote it, where they did.
    let place = args.out.as_ref().unwrap_or(&place).display().to_string();
    // The last line of data is that of the run.
    if args.json {
        tell(&report.warnings, &loaded.files, console)?;
        if let Some(verified) = &verified {
            console.data(&format!("{}\n", verified.json(&schedule)))?;
        }
    }
    console.data(&match (args.json, args.quiet) {
        (true, _) => format!("{}\n", report.json(&place)),
        (_, true) => format!("{place}\n"),
        _ => report.text(Some(&place), args, console),
    })?;
    if let Some(findings) = findings {
        console.say(&super::audit::text(&findings));
        if (findings.count > 0 || !findings.undeclared.is_empty()) && exit == Exit::Done {
            exit = Exit::Failed;
        }
    }
    if let Some(verified) = verified {
        console.say(&verified.text(&schedule));
        if exit == Exit::Done {
            exit = verified.exit();
        }
    }
    if !args.json {
        tell(&report.warnings, &loaded.files, console)?;
    }
    if let Some(warning) = report.plot_warning(args) {
        console.say(&warning);
    }
    if seen.stride > 1 {
        console.say(&format!("note: pictures and tables are of every {} row", ordinal(seen.stride)));
    }
    if selection.unasked > 0 {
        console.say(&format!(
            "note: {} of joints are recorded as well, for the 3D view",
            plural(selection.unasked, "position")
        ));
    }
    if csv == Csv::Sensibly && !is_csv_written(&run, csv) {
        console.say(&format!(
            "note: no signals.csv, as it would be very large; `blocksim export {} --csv FILE` writes it",
            quoted_text(&place)
        ));
    }
    // A disk that is full is told once.
    if let Some(error) = untold.filter(|_| lost.is_none()) {
        let note = format!(
            "all signals are in {place}/{STORE}; `blocksim export {} --csv FILE` writes them as text",
            quoted_text(&place)
        );
        exit = unwritten(&error).note(note).tell(console);
    }
    Ok((place, exit))
}
