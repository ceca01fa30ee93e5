//! Scenes whose light is known in closed form: direct light and the path tracer must find it, within their error bars.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use super::bounce::{Bounces, indirect};
use super::estimate::Estimates;
use super::lamp::Lamp;
use super::sequence::Points;
use super::sparks::Sparks;
use super::world::World;
use crate::mesh::{Bvh, Material, Mesh};

/// A parallelogram: a corner, its sides, its albedo and what it emits.
struct Sheet {
    corner: DVec3,
    sides: [DVec3; 2],
    albedo: f64,
    emission: f64,
}

fn mesh(sheets: &[Sheet]) -> Mesh {
    let corners =
        |s: &Sheet| [s.corner, s.corner + s.sides[0], s.corner + s.sides[0] + s.sides[1], s.corner + s.sides[1]];
    let vertices: Vec<Vec3> = sheets.iter().flat_map(corners).map(|v| v.as_vec3()).collect();
    let quads = 0..sheets.len() as u32;
    let triangles =
        quads.clone().flat_map(|q| [[4 * q, 4 * q + 1, 4 * q + 2], [4 * q, 4 * q + 2, 4 * q + 3]]).collect();
    let material = |s: &Sheet| Material { name: String::new(), albedo: [s.albedo; 3], emission: [s.emission; 3] };
    Mesh::new(vertices, triangles, quads.flat_map(|q| [q, q]).collect(), sheets.iter().map(material).collect()).unwrap()
}

/// Six walls around the unit cube.
fn room(albedo: f64) -> Vec<Sheet> {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    (0..6)
        .map(|side| {
            let (axis, far) = (side / 2, side % 2);
            let sides = [axes[(axis + 1) % 3], axes[(axis + 2) % 3]];
            Sheet { corner: axes[axis] * far as f64, sides, albedo, emission: 0.0 }
        })
        .collect()
}

/// The mean irradiance over one side of triangles, weighted by their areas, with its standard deviation.
fn mean(world: &World, sides: &[(usize, DVec3)], bounces: Bounces, samples: u64) -> [f64; 2] {
    let mesh = world.mesh();
    let sparks = Sparks::new(world, 0);
    let mut estimates = Estimates::<1>::new(sides.len(), 1);
    let finished = estimates.add_all(samples, &|_| true, |item, mut sample| {
        let [a, b, c, d, u, v] = Points::<6>::new().at(&sample.shift, sample.number);
        let (triangle, normal) = sides[item];
        let corners = mesh.corners(triangle);
        let at = corners.iter().zip(super::sampler::triangle([u, v])).map(|(corner, weight)| weight * *corner).sum();
        let surface = world.surface(triangle, at, normal);
        [indirect(world, &sparks, &surface, bounces, [a, b, c, d], &mut sample.more)[0]]
    });
    assert!(finished);
    let area: f64 = sides.iter().map(|(triangle, _)| mesh.area(*triangle)).sum();
    let weight = |item: usize| mesh.area(sides[item].0) / area;
    let mean = (0..sides.len()).map(|item| weight(item) * estimates.mean(item)[0]).sum();
    let variance: f64 = (0..sides.len()).map(|item| (weight(item) * estimates.deviation(item)[0]).powi(2)).sum();
    [mean, variance.sqrt()]
}

/// Within four standard deviations, and those within `share` of what is wanted.
fn agrees([found, deviation]: [f64; 2], wanted: f64, share: f64) {
    assert!(deviation < share * wanted, "{found} ± {deviation}");
    assert!((found - wanted).abs() < 4.0 * deviation, "{found} ± {deviation}, {wanted}");
}

#[test]
fn a_point_light_over_a_plane_falls_off_with_the_cosine_and_the_square() {
    let plane = Sheet {
        corner: DVec3::new(-5.0, 0.0, -5.0),
        sides: [10.0 * DVec3::X, 10.0 * DVec3::Z],
        albedo: 0.5,
        emission: 0.0,
    };
    let mesh = mesh(&[plane]);
    let bvh = Bvh::new(&mesh);
    let lamp = Lamp::Point { position: DVec3::new(0.0, 1.5, 0.0), intensity: [7.0, 3.0, 1.0] };
    let world = World::new(&mesh, &bvh, vec![lamp]);
    for x in [0.0, 0.5, 2.0, 4.5] {
        let above = world.surface(0, DVec3::new(x, 0.0, 0.0), DVec3::Y);
        let squared = x * x + 1.5 * 1.5;
        let wanted = 7.0 * 1.5 / squared.powf(1.5);
        let found = world.direct(&above);
        assert!((found[0] - wanted).abs() < 1e-12 && (found[1] - wanted * 3.0 / 7.0).abs() < 1e-12);
        assert_eq!(world.direct(&world.surface(0, above.at, DVec3::NEG_Y)), [0.0; 3], "the other side is dark");
    }
}

#[test]
fn a_shadow_ends_where_geometry_says() {
    let at = |y: f64, half: f64| Sheet {
        corner: DVec3::new(-half, y, -half),
        sides: [2.0 * half * DVec3::X, 2.0 * half * DVec3::Z],
        albedo: 0.5,
        emission: 0.0,
    };
    let mesh = mesh(&[at(0.0, 5.0), at(1.0, 0.5)]);
    let bvh = Bvh::new(&mesh);
    let lamps = [
        // From height 2 a sheet at height 1 throws a shadow twice its size; the sun one of its size.
        (Lamp::Point { position: DVec3::new(0.0, 2.0, 0.0), intensity: [1.0; 3] }, 1.0),
        (Lamp::Sun { direction: DVec3::NEG_Y, irradiance: [1.0; 3], middle: DVec3::ZERO, radius: 8.0 }, 0.5),
    ];
    for (lamp, edge) in lamps {
        let world = World::new(&mesh, &bvh, vec![lamp]);
        let lit = |x: f64| world.direct(&world.surface(0, DVec3::new(x, 0.0, 0.1), DVec3::Y))[0] > 0.0;
        assert_eq!([lit(0.0), lit(edge - 1e-4), lit(edge + 1e-4)], [false, false, true], "{lamp:?}");
    }
}

