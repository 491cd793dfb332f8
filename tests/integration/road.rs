//! A net of one lane.

use std::path::Path;
use std::sync::Arc;

use closecall::geometry::Vector;
use closecall::{Net, Point, Profile, State};

/// A lane through these points.
pub struct Road {
    points: Vec<Point>,
    pub net: Arc<Net>,
}

impl Road {
    pub fn through(points: Vec<Point>) -> Self {
        let shape = points.iter().map(|point| format!("{},{}", point.x, point.y)).collect::<Vec<_>>().join(" ");
        let length = points.windows(2).map(|ends| (ends[1] - ends[0]).norm()).sum::<f64>();
        let lane = format!(r#"<lane id="e_0" index="0" length="{length}" width="3.2" shape="{shape}"/>"#);
        let text = format!(r#"<net><edge id="e" from="w" to="n">{lane}</edge></net>"#);
        Self { points, net: Arc::new(closecall_run::net::parse(Path::new("bend.net.xml"), text).unwrap()) }
    }

    /// 100 m to the east, a quarter circle of 20 m to the left, 100 m to the north.
    pub fn bend() -> Self {
        let on_circle = |degrees: i32| {
            let (sine, cosine) = f64::from(degrees).to_radians().sin_cos();
            Point::new(100.0 + 20.0 * sine, 20.0 - 20.0 * cosine)
        };
        let circle = (0..=90).step_by(5).map(on_circle);
        Self::through([Point::origin()].into_iter().chain(circle).chain([Point::new(120.0, 120.0)]).collect())
    }

    pub fn turning(turns: &[(f64, f64)]) -> Self {
        let (mut at, mut heading, mut points) = (Point::origin(), 0.0_f64, vec![Point::origin()]);
        for (turn, length) in turns {
            heading += turn;
            at += Vector::new(heading.cos(), heading.sin()) * *length;
            points.push(at);
        }
        Self::through(points)
    }

    pub fn at(&self, mut distance: f64) -> Point {
        for ends in self.points.windows(2) {
            let length = (ends[1] - ends[0]).norm();
            if distance <= length {
                return ends[0] + (ends[1] - ends[0]) * (distance / length);
            }
            distance -= length;
        }
        self.points[self.points.len() - 1]
    }

    /// A vehicle with its front bumper at a distance along it; SUMO's heading is the chord of the first carriage.
    pub fn vehicle(&self, profile: &Profile, distance: f64, speed: f64) -> State {
        let (front, rear) = (self.at(distance), self.at(distance - profile.chord));
        let heading = (front.y - rear.y).atan2(front.x - rear.x);
        State { x: front.x, y: front.y, z: 0.0, heading, speed }
    }
}
