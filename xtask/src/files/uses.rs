//! Uses between the files of a crate: from a file to those that define what it uses.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{TokenStream, TokenTree};
use syn::visit::{self, Visit};
use syn::{ImplItem, Item, Macro, Path};

use super::names::{Names, imports};
use super::tree::{ModuleTree, is_test};

/// From a file to those that it uses, and one name for each.
pub(super) type Arrows = BTreeMap<String, BTreeMap<String, BTreeSet<String>>>;

/// Every arrow between two files of a crate.
///
/// A name that a module only passes on (`pub use`) is no arrow; a use of it there counts as one of the file
/// that defines it.
pub(super) fn arrows(tree: &ModuleTree) -> Arrows {
    let names = Names::new(tree);
    let mut arrows = Arrows::new();
    for (module, content) in &tree.modules {
        let mut seen = UsedFiles { module, names: &names, found: BTreeMap::new() };
        for item in &content.items {
            match item {
                Item::Use(_) => {
                    for import in imports(item).iter().filter(|import| !import.passed_on) {
                        let file = if import.whole() { Names::whole } else { Names::file };
                        seen.add(file(&names, module, &import.path), &import.path);
                    }
                }
                Item::Mod(_) => {}
                _ => seen.visit_item(item),
            }
        }
        seen.found.remove(&content.file);
        let from = arrows.entry(content.file.clone()).or_default();
        for (file, used) in seen.found {
            from.entry(file).or_default().extend(used);
        }
    }
    arrows
}

/// Targets of the paths in a module's code.
struct UsedFiles<'a> {
    module: &'a [String],
    names: &'a Names<'a>,
    found: BTreeMap<String, BTreeSet<String>>,
}

impl UsedFiles<'_> {
    fn add(&mut self, file: Option<String>, path: &[String]) {
        if let Some(file) = file {
            self.found.entry(file).or_default().extend(path.last().cloned());
        }
    }

    fn path(&mut self, path: &[String]) {
        self.add(self.names.file(self.module, path), path);
    }

    /// Paths in what a macro is given.
    fn tokens(&mut self, tokens: TokenStream) {
        let mut path: Vec<String> = Vec::new();
        let mut colons = 0;
        for token in tokens {
            match token {
                TokenTree::Ident(ident) => {
                    if colons != 2 {
                        self.path(&std::mem::take(&mut path));
                    }
                    path.push(ident.to_string());
                    colons = 0;
                }
                TokenTree::Punct(mark) if mark.as_char() == ':' => colons += 1,
                other => {
                    self.path(&std::mem::take(&mut path));
                    colons = 0;
                    if let TokenTree::Group(group) = other {
                        self.tokens(group.stream());
                    }
                }
            }
        }
        self.path(&path);
    }
}

impl<'ast> Visit<'ast> for UsedFiles<'_> {
    fn visit_path(&mut self, path: &'ast Path) {
        let segments: Vec<String> = path.segments.iter().map(|s| s.ident.to_string()).collect();
        if path.leading_colon.is_none() {
            self.path(&segments);
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, called: &'ast Macro) {
        visit::visit_macro(self, called);
        self.tokens(called.tokens.clone());
    }

    fn visit_impl_item(&mut self, item: &'ast ImplItem) {
        let attributes = match item {
            ImplItem::Fn(i) => &i.attrs[..],
            ImplItem::Const(i) => &i.attrs,
            _ => &[],
        };
        if !attributes.iter().any(is_test) {
            visit::visit_impl_item(self, item);
        }
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        // A `use` inside a function.
        for import in imports(&Item::Use(item.clone())) {
            let file = if import.whole() { Names::whole } else { Names::file };
            self.add(file(self.names, self.module, &import.path), &import.path);
        }
    }
}
