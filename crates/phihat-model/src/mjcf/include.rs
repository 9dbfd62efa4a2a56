//! A file with those that it includes.

use std::path::{Component, Path, PathBuf};
use std::rc::Rc;

use roxmltree::Document;

use super::attributes::wrong;
use crate::error::RobotError;
use crate::markup::{MarkupElement, MarkupPart};
use crate::named_texts::{NamedFile, NamedTexts};
use crate::robot_text::read_text;
use crate::urdf::readable;
use crate::whole::Result;

/// Name of the root element.
pub(crate) const ROOT: &str = "mujoco";

/// Most files that are included, most bytes of them, and most elements of all.
const FILES_MAX: usize = 200;
const INCLUDED_BYTES_MAX: usize = 32 << 20;
const ELEMENTS_MAX: usize = 100_000;

/// Most elements inside each other, those of included files among them.
const LEVELS_MAX: usize = 100;

/// The root element, with what it includes in its place, and the files that it includes.
pub(super) fn included(
    document: &Document<'_>,
    path: Option<NamedFile<'_>>,
    origin: &str,
) -> Result<(MarkupElement, Vec<PathBuf>)> {
    let source = path.map_or(&NamedTexts::DISK, |(source, _)| source);
    let main = path.map(|(_, path)| path.parent().unwrap_or(Path::new("")));
    let mut own = Included { source, main, files: Vec::new(), bytes: 0, elements: 0 };
    let root = own.spliced(MarkupElement::of(document, &Rc::from(origin)), main, 0)?;
    let mut files = own.files;
    files.sort();
    files.dedup();
    Ok((root, files))
}

/// The text of an MJCF file with what it includes in its place; `None`: it includes nothing, or is no MJCF.
pub(crate) fn flat(text: &str, (files, path): NamedFile<'_>) -> Result<Option<String>> {
    let origin = path.display().to_string();
    let text = readable(text, &origin)?;
    let Ok(document) = Document::parse(&text) else { return Ok(None) };
    let root = document.root_element();
    let includes =
        root.has_tag_name(ROOT) && root.descendants().any(|node| node.has_tag_name("include"));
    if !includes {
        return Ok(None);
    }
    let mut out = String::new();
    included(&document, Some((files, path)), &origin)?.0.write(0, &mut out);
    Ok(Some(out))
}

struct Included<'p> {
    source: &'p NamedTexts,
    /// Folder of the file that includes the others.
    main: Option<&'p Path>,
    files: Vec<PathBuf>,
    bytes: usize,
    elements: usize,
}

impl Included<'_> {
    /// An element with what it includes, from a file in `folder`.
    fn spliced(
        &mut self,
        mut element: MarkupElement,
        folder: Option<&Path>,
        level: usize,
    ) -> Result<MarkupElement> {
        let parts = std::mem::take(&mut element.parts);
        self.parts(parts, (folder, level + 1), &mut element)?;
        Ok(element)
    }

    fn parts(
        &mut self,
        parts: Vec<MarkupPart>,
        (folder, level): (Option<&Path>, usize),
        into: &mut MarkupElement,
    ) -> Result<()> {
        for part in parts {
            let MarkupPart::Element(element) = part else { continue };
            self.elements += 1;
            let many = |what, limit| RobotError::TooMuch {
                origin: element.place.file.to_string(),
                what,
                found: limit + 1,
                limit,
            };
            if level > LEVELS_MAX {
                return Err(many("elements inside each other", LEVELS_MAX));
            }
            if self.elements > ELEMENTS_MAX {
                return Err(many("elements", ELEMENTS_MAX));
            }
            if element.name == "include" {
                let (root, folder) = self.file(&element, folder)?;
                self.parts(root.parts, (Some(&folder), level + 1), into)?;
            } else {
                let element = self.spliced(element, folder, level)?;
                into.parts.push(MarkupPart::Element(element));
            }
        }
        Ok(())
    }

    /// The root of an included file, and the folder that it is in.
    fn file(
        &mut self,
        include: &MarkupElement,
        folder: Option<&Path>,
    ) -> Result<(MarkupElement, PathBuf)> {
        let Some(name) = include.attribute("file").filter(|name| !name.is_empty()) else {
            return Err(wrong(include, "it has no \"file\""));
        };
        let (Some(main), Some(folder)) = (self.main, folder) else {
            return Err(wrong(include, "a text includes no file; name the file in its place"));
        };
        // A record holds the files of an arm under the folder of the first.
        if Path::new(name)
            .components()
            .any(|part| !matches!(part, Component::Normal(_) | Component::CurDir))
        {
            let why = format!("\"{name}\" must be beside the file that is read, or below it");
            return Err(wrong(include, &why));
        }
        let path =
            [main.join(name), folder.join(name)].into_iter().find(|path| self.source.is_file(path));
        let Some(path) = path else {
            let why = format!("\"{name}\" is not there, in {}", main.display());
            return Err(wrong(include, &why));
        };
        let origin = path.display().to_string();
        let text = read_text(self.source, &path)?;
        self.bytes += text.len();
        let many = |what, limit| {
            let origin = include.place.file.to_string();
            Err(RobotError::TooMuch { origin, what, found: limit + 1, limit })
        };
        self.files.push(path.clone());
        if self.files.len() > FILES_MAX {
            return many("files", FILES_MAX);
        }
        if self.bytes > INCLUDED_BYTES_MAX {
            return many("bytes of included files", INCLUDED_BYTES_MAX);
        }
        let text = readable(&text, &origin)?;
        let document = Document::parse(&text).map_err(|error| RobotError::Xml {
            origin: origin.clone(),
            line: error.pos().row,
            why: error.to_string(),
        })?;
        let root = MarkupElement::of(&document, &Rc::from(origin));
        Ok((root, path.parent().unwrap_or(Path::new("")).to_owned()))
    }
}
