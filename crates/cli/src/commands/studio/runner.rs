//! A run of a model: another process of this program, so that whatever a plug-in does the page stays. The run leaves what
//! `blocksim run` leaves, to the bit.

use std::collections::VecDeque;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use blocksim_studio::{News, Reply};
use serde_json::{Value, json};

use crate::commands::report::meshes::{MeshSources, surfaces};
use crate::running::blame::block_of;

/// Bytes of rows that are kept for a page that is opened while a run goes on.
const KEPT: usize = 16 << 20;
/// Longest line of a run, bytes.
const LINE: u64 = 32 << 20;
/// How long a run may take to end when the studio ends.
const END: Duration = Duration::from_secs(10);
/// Bytes of what a run says to people that are kept.
const SAID: u64 = 65_536;

/// The run that goes on, or the last one.
#[derive(Clone)]
pub struct Runner {
    news: News,
    now: Arc<Mutex<Now>>,
}

struct Now {
    /// As the page knows it.
    state: Value,
    /// Where the run is told what to do, while it goes on, and behind its end, as long as it may go back.
    input: Option<ChildStdin>,
    /// It has come to its end, and nothing goes on.
    is_over: bool,
    /// It stands still as soon as it is where another one was.
    begins_paused: bool,
    /// Counts what was started, as one that has been left may still speak.
    number: u64,
    /// Time up to which its rows, or those of the run that it repeats, have been seen, s.
    reached: f64,
    /// What was set in it, and when, as `--change` takes it. What it repeats of another run stands there from its start on.
    changes: Vec<(f64, String)>,
    /// How many of them it has made.
    made: usize,
    /// Its pictures, and rows for those who come late.
    scopes: Option<String>,
    /// What is seen of its mechanism; null without. Meshes are read when a page asks for them.
    scene: Value,
    space: Option<Arc<str>>,
    rows: VecDeque<String>,
    bytes: usize,
    /// A run has ended since this was asked last.
    ended: bool,
}

impl Runner {
    /// Nothing runs.
    pub fn new(news: News) -> Runner {
        let now = Now {
            state: json!({ "state": "idle" }),
            input: None,
            is_over: false,
            begins_paused: false,
            number: 0,
            reached: 0.0,
            changes: Vec::new(),
            made: 0,
            scopes: None,
            scene: Value::Null,
            space: None,
            rows: VecDeque::new(),
            bytes: 0,
            ended: false,
        };
        Runner { news, now: Arc::new(Mutex::new(now)) }
    }

    fn now(&self) -> MutexGuard<'_, Now> {
        self.now.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// How the run is.
    pub fn state(&self) -> Value {
        self.now().state.clone()
    }

    /// Whether a run has ended since this was asked last.
    pub fn take_ended(&self) -> bool {
        std::mem::take(&mut self.now().ended)
    }

    /// Pictures and rows so far.
    pub fn so_far(&self) -> Reply {
        let now = self.now();
        let rows: Vec<&str> = now.rows.iter().map(String::as_str).collect();
        let scopes = now.scopes.as_deref().unwrap_or("null");
        // Which news they contain: whoever hears news at the same time adds none twice.
        let (at, number) = (self.news.last(), now.number);
        let rows = rows.join(",");
        Reply::Text(
            format!("{{\"at\":{at},\"number\":{number},\"scopes\":{scopes},\"rows\":[{rows}]}}").into(),
        )
    }

    /// The mechanism of the run with its meshes, for the 3D view.
    pub fn space(&self) -> Reply {
        let now = self.now();
        let (mut scene, number, space) = (now.scene.clone(), now.number, now.space.clone());
        drop(now);
        if let Some(space) = space {
            return Reply::Text(space);
        }
        if scene.is_null() {
            return Reply::Data(json!({ "number": number, "scene": null }));
        }
        let mut warnings = Vec::new();
        // Somebody runs this model here, which reads the same files.
        let sources = MeshSources { folder: Path::new(""), of_run: 0, reads_others: true };
        let meshes = surfaces(&mut scene, sources, false, &mut warnings);
        let (meshes, numbers) = blocksim_report::surfaces(&meshes);
        let space = json!({
            "number": number, "scene": scene, "surfaces": meshes, "numbers": numbers, "warnings": warnings,
        });
        let space: Arc<str> = space.to_string().into();
        let mut now = self.now();
        if now.number == number {
            now.space = Some(Arc::clone(&space));
        }
        Reply::Text(space)
    }

