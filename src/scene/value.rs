//! Values that a document may hold: not negative, a share, a direction; and what is said where they are not.

use glam::DVec3;

use super::error::Fault;

/// Checks that a number is finite and not below zero; `what` names it.
pub(super) fn not_negative(value: f64, what: &str) -> Result<(), Fault> {
    if value.is_finite() && value >= 0.0 {
        return Ok(());
    }
    Err(Fault::new(format!("{what} is {value}"), "write a finite number, zero or more"))
}

/// Checks that a share is from 0 to 1; `what` names it.
pub(super) fn check_share(share: f64, what: &str) -> Result<(), Fault> {
    if (0.0..=1.0).contains(&share) {
        return Ok(());
    }
    Err(Fault::new(format!("{what} is {share}"), "write a number from 0 to 1"))
}

/// The unit vector along `vector`, which must be finite and not zero; `what` names it.
pub(super) fn unit(vector: [f64; 3], what: &str) -> Result<DVec3, Fault> {
    let vector = DVec3::from_array(vector);
    // The largest part first: squares of very long or very short vectors would overflow or vanish.
    let scaled = vector / vector.abs().max_element();
    scaled.try_normalize().ok_or_else(|| {
        let DVec3 { x, y, z } = vector;
        let fault = if vector.is_finite() { "has length zero" } else { "is not finite" };
        Fault::new(format!("the {what} ({x}, {y}, {z}) {fault}"), "any other length will do, such as (1, 0, 0)")
    })
}
