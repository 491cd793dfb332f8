//! Tables for spreadsheets and scripts: one line per value, with every digit.

use super::cells::{Cell, Table};
use crate::{Error, Result};
use closecall_run::util::csv_safe::safe;

/// The tables as CSV: `table,row,name,column,value`; `row` counts from 1, `name` is the row's first cell. With `is_safe`, no
/// spreadsheet runs a text as a formula.
///
/// # Errors
/// [`Error::Value`] if memory runs out.
pub fn csv(tables: &[Table], is_safe: bool) -> Result<String> {
    let failed = |error: String| Error::Value(error);
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut line = |cells: [&str; 5]| writer.write_record(cells).map_err(|error| failed(error.to_string()));
    line(["table", "row", "name", "column", "value"])?;
    for table in tables {
        for (number, row) in table.rows.iter().enumerate() {
            let exact = |cell: &Cell| match cell {
                Cell::Text(text) if is_safe => safe(text, &mut String::new()).to_owned(),
                cell => cell.exact(),
            };
            let name = row.first().map(exact).unwrap_or_default();
            let mut of = "";
            for (column, cell) in table.columns.iter().zip(row) {
                // The ends of an interval are named after its value.
                let column = if ["low", "high"].contains(column) {
                    format!("{of} {column}")
                } else {
                    of = column;
                    (*column).to_owned()
                };
                line([table.title, &(number + 1).to_string(), &name, &column, &exact(cell)])?;
            }
        }
    }
    let bytes = writer.into_inner().map_err(|error| failed(error.to_string()))?;
    String::from_utf8(bytes).map_err(|error| failed(error.to_string()))
}

#[cfg(test)]
mod tests {
    use super::super::cells::Cell;
    use crate::statistics::table::table_csv::*;

    #[test]
    fn interval_ends_are_named_after_their_value() {
        let rows = vec![vec!["a,b".into(), Cell::Number(0.1), Cell::None]];
        let table = Table { title: "t", columns: vec!["group", "per hour", "low"], rows, notes: vec![] };
        let wanted = "table,row,name,column,value\nt,1,\"a,b\",group,\"a,b\"\nt,1,\"a,b\",per hour,0.1\nt,1,\"a,b\",per hour low,\n";
        assert_eq!(csv(&[table], false).unwrap(), wanted);
    }
}
