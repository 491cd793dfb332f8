//! A background map for `--tiles`: the page requests its tiles from a server whenever it is opened. Without the option a
//! report sends no requests.

use std::str::FromStr;

use serde_json::{Value, json};

use closecall::geometry::{Bounds, Point};
use closecall::traffic::net::Net;
use closecall_run::{Error, Result};

/// The parts of an address that the page fills in: zoom, column and row.
const PARTS: [&str; 3] = ["{z}", "{x}", "{y}"];

/// The address of a server's tiles in web mercator, such as `https://tile.openstreetmap.org/{z}/{x}/{y}.png`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TileUrl(String);

impl FromStr for TileUrl {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let is_address = text.starts_with("https://") || text.starts_with("http://");
        // The page's own policy names the server: nothing in the address may end that.
        let is_plain = text.chars().all(|letter| letter.is_ascii_graphic() && !"\"'<>;,\\".contains(letter));
        if is_address && is_plain && PARTS.iter().all(|part| text.contains(part)) {
            Ok(Self(text.to_owned()))
        } else {
            Err(format!(
                "it must be an address with {}: https://tile.openstreetmap.org/{{z}}/{{x}}/{{y}}.png",
                PARTS.join(", ")
            ))
        }
    }
}

impl TileUrl {
    /// The server that the page may ask: `https://tile.openstreetmap.org`.
    pub(super) fn origin(&self) -> &str {
        let path = self.0.find("://").map_or(0, |end| end + 3);
        self.0[path..].find('/').map_or(&self.0, |end| &self.0[..path + end])
    }

    /// What the page needs: the address, the attribution, and where the net's metres are on the web mercator square.
    ///
    /// # Errors
    /// [`Error::Value`] without a net, or where its places have no longitude and latitude.
    pub(super) fn json(&self, net: Option<&Net>) -> Result<Value> {
        let net = net.ok_or_else(|| Error::Value("--tiles: the report has no net for a background map".to_owned()))?;
        let square = square(net).ok_or_else(|| {
            Error::Value(
                "--tiles: the net has no geographic projection, so that its place on a map is not known".to_owned(),
            )
        })?;
        Ok(json!({ "url": self.0, "by": self.attribution(), "square": square }))
    }

    fn attribution(&self) -> String {
        if self.origin().ends_with("openstreetmap.org") {
            "© OpenStreetMap contributors".to_owned()
        } else {
            self.origin().split_once("://").map_or(String::new(), |(_, server)| format!("map: {server}"))
        }
    }
}

/// The map from the net's metres to the web mercator square, which is 1 wide and begins at the north-west: x and y of its
/// middle, where that is on the square, and the changes per metre along x and y. On 10 km it is right to 3 m.
fn square(net: &Net) -> Option<[f64; 8]> {
    let mut bounds = Bounds::EMPTY;
    net.lanes.iter().flat_map(|lane| &lane.shape).for_each(|point| bounds.include(*point));
    let middle = Point::from((bounds.low.coords + bounds.high.coords) / 2.0);
    let reach = (bounds.high - bounds.low).amax().max(100.0) / 2.0;
    let to_degrees = net.to_degrees.as_ref()?;
    let at = |x: f64, y: f64| to_degrees.of(Point::new(middle.x + x, middle.y + y)).map(on_square);
    let [u, v] = at(0.0, 0.0)?;
    let slope = |ends: [[f64; 2]; 2]| [0, 1].map(|axis| (ends[1][axis] - ends[0][axis]) / (2.0 * reach));
    let [u_x, v_x] = slope([at(-reach, 0.0)?, at(reach, 0.0)?]);
    let [u_y, v_y] = slope([at(0.0, -reach)?, at(0.0, reach)?]);
    let all = [middle.x, middle.y, u, v, u_x, u_y, v_x, v_y];
    all.iter().all(|value| value.is_finite()).then_some(all)
}

/// Web mercator of longitude and latitude in degrees.
fn on_square([longitude, latitude]: [f64; 2]) -> [f64; 2] {
    let latitude = latitude.to_radians();
    [(longitude + 180.0) / 360.0, (1.0 - latitude.tan().asinh() / std::f64::consts::PI) / 2.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_squares_begin_in_the_north_west() {
        let near =
            |found: [f64; 2], wanted: [f64; 2]| assert!((0..2).all(|axis| (found[axis] - wanted[axis]).abs() < 1e-9));
        near(on_square([-180.0, 85.051_128_779_806_6]), [0.0, 0.0]);
        near(on_square([0.0, 0.0]), [0.5, 0.5]);
        // Berlin's tile at zoom 12 is 2200, 1343.
        let [x, y] = on_square([13.4, 52.52]).map(|value| (value * 4096.0).floor());
        assert_eq!([x, y], [2200.0, 1343.0]);
    }

    #[test]
    fn an_address_names_its_server_and_ends_nothing() {
        let url = "https://tile.openstreetmap.org/{z}/{x}/{y}.png".parse::<TileUrl>().unwrap();
        assert_eq!(url.origin(), "https://tile.openstreetmap.org");
        assert_eq!(url.attribution(), "© OpenStreetMap contributors");
        let local = "http://127.0.0.1:80/{z}/{x}/{y}".parse::<TileUrl>().unwrap();
        assert_eq!((local.origin(), local.attribution().as_str()), ("http://127.0.0.1:80", "map: 127.0.0.1:80"));
        for wrong in
            ["a/{z}/{x}/{y}", "https://a/{z}/{x}", "https://a\"/{z}/{x}/{y}", "https://a; script-src *;/{z}/{x}/{y}"]
        {
            assert!(wrong.parse::<TileUrl>().is_err(), "{wrong}");
        }
    }
}
