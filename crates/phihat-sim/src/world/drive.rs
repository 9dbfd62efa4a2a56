//! The drive: from a torque demand to the torque that acts.

/// One joint's drive: a first-order torque loop, or none.
///
/// # Law
///
/// ```text
/// τ̇ = ω (τ_demand − τ),   solved exactly while the demand is held; ω = ∞: τ = τ_demand       (D1)
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct DriveLoop {
    /// `ω` \[rad/s\]; `None`: infinite.
    rate: Option<f64>,
    demand: f64,
    /// Most that the demand changes from one interval to the next; infinite: no limit.
    step: f64,
    /// Torque at the start of the interval minus the demand.
    gap: f64,
}

impl DriveLoop {
    pub(crate) fn new(bandwidth_hz: Option<f64>) -> Self {
        let rate = bandwidth_hz.map(|f| f * core::f64::consts::TAU);
        Self { rate, demand: 0.0, step: f64::INFINITY, gap: 0.0 }
    }

    /// The same drive, its demand changing by no more than `step` \[N·m\] per interval.
    pub(crate) fn with_step(self, step: f64) -> Self {
        Self { step, ..self }
    }

    /// As if so much torque had been asked for for long.
    pub(crate) fn held(self, demand: f64) -> Self {
        Self { demand, gap: 0.0, ..self }
    }

    /// Takes a new demand at the start of an interval.
    pub(crate) fn demand(&mut self, demand: f64) {
        let demand = if (demand - self.demand).abs() > self.step {
            self.demand + self.step.copysign(demand - self.demand)
        } else {
            demand
        };
        self.gap = if self.rate.is_some() { self.gap + self.demand - demand } else { 0.0 };
        self.demand = demand;
    }

    /// Torque `elapsed` seconds into the interval.
    pub(crate) fn torque(&self, elapsed: f64) -> f64 {
        match self.rate {
            Some(rate) => self.demand + self.gap * libm::exp(-rate * elapsed),
            None => self.demand,
        }
    }

    /// Largest change of a demand from one to the next \[N·m\].
    pub(super) fn step(&self) -> f64 {
        self.step
    }

    /// `ω`, the demand, and what was between it and the torque at the start of the interval.
    pub(super) fn held_over(&self) -> (Option<f64>, f64, f64) {
        (self.rate, self.demand, self.gap)
    }

    /// Mean torque over an interval of `length` seconds; the next interval starts at its end.
    pub(crate) fn finish(&mut self, length: f64) -> f64 {
        let Some(rate) = self.rate else { return self.demand };
        let mean = self.demand - self.gap * libm::expm1(-rate * length) / (rate * length);
        self.gap *= libm::exp(-rate * length);
        mean
    }
}
