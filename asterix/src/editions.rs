//! Which edition of each category a source speaks.

use crate::definition::Edition;
use crate::tables::ALL;

/// One edition for each category.
#[derive(Debug, Clone, PartialEq)]
pub struct Editions([Option<&'static Edition>; 256]);

/// Why an edition cannot be spoken.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum EditionError {
    /// There is no table of it.
    #[error("category {category:03} edition {number}: not known, expected {known}")]
    Unknown {
        /// The category.
        category: u8,
        /// The edition.
        number: String,
        /// What is known of the category.
        known: String,
    },
    /// The text names none.
    #[error("`{0}` found, expected CATEGORY=EDITION, for example 048=1.32")]
    Text(String),
}

impl Default for Editions {
    /// The newest edition of every category.
    fn default() -> Self {
        let mut editions = [None; 256];
        for edition in ALL {
            editions[usize::from(edition.category)] = Some(edition);
        }
        Self(editions)
    }
}

impl Editions {
    /// As these, with another edition of a category.
    ///
    /// # Errors
    /// [`EditionError::Unknown`].
    pub fn with(mut self, category: u8, number: &str) -> Result<Self, EditionError> {
        let known = || ALL.into_iter().filter(|edition| edition.category == category);
        let edition = known().find(|edition| edition.number == number).ok_or_else(|| {
            let numbers: Vec<&str> = known().map(|edition| edition.number).collect();
            let known = if numbers.is_empty() { "another category".into() } else { numbers.join(" or ") };
            EditionError::Unknown { category, number: number.into(), known }
        })?;
        self.0[usize::from(category)] = Some(edition);
        Ok(self)
    }

    /// As these, but for editions that are named as `048=1.32`.
    ///
    /// # Errors
    /// [`EditionError`].
    pub fn with_named<'a>(self, names: impl IntoIterator<Item = &'a str>) -> Result<Self, EditionError> {
        names.into_iter().try_fold(self, |editions, name| {
            let parts = name.split_once('=').and_then(|(category, number)| Some((category.parse().ok()?, number)));
            let (category, number) = parts.ok_or_else(|| EditionError::Text(name.into()))?;
            editions.with(category, number)
        })
    }

    /// As these, of some categories only.
    #[must_use]
    pub fn only(mut self, categories: &[u8]) -> Self {
        for (category, edition) in self.0.iter_mut().enumerate() {
            *edition = edition.filter(|_| categories.iter().any(|&it| usize::from(it) == category));
        }
        self
    }

    /// The edition of a category, if the category is known.
    pub fn of(&self, category: u8) -> Option<&'static Edition> {
        self.0[usize::from(category)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edition_is_chosen_by_its_number() {
        let editions = Editions::default().with(48, "1.32").expect("a known edition");
        assert_eq!(editions.of(48).map(|edition| edition.number), Some("1.32"));
        assert_eq!(editions.of(21), None);
        let error = Editions::default().with(48, "9.9").expect_err("unknown").to_string();
        assert_eq!(error, "category 048 edition 9.9: not known, expected 1.32");
        let named = Editions::default().with_named(["048=1.32", "034=1.29"]);
        assert_eq!(named, Ok(Editions::default()));
        for (name, said) in [("048", "expected CATEGORY=EDITION"), ("021=2.1", "expected another category")] {
            let error = Editions::default().with_named([name]).expect_err(name).to_string();
            assert!(error.contains(said), "{error}");
        }
    }
}
