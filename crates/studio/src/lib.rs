//! Serves the page of a project to a browser on the same computer: addresses, who may ask, news that are pushed, scripts and
//! styles. What is asked is answered by a [`Desk`], who alone knows of models, runs and files.
//!
//! The server is made for one person: it listens on 127.0.0.1 alone, and answers nobody who does not know the token that the
//! program prints. That any page of the web can send requests to 127.0.0.1 is why names of hosts and origins are checked as
//! well (DNS rebinding, requests across sites).
//!
//! A thread for each connection, one request in each, and server-sent events serve it: news in one direction and requests in the
//! other need neither web sockets nor an asynchronous runtime. `httparse` reads requests.

mod assets;
mod door;
mod http;
mod news;
mod page;
mod serve;
mod token;

pub use news::News;
pub use serve::{Server, Started, address};
pub use token::Token;

use serde_json::Value;

/// Who answers.
pub trait Desk: Send + Sync {
    /// What stands at a path below `/api/`, which is given without it.
    fn look(&self, path: &str) -> Reply;

    /// Does what is asked for at a path below `/api/`; `body` is what was sent.
    fn act(&self, path: &str, body: &Value) -> Reply;

    /// A page of its own at a path below `/runs/`, that of a run or of two (`one~other`), whose scripts can reach nothing of the studio.
    fn run_page(&self, name: &str) -> Reply;
}

/// An answer.
#[derive(Debug, Clone, PartialEq)]
pub enum Reply {
    /// Data.
    Data(Value),
    /// Data as text, made before.
    Text(std::sync::Arc<str>),
    /// A page that stands alone.
    Page(String),
    /// It cannot be done: what is wrong, in the terms of the person who asked.
    Refused(Value),
    /// There is nothing of this name.
    Missing,
}

impl Reply {
    /// It cannot be done, for a reason, and what helps.
    pub fn refused(message: impl Into<String>, help: impl Into<String>) -> Reply {
        Reply::Refused(serde_json::json!({ "message": message.into(), "help": help.into() }))
    }
}
