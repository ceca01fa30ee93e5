//! The text of the kernels, in WGSL: the same for the card here and for engines elsewhere.
//!
//! What a scheme, a factor and a level make of light is written into the text as constants; all else is in the files
//! under `kernels/`.

use std::fmt::Write;

use crate::sh::Sh;
use crate::transport::lattice::kernel::form::{Face, Form};
use crate::transport::lattice::stencil::Stencil;

/// What is constant in the kernels of one setting.
#[derive(Clone, Debug, PartialEq)]
pub struct Constants {
    /// The operator of each level, the finest first, in both of its forms.
    pub levels: Vec<(Form<f32>, Stencil<f32>)>,
    /// Whether an iteration may go by the definition, face by face: the first one of NVIDIA's sample does.
    pub plain: bool,
    /// What solids do to light, if there are any.
    pub solids: Option<Solids>,
}

/// What solids do to light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Solids {
    /// Blockers weaken it, and reflect some of it.
    Fuzzy {
        /// What a blocker's value is multiplied by before it is limited to 0..1.
        amplifier: f32,
        /// What reflected light is multiplied by.
        bounce: f32,
        /// The constant of reflected light (4.8).
        reflection: f32,
    },
    /// A cell passes a part of it and sends a part back.
    Hard,
    /// A cell mirrors it.
    Mirrored,
}

/// The kernels there are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Kernel {
    /// Adds a list of lights to the finest level.
    Inject,
    /// Makes a level of the next finer one.
    Downsample,
    /// One iteration, with the sum.
    Propagate,
    /// The same for the cells that solids touch.
    Solids,
    /// Samples the octree for every finest cell.
    Merge,
}

impl Kernel {
    /// All kernels, in the order in which a run needs them.
    pub const ALL: [Kernel; 5] = [Kernel::Inject, Kernel::Downsample, Kernel::Propagate, Kernel::Solids, Kernel::Merge];

    /// Its name: that of its entry point and of its file.
    pub fn name(self) -> &'static str {
        match self {
            Kernel::Inject => "inject",
            Kernel::Downsample => "downsample",
            Kernel::Propagate => "propagate",
            Kernel::Solids => "solids",
            Kernel::Merge => "merge",
        }
    }

    /// Its whole text.
    pub fn text(self, constants: &Constants) -> String {
        let light = include_str!("kernels/light.wgsl");
        let gather = include_str!("kernels/gather.wgsl");
        match self {
            Kernel::Inject => join(&[light, include_str!("kernels/inject.wgsl")]),
            Kernel::Downsample => join(&[light, include_str!("kernels/downsample.wgsl")]),
            Kernel::Merge => join(&[light, include_str!("kernels/merge.wgsl")]),
            Kernel::Propagate => {
                let operator = constants.operator();
                join(&[light, &operator, gather, include_str!("kernels/propagate.wgsl")])
            }
            Kernel::Solids => {
                let (operator, among) = (constants.operator(), constants.among_solids());
                join(&[light, &operator, gather, &among, include_str!("kernels/solids.wgsl")])
            }
        }
    }
}

fn join(parts: &[&str]) -> String {
    parts.iter().map(|part| part.trim_end()).collect::<Vec<_>>().join("\n\n") + "\n"
}

/// A number that WGSL reads back to the last bit.
fn number(c: f32) -> String {
    match c {
        f32::NEG_INFINITY => format!("{:?}f", f32::MIN),
        f32::INFINITY => format!("{:?}f", f32::MAX),
        _ => format!("{c:?}f"),
    }
}

fn numbers(c: &[f32]) -> String {
    c.iter().map(|c| number(*c)).collect::<Vec<_>>().join(", ")
}

fn face(face: &Face<f32>) -> String {
    format!("Face(vec3<f32>({}), vec3<f32>({}), {})", numbers(&face.sampler), numbers(&face.lobe), number(face.least))
}

/// A function of the level: one value where all levels have the same.
fn by_level(text: &mut String, head: &str, values: &[String]) {
    let same = values.iter().all(|value| *value == values[0]);
    if same {
        let _ = writeln!(text, "{head} {{\n    return {};\n}}\n", values[0]);
        return;
    }
    let _ = writeln!(text, "{head} {{\n    switch level {{");
    for (i, value) in values.iter().enumerate().skip(1) {
        let _ = writeln!(text, "        case {i}u: {{ return {value}; }}");
    }
    let _ = writeln!(text, "        default: {{ return {}; }}\n    }}\n}}\n", values[0]);
}

