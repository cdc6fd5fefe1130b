//! Changes of diagrams as changes of their texts: what somebody does to a picture, done to the file that it is drawn from.
//! Comments, the order of the entries and the layout stay; what is against a change is said before anything is written.
//!
//! Each change is a function from the texts of a [`Project`] to a [`Change`] or a [`Refusal`]. Command line, language server
//! and studio write it, each in its way. What an editor asks about a half-written text is here as well ([`complete`]), so that
//! all of them answer alike.
//!
//! | file | idea |
//! |---|---|
//! | `text` | entries between brackets and connections, taken out and put in |
//! | `project` | a model, its levels, the other models that share its files |
//! | `names` | names across files: declarations, references, new names |
//! | `rename`, `delete`, `connect`, `add`, `wrap` | a change each |
//! | `declared`, `complete` | what a text declares, and what may follow in it |

mod add;
mod change;
mod complete;
mod connect;
mod declared;
mod delete;
mod ends;
mod mentions;
mod names;
mod project;
mod refusal;
mod rename;
mod text;
mod wrap;

pub use add::{Field, NewBlock, add, proposed_name, required};
pub use change::{Change, TextChange};
pub use complete::{
    Blocks, Completion, CompletionKind, Context, Facts, Learned, Port, Prose, about, complete, context,
    is_of_reference, kind, side,
};
pub use connect::connect;
pub use declared::{Declared, Section, declared};
pub use delete::{delete, disconnect_end};
pub use names::{Meant, Renaming, Spot, check_name, meant, renamable, renamed};
pub use project::{Project, instance_of, is_whole};
pub use refusal::Refusal;
pub use rename::rename;
pub use wrap::wrap;

#[cfg(test)]
mod tests;
