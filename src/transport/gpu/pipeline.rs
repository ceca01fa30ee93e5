//! Compiled kernels, and what they are bound to.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

use super::device::Device;
use super::text::{Constants, Kernel};

/// Every pipeline that was compiled, by its text: scenes of one scheme share them.
pub(super) fn pipeline(card: &'static Device, kernel: Kernel, constants: &Constants) -> wgpu::ComputePipeline {
    static COMPILED: Mutex<Option<HashMap<String, wgpu::ComputePipeline>>> = Mutex::new(None);
    let text = kernel.text(constants);
    let mut compiled = COMPILED.lock().unwrap_or_else(PoisonError::into_inner);
    let compiled = compiled.get_or_insert_default();
    if let Some(pipeline) = compiled.get(&text) {
        return pipeline.clone();
    }
    let module = card.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(kernel.name()),
        source: wgpu::ShaderSource::Wgsl(text.as_str().into()),
    });
    let layout = card.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some(kernel.name()),
        entries: &bindings(kernel),
    });
    let layout = card.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(kernel.name()),
        bind_group_layouts: &[Some(&layout)],
        immediate_size: 0,
    });
    let pipeline = card.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(kernel.name()),
        layout: Some(&layout),
        module: &module,
        entry_point: Some(kernel.name()),
        compilation_options: Default::default(),
        cache: None,
    });
    compiled.insert(text, pipeline.clone());
    pipeline
}

/// What a kernel is bound to.
fn bindings(kernel: Kernel) -> Vec<wgpu::BindGroupLayoutEntry> {
    use wgpu::BufferBindingType::{Storage, Uniform};
    let (read, write) = (Storage { read_only: true }, Storage { read_only: false });
    let kinds: &[(u32, wgpu::BufferBindingType)] = match kernel {
        Kernel::Propagate => &[(2, read), (3, write), (4, write), (5, write), (6, read), (7, write)],
        Kernel::Solids => &[(2, read), (3, write), (4, write), (5, write), (6, read), (8, read), (9, read)],
        Kernel::Downsample => &[(2, read), (3, write), (5, write)],
        Kernel::Merge => &[(2, read), (3, write), (5, read)],
        Kernel::Inject => &[(2, read), (3, write), (4, write), (5, write)],
    };
    let uniforms = [(0, Uniform), (1, Uniform)];
    uniforms
        .iter()
        .chain(kinds)
        .map(|&(binding, ty)| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: binding == 1, min_binding_size: None },
            count: None,
        })
        .collect()
}

/// What a dispatch of a kernel is bound to.
pub(super) fn bind_group(
    card: &Device,
    pipeline: &wgpu::ComputePipeline,
    entries: Vec<(u32, wgpu::BindingResource<'_>)>,
) -> wgpu::BindGroup {
    let entries: Vec<wgpu::BindGroupEntry<'_>> =
        entries.into_iter().map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource }).collect();
    card.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &entries,
    })
}
