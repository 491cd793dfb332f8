//! The commands that are disturbed, and the folders that they find.

use std::fmt::Write;
use std::fs;
use std::path::Path;

use crate::undisturbed;

/// A command, and what was done before it.
pub struct Subject {
    pub name: &'static str,
    pub words: String,
    before: Vec<String>,
}

/// What closecall writes: a log, one beside or in place of another, its series and other formats, a report, statistics, a
/// picture, exports; and what it reads.
pub fn subjects() -> [Subject; 14] {
    let of = |name, words: &str, before: &[&str]| {
        let before = before.iter().map(|words| (*words).to_owned()).collect();
        Subject { name, words: words.to_owned(), before }
    };
    let log = "replay recording.xml --net net.xml --quiet --out log";
    let another = &format!("{log} --warmup 6");
    let report = "report log --quiet";
    let all = format!("{log} --log-series --ssm-output ssm.xml --trj-output all.trj");
    let stats = "stats log --format json";
    let export = |format: &str| format!("export log --quiet --format {format} --out exported");
    [
        of("a log", log, &[]),
        of("a log after another", log, &[another]),
        of("a log in place of another", &format!("{log} --force"), &[another]),
        of("a log and all other formats", &all, &[]),
        of("a report in place of another", report, &[another, report, log]),
        of("statistics in a file", &format!("{stats} --out stats.json"), &[log]),
        of("statistics", stats, &[log]),
        of("a log in Parquet", &format!("{log} --log-format parquet"), &[]),
        of("a picture of a clip", "clip log --worst 1 --quiet --out clip.svg", &[log]),
        of("a GeoJSON", &export("geojson"), &[log]),
        of("a GeoParquet", &export("geoparquet"), &[log]),
        of("a GeoPackage", &export("gpkg"), &[log]),
        of("points of interest", &export("poi"), &[log]),
        of("an export for the SSM device", &export("ssm"), &[log]),
    ]
}

/// With a projection, as GeoJSON needs degrees.
const NET: &str = r#"<net><location netOffset="-500000,-5400000" projParameter="+proj=utm +zone=32 +datum=WGS84 +units=m +no_defs"/>
<edge id="e" from="a" to="b"><lane id="e_0" index="0" length="90" shape="0,-50 0,40"/></edge></net>"#;

impl Subject {
    /// Fills the folder that the command finds.
    pub fn prepare(&self, folder: &Path, recording: u64) {
        fs::write(folder.join("net.xml"), NET).unwrap();
        fs::write(folder.join("recording.xml"), crossings(recording)).unwrap();
        self.before.iter().for_each(|words| drop(undisturbed(words, folder)));
    }
}

/// Pairs of cars that cross at right angles, one pair after the other, the second of a pair less than a second later.
fn crossings(seed: u64) -> String {
    const PAIRS: u32 = 10;
    const APART: f64 = 1.5;
    let mut random = fastrand::Rng::with_seed(seed);
    let delays = (0..PAIRS).map(|_| random.f64()).collect::<Vec<_>>();
    let mut text = "<fcd-export>\n".to_owned();
    for step in 0..=5 * (f64::from(PAIRS) * APART) as u32 + 20 {
        let time = f64::from(step) * 0.2;
        writeln!(text, r#"<timestep time="{time:.1}">"#).unwrap();
        for pair in 0..PAIRS {
            let here = time - f64::from(pair) * APART - 2.0;
            let there = here - delays[pair as usize];
            let y = 500.0 * f64::from(pair);
            if here.abs() < 2.05 {
                writeln!(
                    text,
                    r#"<vehicle id="e{pair}" x="{:.2}" y="{y}" angle="90" speed="10" type="car"/>"#,
                    10.0 * here
                )
                .unwrap();
                writeln!(
                    text,
                    r#"<vehicle id="n{pair}" x="0" y="{:.2}" angle="0" speed="10" type="car"/>"#,
                    y + 10.0 * there
                )
                .unwrap();
            }
        }
        text += "</timestep>\n";
    }
    text + "</fcd-export>\n"
}
