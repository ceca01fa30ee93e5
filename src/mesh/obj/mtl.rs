//! Reads a Wavefront material library: of each material its diffuse colour (`Kd`), its texture (`map_Kd`) and
//! what it emits (`Ke`). Everything else is stepped over: surfaces here are diffuse.

use std::path::Path;

use super::{lines, numbers, text};
use crate::mesh::Material;
use crate::mesh::job::{at_line, shortened};
use crate::system::file::FileError;

/// The longest library, in bytes.
pub(super) const LONGEST: u64 = 16 << 20;
/// The most that a surface may emit: what volumes in single precision hold with room to spare.
const BRIGHTEST: f32 = 1e20;

/// A material of a library.
pub(super) struct Made {
    pub(super) material: Material,
    /// The file of its texture.
    pub(super) texture: Option<String>,
}

/// The materials of a library in the file `path`.
pub(super) fn read(bytes: &[u8], path: &Path) -> Result<Vec<Made>, FileError> {
    let mut made: Vec<Made> = Vec::new();
    for (i, line) in lines(bytes).enumerate() {
        let Some(line) = text(line) else { continue };
        let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        if word == "newmtl" {
            // The default where a library gives no colour.
            made.push(Made { material: Material::grey(rest), texture: None });
            continue;
        }
        let Some(last) = made.last_mut() else { continue };
        let colour = |most: f32| match numbers::<3>(rest).or(numbers::<1>(rest).map(|[grey]| [grey; 3])) {
            Some(parts) if parts.iter().all(|part| (0.0..=most).contains(part)) => Ok(parts.map(f64::from)),
            _ => {
                let what = format!("`{}` is no colour", shortened(line));
                Err(at_line(path, i + 1, what, format!("write {word} and three numbers from 0 to {most:e}")))
            }
        };
        match word {
            "Kd" => last.material.albedo = colour(1.0)?,
            "Ke" => last.material.emission = colour(BRIGHTEST)?,
            "map_Kd" => last.texture = file_name(rest).map(str::to_owned),
            _ => {}
        }
    }
    Ok(made)
}

/// The file's name behind a map's options, such as `-s 1 1 1 wood.png`.
fn file_name(words: &str) -> Option<&str> {
    let mut rest = words;
    while rest.starts_with('-') {
        let (option, after) = rest.split_once(char::is_whitespace)?;
        rest = after.trim_start();
        let values = match option {
            "-o" | "-s" | "-t" => 3,
            "-mm" => 2,
            _ => 1,
        };
        for _ in 0..values {
            let (_, after) = rest.split_once(char::is_whitespace)?;
            rest = after.trim_start();
        }
    }
    (!rest.is_empty()).then_some(rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_emission_and_textures_are_read_and_the_rest_is_stepped_over() {
        let library = b"# a\nKd 1 1 1\nnewmtl a b\n Kd 0.1 0.2 0.3\nNs 5\nKe 4\nnewmtl c\nmap_Kd -s 1 2 3 -clamp on my wood.png\n";
        let made = read(library, Path::new("a.mtl")).unwrap();
        assert_eq!(made.len(), 2);
        assert_eq!(made[0].material.name, "a b");
        assert_eq!(made[0].material.albedo, [0.1f32, 0.2, 0.3].map(f64::from));
        assert_eq!((made[0].material.emission, made[0].texture.clone()), ([4.0; 3], None));
        assert_eq!((made[1].material.albedo, made[1].texture.as_deref()), ([0.5; 3], Some("my wood.png")));
    }

    #[test]
    fn a_colour_that_no_surface_has_is_refused_with_its_line() {
        for colour in ["Kd 0.5 0.5", "Kd", "Kd nan 0 0", "Kd 1.5 0 0", "Kd -0.1 0 0", "Ke inf 0 0", "Ke -1 0 0"] {
            let fault = read(format!("newmtl a\n{colour}\n").as_bytes(), Path::new("a.mtl")).err();
            // Two numbers are a grey and something that is not looked at.
            match colour {
                "Kd 0.5 0.5" => assert_eq!(fault, None),
                _ => assert!(fault.unwrap().to_string().starts_with("a.mtl:2: "), "{colour}"),
            }
        }
    }
}
