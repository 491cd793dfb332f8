//! Recordings as replay reads them, compared with the simplest readers of the same files: those of the crates csv and
//! quick-xml, which parse every text anew.

use std::fmt::Write as _;
use std::path::Path;

use closecall::EdgeIndex;
use closecall_run::input::replay::demand::PlannedRoutes;
use closecall_run::input::replay::recorded_step::RecordedStep;
use closecall_run::input::replay::recording::Recording;
use closecall_run::input::replay::routes::Routes;
use proptest::prelude::*;

/// One row with all its values.
#[derive(Clone, Debug, PartialEq)]
struct Simple {
    id: String,
    person: bool,
    type_name: String,
    lane: String,
    /// x, y, z, angle, speed, pos, speedLat as bits.
    numbers: [u64; 7],
}

type Steps = Vec<(f64, Vec<Simple>)>;

const NUMBERS: [&str; 7] = ["x", "y", "z", "angle", "speed", "pos", "speedLat"];

/// The steps that closecall reads, and the message of the error that ends them.
fn read(text: &str) -> (Steps, Option<String>) {
    let mut steps = Steps::new();
    let mut recording = match Recording::parse(Path::new("fcd"), text) {
        Ok(recording) => recording,
        Err(error) => return (steps, Some(error.to_string())),
    };
    let mut step = RecordedStep::default();
    let mut there = Vec::new();
    loop {
        match recording.next_step(&mut step) {
            Ok(true) => {}
            Ok(false) => return (steps, None),
            Err(error) => return (steps, Some(error.to_string())),
        }
        let rows = step.rows().iter().map(|row| Simple {
            id: recording.id(row.user).to_owned(),
            person: row.person,
            type_name: recording.type_name(row).to_owned(),
            lane: recording.lane(row.lane).to_owned(),
            numbers: [row.x, row.y, row.z, row.angle, row.speed, row.position, row.lateral_speed].map(f64::to_bits),
        });
        steps.push((step.time, rows.collect()));
        let now = step.rows().iter().map(|row| row.user).collect::<Vec<_>>();
        let mut gone = there.clone();
        gone.retain(|user| !now.contains(user));
        gone.sort_unstable();
        gone.dedup();
        assert_eq!(step.gone(), gone);
        there = now;
    }
}

fn simple(values: impl Iterator<Item = (String, String)>, person: bool) -> Simple {
    let mut row = Simple {
        id: String::new(),
        person,
        type_name: String::new(),
        lane: String::new(),
        numbers: [f64::NAN, f64::NAN, 0.0, f64::NAN, f64::NAN, f64::NAN, 0.0].map(f64::to_bits),
    };
    for (name, value) in values {
        match &*name {
            "id" => row.id = value,
            "type" => row.type_name = value,
            "lane" => row.lane = value,
            _ => {
                if let Some(place) = NUMBERS.iter().position(|known| *known == name) {
                    row.numbers[place] = value.parse::<f64>().unwrap().to_bits();
                }
            }
        }
    }
    row
}

fn read_csv_simply(text: &str) -> Steps {
    let mut reader = csv::ReaderBuilder::new().delimiter(b';').flexible(true).from_reader(text.as_bytes());
    let names = reader.headers().unwrap().clone();
    let mut steps = Steps::new();
    for record in reader.records() {
        let record = record.unwrap();
        let time = record[0].parse().unwrap();
        if steps.last().is_none_or(|(last, _)| *last != time) {
            steps.push((time, Vec::new()));
        }
        let given = || names.iter().zip(&record).skip(1).filter(|(_, value)| !value.is_empty());
        let person = given().any(|(name, _)| name.starts_with("person_"));
        let row = simple(given().map(|(name, value)| (name.split_once('_').unwrap().1.into(), value.into())), person);
        if !row.id.is_empty() {
            steps.last_mut().unwrap().1.push(row);
        }
    }
    steps
}

