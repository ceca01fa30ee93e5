//! What to look for in a preset: the comment that its file opens with.

/// The comment at the beginning of a preset's text, as one paragraph; empty where there is none.
pub fn of_text(text: &str) -> String {
    let lines = text.lines().map(str::trim).skip_while(|line| line.is_empty());
    let comment = lines.map_while(|line| line.strip_prefix("//")).map(str::trim);
    comment.collect::<Vec<_>>().join(" ").trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_comment_is_the_guide_and_no_other() {
        assert_eq!(of_text("\n// Step twice,\n//   watch the left.\n( // not this\n)"), "Step twice, watch the left.");
        assert_eq!(of_text("(version: 1)"), "");
    }
}
