//! Which edition of each category a source speaks.

use crate::definition::Edition;
use crate::tables::ALL;

/// One edition for each category.
#[derive(Debug, Clone, PartialEq)]
pub struct Editions([Option<&'static Edition>; 256]);

/// There is no table of the edition that was asked for.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("category {category:03} edition {number}: not known, expected {known}")]
pub struct UnknownEdition {
    /// The category.
    pub category: u8,
    /// The edition.
    pub number: String,
    /// What is known of the category.
    pub known: String,
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
    /// [`UnknownEdition`].
    pub fn with(mut self, category: u8, number: &str) -> Result<Self, UnknownEdition> {
        let known = || ALL.into_iter().filter(|edition| edition.category == category);
        let edition = known().find(|edition| edition.number == number).ok_or_else(|| {
            let numbers: Vec<&str> = known().map(|edition| edition.number).collect();
            let known = if numbers.is_empty() { "another category".into() } else { numbers.join(" or ") };
            UnknownEdition { category, number: number.into(), known }
        })?;
        self.0[usize::from(category)] = Some(edition);
        Ok(self)
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
    }
}