fn read_xml_simply(text: &str) -> Steps {
    use quick_xml::events::Event;
    let mut reader = quick_xml::Reader::from_str(text);
    let mut steps = Steps::new();
    loop {
        match reader.read_event().unwrap() {
            Event::Start(tag) | Event::Empty(tag) => {
                let value = |value: &str| quick_xml::escape::unescape(value).unwrap().into_owned();
                let attributes = tag.attributes().map(|attribute| {
                    let attribute = attribute.unwrap();
                    (attribute.key.as_ref().to_owned(), value(&attribute.value))
                });
                match tag.name().as_ref() {
                    "timestep" => {
                        let time = attributes.map(|(_, value)| value).next().unwrap().parse().unwrap();
                        steps.push((time, Vec::new()));
                    }
                    "vehicle" => steps.last_mut().unwrap().1.push(simple(attributes, false)),
                    "person" => steps.last_mut().unwrap().1.push(simple(attributes, true)),
                    _ => {}
                }
            }
            Event::Eof => return steps,
            _ => {}
        }
    }
}

/// A road user in a step, to be written.
#[derive(Clone, Debug)]
struct Written {
    id: String,
    person: bool,
    type_name: String,
    lane: String,
    numbers: Vec<String>,
    /// How it is written: which attributes there are, their order and what is around them.
    style: u8,
}

/// Ids with everything that XML and CSV must escape, short and long.
const ID: &str = "[a-d]|[a-d]{7,9}|[a-d<>&\"';é #]{1,12}";

fn road_user() -> impl Strategy<Value = Written> {
    let number = "-?[0-9]{1,5}\\.[0-9]{2}|-?[0-9]{1,3}|[0-9]\\.[0-9]{9,20}|[0-9]e-?[0-4]";
    let speed = "[0-9]{1,3}\\.[0-9]{2}|[0-9]{1,3}|[0-9]\\.[0-9]{9,20}|[0-9]e-?[0-2]";
    let numbers = (prop::collection::vec(number, 7), prop::array::uniform2(speed)).prop_map(|(mut numbers, speeds)| {
        let [speed, aside] = speeds;
        (numbers[4], numbers[6]) = (speed, aside);
        numbers
    });
    (ID, prop::bool::weighted(0.2), "[ab]?|car", "[ab]_[01]|[é&<]", numbers, 0..16_u8).prop_map(
        |(id, person, type_name, lane, numbers, style)| Written { id, person, type_name, lane, numbers, style },
    )
}

/// Steps in which most road users of the previous step are still there, in the same order.
fn steps() -> impl Strategy<Value = Vec<Vec<Written>>> {
    let all = prop::collection::vec(road_user(), 1..12);
    let present = prop::collection::vec(prop::collection::vec(prop::bool::weighted(0.8), 12), 0..8);
    (all, present, any::<bool>()).prop_map(|(mut all, present, sorted)| {
        all.sort_by(|a, b| (&a.id, a.person).cmp(&(&b.id, b.person)));
        all.dedup_by(|a, b| (&a.id, a.person) == (&b.id, b.person));
        let step = |(index, present): (usize, Vec<bool>)| {
            let mut step =
                all.iter().zip(&present).filter(|(_, here)| **here).map(|(one, _)| one.clone()).collect::<Vec<_>>();
            if !sorted && index % 2 == 1 {
                step.reverse();
            }
            for one in &mut step {
                one.numbers[0] = format!("{index}.25");
                if index % 3 == 2 {
                    one.lane = "c_0".to_owned();
                }
            }
            step
        };
        present.into_iter().enumerate().map(step).collect()
    })
}

fn as_csv(steps: &[Vec<Written>], line_end: &str) -> String {
    let mut names = vec!["id", "type", "lane", "more"];
    names.extend(NUMBERS);
    let mut text = "timestep_time".to_owned();
    for kind in ["vehicle", "person"] {
        names.iter().for_each(|name| write!(text, ";{kind}_{name}").unwrap());
    }
    text += line_end;
    for (index, step) in steps.iter().enumerate() {
        if step.is_empty() {
            write!(text, "{index}.10{line_end}").unwrap();
        }
        for one in step {
            let quoted = |value: &str| match value.contains([';', '"']) || one.style & 1 == 1 {
                true => format!("\"{}\"", value.replace('"', "\"\"")),
                false => value.to_owned(),
            };
            write!(text, "{index}.10").unwrap();
            if one.person {
                text += &";".repeat(names.len());
            }
            let more = if one.style & 2 == 2 { "\"a\nb\"" } else { "" };
            write!(text, ";{};{};{};{more}", quoted(&one.id), quoted(&one.type_name), quoted(&one.lane)).unwrap();
            one.numbers.iter().for_each(|number| write!(text, ";{number}").unwrap());
            if !one.person && one.style & 4 == 4 {
                text += &";".repeat(names.len());
            }
            text += line_end;
        }
    }
    text
}

