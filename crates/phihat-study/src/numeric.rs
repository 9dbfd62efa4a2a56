//! Keys that are numbers, found by their path: what a sweep may vary, and how one value of it is put into a study.

use toml::{Table, Value};

use crate::error::{StudyError, StudyErrorKind as Kind, TextPlace};
use crate::format::{FormatSection, Key, Need, NumberBounds, Shape};
use crate::keys::STUDY;
use crate::study::Study;
use crate::suggest::{nearest, sections, with_right_unit};

/// A number of a study, by its path: `world.payload.mass_kg`, `fault[0].size`, `gains.inertia_kg_m2[2]`,
/// `world.coulomb_extra_nm.joint2`, `reference.sine[0].frequency_hz`.
///
/// A key that has a value per joint stands for all joints, or for one that is named by its place, from 0, or
/// by its name.
///
/// # Example
///
/// ```
/// # let text = "duration_s = 2.0\n[robot]\nname = \"planar3r\"\n[gains]\nbandwidth_rad_s = 20.0\n\
/// #     estimator_bandwidth_rad_s = 70.0\ninertia_kg_m2 = 0.3\n[reference]\nkind = \"hold\"\npose = \"ready\"\n";
/// use phihat_study::{NumericKey, Study};
///
/// let study = Study::from_text(text, "demo.toml", "".as_ref())?;
/// let key = NumericKey::find(&study, "world.payload.mass_kg", "--vary")?;
/// assert!(key.unit() == "kg" && key.admits(0.7) && !key.admits(0.0) && key.begins_above(0.0));
///
/// let error = NumericKey::find(&study, "world.payload.mass_g", "--vary").unwrap_err();
/// assert!(error.to_string().contains("world.payload.mass_kg"));
/// # Ok::<(), phihat_study::StudyError>(())
/// ```
#[derive(Debug, Clone)]
pub struct NumericKey {
    path: String,
    above: Vec<(String, Option<usize>)>,
    key: &'static Key,
    bounds: NumberBounds,
    /// The one entry that is meant, of so many.
    entry: Option<NumericEntry>,
}

#[derive(Debug, Clone)]
struct NumericEntry {
    place: usize,
    count: usize,
    /// Of a value per joint: the joint's name, and what all of them are where the study says nothing.
    joint: Option<String>,
}

/// One step of a path: a name, and the place behind it.
type PathStep<'a> = (&'a str, Option<usize>);

impl NumericKey {
    /// Finds a key by its path; `origin` stands for whoever named it in messages.
    ///
    /// # Errors
    ///
    /// There is no such key, its unit is another one, it is no number, or the study has no such entry.
    pub fn find(study: &Study, path: &str, origin: &str) -> Result<Self, StudyError> {
        let find = Finder { path, origin };
        let steps = find.steps()?;
        let table: Table =
            study.table().map_err(|_| find.error(Kind::Syntax, "not in a readable study"))?;
        let mut section: &'static FormatSection = &STUDY;
        let mut at: Option<&Table> = Some(&table);
        for (depth, &(name, place)) in steps.iter().enumerate() {
            let Some(key) = section.key(name) else {
                return Err(find.unknown(section, name));
            };
            let value = at.and_then(|table| table.get(name));
            let inner = match &key.shape {
                Shape::Table(inner) => {
                    at = value.and_then(Value::as_table);
                    *inner
                }
                Shape::Tables(inner, _) => {
                    at = Some(find.entry(name, place, value)?);
                    *inner
                }
                Shape::Kinds(kinds) => {
                    at = value.and_then(Value::as_table);
                    let word = at.and_then(|table| table.get("kind")).and_then(Value::as_str);
                    let kind = kinds.iter().find(|kind| Some(kind.word) == word);
                    kind.map(|kind| kind.section)
                        .ok_or_else(|| find.error(Kind::MissingKey, "the study does not say it"))?
                }
                _ => {
                    let rest = steps.get(depth + 1..).unwrap_or(&[]);
                    let above = steps[..depth].iter().map(|(n, p)| ((*n).to_owned(), *p));
                    let found = find.leaf(study, key, place, rest)?;
                    return Ok(Self { above: above.collect(), ..found });
                }
            };
            section = inner;
        }
        let keys: Vec<_> = section.keys.iter().filter(|key| is_numeric(key)).collect();
        let names = keys.iter().map(|key| format!("`{path}.{}`", key.name)).collect::<Vec<_>>();
        Err(find.error(Kind::WrongType, "a section, not a number").with_help(if names.is_empty() {
            String::new()
        } else {
            names.join(", ")
        }))
    }

