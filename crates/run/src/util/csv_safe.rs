//! Cells that a spreadsheet would run as formulas: those whose text begins with one of these signs.
//!
//! An apostrophe before the text makes it a text for spreadsheets. A text that begins with an apostrophe gets a second one, so
//! that reading takes exactly one away.

/// What a formula begins with (OWASP, "CSV Injection"), and the apostrophe itself.
const SIGNS: [char; 7] = ['=', '+', '-', '@', '\t', '\r', '\''];

/// The text as a cell that no spreadsheet runs; written to `buffer` where that differs.
pub fn safe<'a>(text: &'a str, buffer: &'a mut String) -> &'a str {
    if !text.starts_with(SIGNS) {
        return text;
    }
    buffer.clear();
    buffer.push('\'');
    buffer.push_str(text);
    buffer
}

/// The text of such a cell.
pub fn plain(cell: &str) -> &str {
    cell.strip_prefix('\'').filter(|text| text.starts_with(SIGNS)).unwrap_or(cell)
}

#[cfg(test)]
mod tests {
    use crate::util::csv_safe::*;

    #[test]
    fn a_formula_becomes_a_text_and_comes_back() {
        for (text, cell) in [
            ("=1+1", "'=1+1"),
            ("@a", "'@a"),
            ("-2", "'-2"),
            ("'=x", "''=x"),
            ("car.1", "car.1"),
            ("", ""),
            ("a'b", "a'b"),
        ] {
            assert_eq!(safe(text, &mut String::new()), cell);
            assert_eq!(plain(cell), text);
        }
    }
}
