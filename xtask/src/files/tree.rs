//! The modules of a crate as its `mod` lines give them, each with its file; tests left out.

use std::collections::BTreeMap;

use syn::{Attribute, Item};

/// A crate: its files, parsed, and its modules by their path, the root's being empty.
pub(super) struct ModuleTree {
    pub(super) files: BTreeMap<String, File>,
    pub(super) modules: BTreeMap<Vec<String>, Module>,
}

/// A file of a crate.
pub(super) struct File {
    pub(super) lines: usize,
    /// Those that are neither blank, nor a comment, nor of the tests at the end.
    pub(super) code: usize,
}

/// A module: the file that it is in, and what stands in it.
pub(super) struct Module {
    pub(super) file: String,
    pub(super) items: Vec<Item>,
}

impl ModuleTree {
    /// Reads a crate from the file of its root; `read` gives the text of a file of the source folder.
    pub(super) fn read(root: &str, read: &dyn Fn(&str) -> Option<String>) -> Result<Self, String> {
        let mut tree = Self { files: BTreeMap::new(), modules: BTreeMap::new() };
        tree.file(root, "", Vec::new(), read)?;
        Ok(tree)
    }

    /// Takes a file up, and those of its modules; they lie in `folder`, which ends with a stroke or is empty.
    fn file(
        &mut self,
        name: &str,
        folder: &str,
        path: Vec<String>,
        read: &dyn Fn(&str) -> Option<String>,
    ) -> Result<(), String> {
        let text = read(name).ok_or_else(|| format!("{name} cannot be read"))?;
        let parsed = syn::parse_file(&text).map_err(|e| format!("{name}: {e}"))?;
        self.files.insert(name.to_owned(), File { lines: text.lines().count(), code: code(&text) });
        self.module(name, folder, path, parsed.items, read)
    }

    fn module(
        &mut self,
        file: &str,
        folder: &str,
        path: Vec<String>,
        items: Vec<Item>,
        read: &dyn Fn(&str) -> Option<String>,
    ) -> Result<(), String> {
        let mut kept = Vec::new();
        for mut item in items {
            if attributes(&item).iter().any(is_test) {
                continue;
            }
            if let Item::Mod(child) = &mut item {
                let name = child.ident.to_string();
                let path: Vec<String> = path.iter().cloned().chain([name.clone()]).collect();
                let inside = format!("{folder}{name}/");
                if let Some((_, items)) = child.content.take() {
                    self.module(file, &inside, path, items, read)?;
                } else {
                    let places = [format!("{folder}{name}.rs"), format!("{inside}mod.rs")];
                    let Some(place) = places.iter().find(|place| read(place).is_some()) else {
                        return Err(format!("{file}: no file of mod {name}"));
                    };
                    self.file(place, &inside, path, read)?;
                }
            }
            kept.push(item);
        }
        self.modules.insert(path, Module { file: file.to_owned(), items: kept });
        Ok(())
    }
}

/// Lines of code before the tests of a file.
fn code(text: &str) -> usize {
    let lines = text.lines().map(str::trim).take_while(|line| *line != "#[cfg(test)]");
    lines.filter(|line| !line.is_empty() && !line.starts_with("//")).count()
}

/// Returns true if the attribute is `cfg(test)` or `test`, alone or among others.
pub(super) fn is_test(attribute: &Attribute) -> bool {
    if attribute.path().is_ident("test") {
        return true;
    }
    let Ok(list) = attribute.meta.require_list() else { return false };
    let tokens = list.tokens.to_string();
    list.path.is_ident("cfg")
        && !tokens.starts_with("not")
        && tokens.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == "test")
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(i) => &i.attrs,
        Item::Enum(i) => &i.attrs,
        Item::Fn(i) => &i.attrs,
        Item::Impl(i) => &i.attrs,
        Item::Macro(i) => &i.attrs,
        Item::Mod(i) => &i.attrs,
        Item::Static(i) => &i.attrs,
        Item::Struct(i) => &i.attrs,
        Item::Trait(i) => &i.attrs,
        Item::Type(i) => &i.attrs,
        Item::Union(i) => &i.attrs,
        Item::Use(i) => &i.attrs,
        _ => &[],
    }
}
