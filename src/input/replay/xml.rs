//! fcd-output in XML.
//!
//! SUMO writes the same attributes in the same order in almost every row, so each is first compared with the one that
//! stood at its place in the row before. What does not fit is read as XML may be written.

use std::path::{Path, PathBuf};

use super::names::Users;
use super::number::number;
use super::rows::{Attribute, Extent, Step, cut_short, in_order};
use super::source::{Source, find};
use crate::util::units::Second;
use crate::{Error, Result};

/// An `<fcd-export>` that is being read.
pub(super) struct XmlRecording {
    path: PathBuf,
    source: Source,
    /// The attributes of the last vehicle, and of the last person.
    shapes: [Shape; 2],
    last: Option<Second>,
}

/// The attributes of a row, as they stood one after the other.
#[derive(Debug)]
struct Shape {
    person: bool,
    extent: Extent,
    expected: Vec<Expected>,
}

/// An attribute as it stood at its place in the row before.
#[derive(Debug)]
struct Expected {
    /// From the blank before its name to its quotation mark: ` id="`.
    start: Box<[u8]>,
    /// Its first eight bytes, as far as it has so many, and which these are.
    first: u64,
    mask: u64,
    attribute: Option<Attribute>,
}

/// What stands between `<` and `>`.
enum Found<'a> {
    /// A tag's name and what follows it, up to its end: attributes, and a stroke if it is empty.
    Start(&'a [u8], &'a [u8]),
    End(&'a [u8]),
    Passed,
}

impl XmlRecording {
    pub fn new(path: &Path, mut source: Source, extent: Extent) -> Result<Self> {
        source.look_out_for(b'&');
        loop {
            let next = next(&mut source).map_err(|error| Error::content(path, error))?;
            let Some(end) = next else {
                return Err(Error::content(path, "it is no fcd-output: there is no <fcd-export>"));
            };
            match found(&source.rest()[1..end]) {
                Found::Start(b"fcd-export", attributes) if attributes.ends_with(b"/") => {
                    return Err(Error::content(path, "the recording has no steps"));
                }
                Found::Start(b"fcd-export", _) => {
                    source.consume(end + 1);
                    let shapes = [false, true].map(|person| Shape { person, extent, expected: Vec::new() });
                    return Ok(Self { path: path.to_owned(), source, shapes, last: None });
                }
                Found::Start(..) | Found::End(_) => {
                    return Err(Error::content(path, "it is no fcd-output: its root element is not <fcd-export>"));
                }
                Found::Passed => source.consume(end + 1),
            }
        }
    }

    pub fn next_step(&mut self, step: &mut Step, users: &mut Users) -> Result<bool> {
        let mut inside = false;
        loop {
            let cut = |message: &str| cut_short(&self.path, self.last, message);
            let next = next(&mut self.source).map_err(|error| cut(&error))?;
            let Some(end) = next else { return Err(cut("the file ends before </fcd-export>")) };
            let wrong = |message| Error::line(&self.path, self.source.line(), message);
            let mut ended = false;
            match found(&self.source.rest()[1..end]) {
                Found::Start(kind @ (b"vehicle" | b"person"), attributes) if inside => {
                    let shape = &mut self.shapes[usize::from(kind == b"person")];
                    if self.source.is_marked() && attributes.contains(&b'&') {
                        shape.add_unescaped(attributes, step, users).map_err(wrong)?;
                    } else {
                        shape.add(attributes, step, users).map_err(wrong)?;
                    }
                }
                Found::Start(b"timestep", attributes) => {
                    let time = time(attributes).map_err(wrong)?;
                    in_order(self.last, time).map_err(wrong)?;
                    step.begin(time, users);
                    inside = true;
                    ended = attributes.ends_with(b"/");
                }
                Found::End(b"timestep") => ended = inside,
                Found::End(b"fcd-export") => return Ok(false),
                _ => {}
            }
            self.source.consume(end + 1);
            if ended {
                step.end(users);
                self.last = Some(step.time);
                return Ok(true);
            }
        }
    }
}

/// Goes on to the next tag; returns where its `>` stands in the rest, none at the file's end.
#[inline]
fn next(source: &mut Source) -> std::result::Result<Option<usize>, String> {
    loop {
        // Text between tags says nothing here.
        let rest = source.rest();
        let text = find(rest, b'<').unwrap_or(rest.len());
        source.consume(text);
        if let Some(end) = end_of(source.rest()) {
            return Ok(Some(end));
        }
        match source.more() {
            Ok(true) => {}
            Ok(false) if source.rest().is_empty() => return Ok(None),
            Ok(false) => return Err("the file ends within a tag".to_owned()),
            Err(error) => return Err(error.to_string()),
        }
    }
}

/// What a tag is, without its `<` and `>`.
#[inline]
fn found(tag: &[u8]) -> Found<'_> {
    match tag {
        [b'!' | b'?', ..] => Found::Passed,
        [b'/', name @ ..] => Found::End(name.trim_ascii_end()),
        _ => {
            let name = tag.iter().position(|byte| byte.is_ascii_whitespace() || *byte == b'/');
            let (name, attributes) = tag.split_at(name.unwrap_or(tag.len()));
            Found::Start(name, attributes)
        }
    }
}