fn as_xml(steps: &[Vec<Written>]) -> String {
    let mut text = "<?xml version=\"1.0\"?>\n<!-- a > b & <vehicle/> -->\n<fcd-export a='>'>\n".to_owned();
    for (index, step) in steps.iter().enumerate() {
        if step.is_empty() && index % 2 == 0 {
            writeln!(text, "<timestep time=\"{index}.10\"/>").unwrap();
            continue;
        }
        writeln!(text, "<timestep time=\"{index}.10\">").unwrap();
        for one in step {
            let mark = if one.style & 1 == 1 { '\'' } else { '"' };
            let blank = if one.style & 2 == 2 { "\n\t" } else { " " };
            let escaped = |value: &str| {
                let value =
                    value.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;").replace('\'', "&apos;");
                if one.style & 4 == 4 { value } else { value.replace('>', "&gt;") }
            };
            let kind = if one.person { "person" } else { "vehicle" };
            write!(text, "  <{kind}").unwrap();
            let mut values = vec![("id", escaped(&one.id))];
            values.extend(NUMBERS.into_iter().zip(one.numbers.iter().cloned()));
            values.extend([("type", escaped(&one.type_name)), ("lane", escaped(&one.lane)), ("more", ">".to_owned())]);
            if one.style & 8 == 8 {
                values.swap(0, 10);
                values.swap(3, 8);
            }
            values.iter().for_each(|(name, value)| write!(text, "{blank}{name}={mark}{value}{mark}").unwrap());
            if one.style & 12 == 12 {
                writeln!(text, "><param key=\"a\" value=\"b\"/></{kind}>").unwrap()
            } else {
                text += "/>\n"
            }
        }
        text += "</timestep>\n";
    }
    text + "</fcd-export>\n"
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn a_csv_recording_equals_what_the_simple_reader_reads(steps in steps(), windows in any::<bool>()) {
        let text = as_csv(&steps, if windows { "\r\n" } else { "\n" });
        let (read, error) = read(&text);
        prop_assert_eq!(error, None);
        prop_assert_eq!(read, read_csv_simply(&text));
    }

    #[test]
    fn an_xml_recording_equals_what_the_simple_reader_reads(steps in steps()) {
        let text = as_xml(&steps);
        let (read, error) = read(&text);
        prop_assert_eq!(error, None);
        prop_assert_eq!(read, read_xml_simply(&text));
    }

    #[test]
    fn a_recording_that_ends_anywhere_is_cut_short_there(steps in steps(), part in 0.0..1.0) {
        let text = as_xml(&steps);
        let from = text.find("<timestep").unwrap_or(0);
        let mut end = from + ((text.len() - from) as f64 * part) as usize;
        while !text.is_char_boundary(end) {
            end += 1;
        }
        if !text[..end].contains("</fcd-export>") && from > 0 {
            let (read, error) = read(&text[..end]);
            prop_assert!(error.unwrap().contains("cut short after"));
            prop_assert_eq!(&read[..], &read_xml_simply(&text)[..read.len()]);
        }
    }
}

/// The files are longer than the blocks in which they are read, so that rows cross the blocks' borders.
#[test]
fn rows_across_the_blocks_of_a_file_are_whole() {
    let one = |id: usize| Written {
        id: format!("vehicle{id}"),
        person: false,
        type_name: "car".to_owned(),
        lane: format!("e{}_0", id % 17),
        numbers: (0..7).map(|number| format!("{}.{id:02}", id * number % 1000)).collect(),
        style: 0,
    };
    let steps = (0..20).map(|step| (step * 7..step * 7 + 900).map(one).collect()).collect::<Vec<Vec<_>>>();
    let (csv, xml) = (as_csv(&steps, "\n"), as_xml(&steps));
    assert!(csv.len() > 1 << 20 && xml.len() > 1 << 20);
    assert_eq!(read(&csv), (read_csv_simply(&csv), None));
    assert_eq!(read(&xml), (read_xml_simply(&xml), None));
}

