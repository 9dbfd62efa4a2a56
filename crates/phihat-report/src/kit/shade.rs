//! Shades of a table that is a heat map. Its cells have a number or a sign besides, so that no colour is needed.

use maud::{Markup, html};

/// Shade of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shade {
    /// From 0, light, to 3, dark.
    Step(u8),
    /// Beyond what is allowed.
    Beyond,
    /// Something else went wrong.
    Broken,
    /// Nothing to compare.
    None,
}

impl Shade {
    /// The step of a value: 0 up to the first of three levels, 3 beyond the last.
    pub fn of(value: f64, levels: [f64; 3]) -> Self {
        let passed = levels.into_iter().zip(1_u8..).filter(|(level, _)| value > *level);
        Self::Step(passed.map(|(_, step)| step).max().unwrap_or(0))
    }

    /// Its class in the style sheet.
    pub fn class(self) -> &'static str {
        match self {
            Self::Step(0) => "q0",
            Self::Step(1) => "q1",
            Self::Step(2) => "q2",
            Self::Step(_) => "q3",
            Self::Beyond => "q-beyond",
            Self::Broken => "q-broken",
            Self::None => "q-none",
        }
    }
}

/// The key of a heat map.
pub fn shades(entries: &[(Shade, &str)]) -> Markup {
    html! { @for (shade, words) in entries { span class=(shade.class()) { (words) } " " } }
}

#[cfg(test)]
mod tests {
    use super::Shade;

    #[test]
    fn a_level_belongs_to_the_step_below() {
        let step = |value: f64| Shade::of(value, [1.0, 3.0, 10.0]);
        assert_eq!([0.2, 1.0, 1.1, 3.0, 9.0, 11.0].map(step), [0, 0, 1, 1, 2, 3].map(Shade::Step));
    }
}
