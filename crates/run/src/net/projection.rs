//! Between degrees (`--fcd-output.geo`, the columns `lon` and `lat`) and the net's metres.
//!
//! As in SUMO, only the net's projection is applied, without a shift between datums: the degrees are those of the
//! projection's own ellipsoid.

use proj4rs::Proj;
use proj4rs::transform::transform;

use closecall::geometry::{Point, Vector};
use closecall::traffic::net::degrees::ToDegrees;
use closecall::traffic::net::elements::Location;
use closecall::util::limits::POSITION;
use closecall::util::units::{Degree, Metre};

/// Parameters of a projection that describe its ellipsoid.
const ELLIPSOID: [&str; 9] = ["+ellps=", "+datum=", "+a=", "+b=", "+rf=", "+f=", "+R=", "+towgs84=", "+nadgrids="];
/// netconvert's simple projection (`--simple-projection`): metres per degree of longitude at the equator and of latitude.
const SIMPLE: [Metre; 2] = [111_320.0, 111_136.0];

/// The projection of a net.
#[derive(Debug)]
pub struct Projection {
    plane: Plane,
    offset: Vector,
}

#[derive(Debug)]
enum Plane {
    Simple,
    Proj { degrees: Box<Proj>, metres: Box<Proj> },
}

impl Projection {
    /// The projection of a net with this location, if it has one.
    ///
    /// # Errors
    /// A message if it is not supported.
    pub fn of(location: Option<&Location>) -> Result<Option<Self>, String> {
        let Some(Location { offset, projection }) = location else { return Ok(None) };
        let plane = match projection.as_str() {
            "!" => return Ok(None),
            "-" => Plane::Simple,
            text => {
                let read = |text: &str| {
                    let proj = Proj::from_proj_string(text).map(Box::new);
                    proj.map_err(|error| format!("the net's projection \"{projection}\" is not supported: {error}"))
                };
                let ellipsoid =
                    text.split_whitespace().filter(|word| ELLIPSOID.iter().any(|name| word.starts_with(name)));
                let degrees = std::iter::once("+proj=longlat").chain(ellipsoid).collect::<Vec<_>>().join(" ");
                Plane::Proj { degrees: read(&degrees)?, metres: read(text)? }
            }
        };
        Ok(Some(Self { plane, offset: *offset }))
    }

    /// The place in the net of degrees of longitude and latitude; none where the projection has none.
    pub fn place(&self, longitude: Degree, latitude: Degree) -> Option<Point> {
        let place = match &self.plane {
            Plane::Simple => Point::new(longitude * SIMPLE[0] * latitude.to_radians().cos(), latitude * SIMPLE[1]),
            Plane::Proj { degrees, metres } => {
                let mut place = (longitude.to_radians(), latitude.to_radians(), 0.0);
                transform(degrees, metres, &mut place).ok()?;
                Point::new(place.0, place.1)
            }
        };
        Some(place + self.offset).filter(|place| POSITION.holds(place.x) && POSITION.holds(place.y))
    }

    /// The same as what a net has.
    pub(crate) fn into_degrees(self) -> ToDegrees {
        ToDegrees::by(move |place| self.degrees(place))
    }

    /// The degrees of longitude and latitude of a place in the net; none where the projection has none.
    pub fn degrees(&self, place: Point) -> Option<[Degree; 2]> {
        let place = place - self.offset;
        let degrees = match &self.plane {
            Plane::Simple => {
                let latitude = place.y / SIMPLE[1];
                [place.x / (SIMPLE[0] * latitude.to_radians().cos()), latitude]
            }
            Plane::Proj { degrees, metres } => {
                let mut place = (place.x, place.y, 0.0);
                transform(metres, degrees, &mut place).ok()?;
                [place.0.to_degrees(), place.1.to_degrees()]
            }
        };
        Some(degrees).filter(|degrees| degrees.iter().all(|degree| degree.is_finite()))
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;

    fn projection(parameters: &str) -> Result<Option<Projection>, String> {
        let text = format!(
            r#"<net><location netOffset="-385000.00,-5819000.00" projParameter="{parameters}"/>
            <edge id="a"><lane id="a_0" length="9" shape="0,0 9,0"/></edge></net>"#
        );
        Projection::of(crate::net::parse(Path::new("net"), text).unwrap().location.as_ref())
    }

    /// The places are sumolib's, by pyproj.
    #[test]
    fn degrees_become_metres_and_metres_degrees() {
        for (parameters, place) in [
            ("+proj=utm +zone=33 +ellps=WGS84 +datum=WGS84 +units=m +no_defs", (4404.6735, 1125.2065)),
            (
                "+proj=tmerc +lat_0=0 +lon_0=12 +k=1 +x_0=4500000 +y_0=0 +ellps=bessel +datum=potsdam +units=m +no_defs",
                (4207981.1287, 2487.8557),
            ),
            ("-", (520636.8715, 17862.72)),
        ] {
            let found = projection(parameters).unwrap().unwrap().place(13.37, 52.52).unwrap();
            assert!((found - Point::new(place.0, place.1)).norm() < 1e-3, "{parameters}: {found}");
            let back = projection(parameters).unwrap().unwrap().degrees(found).unwrap();
            assert!((back[0] - 13.37).abs() < 1e-9 && (back[1] - 52.52).abs() < 1e-9, "{parameters}: {back:?}");
        }
    }

    #[test]
    fn a_net_without_a_projection_or_with_an_unknown_one_is_told() {
        assert!(projection("!").unwrap().is_none());
        let message = projection("+proj=nonsense").err().unwrap();
        assert!(message.contains("\"+proj=nonsense\" is not supported"), "{message}");
    }
}
