//! Tables for a terminal.

use super::cells::{Cell, Table};

/// The tables with aligned columns: text to the left, numbers to the right.
pub fn text(tables: &[Table]) -> String {
    tables.iter().map(one).collect::<Vec<_>>().join("\n")
}

fn one(table: &Table) -> String {
    if table.columns.is_empty() {
        // A title appears only with its table.
        return table.notes.iter().map(|note| format!("{note}\n")).collect();
    }
    let rows = table.rows.iter().map(|row| row.iter().map(Cell::rounded).collect::<Vec<_>>()).collect::<Vec<_>>();
    let is_word = |column: usize| table.rows.iter().any(|row| matches!(row.get(column), Some(Cell::Text(_))));
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count());
        // `format!` accepts no greater width.
        cells.chain([table.columns[column].chars().count()]).max().unwrap_or_default().min(u16::MAX.into())
    };
    let columns = (0..table.columns.len()).map(|column| (width(column), is_word(column))).collect::<Vec<_>>();
    let line = |cells: &mut dyn Iterator<Item = &str>| {
        let padded =
            cells.zip(&columns).map(
                |(cell, &(width, is_word))| {
                    if is_word { format!("{cell:<width$}") } else { format!("{cell:>width$}") }
                },
            );
        padded.collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
    };
    let mut text = format!("{}\n{}", table.title.to_uppercase(), line(&mut table.columns.iter().copied()));
    rows.iter().for_each(|row| text += &line(&mut row.iter().map(String::as_str)));
    table.notes.iter().for_each(|note| text += &format!("{note}\n"));
    text
}

#[cfg(test)]
mod tests {
    use crate::statistics::table::text::*;

    #[test]
    fn a_cell_of_any_length_is_printed() {
        let word = "w".repeat(1 << 17);
        let table = Table { title: "t", columns: vec!["id"], rows: vec![vec![word.as_str().into()]], notes: vec![] };
        assert_eq!(text(&[table]), format!("T\nid\n{word}\n"));
    }

    #[test]
    fn text_is_aligned_left_and_numbers_right() {
        let rows = vec![vec!["a".into(), Cell::Number(1.0)], vec!["long".into(), Cell::None]];
        let table = Table { title: "t", columns: vec!["group", "per hour"], rows, notes: vec!["note".to_owned()] };
        assert_eq!(text(&[table]), "T\ngroup  per hour\na         1.000\nlong          –\nnote\n");
    }
}