    /// Changes the state and tells it. States are counted, since one that was asked for may arrive behind a newer one.
    fn change(&self, now: &mut Now, change: impl FnOnce(&mut Value)) {
        let count = now.state["count"].as_u64().unwrap_or(0) + 1;
        change(&mut now.state);
        now.state["count"] = count.into();
        self.news.tell("run", &now.state.to_string());
    }

    /// Starts a run; `body` may say what is set for it, which signals are recorded as well, and at which speed it goes. With
    /// `again` it takes the place of the last one: the same is set at the same times, and it is soon where that one was.
    pub fn start(&self, model: &Path, body: &Value) -> Reply {
        let mut now = self.now();
        let is_again = body["again"] == true;
        if now.input.is_some() && !now.is_over {
            if !is_again {
                return Reply::refused("a run goes on already", "end it, or wait for it");
            }
            // What it has recorded is recorded once more.
            let _ = now.input.as_mut().map(|input| writeln!(input, "{}", json!({ "do": "drop" })));
        }
        let mut command = match std::env::current_exe() {
            Ok(program) => Command::new(program),
            Err(error) => return Reply::refused(format!("the program cannot start itself: {error}"), ""),
        };
        let speed = body["speed"].as_f64().filter(|speed| speed.is_finite() && *speed >= 0.0).unwrap_or(0.0);
        command.arg("run").arg(model).args(["--json", "--live", &speed.to_string()]);
        // One that has not begun yet stands still as soon as it does, if that was its task.
        let was_paused = is_again && (now.state["state"] == "paused" || now.begins_paused);
        let sets = if is_again { now.state["set"].clone() } else { body["set"].clone() };
        let texts = |list: &Value| -> Vec<String> {
            let all = list.as_array().into_iter().flatten().filter_map(Value::as_str);
            all.map(str::to_owned).collect()
        };
        let records = texts(&body["record"]);
        command.args(texts(&sets).iter().flat_map(|set| ["--set", set]));
        command.args(records.iter().flat_map(|signal| ["--record", signal]));
        if is_again {
            command.args(now.changes.iter().flat_map(|(_, change)| ["--change", change]));
            if now.reached > 0.0 {
                command.args(["--catch-up", &format!("{}s", now.reached)]);
            }
            // A line on its input might come behind the time at which it is to stand.
            if was_paused {
                command.arg("--paused");
            }
        }
        let started = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn();
        let mut child = match started {
            Ok(child) => child,
            Err(error) => return Reply::refused(format!("the run cannot be started: {error}"), ""),
        };
        let Some(out) = child.stdout.take() else { return Reply::refused("the run cannot be heard", "") };
        // The one before ends where its input does.
        now.input = child.stdin.take();
        (now.scopes, now.bytes, now.is_over) = (None, 0, false);
        (now.scene, now.space) = (Value::Null, None);
        now.rows.clear();
        if !is_again {
            now.reached = 0.0;
            now.changes.clear();
        }
        now.made = 0;
        now.number += 1;
        now.begins_paused = was_paused;
        let (number, changes) = (now.number, now.texts_of_changes());
        self.change(&mut now, |state| {
            *state = json!({
                "state": "starting", "model": model.display().to_string(), "set": sets, "record": records, "changes": changes,
                "futures": [], "number": number, "standing": if is_again { state["standing"].take() } else { Value::Null },
            });
        });
        drop(now);
        let runner = self.clone();
        std::thread::spawn(move || runner.follow(child, out, number));
        Reply::Data(json!({}))
    }

    /// Hands on what a run says, until it ends.
    fn follow(&self, mut child: Child, out: ChildStdout, number: u64) {
        let said = child.stderr.take().map(|err| {
            std::thread::spawn(move || {
                let mut text = Vec::new();
                let mut err = err;
                let _ = err.by_ref().take(SAID).read_to_end(&mut text);
                // The rest is read so that the run is not held up.
                let _ = std::io::copy(&mut err, &mut std::io::sink());
                String::from_utf8_lossy(&text).into_owned()
            })
        });
        let mut told = Told::default();
        let mut out = BufReader::new(out);
        let mut line = String::new();
        while out.by_ref().take(LINE).read_line(&mut line).is_ok_and(|count| count > 0) {
            if self.now().number == number {
                self.line(&line, &mut told);
            }
            line.clear();
        }
        let status = child.wait();
        let said = said.and_then(|reader| reader.join().ok()).unwrap_or_default();
        let mut now = self.now();
        if now.number != number {
            return;
        }
        (now.input, now.ended) = (None, true);
        if now.is_over {
            return;
        }
        self.change(&mut now, |state| {
            let last = said.lines().rev().find(|line| !line.trim().is_empty()).map(str::to_owned);
            let code = status.map(|status| status.to_string()).unwrap_or_default();
            state["state"] = "failed".into();
            state["reason"] = told.problem.or(last).unwrap_or(code).into();
            state["blocks"] = told.blocks.into();
        });
    }

