//! The drive of one joint of many arms, one arm per lane.

use phihat_model::{FileChoice, Lanes, Scalar};

use super::SimulatedWorld;
use super::drive::DriveLoop;

/// Drives, one per lane: as `DriveLoop`, in its order of operations.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DriveLanes {
    /// Largest change of a demand; `None`: no drive has one.
    step: Option<Lanes>,
    /// `None`: torque acts at once in all of them.
    lag: Option<Lag>,
    pub(super) demand: Lanes,
    pub(super) gap: Lanes,
}

/// Factors of a lag over a sample period `T`, at a rate `ω`; a drive without one follows at once.
#[derive(Debug, Clone, Copy)]
struct Lag {
    /// 1 where there is one.
    is: Lanes,
    /// `exp(−ωT) − 1`, `ωT` and `exp(−ωT)`.
    loss: Lanes,
    angle: Lanes,
    left: Lanes,
}

impl DriveLanes {
    /// The drives of a joint as they are now; free lanes have the last world's.
    pub(crate) fn of(worlds: &[&SimulatedWorld], joint: usize) -> Self {
        let drive = |k: usize| {
            let world = worlds.get(k).or(worlds.last());
            let drive = world.and_then(|world| world.plant.forces.drives.get(joint));
            drive.copied().unwrap_or(DriveLoop::new(None))
        };
        let lane =
            |of: &dyn Fn(DriveLoop) -> f64| Lanes::from(core::array::from_fn(|k| of(drive(k))));
        let period = worlds.first().map_or(1.0, |world| world.period);
        let rate = |drive: DriveLoop| drive.held_over().0;
        let per = |with: f64, of: fn(f64) -> f64| {
            lane(&|drive| rate(drive).map_or(with, |rate| of(rate * period)))
        };
        let lags = (0..Lanes::COUNT).any(|k| rate(drive(k)).is_some());
        let steps = (0..Lanes::COUNT).any(|k| drive(k).step() < f64::INFINITY);
        let lag = || Lag {
            is: per(0.0, |_| 1.0),
            loss: per(0.0, |angle| libm::expm1(-angle)),
            angle: per(1.0, |angle| angle),
            left: per(0.0, |angle| libm::exp(-angle)),
        };
        Self {
            step: steps.then(|| lane(&|drive| drive.step())),
            lag: lags.then(lag),
            demand: lane(&|drive| drive.held_over().1),
            gap: lane(&|drive| drive.held_over().2),
        }
    }

    /// Takes a new demand \[N·m\]; the torque at the start of the interval.
    #[inline]
    pub(crate) fn begin(&mut self, demand: Lanes) -> Lanes {
        let mut demand = demand;
        if let Some(step) = self.step {
            let change = demand - self.demand;
            let toward = change.exceeds(Lanes::splat(0.0)).pick(step, -step);
            let too_far: FileChoice = change.abs().exceeds(step);
            demand = too_far.pick(self.demand + toward, demand);
        }
        let Some(lag) = self.lag else {
            self.demand = demand;
            return demand;
        };
        self.gap = (self.gap + self.demand - demand) * lag.is;
        self.demand = demand;
        demand + self.gap
    }

    /// Ends the interval: its mean torque \[N·m\].
    #[inline]
    pub(crate) fn finish(&mut self) -> Lanes {
        let Some(lag) = self.lag else { return self.demand };
        let mean = self.demand - self.gap * lag.loss / lag.angle;
        self.gap = self.gap * lag.left;
        mean
    }
}
