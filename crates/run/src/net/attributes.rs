//! The attributes of a net's element: texts, numbers within their limits, shapes.

use std::borrow::Cow;
use std::path::Path;

use quick_xml::escape::unescape;
use quick_xml::events::BytesStart;
use quick_xml::events::attributes::Attribute;

use crate::{Error, Result};
use closecall::geometry::Point;
use closecall::util::limits::{HEIGHT, Limit, POSITION};
use closecall::util::units::Metre;

/// The attributes of an element. They borrow from the file unless escaped: large nets have millions.
pub(super) struct ElementAttributes<'a> {
    path: &'a Path,
    line: u64,
    values: Vec<(&'a str, Cow<'a, str>)>,
}

impl<'a> ElementAttributes<'a> {
    /// The attributes of an element in this line of the file.
    pub fn of(tag: &'a BytesStart, path: &'a Path, line: u64) -> Result<Self> {
        let mut attributes = Self { path, line, values: Vec::new() };
        for attribute in tag.attributes() {
            let Attribute { key, value } = attribute.map_err(|error| attributes.wrong(error.to_string()))?;
            let value = match value {
                Cow::Borrowed(value) => unescape(value),
                Cow::Owned(value) => unescape(&value).map(|value| value.into_owned().into()),
            };
            let value = value.map_err(|error| attributes.wrong(error.to_string()))?;
            attributes.values.push((key.into_inner(), value));
        }
        Ok(attributes)
    }

    /// The attribute of this name.
    pub fn get(&self, name: &str) -> Option<&str> {
        self.values.iter().find(|(key, _)| *key == name).map(|(_, value)| &**value)
    }

    /// The same where it has to be there.
    pub fn required(&self, name: &str) -> Result<&str> {
        self.get(name).ok_or_else(|| match self.get("id") {
            Some(id) => self.wrong(format!("\"{id}\" has no attribute \"{name}\"")),
            None => self.wrong(format!("attribute \"{name}\" is missing")),
        })
    }

    /// A number within its limit.
    pub fn number(&self, name: &str, default: f64, limit: &Limit) -> Result<f64> {
        let value = match self.get(name) {
            Some(text) => text.parse().map_err(|_| self.wrong(format!("{name} is \"{text}\", not a number")))?,
            None => default,
        };
        limit.check(name, value).map_err(|why| self.wrong(format!("\"{}\": {why}", self.id())))
    }

    /// The points of a shape and their heights. Repeated points are dropped, since they have no direction, unless fewer than
    /// two would be left.
    pub fn shape(&self, text: &str) -> Result<(Vec<Point>, Vec<Metre>)> {
        let mut points: Vec<Point> = Vec::new();
        let mut heights = Vec::new();
        for triple in text.split_ascii_whitespace() {
            let mut values = triple.split(',').map(|value| value.parse::<f64>().ok());
            let (x, y, z) = (values.next().flatten(), values.next().flatten(), values.next());
            let (Some(x), Some(y), None | Some(Some(_))) = (x, y, z) else {
                return Err(self.wrong(format!("\"{}\": shape point \"{triple}\" is not x,y or x,y,z", self.id())));
            };
            let z = z.flatten().unwrap_or(0.0);
            for (name, value, limit) in [("x", x, &POSITION), ("y", y, &POSITION), ("z", z, &HEIGHT)] {
                limit.check(name, value).map_err(|why| self.wrong(format!("\"{}\": {why}", self.id())))?;
            }
            heights.push(z);
            let point = Point::new(x, y);
            if points.len() != 1 && points.last() == Some(&point) {
                continue;
            }
            if let [first, second] = points[..]
                && first == second
            {
                points.pop();
            }
            points.push(point);
        }
        Ok((points, heights))
    }

    /// What is wrong with the element.
    pub fn wrong(&self, message: impl Into<String>) -> Error {
        Error::line(self.path, self.line, message)
    }

    fn id(&self) -> &str {
        self.get("id").unwrap_or_default()
    }
}
