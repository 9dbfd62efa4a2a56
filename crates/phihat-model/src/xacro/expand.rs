//! From a file of xacro to the text of a URDF.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use roxmltree::Document;

use super::evaluate::{XacroNames, evaluate};
use super::expression::parse;
use super::reason::{Reasoned, reason};
use super::scope::{Macro, Property, XacroScope, parameters};
use super::text::{TextPart, parts};
use super::value::{TEXT_MAX, XacroValue};
use super::{packages, yaml};
use crate::error::RobotError;
use crate::markup::{MarkupElement, MarkupPart, MarkupPlace, PREFIX};
use crate::named_texts::NamedTexts;
use crate::robot_text::read_text;
use crate::urdf::{XACRO_ATTRIBUTES_MAX, declared, scanned};

/// Most steps: parts of expressions, elements, and sixteenths of the bytes that they make.
const STEPS_MAX: usize = 4_000_000;

/// Most elements, macros and properties inside each other.
const LEVELS_MAX: usize = 160;
const CALLS_MAX: usize = 40;
const OPEN_MAX: usize = 32;

/// Most files that are included.
const FILES_MAX: usize = 500;

/// Options of an expansion.
#[derive(Debug, Clone, Default)]
pub struct XacroOptions {
    /// Values of the file's arguments, in place of their defaults.
    pub arguments: BTreeMap<String, String>,
    /// Folders of ROS packages by name, before those that are installed or near the file.
    pub packages: BTreeMap<String, PathBuf>,
    /// Files that the description and its parts are read from.
    pub files: NamedTexts,
}

/// An expanded description.
#[derive(Debug, Clone)]
pub struct Expanded {
    /// The text of the URDF.
    pub urdf: String,
    /// Words that stand for that text in errors, whose lines are its own.
    pub origin: String,
    /// Files that were read, that of the description first.
    pub files: Vec<PathBuf>,
    /// Arguments that the file declares, with the values that they had.
    pub arguments: BTreeMap<String, String>,
}

/// Expands a description.
///
/// # Errors
///
/// [`RobotError`] with file and line: it cannot be read, it is no XML, something in it is not defined, or not read
/// here; an option names an argument that the file does not declare.
///
/// # Example
///
/// ```
/// use phihat_model::xacro::{XacroOptions, expand};
///
/// let folder = std::env::temp_dir().join(format!("phihat-doc-{}", std::process::id()));
/// std::fs::create_dir_all(&folder)?;
/// let file = folder.join("one.urdf.xacro");
/// std::fs::write(&file, r#"<robot name="one" xmlns:xacro="http://ros.org/wiki/xacro">
///   <xacro:arg name="side" default="left"/>
///   <xacro:property name="length" value="0.4"/>
///   <link name="$(arg side)_arm" length="${length / 2}"/>
/// </robot>"#)?;
/// let mut options = XacroOptions::default();
/// options.arguments.insert("side".to_owned(), "right".to_owned());
/// let urdf = expand(&file, &options)?.urdf;
/// assert!(urdf.contains(r#"<link name="right_arm" length="0.2"/>"#));
/// # std::fs::remove_dir_all(&folder)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn expand(path: &Path, options: &XacroOptions) -> Result<Expanded, RobotError> {
    let mut expander = Expander::new(path, options);
    let root = expander.file(path).map_err(RobotError::plain)?;
    let root = expander.element(&root).map_err(|own| own.error(&expander.calls).plain())?;
    expander.all_declared(path).map_err(RobotError::plain)?;
    let mut urdf = String::from("<?xml version=\"1.0\"?>\n");
    root.write(0, &mut urdf);
    let Expander { files, mut arguments, declared, .. } = expander;
    arguments.retain(|name, _| declared.contains(name));
    let origin = format!("{}, expanded", path.display());
    Ok(Expanded { urdf, origin, files, arguments })
}

