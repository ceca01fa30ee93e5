//! The parts of the window that are looked at and clicked on. A panel is shown the session and returns what it wants as
//! asks; it changes nothing itself.

pub mod button;
pub mod canvas;
pub mod field;
pub mod format;
pub mod gallery;
pub mod guide;
pub mod inspector;
pub mod keys;
pub mod legend;
pub mod menu;
pub mod mesh_scene;
pub mod notice;
pub mod offer;
pub mod palette;
pub mod plots;
pub mod port;
pub mod question;
pub mod runs;
pub mod scene;
pub mod slices;
pub mod space;
pub mod timeline;
pub mod toolbar;
pub mod view_bar;
