//! Free scalars that several laws have, with the same meaning and the same range.

use crate::tuning::Scalar;

/// Rate of an integral beside a proportional gain.
pub(crate) const INTEGRAL_RATE: Scalar = Scalar {
    name: "integral_rate",
    unit: "1/s",
    meaning: "1/T_i",
    default: 5.0,
    low: 0.5,
    high: 50.0,
};

/// Bandwidth of the error on a sliding surface `s = ė + Λ e`.
pub(crate) const SLIDING: Scalar = Scalar {
    name: "sliding",
    unit: "1/s",
    meaning: "Λ, of the error on s = 0",
    default: 10.0,
    low: 1.0,
    high: 100.0,
};

/// Rate at which an estimate is forgotten.
pub(crate) const LEAKAGE: Scalar = Scalar {
    name: "leakage",
    unit: "1/s",
    meaning: "σ, at which estimates are forgotten",
    default: 0.01,
    low: 1e-3,
    high: 0.1,
};

/// Rate of an estimate of the parameters, in units of inertia.
pub(crate) const ADAPTATION: Scalar = Scalar {
    name: "adaptation",
    unit: "1/(kg·m²)",
    meaning: "γ of Γ = γ U",
    default: 5.0,
    low: 0.5,
    high: 50.0,
};

/// Gain of a torque against `s`.
pub(crate) const SLIDING_DAMPING: Scalar = Scalar {
    name: "damping",
    unit: "1/s",
    meaning: "K_D of s",
    default: 80.0,
    low: 8.0,
    high: 800.0,
};

/// Rate at which a wide funnel becomes narrow.
pub(crate) const DECAY: Scalar = Scalar {
    name: "decay",
    unit: "1/s",
    meaning: "l of the transient",
    default: 2.0,
    low: 0.2,
    high: 20.0,
};

/// Slope of a surface `s = ė + λ e`.
pub(crate) const SURFACE: Scalar =
    Scalar { name: "surface", unit: "1/s", meaning: "λ", default: 10.0, low: 1.0, high: 100.0 };

/// Natural frequency of the error under a model-based or adaptive inner loop.
pub(crate) const ERROR_BANDWIDTH: Scalar = Scalar {
    name: "bandwidth",
    unit: "rad/s",
    meaning: "ω of the error, K_p = ω²",
    default: 20.0,
    low: 2.0,
    high: 200.0,
};
