use super::device::Device;
use super::text::Constants;
use super::volume::{Masks, Mode, Volume};
use crate::field::{IndexVolume, Levels, Octree};
use crate::sh::Sh;
use crate::transport::lattice::kernel::form::Form;
use crate::transport::lattice::schemes;
use crate::transport::lattice::stencil::Stencil;
use glam::DVec3;

#[test]
fn steps_have_the_bits_of_the_processors_loops() {
    let Ok(card) = Device::shared() else {
        eprintln!("no graphics card or driver: the suite of the card did not run");
        return;
    };
    eprintln!("on {} {:?}", card.name(), card.limits().max_storage_buffer_binding_size);
    for scheme in schemes::all() {
        let stencil = Stencil::<f32>::new(&scheme, 3.0, true);
        let form = Form::of(&stencil).unwrap();
        let sizes = Levels::new(32, 32).unwrap();
        let constants = Constants { levels: vec![(form, stencil.clone())], solids: None };
        let mut volume = Volume::new(card, sizes, 1, &constants, &Masks::default()).unwrap();
        let (mut source, mut target, mut sum) = (Octree::new(sizes), Octree::new(sizes), Octree::new(sizes));
        source.level_mut(0).set([8, 3, 20], Sh::lobe(DVec3::new(0.6, 0.0, -0.8)));
        source.level_mut(0).set([31, 3, 0], Sh::lobe(DVec3::new(0.0, 1.0, 0.0)));
        let mut index = IndexVolume::new(sizes);
        let mut scene = source.level(0).clone();
        volume.load(&[[&source, &sum]], &index, &[vec![false]]);
        volume.iterate(&[Mode { linear: false, ..Mode::default() }; 3]);
        volume.store(&mut [[&mut source, &mut target, &mut sum]], &mut index).unwrap();
        let mut total = crate::field::Grid::new(32);
        for _ in 0..3 {
            scene = crate::transport::lattice::kernel::step::once(&form, scene);
            total.add_grid(&scene);
        }
        for (cell, light) in scene.iter() {
            assert_eq!(
                light.0.map(f32::to_bits),
                source.level(0).get(cell).0.map(f32::to_bits),
                "{} {cell:?}",
                scheme.name
            );
            assert_eq!(
                total.get(cell).0.map(f32::to_bits),
                sum.level(0).get(cell).0.map(f32::to_bits),
                "{} {cell:?}",
                scheme.name
            );
        }
    }
}
