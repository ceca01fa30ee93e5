//! The parts of the window that are looked at and clicked on.

pub mod closing;
pub mod compare;
pub mod controls;
pub mod errors;
pub mod inspect;
pub mod inspector;
pub mod layout;
pub mod legend;
pub mod line;
pub mod menu;
pub mod pareto;
pub mod plots;
pub mod stage;
pub mod timeline;
pub mod toolbar;
