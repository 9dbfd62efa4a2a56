//! Key of a figure: the meaning of its colours, dashes and marks.

use maud::{Markup, html};

use super::ink::{self, CURVES, Pen};
use super::look::{FigureSize, px};
use super::map;
use crate::kit::figure::{Content, Fill, Panel};
use crate::kit::text::short;

/// Letters of a label at most.
const LABEL_MAX: usize = 84;

/// A sign and its meaning.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct KeyEntry {
    sign: KeySign,
    label: String,
}

#[derive(Debug, Clone, PartialEq)]
enum KeySign {
    Line(Pen),
    Points(Pen),
    Band(Fill),
    Class(usize),
}

/// The entries of a panel; a series without a label, or with its name at its last point, has none.
pub(super) fn entries(panel: &Panel) -> Vec<KeyEntry> {
    let entry = |sign: KeySign, label: &str| KeyEntry { sign, label: short(label, LABEL_MAX) };
    let bands = panel.bands.iter().map(|band| entry(KeySign::Band(band.fill), &band.label));
    let others: Vec<KeyEntry> = match &panel.content {
        Content::Lines { series, bounds } => {
            let curves = series.iter().enumerate().filter(|(_, curve)| !curve.named);
            let curves = curves.map(|(place, curve)| {
                let pen = ink::pen(curve.ink, place);
                let sign = if curve.marks { KeySign::Points(pen) } else { KeySign::Line(pen) };
                entry(sign, &curve.label)
            });
            let bounds = bounds
                .iter()
                .enumerate()
                .map(|(place, bound)| entry(KeySign::Line(ink::bound(place)), &bound.label));
            curves.take(CURVES).chain(bounds).collect()
        }
        Content::Map { classes, .. } => {
            let named = classes.iter().take(map::CLASSES_MAX).enumerate();
            named.map(|(place, class)| entry(KeySign::Class(place), class)).collect()
        }
    };
    others.into_iter().chain(bands).filter(|entry| !entry.label.is_empty()).collect()
}

/// One key for all panels, where no sign has two meanings.
pub(super) fn shared(panels: &[Panel]) -> Option<Vec<KeyEntry>> {
    let mut all: Vec<KeyEntry> = Vec::new();
    for entry in panels.iter().flat_map(entries) {
        match all.iter().find(|other| other.sign == entry.sign) {
            Some(other) if other.label != entry.label => return None,
            Some(_) => {}
            None => all.push(entry),
        }
    }
    Some(all)
}

/// Room for a sign, and between entries, in heights of letters.
const SIGN: f64 = 3.6;
const GAP: f64 = 1.6;

/// Entries in rows of a width.
pub(super) fn rows(entries: Vec<KeyEntry>, width: f64, look: &FigureSize) -> Vec<Vec<KeyEntry>> {
    let mut rows: Vec<Vec<KeyEntry>> = Vec::new();
    let mut used = 0.0;
    for mut entry in entries {
        entry.label = short(&entry.label, look.letters(width - SIGN * look.text));
        let wide = entry.width(look);
        match rows.last_mut() {
            Some(row) if used + GAP * look.text + wide <= width => {
                used += GAP * look.text + wide;
                row.push(entry);
            }
            _ => {
                used = wide;
                rows.push(vec![entry]);
            }
        }
    }
    rows
}

impl KeyEntry {
    fn width(&self, look: &FigureSize) -> f64 {
        SIGN * look.text + look.wide(self.label.chars().count())
    }
}

/// Rows of a key from a place on, and the patterns' figure.
pub(super) fn draw(
    rows: &[Vec<KeyEntry>],
    [left, top]: [f64; 2],
    look: &FigureSize,
    figure: &str,
) -> Markup {
    let text = look.text;
    html! { @for (row, y) in rows.iter().zip((0..).map(|k| top + f64::from(k) * look.line())) {
        @let widths = row.iter().scan(left, |x, entry| {
            let own = *x;
            *x += entry.width(look) + GAP * text;
            Some(own)
        });
        @for (entry, x) in row.iter().zip(widths) {
            (sign(&entry.sign, [x, y + 0.5 * look.line()], look, figure))
            text x=(px(x + 3.2 * text)) y=(px(y + 0.5 * look.line() + 0.36 * text)) { (entry.label) }
        }
    } }
}

fn sign(sign: &KeySign, [x, y]: [f64; 2], look: &FigureSize, figure: &str) -> Markup {
    let (long, half) = (2.8 * look.text, 0.55 * look.text);
    match sign {
        KeySign::Line(pen) => html! {
            path class=(pen.class[0]) d=(format!("M{} {}h{}", px(x), px(y), px(long))) fill="none" stroke=(pen.colour)
                stroke-width=(pen.width) stroke-dasharray=[dashes(pen)] {}
        },
        KeySign::Points(pen) => {
            let at = [x + 0.5 * long, y];
            html! { path class=(pen.class[1]) d=(ink::key_shape(pen, at, look)) fill=(pen.colour) {} }
        }
        KeySign::Band(fill) => {
            let (class, colour, opacity) = ink::fill(*fill);
            html! { rect class=(class) x=(px(x)) y=(px(y - half)) width=(px(long)) height=(px(2.0 * half))
            fill=(colour) fill-opacity=(opacity) {} }
        }
        KeySign::Class(class) => html! {
            // A little higher than its letter.
            @let half = 0.72 * look.text;
            rect x=(px(x)) y=(px(y - half)) width=(px(long)) height=(px(2.0 * half)) fill=(map::pattern(figure,
                *class)) stroke="#1b1f24" stroke-width="0.8" {}
            (map::letter(*class, [x + 0.5 * long, y], look.text))
        },
    }
}

/// Dashes of a pen; none of a solid one.
pub(super) fn dashes(pen: &Pen) -> Option<&'static str> {
    Some(pen.dashes).filter(|dashes| !dashes.is_empty())
}