    /// The path as it was given.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// The first section of the path; empty for a key at the top of the file.
    pub fn section(&self) -> &str {
        self.above.first().map_or("", |(name, _)| name)
    }

    /// The unit; empty where there is none.
    pub fn unit(&self) -> &'static str {
        self.key.unit
    }

    /// Returns true if only integers are valid.
    pub fn is_integer(&self) -> bool {
        self.bounds.integer
    }

    /// Returns true if a study may have this number there.
    pub fn admits(&self, value: f64) -> bool {
        self.bounds.admit(value) && (!self.bounds.integer || value.fract() == 0.0)
    }

    /// Returns true if a study may have every number above this one, and not this one.
    pub fn begins_above(&self, value: f64) -> bool {
        self.bounds.open && value.total_cmp(&self.bounds.low).is_eq()
    }

    /// Range of the numbers that a study may have there, in words.
    pub fn range(&self) -> String {
        let integers = if self.bounds.integer { "integers, " } else { "" };
        format!("{integers}{}", self.bounds)
    }

    /// Puts a number into a study's table.
    pub fn put(&self, table: &mut Table, value: f64) {
        let number = self.value(value);
        let Some(at) = self.table_of(table) else { return };
        match &self.entry {
            None => _ = at.insert(self.key.name.to_owned(), number),
            Some(entry) => self.put_entry(at, entry, number),
        }
    }

    /// Multiplies what a study's table has there, every entry of it; whether it had any number.
    pub fn scale(&self, table: &mut Table, factor: f64) -> bool {
        let Some(at) = self.table_of(table) else { return false };
        if let Some(entry) = &self.entry {
            let Some(old) = at.get(self.key.name).and_then(|value| entry.of(value)) else {
                return false;
            };
            self.put_entry(at, entry, self.value(old * factor));
            return true;
        }
        at.get_mut(self.key.name).is_some_and(|value| self.scaled(value, factor))
    }

    /// The numbers that a study's table has there.
    pub fn numbers(&self, table: &Table) -> Vec<f64> {
        let mut at = table;
        for (name, place) in &self.above {
            let value = at.get(name);
            let inner = match place {
                Some(i) => value.and_then(Value::as_array).and_then(|all| all.get(*i)),
                None => value,
            };
            let Some(inner) = inner.and_then(Value::as_table) else { return Vec::new() };
            at = inner;
        }
        let Some(value) = at.get(self.key.name) else { return Vec::new() };
        if let Some(entry) = &self.entry {
            return entry.of(value).into_iter().collect();
        }
        match value {
            Value::Array(all) => all.iter().filter_map(number).collect(),
            Value::Table(all) => all.values().filter_map(number).collect(),
            one => number(one).into_iter().collect(),
        }
    }

    fn value(&self, value: f64) -> Value {
        let whole = || format!("{value:.0}").parse::<i64>().ok();
        let whole = if self.bounds.integer { whole() } else { None };
        whole.map_or_else(|| value.into(), Value::from)
    }

    fn table_of<'t>(&self, table: &'t mut Table) -> Option<&'t mut Table> {
        let mut at = table;
        for (name, place) in &self.above {
            let value = match place {
                Some(i) => at.get_mut(name)?.as_array_mut()?.get_mut(*i)?,
                None => at.entry(name.clone()).or_insert_with(|| Value::Table(Table::new())),
            };
            at = value.as_table_mut()?;
        }
        Some(at)
    }

    fn put_entry(&self, at: &mut Table, entry: &NumericEntry, number: Value) {
        let name = self.key.name;
        if let (Some(Value::Table(all)), Some(joint)) = (at.get_mut(name), &entry.joint) {
            all.insert(joint.clone(), number);
            return;
        }
        let all = match at.get(name) {
            Some(Value::Array(all)) => all.clone(),
            Some(one) if entry.joint.is_some() => vec![one.clone(); entry.count],
            _ => match self.key.need {
                Need::Numbers(all) => all.iter().map(|x| Value::from(*x)).collect(),
                Need::Number(x) => vec![self.value(x); entry.count],
                Need::Count(n) => vec![i64::from(n).into(); entry.count],
                _ => vec![number.clone(); entry.count],
            },
        };
        let place = |(i, old)| if i == entry.place { number.clone() } else { old };
        let all: Vec<Value> = all.into_iter().enumerate().map(place).collect();
        at.insert(name.to_owned(), all.into());
    }

    fn scaled(&self, value: &mut Value, factor: f64) -> bool {
        match value {
            Value::Array(all) => all.iter_mut().all(|one| self.scaled(one, factor)),
            Value::Table(all) => all.iter_mut().all(|(_, one)| self.scaled(one, factor)),
            one => match number(one) {
                Some(old) => {
                    *one = self.value(old * factor);
                    true
                }
                None => false,
            },
        }
    }
}

