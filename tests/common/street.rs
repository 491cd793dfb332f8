//! A street with one lane in each direction, 200 m long, from west to east and back.

use std::path::Path;
use std::sync::Arc;

use closecall::Net;

const STREET: &str = r#"<net>
    <edge id="east" from="w" to="e"><lane id="east_0" index="0" length="200" width="3.2" shape="0,-1.6 200,-1.6"/></edge>
    <edge id="west" from="e" to="w"><lane id="west_0" index="0" length="200" width="3.2" shape="200,1.6 0,1.6"/></edge>
</net>"#;

pub fn street() -> Arc<Net> {
    Arc::new(closecall_run::net::parse(Path::new("street.net.xml"), STREET).unwrap())
}

/// The same where traffic keeps to the left.
pub fn left_hand_street() -> Arc<Net> {
    let mirrored = STREET
        .replace("<net>", r#"<net lefthand="true">"#)
        .replace(",-1.6", ",?")
        .replace(",1.6", ",-1.6")
        .replace(",?", ",1.6");
    Arc::new(closecall_run::net::parse(Path::new("street.net.xml"), mirrored).unwrap())
}
