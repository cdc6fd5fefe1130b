//! RON text as a tree with places, and its usual layout.
//!
//! ```text
//! text ─Tokens─▶ Token ─read──▶ Node           values and names with their places, for the compiler and all who change texts
//!                     ├─format─▶ text          blanks, lines and commas by rule, with every comment
//!                     └─scan───▶ Around        what is around a place of a text that somebody is writing
//! ```

mod around;
mod error;
mod format;
mod mistakes;
mod parse;
mod read;
mod scalar;
mod token;
mod tree;

pub use around::{Around, Event, Open, run_at, scan};
pub use error::{Remedy, SyntaxError};
pub use format::{WIDTH, format};
pub use read::read;
pub use token::{Token, TokenKind, Tokens, is_word};
pub use tree::{Name, Node, Shape};
