//! A page that was made by an earlier version, in the present style.

use crate::policy::{PAGE_STYLE, style_source};

/// A page of [`Page`](super::Page) with the present style sheet and the kind by which the sheet knows it; body, data and
/// scripts stay as they are. `None`: the text is no such page.
///
/// A page whose data were not kept can be dressed again; one whose data are kept is better made again.
pub fn dressed(page: &str, kind: &str) -> Option<String> {
    let page = between(page, "style-src ", ";", &style_source(PAGE_STYLE))?;
    let page = between(&page, "<style>", "</style>", PAGE_STYLE)?;
    let (before, rest) = page.split_once("<main")?;
    let (_, after) = rest.split_once('>')?;
    Some(format!("{before}<main class=\"{kind}\">{after}"))
}

/// The text with something else between the first `open` and the `close` after it.
fn between(text: &str, open: &str, close: &str, new: &str) -> Option<String> {
    let (before, rest) = text.split_once(open)?;
    let (_, after) = rest.split_once(close)?;
    Some(format!("{before}{open}{new}{close}{after}"))
}

#[cfg(test)]
mod tests {
    use super::dressed;
    use crate::kit::Page;
    use maud::html;

    #[test]
    fn a_page_in_an_old_style_becomes_the_page_in_the_present_one() {
        let page = Page { title: "a page", kind: "faults", script: Some("let a = 1;") };
        let now = page.document(&html! { h1 { "a page" } });
        let old = super::between(&now, "<style>", "</style>", "main { color: red; }").unwrap();
        let old = super::between(&old, "style-src ", ";", "'sha256-old'").unwrap();
        let old = old.replace("<main class=\"faults\">", "<main>");
        assert_ne!(old, now);
        assert_eq!(dressed(&old, "faults").as_deref(), Some(&*now));
        assert_eq!(dressed("<p>no page</p>", "faults"), None);
    }
}
