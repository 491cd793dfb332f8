//! Any text as one that XML can hold, for all files in XML, SVG and HTML.
//!
//! XML 1.0 has no escape for the control characters, which ids may contain: a parser refuses the file (its production 2,
//! "Char"). They become their pictures (U+2400 and the following), so that ids stay different; a character that Unicode
//! has not assigned becomes the replacement character.

use std::borrow::Cow;

/// The picture of the first control character.
const PICTURES: u32 = 0x2400;

/// The text between tags or in an attribute, with markup escaped.
pub fn escaped(text: &str) -> Cow<'_, str> {
    match valid(text) {
        Cow::Borrowed(text) => quick_xml::escape::escape(text),
        Cow::Owned(text) => Cow::Owned(quick_xml::escape::escape(text).into_owned()),
    }
}

/// The text, or a whole document, with only such characters as XML can hold.
pub fn valid(text: &str) -> Cow<'_, str> {
    if text.chars().all(is_valid) {
        return Cow::Borrowed(text);
    }
    Cow::Owned(text.chars().map(|sign| if is_valid(sign) { sign } else { picture(sign) }).collect())
}

fn is_valid(sign: char) -> bool {
    matches!(sign, '\t' | '\n' | '\r' | ' '..='\u{d7ff}' | '\u{e000}'..='\u{fffd}' | '\u{10000}'..)
}

fn picture(sign: char) -> char {
    let code = sign as u32;
    char::from_u32(PICTURES + code).filter(|_| code < 0x20).unwrap_or(char::REPLACEMENT_CHARACTER)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_xml_cannot_hold_is_replaced_and_the_rest_escaped() {
        for (text, written) in [
            ("car.1", "car.1"),
            ("a<b>&\"'", "a&lt;b&gt;&amp;&quot;&apos;"),
            ("a\u{1}\u{0}\u{1f}", "a␁␀␟"),
            ("\u{ffff}\u{fffe}<", "\u{fffd}\u{fffd}&lt;"),
            ("\u{7f}\u{85}é\u{10ffff}", "\u{7f}\u{85}é\u{10ffff}"),
            ("a\tb\nc", "a\tb\nc"),
        ] {
            assert_eq!(escaped(text), written);
        }
    }

    #[test]
    fn every_character_makes_a_file_that_a_parser_reads() {
        let all = (0..=0x1_1000).filter_map(char::from_u32).collect::<String>();
        let document = format!("<a b=\"{}\">{}</a>", escaped(&all), escaped(&all));
        assert!(document.chars().all(is_valid));
        let mut reader = quick_xml::Reader::from_str(&document);
        while !matches!(reader.read_event().unwrap(), quick_xml::events::Event::Eof) {}
    }
}
