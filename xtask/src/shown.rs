//! Output that a page shows, held against what was printed, and renewed from it.

/// Placeholder for any text: alone for any lines, at the end of a line for the rest of it.
const ANYTHING: char = '…';

/// Checks that each line that is shown was printed, in this order.
pub(crate) fn in_order(shown: &str, printed: &str) -> Result<(), String> {
    let mut rest = printed.lines().map(str::trim);
    for line in shown.lines().map(str::trim).filter(|line| !blank(line)) {
        if !rest.any(|said| is(line, said)) {
            return Err(format!("not printed, or not in this order:\n{line}\nprinted:\n{printed}"));
        }
    }
    Ok(())
}

/// The lines that are shown, each as it is printed now: the next line that differs in its numbers alone takes
/// its place. A line that has no such successor stays, for [`in_order`] to complain of.
pub(crate) fn renewed(shown: &str, printed: &str) -> String {
    let printed: Vec<&str> = printed.lines().collect();
    let mut after = 0;
    let mut text = String::new();
    for line in shown.lines() {
        let rest = &printed[after..];
        let same = |alike: &dyn Fn(&str) -> bool| rest.iter().position(|said| alike(said));
        let found = if blank(line.trim()) {
            None
        } else {
            let exact = same(&|said| is(line.trim(), said.trim()));
            exact.map(|at| (at, line.to_owned())).or_else(|| {
                let at = same(&|said| is(&without_numbers(line), &without_numbers(said)))?;
                Some((at, cut_like(line, rest[at])))
            })
        };
        after += found.as_ref().map_or(0, |(at, _)| at + 1);
        text.push_str(&found.map_or_else(|| line.to_owned(), |(_, now)| now));
        text.push('\n');
    }
    text
}

fn blank(line: &str) -> bool {
    line.is_empty() || line == ANYTHING.to_string()
}

fn is(shown: &str, said: &str) -> bool {
    match shown.strip_suffix(ANYTHING) {
        Some(start) => said.starts_with(start.trim_end()),
        None => said == shown,
    }
}

/// A printed line as far as the shown one goes, which is counted in words.
fn cut_like(shown: &str, said: &str) -> String {
    let Some(start) = shown.strip_suffix(ANYTHING) else { return said.to_owned() };
    let words = start.split_whitespace().count();
    let end = said.split_whitespace().nth(words.saturating_sub(1)).map_or(said.len(), |word| {
        let start = word.as_ptr() as usize - said.as_ptr() as usize;
        start + word.len()
    });
    format!("{} {ANYTHING}", &said[..end])
}

/// A line with `#` for every number that is not part of a word, and one space for many.
fn without_numbers(line: &str) -> String {
    let mut masked = String::new();
    let mut within = ' ';
    for c in line.trim().chars() {
        let number = c.is_ascii_digit() || (c == '.' && within == '#');
        let word = within.is_alphanumeric() || within == '_';
        let said = if number && !word {
            '#'
        } else if c.is_whitespace() {
            ' '
        } else {
            c
        };
        if !(said == within && (said == '#' || said == ' ')) {
            masked.push(said);
        }
        within = said;
    }
    masked
}

#[cfg(test)]
mod tests {
    use super::{in_order, renewed};

    #[test]
    fn output_is_held_against_what_was_printed_line_by_line() {
        let printed = "a 1\nb 2\nc 3 and more\n";
        for fine in ["a 1\nb 2\n", "b 2\n…\nc 3 …\n", "a 1\nc 3 and more"] {
            assert!(in_order(fine, printed).is_ok(), "{fine}");
        }
        for not in ["b 2\na 1\n", "a", "a 1\na 1\n", "c 3"] {
            assert!(in_order(not, printed).is_err(), "{not}");
        }
    }

    #[test]
    fn numbers_are_renewed_and_nothing_else() {
        let shown = "…\n│joint1   0.43  1.0 │\n│joint2  0.21 │\nbound 3 mrad …\n  deep 1\nno longer said 7\n";
        let printed = "│joint2  9 │\n│joint1  12.43  0.9 │\n│joint2  0.22 │\nbound 4 mrad, and more\n  deep 2\n";
        let now = "…\n│joint1  12.43  0.9 │\n│joint2  0.22 │\nbound 4 mrad, …\n  deep 2\nno longer said 7\n";
        assert_eq!(renewed(shown, printed), now);
        assert_eq!(renewed(now, printed), now);
    }
}
