//! A safe stop: the law brings the arm to rest and holds it there, and gives it no energy on the way.

use super::follow::{JointNews, LEAST_ACCELERATION};
use super::memory::JointMemory;
use super::moment::ArmMoment;
use super::monitor::Actuation;
use super::rules::JointRules;
use super::stopping::{RESERVE_SPEED, REST_SAMPLES, Stopping};
use crate::{Events, Form, JointGains, Measurement, Real, Reference};

/// Share of the largest speed below which a joint does not get faster: the rest is noise.
const SLOWER_SHARE: f64 = 0.98;

/// Share of the excitation at first motion that is enough in a stop: a rate limit leaves less of it, and the
/// joint is fast.
const PROBED_EXCITATION: f64 = 1.0 / 16.0;

/// Samples with half of the torque, and with the whole, that distinguish a drive fault from a push; a power
/// of two.
const PROBED_SAMPLES: u32 = 16;

/// Samples in a row in which such a joint does not follow its torque that are a fault.
const PROBED_SUSPICIOUS: u32 = 8;

/// Samples after which a drive without torque is tried for the first time, and number of samples of a trial,
/// 8 with a small torque and 8 without in turn: the first and the last are powers of two.
const TRIED_FIRST: u32 = 64;
const TRIED_SAMPLES: u32 = 48;
const TRIED_HALF: u32 = 8;

/// Number of times that a drive was taken back from which on its trials begin no later: 64 · 4⁸ samples.
const LATER_MOST: u8 = 8;

/// Speed below which what holds the arm is learnt anew \[rad/s\].
const LEARNS_BELOW: f64 = 0.1;

/// Share of a mean of 50 ms: half a second.
const LEARNS_SLOWER: f64 = 0.1;

/// Number of times that a stop began anew before the holding torque is estimated again.
const SINKS: u32 = 4;

/// Samples in which the reserve held the torque back after which the stop begins anew from where the joint is.
const ANEW_SAMPLES: u32 = 10;

impl<R: Real> JointRules<R> {
    /// The law begins to stop the joint where it is, at the speed that it has. `φ̂` stays what it is.
    ///
    /// # Law
    ///
    /// ```text
    /// q_d(0) = q,   q̇_d(0) = q̇,   then |q̈_d| ≤ A, |q⃛_d| ≤ J to rest, and there for good
    /// ```
    pub(crate) fn begin_to_stop(
        &self,
        gains: &JointGains<R>,
        memory: &mut JointMemory<R>,
        m: &Measurement<R>,
        now: &ArmMoment<R>,
    ) {
        // How far it went is what counts; a velocity may be filtered.
        let speed = (m.q - memory.measured.q) * now.interval.share / now.interval.step;
        // A stop that begins anew at a small velocity damps all of it: a reference that went along would not.
        let slow = memory.stopping.anew > 0 && speed.abs() < R::from_f64(RESERVE_SPEED);
        let speed = if slow { R::ZERO } else { speed };
        // Where the reference would have been at the last sample.
        let last = Reference { q: m.q - speed * gains.period, dq: speed, ddq: R::ZERO };
        let rest = self.stop.rest_from(&last);
        memory.home = self.range.as_ref().and_then(|range| range.keep(rest)).unwrap_or(rest);
        match gains.form {
            Form::Observer => {}
            Form::Literal => {
                // It stops in the observer form, which does not wind up; what it took for φ̂ may have.
                let [memory0, ..] = &mut memory.law.memory;
                *memory0 = memory.law.phi_hat.saturate(gains.limits.torque());
                for entry in memory.law.memory.iter_mut().skip(1) {
                    *entry = R::ZERO;
                }
                memory.law.phi_hat = memory.law.phi_hat.saturate(gains.limits.torque());
            }
            Form::Positions => {
                memory.take_over_feed();
                memory.law.rebase(&memory.reference, &last);
            }
        }
        memory.law.dq = m.dq;
        memory.reference = last;
        memory.stopping.begun = true;
        memory.stopping.held_back = 0;
        let allowed = R::from_f64(RESERVE_SPEED) + speed.abs();
        let before = memory.stopping.fastest;
        memory.stopping.fastest = if before > R::ZERO { before } else { allowed };
    }

    /// The next reference of a stop.
    pub(crate) fn stopping_reference(&self, memory: &JointMemory<R>) -> Reference<R> {
        let rest = Reference { q: memory.home, ..Reference::default() };
        self.stop.profile.step(&memory.reference, &rest)
    }

    /// Torque that tests, where a joint gets faster in a stop, if its drive follows the command; zero once it
    /// does not \[N·m\].
    ///
    /// # Method
    ///
    /// From the sample on at which the joint is faster than at the stop, it is watched as at first motion;
    /// and what brakes is halved for 16 samples of 32, since a torque that stays at its limit says nothing. A
    /// push that is stronger than the drive makes a joint faster as well, and then torque still pushes the
    /// way it should.
    /// The drive is judged at a new largest speed only: where a push ends beside a step of the torque, less of
    /// what brakes goes with more deceleration for some samples.
    pub(crate) fn probed(
        &self,
        memory: &mut JointMemory<R>,
        gains: &JointGains<R>,
        m: &Measurement<R>,
        demand: R,
        news: &mut JointNews,
    ) -> R {
        if memory.stopping.let_go > 0 {
            return self.tried_again(memory, gains, m);
        }
        let stopping = &mut memory.stopping;
        let speed = m.dq.abs();
        // A torque that its rate limit has not yet taken back explains a speed.
        let brakes = (m.tau_applied - memory.held) * m.dq < R::ZERO;
        let faster = brakes && stopping.fastest > R::ZERO && speed > stopping.fastest;
        if !faster || speed < R::from_f64(SLOWER_SHARE) * stopping.peak {
            // What brakes does what it should.
            stopping.faster = 0;
            stopping.peak = if faster { stopping.peak } else { R::ZERO };
            return demand;
        }
        let fastest = speed >= stopping.peak;
        stopping.peak = if fastest { speed } else { stopping.peak };
        if stopping.faster == 0 {
            memory.actuation = Actuation::default();
        }
        stopping.faster = stopping.faster.saturating_add(1);
        let half = stopping.faster & PROBED_SAMPLES == 0;
        let watched = (R::from_f64(PROBED_EXCITATION), PROBED_SUSPICIOUS);
        if self.actuates(memory, gains, m, watched).is_some() && fastest {
            memory.stopping.let_go = 1;
            news.events |= Events::LET_GO;
            return R::ZERO;
        }
        let known = memory.held;
        let limited = demand.saturate(gains.limits.torque());
        if half { known + R::from_f64(0.5) * (limited - known) } else { demand }
    }

