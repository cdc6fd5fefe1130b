//! Messages in, messages out.

use std::collections::{BTreeSet, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use blocksim_block::CodePolicy;
use blocksim_edit::{Context, Prose, complete, context};
use crossbeam_channel::select;
use lsp_server::{Connection, ErrorCode, Message, Notification, Request, RequestId, Response};
use lsp_types::notification::{
    Cancel, DidChangeTextDocument, DidChangeWatchedFiles, DidCloseTextDocument, DidOpenTextDocument,
    DidSaveTextDocument, Notification as _, PublishDiagnostics,
};
use lsp_types::request::{
    CodeActionRequest, CodeActionResolveRequest, Completion, DocumentSymbolRequest, Formatting,
    GotoDefinition, HoverRequest, PrepareRenameRequest, References, Rename, Request as _,
};
use lsp_types::{
    CodeActionOptions, CodeActionParams, CodeActionProviderCapability, CompletionOptions, CompletionParams,
    DidChangeTextDocumentParams, DidChangeWatchedFilesParams, DidCloseTextDocumentParams,
    DidOpenTextDocumentParams, DidSaveTextDocumentParams, DocumentFormattingParams, DocumentSymbolParams,
    DocumentSymbolResponse, GotoDefinitionParams, HoverParams, HoverProviderCapability, InitializeParams,
    Location, OneOf, PublishDiagnosticsParams, Range as Span, ReferenceParams, RenameOptions, RenameParams,
    ResourceOperationKind, ServerCapabilities, TextDocumentPositionParams, TextDocumentSyncCapability,
    TextDocumentSyncKind, TextDocumentSyncOptions, WorkDoneProgressOptions,
};
use serde_json::{Value, json};

use crate::complete::item;
use crate::definition::{Target, definition};
use crate::fixes::offered;
use crate::formatting::laid_out;
use crate::hover::hover;
use crate::models::Known;
use crate::outline::outline;
use crate::position::{changed, offset, span};
use crate::refactor::{self, Takes};
use crate::texts::{Document, Open, Snapshot};
use crate::uri::{path_of, uri_of};
use crate::work::{Cancelled, Done, Job, Query, Worker};

/// What has gone wrong between the editor and the server.
type Broken = Box<dyn std::error::Error + Send + Sync>;

/// Serves an editor on the standard input and output until it says that it ends. To open a file is not to run it: `code` decides
/// whether plug-ins are built and loaded.
///
/// # Errors
/// If the editor breaks the protocol, or goes away without a word.
pub fn serve(prose: Prose, code: Box<dyn CodePolicy + Send>) -> Result<(), Broken> {
    let (connection, threads) = Connection::stdio();
    Server::new(prose, code).run(&connection)?;
    drop(connection);
    threads.join()?;
    Ok(())
}

/// What the server knows of an editor and its files. Keys and questions about a text are answered on the thread of the server;
/// models are compiled on another one (`Worker`).
pub struct Server {
    open: Arc<Open>,
    /// The number of the present texts, which work on older ones looks at.
    newest: Arc<AtomicU64>,
    /// What was found in the models last.
    known: Known,
    /// Files that may belong to another model than before, or have changed on the disk.
    forget: Vec<PathBuf>,
    /// Files whose problems are published.
    published: BTreeSet<PathBuf>,
    /// Requests that the other thread has not answered yet.
    waiting: HashSet<RequestId>,
    cancelled: Cancelled,
    prose: Prose,
    code: Option<Box<dyn CodePolicy + Send>>,
    /// Whether the editor fills in places to be written.
    snippets: bool,
    /// What it can do with changes of whole diagrams.
    takes: Takes,
}

impl Server {
    /// A server that knows nothing yet; `prose` makes text for people of the Markdown of the manual, `code` decides
    /// what becomes of plug-ins.
    pub fn new(prose: Prose, code: Box<dyn CodePolicy + Send>) -> Server {
        Server {
            open: Arc::default(),
            newest: Arc::default(),
            known: Known::default(),
            forget: Vec::new(),
            published: BTreeSet::new(),
            waiting: HashSet::new(),
            cancelled: Cancelled::default(),
            prose,
            code: Some(code),
            snippets: false,
            takes: Takes::default(),
        }
    }

    /// Serves one editor until it says that it ends.
    ///
    /// # Errors
    /// As of [`serve`].
    pub fn run(&mut self, connection: &Connection) -> Result<(), Broken> {
        let (id, request) = connection.initialize_start()?;
        let request: InitializeParams = serde_json::from_value(request)?;
        self.snippets = takes_snippets(&request);
        self.takes = takes_changes(&request);
        let about = json!({ "name": "blocksim", "version": env!("CARGO_PKG_VERSION") });
        connection.initialize_finish(id, json!({ "capabilities": capabilities(), "serverInfo": about }))?;
        let Some(code) = self.code.take() else { return Ok(()) };
        let worker = Worker::new(code, folders(&request), self.cancelled.clone())?;
        let ended = self.answer_all(connection, &worker);
        // What is under way is not wanted any more.
        self.newest.fetch_add(1, Ordering::Relaxed);
        ended
    }

    fn answer_all(&mut self, connection: &Connection, worker: &Worker) -> Result<(), Broken> {
        loop {
            let message = select! {
                recv(worker.done) -> done => {
                    if let Ok(done) = done {
                        self.finish(done, connection)?;
                    }
                    continue;
                }
                recv(connection.receiver) -> message => match message {
                    Ok(message) => message,
                    Err(_) => return Ok(()),
                },
            };
            // Of many keys that were pressed meanwhile only the last text is compiled.
            let mut dirty = false;
            let mut next = Some(message);
            while let Some(message) = next {
                match message {
                    Message::Request(request) if connection.handle_shutdown(&request)? => return Ok(()),
                    Message::Request(request) => {
                        if let Some(answer) = self.answer(request, worker) {
                            connection.sender.send(answer.into())?;
                        }
                    }
                    Message::Notification(notification) => {
                        if self.hear(notification) {
                            dirty = true;
                            self.newest.fetch_add(1, Ordering::Relaxed);
                        }
                    }
                    Message::Response(_) => {}
                }
                next = connection.receiver.try_recv().ok();
            }
            if dirty {
                worker.put(Job::Check { forget: std::mem::take(&mut self.forget) }, self.snapshot());
            }
        }
    }

    fn snapshot(&self) -> Snapshot {
        let number = self.newest.load(Ordering::Relaxed);
        Snapshot { open: self.open.clone(), number, newest: self.newest.clone() }
    }

    /// Takes over what the other thread has done.
    fn finish(&mut self, done: Done, connection: &Connection) -> Result<(), Broken> {
        match done {
            Done::Answered(answer) => {
                self.waiting.remove(&answer.id);
                connection.sender.send(answer.into())?;
            }
            // Of texts that have changed since, the next compilation knows more.
            Done::Checked(number, known) if number == self.newest.load(Ordering::Relaxed) => {
                self.known = *known;
                self.publish(connection)?;
            }
            Done::Checked(..) => {}
        }
        Ok(())
    }

    /// Takes over what the editor says; whether models must be compiled anew.
    fn hear(&mut self, notification: Notification) -> bool {
        let Notification { method, params } = notification;
        match method.as_str() {
            DidOpenTextDocument::METHOD => read(params).is_some_and(|message: DidOpenTextDocumentParams| {
                let item = message.text_document;
                path_of(&item.uri).is_some_and(|path| {
                    self.forget.push(path.clone());
                    self.put(path, &item.text, item.version)
                })
            }),
            DidChangeTextDocument::METHOD => {
                read(params).is_some_and(|message: DidChangeTextDocumentParams| {
                    let Some(path) = path_of(&message.text_document.uri) else { return false };
                    let Some(document) = self.open.get(&path) else { return false };
                    let text =
                        message.content_changes.iter().fold(document.text.to_string(), |t, c| changed(&t, c));
                    self.put(path, &text, message.text_document.version)
                })
            }
            DidSaveTextDocument::METHOD => read(params).is_some_and(|message: DidSaveTextDocumentParams| {
                // Files that name each other may have changed on the disk.
                path_of(&message.text_document.uri).is_some_and(|path| {
                    let is_open = self.open.contains_key(&path);
                    self.forget.push(path);
                    is_open
                })
            }),
            DidCloseTextDocument::METHOD => {
                read(params).is_some_and(|message: DidCloseTextDocumentParams| {
                    path_of(&message.text_document.uri).is_some_and(|path| {
                        Arc::make_mut(&mut self.open).remove(&path);
                        self.forget.push(path);
                        true
                    })
                })
            }
            DidChangeWatchedFiles::METHOD => {
                read(params).is_some_and(|message: DidChangeWatchedFilesParams| {
                    self.forget.extend(message.changes.iter().filter_map(|change| path_of(&change.uri)));
                    !self.open.is_empty()
                })
            }
            Cancel::METHOD => {
                let number = params.get("id").and_then(Value::as_i64).map(|id| RequestId::from(id as i32));
                let text = params.get("id").and_then(Value::as_str).map(|id| RequestId::from(id.to_owned()));
                // Of a request that has been answered nothing is kept.
                if let Some(id) = number.or(text).filter(|id| self.waiting.contains(id))
                    && let Ok(mut cancelled) = self.cancelled.lock()
                {
                    cancelled.insert(id.to_string());
                }
                false
            }
            _ => false,
        }
    }

    fn put(&mut self, path: PathBuf, text: &str, version: i32) -> bool {
        // What was to be changed may be elsewhere now.
        self.known.fixes.remove(&path);
        Arc::make_mut(&mut self.open).insert(path, Document { text: text.into(), version });
        true
    }

    /// Tells the problems that were found; of files that have none any more, too.
    fn publish(&mut self, connection: &Connection) -> Result<(), Broken> {
        let mut found = std::mem::take(&mut self.known.found);
        for gone in std::mem::take(&mut self.published) {
            found.entry(gone).or_default();
        }
        for (path, diagnostics) in found {
            let Some(uri) = uri_of(&path) else { continue };
            let version = self.open.get(&path).map(|document| document.version);
            if !diagnostics.is_empty() {
                self.published.insert(path);
            }
            let params = PublishDiagnosticsParams { uri, diagnostics, version };
            let message = Notification::new(PublishDiagnostics::METHOD.to_owned(), params);
            connection.sender.send(message.into())?;
        }
        Ok(())
    }

    /// The answer to a request, unless the other thread gives it.
    fn answer(&mut self, request: Request, worker: &Worker) -> Option<Response> {
        let Request { id, method, params } = request;
        let answer = match method.as_str() {
            Completion::METHOD => self.at(
                id,
                params,
                |request: CompletionParams| request.text_document_position,
                |place| {
                    let Place { text, at, path } = place;
                    let folder = path.parent().unwrap_or(path);
                    let Known { blocks, choices, .. } = &self.known;
                    let all =
                        complete(text, at, blocks.get(path), choices, folder, self.snippets, self.prose);
                    json!(all.into_iter().map(item).collect::<Vec<_>>())
                },
            ),
            HoverRequest::METHOD => {
                let place = |request: HoverParams| request.text_document_position_params;
                return self.hover(id, params, place, worker);
            }
            GotoDefinition::METHOD => {
                let place = |request: GotoDefinitionParams| request.text_document_position_params;
                return self.definition(id, params, place, worker);
            }
            References::METHOD => {
                let Some(request) = read::<ReferenceParams>(params) else { return Some(wrong(id)) };
                let with_declaration = request.context.include_declaration;
                let request = (request.text_document_position, Query::References { with_declaration });
                return self.hand_over(id, request, worker);
            }
            PrepareRenameRequest::METHOD => {
                let Some(place) = read::<TextDocumentPositionParams>(params) else { return Some(wrong(id)) };
                return self.hand_over(id, (place, Query::Prepare), worker);
            }
            Rename::METHOD => {
                let Some(request) = read::<RenameParams>(params) else { return Some(wrong(id)) };
                let request = (request.text_document_position, Query::Rename { new: request.new_name });
                return self.hand_over(id, request, worker);
            }
            DocumentSymbolRequest::METHOD => match read::<DocumentSymbolParams>(params) {
                Some(request) => {
                    let path = path_of(&request.text_document.uri);
                    let text = path.and_then(|path| self.text(&path)).unwrap_or_default();
                    Response::new_ok(id, DocumentSymbolResponse::Nested(outline(text)))
                }
                None => wrong(id),
            },
            CodeActionRequest::METHOD => match read::<CodeActionParams>(params) {
                Some(request) => {
                    let uri = &request.text_document.uri;
                    let path = path_of(uri).unwrap_or_default();
                    let fixes = self.known.fixes.get(&path).map(Vec::as_slice).unwrap_or_default();
                    let mut all = offered(fixes, uri, &request.range);
                    let text = self.text(&path).unwrap_or_default();
                    all.extend(refactor::offered(text, uri, &request.range, self.takes));
                    Response::new_ok(id, all)
                }
                None => wrong(id),
            },
            CodeActionResolveRequest::METHOD => return self.resolve(id, params, worker),
            Formatting::METHOD => match read::<DocumentFormattingParams>(params) {
                Some(request) => {
                    let path = path_of(&request.text_document.uri);
                    let edits = path.and_then(|path| laid_out(self.text(&path)?));
                    Response::new_ok(id, edits)
                }
                None => wrong(id),
            },
            other => {
                Response::new_err(id, ErrorCode::MethodNotFound as i32, format!("`{other}` is not offered"))
            }
        };
        Some(answer)
    }

    fn text(&self, path: &Path) -> Option<&str> {
        self.open.get(path).map(|document| &*document.text)
    }

    /// The place of an open file that a request names.
    fn place(&self, request: &TextDocumentPositionParams) -> Option<Place<'_>> {
        let (path, document) = self.open.get_key_value(&path_of(&request.text_document.uri)?)?;
        Some(Place { text: &document.text, at: offset(&document.text, request.position), path })
    }

    /// Answers a question about a place of an open file; with nothing if the file is not open.
    fn at<P: serde::de::DeserializeOwned>(
        &self,
        id: RequestId,
        params: Value,
        place: impl Fn(P) -> TextDocumentPositionParams,
        answer: impl Fn(Place) -> Value,
    ) -> Response {
        let Some(request) = read(params).map(place) else { return wrong(id) };
        Response::new_ok(id, self.place(&request).map_or(Value::Null, answer))
    }

    /// Leaves a question to the other thread; answers with nothing if the file is not open.
    fn hand_over(
        &mut self,
        id: RequestId,
        (place, query): (TextDocumentPositionParams, Query),
        worker: &Worker,
    ) -> Option<Response> {
        let Some(Place { at, path, .. }) = self.place(&place) else {
            return Some(Response::new_ok(id, Value::Null));
        };
        let job = Job::Answer { id: id.clone(), path: path.to_owned(), at, query };
        worker.put(job, self.snapshot());
        self.waiting.insert(id);
        None
    }

    /// Leaves it to the other thread what a chosen action comes to.
    fn resolve(&mut self, id: RequestId, action: Value, worker: &Worker) -> Option<Response> {
        let uri = action["data"]["uri"].as_str().and_then(|uri| uri.parse().ok());
        let Some(path) = uri.as_ref().and_then(path_of).filter(|path| self.open.contains_key(path)) else {
            return Some(wrong(id));
        };
        let query = Query::Refactor { action: Box::new(action) };
        worker.put(Job::Answer { id: id.clone(), path, at: 0, query }, self.snapshot());
        self.waiting.insert(id);
        None
    }

    /// What stands at a place: from the text and what is known of blocks, or from the other files of the model.
    fn hover<P: serde::de::DeserializeOwned>(
        &mut self,
        id: RequestId,
        params: Value,
        place: impl Fn(P) -> TextDocumentPositionParams,
        worker: &Worker,
    ) -> Option<Response> {
        let Some(request) = read(params).map(place) else { return Some(wrong(id)) };
        let found = self.place(&request).map(|Place { text, at, path }| {
            let here = hover(text, at, self.known.blocks.get(path), self.prose);
            (here, context(text, at) == Context::Expression)
        });
        match found {
            Some((None, true)) => self.hand_over(id, (request, Query::Hover), worker),
            found => Some(Response::new_ok(id, found.and_then(|(here, _)| here))),
        }
    }

    /// Where it is declared what stands at a place: in this text or, of parameters of diagrams around it and of ports of
    /// subsystems, in another one.
    fn definition<P: serde::de::DeserializeOwned>(
        &mut self,
        id: RequestId,
        params: Value,
        place: impl Fn(P) -> TextDocumentPositionParams,
        worker: &Worker,
    ) -> Option<Response> {
        let Some(request) = read(params).map(place) else { return Some(wrong(id)) };
        let Some(Place { text, at, path }) = self.place(&request) else {
            return Some(Response::new_ok(id, Value::Null));
        };
        let here = path.parent().and_then(|folder| definition(text, at, folder));
        let here = here.and_then(|target| match target {
            Target::Here(bytes) => Some(Location::new(uri_of(path)?, span(text, &bytes))),
            Target::File(file) => Some(Location::new(uri_of(&file.canonicalize().ok()?)?, Span::default())),
        });
        let is_elsewhere = match context(text, at) {
            Context::Connection { before } => {
                before.rsplit(['>', ',']).next().is_some_and(|b| b.contains('.'))
            }
            Context::Expression => here.is_none(),
            _ => false,
        };
        if is_elsewhere {
            return self.hand_over(id, (request, Query::Definition { otherwise: here }), worker);
        }
        Some(Response::new_ok(id, here))
    }
}

