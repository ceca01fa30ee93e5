//! What the window keeps and is given in files: settings, unsaved work, dialogs, drops, exports.

pub mod dialog;
pub mod drops;
pub mod export;
pub mod home;
pub mod recovery;
