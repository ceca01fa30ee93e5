//! What the window keeps and is given in files: settings, unsaved work, the question for a path, exports.

pub(crate) mod dialog;
pub(crate) mod export;
pub(crate) mod film;
pub(crate) mod home;
pub(crate) mod preview;
pub(crate) mod recovery;
