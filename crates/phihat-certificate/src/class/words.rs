//! The class of a bound in words.

use super::ClassBound;
use crate::extremes::Extremes as _;

impl ClassBound {
    /// Half the joint box, and the largest speed, acceleration and jerk, in words: `±0.3 rad, 0.2 rad/s, 0.2 rad/s²,
    /// 1 rad/s³`. Of joints that differ, the least and the largest: `0.1 … 0.2 rad/s`. Joints at whose place `slides`
    /// is true are in metres.
    pub fn limits_in_words(&self, slides: &[bool]) -> String {
        let ends = self.box_rad.0.iter().zip(&self.box_rad.1);
        let half: Vec<f64> = ends.map(|(low, high)| 0.5 * (high - low)).collect();
        let lists = [
            ("±", "", &half),
            ("", "/s", &self.speed_max_rad_s),
            ("", "/s²", &self.acceleration_max_rad_s2),
            ("", "/s³", &self.jerk_max_rad_s3),
        ];
        let words = lists.map(|(sign, per, values)| {
            let kinds = [("rad", false), ("m", true)].map(|(unit, sliding)| {
                let joints = values.iter().enumerate();
                let slides = |i: usize| slides.get(i).copied().unwrap_or(false);
                let of = joints.filter(|(i, _)| slides(*i) == sliding).map(|(_, value)| *value);
                let (least, most) = of.ends();
                (least <= most).then(|| format!("{sign}{} {unit}{per}", span(least, most)))
            });
            kinds.into_iter().flatten().collect::<Vec<_>>().join(" and ")
        });
        words.join(", ")
    }
}

/// `0.2`, or `0.1 … 0.2` where the ends differ in four digits.
fn span(least: f64, most: f64) -> String {
    let shown = |x: f64| {
        let text = format!("{x:.4}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    };
    let (least, most) = (shown(least), shown(most));
    if least == most { most } else { format!("{least} … {most}") }
}

#[cfg(test)]
mod tests {
    use super::span;

    #[test]
    fn a_span_is_one_figure_where_its_ends_are_the_same() {
        assert_eq!(span(0.2, 0.1 + 0.1), "0.2");
        // What is left of a difference of two ends.
        assert_eq!(span(0.3, 0.3 + 1e-16), "0.3");
        assert_eq!(span(1.0, 10.0), "1 … 10");
    }
}
