//! Lengths of functions and files, and errors that are only a text.

use syn::spanned::Spanned;
use syn::visit::{self, Visit};
use syn::{
    Block, Expr, ExprBinary, ExprMethodCall, GenericArgument, ImplItemFn, Item, ItemFn, Path,
    PathArguments, PathSegment, Signature, TraitItemFn, Type,
};

use super::tree::{ModuleTree, is_test};

/// Lines of a function, from its signature to its last brace.
const LINES_MAX: usize = 80;

/// Lines of the median file of all crates.
const MEDIAN_MAX: usize = 130;

/// Functions that are longer than one can see at once.
pub(super) fn long_functions(tree: &ModuleTree) -> Vec<String> {
    let read = |(file, _): &(String, ModuleFigures)| !written_by_a_program(file);
    let longer = gathered(tree).into_iter().filter(read).filter_map(|(file, measured)| {
        let places: Vec<String> =
            measured.long.iter().map(|(name, n)| format!("{file}: {name}, {n} lines")).collect();
        (!places.is_empty()).then_some(places)
    });
    longer.flatten().collect()
}

/// Returns true for a file that nobody reads from end to end: one of the dynamics written out, which a test
/// compares with its source.
fn written_by_a_program(file: &str) -> bool {
    file.starts_with("straight/") && !file.ends_with("mod.rs")
}

/// Places where an error is a `String`: nobody can tell its kind but by reading it.
pub(super) fn errors_of_text(tree: &ModuleTree) -> Vec<String> {
    places(tree, |measured| measured.texts)
}

/// Places where a condition has a `let` among others (Rust 1.88): the core compiles with an older compiler.
pub(super) fn let_chains(tree: &ModuleTree) -> Vec<String> {
    places(tree, |measured| measured.chains)
}

/// Functions that the standard library takes from the machine, whose last bits are another's elsewhere. Methods `exp`
/// and `sin_cos` are this project's own vectors', too.
const OF_THE_MACHINE: [&str; 15] = [
    "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "exp_m1", "ln", "ln_1p", "log10", "log2",
    "powf", "cbrt", "hypot",
];

/// Places where a function of the machine's library is used.
pub(super) fn of_the_machine(tree: &ModuleTree) -> Vec<String> {
    places(tree, |measured| measured.of_the_machine)
}

/// File and line of each place that a module's figures list.
fn places(tree: &ModuleTree, of: impl Fn(ModuleFigures) -> Vec<usize>) -> Vec<String> {
    let all = gathered(tree).into_iter();
    all.flat_map(|(file, measured)| {
        of(measured).into_iter().map(move |line| format!("{file}:{line}"))
    })
    .collect()
}

/// Lines of each file.
pub(super) fn lines(tree: &ModuleTree) -> impl Iterator<Item = usize> {
    tree.files.values().map(|file| file.lines)
}

/// Message if half of the files are longer than what reads well.
pub(super) fn median(mut lines: Vec<usize>) -> Option<String> {
    lines.sort_unstable();
    let median = lines.get(lines.len() / 2).copied().unwrap_or(0);
    (median > MEDIAN_MAX)
        .then(|| format!("the median file has {median} lines, at most {MEDIAN_MAX}"))
}

/// Figures of a module's code.
#[derive(Default)]
struct ModuleFigures {
    long: Vec<(String, usize)>,
    texts: Vec<usize>,
    chains: Vec<usize>,
    of_the_machine: Vec<usize>,
}

fn gathered(tree: &ModuleTree) -> Vec<(String, ModuleFigures)> {
    let each = tree.modules.values().map(|module| {
        let mut measured = ModuleFigures::default();
        for item in module.items.iter().filter(|item| !matches!(item, Item::Mod(_))) {
            measured.visit_item(item);
        }
        (module.file.clone(), measured)
    });
    each.collect()
}

impl ModuleFigures {
    fn function(&mut self, signature: &Signature, block: &Block) {
        let first = signature.span().start().line;
        let lines = block.span().end().line + 1 - first;
        if lines > LINES_MAX {
            self.long.push((signature.ident.to_string(), lines));
        }
    }
}

impl<'ast> Visit<'ast> for ModuleFigures {
    fn visit_item_fn(&mut self, item: &'ast ItemFn) {
        self.function(&item.sig, &item.block);
        visit::visit_item_fn(self, item);
    }