/// Returns true if one of these files is of xacro: by its name, or by an element of xacro in it.
pub fn is_xacro(path: &Path, files: &NamedTexts) -> bool {
    path.extension().is_some_and(|extension| extension == "xacro")
        || (files.is_file(path)
            && read_text(files, path).is_ok_and(|text| text.contains("<xacro:")))
}

/// Refusal with its place.
#[derive(Debug)]
enum Wrong {
    Here(MarkupPlace, String),
    File(RobotError),
}

impl Wrong {
    fn error(self, calls: &[(String, MarkupPlace)]) -> RobotError {
        let (place, why) = match self {
            Self::Here(place, why) => (place, why),
            Self::File(error) => return error,
        };
        let within = calls.last().map_or_else(String::new, |(name, from)| {
            format!("; in the macro \"{name}\" that {}:{} calls", from.file, from.line)
        });
        RobotError::Xml { origin: place.file.to_string(), line: place.line, why: why + &within }
    }
}

type Result<T, E = Wrong> = core::result::Result<T, E>;

/// A description on its way.
struct Expander<'o> {
    options: &'o XacroOptions,
    arguments: BTreeMap<String, String>,
    declared: BTreeSet<String>,
    scopes: Vec<XacroScope>,
    files: Vec<PathBuf>,
    /// Macros that are being expanded, and where they were called.
    calls: Vec<(String, MarkupPlace)>,
    here: MarkupPlace,
    levels: usize,
    open: usize,
    steps: usize,
}

impl<'o> Expander<'o> {
    fn new(path: &Path, options: &'o XacroOptions) -> Self {
        let here = MarkupPlace { file: Rc::from(path.display().to_string()), line: 1 };
        Self {
            options,
            arguments: options.arguments.clone(),
            declared: BTreeSet::new(),
            scopes: vec![XacroScope::default()],
            files: Vec::new(),
            calls: Vec::new(),
            here,
            levels: 0,
            open: 0,
            steps: 0,
        }
    }

    /// The root of a file.
    fn file(&mut self, path: &Path) -> Result<MarkupElement, RobotError> {
        let origin: Rc<str> = Rc::from(path.display().to_string());
        if self.files.len() >= FILES_MAX {
            let (origin, limit) = (origin.to_string(), FILES_MAX);
            return Err(RobotError::TooMuch { origin, what: "files", found: limit + 1, limit });
        }
        let text = read_text(&self.options.files, path)?;
        scanned(&text, &origin, XACRO_ATTRIBUTES_MAX)?;
        self.files.push(path.to_owned());
        let text = declared(Cow::Owned(text));
        let document = Document::parse(&text).map_err(|error| RobotError::Xml {
            origin: origin.to_string(),
            line: error.pos().row,
            why: error.to_string(),
        })?;
        Ok(MarkupElement::of(&document, &origin))
    }

    /// Refuses values of arguments that the file does not have.
    fn all_declared(&self, path: &Path) -> Result<(), RobotError> {
        let unknown = self.options.arguments.keys().find(|name| !self.declared.contains(*name));
        let Some(name) = unknown else { return Ok(()) };
        let own: Vec<&str> = self.declared.iter().map(String::as_str).collect();
        let own = if own.is_empty() { "none".to_owned() } else { own.join(", ") };
        let why = format!("it has no argument \"{name}\"; it has {own}");
        Err(RobotError::Value { origin: path.display().to_string(), key: name.clone(), why })
    }

    fn count(&mut self, steps: usize) -> Reasoned<()> {
        self.steps = self.steps.saturating_add(steps);
        if self.steps > STEPS_MAX {
            Err("more is to be expanded than is read".into())
        } else {
            Ok(())
        }
    }

