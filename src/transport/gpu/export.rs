//! The kernels in other languages, checked and translated by naga: WGSL as it runs here, GLSL 4.50, HLSL for shader model
//! 6.0, Metal's language, SPIR-V.

use naga::back::{glsl, hlsl, msl, spv};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};

use super::text::{Constants, Kernel};

/// The languages that kernels are written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Language {
    /// The language of WebGPU, as it runs here.
    Wgsl,
    /// OpenGL's and Vulkan's, version 4.50.
    Glsl,
    /// Direct3D's, for shader model 6.0.
    Hlsl,
    /// Metal's.
    Msl,
    /// Vulkan's binary form, version 1.1.
    Spirv,
}

impl Language {
    /// All languages.
    #[cfg(test)]
    pub const ALL: [Language; 5] = [Language::Wgsl, Language::Glsl, Language::Hlsl, Language::Msl, Language::Spirv];

    /// What names of its files end in.
    pub fn extension(self) -> &'static str {
        match self {
            Language::Wgsl => "wgsl",
            Language::Glsl => "comp",
            Language::Hlsl => "hlsl",
            Language::Msl => "metal",
            Language::Spirv => "spv",
        }
    }
}

/// A kernel that naga does not take, or cannot write; the sentence is naga's.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the kernel `{kernel}` cannot be written: {what}")]
pub struct ExportError {
    kernel: &'static str,
    what: String,
}

/// A kernel's file in a language.
pub fn translate(kernel: Kernel, constants: &Constants, language: Language) -> Result<Vec<u8>, ExportError> {
    let text = kernel.text(constants);
    let failed = |what: String| ExportError { kernel: kernel.name(), what };
    let module = naga::front::wgsl::parse_str(&text).map_err(|error| failed(error.emit_to_string(&text)))?;
    let info = Validator::new(ValidationFlags::all(), Capabilities::all())
        .validate(&module)
        .map_err(|error| failed(error.emit_to_string(&text)))?;
    written(kernel, &module, &info, language).map(|file| file.unwrap_or(text.into_bytes())).map_err(failed)
}

/// The translation; `None` where the text is in that language already.
fn written(
    kernel: Kernel,
    module: &naga::Module,
    info: &ModuleInfo,
    language: Language,
) -> Result<Option<Vec<u8>>, String> {
    let bindings = module.global_variables.iter().filter_map(|(_, variable)| variable.binding);
    match language {
        Language::Wgsl => Ok(None),
        Language::Glsl => {
            let options = glsl::Options {
                version: glsl::Version::Desktop(450),
                writer_flags: glsl::WriterFlags::empty(),
                binding_map: bindings.map(|binding| (binding, binding.binding as u8)).collect(),
                ..Default::default()
            };
            let pipeline = glsl::PipelineOptions {
                shader_stage: naga::ShaderStage::Compute,
                entry_point: kernel.name().to_owned(),
                multiview: None,
            };
            let mut text = String::new();
            glsl::Writer::new(&mut text, module, info, &options, &pipeline, Default::default())
                .and_then(|mut writer| writer.write())
                .map_err(|error| error.to_string())?;
            Ok(Some(text.into_bytes()))
        }
        Language::Hlsl => {
            let target =
                |binding: naga::ResourceBinding| hlsl::BindTarget { register: binding.binding, ..Default::default() };
            let options = hlsl::Options {
                shader_model: hlsl::ShaderModel::V6_0,
                binding_map: bindings.map(|binding| (binding, target(binding))).collect(),
                fake_missing_bindings: false,
                ..Default::default()
            };
            let mut text = String::new();
            hlsl::Writer::new(&mut text, &options, &Default::default())
                .write(module, info, None)
                .map_err(|error| error.to_string())?;
            Ok(Some(text.into_bytes()))
        }
        Language::Msl => {
            let target = |binding: naga::ResourceBinding| msl::BindTarget {
                buffer: Some(binding.binding as u8),
                mutable: true,
                ..Default::default()
            };
            let resources = msl::EntryPointResources {
                resources: bindings.map(|binding| (binding, target(binding))).collect(),
                sizes_buffer: Some(SIZES_BUFFER),
                ..Default::default()
            };
            let options = msl::Options {
                lang_version: (2, 4),
                per_entry_point_map: [(kernel.name().to_owned(), resources)].into(),
                fake_missing_bindings: false,
                ..Default::default()
            };
            let (text, _) =
                msl::write_string(module, info, &options, &Default::default()).map_err(|error| error.to_string())?;
            Ok(Some(text.into_bytes()))
        }
        Language::Spirv => {
            let options = spv::Options { lang_version: (1, 3), ..Default::default() };
            let words = spv::write_vec(module, info, &options, None).map_err(|error| error.to_string())?;
            Ok(Some(words.iter().flat_map(|word| word.to_le_bytes()).collect()))
        }
    }
}

/// The buffer of Metal's kernels that holds the sizes of the others.
pub const SIZES_BUFFER: u8 = 16;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::transport::gpu::text::Solids;
    use crate::transport::lattice::kernel::form::Form;
    use crate::transport::lattice::schemes;
    use crate::transport::lattice::stencil::Stencil;

    #[test]
    fn every_kernel_of_every_scheme_is_valid_in_every_language() {
        let fuzzy = Solids::Fuzzy { amplifier: 0.8, bounce: 1.0, reflection: 4.8 };
        for scheme in schemes::all() {
            for solids in [None, Some(fuzzy), Some(Solids::Hard), Some(Solids::Mirrored)] {
                let stencil = Stencil::<f32>::new(&scheme, 3.0, true);
                let form = Form::of(&stencil).unwrap();
                let constants = Constants { levels: vec![(form, stencil)], plain: true, solids };
                for (kernel, language) in Kernel::ALL.iter().flat_map(|k| Language::ALL.map(|l| (*k, l))) {
                    let file = translate(kernel, &constants, language);
                    let file = file.unwrap_or_else(|error| panic!("{} {language:?}: {error}", scheme.name));
                    let has_name = file.windows(4).any(|part| part == &kernel.name().as_bytes()[..4]);
                    assert!(has_name || language == Language::Glsl, "{} {language:?}", kernel.name());
                }
            }
        }
    }
}