    /// Torque of a drive that did not follow its command: zero, and at times, ever more seldom, the small
    /// torque by which a first motion is judged, against the motion. A joint that was only pushed follows it
    /// and is taken back. Each time that it has to be let go again, the first trial comes four times later.
    fn tried_again(
        &self,
        memory: &mut JointMemory<R>,
        gains: &JointGains<R>,
        m: &Measurement<R>,
    ) -> R {
        let age = memory.stopping.let_go;
        memory.stopping.let_go = age.saturating_add(1);
        // 64, 128, 256 … samples after it was let go.
        let begun = 1_u32 << age.ilog2();
        let since = age - begun;
        let taken_back = memory.stopping.taken_back;
        let first = TRIED_FIRST << (2 * taken_back.min(LATER_MOST));
        if begun < first || since >= TRIED_SAMPLES {
            return R::ZERO;
        }
        if since == 0 {
            memory.actuation = Actuation::default();
        }
        // Twice what a watched joint needs at least.
        let gain = R::from_f64(2.0 * LEAST_ACCELERATION) * gains.inertia_inverse * gains.period;
        // The commanded torque, not the reported one: a reversed wire changes the sign of that, too.
        let step = m.dq - memory.measured.dq;
        memory.actuation.take((memory.law.tau, step), gain, (R::ZERO, u32::MAX));
        let judged = (since + 1).is_multiple_of(2 * TRIED_HALF);
        if judged && !memory.actuation.follows(gain) {
            memory.stopping.let_go = begun + TRIED_SAMPLES;
            return R::ZERO;
        }
        if since + 1 == TRIED_SAMPLES {
            let (fastest, learns) = (m.dq.abs(), memory.stopping.learns);
            let taken_back = taken_back.saturating_add(1);
            memory.stopping = Stopping { learns, fastest, taken_back, ..Stopping::default() };
            return R::ZERO;
        }
        let small = self.first_motion.map_or(R::ZERO, R::sqrt);
        let brakes = if m.dq > R::ZERO { -small } else { small };
        if since & TRIED_HALF == 0 { brakes } else { R::ZERO }
    }

    /// A torque demand that gives the joint no more energy than the stop took out of it.
    ///
    /// # Law
    ///
    /// With `τ_0` the torque that held the arm before, and `Δq` the motion of the joint since the last
    /// sample, the drive's work on the joint is exactly `(τ_applied − τ_0) Δq`: the torque is constant over a
    /// sample.
    ///
    /// ```text
    /// E ← min(E_max, E − (τ_applied − τ_0) Δq),   E = 0 at the stop
    /// τ = τ_0 + s (τ_law − τ_0),   s ≤ 1 such that  s (τ_law − τ_0) Δq ≤ max(E, 0)                   as (Q1)
    /// ```
    ///
    /// A torque against the motion is never held back. A joint that rests has no energy: then `E = E_max`.
    pub(crate) fn without_driving(
        &self,
        memory: &mut JointMemory<R>,
        m: &Measurement<R>,
        (demand, phi_hat): (R, R),
        now: &ArmMoment<R>,
        news: &mut JointNews,
    ) -> R {
        let moved = m.q - memory.measured.q;
        // Where nothing pushes and a joint that all but stands sinks time and again, what held it before does
        // not hold it here: it sank before it was measured again, or a push moved it far.
        if (memory.stopping.learns || now.alone)
            && memory.stopping.anew >= SINKS
            && m.dq.abs() <= R::from_f64(LEARNS_BELOW)
        {
            memory.held += R::from_f64(LEARNS_SLOWER) * now.average * (phi_hat - memory.held);
        }
        let known = memory.held;
        let most = self.stop.unloaded_at(m.dq);
        let demand = phi_hat + (demand - phi_hat).saturate(most);
        let stopping = &mut memory.stopping;
        let left = stopping.reserve - (m.tau_applied - known) * moved;
        stopping.reserve = left.saturate(self.stop.reserve);
        let (place, samples) = &mut stopping.rest;
        if (m.q - *place).abs() > self.stop.rest_travel {
            (*place, *samples) = (m.q, 0);
        } else if *samples < REST_SAMPLES {
            *samples += 1;
        } else {
            (*place, *samples) = (m.q, 0);
            stopping.reserve = self.stop.reserve;
        }
        let drives = demand - known;
        let gives = drives * moved;
        if gives <= R::ZERO || gives <= stopping.reserve {
            return demand;
        }
        news.events |= Events::HELD_BACK;
        let share = if stopping.reserve > R::ZERO { stopping.reserve / gives } else { R::ZERO };
        stopping.held_back = stopping.held_back.saturating_add(1);
        if stopping.held_back >= ANEW_SAMPLES {
            stopping.begun = false;
            stopping.anew = stopping.anew.saturating_add(1);
        }
        known + share * drives
    }
}