    fn visit_impl_item_fn(&mut self, item: &'ast ImplItemFn) {
        if item.attrs.iter().any(is_test) {
            return;
        }
        self.function(&item.sig, &item.block);
        visit::visit_impl_item_fn(self, item);
    }

    fn visit_trait_item_fn(&mut self, item: &'ast TraitItemFn) {
        if let Some(block) = &item.default {
            self.function(&item.sig, block);
        }
        visit::visit_trait_item_fn(self, item);
    }

    fn visit_expr_binary(&mut self, condition: &'ast ExprBinary) {
        let sides = [&*condition.left, &*condition.right];
        if sides.iter().any(|side| matches!(side, Expr::Let(_))) {
            self.chains.push(condition.span().start().line);
        }
        visit::visit_expr_binary(self, condition);
    }

    fn visit_expr_method_call(&mut self, call: &'ast ExprMethodCall) {
        if OF_THE_MACHINE.iter().any(|name| call.method == name) {
            self.of_the_machine.push(call.method.span().start().line);
        }
        visit::visit_expr_method_call(self, call);
    }

    fn visit_path(&mut self, path: &'ast Path) {
        if let Some([number, function]) = path.segments.iter().collect::<Vec<_>>().get(..)
            && number.ident == "f64"
            && OF_THE_MACHINE.iter().chain(&["exp", "sin_cos"]).any(|name| function.ident == name)
        {
            self.of_the_machine.push(function.ident.span().start().line);
        }
        visit::visit_path(self, path);
    }

    fn visit_path_segment(&mut self, segment: &'ast PathSegment) {
        if segment.ident == "Result"
            && let PathArguments::AngleBracketed(list) = &segment.arguments
            && let Some(GenericArgument::Type(Type::Path(error))) = list.args.iter().nth(1)
            && error.path.is_ident("String")
        {
            self.texts.push(segment.ident.span().start().line);
        }
        visit::visit_path_segment(self, segment);
    }
}

#[cfg(test)]
mod tests {
    use super::super::tree::ModuleTree;
    use super::{errors_of_text, let_chains, lines, long_functions, median, of_the_machine};

    fn alone(text: &str) -> ModuleTree {
        ModuleTree::read("lib.rs", &|name| (name == "lib.rs").then(|| text.to_owned())).unwrap()
    }

    #[test]
    fn long_functions_are_found_and_tests_left_out() {
        let long = |lines: usize| format!("fn f() {{\n{}}}\n", "g();\n".repeat(lines - 2));
        assert!(long_functions(&alone(&long(80))).is_empty());
        assert_eq!(long_functions(&alone(&long(81))), ["lib.rs: f, 81 lines"]);
        let inside = format!("impl A {{ {} }} trait B {{ {} }}", long(82), long(83));
        assert_eq!(long_functions(&alone(&inside)).len(), 2);
        let test = format!("#[cfg(test)] mod tests {{ {} }} #[test] {}", long(90), long(90));
        assert!(long_functions(&alone(&test)).is_empty());
    }

    #[test]
    fn errors_of_text_are_counted() {
        let text = "fn a() -> Result<u8, String> {}\nfn b(x: Option<Result<(), String>>) {}\nfn c() -> Result<String, \
            E> {}";
        assert_eq!(errors_of_text(&alone(text)), ["lib.rs:1", "lib.rs:2"]);
    }

    #[test]
    fn conditions_with_a_let_among_others_are_told() {
        let text = "fn a() {\n if let A = b { if c && d {} }\n if c && let A = b {}\n if let A = b && c {}\n while c \
            && let A = b && d {}\n}";
        assert_eq!(let_chains(&alone(text)), ["lib.rs:3", "lib.rs:4", "lib.rs:5"]);
    }

    #[test]
    fn functions_of_the_machine_are_told_but_in_tests() {
        let text = "fn a() {\n x.sin(); libm::sin(x);\n (x + 1.0)\n .powf(y); x.sqrt();\n all.map(f64::exp);\n}\n\
                    #[test] fn b() { x.ln(); }";
        assert_eq!(of_the_machine(&alone(text)), ["lib.rs:2", "lib.rs:4", "lib.rs:5"]);
    }

    #[test]
    fn the_median_file_is_told_where_it_is_long() {
        let three = |middle: usize| {
            [1, middle, 900].map(|n| alone(&"\n".repeat(n))).iter().flat_map(lines).collect()
        };
        assert_eq!(median(three(130)), None);
        assert!(median(three(131)).is_some());
    }
}
