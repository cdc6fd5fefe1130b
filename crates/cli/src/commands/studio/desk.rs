//! Answers what the page asks.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError, TryLockError};
use std::time::{Duration, Instant, SystemTime};

use blocksim_edit::Learned;
use blocksim_studio::{Desk, News, Reply};
use clap::ValueEnum;
use serde_json::{Value, json};

use super::analysis::Questions;
use super::model::{self, Shown, place};
use super::runner::Runner;
use super::values::{Changes, list, refusal};
use super::{edits, measured, motion, name_of, plugins, project, sheets, texts};
use crate::args::report::{ReportArgs, Section};
use crate::args::values::RUNS;
use crate::commands::compare::page_of_both;
use crate::commands::report;
use crate::disk::write_file;
use crate::terminal::console::Console;
use crate::watch::newest;

/// How often it is looked whether there are other models.
const MODELS: Duration = Duration::from_secs(2);

/// A project that is shown.
pub struct Studio {
    root: PathBuf,
    may_edit: bool,
    news: News,
    console: Console,
    runner: Runner,
    linear: Questions,
    sweeps: Questions,
    planner: motion::Planner,
    now: Mutex<Now>,
    changes: Mutex<Changes>,
    /// What compilations have found of the blocks, for those who write.
    learned: Mutex<Learned>,
}

struct Now {
    models: Vec<PathBuf>,
    model: PathBuf,
    shown: Shown,
    /// Files of the model as they were seen last; read anew when they have kept still.
    seen: Vec<Option<SystemTime>>,
    /// When a source of a plug-in was written last.
    code: Option<SystemTime>,
    /// When models were looked for.
    searched: Instant,
}

impl Studio {
    /// A project in a folder, with a model if one is named.
    pub fn new(
        root: PathBuf,
        model: Option<PathBuf>,
        may_edit: bool,
        news: News,
        console: Console,
    ) -> Studio {
        let models = project::models(&root);
        let named = model.or_else(|| project::first(&root, &models));
        // Where no file is a model, the first one has problems that say so.
        let model = named.unwrap_or_else(|| PathBuf::from("model.ron"));
        let shown = model::read(&root, &model, 1);
        let seen = times(&root, &model, &shown);
        let code = newest(&blocksim_host::folders());
        let now = Now { models, model, shown, seen, code, searched: Instant::now() };
        Studio {
            runner: Runner::new(news.clone()),
            linear: Questions::default(),
            sweeps: Questions::default(),
            planner: motion::Planner::default(),
            root,
            may_edit,
            news,
            console,
            now: Mutex::new(now),
            changes: Mutex::default(),
            learned: Mutex::default(),
        }
    }

    fn changes(&self) -> MutexGuard<'_, Changes> {
        self.changes.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Files of the model, as it was read last.
    fn files(&self) -> Vec<PathBuf> {
        let now = self.now();
        let all = now.shown.files.iter().map(|(path, _)| path.clone());
        // One that cannot be read as a diagram has a text all the same.
        let own = place(&self.root, &now.model);
        std::iter::once(own.clone()).chain(all.filter(|path| *path != own)).collect()
    }

    /// Changes the diagram as somebody has seen it, unless it has been changed meanwhile.
    fn edit(&self, model: &Path, body: &Value) -> Reply {
        let now = self.now();
        let is_seen = body["version"] == now.shown.version
            && known(&now.shown) == times(&self.root, &now.model, &now.shown);
        drop(now);
        if !is_seen {
            return Reply::refused(
                "the model has been changed meanwhile",
                "look at it as it is now, then try again",
            );
        }
        let mut reply = edits::edit(&self.root, model, body, &mut self.changes(), self.console);
        self.renew();
        // Whoever goes on at once knows what has been read.
        if let Reply::Data(data) = &mut reply {
            data["version"] = self.now().shown.version.into();
        }
        reply
    }

    /// Reads the model anew at once, if its files have changed.
    fn renew(&self) {
        let mut now = self.now();
        if times(&self.root, &now.model, &now.shown) != known(&now.shown) {
            let version = now.shown.version + 1;
            now.shown = model::read(&self.root, &now.model, version);
            now.seen = times(&self.root, &now.model, &now.shown);
            self.tell(&now);
        }
    }

