//! What the window knows: the document, how it is looked at, what is remembered.

pub mod command;
pub mod critical;
pub mod document;
pub mod errand;
pub mod format;
pub mod settings;
pub mod truth;
pub mod view;
