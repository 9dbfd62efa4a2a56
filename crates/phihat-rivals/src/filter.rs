//! A low-pass of second order, the same for every signal that goes through it.

/// `H(s) = ω²/(s² + 2ζωs + ω²)` with its exact sampled poles and gain 1 at rest:
///
/// ```text
/// y_k = (1 + a_1 + a_2) u_k − a_1 y_{k−1} − a_2 y_{k−2}                                  (1)
/// ```
///
/// `z² + a_1 z + a_2` has the poles `e^{sT}`. It answers within the sample.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LowPass {
    a: [f64; 2],
}

/// State of the filter for one signal: the last output and the one before.
pub(crate) type Passed = [f64; 2];

impl LowPass {
    /// `ω` \[rad/s\], damping, sample period \[s\].
    pub(crate) fn new(omega: f64, zeta: f64, period: f64) -> Self {
        let x = omega * period;
        let a = if zeta < 1.0 {
            let size = (-zeta * x).exp();
            [-2.0 * size * (x * (1.0 - zeta * zeta).sqrt()).cos(), size * size]
        } else {
            let apart = (zeta * zeta - 1.0).sqrt();
            let [slow, fast] = [zeta - apart, zeta + apart].map(|times| (-times * x).exp());
            [-slow - fast, slow * fast]
        };
        Self { a }
    }

    /// (1)
    pub(crate) fn pass(self, memory: &mut Passed, input: f64) -> f64 {
        let [a1, a2] = self.a;
        let output = (1.0 + a1 + a2) * input - a1 * memory[0] - a2 * memory[1];
        *memory = [output, memory[0]];
        output
    }
}

#[cfg(test)]
mod tests {
    use super::LowPass;

    /// The step response of the differential equation, sampled: `1 − e^{−ζωt}(cos + ζ/√(1−ζ²) sin)` and
    /// `1 − (1 + ωt) e^{−ωt}`. A filter that answers within the sample is ahead by one sample at most.
    #[test]
    fn a_step_goes_through_as_through_the_differential_equation() {
        let (w, h) = (50.0_f64, 1e-4_f64);
        for zeta in [0.55, 1.0, 2.0] {
            let filter = LowPass::new(w, zeta, h);
            let mut memory = [0.0; 2];
            // By steps of Heun's method, a tenth as long.
            let (mut y, mut dy) = (0.0_f64, 0.0_f64);
            for _ in 0..6000 {
                let sampled = filter.pass(&mut memory, 1.0);
                for _ in 0..10 {
                    let k = h / 10.0;
                    let slope = |y: f64, dy: f64| w * w * (1.0 - y) - 2.0 * zeta * w * dy;
                    let (y1, dy1) = (y + k * dy, dy + k * slope(y, dy));
                    let (a, b) = (slope(y, dy), slope(y1, dy1));
                    (y, dy) = (y + 0.5 * k * (dy + dy1), dy + 0.5 * k * (a + b));
                }
                assert!((sampled - y).abs() < 4e-3, "{zeta}: {sampled} and {y}");
            }
            assert!((memory[0] - 1.0).abs() < 1e-2);
        }
    }
}
