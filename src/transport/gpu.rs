//! Light on a graphics card, with the bits of the processor's loops.

pub mod card;
pub mod device;
pub mod export;
pub mod layout;
mod pipeline;
pub mod porting;
pub mod text;
pub mod volume;
