//! Diagrams in editors: a server of the Language Server Protocol.
//!
//! While somebody writes, the server compiles the models that the open files belong to and tells their problems; it
//! completes kinds, parameters, ports and names, shows what stands under the cursor, and goes to its declaration.
//!
//! What can be answered while a text is half written comes from its words and brackets alone (`blocksim_edit`); what needs
//! the diagram, such as the ports of a block, from the last time that it could be read (`models`).
//!
//! | file | idea |
//! |---|---|
//! | `server` | messages in, messages out |
//! | `work` | the thread that compiles, and answers what needs whole models |
//! | `texts` | texts as the editor has them, before the disk |
//! | `models` | which model a file belongs to, its problems, its blocks; each text is parsed once |
//! | `meanings` | names across files: declarations, references, new names |
//! | `complete`, `hover`, `definition`, `outline`, `formatting`, `fixes` | an answer each |
//! | `refactor` | changes of whole diagrams: blocks that go, blocks that become a subsystem |
//! | `position`, `uri` | places and files as the protocol writes them |

mod complete;
mod definition;
mod fixes;
mod formatting;
mod hover;
mod meanings;
mod models;
mod outline;
mod position;
mod refactor;
mod server;
mod texts;
mod uri;
mod work;

pub use server::{Server, serve};
