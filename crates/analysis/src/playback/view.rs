//! The part of the world that a picture shows, and where in the picture a place is.

use std::fmt::Write;

use super::found::Playback;
use closecall::events::ClipUser;
use closecall::geometry::Point;
use closecall::util::units::{Metre, Second};

/// Width and height of the picture in its own units.
pub const SIZE: [f64; 2] = [960.0, 600.0];
/// The height of the panel below the roads.
pub(crate) const PANEL: f64 = 84.0;
/// The least and the largest half width of what is shown, in m.
const HALF_WIDTH: [Metre; 2] = [24.0, 60.0];
/// Room between the two and the picture's edge, in m.
const ROOM: Metre = 6.0;
/// The part of the world that the picture shows.
#[derive(Debug)]
pub(crate) struct View {
    centre: Point,
    half_width: Metre,
}

impl View {
    /// That around a conflict and the two that come there.
    pub fn of(playback: &Playback) -> Self {
        let Playback { conflict, clip, .. } = playback;
        let at = Point::new(conflict.x, conflict.y);
        let worst = place_of(&clip.times, conflict.time);
        // The two in the second before the worst step, so that one sees them come.
        let seen = clip.times.iter().enumerate().filter(|(_, time)| (**time - clip.times[worst]).abs() <= 1.5);
        let places = seen.flat_map(|(place, _)| clip.users[..2].iter().filter_map(move |user| front(user, place)));
        Self::around(at, places)
    }

    /// That around a place, such that all these places are seen.
    pub fn around(centre: Point, places: impl Iterator<Item = Point>) -> Self {
        let reach = places.fold(0.0_f64, |most, place| {
            let away = place - centre;
            most.max(away.x.abs()).max(away.y.abs() * SIZE[0] / (SIZE[1] - PANEL))
        });
        Self { centre, half_width: (reach + ROOM).clamp(HALF_WIDTH[0], HALF_WIDTH[1]) }
    }

    /// Units per metre.
    pub fn scale(&self) -> f64 {
        SIZE[0] / 2.0 / self.half_width
    }

    fn half_height(&self) -> Metre {
        (SIZE[1] - PANEL) / 2.0 / self.scale()
    }

    /// A place in the picture's units.
    pub(crate) fn to_picture(&self, place: Point) -> [f64; 2] {
        let away = place - self.centre;
        [(away.x + self.half_width) * self.scale(), (self.half_height() - away.y) * self.scale()]
    }

    /// Points as SVG has them.
    pub fn points(&self, shape: &[Point]) -> String {
        let mut text = String::new();
        for point in shape {
            let [x, y] = self.to_picture(*point);
            let _ = write!(text, "{}{x:.1},{y:.1}", if text.is_empty() { "" } else { " " });
        }
        text
    }

    /// Whether something of a line of this width may be seen.
    pub fn sees(&self, shape: &[Point], width: Metre) -> bool {
        let away = shape.iter().map(|point| point - self.centre);
        let ranges = away.fold([[f64::INFINITY, f64::NEG_INFINITY]; 2], |[x, y], away| {
            [[x[0].min(away.x), x[1].max(away.x)], [y[0].min(away.y), y[1].max(away.y)]]
        });
        let half = [self.half_width + width, self.half_height() + width];
        ranges.iter().zip(half).all(|([low, high], half)| *low <= half && *high >= -half)
    }
}

/// The place in the clip's lists of the time nearest to this.
pub(crate) fn place_of(times: &[Second], time: Second) -> usize {
    let places = times.iter().enumerate().min_by(|a, b| (a.1 - time).abs().total_cmp(&(b.1 - time).abs()));
    places.map_or(0, |(place, _)| place)
}

/// The front bumper of a road user; none where it is absent.
pub fn front(user: &ClipUser, place: usize) -> Option<Point> {
    Some(Point::new(user.x[place]?, user.y[place]?))
}
