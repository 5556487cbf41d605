//! What things depend on, as sets of numbers: planning unites them for every expression, every
//! variable of a shader and every pass, where sets of names would take most of its time.

use std::collections::BTreeSet;

use crate::plan::model::Causes;
use crate::words::Words;

/// Numbers that [`CauseNames`] gave out. Up to 192 lie in the set itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(in crate::plan) struct CauseSet {
    first: [u64; Self::FIRST],
    /// The last word is never 0, so that equal sets are equal bit by bit.
    more: Vec<u64>,
}

impl CauseSet {
    const FIRST: usize = 3;

    pub fn of(number: usize) -> Self {
        let mut set = Self::default();
        let (word, bit) = (number / 64, 1 << (number % 64));
        if word < Self::FIRST {
            set.first[word] = bit;
        } else {
            set.more = vec![0; word - Self::FIRST + 1];
            set.more[word - Self::FIRST] = bit;
        }
        set
    }

    /// Puts in what another has. Tells whether that was more than was there.
    pub fn add(&mut self, other: &CauseSet) -> bool {
        let mut new = 0;
        for (have, more) in self.first.iter_mut().zip(&other.first) {
            new |= *more & !*have;
            *have |= more;
        }
        if self.more.len() < other.more.len() {
            self.more.resize(other.more.len(), 0);
        }
        for (have, more) in self.more.iter_mut().zip(&other.more) {
            new |= *more & !*have;
            *have |= more;
        }
        new != 0
    }

    pub fn meets(&self, other: &CauseSet) -> bool {
        self.words().zip(other.words()).any(|(a, b)| a & b != 0)
    }

    fn words(&self) -> impl Iterator<Item = u64> + '_ {
        self.first.iter().chain(&self.more).copied()
    }

    fn numbers(&self) -> impl Iterator<Item = usize> + '_ {
        let set = |word: u64| (0..64).filter(move |bit| word & (1 << bit) != 0);
        self.words()
            .enumerate()
            .filter(|(_, word)| *word != 0)
            .flat_map(move |(at, word)| set(word).map(move |bit| at * 64 + bit))
    }
}

/// A kind of cause.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::plan) enum CauseKind {
    Input,
    Live,
    Param,
    Viewport,
}

/// Every cause that anything has, by number.
#[derive(Debug, Default)]
pub(in crate::plan) struct CauseNames {
    all: Vec<(CauseKind, String)>,
    numbers: [Words<usize>; 4],
    /// Those that are parameters.
    params: CauseSet,
}

impl CauseNames {
    /// The set of one cause.
    pub fn set(&mut self, kind: CauseKind, name: &str) -> CauseSet {
        let numbers = &mut self.numbers[kind as usize];
        let number = numbers.get(name).copied().unwrap_or_else(|| {
            numbers.insert(name.to_owned(), self.all.len());
            self.all.push((kind, name.to_owned()));
            self.all.len() - 1
        });
        let set = CauseSet::of(number);
        if kind == CauseKind::Param {
            self.params.add(&set);
        }
        set
    }

    /// All causes of a kind whose names are such.
    pub fn such(&self, kind: CauseKind, is_such: impl Fn(&str) -> bool) -> CauseSet {
        let mut such = CauseSet::default();
        for (number, (of, name)) in self.all.iter().enumerate() {
            if *of == kind && is_such(name) {
                such.add(&CauseSet::of(number));
            }
        }
        such
    }

    /// The paths of the parameters in a set.
    pub fn params(&self, set: &CauseSet) -> BTreeSet<String> {
        if !set.meets(&self.params) {
            return BTreeSet::new();
        }
        let all = set.numbers().map(|number| &self.all[number]);
        all.filter(|(kind, _)| *kind == CauseKind::Param).map(|(_, name)| name.clone()).collect()
    }

    /// The parameter in a set, if it has exactly one.
    pub fn only_param(&self, set: &CauseSet) -> Option<&str> {
        let mut params = set.numbers().map(|number| &self.all[number]).filter(|(kind, _)| *kind == CauseKind::Param);
        match (params.next(), params.next()) {
            (Some((_, name)), None) => Some(name),
            _ => None,
        }
    }

    /// A set with its names.
    pub fn named(&self, set: &CauseSet) -> Causes {
        let mut causes = Causes::default();
        for (kind, name) in set.numbers().map(|number| &self.all[number]) {
            match kind {
                CauseKind::Input => _ = causes.inputs.insert(name.clone()),
                CauseKind::Live => _ = causes.live.insert(name.clone()),
                CauseKind::Param => _ = causes.params.insert(name.clone()),
                CauseKind::Viewport => causes.viewport = true,
            }
        }
        causes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_of_many_causes_unite_and_keep_their_names() {
        let mut names = CauseNames::default();
        let mut all = CauseSet::default();
        for n in 0..300 {
            let kind = if n % 2 == 0 { CauseKind::Param } else { CauseKind::Input };
            let one = names.set(kind, &format!("x{n}"));
            assert_eq!(one, names.set(kind, &format!("x{n}")), "a name has one number");
            assert!(!one.meets(&all) && all.add(&one) && !all.add(&one) && one.meets(&all));
        }
        let named = names.named(&all);
        assert_eq!((named.params.len(), named.inputs.len(), named.live.len(), named.viewport), (150, 150, 0, false));
        assert_eq!(names.params(&all), named.params);
        assert_eq!(names.only_param(&all), None);
    }

    #[test]
    fn a_name_of_two_kinds_is_two_causes() {
        let mut names = CauseNames::default();
        let (live, param) = (names.set(CauseKind::Live, "camera.x"), names.set(CauseKind::Param, "camera.x"));
        assert!(live != param && !live.meets(&param));
        assert_eq!(names.such(CauseKind::Live, |name| name.starts_with("camera.")), live);
        let mut both = live;
        both.add(&param);
        assert_eq!(names.only_param(&both), Some("camera.x"));
    }
}