    /// Value of a text with its expressions, names from the first `depth` scopes.
    fn evaluated(&mut self, text: &str, depth: usize) -> Reasoned<XacroValue> {
        self.count(1 + text.len() / 16)?;
        let parts = parts(text);
        let mut made = String::new();
        let alone = parts.len() == 1;
        for part in parts {
            let value = match part {
                TextPart::Plain(plain) => XacroValue::Text(plain.to_owned()),
                TextPart::Expression(inside) => {
                    let value = self.expression(inside, depth);
                    value.map_err(|why| reason!("${{{inside}}}: {why}"))?
                }
                TextPart::Extension(inside) => self.extension(inside, depth)?,
            };
            if alone {
                return Ok(value);
            }
            made.push_str(&value.to_string());
            self.count(made.len() / 256)?;
            if made.len() > TEXT_MAX {
                return Err("a text longer than is read".into());
            }
        }
        Ok(XacroValue::Text(made))
    }

    fn expression(&mut self, inside: &str, depth: usize) -> Reasoned<XacroValue> {
        let text = self.evaluated(inside, depth)?.to_string();
        evaluate(&parse(&text)?, &mut ScopeNames { expander: self, depth })
    }

    /// Value of `$(…)`.
    fn extension(&mut self, inside: &str, depth: usize) -> Reasoned<XacroValue> {
        let inside = self.evaluated(inside, depth)?.to_string();
        let (verb, rest) =
            inside.trim().split_once(char::is_whitespace).unwrap_or((inside.trim(), ""));
        let rest = rest.trim();
        let folder = || {
            let folder = Path::new(&*self.here.file).parent().unwrap_or(Path::new(""));
            folder.display().to_string()
        };
        let text = match verb {
            "arg" => self.arguments.get(rest).cloned().ok_or_else(|| {
                reason!("$(arg {rest}): there is no argument \"{rest}\"; state it as {rest}:=VALUE")
            })?,
            "find" => {
                let places = (&self.options.packages, &self.options.files);
                let found = packages::find(rest, places, Path::new(&*self.here.file))?;
                found.display().to_string()
            }
            "env" => std::env::var(rest).map_err(|_| reason!("$(env {rest}): it is not set"))?,
            "optenv" => {
                let (name, default) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
                std::env::var(name).unwrap_or_else(|_| default.trim().to_owned())
            }
            "dirname" => folder(),
            "cwd" => ".".to_owned(),
            "eval" => return evaluate(&parse(rest)?, &mut ScopeNames { expander: self, depth }),
            _ => {
                return Err(reason!(
                    "$({inside}) is not read; arg, find, env, optenv, eval and dirname are"
                ));
            }
        };
        Ok(XacroValue::Text(text))
    }

    /// The text of a text with its expressions.
    fn text(&mut self, text: &str, place: &MarkupPlace) -> Result<String> {
        self.value(text, place).map(|value| value.to_string())
    }

    fn value(&mut self, text: &str, place: &MarkupPlace) -> Result<XacroValue> {
        self.here = place.clone();
        let depth = self.scopes.len();
        self.evaluated(text, depth).map_err(|why| Wrong::Here(place.clone(), why.0))
    }

    /// An attribute that must be there, evaluated.
    fn needed(&mut self, element: &MarkupElement, key: &str) -> Result<String> {
        match element.attribute(key) {
            Some(text) => self.text(text, &element.place),
            None => Err(wrong(element, format!("<{}> has no \"{key}\"", element.name))),
        }
    }

    fn condition(&mut self, element: &MarkupElement, key: &str, default: bool) -> Result<bool> {
        let Some(text) = element.attribute(key) else { return Ok(default) };
        let value = self.value(text, &element.place)?;
        value.condition().ok_or_else(|| {
            wrong(element, format!("{key}=\"{value}\" is neither true, false nor a number"))
        })
    }

    /// An element that xacro leaves, with what it expands to inside.
    fn element(&mut self, element: &MarkupElement) -> Result<MarkupElement> {
        self.count(1).map_err(|why| wrong(element, why.0))?;
        self.levels += 1;
        if self.levels > LEVELS_MAX {
            return Err(wrong(element, format!("more than {LEVELS_MAX} levels inside each other")));
        }
        let mut own = MarkupElement {
            name: element.name.clone(),
            attributes: Vec::new(),
            parts: Vec::new(),
            place: element.place.clone(),
        };
        for (name, value) in &element.attributes {
            if !name.starts_with(PREFIX) {
                let value = self.text(value, &element.place)?;
                own.attributes.push((name.clone(), value));
            }
        }
        let parts = self.parts(&element.parts, &mut own)?;
        own.parts = parts;
        self.levels -= 1;
        Ok(own)
    }

