//! Programs as an editor asks about them: the language server without its streams.
//!
//! All that is said comes from [`jobs`], as the command says it: messages are those of the correction, a line's figures
//! those of the pages, places of subprograms those that the program takes. An [`Editor`] holds the texts that are
//! open and the machines they are for; messages of the protocol go in, answers come out. Work that takes its time
//! asks now and then whether somebody waits, and gives way: there are no threads here.

mod capabilities;
mod document;
mod follow;
mod hover;
mod machine;
mod messages;
mod outline;
mod place;
mod requests;

use std::collections::{BTreeMap, VecDeque};
use std::path::PathBuf;

use diagnostic::{Diagnostic, Language};
use jobs::message::Failure;
use jobs::options::JobOptions;
use lsp_server::{ErrorCode, Message, Notification, Request, Response};
use lsp_types::{
    DidChangeConfigurationParams, DidChangeTextDocumentParams, DidCloseTextDocumentParams,
    DidOpenTextDocumentParams, InitializeParams, MessageType, PublishDiagnosticsParams, ShowMessageParams,
    Uri,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

pub use document::Document;
pub use machine::Find;
use machine::{Machines, Told};
use messages::Marked;
use place::Place;

/// Whether somebody waits for what is to be done next.
pub type Stop<'s> = &'s dyn Fn() -> bool;

/// How far the conversation is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    New,
    Running,
    ShutDown,
}

/// A program that is open.
struct Open {
    place: Place,
    document: Document,
    version: i32,
    /// What was said of this text; `None` before it is checked.
    marked: Option<Vec<Marked>>,
}

/// The texts that are open, and the machines they are for.
pub struct Editor {
    stage: Stage,
    /// Whom `--lang` asked for.
    asked: Option<Language>,
    language: Language,
    folder: Option<PathBuf>,
    /// The settings that came before anything may be said of them.
    first: Value,
    machines: Machines,
    open: BTreeMap<Uri, Open>,
    /// To be checked, the one that was changed first in front.
    unchecked: VecDeque<Uri>,
}

impl Editor {
    /// Nothing open.
    ///
    /// * `asked` – the language of `--lang`, in which it speaks whatever the editor's is
    /// * `language` – that of the environment
    #[must_use]
    pub fn new(find: Find, asked: Option<Language>, language: Language) -> Self {
        let machines = Machines::new(find, JobOptions::default());
        let (open, unchecked) = (BTreeMap::new(), VecDeque::new());
        Self {
            stage: Stage::New,
            asked,
            language,
            folder: None,
            first: Value::Null,
            machines,
            open,
            unchecked,
        }
    }

    /// True where the editor said that it will end: an end without is a failure.
    #[must_use]
    pub fn is_shut_down(&self) -> bool {
        self.stage == Stage::ShutDown
    }

    /// Answers a request; `stop` says that it was cancelled.
    pub fn request(&mut self, request: Request, stop: Stop<'_>) -> Response {
        let Request { id, method, params } = request;
        let refused = |code: ErrorCode, why: &str| Response::new_err(id.clone(), code as i32, why.to_owned());
        match (self.stage, method.as_str()) {
            (Stage::New, "initialize") => {}
            (Stage::New, _) => return refused(ErrorCode::ServerNotInitialized, "not initialized"),
            (Stage::Running, "initialize") | (Stage::ShutDown, _) => {
                return refused(ErrorCode::InvalidRequest, "not at this stage");
            }
            (Stage::Running, _) => {}
        }
        if stop() {
            return refused(ErrorCode::RequestCanceled, "cancelled");
        }
        let answer = match method.as_str() {
            "initialize" => asked(params, |params| self.initialize(&params)),
            "shutdown" => {
                self.stage = Stage::ShutDown;
                Ok(Value::Null)
            }
            "textDocument/hover" => asked(params, |params| self.hover(&params, stop)),
            "textDocument/documentSymbol" => asked(params, |params| self.symbols(&params)),
            "textDocument/foldingRange" => asked(params, |params| self.folds(&params)),
            "textDocument/definition" => asked(params, |params| self.definition(&params)),
            "textDocument/codeAction" => asked(params, |params| self.actions(&params)),
            unknown => return refused(ErrorCode::MethodNotFound, unknown),
        };
        match answer {
            _ if stop() => refused(ErrorCode::RequestCanceled, "cancelled"),
            Ok(answer) => Response::new_ok(id, answer),
            Err(why) => refused(ErrorCode::InvalidParams, &why.to_string()),
        }
    }

    /// Takes in a notification; what is to be said at once.
    pub fn notify(&mut self, notification: Notification) -> Vec<Message> {
        let Notification { method, params } = notification;
        if self.stage != Stage::Running {
            return Vec::new();
        }
        // What is not understood is not answered: nobody waits for an answer to a notification.
        match method.as_str() {
            "initialized" => {
                let settings = std::mem::take(&mut self.first);
                return self.tell(&settings);
            }
            "textDocument/didOpen" => heard(params, |params| self.opened(params)),
            "textDocument/didChange" => heard(params, |params| self.changed(params)),
            "textDocument/didClose" => return self.closed(params),
            "textDocument/didSave" | "workspace/didChangeWatchedFiles" => self.look_again(),
            "workspace/didChangeConfiguration" => return self.configured(params),
            _ => {}
        }
        Vec::new()
    }