    /// A run has come to its end, or is left for one that goes back.
    fn done(&self, done: &Value, told: &mut Told) {
        let name = done["run"].as_str().and_then(|path| Path::new(path).file_name()?.to_str());
        let (problem, blocks) = (told.problem.take(), std::mem::take(&mut told.blocks));
        let mut now = self.now();
        now.ended = true;
        if std::mem::take(&mut told.is_left) {
            return self.change(&mut now, |state| left(state, name, &done["simulated_time"]));
        }
        now.is_over = true;
        self.change(&mut now, |state| {
            state["state"] = match done["ended"].as_str() {
                Some("complete") => "done",
                Some("failed") => "failed",
                _ => "stopped",
            }
            .into();
            state["t"] = done["simulated_time"].clone();
            state["took"] = done["wall_time"].clone();
            state["name"] = name.into();
            state["reason"] = problem.map_or(done["reason"].clone(), Value::from);
            state["blocks"] = blocks.into();
        });
    }

    /// The run stands at a time of its past, or stays where it is.
    fn back(&self, line: &str, event: &Value) {
        let mut now = self.now();
        if event["refused"].is_null() {
            let t = event["t"].as_f64().unwrap_or(0.0);
            now.changes.retain(|(at, _)| *at < t);
            (now.made, now.reached) = (now.changes.len(), t);
            now.keep(line);
            let changes = now.texts_of_changes();
            self.change(&mut now, |state| {
                (state["state"], state["t"]) = ("paused".into(), t.into());
                (state["name"], state["changes"]) = (Value::Null, changes.into());
                state["standing"] = event["standing"].clone();
            });
        }
        self.news.tell("back", line);
    }

    fn line(&self, line: &str, told: &mut Told) {
        let Ok(mut event) = serde_json::from_str::<Value>(line) else { return };
        match event["type"].as_str() {
            Some("scopes") => {
                let scene = event["scene"].take();
                let line = event.to_string();
                let mut now = self.now();
                now.scene = scene;
                self.news.tell("scopes", &line);
                now.scopes = Some(line);
                let was_paused = std::mem::take(&mut now.begins_paused);
                let (is_whole, reached) = (now.changes.is_empty(), now.reached);
                self.change(&mut now, |state| {
                    state["state"] = if was_paused { "paused" } else { "running" }.into();
                    state["until"] = event["until"].clone();
                    // One that repeats another is soon there.
                    state["t"] = reached.into();
                    if is_whole {
                        state["standing"] = event["standing"].take();
                    }
                });
            }
            Some("rows") => {
                let line = line.trim_end();
                let mut now = self.now();
                now.reach(&event["last"]);
                now.keep(line);
                self.news.tell("rows", line);
            }
            Some("tuned") => {
                self.news.tell("tuned", line.trim_end());
                if let (Some(t), Some(change)) = (event["t"].as_f64(), event["change"].as_str()) {
                    let mut now = self.now();
                    now.reach(&event["t"]);
                    let is_whole = now.makes(t, change);
                    let changes = now.texts_of_changes();
                    self.change(&mut now, |state| {
                        state["changes"] = changes.into();
                        if is_whole {
                            state["standing"] = event["standing"].clone();
                        }
                    });
                }
            }
            Some("left") => {
                let mut now = self.now();
                // One that had ended is known by its name.
                if std::mem::take(&mut now.is_over) {
                    let (name, t) = (now.state["name"].clone(), event["t"].clone());
                    self.change(&mut now, |state| left(state, name.as_str(), &t));
                } else {
                    told.is_left = true;
                }
            }
            Some("back") => self.back(line.trim_end(), &event),
            Some("progress") => {
                let mut now = self.now();
                now.reach(&event["t"]);
                self.change(&mut now, |state| {
                    state["t"] = event["t"].clone();
                    state["factor"] = event["real_time_factor"].clone();
                });
            }
            Some("diagnostic") if event["severity"] == "error" && told.problem.is_none() => {
                let help = event["help"].as_str().map(|help| format!(" ({help})")).unwrap_or_default();
                told.problem = event["message"].as_str().map(|message| format!("{message}{help}"));
                let labels = event["labels"].as_array().into_iter().flatten();
                let blocks = labels.filter_map(|label| block_of(label["text"].as_str()?));
                told.blocks = blocks.map(str::to_owned).collect();
            }
            Some("done") => self.done(&event, told),
            _ => {}
        }
    }

