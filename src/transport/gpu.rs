//! Light on a graphics card, with the bits of the processor's loops.

pub(crate) mod card;
pub mod device;
pub(crate) mod export;
pub(crate) mod layout;
mod pipeline;
pub(crate) mod porting;
pub(crate) mod text;
pub(crate) mod volume;
