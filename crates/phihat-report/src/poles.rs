//! Sections of an innovation filter, as people read them.

use phihat_design::FilterSection;

use crate::kit::number::number;

/// The poles of a section \[rad/s\]: `s = ln(1 + w)/T` with `w² + c_1 w + c_0 = 0`. A pole that no `s` on the left is
/// sampled to, real and not above 0, is told as `z`.
pub fn section_poles(section: &FilterSection, rate_hz: f64) -> String {
    let [c0, c1] = section.rates;
    let turn = 0.25 * c1 * c1 - c0;
    let told = |value: f64| number(value).replace('-', "−");
    if turn < 0.0 {
        // Both at once: |1 + w|² = 1 − c_1 + c_0.
        let angle = libm::atan2((-turn).sqrt(), 1.0 - 0.5 * c1);
        let decay = 0.5 * libm::log1p(c0 - c1) * rate_hz;
        return format!("{} ± {}j", told(decay), number(angle * rate_hz));
    }
    // The larger w first, so that nothing is lost of the smaller.
    let far = -(0.5 * c1 + turn.sqrt());
    let near = if far < 0.0 { c0 / far } else { 0.0 };
    let pole = |w: f64| {
        if w > -1.0 { told(libm::log1p(w) * rate_hz) } else { format!("z = {}", told(1.0 + w)) }
    };
    format!("{}, {}", pole(near), pole(far))
}

#[cfg(test)]
mod tests {
    use super::section_poles;
    use phihat_design::FilterSection;

    fn told(rates: [f64; 2]) -> String {
        section_poles(&FilterSection { rates, weights_per_s2: [0.0; 2] }, 1000.0)
    }

    /// Rates of poles at these `z`: from their sum and product.
    fn rates(sum: f64, product: f64) -> [f64; 2] {
        [1.0 - sum + product, 2.0 - sum]
    }

    #[test]
    fn poles_read_back() {
        // s = −100 ± 200j rad/s.
        let decay = (-0.1_f64).exp();
        let pair = rates(2.0 * decay * 0.2_f64.cos(), decay * decay);
        assert_eq!(told(pair), "−100.0 ± 200.0j");
        // s = −2 and −300 rad/s; the same twice.
        let [slow, fast] = [(-0.002_f64).exp(), (-0.3_f64).exp()];
        assert_eq!(told(rates(slow + fast, slow * fast)), "−2.000, −300.0");
        assert!(told([0.01, 0.2]).starts_with("−105.4"), "{}", told([0.01, 0.2]));
        // z = 0.5 and −0.25, and what no s is sampled to.
        assert_eq!(told(rates(0.25, -0.125)), "−693.1, z = −0.2500");
        assert_eq!(told([1.0, 2.0]), "z = 0, z = 0");
    }
}
