//! Laws from positions whose tube keeps the specification: with the least share of the torque noise that is allowed.

use std::path::Path;

use phihat_certificate::extremes::Extremes as _;
use phihat_design::tube::{Desired, FINER, PARTS};
use phihat_design::{Arm, DesignError, Gains, Outcome, Phi, PositionSearch};
use phihat_sim::Demand;
use phihat_study::{PhiSource, Study};

use crate::along::phi_along;
use crate::error::SessionError;
use crate::judged::{Judged, judge};
use crate::told::Told;

/// How often laws are looked for.
const ROUNDS: u32 = 7;

/// After so many in a row that gain nothing, it ends; where finer slices are to come, after one.
const STUCK: u32 = 2;

/// The encoder's share of the torque step that a study allows: where a search begins, and its ends. What else turns the torque has
/// the rest.
const FIRST: f64 = 0.6;
const SHARES: (f64, f64) = (0.01, 1.0);

/// Of [`FIRST`], what is tried after a tube that does not close: stiffer laws mostly close one sooner, but where the encoder is what
/// widens it, softer ones do. After the first, all by the search for the least error.
const OPEN: [f64; 5] = [1.5, 1.0, 1.5, 0.5, 0.25];

/// The error of a law falls by about this power of its noise.
const POWER: f64 = 0.4;

/// How much of the allowed torque step is gone for.
const ROOM: f64 = 0.97;

/// A tube that uses less of the specification than this leaves room for less noise.
const ENOUGH: f64 = 0.85;

/// Designs for a study until the tube keeps the specification; where no tube does, once more with the payload in finer slices.
///
/// # Errors
///
/// [`SessionError`] of the search.
pub(crate) fn by_positions(
    study: &Study,
    (arm, demand): (&Arm, &Demand),
    path: &Path,
) -> Result<Outcome, SessionError> {
    let motion = Told::of(study).map_err(|e| SessionError::at(path, e))?;
    // For the search alone: the certificate of an arm with a description says nothing of φ.
    let phi = |joint: usize, inertia: f64| {
        let along = phi_along(demand, joint, inertia);
        let PhiSource::Typed { rate, jump } = &study.design.phi else { return along };
        Phi { rate_nm_s: rate[joint], jump_nm: jump[joint], ..along }
    };
    let search = PositionSearch::new(study, arm, &phi).map_err(|e| SessionError::at(path, e))?;
    let least = || PositionSearch::with_least_error(study, arm, &phi);
    let mut rounds = Rounds { study, path, motion: &motion, search, least: Some(&least) };
    let mut best = rounds.sought(vec![FIRST; study.robot.joints.len()], PARTS)?;
    let asked = best.as_ref().filter(|best| !best.rank.kept() && best.rank.error.is_finite());
    if let Some(coarse) = asked.filter(|_| divisible(study)) {
        let finer = rounds.sought(coarse.shares.clone(), FINER)?;
        // Finer slices bound the same laws by less.
        best = finer.filter(|finer| finer.rank.armed).or(best);
    }
    // Laws of which a claim is refused do not arm.
    let best = best.filter(|best| best.rank.armed);
    let Some(Best { rank, mut gains, parts, .. }) = best else {
        return Ok(Outcome::Infeasible(rounds.search.refused()));
    };
    // A tube whose steps are within the limits is that of the loop with them.
    let free = rank.loudest <= 1.0 || (0..gains.joints.len()).all(|i| study.limits(i).1.is_none());
    if !free {
        let desired = rounds.told(&gains)?;
        judge(study, &mut gains, (&desired, parts));
    }
    Ok(Outcome::Designed(Box::new(gains)))
}

/// Whether the payload can be divided.
fn divisible(study: &Study) -> bool {
    let set = &study.design.payload;
    let wide = |(low, high): (f64, f64)| high > low;
    set.mass.1 > 0.0 && (wide(set.mass) || set.com.into_iter().any(wide))
}

/// The best gains so far, and what they were looked for with.
struct Best {
    rank: Rank,
    gains: Gains,
    shares: Vec<f64>,
    parts: u32,
}

/// What every round needs.
struct Rounds<'a> {
    study: &'a Study,
    path: &'a Path,
    motion: &'a Told<'a>,
    search: PositionSearch<'a>,
    /// Another search, once, where no tube closes for laws of this one.
    least: Option<&'a dyn Fn() -> Result<PositionSearch<'a>, DesignError>>,
}