/// Where the `>` of what begins here stands; none where more has to be read to know.
#[inline]
fn end_of(rest: &[u8]) -> Option<usize> {
    let close = |ending: &[u8]| memchr::memmem::find(rest, ending).map(|place| place + ending.len() - 1);
    match rest {
        [_, b'?', ..] => close(b"?>"),
        [_, b'!', b'-', b'-', ..] => memchr::memmem::find(rest.get(4..)?, b"-->").map(|place| place + 6),
        [_, b'!', b'[', ..] => close(b"]]>"),
        _ => {
            let mut end = memchr::memchr2(b'>', b'\'', rest)?;
            // In a value there may be a > too: then its quotation marks are counted.
            if rest[end] == b'\'' || rest[..end].ends_with(b"=\"") || !is_value_end(rest, end) {
                end = end_outside_values(rest)?;
            }
            Some(end)
        }
    }
}

/// Whether a `>` stands where a value has just ended, or where there was none.
#[inline]
fn is_value_end(rest: &[u8], end: usize) -> bool {
    let before = rest[..end].strip_suffix(b"/").unwrap_or(&rest[..end]);
    before.ends_with(b"\"") || !before.contains(&b'"')
}

#[cold]
fn end_outside_values(rest: &[u8]) -> Option<usize> {
    let mut quote = None;
    rest.iter().position(|byte| {
        match (quote, *byte) {
            (None, b'>') => return true,
            (None, b'"' | b'\'') => quote = Some(*byte),
            (Some(mark), byte) if mark == byte => quote = None,
            _ => {}
        }
        false
    })
}

fn time(attributes: &[u8]) -> std::result::Result<Second, String> {
    let mut rest = attributes;
    while let Some((_, name, value, further)) = attribute(rest)? {
        if name == b"time" {
            return number(value).ok_or_else(|| format!("time is \"{}\"", String::from_utf8_lossy(value)));
        }
        rest = further;
    }
    Err("a timestep without time".to_owned())
}

impl Shape {
    fn add(&mut self, attributes: &[u8], step: &mut Step, users: &mut Users) -> std::result::Result<(), String> {
        let mut fields = self.extent.fields();
        fields.person = self.person;
        let (mut rest, mut given) = (attributes, 0);
        for place in 0.. {
            let known = self.expected.get(place).and_then(|known| known.split(rest));
            let (attribute, value) = match known {
                Some((attribute, value, further)) => {
                    rest = further;
                    (attribute, value)
                }
                None => {
                    let Some((start, name, value, further)) = attribute(rest)? else { break };
                    let attribute = self.extent.attribute(name);
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
        // What ends with another mark is not sought by ".
        if start.ends_with(b"\"") && place <= self.expected.len() {
            self.expected.truncate(place);
            let mut bytes = [[0; 8]; 2];
            for (place, byte) in start.iter().take(8).enumerate() {
                (bytes[0][place], bytes[1][place]) = (*byte, 0xff);
            }
            let [first, mask] = bytes.map(u64::from_le_bytes);
            self.expected.push(Expected { start: start.into(), first, mask, attribute });
        }
    }

    /// A row in which something is escaped.
    #[cold]
    fn add_unescaped(&self, attributes: &[u8], step: &mut Step, users: &mut Users) -> std::result::Result<(), String> {
        let (mut values, mut rest, mut given) = (Vec::new(), attributes, 0);
        while let Some((_, name, value, further)) = attribute(rest)? {
            rest = further;
            let Some(attribute) = self.extent.attribute(name) else { continue };
            once(attribute, &mut given)?;
            let text = std::str::from_utf8(value).map_err(|error| error.to_string())?;
            values.push((attribute, quick_xml::escape::unescape(text).map_err(|error| error.to_string())?));
        }
        let mut fields = self.extent.fields();
        fields.person = self.person;
        values.iter().try_for_each(|(attribute, value)| fields.set(*attribute, value.as_bytes()))?;
        step.add(&fields, users, "attribute")
    }
}

/// What an attribute says, its value, and what follows.
type Known<'a> = (Option<Attribute>, &'a [u8], &'a [u8]);

impl Expected {
    /// Splits off this attribute, if it is here.
    #[inline]
    fn split<'a>(&self, rest: &'a [u8]) -> Option<Known<'a>> {
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

/// An attribute: all up to its value, its name, its value, and what follows.
type Split<'a> = (&'a [u8], &'a [u8], &'a [u8], &'a [u8]);

/// The first attribute of a tag; none where there is no more.
fn attribute(rest: &[u8]) -> std::result::Result<Option<Split<'_>>, String> {
    let text = rest.trim_ascii_start();
    if text.is_empty() || text == b"/" {
        return Ok(None);
    }
    let bad = || format!("\"{}\" is no attribute", String::from_utf8_lossy(&text[..text.len().min(40)]));
    let equals = find(text, b'=').ok_or_else(bad)?;
    let name = text[..equals].trim_ascii_end();
    let after = text[equals + 1..].trim_ascii_start();
    let (Some(mark @ (b'"' | b'\'')), false) = (after.first(), name.is_empty()) else { return Err(bad()) };
    let value = &after[1..];
    let end = find(value, *mark).ok_or_else(bad)?;
    let start = &rest[..rest.len() - value.len()];
    Ok(Some((start, name, &value[..end], &value[end + 1..])))
}
