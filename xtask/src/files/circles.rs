//! No two files of a crate use each other, not even around the corner.

use std::collections::{BTreeMap, BTreeSet};

use super::tree::ModuleTree;
use super::uses::{Arrows, arrows};

/// Number of files on circles, and the names that tie each circle.
pub(super) fn told(tree: &ModuleTree) -> (usize, Vec<String>) {
    let arrows = arrows(tree);
    let found = circles(&arrows);
    let mut lines = Vec::new();
    for circle in &found {
        lines.push(format!("circle of {}:", circle.len()));
        for from in circle {
            for (to, names) in arrows.get(from).into_iter().flatten() {
                if circle.contains(to) {
                    let names: Vec<_> = names.iter().map(String::as_str).collect();
                    lines.push(format!("  {from} uses {to}: {}", names.join(", ")));
                }
            }
        }
    }
    (found.iter().map(BTreeSet::len).sum(), lines)
}

/// The sets of files that reach each other.
fn circles(arrows: &Arrows) -> Vec<BTreeSet<String>> {
    let reached: BTreeMap<&String, BTreeSet<&String>> =
        arrows.keys().map(|from| (from, reach(arrows, from))).collect();
    let mut found: Vec<BTreeSet<String>> = Vec::new();
    for (from, to) in &reached {
        let known = found.iter().any(|circle| circle.contains(*from));
        if to.contains(from) && !known {
            let back = |other: &&&String| reached.get(**other).is_some_and(|r| r.contains(from));
            found.push(to.iter().filter(back).map(|file| (*file).clone()).collect());
        }
    }
    found
}

/// Files that a file uses, directly or through others.
fn reach<'a>(arrows: &'a Arrows, from: &String) -> BTreeSet<&'a String> {
    let mut found = BTreeSet::new();
    let mut open: Vec<&String> = arrows.get(from).into_iter().flat_map(BTreeMap::keys).collect();
    while let Some(file) = open.pop() {
        if found.insert(file) {
            open.extend(arrows.get(file).into_iter().flat_map(BTreeMap::keys));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::tree::ModuleTree;
    use super::told;

    /// Files on circles of a crate made of these.
    fn count(files: &[(&str, &str)]) -> usize {
        let read = |name: &str| {
            files.iter().find(|(file, _)| *file == name).map(|(_, text)| (*text).to_owned())
        };
        told(&ModuleTree::read("lib.rs", &read).unwrap()).0
    }

    const LIB: (&str, &str) = ("lib.rs", "mod a; mod b; pub use a::A; pub use b::B;");

    #[test]
    fn two_files_that_use_each_other_are_a_circle_however_they_say_it() {
        let a = ("a.rs", "use crate::B; pub struct A(B);");
        for b in [
            "pub struct B; use crate::a::A;",
            "pub struct B; fn f() { crate::a::A::new() }",
            "pub struct B; fn f() { super::A::new() }",
            "pub struct B; fn f() { println!(\"{}\", crate::A::new()) }",
            "pub struct B; use super::a; fn f(_: &a::A) {}",
            "pub struct B; use crate::a::*;",
            "pub struct B; fn f() { use crate::a::A as Other; }",
        ] {
            assert_eq!(count(&[LIB, a, ("b.rs", b)]), 2, "{b}");
        }
    }

    #[test]
    fn one_way_tests_comments_and_what_is_passed_on_are_none() {
        let a = ("a.rs", "use crate::B; pub struct A(B);");
        for b in [
            "pub struct B;",
            "/// As [`crate::a::A`].\npub struct B; #[cfg(test)] mod tests { use crate::a::A; }",
            "pub struct B; impl B { #[cfg(test)] fn f() { crate::a::A } }",
            "pub struct B; use elsewhere::A;",
        ] {
            assert_eq!(count(&[LIB, a, ("b.rs", b)]), 0, "{b}");
        }
    }

    #[test]
    fn a_child_that_takes_what_its_parent_defines_and_uses_it_closes_a_circle() {
        let child = ("a/c.rs", "use super::A; pub fn of(a: &A) {}");
        let lib = ("lib.rs", "mod a;");
        let uses = ("a/mod.rs", "mod c; pub struct A; fn f() { c::of(&A) }");
        assert_eq!(count(&[lib, uses, child]), 2);
        let passes_on = ("a/mod.rs", "mod c; pub use c::of; pub struct A;");
        assert_eq!(count(&[lib, passes_on, child]), 0);
    }

    #[test]
    fn three_files_around_a_corner_are_a_circle() {
        let lib = ("lib.rs", "mod a; mod b; mod c; mod d;");
        let file = |name, next: &'static str| (name, next);
        let ring = [
            lib,
            file("a.rs", "use crate::b::B; pub struct A;"),
            file("b.rs", "use crate::c::C; pub struct B;"),
            file("c.rs", "use crate::a::A; pub struct C;"),
            file("d.rs", "use crate::a::A;"),
        ];
        assert_eq!(count(&ring), 3);
    }
}
