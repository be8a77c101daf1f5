//! The requested fields: by their keys, as messages and people name them, and by our numbers for
//! them, as candidates do.

use std::{
    collections::HashMap,
    hash::{BuildHasher as _, RandomState},
};

use asi_model::FieldKey;
use hashbrown::HashTable;

use super::Field;

/// All requested fields.
#[derive(Default)]
pub struct Fields {
    /// By number: what comes with every candidate is found without looking at a text.
    fields: HashMap<i64, Box<Field>, foldhash::fast::RandomState>,
    /// The numbers, by key. Partners choose the keys, so this hasher must withstand chosen ones.
    numbers: HashTable<i64>,
    hasher: RandomState,
}

impl Fields {
    /// The field with this key.
    #[must_use]
    pub fn get(&self, key: &FieldKey) -> Option<&Field> {
        let is_it = |number: &i64| self.fields.get(number).is_some_and(|field| field.key == *key);
        let number = self.numbers.find(self.hasher.hash_one(key), is_it)?;
        self.fields.get(number).map(|field| &**field)
    }

    /// As [`Self::get`], to change it.
    pub fn get_mut(&mut self, key: &FieldKey) -> Option<&mut Field> {
        let number = self.get(key)?.id;
        self.get_numbered_mut(number)
    }

    /// The field with this number, to change it.
    pub fn get_numbered_mut(&mut self, number: i64) -> Option<&mut Field> {
        self.fields.get_mut(&number).map(|field| &mut **field)
    }

    /// Whether there is one with this key.
    #[must_use]
    pub fn contains_key(&self, key: &FieldKey) -> bool {
        self.get(key).is_some()
    }

    /// A new field. One with the same key would have been changed instead.
    pub fn insert(&mut self, field: Field) {
        let Self { fields, numbers, hasher } = self;
        let number = field.id;
        let hash = hasher.hash_one(&field.key);
        fields.insert(number, Box::new(field));
        let rehash =
            |number: &i64| fields.get(number).map_or(0, |field| hasher.hash_one(&field.key));
        numbers.insert_unique(hash, number, rehash);
    }

    /// Takes a field out.
    pub fn remove(&mut self, key: &FieldKey) -> Option<Field> {
        let number = self.get(key)?.id;
        if let Ok(found) =
            self.numbers.find_entry(self.hasher.hash_one(key), |other| *other == number)
        {
            found.remove();
        }
        self.fields.remove(&number).map(|field| *field)
    }

    /// All of them, in no order.
    pub fn iter(&self) -> impl Iterator<Item = &Field> {
        self.fields.values().map(|field| &**field)
    }

    /// All of them, to change them.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = &mut Field> {
        self.fields.values_mut().map(|field| &mut **field)
    }
}
