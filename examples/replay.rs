//! Checks a recording of SUMO (`--fcd-output`) and prints its conflicts.
//!
//!     cargo run --example replay -- fcd.xml.gz town.net.xml

use std::path::PathBuf;
use std::sync::Arc;

use closecall::Options;
use closecall_run::{Error, Replay, Result, Run};

fn main() -> Result<()> {
    let mut paths = std::env::args_os().skip(1).map(PathBuf::from);
    let (Some(recording), Some(net)) = (paths.next(), paths.next()) else {
        return Err(Error::Value("usage: replay RECORDING NET".to_owned()));
    };
    let options = Options::default();
    let net = Arc::new(closecall_run::net::read(&net)?);
    let mut replay = Replay::open(&recording, &[], Some(&net), &options)?;
    let mut run = Run::new(&options.clone().into(), Some(net))?;
    run.set_fixed_routes(true);
    while replay.next(&mut run)?.is_some() {}
    let summary = run.finish()?;
    for conflict in run.conflicts() {
        println!("{:>8.1} s  {} / {}: {}", conflict.time, conflict.ego, conflict.foe, conflict.kind.name());
    }
    println!("{summary}");
    Ok(())
}
