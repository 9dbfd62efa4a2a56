//! Tables and sentences for the terminal. Units are converted here for reading, nothing else.

mod budget;
mod class;
mod coarser;
mod coupled;
mod design;
mod fitted;
mod identified;
mod limit;
mod metrics;
pub(crate) mod motion;
mod robots;
mod stop;

use phihat_report::kit::{MILLI, unit_of};

pub(crate) use budget::budget;
pub(crate) use class::class;
pub(crate) use coarser::coarser;
pub(crate) use design::{certificate, gains, not_counted};
pub(crate) use fitted::Fitted;
pub(crate) use identified::identified;
pub(crate) use limit::limit;
pub(crate) use metrics::{metrics, tip, tube, verdict};
pub(crate) use robots::{chains, joints, robots};
pub(crate) use stop::stop;

/// A figure with so many decimals; one that is below the last of them with two significant digits: it is not nothing.
pub(crate) fn figure(value: f64, decimals: usize) -> String {
    let least = 0.1_f64.powi(i32::try_from(decimals).unwrap_or(i32::MAX));
    if !value.is_finite() || value.abs() >= least || value.abs() < f64::MIN_POSITIVE {
        return format!("{value:.decimals$}");
    }
    let rounded = format!("{value:.1e}");
    let exponent = rounded.split_once('e').and_then(|(_, power)| power.parse::<i32>().ok());
    match exponent.and_then(|power| usize::try_from(-power).ok()) {
        Some(zeros @ 0..=7) => format!("{value:.*}", zeros + 1),
        _ => rounded,
    }
}

/// A joint's figure: its unit stands beside it where it is not that of the heading, because it slides.
pub(crate) fn in_unit(figure: String, turning: &str, slides: bool) -> String {
    if slides { format!("{figure} {}", unit_of(turning, true)) } else { figure }
}

fn plain_table<T: Into<comfy_table::Row>>(headers: T) -> Fitted {
    Fitted::new(headers)
}

/// Figures to the right, names to the left, one space around.
fn align(table: &mut Fitted) {
    table.align();
}

#[cfg(test)]
mod tests {
    use super::{figure, in_unit};

    #[test]
    fn what_is_small_is_not_shown_as_nothing() {
        for (value, decimals, shown) in [
            (12.3456, 3, "12.346"),
            (0.123_46, 3, "0.123"),
            (0.0123, 3, "0.012"),
            (0.001_23, 3, "0.001"),
            (0.000_123, 3, "0.00012"),
            (-0.000_5, 3, "-0.00050"),
            (1.5e-6, 3, "0.0000015"),
            (1.5e-9, 3, "1.5e-9"),
            (0.0, 3, "0.000"),
            (0.04, 1, "0.040"),
            (0.4, 1, "0.4"),
            (4.0, 1, "4.0"),
            (0.0, 2, "0.00"),
            (f64::NAN, 2, "NaN"),
        ] {
            assert_eq!(figure(value, decimals), shown, "{value}");
        }
    }

    #[test]
    fn a_joint_that_slides_has_its_own_unit() {
        assert_eq!(in_unit("1.5".to_owned(), "mrad/s", false), "1.5");
        assert_eq!(in_unit("1.5".to_owned(), "mrad/s", true), "1.5 mm/s");
    }
}
