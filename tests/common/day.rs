//! A day of traffic on a real junction, made without SUMO. On every course through the junction a car enters twice a minute
//! and drives through. Road users come and go, each with an id of its own, and their number stays the same.
//!
//! Everything except the ids and the time repeats every [`PERIOD`] steps, so what a run keeps must repeat too.

use std::path::Path;
use std::sync::Arc;

use closecall::traffic::net::EdgeFunction;
use closecall::{EdgeIndex, LaneIndex, Net, Placement, Point, Profile, ProfileIndex, State, UserIndex};
use closecall_run::Run;
use closecall_run::RunOptions;
use closecall_run::output::log::Log;

/// Steps of 1 s that a car needs from one end of its course to the other.
const PERIOD: usize = 60;
/// Cars on each course.
const CARS: usize = 4;

/// A course through the net.
struct Course {
    /// Lanes, and where each begins.
    lanes: Vec<(f64, LaneIndex)>,
    points: Vec<(f64, Point)>,
    route: Arc<[EdgeIndex]>,
}

/// A run with an unlimited number of steps.
pub struct Day {
    net: Arc<Net>,
    courses: Vec<Course>,
    run: Run,
    profile: ProfileIndex,
    cars: Vec<Option<UserIndex>>,
    rows: Vec<(usize, f64)>,
    steps: usize,
    entered: usize,
}

impl Day {
    /// A day on the net of a scenario, its conflicts logged.
    pub fn new(net: &Path, log: &Path, car: Profile) -> Self {
        let options = RunOptions::default();
        let net = Arc::new(closecall_run::net::read(net).unwrap());
        let mut run = Run::new(&options, Some(net.clone())).unwrap();
        run.set_log(Log::create(log, &options).unwrap(), options.log.log_clips);
        run.drop_closed_conflicts();
        run.set_fixed_routes(true);
        let profile = run.roster.profile(car).unwrap();
        let courses = courses(&net);
        Self { net, courses, run, profile, cars: Vec::new(), rows: Vec::new(), steps: 0, entered: 0 }
    }

    /// The number of cars in the scene, which is constant.
    pub fn cars(&self) -> usize {
        self.courses.len() * CARS
    }

    /// The number of conflicts that have closed.
    pub fn conflicts(&self) -> u64 {
        self.run.closed_conflicts()
    }

    /// One step of 1 s.
    pub fn step(&mut self) {
        self.run.begin_step(self.steps as f64);
        self.cars.resize(self.cars(), None);
        self.rows.clear();
        let length = self.run.roster.profile_at(self.profile).length;
        for place in 0..self.cars.len() {
            let (course, first) = (place % self.courses.len(), place * PERIOD / self.cars.len());
            let age = (self.steps + PERIOD - first) % PERIOD;
            if age == 0 || self.cars[place].is_none() {
                let gone = self.cars[place].replace(self.run.enter(&format!("car{:09}", self.entered), self.profile));
                gone.into_iter().for_each(|user| self.run.leave(user));
                self.entered += 1;
            }
            let course = &self.courses[course];
            let speed = (course.end() - length) / PERIOD as f64;
            let distance = length + speed * age as f64;
            let (front, rear) = (course.at(distance), course.at(distance - length));
            let heading = (front.y - rear.y).atan2(front.x - rear.x);
            let state = State { x: front.x, y: front.y, z: 0.0, heading, speed };
            self.run.frame.push(self.cars[place].unwrap(), state);
            self.rows.push((place % self.courses.len(), distance));
        }
        let place = |run: &mut Run, rows: &[u32]| -> closecall_run::Result<()> {
            for &row in rows {
                let (course, distance) = self.rows[row as usize];
                run.set_placement(row, &self.courses[course].placement(&self.net, distance));
            }
            Ok(())
        };
        self.run.step(place).unwrap();
        self.steps += 1;
    }
}

impl Course {
    fn end(&self) -> f64 {
        self.points.last().unwrap().0
    }

    fn at(&self, distance: f64) -> Point {
        let next = self.points.partition_point(|(start, _)| *start <= distance).clamp(1, self.points.len() - 1);
        let [(start, from), (end, to)] = [self.points[next - 1], self.points[next]];
        from + (to - from) * ((distance - start) / (end - start))
    }

    fn placement(&self, net: &Net, distance: f64) -> Placement {
        let index = self.lanes.partition_point(|(start, _)| *start <= distance).max(1) - 1;
        let (start, lane) = self.lanes[index];
        let (drawn, edge) = (net.lines.length(lane.0), |lane: LaneIndex| net.lanes[lane].edge);
        // Inside a junction, the position is that of the edge before it.
        let before = self.lanes[..=index].iter().rev().map(|(_, lane)| edge(*lane));
        let last = before.filter_map(|edge| self.route.iter().position(|known| *known == edge)).next();
        Placement {
            lane,
            position: (distance - start) * net.lanes[lane].length / drawn,
            route: Some(self.route.clone()),
            route_position: last.unwrap(),
            lateral_speed: 0.0,
        }
    }
}

/// Every course from a lane that nothing leads to, to a dead end.
fn courses(net: &Net) -> Vec<Course> {
    let lane = |index: LaneIndex| &net.lanes[index];
    let is_normal = |index: LaneIndex| net.edges[lane(index).edge].function == EdgeFunction::Normal;
    let starts = net.lanes.keys();
    let starts = starts.filter(|&start| is_normal(start) && lane(start).from.is_empty());
    let mut chains = starts.map(|start| vec![start]).collect::<Vec<_>>();
    let mut courses = Vec::new();
    while let Some(lanes) = chains.pop() {
        let last = lane(*lanes.last().unwrap());
        chains.extend(last.links.iter().map(|link| [&lanes[..], &[link.via.unwrap_or(link.to)]].concat()));
        if last.links.is_empty() && lanes.len() > 1 {
            courses.push(course(net, &lanes));
        }
    }
    courses
}

fn course(net: &Net, lanes: &[LaneIndex]) -> Course {
    let mut course = Course { lanes: Vec::new(), points: Vec::new(), route: Arc::new([]) };
    let mut route = Vec::new();
    for &index in lanes {
        let lane = &net.lanes[index];
        course.lanes.push((course.points.last().map_or(0.0, |(distance, _)| *distance), index));
        if net.edges[lane.edge].function == EdgeFunction::Normal {
            route.push(lane.edge);
        }
        for &point in &lane.shape {
            let distance =
                course.points.last().map_or(0.0, |(distance, last): &(f64, Point)| distance + (point - last).norm());
            if course.points.last().is_none_or(|(before, _)| distance > *before) {
                course.points.push((distance, point));
            }
        }
    }
    course.route = route.into();
    course
}
