//! The parts of the window that are looked at and clicked on. A panel is shown the session and returns what it wants as
//! asks; it changes nothing itself.

pub(crate) mod button;
pub(crate) mod canvas;
pub(crate) mod field;
pub(crate) mod format;
pub(crate) mod gallery;
pub(crate) mod guide;
pub(crate) mod inspector;
pub(crate) mod keys;
pub(crate) mod legend;
pub(crate) mod menu;
pub(crate) mod mesh_scene;
pub(crate) mod notice;
pub(crate) mod offer;
pub(crate) mod palette;
pub(crate) mod plots;
pub(crate) mod port;
pub(crate) mod question;
pub(crate) mod runs;
pub(crate) mod scene;
pub(crate) mod slices;
pub(crate) mod space;
pub(crate) mod timeline;
pub(crate) mod toolbar;
pub(crate) mod view_bar;