    /// What this program has written is whole: it is not waited for until it has kept still.
    fn wrote(&self) {
        let mut now = self.now();
        now.seen = times(&self.root, &now.model, &now.shown);
    }

    fn now(&self) -> MutexGuard<'_, Now> {
        self.now.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Reads the model anew if its files have changed and keep still.
    pub fn look(&self) {
        // Several files that are being written together are not looked at before all of them are.
        if matches!(self.changes.try_lock(), Err(TryLockError::WouldBlock)) {
            return;
        }
        let mut now = self.now();
        if now.searched.elapsed() > MODELS {
            now.searched = Instant::now();
            let models = project::models(&self.root);
            if models != now.models {
                now.models = models;
                self.tell(&now);
            }
        }
        let code = newest(&blocksim_host::folders());
        let is_broken = now.shown.of("plugin_", "error").is_some();
        // Until then a plug-in that does not build is not built again.
        let is_held = is_broken && now.shown.read.elapsed() <= blocksim_host::ANSWER_HOLDS;
        let is_newer = code != now.code && !is_held;
        if is_newer {
            now.code = code;
        }
        // A run has built plug-ins, and made them known.
        let built = self.runner.take_ended()
            && (is_broken || now.shown.untrusted.is_some() || now.shown.has_other_plugins());
        let corrected = is_newer && is_broken;
        let before: Vec<Option<SystemTime>> = known(&now.shown);
        let present = times(&self.root, &now.model, &now.shown);
        let is_quiet = present == now.seen;
        now.seen = present;
        // A file that is gone is about to be written again, as editors do.
        if built || corrected || is_quiet && now.seen != before {
            let version = now.shown.version + 1;
            now.shown = model::read(&self.root, &now.model, version);
            now.seen = times(&self.root, &now.model, &now.shown);
            // As it was before: what is written meanwhile is seen the next time.
            now.code = code;
            self.tell(&now);
        } else if is_newer {
            self.tell(&now);
        }
    }

    fn tell(&self, now: &Now) {
        self.news.tell("model", &json!({ "version": now.shown.version }).to_string());
    }

    /// Ends what goes on.
    pub fn end(&self) {
        self.runner.end();
        self.linear.end();
        self.sweeps.end();
    }

    fn project(&self) -> Value {
        let now = self.now();
        let (rows, next) = project::rows(&self.root, &now.model, &now.shown);
        json!({
            "root": std::path::absolute(&self.root).unwrap_or_else(|_| self.root.clone()).display().to_string(),
            "name": name_of(&self.root),
            "edit": self.may_edit,
            "models": now.models.iter().map(|model| model.display().to_string()).collect::<Vec<_>>(),
            "model": now.model.display().to_string(),
            "path": place(&self.root, &now.model).display().to_string(),
            "title": now.shown.title,
            "version": now.shown.version,
            "until": now.shown.until,
            "panel": now.shown.panel,
            "problems": now.shown.problems,
            "rows": rows,
            "next": next,
            "run": self.runner.state(),
        })
    }

    /// Corrects a problem as it proposes itself.
    fn fix(&self, body: &Value) -> Reply {
        let now = self.now();
        let fix =
            body["problem"].as_u64().and_then(|n| now.shown.fixes.get(usize::try_from(n).ok()?)?.clone());
        let Some(fix) = fix.filter(|_| body["version"] == now.shown.version) else {
            return Reply::refused(
                "the model has been read anew since",
                "look at its problems as they are now",
            );
        };
        drop(now);
        let told = format!("{} is corrected", fix.path.display());
        let mut changes = self.changes.lock().unwrap_or_else(PoisonError::into_inner);
        changes.write(fix.path, fix.old, fix.new, &told)
    }

    /// Keeps a move as a file, and has the model use it if that is wanted.
    fn keep(&self, model: &Path, body: &Value) -> Reply {
        let model = place(&self.root, model);
        let name = match motion::save(&self.planner, &model, body) {
            Ok(name) => name,
            Err(refused) => return refused,
        };
        let told = format!("{name} is kept");
        if body["use"] != true {
            return Reply::Data(json!({ "message": told, "name": name }));
        }
        let mut changes = self.changes.lock().unwrap_or_else(PoisonError::into_inner);
        match changes.replace(&model, ("move", &format!("File({name:?})")), None, self.console) {
            Reply::Data(mut done) => {
                done["name"] = name.into();
                Reply::Data(done)
            }
            Reply::Refused(mut reason) => {
                let why = reason["message"].as_str().unwrap_or_default();
                reason["message"] = format!("{told}, but the model is not changed: {why}").into();
                Reply::Refused(reason)
            }
            other => other,
        }
    }