impl Rounds<'_> {
    fn told(&self, gains: &Gains) -> Result<Desired, SessionError> {
        self.motion.to(gains).map_err(|e| SessionError::at(self.path, e))
    }

    /// The best gains from these shares on, their tubes with the payload in so many slices.
    fn sought(&mut self, first: Vec<f64>, parts: u32) -> Result<Option<Best>, SessionError> {
        let mut shares = first;
        let mut best: Option<Best> = None;
        let (mut stuck, mut open) = (0, 0);
        let patience = if parts < FINER && divisible(self.study) { 1 } else { STUCK };
        // Where a limit can act there is no tube, and no figure to go by.
        let unlimited = without_rate_limits(self.study);
        for round in 0..ROUNDS {
            let Some((mut gains, _)) = self.search.laws(&shares) else { break };
            let certified = self.search.certify(&mut gains);
            certified.map_err(|e| SessionError::at(self.path, e))?;
            let desired = self.told(&gains)?;
            let judged = judge(&unlimited, &mut gains, (&desired, parts));
            let loudest = shares.iter().copied().largest();
            let armed = gains.certificate.as_ref().is_some_and(|all| all.refused().is_none());
            let (rank, next) = next(self.study, &gains, &judged, (&shares, loudest));
            let rank = Rank { armed, ..rank };
            let closed = |rank: &Rank| rank.error.is_finite();
            // Until a tube closes there is nothing to go by but what was tried.
            let first_open = matches!(judged, Judged::Open) || open > 0;
            if first_open && !closed(&rank) && best.as_ref().is_none_or(|best| !closed(&best.rank))
            {
                best.get_or_insert(Best { rank, gains, shares: shares.clone(), parts });
                let Some(factor) = OPEN.get(open) else { break };
                if open > 0
                    && let Some(least) = self.least.take()
                {
                    self.search = least().map_err(|e| SessionError::at(self.path, e))?;
                }
                open += 1;
                shares.fill((FIRST * factor).min(SHARES.1));
                continue;
            }
            let better = best.as_ref().is_none_or(|before| rank.beats(&before.rank, 0.0));
            let kept = best.as_ref().is_some_and(|before| before.rank.kept());
            let gained = best.as_ref().is_none_or(|before| rank.beats(&before.rank, 0.005));
            stuck = if gained { 0 } else { stuck + 1 };
            if better {
                best = Some(Best { rank, gains, shares: shares.clone(), parts });
            }
            // What keeps the specification and could be quieter is tried once more, not for ever.
            if (kept && !better) || stuck == patience || round + 1 == ROUNDS {
                break;
            }
            let Some(next) = next else { break };
            let moved = next.iter().zip(&shares).any(|(a, b)| (a / b - 1.0).abs() > 0.02);
            if !moved {
                break;
            }
            shares = next;
        }
        Ok(best)
    }
}

/// The study without limits of torque rate.
pub(crate) fn without_rate_limits(study: &Study) -> Study {
    let mut free = study.clone();
    free.control.torque_rate_max = None;
    free.interface.profile.torque_rate_max = None;
    free
}

/// How good gains are.
#[derive(Debug, Clone, Copy)]
struct Rank {
    /// Whether no claim is refused.
    armed: bool,
    /// The largest share of an error that is allowed; infinite without a tube.
    error: f64,
    /// The largest share of a change of torque that is allowed.
    loudest: f64,
    /// The largest share of the noise.
    noise: f64,
}

impl Rank {
    const UNKNOWN: Self =
        Self { armed: true, error: f64::INFINITY, loudest: f64::INFINITY, noise: f64::INFINITY };

    /// Whether the tube keeps every clause.
    fn kept(&self) -> bool {
        self.error <= 1.0 && self.loudest <= 1.0
    }

    /// What counts, the less the better, and how far it is gone: torque within its limits, then the error, then the noise.
    fn stage(&self) -> (u8, f64) {
        if !self.armed {
            (0, self.loudest)
        } else if self.kept() {
            (3, self.noise)
        } else if self.loudest <= 1.0 {
            (2, self.error)
        } else {
            (1, self.loudest)
        }
    }

    /// Whether it is better, by more than a share.
    fn beats(&self, other: &Self, share: f64) -> bool {
        let ((own, value), (theirs, others)) = (self.stage(), other.stage());
        own > theirs || (own == theirs && value < (1.0 - share) * others)
    }
}

/// How good the gains are, and the shares to try next; `None`: these are the last.
fn next(
    study: &Study,
    gains: &Gains,
    judged: &Judged,
    (shares, noise): (&[f64], f64),
) -> (Rank, Option<Vec<f64>>) {
    let to = |factor: &dyn Fn(usize) -> f64| -> Option<Vec<f64>> {
        let moved = shares.iter().enumerate();
        Some(moved.map(|(i, s)| (s * factor(i)).clamp(SHARES.0, SHARES.1)).collect())
    };
    let tube = gains.certificate.as_ref().and_then(|certificate| certificate.tube.as_ref());
    let errors = match judged {
        // Stiffer laws close a tube sooner.
        Judged::Open => return (Rank::UNKNOWN, to(&|_| 1.5)),
        Judged::Unknown => return (Rank::UNKNOWN, None),
        Judged::Kept(shares) | Judged::Beyond(shares) => shares,
    };
    let period = study.control.period_ns as f64 * 1e-9;
    let step = |i: usize| -> f64 {
        let Some(joint) = tube.map(|tube| &tube.joints[i]) else { return 0.0 };
        let allowed = study.design.torque_step_max.as_ref().map(|most| most[i]);
        let steady = allowed.map_or(0.0, |allowed| joint.torque_step_steady_max_nm / allowed);
        // A limit must not act from the start on.
        let limit = study.limits(i).1.map(|rate| rate * period);
        limit.map_or(steady, |limit| steady.max(joint.torque_step_max_nm / limit))
    };
    let steps: Vec<f64> = (0..shares.len()).map(step).collect();
    let most = |list: &[f64]| list.iter().copied().largest();
    let (error, loudest) = (most(errors), most(&steps));
    let rank = Rank { armed: true, error, loudest, noise };
    // All joints get stiffer where one has too much error, as far as each has room: they push each other.
    let needed = (1.03 * error).powf(1.0 / POWER);
    let factor = |i: usize| {
        let room = if steps[i] > 0.0 { ROOM / steps[i] } else { f64::INFINITY };
        if error > 1.0 {
            if room < 1.0 { room } else { needed.min(room) }
        } else if steps[i] > 1.0 {
            room
        } else if loudest <= 1.0 && error < ENOUGH {
            (error / ENOUGH.sqrt()).powf(1.0 / POWER).max(0.2)
        } else {
            1.0
        }
    };
    (rank, to(&factor))
}
