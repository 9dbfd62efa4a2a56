//! Classes of default values, and the values that an element has with those of its class.

use std::collections::BTreeMap;

use super::attributes::{AutoSetting, exactly, finite, setting, values, wrong};
use crate::markup::MarkupElement;
use crate::whole::Result;

/// Most classes inside each other, and most of all.
const LEVELS_MAX: usize = 16;
const CLASSES_MAX: usize = 2000;

/// Elements of a class that are read, but for actuators.
const READ: [&str; 4] = ["joint", "geom", "site", "equality"];

/// Elements of actuators: a class has one set of values for all of them.
pub(super) const ACTUATORS: [&str; 12] = [
    "general",
    "motor",
    "position",
    "velocity",
    "intvelocity",
    "orientation",
    "pid",
    "damper",
    "cylinder",
    "muscle",
    "adhesion",
    "dcmotor",
];

/// Classes of a file; the first is the one that all others begin with.
pub(super) struct DefaultClasses {
    all: Vec<DefaultClass>,
    by_name: BTreeMap<String, usize>,
}

#[derive(Default)]
struct DefaultClass {
    before: Option<usize>,
    /// One of a name; a later one takes the place of an earlier one, attribute by attribute.
    elements: Vec<MarkupElement>,
}

impl DefaultClasses {
    /// Classes of the sections of a file.
    pub(super) fn of(root: &MarkupElement) -> Result<Self> {
        let mut classes = Self { all: vec![DefaultClass::default()], by_name: BTreeMap::new() };
        classes.by_name.insert("main".to_owned(), 0);
        for section in root.elements().filter(|section| section.name == "default") {
            match section.attribute("class") {
                None | Some("" | "main") => {}
                // MuJoCo 2 and 3 let the outermost class have another name.
                Some(name) => drop(classes.by_name.insert(name.to_owned(), 0)),
            }
            classes.fill(section, 0, 0)?;
        }
        Ok(classes)
    }

    fn fill(&mut self, section: &MarkupElement, class: usize, level: usize) -> Result<()> {
        if level > LEVELS_MAX || self.all.len() > CLASSES_MAX {
            let why = format!(
                "more than {LEVELS_MAX} classes inside each other, or {CLASSES_MAX} of all"
            );
            return Err(wrong(section, &why));
        }
        let read = |name: &str| READ.contains(&name) || ACTUATORS.contains(&name);
        for element in section.elements().filter(|element| read(&element.name)) {
            let own = &mut self.all[class].elements;
            let before = own.iter().position(|other| other.name == element.name);
            let mut merged = element.clone();
            if let Some(before) = before {
                let earlier = own.remove(before);
                for (key, value) in earlier.attributes {
                    if merged.attribute(&key).is_none() {
                        merged.set(key, value);
                    }
                }
            }
            own.push(merged);
        }
        for nested in section.elements().filter(|element| element.name == "default") {
            let name = nested.attribute("class").filter(|name| !name.is_empty());
            let name = name.ok_or_else(|| wrong(nested, "it has no \"class\""))?.to_owned();
            self.all.push(DefaultClass { before: Some(class), elements: Vec::new() });
            let new = self.all.len() - 1;
            if self.by_name.insert(name.clone(), new).is_some() {
                return Err(wrong(nested, &format!("another class is called \"{name}\"")));
            }
            self.fill(nested, new, level + 1)?;
        }
        Ok(())
    }

    /// The class that `key` of an element names, else `inherited`.
    pub(super) fn named(
        &self,
        element: &MarkupElement,
        key: &str,
        inherited: usize,
    ) -> Result<usize> {
        let Some(name) = element.attribute(key) else { return Ok(inherited) };
        let unknown = || wrong(element, &format!("there is no class \"{name}\""));
        self.by_name.get(name).copied().ok_or_else(unknown)
    }

    /// An element with the values of its class, `inherited` where it names none.
    pub(super) fn with<'m>(
        &'m self,
        element: &'m MarkupElement,
        inherited: usize,
    ) -> Result<WithDefaults<'m>> {
        let actuator = ACTUATORS.contains(&&*element.name);
        let same = |other: &&MarkupElement| {
            other.name == element.name || (actuator && ACTUATORS.contains(&&*other.name))
        };
        let mut levels = vec![element];
        let mut next = Some(self.named(element, "class", inherited)?);
        while let Some(class) = next.and_then(|at| self.all.get(at)) {
            levels.extend(class.elements.iter().rev().filter(same));
            next = class.before;
        }
        Ok(WithDefaults { levels })
    }
}

/// An element, and those of its classes, the nearest one first.
pub(super) struct WithDefaults<'m> {
    pub(super) levels: Vec<&'m MarkupElement>,
}

impl WithDefaults<'_> {
    /// The element itself.
    pub(super) fn own(&self) -> &MarkupElement {
        self.levels[0]
    }

    /// The nearest element that states the attribute.
    fn level(&self, key: &str) -> Option<&MarkupElement> {
        self.levels.iter().copied().find(|level| level.attribute(key).is_some())
    }

    pub(super) fn word(&self, key: &str) -> Option<&str> {
        self.level(key)?.attribute(key)
    }

    pub(super) fn number(&self, key: &str) -> Result<Option<f64>> {
        Ok(self.finite::<1>(key)?.map(|[number]| number))
    }

    pub(super) fn finite<const N: usize>(&self, key: &str) -> Result<Option<[f64; N]>> {
        self.level(key).map_or(Ok(None), |level| finite(level, key))
    }

    /// Two ends, which may be infinite.
    pub(super) fn ends(&self, key: &str) -> Result<Option<(f64, f64)>> {
        let ends = self.level(key).map_or(Ok(None), |level| exactly::<2>(level, key))?;
        Ok(ends.map(|[low, high]| (low, high)))
    }

    pub(super) fn setting(&self, key: &str) -> Result<AutoSetting> {
        let stated = self.level(key).map_or(Ok(None), |level| setting(level, key))?;
        Ok(stated.unwrap_or(AutoSetting::Auto))
    }

    /// Numbers of which a nearer element may state the first few alone: each is that of the nearest one that has it.
    pub(super) fn up_to<const N: usize>(&self, key: &str, default: [f64; N]) -> Result<[f64; N]> {
        let mut found = default;
        for level in self.levels.iter().rev() {
            for (into, value) in found.iter_mut().zip(values(level, key)?.unwrap_or_default()) {
                *into = value;
            }
        }
        Ok(found)
    }

    fn values(&self, key: &str) -> Result<Option<Vec<f64>>> {
        self.level(key).map_or(Ok(None), |level| values(level, key))
    }

    /// The first of several numbers, such as those of a polynomial.
    pub(super) fn first(&self, key: &str) -> Result<Option<f64>> {
        Ok(self.values(key)?.and_then(|values| values.first().copied()))
    }

    /// Returns true if another number than the first is not 0.
    pub(super) fn bends(&self, key: &str) -> Result<bool> {
        Ok(self.values(key)?.is_some_and(|values| values.iter().skip(1).any(|x| *x != 0.0)))
    }
}