    /// Parts that those of an element expand to; `parent` takes attributes.
    fn parts(
        &mut self,
        parts: &[MarkupPart],
        parent: &mut MarkupElement,
    ) -> Result<Vec<MarkupPart>> {
        let mut out = Vec::new();
        for part in parts {
            match part {
                MarkupPart::Text(text) => {
                    let place = parent.place.clone();
                    let text = self.text(text, &place)?;
                    out.push(MarkupPart::Text(text));
                }
                MarkupPart::Element(element) => self.one(element, parent, &mut out)?,
            }
        }
        Ok(out)
    }

    fn one(
        &mut self,
        element: &MarkupElement,
        parent: &mut MarkupElement,
        out: &mut Vec<MarkupPart>,
    ) -> Result<()> {
        let Some(verb) = element.name.strip_prefix(PREFIX) else {
            out.push(MarkupPart::Element(self.element(element)?));
            return Ok(());
        };
        match verb {
            "property" => self.property(element),
            "macro" => self.define(element),
            "arg" => self.argument(element),
            "include" => self.include(element, parent, out),
            "insert_block" => {
                let name = self.needed(element, "name")?;
                let block = self
                    .block(&name)
                    .ok_or_else(|| wrong(element, format!("there is no block \"{name}\"")))?;
                out.extend(self.parts(&block, parent)?);
                Ok(())
            }
            "if" | "unless" => {
                if element.attribute("value").is_none() {
                    return Err(wrong(element, format!("<{}> has no \"value\"", element.name)));
                }
                if self.condition(element, "value", false)? == (verb == "if") {
                    out.extend(self.parts(&element.parts, parent)?);
                }
                Ok(())
            }
            "element" => {
                let name = self.needed(element, "xacro:name")?;
                out.push(MarkupPart::Element(
                    self.element(&MarkupElement { name, ..element.clone() })?,
                ));
                Ok(())
            }
            "attribute" => {
                let (name, value) = (self.needed(element, "name")?, self.needed(element, "value")?);
                parent.set(name, value);
                Ok(())
            }
            "call" => {
                let name = self.needed(element, "macro")?;
                let mut call = element.clone();
                call.attributes.retain(|(key, _)| key != "macro");
                self.call(&name, &call, parent, out)
            }
            name => self.call(name, element, parent, out),
        }
    }

    fn property(&mut self, element: &MarkupElement) -> Result<()> {
        let name = self.needed(element, "name")?;
        let top = self.scopes.len() - 1;
        if self.condition(element, "remove", false)? {
            self.scopes[top].properties.remove(&name);
            return Ok(());
        }
        if let Some(default) = element.attribute("default") {
            if !self.scopes.iter().any(|scope| scope.properties.contains_key(&name)) {
                let text = Property::Text(default.to_owned());
                self.scopes[top].properties.insert(name, text);
            }
            return Ok(());
        }
        let Some(text) = element.attribute("value") else {
            let block = Rc::new(element.parts.clone());
            self.scopes[top].blocks.insert(format!("**{name}"), block);
            return Ok(());
        };
        let (scope, now) = match element.attribute("scope") {
            Some("global") => (0, true),
            Some("parent") => (top.saturating_sub(1), true),
            _ => (top, !self.condition(element, "lazy_eval", true)?),
        };
        let property = if now {
            Property::Value(literal(self.value(text, &element.place)?))
        } else {
            Property::Text(text.to_owned())
        };
        self.scopes[scope].properties.insert(name, property);
        Ok(())
    }