    /// Tells the run what to do.
    pub fn control(&self, body: &Value) -> Reply {
        let paused = match body["do"].as_str() {
            Some("pause" | "step") => Some(true),
            Some("go") => Some(false),
            Some("stop" | "speed" | "set" | "back") => None,
            _ => {
                return Reply::refused(
                    "a run can pause, go, step, stop, go at a speed, go back, or be given a parameter",
                    "",
                );
            }
        };
        let mut now = self.now();
        let is_over = now.is_over && body["do"] != "back";
        let Some(input) = now.input.as_mut().filter(|_| !is_over) else {
            // Whoever ends what has ended has what they want.
            return if body["do"] == "stop" {
                Reply::Data(json!({}))
            } else {
                Reply::refused("nothing runs", "F5 runs the model")
            };
        };
        if writeln!(input, "{body}").and_then(|()| input.flush()).is_err() {
            return Reply::refused("the run has just ended", "");
        }
        if let (Some(paused), Some("running" | "paused")) = (paused, now.state["state"].as_str()) {
            let word = if paused { "paused" } else { "running" };
            self.change(&mut now, |state| state["state"] = word.into());
        }
        Reply::Data(json!({}))
    }

    /// Ends the run, and waits until what it has recorded is kept.
    pub fn end(&self) {
        // A run whose input ends comes to its end.
        let input = self.now().input.take();
        if input.is_none() {
            return;
        }
        drop(input);
        let begin = Instant::now();
        while begin.elapsed() < END
            && ["starting", "running", "paused"].iter().any(|state| self.state()["state"] == *state)
        {
            std::thread::sleep(Duration::from_millis(10));
        }
    }
}

/// A future that was left, in the state of the run.
fn left(state: &mut Value, name: Option<&str>, t: &Value) {
    if let Some(futures) = state["futures"].as_array_mut() {
        futures.push(json!({ "name": name, "t": t }));
    }
}

impl Now {
    /// The run has been seen up to a time.
    fn reach(&mut self, t: &Value) {
        self.reached = t.as_f64().map_or(self.reached, |t| t.max(self.reached));
    }

    /// The run has made a change: the next one of those that it repeats, or a new one. Whether it repeats no more.
    fn makes(&mut self, t: f64, change: &str) -> bool {
        let change = (t, change.to_owned());
        match self.changes.get_mut(self.made) {
            Some(known) => *known = change,
            None => self.changes.push(change),
        }
        self.made += 1;
        self.made == self.changes.len()
    }

    /// What was set in the run, as `--change` takes it.
    fn texts_of_changes(&self) -> Vec<String> {
        self.changes.iter().map(|(_, change)| change.clone()).collect()
    }

    /// Keeps a line for those who come late.
    fn keep(&mut self, line: &str) {
        self.bytes += line.len();
        self.rows.push_back(line.to_owned());
        while self.bytes > KEPT {
            self.bytes -= self.rows.pop_front().map_or(self.bytes, |gone| gone.len());
        }
    }
}

/// What a run has said of itself.
#[derive(Default)]
struct Told {
    problem: Option<String>,
    /// Paths of the blocks that are to blame for it.
    blocks: Vec<String>,
    /// It is left for one that goes back, so what it says of its end is not the last word.
    is_left: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_repeated_run_has_still_to_make_is_not_forgotten() {
        let runner = Runner::new(News::default());
        let mut now = runner.now();
        assert!(now.makes(1.0, "a") && now.makes(2.0, "b"));
        // Repeated twice, and the first time it has come behind the first of them alone.
        for makes in [1, 2] {
            now.made = 0;
            let whole: Vec<bool> = [(1.0, "a"), (2.0, "b")]
                .iter()
                .take(makes)
                .map(|(t, change)| now.makes(*t, change))
                .collect();
            assert_eq!(whole, [false, true][..makes]);
            assert_eq!(now.texts_of_changes(), ["a", "b"]);
        }
        assert!(now.makes(3.0, "c"));
        assert_eq!(now.texts_of_changes(), ["a", "b", "c"]);
        // A time that is not known leaves what is.
        now.reach(&json!(2.5));
        now.reach(&json!(0.5));
        now.reach(&Value::Null);
        assert_eq!(now.reached, 2.5);
    }
}
