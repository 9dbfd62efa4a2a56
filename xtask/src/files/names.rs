//! Meaning of a name in a module: a module, or something that a file defines.

use std::collections::BTreeMap;

use syn::{Item, UseTree, Visibility};

use super::tree::ModuleTree;

/// The names of a crate's modules.
pub(super) struct Names<'a> {
    tree: &'a ModuleTree,
    scopes: BTreeMap<&'a [String], ModuleScope>,
}

/// The names of one module.
#[derive(Default)]
struct ModuleScope {
    defined: Vec<String>,
    imports: Vec<Import>,
}

/// One name, or all of them, that a `use` brings.
pub(super) struct Import {
    pub(super) path: Vec<String>,
    /// The name that it has here; none for `*`.
    name: Option<String>,
    /// True if others may see it: it is passed on.
    pub(super) passed_on: bool,
}

/// Target of a path.
enum Found {
    Module(Vec<String>),
    File(String),
}

impl<'a> Names<'a> {
    pub(super) fn new(tree: &'a ModuleTree) -> Self {
        let scope = |items: &[Item]| {
            let mut scope = ModuleScope::default();
            for item in items {
                match item {
                    Item::Use(_) => scope.imports.extend(imports(item)),
                    Item::Macro(i) => {
                        scope.defined.extend(i.ident.as_ref().map(ToString::to_string));
                    }
                    _ => scope.defined.extend(defined(item)),
                }
            }
            scope
        };
        let scopes = tree.modules.iter().map(|(path, module)| (&path[..], scope(&module.items)));
        Self { tree, scopes: scopes.collect() }
    }

    /// The file that defines what a path names, seen from a module; none where it is of another crate, or a module.
    pub(super) fn file(&self, from: &[String], path: &[String]) -> Option<String> {
        match self.find(from, path, 0)? {
            Found::File(file) => Some(file),
            Found::Module(_) => None,
        }
    }

    /// The file of a module whose names are all taken, where it defines any.
    pub(super) fn whole(&self, from: &[String], path: &[String]) -> Option<String> {
        match self.find(from, path, 0)? {
            Found::Module(at) if self.scopes.get(&at[..])?.defined.is_empty() => None,
            Found::Module(at) => Some(self.tree.modules.get(&at)?.file.clone()),
            Found::File(file) => Some(file),
        }
    }

    fn find(&self, from: &[String], path: &[String], depth: usize) -> Option<Found> {
        // A `use` of a name by itself, in a circle of `use`s.
        if depth > 20 {
            return None;
        }
        let (first, rest) = path.split_first()?;
        let start = match first.as_str() {
            "crate" => Found::Module(Vec::new()),
            "self" => Found::Module(from.to_vec()),
            "super" => Found::Module(from.split_last()?.1.to_vec()),
            name => self.member(from, name, depth)?,
        };
        rest.iter().try_fold(start, |at, name| match at {
            Found::Module(module) if name == "super" => {
                Some(Found::Module(module.split_last()?.1.to_vec()))
            }
            Found::Module(module) => self.member(&module, name, depth),
            // A variant, an associated function.
            Found::File(file) => Some(Found::File(file)),
        })
    }

    /// Target of a name in a module.
    fn member(&self, module: &[String], name: &str, depth: usize) -> Option<Found> {
        let child: Vec<String> = module.iter().cloned().chain([name.to_owned()]).collect();
        if self.scopes.contains_key(&child[..]) {
            return Some(Found::Module(child));
        }
        let scope = self.scopes.get(module)?;
        if scope.defined.iter().any(|defined| defined == name) {
            return Some(Found::File(self.tree.modules.get(module)?.file.clone()));
        }
        let named = scope.imports.iter().find(|import| import.name.as_deref() == Some(name));
        if let Some(import) = named {
            return self.find(module, outside(&import.path, name), depth + 1);
        }
        let mut globs = scope.imports.iter().filter(|import| import.name.is_none());
        globs.find_map(|glob| {
            let path: Vec<String> = glob.path.iter().cloned().chain([name.to_owned()]).collect();
            self.find(module, outside(&path, name), depth + 1)
        })
    }
}

/// `use name;` of a crate of that name leads nowhere here.
fn outside<'p>(path: &'p [String], name: &str) -> &'p [String] {
    if path.first().is_some_and(|first| first == name) { &[] } else { path }
}

/// The name that an item defines.
fn defined(item: &Item) -> Option<String> {
    let ident = match item {
        Item::Const(i) => &i.ident,
        Item::Enum(i) => &i.ident,
        Item::Fn(i) => &i.sig.ident,
        Item::Static(i) => &i.ident,
        Item::Struct(i) => &i.ident,
        Item::Trait(i) => &i.ident,
        Item::Type(i) => &i.ident,
        Item::Union(i) => &i.ident,
        _ => return None,
    };
    Some(ident.to_string())
}

/// Imports of a `use`.
pub(super) fn imports(item: &Item) -> Vec<Import> {
    let Item::Use(item) = item else { return Vec::new() };
    let mut found = Vec::new();
    let passed_on = !matches!(item.vis, Visibility::Inherited);
    gather(&item.tree, &mut Vec::new(), passed_on, &mut found);
    found
}

fn gather(tree: &UseTree, path: &mut Vec<String>, passed_on: bool, found: &mut Vec<Import>) {
    let mut take = |path: &[String], last: Option<String>, name: Option<String>| {
        // `{self}` is the module itself.
        let last = last.filter(|last| last != "self" || path.is_empty());
        let name = if last.is_none() && name.as_deref() == Some("self") {
            path.last().cloned()
        } else {
            name
        };
        let path = path.iter().cloned().chain(last).collect();
        found.push(Import { path, name, passed_on });
    };
    match tree {
        UseTree::Path(inner) => {
            path.push(inner.ident.to_string());
            gather(&inner.tree, path, passed_on, found);
            path.pop();
        }
        UseTree::Group(group) => {
            group.items.iter().for_each(|inner| gather(inner, path, passed_on, found));
        }
        UseTree::Name(name) => {
            take(path, Some(name.ident.to_string()), Some(name.ident.to_string()));
        }
        UseTree::Rename(name) => {
            take(path, Some(name.ident.to_string()), Some(name.rename.to_string()));
        }
        UseTree::Glob(_) => take(path, None, None),
    }
}

impl Import {
    /// Returns true if it takes all that a module has.
    pub(super) fn whole(&self) -> bool {
        self.name.is_none()
    }
}
