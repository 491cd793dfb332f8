//! fcd-output in XML.
//!
//! SUMO writes the same attributes in the same order in almost every row. Each attribute is therefore first compared with
//! the one at its place in the previous row; where they differ, any attribute that XML allows is read.

use std::path::{Path, PathBuf};

use super::clock;
use super::fcd_attributes::{Attribute, Scope};
use super::names::Users;
use super::recorded_step::{RecordedStep, cut_short, in_order};
use super::source::{ByteWindow, find};
use super::tags::{Tag, TagFault, next_tag};
use crate::util::decimal::Written;
use crate::{Error, Result};
use closecall::util::units::Second;

/// Bytes of an element's name that a message shows.
const NAMED: usize = 40;

/// An `<fcd-export>` being read.
pub(super) struct XmlRecording {
    path: PathBuf,
    source: ByteWindow,
    /// The attributes of the last vehicle and of the last person.
    patterns: [RowPattern; 2],
    last: Option<Second>,
}

/// The attributes of a row, in their order.
#[derive(Debug)]
struct RowPattern {
    person: bool,
    scope: Scope,
    expected: Vec<ExpectedAttribute>,
}

/// The attribute at its place in the previous row.
#[derive(Debug)]
struct ExpectedAttribute {
    /// From the blank before its name to the opening quotation mark: ` id="`.
    start: Box<[u8]>,
    /// The first eight bytes of `start`, or fewer if it is shorter, and a mask of the bytes that count.
    first: u64,
    mask: u64,
    attribute: Option<Attribute>,
}

impl XmlRecording {
    pub fn new(path: &Path, mut source: ByteWindow, scope: Scope) -> Result<Self> {
        source.look_out_for(b'&');
        loop {
            let next = next_tag(&mut source).map_err(|fault| fault.at(path, source.line()))?;
            let Some(end) = next else {
                return Err(Error::content(path, "it is not an fcd-output: it has no <fcd-export>"));
            };
            match Tag::of(&source.rest()[1..end]) {
                Tag::Start(b"fcd-export", attributes) if attributes.ends_with(b"/") => {
                    return Err(Error::content(path, "the recording has no steps"));
                }
                Tag::Start(b"fcd-export", _) => {
                    source.consume(end + 1);
                    let patterns = [false, true].map(|person| RowPattern { person, scope, expected: Vec::new() });
                    return Ok(Self { path: path.to_owned(), source, patterns, last: None });
                }
                Tag::Start(name, _) | Tag::End(name) => {
                    let name = String::from_utf8_lossy(&name[..name.len().min(NAMED)]);
                    let why = format!("it is not an fcd-output: its root element is <{name}>, not <fcd-export>");
                    return Err(Error::content(path, why));
                }
                Tag::Other => source.consume(end + 1),
            }
        }
    }

    pub fn next_step(&mut self, step: &mut RecordedStep, users: &mut Users) -> Result<bool> {
        let mut inside = false;
        loop {
            let cut = |message: &str| cut_short(&self.path, self.last, message);
            let next = next_tag(&mut self.source).map_err(|fault| match fault {
                TagFault::CutShort(message) => cut(&message),
                TagFault::TooLong => fault.at(&self.path, self.source.line()),
            })?;
            let Some(end) = next else { return Err(cut("the file ends before </fcd-export>")) };
            let wrong = |message| Error::line(&self.path, self.source.line(), message);
            let mut is_complete = false;
            match Tag::of(&self.source.rest()[1..end]) {
                Tag::Start(kind @ (b"vehicle" | b"person"), attributes) if inside => {
                    let pattern = &mut self.patterns[usize::from(kind == b"person")];
                    if self.source.is_marked() && attributes.contains(&b'&') {
                        pattern.add_unescaped(attributes, step, users).map_err(wrong)?;
                    } else {
                        pattern.add(attributes, step, users).map_err(wrong)?;
                    }
                }
                Tag::Start(b"timestep", _) if inside => return Err(wrong(unclosed(step.time))),
                Tag::Start(b"timestep", attributes) => {
                    let time = time(attributes).map_err(wrong)?;
                    in_order(self.last, time).map_err(wrong)?;
                    step.begin(time, users);
                    inside = true;
                    is_complete = attributes.ends_with(b"/");
                }
                Tag::End(b"timestep") if inside => is_complete = true,
                Tag::End(b"fcd-export") if inside => return Err(wrong(unclosed(step.time))),
                Tag::End(b"fcd-export") => {
                    self.source.consume(end + 1);
                    return self.nothing_follows().map(|()| false);
                }
                Tag::Start(b"vehicle" | b"person", _) => {
                    return Err(wrong("a road user stands outside of a timestep".to_owned()));
                }
                // Such as containers.
                Tag::Start(..) => step.left_out.elements += 1,
                Tag::End(_) | Tag::Other => {}
            }
            self.source.consume(end + 1);
            if is_complete {
                step.end(users);
                self.last = Some(step.time);
                return Ok(true);
            }
        }
    }

    /// Checks that the recording is all that is in the file.
    fn nothing_follows(&mut self) -> Result<()> {
        loop {
            let next = next_tag(&mut self.source).map_err(|fault| fault.at(&self.path, self.source.line()))?;
            let Some(end) = next else { return Ok(()) };
            if let Tag::Start(name, _) | Tag::End(name) = Tag::of(&self.source.rest()[1..end]) {
                let name = String::from_utf8_lossy(&name[..name.len().min(NAMED)]);
                let why = format!("<{name}> follows after the end of the recording: are there two in one file?");
                return Err(Error::line(&self.path, self.source.line(), why));
            }
            self.source.consume(end + 1);
        }
    }
}

