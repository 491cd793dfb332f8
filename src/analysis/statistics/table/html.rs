//! Tables for a browser: one self-contained page.

use quick_xml::escape::escape;

use super::cells::{Cell, Table};

const STYLE: &str = "body{font:14px sans-serif;margin:2em;color-scheme:light dark}table{border-collapse:collapse}\
    div{overflow-x:auto}th,td{padding:.2em .6em;text-align:left;border-bottom:1px solid #8888}\
    td.number{text-align:right;font-variant-numeric:tabular-nums}code{white-space:pre-wrap}";

/// The tables as one HTML page; text from the scenario is escaped.
pub fn html(tables: &[Table]) -> String {
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>closecall stats</title>\
         <meta name=\"viewport\" content=\"width=device-width\"><style>{STYLE}</style></head><body>\n"
    );
    for table in tables {
        page += &format!("<h2>{}</h2>\n<div><table><tr>", escape(table.title));
        table.columns.iter().for_each(|column| page += &format!("<th>{}</th>", escape(*column)));
        page += "</tr>\n";
        for row in &table.rows {
            let cells = row.iter().map(|cell| match cell {
                Cell::Text(text) => format!("<td>{}</td>", escape(text.as_str())),
                number => format!("<td class=\"number\">{}</td>", number.rounded()),
            });
            page += &format!("<tr>{}</tr>\n", cells.collect::<String>());
        }
        page += "</table></div>\n";
        table.notes.iter().for_each(|note| page += &format!("<p><code>{}</code></p>\n", escape(note.as_str())));
    }
    page + "</body></html>\n"
}

#[cfg(test)]
mod tests {
    use crate::analysis::statistics::table::html::*;

    #[test]
    fn a_vehicle_named_like_a_script_stays_text() {
        let rows = vec![vec!["<script>alert(1)</script>".into()]];
        let page = html(&[Table { title: "t", columns: vec!["ego"], rows, notes: vec!["<b>".to_owned()] }]);
        assert!(page.contains("&lt;script&gt;") && !page.contains("<script") && !page.contains("<b>"), "{page}");
    }
}
