//! The models of one viewer.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use serde_json::{Value, json};

use crate::model_request::ModelRequest;
use crate::model_workspace::ModelWorkspace;

/// The models that a viewer may edit, and its check in progress.
pub(crate) struct ModelSession {
    workspace: Arc<ModelWorkspace>,
    may_write: bool,
    /// Cancels the check in progress.
    stop: Arc<AtomicBool>,
    checked: Receiver<Value>,
    sender: Sender<Value>,
}

impl ModelSession {
    pub(crate) fn new(workspace: Arc<ModelWorkspace>, may_write: bool) -> ModelSession {
        let (sender, checked) = channel();
        ModelSession { workspace, may_write, stop: Arc::default(), checked, sender }
    }

    /// The first message to a page.
    pub(crate) fn greeting(&self) -> Value {
        json!({"type": "models", "files": self.workspace.names(), "writable": self.may_write})
    }

    /// Handles a request. Returns the reply; a check replies later.
    pub(crate) fn handle(&mut self, id: Option<u64>, request: Result<ModelRequest, String>) -> Option<Value> {
        let result = match request {
            Ok(ModelRequest::Check { file, text }) => return self.check(id, file, text),
            Ok(request) => self.answer(request),
            Err(reason) => Err(format!("the request cannot be read: {reason}")),
        };
        Some(numbered(id, result))
    }

    /// The reply of a finished check.
    pub(crate) fn checked(&mut self) -> Option<Value> {
        self.checked.try_recv().ok()
    }

    fn answer(&self, request: ModelRequest) -> Result<Value, String> {
        let language = self.workspace.language();
        match request {
            ModelRequest::Open { file } => self.workspace.open(file),
            ModelRequest::Outline { file, text } => Ok(language.outline(self.workspace.name(file)?, &text)),
            ModelRequest::Complete { text, expression, at } => {
                Ok(language.complete(&text, expression.as_deref(), at))
            }
            ModelRequest::Edit { text, edit } => language.edit(&text, edit),
            ModelRequest::Save { .. } if !self.may_write => {
                Err("files are not written for other computers without --allow-control".into())
            }
            ModelRequest::Save { file, text, revision } => self.workspace.save(file, &text, &revision),
            ModelRequest::Check { .. } => Err("a check replies later".into()),
        }
    }

    /// Checks a text on a thread of its own; replaces the check in progress.
    fn check(&mut self, id: Option<u64>, file: usize, text: String) -> Option<Value> {
        self.stop.store(true, Ordering::SeqCst);
        self.stop = Arc::default();
        let name = match self.workspace.name(file) {
            Ok(name) => name.to_owned(),
            Err(reason) => return Some(numbered(id, Err(reason))),
        };
        let (workspace, sender, stop) = (self.workspace.clone(), self.sender.clone(), self.stop.clone());
        let check = move || {
            let found = workspace.language().check(&name, &text, &stop);
            // A disconnected page needs no reply.
            let _ = sender.send(numbered(id, Ok(found)));
        };
        let started = thread::Builder::new().name("studio check".into()).spawn(check);
        started.err().map(|error| numbered(id, Err(error.to_string())))
    }
}

impl Drop for ModelSession {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::SeqCst);
    }
}

/// A reply with the number of its request.
fn numbered(id: Option<u64>, result: Result<Value, String>) -> Value {
    let mut reply = result.unwrap_or_else(|reason| json!({"done": false, "reason": reason}));
    (reply["type"], reply["id"]) = (json!("reply"), json!(id));
    reply
}
