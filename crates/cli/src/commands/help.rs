//! `blocksim help`: the help of a command, or all that is about some words.

use blocksim_signal::closest;
use clap::{Command, CommandFactory};

use super::blocks;
use super::explain::error_pages;
use super::manual::{Section, all_sections};
use crate::args::Args;
use crate::args::manual::HelpArgs;
use crate::exit::Exit;
use crate::failure::{Failure, Outcome};
use crate::search::Query;
use crate::terminal::console::Console;
use crate::terminal::prose::{first_sentence, shortened};

/// Most results of a kind that are listed.
const MOST: usize = 8;

/// Something that can be typed, and what it is for.
struct Found {
    typed: String,
    about: String,
}

/// Prints the help of a command, or lists commands, options, pages, blocks and errors about some words.
///
/// # Errors
/// If nothing is about the words.
pub fn help(args: &HelpArgs, console: Console) -> Outcome {
    let mut program = Args::command();
    program.build();
    if let Some(command) = command_of(&program, &args.words) {
        console.data(&command.clone().render_long_help().to_string())?;
        return Ok(Exit::Done);
    }
    let words = args.words.join(" ");
    let query = Query::new(&words);
    let sections = [
        ("Commands and options", commands(&program, &query)),
        ("Pages of the manual", pages(&query)),
        ("Blocks", blocks::found(&words).iter().map(|info| block(info.kind, info.doc)).collect()),
        ("Problems", problems(&query)),
    ];
    if sections.iter().all(|(_, found)| found.is_empty()) {
        return Err(nothing(&program, &words));
    }
    let written: Vec<String> = sections
        .iter()
        .filter(|(_, found)| !found.is_empty())
        .map(|(heading, found)| listed(heading, found, console.width))
        .collect();
    console.data(&written.join("\n"))?;
    Ok(Exit::Done)
}

/// The command that the words name; the program itself without words.
fn command_of<'a>(program: &'a Command, words: &[String]) -> Option<&'a Command> {
    words.iter().try_fold(program, |command, word| command.find_subcommand(word))
}

fn listed(heading: &str, found: &[Found], width: usize) -> String {
    let shown = &found[..found.len().min(MOST)];
    let longest = shown.iter().map(|found| found.typed.chars().count()).max().unwrap_or_default();
    let room = width.saturating_sub(longest + 4).max(30);
    let lines: String = shown
        .iter()
        .map(|found| format!("  {:longest$}  {}\n", found.typed, shortened(&found.about, room)))
        .collect();
    let more = match found.len() - shown.len() {
        0 => String::new(),
        left => format!("  and {left} more: add a word to see fewer\n"),
    };
    format!("{heading}\n{lines}{more}")
}

/// Commands, and options of commands, by their names and what is written about them.
fn commands(program: &Command, query: &Query) -> Vec<Found> {
    let mut all = Vec::new();
    gather(program, "blocksim", query, &mut all);
    // What several commands have in common is listed once, for the first of them.
    let mut seen = std::collections::BTreeSet::new();
    let ranked = query.ranked(all, |(score, ..)| *score);
    ranked.into_iter().filter(|(_, key, _)| seen.insert(key.clone())).map(|(_, _, found)| found).collect()
}

/// Score, what tells it apart from others, and the line.
type Scored = (u32, String, Found);

fn gather(command: &Command, path: &str, query: &Query, all: &mut Vec<Scored>) {
    for argument in command.get_arguments().filter(|argument| !argument.is_hide_set()) {
        let about = argument.get_help().map(ToString::to_string).unwrap_or_default();
        let Some(name) = argument.get_long().filter(|name| !["help", "version"].contains(name)) else {
            continue;
        };
        let values: Vec<String> = argument
            .get_possible_values()
            .iter()
            .map(|value| {
                format!(
                    "{} {}",
                    value.get_name(),
                    value.get_help().map(ToString::to_string).unwrap_or_default()
                )
            })
            .collect();
        let score = query.score(&[(name, 6), (&about, 4), (&values.join(" "), 2)]);
        let value = match argument.get_value_names() {
            Some([value, ..]) if argument.get_action().takes_values() => format!(" {value}"),
            _ => String::new(),
        };
        let typed = format!("{path} --{name}{value}");
        all.push((score, format!("--{name} {about}"), Found { typed, about: first_sentence(&about) }));
    }
    for below in command.get_subcommands().filter(|below| !below.is_hide_set()) {
        let path = format!("{path} {}", below.get_name());
        let about = below.get_about().map(ToString::to_string).unwrap_or_default();
        let long = below.get_long_about().map(ToString::to_string).unwrap_or_default();
        let more = below.get_after_help().map(ToString::to_string).unwrap_or_default();
        let aliases = below.get_all_aliases().collect::<Vec<_>>().join(" ");
        let score = query.score(&[(below.get_name(), 8), (&aliases, 8), (&about, 5), (&long, 2), (&more, 1)]);
        all.push((score, path.clone(), Found { typed: path.clone(), about }));
        gather(below, &path, query, all);
    }
}

fn pages(query: &Query) -> Vec<Found> {
    let score =
        |section: &Section| query.score(&[(section.heading, 6), (section.page, 4), (section.text, 1)]);
    let ranked = query.ranked(all_sections(), score);
    let mut found: Vec<Found> = Vec::new();
    for section in ranked {
        let typed = format!("blocksim manual {}", section.page);
        // One line a page, with its headings in the order of the results.
        match found.iter_mut().find(|found| found.typed == typed) {
            Some(found) => found.about += &format!("; {}", section.heading),
            None => found.push(Found { typed, about: section.heading.to_owned() }),
        }
    }
    found
}

fn block(kind: &str, doc: &str) -> Found {
    Found { typed: format!("blocksim blocks {kind}"), about: first_sentence(doc) }
}

fn problems(query: &Query) -> Vec<Found> {
    let first =
        |page: &'static str| page.lines().skip(1).find(|line| !line.trim().is_empty()).unwrap_or_default();
    let ranked = query.ranked(error_pages(), |(code, page)| query.score(&[(code, 6), (first(page), 2)]));
    ranked
        .into_iter()
        .map(|(code, page)| Found {
            typed: format!("blocksim explain {code}"),
            about: first_sentence(first(page)),
        })
        .collect()
}

fn nothing(program: &Command, words: &str) -> Failure {
    let names: Vec<&str> = program.get_subcommands().map(Command::get_name).collect();
    Failure::usage(format!("nothing is about `{words}`")).help(match closest(words, names.iter().copied()) {
        Some(meant) => format!("did you mean `blocksim help {meant}`?"),
        None => {
            "`blocksim help` lists the commands, `blocksim manual` the pages, `blocksim blocks` the blocks"
                .to_owned()
        }
    })
}
