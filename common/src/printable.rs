//! Texts of others on a terminal.

/// `text` with control characters as they are written in a program (`\n`, `\u{1b}`): what a recording or a configuration
/// says of itself cannot move the cursor or begin a line of its own.
pub fn printable(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        if character.is_control() { out.extend(character.escape_default()) } else { out.push(character) }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_are_written_out() {
        assert_eq!(printable("Grün 50°\u{1b}[2J\r\nstate whole\u{9b}"), "Grün 50°\\u{1b}[2J\\r\\nstate whole\\u{9b}");
    }
}
