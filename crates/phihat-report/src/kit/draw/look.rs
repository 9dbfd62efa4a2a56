//! Size of a figure, and how its numbers are written.

/// Size of a figure and of its letters, in units of its view box \[px\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FigureSize {
    /// Width of the figure.
    pub width: f64,
    /// Height of its letters.
    pub text: f64,
    /// True if its title stands in it: a file has no heading beside it.
    pub titled: bool,
    /// Height of the axes of a panel with their labels; `None`: by the number of columns.
    pub height: Option<f64>,
}

impl FigureSize {
    /// A figure for paper and for a page: 16 cm wide, letters of 7.5 points.
    pub const PAPER: Self = Self { width: 960.0, text: 16.0, titled: true, height: None };

    /// A wide figure under a heading, with many labels.
    pub const WIDE: Self = Self { width: 960.0, text: 15.0, titled: false, height: Some(600.0) };

    /// The same for a narrow screen.
    pub const NARROW: Self = Self { width: 400.0, text: 14.5, titled: false, height: Some(285.0) };

    /// A small figure, several beside each other.
    pub const SMALL: Self = Self { width: 560.0, text: 16.0, titled: false, height: Some(330.0) };

    /// The same with another height of the axes of a panel.
    #[must_use]
    pub fn of_height(self, height: f64) -> Self {
        Self { height: Some(height), ..self }
    }

    /// Height of a line of text.
    pub(super) fn line(&self) -> f64 {
        1.6 * self.text
    }

    /// Width of some letters, generously.
    pub(super) fn wide(&self, letters: usize) -> f64 {
        0.6 * self.text * letters as f64
    }

    /// Letters that a width has room for.
    pub(super) fn letters(&self, width: f64) -> usize {
        (1..200).take_while(|count| self.wide(*count) <= width).count().max(4)
    }

    /// Radius of a mark.
    pub(super) fn mark(&self) -> f64 {
        0.27 * self.text
    }
}

/// Units of a view box per centimetre on paper: 960 are 16 cm.
pub(super) const UNITS_PER_CM: f64 = 60.0;

/// A length of a picture: a tenth of a unit is enough.
pub(super) fn px(length: f64) -> String {
    let text = format!("{length:.1}");
    let short = text.strip_suffix(".0").unwrap_or(&text);
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

/// A rectangle of a picture: `[left, top, right, bottom]`.
pub(super) type Rect = [f64; 4];
