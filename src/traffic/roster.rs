//! The road users in the scene: what does not change while they are there (id, type, size, brakes).

use std::sync::Arc;

use ecow::EcoString;
use rustc_hash::FxHashMap;
use typed_index_collections::TiVec;

use super::profile::{Category, Profile, origins};
use crate::Result;
use crate::geometry::polygon::Polygon;
use crate::util::index::index_tables;
use crate::util::units::Second;

/// A road user of a [`Roster`]: valid from when it enters the scene until it leaves, then given to another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct UserIndex(pub u32);

/// A [`Profile`] of a [`Roster`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct ProfileIndex(pub u32);

index_tables!(UserIndex, ProfileIndex);

/// The road users in the scene, by [`UserIndex`].
#[derive(Clone, Debug, Default)]
pub struct Roster {
    /// SUMO's ids.
    ids: TiVec<UserIndex, EcoString>,
    types: TiVec<UserIndex, ProfileIndex>,
    /// The shapes of obstacles, in convex parts.
    shapes: FxHashMap<UserIndex, Arc<[Polygon]>>,
    profiles: TiVec<ProfileIndex, Profile>,
    free: Vec<UserIndex>,
    changes: u64,
    /// By category: a vehicle and a person may be of the same type.
    by_name: FxHashMap<String, [Option<ProfileIndex>; Category::COUNT]>,
}

impl Roster {
    /// Adds a type, or finds it by its name.
    ///
    /// # Errors
    /// Those of [`Profile::check`].
    pub fn profile(&mut self, profile: Profile) -> Result<ProfileIndex> {
        if let Some(known) = self.profile_named(&profile.name, profile.category) {
            return Ok(known);
        }
        profile.check()?;
        let of_name = self.by_name.entry(profile.name.clone()).or_default();
        Ok(*of_name[profile.category as usize].insert(self.profiles.push_and_get_key(profile)))
    }

    /// Sets the response time of a type, from the next step on.
    pub fn set_response(&mut self, profile: ProfileIndex, response: Second) {
        self.changes += 1;
        self.profiles[profile].brakes.response = response;
    }

    /// The type added under this name.
    pub fn profile_named(&self, name: &str, category: Category) -> Option<ProfileIndex> {
        self.by_name.get(name)?[category as usize]
    }

    /// Whether any road user had a type that settings refer to by this name.
    pub fn has_any_of(&self, name: &str) -> bool {
        self.by_name.keys().any(|known| origins(known).any(|origin| origin == name))
    }

    /// Adds a road user to the scene.
    pub fn enter(&mut self, id: &str, profile: ProfileIndex) -> UserIndex {
        self.changes += 1;
        match self.free.pop() {
            Some(user) => {
                self.ids[user] = id.into();
                self.types[user] = profile;
                user
            }
            None => {
                self.ids.push(id.into());
                self.types.push_and_get_key(profile)
            }
        }
    }

    /// Adds an obstacle whose shape is a polygon to the scene.
    pub fn enter_shaped(&mut self, id: &str, profile: ProfileIndex, shape: Arc<[Polygon]>) -> UserIndex {
        let user = self.enter(id, profile);
        self.shapes.insert(user, shape);
        user
    }

    /// Removes a road user; its index may be given to another from now on.
    pub fn leave(&mut self, user: UserIndex) {
        self.changes += 1;
        self.shapes.remove(&user);
        self.free.push(user);
    }

    /// The number of times that a road user entered or left.
    pub fn changes(&self) -> u64 {
        self.changes
    }

    /// SUMO's id of this road user.
    pub fn id(&self, user: UserIndex) -> &EcoString {
        &self.ids[user]
    }

    /// The shape of an obstacle, in convex parts; empty for all others.
    pub fn shape(&self, user: UserIndex) -> &[Polygon] {
        self.shapes.get(&user).map_or(&[], |shape| &**shape)
    }

    /// The index of this road user's type.
    pub(crate) fn type_of(&self, user: UserIndex) -> ProfileIndex {
        self.types[user]
    }

    /// The type of this road user.
    pub fn profile_of(&self, user: UserIndex) -> &Profile {
        self.profile_at(self.type_of(user))
    }

    /// The type of this index.
    pub fn profile_at(&self, profile: ProfileIndex) -> &Profile {
        &self.profiles[profile]
    }

    /// The number of indices in use or free: one more than the largest [`UserIndex`].
    pub fn len(&self) -> usize {
        self.ids.len()
    }

    /// Whether no road user was ever in the scene.
    pub fn is_empty(&self) -> bool {
        self.ids.is_empty()
    }
}