    /// Shows another of the models.
    fn choose(&self, body: &Value) -> Reply {
        let mut now = self.now();
        let Some(model) = now
            .models
            .iter()
            .find(|model| Some(model.display().to_string().as_str()) == body["model"].as_str())
        else {
            return Reply::refused("there is no such model in this project", "");
        };
        now.model = model.clone();
        let version = now.shown.version + 1;
        now.shown = model::read(&self.root, &now.model, version);
        now.seen = times(&self.root, &now.model, &now.shown);
        self.tell(&now);
        Reply::Data(json!({}))
    }
}

/// When the files of a model were written, as it was read.
fn known(shown: &Shown) -> Vec<Option<SystemTime>> {
    shown.files.iter().map(|(_, written)| *written).collect()
}

/// When they were written last; of a model that could not be read the file alone counts.
fn times(root: &Path, model: &Path, shown: &Shown) -> Vec<Option<SystemTime>> {
    let written = |path: &Path| path.metadata().ok().and_then(|data| data.modified().ok());
    if shown.files.is_empty() {
        return written(&place(root, model)).map(Some).into_iter().collect();
    }
    shown.files.iter().map(|(path, _)| written(path)).collect()
}

/// The folder of a run by its name: one part of a path, so that nothing but a run can be named.
pub fn run_folder(name: &str) -> Option<PathBuf> {
    let is_name =
        Path::new(name).components().count() == 1 && !name.contains(['/', '\\']) && !name.starts_with('.');
    let folder = Path::new(RUNS).join(name);
    (is_name && folder.is_dir()).then_some(folder)
}

/// Keeps the page of a run as a file in its folder, as `blocksim report` makes it with these options. It is made of nothing but the run
/// and measurements, so a new one replaces no work.
fn keep_page(root: &Path, body: &Value, console: Console) -> Reply {
    let Some(folder) = run_folder(body["run"].as_str().unwrap_or_default()) else { return Reply::Missing };
    let file = folder.join(report::NAME);
    let texts = |name: &str| {
        body[name].as_array().into_iter().flatten().filter_map(Value::as_str).collect::<Vec<_>>()
    };
    let overlay = match measured::files(root, &texts("measured")) {
        Ok(overlay) => overlay,
        Err(refused) => return refused,
    };
    let sections: Result<Vec<Section>, String> =
        texts("sections").into_iter().map(|name| Section::from_str(name, false)).collect();
    let Ok(sections) = sections else { return Reply::refused("a section of this name does not exist", "") };
    let author = body["author"].as_str().map(str::trim).filter(|name| !name.is_empty()).map(str::to_owned);
    let args = ReportArgs {
        full: body["full"] == true,
        overlay,
        sections,
        author,
        ..ReportArgs::of(folder.display().to_string())
    };
    let written = report::page(&args, console)
        .and_then(|page| write_file(&file, page.as_bytes(), true).map(|()| page.len()));
    match written {
        Ok(bytes) => Reply::Data(json!({ "file": file.display().to_string(), "bytes": bytes })),
        Err(failure) => refusal(failure),
    }
}

impl Desk for Studio {
    fn look(&self, path: &str) -> Reply {
        match path {
            "project" => Reply::Data(self.project()),
            "diagram" => Reply::Text(self.now().shown.drawn.clone()),
            "parameters" => {
                let model = self.now().model.clone();
                Reply::Data(list(&self.root, &model, self.may_edit))
            }
            "robot" => {
                let now = self.now();
                let (model, scene) = (place(&self.root, &now.model), now.shown.scene.clone());
                drop(now);
                Reply::Data(motion::robot_of(&model, &scene))
            }
            "signals" => Reply::Data(self.now().shown.signals.clone()),
            "measured" => Reply::Data(measured::list(&self.root, self.may_edit)),
            "runs" => Reply::Data(project::runs().into()),
            "plugins" => Reply::Data(plugins::list(&self.now().shown, self.may_edit)),
            "live" => self.runner.so_far(),
            "space" => self.runner.space(),
            // What a run had, to compare with.
            other => match other.strip_prefix("parameters/") {
                Some(name) => match project::run(name) {
                    Some(run) => sheets::of_run(&run),
                    None => Reply::Missing,
                },
                None => Reply::Missing,
            },
        }
    }