impl NumericEntry {
    /// Its number, of all of them.
    fn of(&self, value: &Value) -> Option<f64> {
        match (value, &self.joint) {
            (Value::Array(all), _) => all.get(self.place).and_then(number),
            (Value::Table(all), Some(joint)) => all.get(joint).and_then(number),
            (one, Some(_)) => number(one),
            _ => None,
        }
    }
}

/// A path that is looked for.
struct Finder<'a> {
    path: &'a str,
    origin: &'a str,
}

impl<'a> Finder<'a> {
    fn error(&self, kind: Kind, message: impl Into<String>) -> StudyError {
        StudyError::new(kind, TextPlace::whole_file(self.origin), self.path, message)
    }

    fn steps(&self) -> Result<Vec<PathStep<'a>>, StudyError> {
        let step = |text: &'a str| -> Option<PathStep<'a>> {
            let Some((name, place)) = text.split_once('[') else {
                return (!text.is_empty()).then_some((text, None));
            };
            let place = place.strip_suffix(']')?.parse().ok()?;
            (!name.is_empty()).then_some((name, Some(place)))
        };
        let steps: Option<Vec<_>> = self.path.split('.').map(step).collect();
        steps.ok_or_else(|| {
            let words = "a key is written like `world.payload.mass_kg` or `fault[0].size`";
            self.error(Kind::UnknownKey, "not the path of a key").with_help(words)
        })
    }

    /// There is no such key in a section: the one with the right unit, else the nearest of all.
    fn unknown(&self, section: &'static FormatSection, name: &str) -> StudyError {
        let inside = |name: &str| match section.path {
            "" => name.to_owned(),
            path => format!("{path}.{name}"),
        };
        if let Some((right, unit)) = with_right_unit(name, section) {
            let message = format!("no such key: the unit here is {unit}");
            return self
                .error(Kind::WrongUnit, message)
                .with_help(format!("write `{}`", inside(right)));
        }
        let all: Vec<String> = all_paths();
        let last = self.path.rsplit('.').next().unwrap_or_default();
        let ending = format!(".{last}");
        let same: Vec<_> = all.iter().filter(|path| path.ends_with(&ending)).collect();
        let help = match same.as_slice() {
            [] => nearest(self.path, all.iter().map(String::as_str))
                .or_else(|| nearest(&inside(name), all.iter().map(String::as_str)))
                .map_or_else(
                    || "docs/study.md lists all keys".to_owned(),
                    |near| format!("did you mean `{near}`?"),
                ),
            [one] => format!("did you mean `{one}`?"),
            several => {
                let names: Vec<_> =
                    several.iter().take(6).map(|path| format!("`{path}`")).collect();
                format!("did you mean one of {}?", names.join(", "))
            }
        };
        self.error(Kind::UnknownKey, "unknown key").with_help(help)
    }

    /// One of the tables that a study has under a name.
    fn entry<'t>(
        &self,
        name: &str,
        place: Option<usize>,
        value: Option<&'t Value>,
    ) -> Result<&'t Table, StudyError> {
        let all = value.and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
        let Some(place) = place else {
            return Err(self
                .error(Kind::WrongType, format!("`{name}` is a list of sections"))
                .with_help(format!("name one by its place, from 0: `{name}[0]`")));
        };
        all.get(place).and_then(Value::as_table).ok_or_else(|| {
            let has = match all.len() {
                0 => format!("the study has no [[{name}]]"),
                1 => format!("the study has one [[{name}]]: `{name}[0]`"),
                n => format!("the study has {n} [[{name}]]: `{name}[0]` to `{name}[{}]`", n - 1),
            };
            self.error(Kind::WrongLength, has)
        })
    }

    fn leaf(
        &self,
        study: &Study,
        key: &'static Key,
        place: Option<usize>,
        rest: &[PathStep<'_>],
    ) -> Result<NumericKey, StudyError> {
        let joints: Vec<&str> = study.robot.joints.iter().map(|j| j.name.as_str()).collect();
        let found = |bounds, entry| {
            Ok(NumericKey { path: self.path.to_owned(), above: Vec::new(), key, bounds, entry })
        };
        match &key.shape {
            Shape::Number(bounds) | Shape::NumberOrWord(bounds, _)
                if place.is_none() && rest.is_empty() =>
            {
                found(*bounds, None)
            }
            Shape::PerJoint(bounds, _) => match (place, rest) {
                (None, []) => found(*bounds, None),
                (Some(place), []) if place < joints.len() => {
                    found(*bounds, Some(NumericEntry::joint(place, &joints)))
                }
                (None, [(name, None)]) => match joints.iter().position(|joint| joint == name) {
                    Some(place) => found(*bounds, Some(NumericEntry::joint(place, &joints))),
                    None => Err(self.no_joint(&joints)),
                },
                _ => Err(self.no_joint(&joints)),
            },
            Shape::List { min, max, bounds } => match (place, rest) {
                (Some(place), []) if place < *max => {
                    found(*bounds, Some(NumericEntry { place, count: *min, joint: None }))
                }
                _ => Err(self
                    .error(Kind::WrongType, "a list of numbers")
                    .with_help(format!("name one by its place, from 0: `{}[0]`", key.name))),
            },
            _ if is_numeric(key) => Err(self
                .error(Kind::UnknownKey, "no such entry")
                .with_help(format!("`{}` is one number", key.name))),
            _ => Err(self
                .error(Kind::WrongType, format!("`{}` is not a number", key.name))
                .with_help("only numbers vary")),
        }
    }

    fn no_joint(&self, joints: &[&str]) -> StudyError {
        self.error(Kind::UnknownName, "the arm has no such joint")
            .with_help(format!("its joints are {}", joints.join(", ")))
    }
}

impl NumericEntry {
    fn joint(place: usize, joints: &[&str]) -> Self {
        let joint = joints.get(place).map(|name| (*name).to_owned());
        Self { place, count: joints.len(), joint }
    }
}

fn number(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|n| n as f64))
}

fn is_numeric(key: &Key) -> bool {
    matches!(
        key.shape,
        Shape::Number(_) | Shape::NumberOrWord(..) | Shape::PerJoint(..) | Shape::List { .. }
    )
}

/// The paths of all numbers that a study may have, each once.
fn all_paths() -> Vec<String> {
    let mut all: Vec<String> = sections(&STUDY)
        .into_iter()
        .flat_map(|(_, section)| {
            let inside = |key: &Key| match section.path {
                "" => key.name.to_owned(),
                path => format!("{path}.{}", key.name),
            };
            section.keys.iter().filter(|key| is_numeric(key)).map(inside)
        })
        .collect();
    all.sort_unstable();
    all.dedup();
    all
}
