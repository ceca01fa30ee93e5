//! What to look for in a preset: the comment that its file opens with.

use std::path::Path;

use crate::scene::{Preset, builtin};
use crate::transport::preset;

/// The comment at the beginning of a preset's text, as one paragraph; empty where there is none.
pub fn of_text(text: &str) -> String {
    let lines = text.lines().map(str::trim).skip_while(|line| line.is_empty());
    let comment = lines.map_while(|line| line.strip_prefix("//")).map(str::trim);
    comment.collect::<Vec<_>>().join(" ").trim().to_owned()
}

/// The guide of a built-in preset as it is brought along; none for any other.
pub fn of_preset(preset: &Preset) -> Option<String> {
    let is_it = |(name, text): &&(&str, &str)| preset::parse(text, Path::new(name)).is_ok_and(|known| known == *preset);
    builtin::PRESETS.iter().find(is_it).map(|(_, text)| of_text(text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_comment_is_the_guide_and_no_other() {
        assert_eq!(of_text("\n// Step twice,\n//   watch the left.\n( // not this\n)"), "Step twice, watch the left.");
        assert_eq!(of_text("(version: 1)"), "");
    }

    #[test]
    fn a_built_in_preset_is_known_until_it_is_edited() {
        let text = builtin::find("one-lobe").unwrap();
        let mut preset = preset::parse(text, Path::new("one-lobe")).unwrap();
        assert!(of_preset(&preset).unwrap().starts_with("One lobe"));
        preset.propagation.factor += 0.5;
        assert_eq!(of_preset(&preset), None);
    }
}
