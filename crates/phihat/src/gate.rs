//! The last thing between a computed torque and the wire.

use crate::{Command, Gain, GainError, Limits, Measurement, Real, Status};

/// Torques \[N·m\] that a [`Gate`] let out, on their way to a wire: only a gate makes them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Released<'a, R>(&'a [R]);

impl<'a, R: Copy> Released<'a, R> {
    /// The torques.
    pub fn tau(self) -> &'a [R] {
        self.0
    }

    /// The same torques in the order of another wire: torque `i` at `out[places[i]]`, every other entry 0. A
    /// place that `out` lacks is left out.
    pub fn placed<'b>(self, places: &[usize], out: &'b mut [R]) -> Released<'b, R>
    where
        R: Real,
    {
        placed(self.0.iter().copied(), places, out)
    }
}

/// Value `i` at `out[places[i]]`, 0 elsewhere.
fn placed<'a, R: Real>(
    values: impl Iterator<Item = R>,
    places: &[usize],
    out: &'a mut [R],
) -> Released<'a, R> {
    out.fill(R::ZERO);
    for (value, place) in values.zip(places) {
        if let Some(entry) = out.get_mut(*place) {
            *entry = value;
        }
    }
    Released(out)
}

/// One joint of a [`Gate`]: its limits, and the torque that it let through last.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Outlet<R> {
    limits: Limits<R>,
    /// Position at the last sample \[rad\]; before the first one there is none.
    q: Option<R>,
    tau: R,
}

impl<R: Real> Outlet<R> {
    /// Limits of a joint, behind a drive that gives no torque yet.
    pub fn new(limits: Limits<R>) -> Self {
        Self { limits, q: None, tau: R::ZERO }
    }

    /// The limits.
    pub fn limits(&self) -> &Limits<R> {
        &self.limits
    }
}

/// The most energy that the drives of an arm may give it within a time.
///
/// # Law
///
/// A tank of half of the energy, which fills up with the other half in the time:
///
/// ```text
/// E ← min(E_max/2, E + E_max/2 · T/t − Σ_i τ_i Δq_i)
/// ```
///
/// If the forecast `Σ τ_i Δq_i` of the next sample is more than the energy in the tank, torques along the
/// motion are scaled down; those against it never. So the work of the drives over any time `t` is at most
/// `E_max`, plus the error of the forecast of one sample.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tank<R> {
    capacity: R,
    /// Inflow per sample \[J\].
    inflow: R,
    energy: R,
}

impl<R: Real> Tank<R> {
    /// At most `energy` \[J\] within any `within` \[s\], at a sample period \[s\].
    ///
    /// # Errors
    ///
    /// [`GainError::NotPositive`] when one of them is not positive and finite.
    pub fn new(energy: f64, within: f64, period: f64) -> Result<Self, GainError> {
        let half = 0.5 * Gain::EnergyMax.positive(energy)?;
        let share = Gain::Period.positive(period)? / Gain::EnergyWindow.positive(within)?;
        let capacity = R::from_f64(half);
        let share = if share < 1.0 { share } else { 1.0 };
        Ok(Self { capacity, inflow: R::from_f64(half * share), energy: capacity })
    }

    fn turn(&mut self, work: R) {
        // No more is owed than the tank holds: what a sensor says for one sample does not close the gate for good.
        self.energy = (self.energy + self.inflow - work).saturate(self.capacity);
    }
}

