//! Messages in, messages out.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use blocksim_block::CodePolicy;
use lsp_server::{Connection, ErrorCode, Message, Notification, Request, RequestId, Response};
use lsp_types::notification::{
    DidChangeTextDocument, DidCloseTextDocument, DidOpenTextDocument, DidSaveTextDocument, Notification as _,
    PublishDiagnostics,
};
use lsp_types::request::{
    CodeActionRequest, Completion, DocumentSymbolRequest, Formatting, GotoDefinition, HoverRequest,
    Request as _,
};
use lsp_types::{
    CodeActionParams, CodeActionProviderCapability, CompletionOptions, CompletionParams,
    DidChangeTextDocumentParams, DidCloseTextDocumentParams, DidOpenTextDocumentParams,
    DidSaveTextDocumentParams, DocumentFormattingParams, DocumentSymbolParams, DocumentSymbolResponse,
    GotoDefinitionParams, GotoDefinitionResponse, HoverParams, HoverProviderCapability, InitializeParams,
    Location, OneOf, PublishDiagnosticsParams, Range as Span, ServerCapabilities, TextDocumentPositionParams,
    TextDocumentSyncCapability, TextDocumentSyncKind, TextDocumentSyncOptions, Uri,
};
use serde_json::{Value, json};

use crate::complete::complete;
use crate::definition::{Target, definition};
use crate::fixes::offered;
use crate::formatting::laid_out;
use crate::hover::hover;
use crate::library::Prose;
use crate::models::Models;
use crate::outline::outline;
use crate::position::{offset, span};
use crate::texts::Texts;
use crate::uri::{path_of, uri_of};

/// What has gone wrong between the editor and the server.
type Broken = Box<dyn std::error::Error + Send + Sync>;

/// Serves an editor on the standard input and output until it says that it ends. To open a file is not to run it: `code` decides
/// whether plug-ins are built and loaded.
///
/// # Errors
/// If the editor breaks the protocol, or goes away without a word.
pub fn serve(prose: Prose, code: Box<dyn CodePolicy>) -> Result<(), Broken> {
    let (connection, threads) = Connection::stdio();
    Server::new(prose, code).run(&connection)?;
    drop(connection);
    threads.join()?;
    Ok(())
}

/// What the server knows of an editor and its files.
pub struct Server {
    texts: Texts,
    models: Models,
    /// Files that were said to have problems.
    told: BTreeSet<PathBuf>,
    prose: Prose,
    /// Whether the editor fills in places to be written.
    snippets: bool,
}

impl Server {
    /// A server that knows nothing yet; `prose` makes text for people of the Markdown of the manual, `code` decides
    /// what becomes of plug-ins.
    pub fn new(prose: Prose, code: Box<dyn CodePolicy>) -> Server {
        Server {
            texts: Texts::new(code),
            models: Models::default(),
            told: BTreeSet::new(),
            prose,
            snippets: false,
        }
    }

    /// Serves one editor until it says that it ends.
    ///
    /// # Errors
    /// As of [`serve`].
    pub fn run(&mut self, connection: &Connection) -> Result<(), Broken> {
        let (id, asked) = connection.initialize_start()?;
        let asked: InitializeParams = serde_json::from_value(asked)?;
        self.snippets = takes_snippets(&asked);
        let about = json!({ "name": "blocksim", "version": env!("CARGO_PKG_VERSION") });
        connection.initialize_finish(id, json!({ "capabilities": capabilities(), "serverInfo": about }))?;
        while let Ok(message) = connection.receiver.recv() {
            // Of many keys that were pressed meanwhile only the last text is compiled.
            let mut dirty = false;
            let mut next = Some(message);
            while let Some(message) = next {
                match message {
                    Message::Request(request) if connection.handle_shutdown(&request)? => return Ok(()),
                    Message::Request(request) => connection.sender.send(self.answer(request).into())?,
                    Message::Notification(notification) => dirty |= self.hear(notification),
                    Message::Response(_) => {}
                }
                next = connection.receiver.try_recv().ok();
            }
            if dirty {
                self.tell(connection)?;
            }
        }
        Ok(())
    }

    /// Takes over what the editor says; whether models must be compiled anew.
    fn hear(&mut self, notification: Notification) -> bool {
        let Notification { method, params } = notification;
        match method.as_str() {
            DidOpenTextDocument::METHOD => read(params).is_some_and(|said: DidOpenTextDocumentParams| {
                self.take(&said.text_document.uri, said.text_document.text)
            }),
            DidChangeTextDocument::METHOD => read(params).is_some_and(|said: DidChangeTextDocumentParams| {
                let last = said.content_changes.into_iter().last();
                last.is_some_and(|change| self.take(&said.text_document.uri, change.text))
            }),
            DidSaveTextDocument::METHOD => read(params).is_some_and(|said: DidSaveTextDocumentParams| {
                // Files that name each other may have changed on the disk.
                path_of(&said.text_document.uri).is_some_and(|path| {
                    self.models.forget(&path);
                    self.texts.get(&path).is_some()
                })
            }),
            DidCloseTextDocument::METHOD => read(params).is_some_and(|said: DidCloseTextDocumentParams| {
                path_of(&said.text_document.uri).is_some_and(|path| {
                    self.texts.close(&path);
                    self.models.forget(&path);
                    true
                })
            }),
            _ => false,
        }
    }

