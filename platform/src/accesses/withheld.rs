//! Values that nobody may read before the access is on record.

use std::{collections::BTreeMap, fmt};

use super::{Contents, Values};

/// Values that only an [`AccessRecorder`](super::AccessRecorder) hands out. Nothing else opens them:
///
/// ```compile_fail,E0624
/// use platform::accesses::Withheld;
/// fn read<T>(values: Withheld<T>) -> T {
///     values.open()
/// }
/// ```
#[derive(Clone)]
pub struct Withheld<T> {
    value: T,
    contents: Vec<Contents>,
}

impl<T: Values> Withheld<T> {
    /// Withholds values.
    pub fn new(value: T) -> Self {
        Self { contents: value.contents(), value }
    }
}

impl<T> Withheld<T> {
    /// Returns which values these are.
    pub(crate) fn contents(&self) -> &[Contents] {
        &self.contents
    }

    /// Derives something from the values, which is withheld likewise. A function, so that it takes
    /// nothing along but its argument.
    #[must_use]
    pub fn map_with<A, U>(self, argument: A, derive: fn(A, T) -> U) -> Withheld<U> {
        Withheld { value: derive(argument, self.value), contents: self.contents }
    }

    /// Hands the values out.
    pub(super) fn open(self) -> T {
        self.value
    }

    /// Shows the values.
    pub(super) const fn get(&self) -> &T {
        &self.value
    }
}

impl<T> Withheld<Vec<T>>
where
    Vec<T>: Values,
{
    /// Keeps what fits an argument, with its own contents. A function, so that it takes nothing along.
    #[must_use]
    pub fn retain_with<A>(self, argument: &A, fits: fn(&A, &T) -> bool) -> Self {
        let mut value = self.value;
        value.retain(|value| fits(argument, value));
        Self::new(value)
    }

    /// Returns true for a list of nothing.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.value.is_empty()
    }

    /// Divides a list by a key, each part with its own contents.
    #[must_use]
    pub fn divide<K: Ord>(self, key: fn(&T) -> K) -> BTreeMap<K, Self> {
        let mut parts: BTreeMap<K, Vec<T>> = BTreeMap::new();
        for value in self.value {
            parts.entry(key(&value)).or_default().push(value);
        }
        parts.into_iter().map(|(key, part)| (key, Self::new(part))).collect()
    }
}

impl<T: PartialEq> PartialEq for Withheld<T> {
    fn eq(&self, other: &Self) -> bool {
        self.value == other.value
    }
}

/// Shows what is withheld, and nothing of it.
impl<T> fmt::Debug for Withheld<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Withheld").field("contents", &self.contents).finish_non_exhaustive()
    }
}