impl Constants {
    /// The operators of the levels.
    fn operator(&self) -> String {
        let mut text = String::from(
            "// The operator: what a cell's light becomes in its neighbours, the factor included.\n\n\
             // Without clamps: c00 from c00 (alpha) and from the direction along the way (beta), the direction along the\n\
             // way from c00 (gamma) and from itself (delta), the direction across it from itself (epsilon).\n\
             struct Share { alpha: f32, beta: f32, gamma: f32, delta: f32, epsilon: f32 }\n\n\
             // A face in its own frame (c00, along the way, across it): flux = max(least, sampler . light), which adds\n\
             // flux * lobe.\n\
             struct Face { sampler: vec3<f32>, lobe: vec3<f32>, least: f32 }\n\n\
             // A face in the frame of the grid.\n\
             struct Tap { sampler: vec4<f32>, lobe: vec4<f32>, travel: vec4<f32>, clamps: u32 }\n\n",
        );
        let forms: Vec<&Form<f32>> = self.levels.iter().map(|(form, _)| form).collect();
        let share = |form: &Form<f32>| {
            let s = form.share;
            format!("Share({})", numbers(&[s.alpha, s.beta, s.gamma, s.delta, s.epsilon]))
        };
        let values: Vec<String> = forms.iter().map(|form| share(form)).collect();
        by_level(&mut text, "fn share(level: u32) -> Share", &values);
        let values: Vec<String> = forms.iter().map(|form| face(&form.ahead)).collect();
        by_level(&mut text, "fn ahead_face(level: u32) -> Face", &values);
        let has_sides = forms.iter().all(|form| form.side.is_some());
        let _ = writeln!(text, "const HAS_SIDES: bool = {has_sides};\n");
        let values: Vec<String> = forms.iter().map(|form| face(form.side.as_ref().unwrap_or(&form.ahead))).collect();
        by_level(&mut text, "fn side_face(level: u32) -> Face", &values);
        let values: Vec<String> = self
            .levels
            .iter()
            .map(|(_, stencil)| {
                let [band0, band1, ..] = stencil.reflect(Sh([1.0; 4])).0;
                format!("vec4<f32>({})", numbers(&[band0, band1, band1, band1]))
            })
            .collect();
        text.push_str("// What a level multiplies reflected light by.\n");
        by_level(&mut text, "fn reflection(level: u32) -> vec4<f32>", &values);
        let cone = forms.first().and_then(|form| form.cone).filter(|r| r.is_finite()).unwrap_or(0.0);
        let high = (cone * cone) as f32;
        let low = (cone * cone - f64::from(high)) as f32;
        let _ = writeln!(
            text,
            "// Light whose direction part is at most so many times c00 meets no clamp, now and ever: the square of that\n\
             // number, in two parts.\n\
             const CONE2_HIGH: f32 = {};\nconst CONE2_LOW: f32 = {};\n",
            number(high),
            number(low)
        );
        text + &self.taps()
    }

    /// The faces as the definition has them, for light that goes to +x, and how they are turned into the other
    /// directions; once for all levels where levels do not differ.
    fn taps(&self) -> String {
        let stencils: Vec<&Stencil<f32>> = self.levels.iter().map(|(_, stencil)| stencil).collect();
        let same = stencils.iter().all(|stencil| *stencil == stencils[0]);
        let stencils = if same { &stencils[..1] } else { &stencils[..] };
        let faces = stencils[0].taps()[0].len();
        let taps: Vec<String> = stencils
            .iter()
            .flat_map(|stencil| &stencil.taps()[0])
            .map(|tap| {
                let vector = |sh: Sh<f32>| format!("vec4<f32>({})", numbers(&sh.0));
                let [sampler, lobe, travel] = [tap.sampler, tap.lobe, tap.travel].map(vector);
                format!("        Tap({sampler}, {lobe}, {travel}, {}u),\n", u32::from(tap.clamp))
            })
            .collect();
        let first = if same { "f" } else { "level * FACES + f" };
        format!(
            "const FACES: u32 = {faces}u;\n\n\
             // A vector that is given for light to +x, turned so that it fits light in direction `d`\n\
             // (+x, -x, +y, -y, +z, -z).\n\
             fn turned(v: vec4<f32>, d: u32) -> vec4<f32> {{\n    \
             let along = select(v.y, -v.y, (d & 1u) != 0u);\n    \
             switch d >> 1u {{\n        \
             case 0u: {{ return vec4<f32>(v.x, along, v.z, v.w); }}\n        \
             case 1u: {{ return vec4<f32>(v.x, v.z, along, v.w); }}\n        \
             default: {{ return vec4<f32>(v.x, v.w, v.z, along); }}\n    }}\n}}\n\n\
             // Face `f` for light in direction `d`.\n\
             fn tap(level: u32, d: u32, f: u32) -> Tap {{\n    var taps = array<Tap, {}>(\n{}    );\n    \
             let t = taps[{first}];\n    \
             return Tap(turned(t.sampler, d), turned(t.lobe, d), turned(t.travel, d), t.clamps);\n}}\n\n\
             // Whether an iteration may go tap by tap, by the definition.\n\
             const MAY_BE_PLAIN: bool = {};\n",
            taps.len(),
            taps.concat(),
            self.plain
        )
    }

    /// Which of the kernels' ways of meeting a solid is this setting's.
    fn among_solids(&self) -> String {
        let (amplifier, bounce, reflection, call) = match self.solids {
            Some(Solids::Fuzzy { amplifier, bounce, reflection }) => {
                (amplifier, bounce, reflection, "fuzzy(t, level, d, light)")
            }
            Some(Solids::Mirrored) => (0.0, 0.0, 0.0, "mirror(t, level, d, light)"),
            Some(Solids::Hard) | None => (0.0, 0.0, 0.0, "hard(t, level, d, light, own)"),
        };
        format!(
            "const AMPLIFIER: f32 = {};\nconst BOUNCE: f32 = {};\nconst REFLECTION: f32 = {};\n\n\
             // What a cell that a solid touches receives in direction `d`; `own` is its own light.\n\
             fn receive_among_solids(t: Touched, level: u32, d: u32, light: vec4<f32>, own: vec4<f32>) -> vec4<f32> \
             {{\n    return {call};\n}}\n",
            number(amplifier),
            number(bounce),
            number(reflection)
        )
    }
}
