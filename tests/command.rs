//! Tests of the command in temporary folders: exit codes, messages and files.

#[path = "command/bad_input.rs"]
mod bad_input;
#[path = "command/curves.rs"]
mod curves;
#[path = "command/documents.rs"]
mod documents;
#[path = "command/folder.rs"]
mod folder;
#[path = "command/help.rs"]
mod help;
#[path = "command/interruption.rs"]
mod interruption;
#[path = "command/missing_files.rs"]
mod missing_files;
#[path = "command/remesh.rs"]
mod remesh;
#[path = "command/results.rs"]
mod results;
#[path = "command/stream.rs"]
mod stream;
