//! Ids, types and lanes as small numbers. A road user that was there before is recognised by comparison, without a look-up.

use rustc_hash::FxHashMap;

use crate::util::input_file::longer;
use closecall::util::limits::NAME;

/// Distinct texts, numbered in the order in which they appeared.
#[derive(Debug, Default)]
pub(super) struct Names {
    texts: Vec<String>,
    known: FxHashMap<Box<[u8]>, u32>,
}

impl Names {
    pub fn text(&self, name: u32) -> &str {
        self.texts.get(name as usize).map_or("", String::as_str)
    }

    /// The texts after the first `known`.
    pub fn after(&self, known: usize) -> &[String] {
        self.texts.get(known..).unwrap_or_default()
    }

    /// The number of a text, which is most likely `guess`.
    #[inline]
    fn number(&mut self, text: &[u8], guess: u32) -> Result<u32, String> {
        // Empty texts are tested first: comparing two of them, a masked load from an invalid address, took 60 to 80 ns on an
        // AMD EPYC.
        let is_known = |known: &String| known.len() == text.len() && (text.is_empty() || known.as_bytes() == text);
        if self.texts.get(guess as usize).is_some_and(is_known) {
            return Ok(guess);
        }
        self.look_up(text)
    }

    fn look_up(&mut self, text: &[u8]) -> Result<u32, String> {
        if let Some(known) = self.known.get(text) {
            return Ok(*known);
        }
        let number = self.texts.len() as u32;
        self.texts.push(name(text)?.to_owned());
        self.known.insert(text.into(), number);
        Ok(number)
    }
}

/// The road users in the scene, each with a number that it keeps while it is there, and their types and lanes.
#[derive(Debug, Default)]
pub(super) struct Users {
    users: Vec<NamedUser>,
    /// The numbers of vehicles and of persons by id: a vehicle and a person may have the same id.
    known: [FxHashMap<Box<[u8]>, u32>; 2],
    free: Vec<u32>,
    gone: Vec<u32>,
    /// The road users that were given a number in this step.
    entered: Vec<u32>,
    step: u64,
    /// The road users of the previous step and of this one, in the recording's order.
    before: Vec<u32>,
    now: Vec<u32>,
    /// The place in `before` of the road user that is expected next.
    expected: usize,
    pub types: Names,
    pub lanes: Names,
}

#[derive(Debug)]
struct NamedUser {
    id: String,
    person: bool,
    /// The last step that it was in.
    step: u64,
    /// Its place in the order of that step.
    place: u32,
    type_name: u32,
    lane: u32,
}

/// The numbers of a road user, its type and its lane.
#[derive(Clone, Copy, Debug)]
pub(super) struct Numbers {
    pub user: u32,
    pub type_name: u32,
    pub lane: u32,
    /// Whether it was on this lane in the previous step.
    pub keeps_lane: bool,
}

impl Users {
    pub fn id(&self, user: u32) -> &str {
        self.users.get(user as usize).map_or("", |user| &user.id)
    }

    /// The numbers that were given in this step, with the ids that they stand for.
    pub fn entered(&self) -> impl Iterator<Item = (u32, &str)> {
        self.entered.iter().map(|user| (*user, self.id(*user)))
    }

    /// The ids that the numbers from 0 on stand for, or stood for last.
    pub fn ids(&self) -> impl Iterator<Item = &str> {
        self.users.iter().map(|user| &*user.id)
    }

    /// Begins a step. The numbers of road users that were not in the previous one become free only now.
    pub fn begin(&mut self) {
        for user in self.gone.drain(..) {
            let left = &self.users[user as usize];
            self.known[usize::from(left.person)].remove(left.id.as_bytes());
            self.free.push(user);
        }
        std::mem::swap(&mut self.before, &mut self.now);
        self.now.clear();
        self.entered.clear();
        self.expected = 0;
        self.step += 1;
    }

    /// Ends a step; returns the road users of the previous step that are not in it.
    pub fn end(&mut self) -> &[u32] {
        let (users, step) = (&self.users, self.step);
        self.gone.extend(self.before.iter().filter(|user| users[**user as usize].step != step));
        self.gone.sort_unstable();
        self.gone.dedup();
        &self.gone
    }

    /// The numbers of the road user with this id.
    #[inline]
    pub fn number(&mut self, id: &[u8], person: bool, type_name: &[u8], lane: &[u8]) -> Result<Numbers, String> {
        let index = self.find(id, person)?;
        let user = &mut self.users[index as usize];
        if user.step == self.step {
            return Err(format!("\"{}\" is there twice in one step", user.id));
        }
        let lane_before = user.lane;
        user.type_name = self.types.number(type_name, user.type_name)?;
        user.lane = self.lanes.number(lane, user.lane)?;
        user.step = self.step;
        user.place = self.now.len() as u32;
        self.now.push(index);
        Ok(Numbers { user: index, type_name: user.type_name, lane: user.lane, keeps_lane: user.lane == lane_before })
    }

    /// Forgets the lane of a road user, so that it does not keep it in the next step.
    pub(crate) fn forget_lane(&mut self, user: u32) {
        if let Some(user) = self.users.get_mut(user as usize) {
            user.lane = u32::MAX;
        }
    }

    #[inline]
    fn find(&mut self, id: &[u8], person: bool) -> Result<u32, String> {
        // If it is not the expected one, that one has probably left, and this is the next.
        for place in self.expected..self.expected + 2 {
            let Some(&index) = self.before.get(place) else { break };
            let user = &self.users[index as usize];
            if user.id.as_bytes() == id && user.person == person {
                self.expected = place + 1;
                return Ok(index);
            }
        }
        self.look_up(id, person)
    }

    fn look_up(&mut self, id: &[u8], person: bool) -> Result<u32, String> {
        if let Some(&index) = self.known[usize::from(person)].get(id) {
            let user = &self.users[index as usize];
            if user.step + 1 == self.step {
                self.expected = user.place as usize + 1;
            }
            return Ok(index);
        }
        let user =
            NamedUser { id: name(id)?.to_owned(), person, step: 0, place: 0, type_name: u32::MAX, lane: u32::MAX };
        let index = self.free.pop().unwrap_or(self.users.len() as u32);
        match self.users.get_mut(index as usize) {
            Some(free) => *free = user,
            None => self.users.push(user),
        }
        self.known[usize::from(person)].insert(id.into(), index);
        self.entered.push(index);
        Ok(index)
    }
}

/// A text as an id, which is UTF-8 and not too long.
fn name(text: &[u8]) -> Result<&str, String> {
    if text.len() > NAME.count() {
        let begin = String::from_utf8_lossy(&text[..40]);
        return Err(longer(&format!("\"{begin}…\""), &NAME));
    }
    std::str::from_utf8(text).map_err(|_| format!("\"{}\" is not UTF-8", String::from_utf8_lossy(text)))
}
