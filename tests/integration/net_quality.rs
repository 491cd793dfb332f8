//! Warnings about a net that is not drawn as it is driven.

use closecall::traffic::net::Net;
use closecall::traffic::net::quality::{lengths, overlapping};
use closecall::util::units::Metre;
use std::path::Path;

fn net(lengths: &[(Metre, Metre)]) -> Net {
    let lane = |number: usize, (length, drawn): &(Metre, Metre)| {
        let y = number as f64 * 1.5;
        format!(r#"<edge id="e{number}"><lane id="e{number}_0" length="{length}" shape="0,{y} {drawn},{y}"/></edge>"#)
    };
    let edges = lengths.iter().enumerate().map(|(number, pair)| lane(number, pair)).collect::<String>();
    closecall_run::net::parse(Path::new("e.net.xml"), format!("<net>{edges}</net>")).unwrap()
}

#[test]
fn lengths_that_differ_from_the_shape_are_counted_and_the_worst_named() {
    let pairs = [(100.0, 104.0), (44.9, 20.9), (10.0, 12.0), (0.1, 0.02)];
    let said =
        "2 of 4 lanes are longer or shorter than drawn by more than 5 %; the worst is e1_0: 44.9 m, drawn 20.9 m";
    assert_eq!(lengths(&net(&pairs)).as_deref(), Some(said));
    assert_eq!(lengths(&net(&[(100.0, 104.0), (0.1, 0.02)])), None);
}

#[test]
fn places_that_overlap_are_counted_and_the_worst_named() {
    let remark = |count| {
        let net = net(&vec![(10.0, 10.0); count]);
        overlapping(&net, &net.overlaps())
    };
    assert_eq!(remark(1), None);
    let one = "e0_0 and e1_0 by 0.30 m";
    assert_eq!(remark(2), Some(format!("2 lanes overlap as drawn: {one}")));
    let many = format!("5 pairs of lanes overlap as drawn, the worst first: {one}, e1_0 and e2_0 by 0.30 m");
    assert!(remark(6).is_some_and(|said| said.starts_with(&many) && said.ends_with(", …")));
}
