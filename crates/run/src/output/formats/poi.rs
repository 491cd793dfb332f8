//! Conflicts as points of interest of SUMO, for sumo-gui and netedit: the colour is the severity, the type the kind, and the
//! columns of the log are the parameters, which a right click shows.

use std::fmt::Write;
use std::path::Path;

use crate::Result;
use crate::output::schema::{Column, LoggedConflict, Value};
use crate::util::decimal::shortest;
use crate::util::output_file::OutputFile;
use crate::util::xml_text::escaped;
use closecall::detection::kind::Severity;

/// Above the roads and the vehicles.
const LAYER: u32 = 300;

/// A file of points of interest that is being written.
pub struct Poi {
    file: OutputFile,
    columns: Vec<&'static Column>,
}

impl Poi {
    /// Begins the file.
    pub fn create(path: &Path, columns: Vec<&'static Column>) -> Result<Self> {
        let mut file = OutputFile::create(path)?;
        let made_by = concat!("<!-- closecall ", env!("CARGO_PKG_VERSION"), " -->\n");
        file.append(format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\n{made_by}\n<additional>\n").as_bytes())?;
        Ok(Self { file, columns })
    }

    /// Appends a conflict.
    pub fn write(&mut self, conflict: &LoggedConflict) -> Result<()> {
        let colour = match conflict.severity {
            Severity::Critical => "red",
            Severity::Serious => "orange",
            Severity::Caution => "yellow",
        };
        let [x, y] = [conflict.x, conflict.y].map(|metres| shortest(metres, &mut String::new()).to_owned());
        let (id, kind) = (conflict.id, conflict.kind.name());
        let mut text = format!(
            "    <poi id=\"conflict_{id}\" type=\"{kind}\" color=\"{colour}\" icon=\"pin\" layer=\"{LAYER}\" \
             x=\"{x}\" y=\"{y}\">\n"
        );
        let mut buffer = String::new();
        for column in &self.columns {
            let value = (column.get)(conflict);
            if !matches!(value, Value::Missing | Value::Text("")) {
                let value = value.text(&mut buffer);
                // Writing to a String cannot fail.
                let _ = writeln!(text, "        <param key=\"{}\" value=\"{}\"/>", column.name, escaped(value));
            }
        }
        self.file.append((text + "    </poi>\n").as_bytes())
    }

    /// Completes the file.
    pub fn finish(mut self) -> Result<()> {
        self.file.append(b"</additional>\n")?;
        self.file.finish()
    }
}