/// A gate without which no torque leaves: finite, within its range and its rate, and within an energy per
/// time. Its place is behind everything that computes on a torque: gravity compensation, feed-forward, a
/// robot's rounding.
///
/// `J` holds an [`Outlet`] per joint: an array where there is no allocator, or a `Vec`.
///
/// # Law
///
/// A torque that is not finite is the last one. Then the energy ([`Tank`]), then the rate, and the range
/// last: a later one is kept whatever the ones before it ask for. A position that is not finite counts as the
/// last one.
///
/// # Real time
///
/// Does not allocate; an addition, a product and the limits per joint.
///
/// # Example
///
/// ```
/// use phihat::{Command, Gate, Limits, Measurement, Outlet};
///
/// let limits = Limits::<f64>::new(Some(87.0), Some(1000.0), 1e-3)?;
/// let mut gate = Gate::new([Outlet::new(limits)], None);
/// let mut commands = [Command { tau: f64::NAN, ..Command::default() }];
/// gate.release(&[Measurement::default()], &mut commands);
/// assert!(commands[0].status.refused);
/// let mut wire = [0.0];
/// assert_eq!(gate.torques(&[0], &mut wire).tau(), [0.0]);
/// # Ok::<(), phihat::GainError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Gate<R, J> {
    outlets: J,
    tank: Option<Tank<R>>,
}

impl<R: Real, J: AsRef<[Outlet<R>]> + AsMut<[Outlet<R>]>> Gate<R, J> {
    /// A gate; without a tank it limits no energy.
    pub fn new(outlets: J, tank: Option<Tank<R>>) -> Self {
        Self { outlets, tank }
    }

    /// The joints.
    pub fn outlets(&self) -> &[Outlet<R>] {
        self.outlets.as_ref()
    }

    /// From here on the rate counts from these torques \[N·m\]: something else holds the arm with them.
    pub fn holding(&mut self, tau: &[R]) {
        for (outlet, tau) in self.outlets.as_mut().iter_mut().zip(tau) {
            if tau.is_finite() {
                outlet.tau = *tau;
            }
        }
    }

    /// Lets the torques of a sample out, which `commands` then holds, with what became of each. One entry per
    /// joint in both.
    pub fn release(&mut self, measured: &[Measurement<R>], commands: &mut [Command<R>]) {
        let share = self.energy_share(measured, commands);
        let joints = self.outlets.as_mut().iter_mut().zip(measured).zip(commands);
        for ((outlet, m), command) in joints {
            let mut demand = command.tau;
            if let Some(share) = share.filter(|_| demand * outlet.moved(m) > R::ZERO) {
                demand = share * demand;
                command.status.saturated = true;
            }
            let last = outlet.limits.command(demand, outlet.tau);
            command.status = Status {
                saturated: command.status.saturated || last.status.saturated,
                rate_limited: command.status.rate_limited || last.status.rate_limited,
                refused: command.status.refused || last.status.refused,
            };
            outlet.tau = last.tau;
            outlet.q = if m.q.is_finite() { Some(m.q) } else { outlet.q };
            command.tau = last.tau;
        }
    }

    /// Torques that were let out last \[N·m\], in the order of a wire: torque `i` at `out[places[i]]`, every
    /// other entry 0. A place that `out` lacks is left out.
    pub fn torques<'a>(&self, places: &[usize], out: &'a mut [R]) -> Released<'a, R> {
        placed(self.outlets().iter().map(|outlet| outlet.tau), places, out)
    }

    /// Share of the torques along the motion that the tank lets out; `None`: all.
    fn energy_share(&mut self, measured: &[Measurement<R>], commands: &[Command<R>]) -> Option<R> {
        let tank = self.tank.as_mut()?;
        let (mut done, mut drives, mut brakes) = (R::ZERO, R::ZERO, R::ZERO);
        for ((outlet, m), command) in self.outlets.as_ref().iter().zip(measured).zip(commands) {
            let moved = outlet.moved(m);
            done += outlet.tau * moved;
            if command.tau.is_finite() {
                let work = command.tau.saturate(outlet.limits.torque()) * moved;
                if work > R::ZERO { drives += work } else { brakes += work }
            }
        }
        tank.turn(done);
        let left = tank.energy - brakes;
        let allowed = drives <= R::ZERO || drives <= left;
        (!allowed).then(|| if left > R::ZERO { left / drives } else { R::ZERO })
    }
}

impl<R: Real> Outlet<R> {
    /// Motion of the joint since the last sample \[rad\].
    fn moved(&self, m: &Measurement<R>) -> R {
        match self.q {
            Some(before) if m.q.is_finite() => m.q - before,
            _ => R::ZERO,
        }
    }
}
