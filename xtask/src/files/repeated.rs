//! Names of types that stand for more than one thing.

use std::collections::BTreeMap;

use syn::Item;

use super::tree::ModuleTree;

/// Most names of types that are defined more than once, tests left out; it may only fall. Types of the Python package
/// have the names of those that they wrap, and alternatives of one `cfg` share theirs.
const REPEATED_MAX: usize = 43;

/// Names of the types that each crate defines, each with its file.
pub(super) fn types<'t>(crate_name: &str, tree: &'t ModuleTree) -> Vec<(String, String)> {
    let named = |item: &'t Item| match item {
        Item::Enum(i) => Some(&i.ident),
        Item::Struct(i) => Some(&i.ident),
        Item::Trait(i) => Some(&i.ident),
        Item::Type(i) => Some(&i.ident),
        Item::Union(i) => Some(&i.ident),
        _ => None,
    };
    let modules = tree.modules.values();
    let all = modules.flat_map(|module| module.items.iter().map(move |item| (module, item)));
    all.filter_map(|(module, item)| Some((named(item)?.to_string(), &module.file)))
        .map(|(name, file)| (name, format!("{crate_name}/{file}")))
        .collect()
}

/// Message if more names are defined more than once than there were.
pub(super) fn wrong(all: Vec<(String, String)>) -> Option<String> {
    let repeated = repeated(all);
    (repeated.len() > REPEATED_MAX).then(|| {
        format!(
            "{} names of types are defined more than once, where {REPEATED_MAX} were: say which one it is\n  {}",
            repeated.len(),
            repeated.join("\n  ")
        )
    })
}

/// A line for each name that is defined more than once.
fn repeated(all: Vec<(String, String)>) -> Vec<String> {
    let mut places: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for (name, file) in all {
        places.entry(name).or_default().push(file);
    }
    let more = places.into_iter().filter(|(_, files)| files.len() > 1);
    more.map(|(name, files)| format!("{name}: {}", files.join(", "))).collect()
}

#[cfg(test)]
mod tests {
    use super::super::tree::ModuleTree;
    use super::{repeated, types};

    #[test]
    fn names_in_two_modules_or_crates_are_counted_and_tests_are_not() {
        let text = "struct A; mod inner { enum A {} struct B; fn f() { struct A; } }\n\
                    #[cfg(test)] mod tests { struct B; struct C; } trait C { type B; }";
        let one = ModuleTree::read("lib.rs", &|name| (name == "lib.rs").then(|| text.to_owned()))
            .unwrap();
        let alone = types("one", &one);
        assert_eq!(repeated(alone.clone()), ["A: one/lib.rs, one/lib.rs"]);
        let both = alone.into_iter().chain([("C".to_owned(), "two/lib.rs".to_owned())]).collect();
        assert_eq!(repeated(both).len(), 2);
    }
}