#[test]
fn what_is_wrong_is_named_with_its_line() {
    let xml = |row: &str| format!("<fcd-export>\n<timestep time=\"1\">\n<vehicle {row}/>\n</timestep>\n</fcd-export>");
    let csv = |row: &str| format!("timestep_time;vehicle_id;vehicle_x;vehicle_y;vehicle_angle;vehicle_speed\n{row}\n");
    for (text, said) in [
        (xml(r#"id="a" x="1" y="?" angle="0" speed="0""#), r#"fcd, line 3: y is "?", not a number"#),
        (xml(r#"id="a" x="1" y="2" angle="0""#), r#"fcd, line 3: "a" has no attribute speed"#),
        (xml(r#"id="a" x="1" y="2" x="1" angle="0" speed="0""#), "fcd, line 3: an attribute is given twice"),
        (xml(r#"x="1" y="2" angle="0" speed="0""#), r#"fcd, line 3: "" has no attribute id"#),
        (xml(r"id=a"), r#"fcd, line 3: "id=a/" is not an attribute"#),
        (xml("").replace("\"1\"", "\"x\""), r#"fcd, line 2: time is "x""#),
        (xml("").replace("\"1\"", "\"inf\""), r#"fcd, line 2: time is "inf""#),
        (xml("").replace("time=", "when="), "fcd, line 2: a timestep without time"),
        (csv("0;a;1;2;x;3"), r#"fcd, line 2: angle is "x", not a number"#),
        (csv("0;a;1;2;3"), r#"fcd, line 2: "a" has no value in column speed"#),
        (csv("0;a;1;2;3;4\n\n-1;a;1;2;3;4"), "fcd, line 4: time -1 s follows 0 s"),
        (csv("x;a;1;2;3;4"), r#"fcd, line 2: timestep_time is "x""#),
        (csv("0;a;1;2;3;4\n1;a"), r#"fcd, line 3: "a" has no value in column x"#),
        (csv("0;\"a;1;2;3;4"), "fcd: cut short after time NaN s: the last row is incomplete"),
        ("\u{feff}".to_owned(), "fcd: the file is empty"),
        (csv("0;;1;2;3;4"), "fcd, line 2: a row without id, but x is 1: whose is it?"),
        (csv("0;a;1;2;3;-5"), "fcd, line 2: \"a\": speed is -5, it must be 0 to 1000 m/s"),
        (csv("").replace("_y", "_x"), "fcd: it has no column vehicle_y"),
        (csv("").replace("speed", "speed;vehicle_x"), "fcd: its columns vehicle_x and vehicle_x are the same"),
        (csv("").replace("speed", "speed;x"), "fcd: its columns vehicle_x and x are the same"),
        (
            xml("").replace("<vehicle />\n</timestep>", ""),
            "fcd, line 4: the timestep of 1 s is not closed: its </timestep> is missing",
        ),
        (
            xml("").replace("<vehicle />\n</timestep>", "<timestep time=\"2\"/>"),
            "fcd, line 3: the timestep of 1 s is not closed: its </timestep> is missing",
        ),
        (
            xml("").replace("<vehicle />", "</timestep><person/>"),
            "fcd, line 3: a road user stands outside of a timestep",
        ),
        (
            "<fcd-export>\n</fcd-export>\n<!-- -->\n<fcd-export/>".to_owned(),
            "fcd, line 4: <fcd-export> follows after the end of the recording: are there two in one file?",
        ),
        ("<net/>".to_owned(), "fcd: it is not an fcd-output: its root element is <net>, not <fcd-export>"),
    ] {
        assert_eq!(read(&text).1.as_deref(), Some(said), "{text}");
    }
}

#[test]
fn a_byte_order_mark_is_passed_over() {
    let steps = [vec![], vec![]];
    for text in [as_csv(&steps, "\n"), as_xml(&steps)] {
        assert_eq!(read(&format!("\u{feff}{text}")), read(&text));
        assert_eq!(read(&text).1, None);
    }
}

/// SUMO names the columns after the kind of the first road user, and gives vehicles a lane and persons an edge.
#[test]
fn lane_or_edge_tells_vehicles_from_persons_in_shared_columns() {
    for kind in ["vehicle", "person"] {
        let names = ["id", "x", "y", "angle", "speed", "lane", "edge"].map(|name| format!("{kind}_{name}")).join(";");
        let text = format!("timestep_time;{names}\n0;car;1;2;90;3;a_0;\n0;walker;1;2;90;1;;a\n0;unknown;1;2;90;1;;\n");
        let (steps, error) = read(&text);
        assert_eq!(error, None);
        let persons = steps[0].1.iter().map(|row| (&*row.id, row.person)).collect::<Vec<_>>();
        assert_eq!(persons, [("car", false), ("walker", true), ("unknown", kind == "person")]);
    }
}

/// A vehicle and a person may have the same id in SUMO.
#[test]
fn a_vehicle_and_a_person_may_share_an_id() {
    let row = "id=\"a\" x=\"1\" y=\"2\" angle=\"0\" speed=\"1\"";
    let text = format!("<fcd-export><timestep time=\"0\"><vehicle {row}/><person {row}/></timestep></fcd-export>");
    let mut recording = Recording::parse(Path::new("fcd"), text).unwrap();
    let mut step = RecordedStep::default();
    assert!(recording.next_step(&mut step).unwrap());
    assert_ne!(step.rows()[0].user, step.rows()[1].user);
}

/// A recording on a net of roads e0, e1, …, and its routes.
fn read_routes(rows: impl Iterator<Item = (f64, String, usize)>) -> (tempfile::NamedTempFile, Routes) {
    let edge = |n| format!(r#"<edge id="e{n}"><lane id="e{n}_0" length="9" shape="0,{n} 9,{n}"/></edge>"#);
    let net = format!("<net>{}</net>", (0..200).map(edge).collect::<String>());
    let net = closecall_run::net::parse(Path::new("net"), net).unwrap();
    let mut text = "timestep_time;vehicle_id;vehicle_x;vehicle_y;vehicle_angle;vehicle_speed;vehicle_lane\n".to_owned();
    rows.for_each(|(time, id, edge)| writeln!(text, "{time};{id};0;0;0;1;e{edge}_0").unwrap());
    let file = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(file.path(), text).unwrap();
    let routes = Routes::read(file.path(), &net, PlannedRoutes::none().unwrap(), None, &mut || false).unwrap();
    (file, routes)
}

/// The routes of this number of vehicles in the order of arrival, and the vehicle's number for each entry into the scene.
fn routes(
    vehicles: u64,
    entering: usize,
    rows: impl Iterator<Item = (f64, String, usize)>,
) -> (Vec<Vec<u32>>, Vec<u64>) {
    let (_, mut routes) = read_routes(rows);
    let route = |number| routes.of(number).unwrap().edges.iter().map(|EdgeIndex(edge)| *edge).collect();
    let routes_of_all = (0..vehicles).map(route).collect();
    (routes_of_all, (0..entering).map(|_| routes.enter().unwrap()).collect())
}

#[test]
fn a_returning_vehicle_continues_its_route_unless_absent_for_long() {
    // a stays, b is absent for 300 s (SUMO put it further along), c for 700 s.
    let steps = (0..1000).flat_map(|time| {
        let there = |id: &str| match id {
            "b" => !(100..400).contains(&time),
            "c" => !(100..800).contains(&time),
            _ => true,
        };
        let row = move |id: &str| (f64::from(time), id.to_owned(), if time < 500 { 1 } else { 2 });
        ["a", "b", "c"].into_iter().filter(|id| there(id)).map(row).collect::<Vec<_>>()
    });
    let (routes, entering) = routes(4, 5, steps);
    assert_eq!(routes, [vec![1, 2], vec![1, 2], vec![1], vec![2]]);
    assert_eq!(entering, [0, 1, 2, 1, 3], "a, b, c, b again, another c");
}

#[test]
fn a_recording_that_grows_while_it_is_read_is_named() {
    let (file, mut routes) = read_routes([(0.0, "a".to_owned(), 1)].into_iter());
    assert_eq!(routes.enter().unwrap(), 0);
    let error = routes.enter().unwrap_err().to_string();
    assert!(error.starts_with(&*file.path().to_string_lossy()) && error.contains("has grown"), "{error}");
}

#[test]
fn routes_too_large_for_memory_are_read_from_the_file() {
    const VEHICLES: u64 = 2000;
    // They leave in another order than they arrive: the route of vehicle n has 150 − n % 50 edges, from edge n % 40 on.
    let steps = (0..150).flat_map(|step| {
        let row = move |n: u64| (step as f64, format!("v{n}"), (n % 40 + step) as usize);
        (0..VEHICLES).filter(move |n| step < 150 - n % 50).map(row)
    });
    let (routes, entering) = routes(VEHICLES, VEHICLES as usize, steps);
    assert!(entering.into_iter().eq(0..VEHICLES));
    for (n, route) in (0..).zip(routes) {
        let first = n as u32 % 40;
        assert_eq!(route, (first..first + 150 - n as u32 % 50).collect::<Vec<_>>(), "v{n}");
    }
}