    fn define(&mut self, element: &MarkupElement) -> Result<()> {
        let name = self.needed(element, "name")?;
        let text = element.attribute("params").unwrap_or_default();
        let own = Macro { parameters: parameters(text), body: element.clone() };
        let top = self.scopes.len() - 1;
        let name = name.strip_prefix(PREFIX).unwrap_or(&name).to_owned();
        self.scopes[top].macros.insert(name, Rc::new(own));
        Ok(())
    }

    fn argument(&mut self, element: &MarkupElement) -> Result<()> {
        let name = self.needed(element, "name")?;
        if !self.arguments.contains_key(&name) {
            let default = self.needed(element, "default")?;
            self.arguments.insert(name.clone(), default);
        }
        self.declared.insert(name);
        Ok(())
    }

    fn include(
        &mut self,
        element: &MarkupElement,
        parent: &mut MarkupElement,
        out: &mut Vec<MarkupPart>,
    ) -> Result<()> {
        if element.attribute("ns").is_some() {
            return Err(wrong(element, "<xacro:include ns=…> is not read".to_owned()));
        }
        let name = self.needed(element, "filename")?;
        let folder = Path::new(&*element.place.file).parent().unwrap_or(Path::new(""));
        let path = folder.join(&name);
        if self.condition(element, "optional", false)? && !self.options.files.is_file(&path) {
            return Ok(());
        }
        let root = self.file(&path).map_err(|error| match error {
            RobotError::Read { source, .. } => wrong(
                element,
                format!("the included file {} cannot be read: {source}", path.display()),
            ),
            other => Wrong::File(other),
        })?;
        self.levels += 1;
        if self.levels > LEVELS_MAX {
            return Err(wrong(element, "files include each other without end".to_owned()));
        }
        out.extend(self.parts(&root.parts, parent)?);
        self.levels -= 1;
        Ok(())
    }

    /// A block by its name, the nearest scope first.
    fn block(&self, name: &str) -> Option<Rc<Vec<MarkupPart>>> {
        let keys = [format!("**{name}"), format!("*{name}")];
        let near = self.scopes.iter().rev();
        near.flat_map(|scope| keys.iter().filter_map(|key| scope.blocks.get(key))).next().cloned()
    }

    fn call(
        &mut self,
        name: &str,
        element: &MarkupElement,
        parent: &mut MarkupElement,
        out: &mut Vec<MarkupPart>,
    ) -> Result<()> {
        let own = self.scopes.iter().rev().find_map(|scope| scope.macros.get(name)).cloned();
        let own = own.ok_or_else(|| wrong(element, format!("there is no macro \"{name}\"")))?;
        if self.calls.len() >= CALLS_MAX {
            return Err(wrong(element, format!("more than {CALLS_MAX} macros inside each other")));
        }
        let scope = self.given(name, &own, element)?;
        self.calls.push((name.to_owned(), element.place.clone()));
        self.scopes.push(scope);
        out.extend(self.parts(&own.body.parts, parent)?);
        self.scopes.pop();
        self.calls.pop();
        Ok(())
    }

    /// The scope of a macro's call: its parameters and blocks, all evaluated where it is called.
    fn given(&mut self, name: &str, own: &Macro, element: &MarkupElement) -> Result<XacroScope> {
        let mut scope = XacroScope::default();
        let stars = |name: &str| name.starts_with('*');
        let known = |key: &str| own.parameters.iter().any(|p| p.name == key && !stars(key));
        for (key, text) in &element.attributes {
            if !known(key) {
                return Err(wrong(
                    element,
                    format!("the macro \"{name}\" has no parameter \"{key}\""),
                ));
            }
            let value = literal(self.value(text, &element.place)?);
            scope.properties.insert(key.clone(), Property::Value(value));
        }
        let mut holder = MarkupElement { parts: Vec::new(), ..element.clone() };
        let inside = self.parts(&element.parts, &mut holder)?;
        let mut blocks = inside.into_iter().filter(|part| matches!(part, MarkupPart::Element(_)));
        for parameter in &own.parameters {
            if stars(&parameter.name) {
                let missing = || {
                    wrong(
                        element,
                        format!("the macro \"{name}\" lacks the block \"{}\"", parameter.name),
                    )
                };
                let block = blocks.next().ok_or_else(missing)?;
                let content = match block {
                    MarkupPart::Element(block) if parameter.name.starts_with("**") => block.parts,
                    block => vec![block],
                };
                scope.blocks.insert(parameter.name.clone(), Rc::new(content));
            } else if !scope.properties.contains_key(&parameter.name) {
                let value = self.default(name, parameter, element)?;
                scope.properties.insert(parameter.name.clone(), Property::Value(value));
            }
        }
        match blocks.next() {
            Some(MarkupPart::Element(block)) => Err(wrong(
                element,
                format!("the macro \"{name}\" has no use for the block <{}>", block.name),
            )),
            _ => Ok(scope),
        }
    }

