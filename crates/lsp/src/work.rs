//! The thread that compiles, so that keys and questions about texts are answered at once.

use std::collections::BTreeSet;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;

use blocksim_block::CodePolicy;
use crossbeam_channel::{Receiver, Sender, unbounded};
use lsp_server::{ErrorCode, RequestId, Response};
use lsp_types::Location;
use serde_json::{Value, json};

use blocksim_edit::Refusal;

use crate::meanings::{definition, described, prepared, references, renamed};
use crate::models::{Known, Models};
use crate::refactor::chosen;
use crate::texts::Snapshot;

/// Stack of the thread: diagrams lie inside each other as deep as their brackets.
const STACK: usize = 32 << 20;

/// What there is to do, with the texts that it is about.
pub enum Job {
    /// To compile the models of all open files, looking anew for those that the listed files belong to.
    Check { forget: Vec<PathBuf> },
    /// To answer a question about a byte of a file.
    Answer { id: RequestId, path: PathBuf, at: usize, query: Query },
}

/// Questions whose answers need the names of whole models.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Query {
    /// Where it is declared, or `otherwise` where nothing more is known.
    Definition { otherwise: Option<Location> },
    /// What is declared, as text.
    Hover,
    /// Every place that names it.
    References { with_declaration: bool },
    /// Whether it can have another name, and what is to be replaced.
    Prepare,
    /// The edits that give it another name.
    Rename { new: String },
    /// The action with the changes that it stands for.
    Refactor { action: Box<Value> },
}

/// What is done.
pub enum Done {
    /// What is known of the models of the open files.
    Checked(u64, Box<Known>),
    /// An answer.
    Answered(Response),
}

/// Requests that the editor does not wait for any more.
pub type Cancelled = Arc<Mutex<BTreeSet<String>>>;

/// The thread and the ways there and back.
pub struct Worker {
    jobs: Option<Sender<(Job, Snapshot)>>,
    /// What is done.
    pub done: Receiver<Done>,
    thread: Option<JoinHandle<()>>,
}

impl Worker {
    /// Starts the thread; `code` decides what becomes of plug-ins, `folders` are those that the editor has open.
    ///
    /// # Errors
    /// The system has no thread left.
    pub fn new(
        code: Box<dyn CodePolicy + Send>,
        folders: Vec<PathBuf>,
        cancelled: Cancelled,
    ) -> std::io::Result<Worker> {
        let (jobs, queue) = unbounded();
        let (finished, done) = unbounded();
        let work = move || run(&queue, &finished, &folders, &*code, &cancelled);
        let thread = std::thread::Builder::new().name("models".to_owned()).stack_size(STACK).spawn(work)?;
        Ok(Worker { jobs: Some(jobs), done, thread: Some(thread) })
    }

    /// Puts a job behind the others.
    pub fn put(&self, job: Job, snapshot: Snapshot) {
        if let Some(jobs) = &self.jobs {
            // The thread lives as long as this.
            let _ = jobs.send((job, snapshot));
        }
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        drop(self.jobs.take());
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

fn run(
    queue: &Receiver<(Job, Snapshot)>,
    finished: &Sender<Done>,
    folders: &[PathBuf],
    code: &dyn CodePolicy,
    gone: &Cancelled,
) {
    let fresh = || Models::of(folders.to_vec());
    let mut models = fresh();
    while let Ok(first) = queue.recv() {
        // Somebody waits for answers; of several compilations only the last is wanted.
        let mut check: Option<(Vec<PathBuf>, Snapshot)> = None;
        let mut next = Some(first);
        while let Some((job, snapshot)) = next {
            match job {
                Job::Check { forget } => {
                    let mut all = check.take().map(|(all, _)| all).unwrap_or_default();
                    all.extend(forget);
                    check = Some((all, snapshot));
                }
                Job::Answer { id, path, at, query } => {
                    let about = (path, at, query);
                    let answer = answer(&mut models, id, about, &snapshot, code, gone);
                    let _ = finished.send(Done::Answered(answer));
                }
            }
            next = queue.try_recv().ok();
        }
        let Some((forget, snapshot)) = check else { continue };
        forget.iter().for_each(|path| models.forget(path));
        let look = || models.look(&snapshot, code);
        match catch_unwind(AssertUnwindSafe(look)) {
            Ok(Some(known)) => drop(finished.send(Done::Checked(snapshot.number, Box::new(known)))),
            // Texts have changed meanwhile: the next job compiles them.
            Ok(None) => {}
            Err(_) => {
                // What was kept may be half of something.
                models = fresh();
                drop(finished.send(Done::Checked(snapshot.number, Box::new(Known::after_a_bug(&snapshot)))));
            }
        }
    }
}

fn answer(
    models: &mut Models,
    id: RequestId,
    (path, at, query): (PathBuf, usize, Query),
    snapshot: &Snapshot,
    code: &dyn CodePolicy,
    gone: &Cancelled,
) -> Response {
    let was_cancelled = gone.lock().is_ok_and(|mut gone| gone.remove(&id.to_string()));
    if was_cancelled {
        let message = "the request was cancelled".to_owned();
        return Response::new_err(id, ErrorCode::RequestCanceled as i32, message);
    }
    let changed = "the text has changed meanwhile";
    let names = catch_unwind(AssertUnwindSafe(|| match &query {
        Query::Definition { otherwise } => {
            let found = definition(models, &path, at, snapshot, code);
            Ok(if found.is_empty() { json!(otherwise) } else { json!(found) })
        }
        Query::Hover => Ok(json!(described(models, &path, at, snapshot, code))),
        Query::References { with_declaration } => {
            Ok(json!(references(models, &path, at, *with_declaration, snapshot, code)))
        }
        Query::Prepare => prepared(models, &path, at, snapshot, code).map(|found| json!(found)),
        Query::Rename { new } => renamed(models, &path, at, new, snapshot, code).map(|edit| json!(edit)),
        Query::Refactor { action } => chosen(models, &path, &action["data"], snapshot, code).map(|edit| {
            let mut action = (**action).clone();
            action["edit"] = edit;
            action
        }),
    }));
    let refused = |id, Refusal { message, help, .. }: Refusal| {
        let reason = help.map_or_else(|| message.clone(), |help| format!("{message}: {help}"));
        Response::new_err(id, ErrorCode::RequestFailed as i32, reason)
    };
    match names {
        _ if snapshot.is_stale() => {
            Response::new_err(id, ErrorCode::ContentModified as i32, changed.to_owned())
        }
        Ok(Ok(answer)) => Response::new_ok(id, answer),
        Ok(Err(refusal)) => refused(id, refusal),
        Err(_) => {
            *models = Models::of(std::mem::take(&mut models.folders));
            let message = "this is a bug of blocksim: the names of the model could not be read";
            Response::new_err(id, ErrorCode::InternalError as i32, message.to_owned())
        }
    }
}