    fn act(&self, path: &str, body: &Value) -> Reply {
        let model = self.now().model.clone();
        let reply = match path {
            "run" => self.runner.start(&place(&self.root, &model), body),
            "control" => self.runner.control(body),
            "model" => self.choose(body),
            "linear" => self.linear.linear(&place(&self.root, &model), body),
            "sweep" if body["stop"] == true => {
                self.sweeps.end();
                Reply::Data(json!({}))
            }
            "sweep" => self.sweeps.sweep(&place(&self.root, &model), body, &self.news),
            "report" => keep_page(&self.root, body, self.console),
            "measured" => measured::look(&self.root, body),
            "plan" => motion::plan(&self.planner, &place(&self.root, &model), body),
            "kept" => motion::kept(&place(&self.root, &model), body["name"].as_str().unwrap_or_default()),
            "kinds" => edits::kinds(body),
            "kind" => edits::kind_of(&self.root, &place(&self.root, &model), body),
            "text" => texts::text(&self.root, &self.files(), body),
            "draft" => {
                texts::draft(&self.root, &place(&self.root, &model), &self.files(), body, &self.learned)
            }
            "complete" => {
                texts::completions(&self.root, &place(&self.root, &model), &self.files(), body, &self.learned)
            }
            "set" | "undo" | "redo" | "keep" | "fix" | "edit" | "save" | "plugin" | "measure" | "table"
                if !self.may_edit =>
            {
                Reply::refused(
                    "this page may not change files",
                    "start it with `blocksim studio --edit`; `Run with it` needs no file",
                )
            }
            // In another tab another model has been chosen meanwhile, in which the name may mean something else.
            "set" if body["model"].as_str().is_some_and(|of| Path::new(of) != model) => Reply::refused(
                format!("`{}` is shown now, not the model of this value", model.display()),
                "choose the model again; what was typed stays with it",
            ),
            "set" => {
                let mut changes = self.changes.lock().unwrap_or_else(PoisonError::into_inner);
                changes.set(&place(&self.root, &model), body, self.console)
            }
            "keep" => self.keep(&model, body),
            "plugin" => plugins::make(&self.root, &place(&self.root, &model), body),
            "measure" => measured::keep(&self.root, body),
            "table" => measured::take(&self.root, body),
            "fix" => self.fix(body),
            "undo" => self.changes().undo(),
            "redo" => self.changes().redo(),
            "edit" => self.edit(&place(&self.root, &model), body),
            "save" => texts::save(&self.root, &self.files(), body, &mut self.changes()),
            _ => Reply::Missing,
        };
        if ["set", "fix", "undo", "redo", "keep", "save"].contains(&path) {
            self.wrote();
        }
        reply
    }

    fn run_page(&self, name: &str) -> Reply {
        // Names of measurements stand behind that of the run, and two names for a run with another one beside it.
        let (name, measured) = match run_folder(name) {
            Some(_) => (name, Vec::new()),
            None => {
                let mut parts = name.split('*');
                (parts.next().unwrap_or_default(), parts.collect())
            }
        };
        let overlay = match measured::files(&self.root, &measured) {
            Ok(overlay) => overlay,
            Err(refused) => return refused,
        };
        let page = match name.split_once('~') {
            None => run_folder(name).map(|folder| {
                let args = ReportArgs { overlay, ..ReportArgs::of(folder.display().to_string()) };
                report::page(&args, self.console)
            }),
            Some((name, other)) => run_folder(name).zip(run_folder(other)).map(|(folder, other)| {
                let [folder, other] = [folder, other].map(|folder| folder.display().to_string());
                page_of_both(&folder, &other, self.console)
            }),
        };
        let Some(page) = page else { return Reply::Missing };
        match page {
            Ok(page) => Reply::Page(page),
            Err(failure) => refusal(failure),
        }
    }
}
