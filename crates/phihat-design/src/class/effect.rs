//! Effects that a class bound is made of, and inputs of the frozen loop.

/// Effect that adds to a bound.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ClassEffect {
    Quantum,
    Noise,
    Jitter,
    Dry,
    Stiction,
    Cogging,
    Smooth,
    Motion,
    Start,
    Losses,
    Moving,
}

impl ClassEffect {
    /// All of them, in the order in which they are shown.
    pub(super) const ALL: [Self; 11] = [
        Self::Motion,
        Self::Moving,
        Self::Dry,
        Self::Stiction,
        Self::Smooth,
        Self::Cogging,
        Self::Quantum,
        Self::Noise,
        Self::Jitter,
        Self::Losses,
        Self::Start,
    ];

    /// Those that a study can state less of without another motion or arm.
    pub(super) const SIGNALS: [Self; 5] =
        [Self::Noise, Self::Jitter, Self::Stiction, Self::Cogging, Self::Losses];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Quantum => "encoder steps",
            Self::Noise => "noise",
            Self::Jitter => "jitter",
            Self::Dry => "dry friction",
            Self::Stiction => "stiction",
            Self::Cogging => "cogging",
            Self::Smooth => "viscous friction",
            Self::Motion => "motion and payload",
            Self::Start => "start",
            Self::Losses => "lost commands",
            Self::Moving => "changing inertia",
        }
    }
}

/// Inputs of the frozen loop at bounds on error and velocity, joint by joint.
#[derive(Debug, Clone)]
pub(super) struct ClassInputs {
    /// Forces of any course \[N·m\], and rates of forces \[N·m/s\].
    pub(super) torque: Vec<f64>,
    pub(super) ramp: Vec<f64>,
    /// Force of this size and this rate: whichever costs less.
    pub(super) wave: Vec<[f64; 2]>,
    /// `|N| V`, `N` the change of inertia by the error.
    pub(super) shift: Vec<f64>,
    /// Error of a reading, with what jitter adds to it.
    pub(super) reading: Vec<f64>,
    /// Torque by which the start is out of balance.
    pub(super) start: Vec<f64>,
    /// Largest deviation of the torque that acts from a command that is lost.
    pub(super) deviation: Vec<f64>,
}

impl ClassInputs {
    pub(super) fn none(n: usize) -> Self {
        let zero = || vec![0.0; n];
        Self {
            torque: zero(),
            ramp: zero(),
            wave: vec![[0.0; 2]; n],
            shift: zero(),
            reading: zero(),
            start: zero(),
            deviation: zero(),
        }
    }

    pub(super) fn add(&mut self, share: f64, other: &Self) {
        let lists = [
            (&mut self.torque, &other.torque),
            (&mut self.ramp, &other.ramp),
            (&mut self.shift, &other.shift),
            (&mut self.reading, &other.reading),
            (&mut self.start, &other.start),
            (&mut self.deviation, &other.deviation),
        ];
        for (own, other) in lists {
            own.iter_mut().zip(other).for_each(|(own, x)| *own += share * x);
        }
        for (own, other) in self.wave.iter_mut().zip(&other.wave) {
            own.iter_mut().zip(other).for_each(|(own, x)| *own += share * x);
        }
    }
}

fn row(m: &[f64], i: usize, x: &[f64]) -> f64 {
    let n = x.len();
    (0..n).map(|k| m[i * n + k] * x[k]).sum()
}

/// `Σ_c |list_c| y_c x`.
pub(super) fn bilinear(list: &[Vec<f64>], i: usize, (y, x): (&[f64], &[f64])) -> f64 {
    list.iter().zip(y).map(|(m, y)| y * row(m, i, x)).sum()
}
