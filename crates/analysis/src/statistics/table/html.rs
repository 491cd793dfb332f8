//! Tables for a browser: one self-contained page.

use super::cells::{Cell, Table};
use crate::style;
use closecall_run::util::xml_text::escaped;

/// The tables as one HTML page in the report's style, with a title; text from the scenario is escaped.
pub fn html(title: &str, tables: &[Table]) -> String {
    let (title, style) = (escaped(title), style::sheet());
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{title} – closecall</title>\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'\">\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\
         <meta name=\"color-scheme\" content=\"light dark\"><style>{style}</style></head><body>\n\
         <header><h1>{title}</h1></header>\n<main>\n"
    );
    for table in tables {
        let notes = table.notes.iter().map(|note| format!("<p class=\"note\">{}</p>\n", escaped(note.as_str())));
        let notes = notes.collect::<String>();
        if table.columns.is_empty() {
            page += &format!("<section>{notes}</section>\n");
            continue;
        }
        page += &format!(
            "<section><h2>{}</h2>\n<div class=\"scroll\" tabindex=\"0\"><table>\n<thead><tr>",
            escaped(&heading(table.title))
        );
        let is_number =
            |column: usize| table.rows.iter().any(|row| !matches!(row.get(column), Some(Cell::Text(_) | Cell::None)));
        for (place, column) in table.columns.iter().enumerate() {
            let class = if is_number(place) { " class=\"number\"" } else { "" };
            page += &format!("<th scope=\"col\"{class}>{}</th>", escaped(column));
        }
        page += "</tr></thead>\n";
        for row in &table.rows {
            let cells = row.iter().map(|cell| match cell {
                Cell::Text(text) => format!("<td>{}</td>", escaped(text.as_str())),
                number => format!("<td class=\"number\">{}</td>", number.rounded()),
            });
            page += &format!("<tr>{}</tr>\n", cells.collect::<String>());
        }
        page += &format!("</table></div>\n{notes}</section>\n");
    }
    page + "</main></body></html>\n"
}

/// The title of a table, capitalised.
fn heading(title: &str) -> String {
    let mut letters = title.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use crate::statistics::table::html::*;

    #[test]
    fn a_vehicle_named_like_a_script_stays_text() {
        let rows = vec![vec!["<script>alert(1)</script>".into()]];
        let page = html("<i>", &[Table { title: "t", columns: vec!["ego"], rows, notes: vec!["<b>".to_owned()] }]);
        assert!(
            page.contains("&lt;script&gt;")
                && !page.contains("<script")
                && !page.contains("<b>")
                && !page.contains("<i>"),
            "{page}"
        );
    }
}
