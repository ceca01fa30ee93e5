//! Light on a graphics card, with the bits of the processor's loops.

pub(crate) mod card;
pub(crate) mod device;
pub(crate) mod export;
pub(crate) mod layout;
mod pipeline;
pub(crate) mod porting;
pub(crate) mod text;
pub(crate) mod volume;

pub use device::Device;
