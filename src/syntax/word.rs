//! What a file in RON is, without reading all of it.

/// The first word of a text in RON, behind comments.
pub fn first_word(text: &str) -> &str {
    let mut rest = text.trim_start_matches('\u{feff}').trim_start();
    loop {
        let end = if rest.starts_with("//") {
            rest.find('\n')
        } else if rest.starts_with("/*") {
            rest.find("*/").map(|at| at + 1)
        } else if rest.starts_with("#!") {
            rest.find(']')
        } else {
            let end = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
            return &rest[..end];
        };
        rest = end.map_or("", |at| rest[at + 1..].trim_start());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_word_stands_behind_comments() {
        assert_eq!(first_word("// a\n/* b */ Graph(x: 1)"), "Graph");
        assert_eq!(first_word("\u{feff}#![enable(x)]\nScene ("), "Scene");
        assert_eq!(first_word("// only"), "");
    }
}