    fn default(
        &mut self,
        name: &str,
        parameter: &super::scope::Parameter,
        element: &MarkupElement,
    ) -> Result<XacroValue> {
        let place = &element.place;
        if parameter.forward {
            let depth = self.scopes.len();
            let value = ScopeNames { expander: self, depth }.value(&parameter.name);
            if let Some(value) = value.map_err(|why| Wrong::Here(place.clone(), why.0))? {
                return Ok(value);
            }
        }
        match &parameter.default {
            Some(text) => self.value(text, place).map(literal),
            None => {
                Err(wrong(element, format!("the macro \"{name}\" needs \"{}\"", parameter.name)))
            }
        }
    }
}

fn wrong(element: &MarkupElement, why: String) -> Wrong {
    Wrong::Here(element.place.clone(), why)
}

/// Number or bool that a text reads as; all else as it is.
fn literal(value: XacroValue) -> XacroValue {
    if let XacroValue::Text(text) = &value { XacroValue::literal(text) } else { value }
}

/// Names as the first scopes have them.
struct ScopeNames<'e, 'o> {
    expander: &'e mut Expander<'o>,
    depth: usize,
}

impl XacroNames for ScopeNames<'_, '_> {
    fn value(&mut self, name: &str) -> Reasoned<Option<XacroValue>> {
        for scope in (0..self.depth).rev() {
            let Some(property) = self.expander.scopes[scope].properties.get_mut(name) else {
                continue;
            };
            match core::mem::replace(property, Property::Open) {
                Property::Value(value) => {
                    *property = Property::Value(value.clone());
                    self.expander.count(value.size() / 16)?;
                    return Ok(Some(value));
                }
                Property::Open => return Err(reason!("the property \"{name}\" needs itself")),
                Property::Text(text) => {
                    self.expander.open += 1;
                    if self.expander.open > OPEN_MAX {
                        return Err(reason!("more than {OPEN_MAX} properties need each other"));
                    }
                    let value = self.expander.evaluated(&text, scope + 1);
                    let value =
                        literal(value.map_err(|why| reason!("property \"{name}\": {why}"))?);
                    self.expander.open -= 1;
                    let properties = &mut self.expander.scopes[scope].properties;
                    properties.insert(name.to_owned(), Property::Value(value.clone()));
                    return Ok(Some(value));
                }
            }
        }
        Ok(None)
    }

    fn argument(&mut self, name: &str) -> Option<String> {
        self.expander.arguments.get(name).cloned()
    }

    fn yaml(&mut self, file: &str) -> Reasoned<XacroValue> {
        let folder =
            Path::new(&*self.expander.here.file).parent().unwrap_or(Path::new("")).to_owned();
        let path = folder.join(file);
        let files = &self.expander.options.files;
        let text = read_text(files, &path).map_err(|why| why.to_string())?;
        self.expander.files.push(path.clone());
        yaml::read(&text).map_err(|why| reason!("{}: {why}", path.display()))
    }

    fn step(&mut self) -> Reasoned<()> {
        self.expander.count(1)
    }
}
