//! Sweeps and linear analysis of a model: other processes of this program, as for a run. A newer question ends the one before.

use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use blocksim_studio::{News, Reply};
use serde_json::{Value, json};

/// How often it is looked whether an answer is there, or a newer question.
const LOOK: Duration = Duration::from_millis(4);
/// Longest answer, bytes.
const ANSWER: u64 = 64 << 20;
/// Longest line of what is told meanwhile, bytes.
const LINE: u64 = 1 << 20;

/// Questions of one kind, of which the last one counts.
#[derive(Clone, Default)]
pub struct Questions(Arc<AtomicU64>);

impl Questions {
    /// Ends what goes on.
    pub fn end(&self) {
        self.0.fetch_add(1, Ordering::Relaxed);
    }

    fn next(&self) -> u64 {
        self.0.fetch_add(1, Ordering::Relaxed) + 1
    }

    /// The answer of a command; `meanwhile` gets the lines of JSON that it prints to its standard error.
    fn ask(&self, words: Vec<String>, meanwhile: impl FnMut(&Value) + Send + 'static) -> Reply {
        let number = self.next();
        let started = std::env::current_exe().and_then(|program| {
            let mut command = Command::new(program);
            command.args(words).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn()
        });
        let mut child = match started {
            Ok(child) => child,
            Err(error) => return Reply::refused(format!("the program cannot start itself: {error}"), ""),
        };
        let answer = child.stdout.take().map(|out| {
            std::thread::spawn(move || {
                let mut text = Vec::new();
                let _ = out.take(ANSWER).read_to_end(&mut text);
                text
            })
        });
        let told = child.stderr.take().map(|err| std::thread::spawn(move || follow(err, meanwhile)));
        let is_over = self.wait(&mut child, number);
        let text = answer.and_then(|reader| reader.join().ok()).unwrap_or_default();
        let problem = told.and_then(|reader| reader.join().ok()).flatten();
        if !is_over {
            return Reply::refused("a newer question has taken its place", "");
        }
        answered(&text, problem)
    }

    /// Waits for a child; whether it has come to its end by itself.
    fn wait(&self, child: &mut Child, number: u64) -> bool {
        loop {
            match child.try_wait() {
                Ok(Some(_)) => return true,
                Ok(None) if self.0.load(Ordering::Relaxed) == number => std::thread::sleep(LOOK),
                _ => {
                    let _ = child.kill();
                    let _ = child.wait();
                    return false;
                }
            }
        }
    }

    /// Poles, responses and margins of a model.
    pub fn linear(&self, model: &Path, body: &Value) -> Reply {
        let mut words = vec!["linearise".to_owned(), model.display().to_string()];
        words.extend(["--json", "--curves"].map(str::to_owned));
        for (name, option) in
            [("from", "--from"), ("to", "--to"), ("open", "--open"), ("at", "--at"), ("locus", "--locus")]
        {
            if let Some(text) = text(&body[name]) {
                words.push(format!("{option}={text}"));
            }
        }
        if body["steady"] == true {
            words.push("--steady".to_owned());
        }
        if body["sampled"] == true {
            words.push("--sampled".to_owned());
        }
        words.extend(texts(&body["set"]).map(|set| format!("--set={set}")));
        self.ask(words, |_| {})
    }

    /// A table of runs; how far it is, is told as news.
    pub fn sweep(&self, model: &Path, body: &Value, news: &News) -> Reply {
        let mut words = vec!["sweep".to_owned(), model.display().to_string()];
        words.extend(["--json", "--progress"].map(str::to_owned));
        words.extend(texts(&body["over"]).map(|over| format!("--over={over}")));
        words.extend(texts(&body["metric"]).map(|metric| format!("--metric={metric}")));
        words.extend(texts(&body["set"]).map(|set| format!("--set={set}")));
        if let Some(count) = body["random"].as_u64() {
            words.push(format!("--random={count}"));
        }
        if let Some(until) = text(&body["until"]) {
            words.push(format!("--until={until}"));
        }
        let news = news.clone();
        self.ask(words, move |event| {
            if event["type"] == "progress" {
                news.tell("sweep", &event.to_string());
            }
        })
    }
}

fn text(value: &Value) -> Option<&str> {
    value.as_str().map(str::trim).filter(|text| !text.is_empty())
}

fn texts(value: &Value) -> impl Iterator<Item = &str> {
    value.as_array().into_iter().flatten().filter_map(text)
}

/// Hands on what a command tells while it works; returns the last line that is no JSON.
fn follow(err: impl Read, mut meanwhile: impl FnMut(&Value)) -> Option<String> {
    let mut err = BufReader::new(err);
    let (mut line, mut last) = (String::new(), None);
    while err.by_ref().take(LINE).read_line(&mut line).is_ok_and(|count| count > 0) {
        match serde_json::from_str::<Value>(&line) {
            Ok(event) => meanwhile(&event),
            Err(_) if !line.trim().is_empty() => last = Some(line.trim().to_owned()),
            Err(_) => {}
        }
        line.clear();
    }
    last
}

/// What is wrong with a value, without the option that it was handed on by: it stands in a field of the page.
fn of_field(message: &str) -> &str {
    let told = message.strip_prefix("invalid value '").and_then(|rest| rest.split_once(">': "));
    told.map_or(message, |(_, told)| told)
}

/// The answer among the lines of JSON, or the first error.
fn answered(text: &[u8], last: Option<String>) -> Reply {
    let text = String::from_utf8_lossy(text);
    let mut problem = None;
    for line in text.lines() {
        let Ok(event) = serde_json::from_str::<Value>(line) else { continue };
        match event["type"].as_str() {
            // As it was printed: to read numbers and to write them again may change their last digit.
            Some("sweep" | "linear") => return Reply::Text(line.into()),
            Some("diagnostic") if event["severity"] == "error" && problem.is_none() => {
                let help = event["help"].as_str().filter(|help| !help.contains("--help"));
                let message = event["message"].as_str().map(of_field);
                problem = Some(json!({ "message": message, "help": help }));
            }
            _ => {}
        }
    }
    problem.map_or_else(
        || Reply::refused(last.unwrap_or_else(|| "the program has given no answer".to_owned()), ""),
        Reply::Refused,
    )
}
