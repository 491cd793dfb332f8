//! Which road users are in the scene: what does not change while they are there (id, type, size, brakes).

use std::sync::Arc;

use ecow::EcoString;
use rustc_hash::FxHashMap;

use super::profile::{Category, Profile, origins};
use crate::Result;
use crate::geometry::polygon::Polygon;

/// Which road user of a [`Roster`]: valid from its entering to its leaving the scene, then given to another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct UserIndex(pub u32);

/// Which [`Profile`] of a [`Roster`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct ProfileIndex(pub u32);

/// Everybody in the scene, by [`UserIndex`].
#[derive(Clone, Debug, Default)]
pub struct Roster {
    /// SUMO's; short ones stand in the table itself.
    ids: Vec<EcoString>,
    types: Vec<ProfileIndex>,
    /// Those of obstacles, in convex parts.
    shapes: FxHashMap<UserIndex, Arc<[Polygon]>>,
    profiles: Vec<Profile>,
    free: Vec<u32>,
    changes: u64,
    /// By category: a vehicle and a person may be of the same type.
    by_name: FxHashMap<String, [Option<ProfileIndex>; Category::COUNT]>,
}

impl Roster {
    /// Adds a type, or finds it by its name.
    ///
    /// # Errors
    /// As [`Profile::check`] has them.
    pub fn profile(&mut self, profile: Profile) -> Result<ProfileIndex> {
        if let Some(known) = self.profile_named(&profile.name, profile.category) {
            return Ok(known);
        }
        profile.check()?;
        let index = ProfileIndex(self.profiles.len() as u32);
        self.by_name.entry(profile.name.clone()).or_default()[profile.category as usize] = Some(index);
        self.profiles.push(profile);
        Ok(index)
    }

    /// The type that was added under this name.
    pub fn profile_named(&self, name: &str, category: Category) -> Option<ProfileIndex> {
        self.by_name.get(name)?[category as usize]
    }

    /// Whether anybody was of a type that settings name so.
    pub fn has_any_of(&self, name: &str) -> bool {
        self.by_name.keys().any(|known| origins(known).any(|origin| origin == name))
    }

    /// Takes a road user into the scene.
    pub fn enter(&mut self, id: &str, profile: ProfileIndex) -> UserIndex {
        self.changes += 1;
        match self.free.pop() {
            Some(index) => {
                self.ids[index as usize] = id.into();
                self.types[index as usize] = profile;
                UserIndex(index)
            }
            None => {
                self.ids.push(id.into());
                self.types.push(profile);
                UserIndex(self.ids.len() as u32 - 1)
            }
        }
    }

    /// Takes an obstacle with a polygon for a shape into the scene.
    pub fn enter_shaped(&mut self, id: &str, profile: ProfileIndex, shape: Arc<[Polygon]>) -> UserIndex {
        let user = self.enter(id, profile);
        self.shapes.insert(user, shape);
        user
    }

    /// Lets a road user leave; its index may be given to another from now on.
    pub fn leave(&mut self, user: UserIndex) {
        self.changes += 1;
        self.shapes.remove(&user);
        self.free.push(user.0);
    }

    /// How often anybody has entered or left.
    pub fn changes(&self) -> u64 {
        self.changes
    }

    /// SUMO's id of this road user.
    pub fn id(&self, user: UserIndex) -> &EcoString {
        &self.ids[user.0 as usize]
    }

    /// The shape of an obstacle, in convex parts; empty for all others.
    pub fn shape(&self, user: UserIndex) -> &[Polygon] {
        self.shapes.get(&user).map_or(&[], |shape| &**shape)
    }

    /// Which type this road user has.
    pub fn type_of(&self, user: UserIndex) -> ProfileIndex {
        self.types[user.0 as usize]
    }

    /// The type of this road user.
    pub fn profile_of(&self, user: UserIndex) -> &Profile {
        self.profile_at(self.type_of(user))
    }

    /// The type of this index.
    pub fn profile_at(&self, profile: ProfileIndex) -> &Profile {
        &self.profiles[profile.0 as usize]
    }

    /// The number of indices in use or free: one more than the largest [`UserIndex`].
    pub fn len(&self) -> usize {
        self.ids.len()
    }

    /// Whether nobody was ever in the scene.
    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }
}
