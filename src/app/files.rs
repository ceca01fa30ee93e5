//! What the window keeps and is given in files: settings, unsaved work, the question for a path, exports.

pub mod dialog;
pub mod export;
pub mod film;
pub mod home;
pub mod preview;
pub mod recovery;