#[test]
fn squares_see_each_other_by_their_form_factors() {
    // A square that emits radiance 1 gives one of its size the mean irradiance π·F.
    let unit =
        |corner: DVec3, a: DVec3, b: DVec3, emission: f64| Sheet { corner, sides: [a, b], albedo: 0.0, emission };
    // Directly opposed at the distance of a side: F = (2/π)·(ln√(4/3) + 2√2·atan(1/√2) − 2·atan 1).
    let root = 2f64.sqrt();
    let parallel = 2.0 / PI * ((4.0f64 / 3.0).sqrt().ln() + 2.0 * root * (1.0 / root).atan() - 2.0 * 1f64.atan());
    // At right angles with a common side: F = (1/π)·(2·atan 1 − √2·atan(1/√2) + ¼·ln(3/4)).
    let perpendicular = (2.0 * 1f64.atan() - root * (1.0 / root).atan() + 0.25 * 0.75f64.ln()) / PI;
    for (receiver, factor) in [
        (unit(DVec3::Y, DVec3::X, DVec3::Z, 0.0), parallel),
        (unit(DVec3::ZERO, DVec3::Y, DVec3::Z, 0.0), perpendicular),
    ] {
        let normal = if receiver.corner == DVec3::Y { DVec3::NEG_Y } else { DVec3::X };
        let mesh = mesh(&[unit(DVec3::ZERO, DVec3::X, DVec3::Z, 1.0), receiver]);
        let bvh = Bvh::new(&mesh);
        let world = World::new(&mesh, &bvh, Vec::new());
        agrees(mean(&world, &[(2, normal), (3, normal)], Bounces::UpTo(1), 4096), PI * factor, 0.01);
        assert_eq!(mean(&world, &[(2, -normal), (3, -normal)], Bounces::UpTo(1), 16)[0], 0.0, "not from behind");
    }
}

#[test]
fn in_a_closed_room_every_bounce_keeps_the_albedo_of_the_flux() {
    let albedo = 0.6;
    let mesh = mesh(&room(albedo));
    let bvh = Bvh::new(&mesh);
    let inwards = |triangle: usize| {
        let normal = mesh.normal(triangle);
        let inside = normal.dot(DVec3::splat(0.5) - mesh.corners(triangle)[0]);
        (triangle, if inside < 0.0 { -normal } else { normal })
    };
    let sides: Vec<(usize, DVec3)> = (0..mesh.len()).map(inwards).collect();
    let position = DVec3::new(0.3, 0.55, 0.6);
    let lamps = [
        (Lamp::Point { position, intensity: [1.0; 3] }, 4.0 * PI),
        (Lamp::Spot { position, direction: DVec3::new(0.6, 0.0, 0.8), edge: 0.5, full: 0.5, intensity: [1.0; 3] }, PI),
    ];
    for (lamp, flux) in lamps {
        let world = World::new(&mesh, &bvh, vec![lamp]);
        // The walls have an area of 6.
        agrees(mean(&world, &sides, Bounces::UpTo(1), 1024), albedo * flux / 6.0, 0.01);
        agrees(mean(&world, &sides, Bounces::UpTo(2), 1024), (albedo + albedo * albedo) * flux / 6.0, 0.01);
        agrees(mean(&world, &sides, Bounces::All, 1024), albedo / (1.0 - albedo) * flux / 6.0, 0.01);
        assert_eq!(mean(&world, &sides, Bounces::UpTo(0), 16), [0.0; 2]);
    }
}

#[test]
fn no_light_gets_out_of_a_closed_room() {
    let mesh = mesh(&room(0.9));
    let bvh = Bvh::new(&mesh);
    let lamp = Lamp::Point { position: DVec3::splat(0.4), intensity: [1.0; 3] };
    let world = World::new(&mesh, &bvh, vec![lamp]);
    let outwards = |triangle: usize| {
        let normal = mesh.normal(triangle);
        let inside = normal.dot(DVec3::splat(0.5) - mesh.corners(triangle)[0]);
        (triangle, if inside < 0.0 { normal } else { -normal })
    };
    let sides: Vec<(usize, DVec3)> = (0..mesh.len()).map(outwards).collect();
    assert_eq!(mean(&world, &sides, Bounces::All, 256), [0.0; 2]);
}

#[test]
fn two_lights_are_the_sum_of_each() {
    let mesh = mesh(&room(0.5));
    let bvh = Bvh::new(&mesh);
    let lamps = [
        Lamp::Point { position: DVec3::splat(0.4), intensity: [1.0; 3] },
        Lamp::Point { position: DVec3::new(0.8, 0.2, 0.7), intensity: [2.0; 3] },
    ];
    let of = |lamps: Vec<Lamp>| {
        mean(&World::new(&mesh, &bvh, lamps), &[(0, mesh.normal(0)), (0, -mesh.normal(0))], Bounces::UpTo(1), 4096)
    };
    let (one, other, both) = (of(lamps[..1].to_vec()), of(lamps[1..].to_vec()), of(lamps.to_vec()));
    let deviation = (one[1].powi(2) + other[1].powi(2) + both[1].powi(2)).sqrt();
    assert!(
        (one[0] + other[0] - both[0]).abs() < 4.0 * deviation && both[0] > 20.0 * deviation,
        "{one:?} {other:?} {both:?}"
    );
}