/// Folders that the editor has open.
#[expect(deprecated, reason = "older editors name one folder alone")]
fn folders(request: &InitializeParams) -> Vec<PathBuf> {
    match &request.workspace_folders {
        Some(folders) => folders.iter().filter_map(|folder| path_of(&folder.uri)).collect(),
        None => request.root_uri.iter().filter_map(path_of).collect(),
    }
}

/// A place of an open file.
struct Place<'a> {
    text: &'a str,
    /// Byte.
    at: usize,
    path: &'a Path,
}

fn read<P: serde::de::DeserializeOwned>(params: Value) -> Option<P> {
    serde_json::from_value(params).ok()
}

fn wrong(id: RequestId) -> Response {
    Response::new_err(id, ErrorCode::InvalidParams as i32, "the parameters do not fit the request".to_owned())
}

fn capabilities() -> ServerCapabilities {
    ServerCapabilities {
        text_document_sync: Some(TextDocumentSyncCapability::Options(TextDocumentSyncOptions {
            open_close: Some(true),
            change: Some(TextDocumentSyncKind::INCREMENTAL),
            save: Some(true.into()),
            ..TextDocumentSyncOptions::default()
        })),
        completion_provider: Some(CompletionOptions {
            trigger_characters: Some(["\"", ".", "(", " ", "/"].map(str::to_owned).to_vec()),
            ..CompletionOptions::default()
        }),
        hover_provider: Some(HoverProviderCapability::Simple(true)),
        definition_provider: Some(OneOf::Left(true)),
        references_provider: Some(OneOf::Left(true)),
        rename_provider: Some(OneOf::Right(RenameOptions {
            prepare_provider: Some(true),
            work_done_progress_options: WorkDoneProgressOptions::default(),
        })),
        document_symbol_provider: Some(OneOf::Left(true)),
        code_action_provider: Some(CodeActionProviderCapability::Options(CodeActionOptions {
            resolve_provider: Some(true),
            ..CodeActionOptions::default()
        })),
        document_formatting_provider: Some(OneOf::Left(true)),
        ..ServerCapabilities::default()
    }
}

/// Whether the editor asks for the changes of an action when it is chosen, and makes files.
fn takes_changes(request: &InitializeParams) -> Takes {
    let actions = request.capabilities.text_document.as_ref().and_then(|text| text.code_action.as_ref());
    let resolves = actions.and_then(|actions| actions.resolve_support.as_ref());
    let later = resolves.is_some_and(|support| support.properties.iter().any(|property| property == "edit"));
    let edits =
        request.capabilities.workspace.as_ref().and_then(|workspace| workspace.workspace_edit.as_ref());
    let documents = edits.and_then(|edits| edits.document_changes).unwrap_or(false);
    let operations = edits.and_then(|edits| edits.resource_operations.clone()).unwrap_or_default();
    Takes { later: later && documents, new_files: operations.contains(&ResourceOperationKind::Create) }
}

fn takes_snippets(request: &InitializeParams) -> bool {
    let item = || {
        request
            .capabilities
            .text_document
            .as_ref()?
            .completion
            .as_ref()?
            .completion_item
            .as_ref()?
            .snippet_support
    };
    item().unwrap_or(false)
}