    fn take(&mut self, uri: &Uri, text: String) -> bool {
        let path = path_of(uri);
        path.is_some_and(|path| {
            self.texts.put(path, text);
            true
        })
    }

    /// Compiles what is open and tells the problems; of files that have none any more, too.
    fn tell(&mut self, connection: &Connection) -> Result<(), Broken> {
        let mut found = self.models.look(&self.texts);
        for gone in std::mem::take(&mut self.told) {
            found.entry(gone).or_default();
        }
        for (path, diagnostics) in found {
            let Some(uri) = uri_of(&path) else { continue };
            if !diagnostics.is_empty() {
                self.told.insert(path);
            }
            let params = PublishDiagnosticsParams { uri, diagnostics, version: None };
            let told = Notification::new(PublishDiagnostics::METHOD.to_owned(), params);
            connection.sender.send(told.into())?;
        }
        Ok(())
    }

    fn answer(&self, request: Request) -> Response {
        let Request { id, method, params } = request;
        match method.as_str() {
            Completion::METHOD => self.at(
                id,
                params,
                |asked: CompletionParams| asked.text_document_position,
                |place| {
                    let Place { text, at, path } = place;
                    let folder = path.parent().unwrap_or(path);
                    json!(complete(text, at, self.models.blocks(path), folder, self.snippets, self.prose))
                },
            ),
            HoverRequest::METHOD => self.at(
                id,
                params,
                |asked: HoverParams| asked.text_document_position_params,
                |place| json!(hover(place.text, place.at, self.models.blocks(place.path), self.prose)),
            ),
            GotoDefinition::METHOD => self.at(
                id,
                params,
                |asked: GotoDefinitionParams| asked.text_document_position_params,
                |place| json!(self.definition(&place)),
            ),
            DocumentSymbolRequest::METHOD => match read::<DocumentSymbolParams>(params) {
                Some(asked) => {
                    let path = path_of(&asked.text_document.uri);
                    let text = path.and_then(|path| self.texts.get(&path)).unwrap_or_default();
                    Response::new_ok(id, DocumentSymbolResponse::Nested(outline(text)))
                }
                None => wrong(id),
            },
            CodeActionRequest::METHOD => match read::<CodeActionParams>(params) {
                Some(asked) => {
                    let uri = &asked.text_document.uri;
                    let path = path_of(uri).unwrap_or_default();
                    Response::new_ok(id, offered(self.models.fixes(&path), uri, &asked.range))
                }
                None => wrong(id),
            },
            Formatting::METHOD => match read::<DocumentFormattingParams>(params) {
                Some(asked) => {
                    let path = path_of(&asked.text_document.uri);
                    let edits = path.and_then(|path| laid_out(self.texts.get(&path)?));
                    Response::new_ok(id, edits)
                }
                None => wrong(id),
            },
            other => {
                Response::new_err(id, ErrorCode::MethodNotFound as i32, format!("`{other}` is not offered"))
            }
        }
    }

    /// Answers a question about a place of an open file; with nothing if the file is not open.
    fn at<P: serde::de::DeserializeOwned>(
        &self,
        id: RequestId,
        params: Value,
        place: impl Fn(P) -> TextDocumentPositionParams,
        answer: impl Fn(Place) -> Value,
    ) -> Response {
        let Some(asked) = read(params).map(place) else { return wrong(id) };
        let path = path_of(&asked.text_document.uri);
        let found = path.as_ref().and_then(|path| Some((path, self.texts.get(path)?)));
        match found {
            Some((path, text)) => {
                Response::new_ok(id, answer(Place { text, at: offset(text, asked.position), path }))
            }
            None => Response::new_ok(id, Value::Null),
        }
    }

    fn definition(&self, place: &Place) -> Option<GotoDefinitionResponse> {
        let Place { text, at, path } = place;
        let location = match definition(text, *at, path.parent()?)? {
            Target::Here(bytes) => Location::new(uri_of(path)?, span(text, &bytes)),
            Target::File(file) => Location::new(uri_of(&file.canonicalize().ok()?)?, Span::default()),
        };
        Some(GotoDefinitionResponse::Scalar(location))
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
            change: Some(TextDocumentSyncKind::FULL),
            save: Some(true.into()),
            ..TextDocumentSyncOptions::default()
        })),
        completion_provider: Some(CompletionOptions {
            trigger_characters: Some(["\"", ".", "(", " ", "/"].map(str::to_owned).to_vec()),
            ..CompletionOptions::default()
        }),
        hover_provider: Some(HoverProviderCapability::Simple(true)),
        definition_provider: Some(OneOf::Left(true)),
        document_symbol_provider: Some(OneOf::Left(true)),
        code_action_provider: Some(CodeActionProviderCapability::Simple(true)),
        document_formatting_provider: Some(OneOf::Left(true)),
        ..ServerCapabilities::default()
    }
}

fn takes_snippets(asked: &InitializeParams) -> bool {
    let item = || {
        asked
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
