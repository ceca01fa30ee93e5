//! Text from outside (titles, names of files, what a file holds) made fit to be shown: one line, in the order in which
//! it is written, not too long.
//!
//! Whoever writes a preset could otherwise move a terminal's cursor, recolour what follows, or turn the letters round
//! so that a name reads as another one ("Trojan Source", CVE-2021-42574).

/// What a message quotes of a file, at most: enough to recognise, not enough to flood a terminal.
const QUOTED: usize = 60;

/// The text with control characters and marks that turn its direction written out as `\u{…}`.
///
/// ```
/// use lpv_lab::system::text::one_line;
/// assert_eq!(one_line("red\u{1b}[31m\nand \u{202e}back"), "red\\u{1b}[31m\\nand \\u{202e}back");
/// assert_eq!(one_line("Стена, 壁, קיר"), "Стена, 壁, קיר");
/// ```
pub fn one_line(text: &str) -> String {
    written_out(text, is_unfit)
}

/// As [`one_line`], but ends of lines and tabulators stay: for what is laid out already.
pub fn lines(text: &str) -> String {
    written_out(text, |c| is_unfit(c) && c != '\n' && c != '\t')
}

fn written_out(text: &str, unfit: impl Fn(char) -> bool) -> String {
    text.chars().fold(String::with_capacity(text.len()), |mut line, c| {
        if unfit(c) {
            line.extend(c.escape_default());
        } else {
            line.push(c);
        }
        line
    })
}

/// Whether a character does more than stand in its place: controls, line and paragraph separators, and the marks,
/// embeddings, overrides and isolates of the bidirectional algorithm (Unicode Standard Annex 9, table 1).
pub fn is_unfit(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// The text, or its beginning and `…` where it has more than `most` characters.
///
/// ```
/// use lpv_lab::system::text::shortened;
/// assert_eq!(shortened("a wall of light", 40), "a wall of light");
/// assert_eq!(shortened("a wall of light", 7), "a wall…");
/// ```
pub fn shortened(text: &str, most: usize) -> String {
    match text.char_indices().nth(most) {
        None => text.to_owned(),
        Some(_) => {
            let end = text.char_indices().nth(most.saturating_sub(1)).map_or(text.len(), |(end, _)| end);
            format!("{}…", text[..end].trim_end())
        }
    }
}

/// `found` between backquotes, cut to what a message may quote.
pub fn quote(found: &str) -> String {
    match found.char_indices().nth(QUOTED) {
        Some((end, _)) => format!("`{}…`", &found[..end]),
        None => format!("`{found}`"),
    }
}

/// The known name that `found` most likely means: the one with the fewest letters to change, put in, take out or swap
/// with their neighbour (case is free), if that is at most half of them.
///
/// ```
/// use lpv_lab::system::text::nearest;
/// assert_eq!(nearest("casaded", &["axial", "cascaded"]), Some("cascaded"));
/// assert_eq!(nearest("something else", &["axial", "cascaded"]), None);
/// ```
pub fn nearest<'a>(found: &str, known: &[&'a str]) -> Option<&'a str> {
    let length = found.chars().count();
    if length > QUOTED {
        return None;
    }
    let found = found.to_lowercase();
    let changes = |name: &&'a str| strsim::osa_distance(&found, &name.to_lowercase());
    let (changes, name) = known.iter().map(|name| (changes(name), *name)).min_by_key(|&(n, _)| n)?;
    (2 * changes <= length.max(name.len())).then_some(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_misspelt_name_finds_its_neighbour_and_a_strange_one_finds_none() {
        let known = ["factor", "iterations", "scheme", "snapshots"];
        for (found, meant) in [("fcator", "factor"), ("Factor", "factor"), ("shceme", "scheme")] {
            assert_eq!(nearest(found, &known), Some(meant));
        }
        assert_eq!(nearest("colour", &known), None);
        assert_eq!(nearest(&"factor".repeat(1000), &known), None);
        assert_eq!(nearest("a", &[]), None);
    }

    #[test]
    fn nothing_that_steers_a_terminal_or_turns_letters_is_left() {
        let unfit = "\0\u{7}\u{1b}\u{7f}\u{9b}\r\n\t\u{61c}\u{200e}\u{200f}\u{2028}\u{2029}\u{202a}\u{202b}\u{202c}\
                     \u{202d}\u{202e}\u{2066}\u{2067}\u{2068}\u{2069}";
        for c in unfit.chars() {
            let shown = one_line(&format!("a{c}b"));
            assert!(shown.starts_with("a\\") && shown.ends_with('b') && !shown.chars().any(is_unfit), "{shown}");
        }
        let fit = "Ünï — 壁 קיר é \u{301}";
        assert_eq!(one_line(fit), fit);
        assert_eq!(lines("a\tb\nc\u{1b}"), "a\tb\nc\\u{1b}");
    }

    #[test]
    fn long_text_is_cut_between_characters_and_says_so() {
        assert_eq!(shortened("ééééé", 5), "ééééé");
        assert_eq!(shortened("éééééé", 5), "éééé…");
        assert_eq!(shortened("ab", 1), "…");
        assert_eq!(shortened("ab", 0), "…");
        assert!(quote(&"é".repeat(5000)).len() < 200);
    }
}