fn unclosed(time: Second) -> String {
    format!("the timestep of {} s is not closed: its </timestep> is missing", Written(time))
}

fn time(attributes: &[u8]) -> std::result::Result<Second, String> {
    let mut rest = attributes;
    while let Some((_, name, value, further)) = attribute(rest)? {
        if name == b"time" {
            return clock::time(value).ok_or_else(|| format!("time is \"{}\"", String::from_utf8_lossy(value)));
        }
        rest = further;
    }
    Err("a timestep without time".to_owned())
}

impl RowPattern {
    fn add(
        &mut self,
        attributes: &[u8],
        step: &mut RecordedStep,
        users: &mut Users,
    ) -> std::result::Result<(), String> {
        let mut fields = self.scope.fields();
        fields.person = self.person;
        let mut rest = attributes;
        let mut given = 0;
        for place in 0.. {
            let known = self.expected.get(place).and_then(|known| known.split(rest));
            let (attribute, value) = match known {
                Some((attribute, value, further)) => {
                    rest = further;
                    (attribute, value)
                }
                None => {
                    let Some((start, name, value, further)) = attribute(rest)? else { break };
                    let attribute = self.scope.attribute(name);
                    self.expect(place, start, attribute);
                    rest = further;
                    (attribute, value)
                }
            };
            let Some(attribute) = attribute else { continue };
            once(attribute, &mut given)?;
            fields.set(attribute, value)?;
        }
        step.add(&fields, users, "attribute")
    }

    #[cold]
    fn expect(&mut self, place: usize, start: &[u8], attribute: Option<Attribute>) {
        // Only values in double quotes: `split` looks for the closing ".
        if start.ends_with(b"\"") && place <= self.expected.len() {
            self.expected.truncate(place);
            let mut first = [0; 8];
            let mut mask = [0; 8];
            for (place, byte) in start.iter().take(8).enumerate() {
                first[place] = *byte;
                mask[place] = 0xff;
            }
            let [first, mask] = [first, mask].map(u64::from_le_bytes);
            self.expected.push(ExpectedAttribute { start: start.into(), first, mask, attribute });
        }
    }

    /// Adds a row with escaped characters.
    #[cold]
    fn add_unescaped(
        &self,
        attributes: &[u8],
        step: &mut RecordedStep,
        users: &mut Users,
    ) -> std::result::Result<(), String> {
        let mut values = Vec::new();
        let mut rest = attributes;
        let mut given = 0;
        while let Some((_, name, value, further)) = attribute(rest)? {
            rest = further;
            let Some(attribute) = self.scope.attribute(name) else { continue };
            once(attribute, &mut given)?;
            let text = std::str::from_utf8(value).map_err(|error| error.to_string())?;
            values.push((attribute, quick_xml::escape::unescape(text).map_err(|error| error.to_string())?));
        }
        let mut fields = self.scope.fields();
        fields.person = self.person;
        values.iter().try_for_each(|(attribute, value)| fields.set(*attribute, value.as_bytes()))?;
        step.add(&fields, users, "attribute")
    }
}

/// Which attribute it is, its value, and what follows it.
type Recognised<'a> = (Option<Attribute>, &'a [u8], &'a [u8]);

impl ExpectedAttribute {
    /// Splits this attribute off, if `rest` begins with it.
    #[inline]
    fn split<'a>(&self, rest: &'a [u8]) -> Option<Recognised<'a>> {
        if u64::from_le_bytes(*rest.first_chunk::<8>()?) & self.mask != self.first {
            return None;
        }
        if self.start.len() > 8 && rest.get(8..self.start.len())? != &self.start[8..] {
            return None;
        }
        let after = &rest[self.start.len()..];
        let end = find(after, b'"')?;
        Some((self.attribute, &after[..end], &after[end + 1..]))
    }
}

fn once(attribute: Attribute, given: &mut u32) -> std::result::Result<(), String> {
    let bit = attribute.bit();
    if *given & bit != 0 {
        return Err("an attribute is given twice".to_owned());
    }
    *given |= bit;
    Ok(())
}

/// An attribute: everything up to its value, its name, its value, and what follows it.
type Split<'a> = (&'a [u8], &'a [u8], &'a [u8], &'a [u8]);

/// The first attribute of a tag; none at its end.
fn attribute(rest: &[u8]) -> std::result::Result<Option<Split<'_>>, String> {
    let text = rest.trim_ascii_start();
    if text.is_empty() || text == b"/" {
        return Ok(None);
    }
    let bad = || format!("\"{}\" is not an attribute", String::from_utf8_lossy(&text[..text.len().min(40)]));
    let equals = find(text, b'=').ok_or_else(bad)?;
    let name = text[..equals].trim_ascii_end();
    let after = text[equals + 1..].trim_ascii_start();
    let (Some(mark @ (b'"' | b'\'')), false) = (after.first(), name.is_empty()) else { return Err(bad()) };
    let value = &after[1..];
    let end = find(value, *mark).ok_or_else(bad)?;
    let start = &rest[..rest.len() - value.len()];
    Ok(Some((start, name, &value[..end], &value[end + 1..])))
}
