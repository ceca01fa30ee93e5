//! Opens a glTF file: its JSON, and in a `.glb` the binary part behind it.
//!
//! A `.glb` is a header of three numbers (`glTF`, version 2, the length of all), then chunks of a length, a
//! kind and bytes: `JSON` first, `BIN` next, others stepped over.

use gltf::json::{Root, validation};
use gltf::{Document, Semantic};

use crate::mesh::job::{Job, shortened};
use crate::system::file::FileError;

/// The document and its binary part.
pub(super) fn open<'a>(bytes: &'a [u8], job: &Job) -> Result<(Document, Option<&'a [u8]>), FileError> {
    let (text, binary) = if bytes.starts_with(b"glTF") { chunks(bytes, job)? } else { (bytes, None) };
    // Some editors begin a text with a byte order mark.
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    let mut root = Root::from_slice(text).map_err(|error| {
        let fault = job.fault(format!("it is no glTF ({error})"), "give a glTF 2.0 file");
        if error.line() > 0 && !bytes.starts_with(b"glTF") {
            FileError { line: Some(error.line()), ..fault }
        } else {
            fault
        }
    })?;
    if root.asset.version != "2.0" && !root.asset.version.starts_with("2.") {
        let what = format!("it is glTF {}", shortened(&root.asset.version));
        return Err(job.fault(what, "this program reads glTF 2.0"));
    }
    prepare(&mut root, job)?;
    let document = Document::from_json(root).map_err(|error| {
        let what = match error {
            gltf::Error::Validation(faults) => {
                let fault = faults.first().map(|(path, fault)| (path.to_string(), *fault));
                let (path, fault) = fault.unwrap_or((String::new(), validation::Error::Invalid));
                format!("{}: {fault}", shortened(&path))
            }
            error => error.to_string(),
        };
        job.fault(what, "export the mesh again, without the extensions that it needs")
    })?;
    Ok((document, binary))
}

/// The JSON and the binary part of a `.glb`.
fn chunks<'a>(bytes: &'a [u8], job: &Job) -> Result<(&'a [u8], Option<&'a [u8]>), FileError> {
    let number = |at: usize| {
        let four = bytes.get(at..at + 4).and_then(|four| four.try_into().ok());
        four.map(u32::from_le_bytes)
    };
    let cut = || job.fault("the file ends before its header says", "copy or export it again: it is cut off");
    let (version, length) = (number(4).ok_or_else(cut)?, number(8).ok_or_else(cut)? as usize);
    if version != 2 {
        return Err(job.fault(format!("it is binary glTF {version}"), "this program reads glTF 2.0"));
    }
    if length > bytes.len() {
        return Err(cut());
    }
    let (mut json, mut binary) = (None, None);
    let mut at = 12;
    while at + 8 <= length {
        let size = number(at).ok_or_else(cut)? as usize;
        let kind = &bytes[at + 4..at + 8];
        let chunk = bytes[..length].get(at + 8..at + 8 + size).ok_or_else(cut)?;
        match kind {
            b"JSON" if json.is_none() => json = Some(chunk),
            b"BIN\0" if binary.is_none() => binary = Some(chunk),
            _ => {}
        }
        at += 8 + size;
    }
    let json = json.ok_or_else(|| job.fault("it has no JSON part", "export the mesh again"))?;
    Ok((json, binary))
}

/// Sees to what the check of the document takes for granted: that positions name accessors that are there, and
/// that these tell their bounds, which many programs leave out and nothing here needs.
fn prepare(root: &mut Root, job: &Job) -> Result<(), FileError> {
    let positions = validation::Checked::Valid(Semantic::Positions);
    let named: Vec<(usize, usize)> = root
        .meshes
        .iter()
        .enumerate()
        .flat_map(|(m, mesh)| {
            let positions = &positions;
            mesh.primitives.iter().filter_map(move |p| p.attributes.get(positions).map(|a| (m, a.value())))
        })
        .collect();
    for (mesh, accessor) in named {
        let Some(accessor) = root.accessors.get_mut(accessor) else {
            let what = format!("meshes[{mesh}] names accessors[{accessor}], which is not there");
            return Err(job.fault(what, "export the mesh again"));
        };
        let zero = || Some(gltf::json::serialize::to_value([0.0f32; 3]).unwrap_or_default());
        (accessor.min, accessor.max) = (zero(), zero());
    }
    Ok(())
}
