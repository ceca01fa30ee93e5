//! The schemes of the lattice, one a file, and the list of them.

pub(crate) mod axial;
pub(crate) mod blog;
pub(crate) mod cascaded;
pub(crate) mod cone;
pub(crate) mod reflective;

use super::scheme::Scheme;

/// Every scheme, the default first.
pub fn all() -> Vec<Scheme> {
    vec![cascaded::scheme(), blog::scheme(), axial::scheme(), cone::scheme(), reflective::scheme()]
}

/// The names of all schemes, the default first.
pub fn names() -> Vec<&'static str> {
    all().iter().map(|s| s.name).collect()
}

/// The scheme called `name`.
pub fn find(name: &str) -> Option<Scheme> {
    all().into_iter().find(|s| s.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sh::Sh;
    use crate::transport::lattice::scheme::Face;
    use glam::DVec3;

    /// The eight symmetries of the cube that keep +X, as maps of (y, z).
    fn keep_x(v: DVec3, which: usize) -> DVec3 {
        let (y, z) = if which & 1 == 0 { (v.y, v.z) } else { (v.z, v.y) };
        let sign = |bit: usize, c: f64| if which & bit == 0 { c } else { -c };
        DVec3::new(v.x, sign(2, y), sign(4, z))
    }

    fn key(f: &Face, which: usize) -> [i64; 8] {
        let sh = |s: Sh<f64>| {
            let v = keep_x(s.vector(), which);
            [s.0[0], v.x, v.y, v.z].map(|c| (c * 1e9).round() as i64)
        };
        let ([a, b, c, d], [e, f, g, h]) = (sh(f.sampler), sh(f.lobe));
        [a, b, c, d, e, f, g, h]
    }

    #[test]
    fn every_scheme_has_the_symmetry_of_the_cell() {
        for scheme in all() {
            let sorted = |which| {
                let mut keys: Vec<_> = scheme.faces.iter().map(|f| key(f, which)).collect();
                keys.sort();
                keys
            };
            for which in 1..8 {
                assert_eq!(sorted(which), sorted(0), "{} under symmetry {which}", scheme.name);
            }
        }
    }

    #[test]
    fn names_are_distinct_and_found() {
        for name in names() {
            assert_eq!(names().iter().filter(|other| **other == name).count(), 1);
            assert_eq!(find(name).unwrap().name, name);
        }
        assert_eq!(find("no such scheme"), None);
    }
}
