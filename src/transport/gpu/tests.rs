use super::device::Device;
use super::text::Constants;
use super::volume::{Masks, Mode, Volume};
use crate::field::{IndexVolume, Octree};
use crate::scene::builtin;
use crate::scene::propagation::{Policy, Snapshots};
use crate::simulation::{Action, Simulation};
use crate::transport::lattice::kernel::form::Form;
use crate::transport::lattice::kernel::lies_in_cone;
use crate::transport::lattice::levels;
use crate::transport::lattice::schemes;
use std::path::Path;

#[test]
fn steps_have_the_bits_of_the_processors_loops() {
    let Ok(card) = Device::shared() else {
        eprintln!("no graphics card or driver: the suite of the card did not run");
        return;
    };
    for scheme in ["cascaded", "axial", "blog"] {
        for (name, policy) in [("level-jump", Policy::Consistent), ("colours", Policy::Same)] {
            for snapshots in [Snapshots::Thesis, Snapshots::CopyFirst] {
                eprintln!("{scheme} {name} {snapshots:?} {:?}", std::time::Instant::now());
                let builtin = builtin::find(name).unwrap();
                let mut preset = crate::scene::Preset::parse(builtin, Path::new(name)).unwrap();
                preset.propagation.scheme = scheme.to_owned();
                preset.propagation.levels = policy;
                preset.propagation.snapshots = snapshots;
                let problem = crate::scene::Problem::build(&preset, Path::new("")).unwrap();
                let mut cpu = Simulation::<f32>::new(problem).unwrap();
                for action in [Action::Clear, Action::Inject, Action::Downsample] {
                    cpu.act(action);
                }
                let found = schemes::find(scheme).unwrap();
                let p = &preset.propagation;
                let operators =
                    levels::operators::<f32>(&found, p.factor, p.clamp, p.levels, cpu.sizes().count()).unwrap();
                let levels: Vec<_> =
                    operators.into_iter().map(|o| (Form::of(&o.stencil).unwrap(), o.stencil)).collect();
                let cone = levels[0].0.cone;
                let constants = Constants { levels, plain: snapshots == Snapshots::CopyFirst, solids: None };
                let linear: Vec<Vec<bool>> = cpu
                    .lights()
                    .iter()
                    .map(|light| {
                        (0..cpu.sizes().count())
                            .map(|i| {
                                constants.levels[i].0.cone.is_some_and(|r| {
                                    r.is_infinite() || lies_in_cone(light.source.level(i), cpu.index().level(i), r)
                                })
                            })
                            .collect()
                    })
                    .collect();
                let mut volume =
                    Volume::new(card, cpu.sizes(), cpu.lights().len(), &constants, &Masks::default()).unwrap();
                let light: Vec<[&Octree<f32>; 2]> = cpu.lights().iter().map(|l| [&l.source, &l.accumulated]).collect();
                volume.load(&light, cpu.index(), &linear);
                let keep = snapshots == Snapshots::CopyFirst;
                let decide = cone.is_some_and(f64::is_finite);
                let mut modes = vec![Mode { linear: true, decide, ..Mode::default() }; 7];
                if keep {
                    modes[0] = Mode { keep: true, plain: true, decide, ..Mode::default() };
                }
                volume.iterate(&modes);
                for _ in 0..7 {
                    cpu.act(Action::Propagate);
                }
                let mut octrees: Vec<[Octree<f32>; 3]> =
                    cpu.lights().iter().map(|_| [0; 3].map(|_| Octree::new(cpu.sizes()))).collect();
                let mut index = IndexVolume::new(cpu.sizes());
                let mut to: Vec<[&mut Octree<f32>; 3]> = octrees.iter_mut().map(|o| o.each_mut()).collect();
                volume.store(&mut to, &mut index).unwrap();
                for (channel, (light, found)) in cpu.lights().iter().zip(&octrees).enumerate() {
                    for (what, (wanted, found)) in
                        [&light.source, &light.target, &light.accumulated].into_iter().zip(found).enumerate()
                    {
                        for i in 0..cpu.sizes().count() {
                            for (cell, wanted) in wanted.level(i).iter() {
                                let found = found.level(i).get(cell);
                                assert_eq!(
                                    found.0.map(f32::to_bits),
                                    wanted.0.map(f32::to_bits),
                                    "{scheme} {name} {snapshots:?} channel {channel} {what} level {i} {cell:?} {found:?} {wanted:?}"
                                );
                            }
                        }
                    }
                }
                for i in 0..cpu.sizes().count() {
                    assert_eq!(index.level(i), cpu.index().level(i), "{scheme} {name} marks of level {i}");
                }
            }
        }
    }
}
