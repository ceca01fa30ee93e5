//! Choices that settings files keep by their place in a list: what follows an older program's number, and a number
//! beyond the list, is still read.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::report::colour::Paint;
use crate::report::glyph::Hue;
use crate::report::slice::Axis;

/// A choice out of a fixed list.
pub trait Listed: Copy + PartialEq + 'static {
    /// All that can be chosen; at least one.
    const LIST: &'static [Self];
}

impl Listed for Axis {
    const LIST: &'static [Self] = &Axis::ALL;
}

impl Listed for Paint {
    const LIST: &'static [Self] = &Paint::ALL;
}

impl Listed for Hue {
    const LIST: &'static [Self] = &Hue::ALL;
}

/// Writes the place of a choice.
pub fn serialize<T: Listed, S: Serializer>(choice: &T, serializer: S) -> Result<S::Ok, S::Error> {
    T::LIST.iter().position(|one| one == choice).unwrap_or_default().serialize(serializer)
}

/// Reads a place; one beyond the list's end counts from its beginning again.
pub fn deserialize<'de, T: Listed, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
    let place = usize::deserialize(deserializer)?;
    Ok(T::LIST[place % T::LIST.len()])
}