    /// Checks what was changed; `None` where nothing was, or somebody waits.
    pub fn check(&mut self, stop: Stop<'_>) -> Option<Message> {
        let uri = self.unchecked.front()?;
        let Some(open) = self.open.get_mut(uri) else {
            self.unchecked.pop_front();
            return None;
        };
        let machine = self.machines.of(open.place.path());
        let reports = messages::check(&open.document, &open.place, machine, stop)?;
        let marked = messages::marked(&open.document, &open.place, &reports, self.language);
        let diagnostics = marked.iter().map(|marked| marked.squiggle.clone()).collect();
        open.marked = Some(marked);
        self.unchecked.pop_front();
        let (uri, version) = (open.place.uri.clone(), Some(open.version));
        Some(published(PublishDiagnosticsParams { uri, diagnostics, version }))
    }

    /// True while something is to be checked.
    #[must_use]
    pub fn has_unchecked(&self) -> bool {
        !self.unchecked.is_empty()
    }

    /// What is said where a message of the protocol is too large to be read.
    #[must_use]
    pub fn too_large(&self, megabytes: u64) -> Message {
        self.shown(&messages::not_read(megabytes))
    }

    fn opened(&mut self, params: DidOpenTextDocumentParams) {
        let item = params.text_document;
        let (place, document) = (Place::of(&item.uri), Document::new(item.text));
        let open = Open { place, document, version: item.version, marked: None };
        self.open.insert(item.uri.clone(), open);
        self.queue(item.uri);
    }

    fn changed(&mut self, params: DidChangeTextDocumentParams) {
        let uri = params.text_document.uri;
        let Some(open) = self.open.get_mut(&uri) else { return };
        params.content_changes.into_iter().for_each(|change| open.document.change(change));
        open.version = params.text_document.version;
        open.marked = None;
        self.queue(uri);
    }

    fn closed(&mut self, params: Value) -> Vec<Message> {
        let Ok(params) = serde_json::from_value::<DidCloseTextDocumentParams>(params) else {
            return Vec::new();
        };
        let uri = params.text_document.uri;
        self.open.remove(&uri);
        self.unchecked.retain(|other| *other != uri);
        vec![published(PublishDiagnosticsParams { uri, diagnostics: Vec::new(), version: None })]
    }

    fn configured(&mut self, params: Value) -> Vec<Message> {
        let Ok(DidChangeConfigurationParams { settings }) = serde_json::from_value(params) else {
            return Vec::new();
        };
        let said = self.tell(settings.get("vpost").unwrap_or(&settings));
        self.look_again();
        said
    }

    /// Takes in the editor's settings; none of them are no settings.
    fn tell(&mut self, settings: &Value) -> Vec<Message> {
        if settings.as_object().is_none_or(serde_json::Map::is_empty) {
            return Vec::new();
        }
        let Told { options, language, wrong } = machine::told(settings, self.folder.as_deref());
        self.machines.tell(options);
        self.language = self.asked.or(language).unwrap_or(self.language);
        wrong.iter().flat_map(|failure| self.said(failure)).collect()
    }

    /// Files may be others now: all that is open is checked again.
    fn look_again(&mut self) {
        self.machines.forget();
        let all: Vec<Uri> = self.open.keys().cloned().collect();
        all.into_iter().for_each(|uri| self.queue(uri));
    }

    fn queue(&mut self, uri: Uri) {
        if !self.unchecked.contains(&uri) {
            self.unchecked.push_back(uri);
        }
    }

    fn initialize(&mut self, params: &InitializeParams) -> Value {
        self.stage = Stage::Running;
        let locale = params.locale.as_deref().map(Language::of_locale);
        self.language = self.asked.or(locale).unwrap_or(self.language);
        let folders = params.workspace_folders.iter().flatten().map(|folder| &folder.uri);
        #[expect(deprecated, reason = "editors that know no folders say it so")]
        let root = folders.chain(&params.root_uri).next();
        self.folder = root.and_then(place::path);
        self.first = params.initialization_options.clone().unwrap_or_default();
        capabilities::capabilities()
    }

    fn said(&self, failure: &Failure) -> Vec<Message> {
        failure.reports().iter().flat_map(|report| &report.diagnostics).map(|one| self.shown(one)).collect()
    }

    fn shown(&self, one: &Diagnostic) -> Message {
        let message = messages::text(one, self.language);
        said("window/showMessage", ShowMessageParams { typ: MessageType::ERROR, message })
    }
}

fn published(params: PublishDiagnosticsParams) -> Message {
    said("textDocument/publishDiagnostics", params)
}

fn said(method: &str, params: impl Serialize) -> Message {
    Message::Notification(Notification::new(method.to_owned(), params))
}

/// Parameters as the protocol has them, and what is answered to them.
fn asked<P: DeserializeOwned, A: Serialize>(
    params: Value,
    answer: impl FnOnce(P) -> A,
) -> Result<Value, serde_json::Error> {
    serde_json::to_value(answer(serde_json::from_value(params)?))
}

fn heard<P: DeserializeOwned>(params: Value, take: impl FnOnce(P)) {
    if let Ok(params) = serde_json::from_value(params) {
        take(params);
    }
}
