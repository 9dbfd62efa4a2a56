//! Laws from positions whose tube keeps the specification: with the least share of the torque noise that is allowed.

use std::path::Path;

use phihat_certificate::extremes::Extremes as _;
use phihat_design::tube::{Desired, FINER, PARTS, tube_in_parts, tube_of_heaviest, tubes_behind};
use phihat_design::{Arm, DesignError, Gains, Outcome, Phi, PositionSearch, Tube};
use phihat_sim::Demand;
use phihat_study::{PhiSource, Study};

use crate::along::phi_along;
use crate::coarser::{encoders, told_of};
use crate::error::SessionError;
use crate::judged::{
    Judged, SETTLED_S, judge, judge_by, late_error, promised, without_rate_limits,
};
use crate::told::Told;
use crate::tube_parts::tube_parts;

/// Rounds of a search for laws, at most.
const ROUNDS: u32 = 7;

/// After so many in a row that gain nothing, it ends; where finer slices are to come, after one.
const STUCK: u32 = 2;

/// The encoder's share of the torque step that a study allows: start of a search, and its limits. Other
/// causes of a torque step have the rest.
const FIRST: f64 = 0.6;
const SHARES: (f64, f64) = (0.01, 1.0);

/// Factors on [`FIRST`] that are tried after a tube that does not close: stiffer laws mostly close one
/// sooner, but where the encoder widens it, softer ones do. After the first, all by the search for the least
/// error.
const OPEN: [f64; 5] = [1.5, 1.0, 1.5, 0.5, 0.25];

/// The error of a law falls by about this power of its noise.
const POWER: f64 = 0.4;

/// The change of torque of a tube falls by about this power of the encoder's share: its other causes fall
/// less.
const STEP_POWER: f64 = 0.95;

/// Rounds in which the tube over all payloads is computed for a law that satisfies the specification with the
/// heaviest, at most.
const CONFIRMED: u32 = 3;

/// Factor on the shares of noise with finer slices: their tube has less change of torque.
const FINER_ROOM: f64 = 1.12;

/// Share of the allowed torque step that a search aims at.
const ROOM: f64 = 0.97;

/// A tube that uses less of the specification than this leaves room for less noise.
const ENOUGH: f64 = 0.85;

/// Designs for a study until the tube satisfies the specification; where no tube does, once more with the
/// payload in finer slices.
///
/// # Method
///
/// Laws are searched by the tube over the heaviest payloads; that over all of them, and every other claim, is
/// computed for the laws that are taken. Where it is wider than with the heaviest, the search goes on with
/// its figures. Where laws may filter their innovation, they are searched a second time, and those are taken
/// whose tube is better.
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
    // Where a limit can act there is no tube, and no figure to go by.
    let unlimited = without_rate_limits(study);
    let search = PositionSearch::new(study, arm, &phi).map_err(|e| SessionError::at(path, e))?;
    let least = || PositionSearch::with_least_error(study, arm, &phi);
    let mut rounds = Rounds {
        study,
        unlimited: &unlimited,
        path,
        motion: &motion,
        search,
        least: Some(&least),
        thorough: false,
        beside: None,
    };
    let joints = study.robot.joints.len();
    let mut best = rounds.best(&vec![FIRST; joints])?;
    let found = best.as_ref().filter(|best| study.design.innovation_filter && best.found.is_some());
    if let Some(plain) = found
        && let told = rounds.told(&plain.gains)?
        && let Some(parts) = tube_parts(&unlimited, &plain.gains, (&told, plain.parts))
    {
        rounds.search.weigh(&plain.gains, &parts);
        rounds.search.filter();
        let filtered = rounds.best(&vec![ROOM; joints])?;
        best = filtered.filter(|own| own.rank.pays(&plain.rank)).or(best);
    }
    // Laws of which a claim is refused do not arm.
    let Some(Best { rank, mut gains, parts, .. }) = best.filter(|best| best.rank.armed) else {
        return Ok(Outcome::Infeasible(rounds.search.refused()));
    };
    // A tube whose steps are within the limits is that of the loop with them.
    let free = rank.loudest <= 1.0 || (0..gains.joints.len()).all(|i| study.limits(i).1.is_none());
    if !free {
        gains.coarser.clear();
        let desired = rounds.told(&gains)?;
        judge(study, &mut gains, (&desired, parts));
    }
    Ok(Outcome::Designed(gains))
}

/// Returns true if the payload can be divided.
fn divisible(study: &Study) -> bool {
    let set = &study.design.payload;
    let wide = |(low, high): (f64, f64)| high > low;
    set.mass.1 > 0.0 && (wide(set.mass) || set.com.into_iter().any(wide))
}

/// The best gains so far, and what they were looked for with.
struct Best {
    rank: Rank,
    gains: Box<Gains>,
    shares: Vec<f64>,
    parts: u32,
    /// Shares of the next round of a search.
    next: Option<Vec<f64>>,
    /// Figures of each joint.
    found: Option<Figures>,
    /// True if every claim was computed, and the tube over all payloads.
    whole: bool,
}

/// Data that every round needs.
struct Rounds<'a> {
    study: &'a Study,
    unlimited: &'a Study,
    path: &'a Path,
    motion: &'a Told<'a>,
    search: PositionSearch<'a>,
    /// Another search, once, where no tube closes for laws of this one.
    least: Option<&'a dyn Fn() -> Result<PositionSearch<'a>, DesignError>>,
    /// True if every claim is computed in every round.
    thorough: bool,
    /// By how much the tube over all payloads is wider than that of the heaviest.
    beside: Option<Figures>,
}

impl Rounds<'_> {
    /// The best laws of the search from these shares on, with every claim.
    fn best(&mut self, first: &[f64]) -> Result<Option<Best>, SessionError> {
        let study = self.study;
        let mut best = self.settled(first, PARTS)?;
        let asked = best.as_ref().filter(|best| !best.rank.kept() && best.rank.error.is_finite());
        if let Some(coarse) = asked.filter(|_| divisible(study)) {
            let first = coarse.next.as_ref().unwrap_or(&coarse.shares).iter();
            let first: Vec<f64> = first.map(|s| (FINER_ROOM * s).min(SHARES.1)).collect();
            let finer = self.settled(&first, FINER)?;
            // Finer slices bound the same laws by less.
            best = finer.filter(|finer| finer.rank.armed).or(best);
        }
        best.map(|best| self.confirmed(best)).transpose()
    }

    fn told(&self, gains: &Gains) -> Result<Desired, SessionError> {
        self.motion.to(gains).map_err(|e| SessionError::at(self.path, e))
    }

    fn certify(&self, gains: &mut Gains) -> Result<(), SessionError> {
        self.search.certify(gains).map_err(|e| SessionError::at(self.path, e))
    }

    /// The best gains from these shares on, confirmed, unless finer slices are to come.
    fn settled(&mut self, first: &[f64], parts: u32) -> Result<Option<Best>, SessionError> {
        let last = parts >= FINER || !divisible(self.study);
        let mut shares = first.to_vec();
        let mut sure: Option<Best> = None;
        self.beside = None;
        for _ in 0..CONFIRMED {
            let Some(found) = self.sought(shares.clone(), parts)? else { break };
            let promised = found.rank.kept();
            if !last && !promised {
                return Ok(Some(sure.unwrap_or(found)));
            }
            let whole = self.confirmed(found)?;
            if !whole.rank.armed && !self.thorough {
                self.thorough = true;
                shares = first.to_vec();
                continue;
            }
            let (done, next) = (whole.rank.kept() || !promised, whole.next.clone());
            if sure.as_ref().is_none_or(|before| whole.rank.beats(&before.rank, 0.0)) {
                sure = Some(whole);
            }
            let Some(next) = next.filter(|_| !done) else { break };
            shares = next;
        }
        Ok(sure)
    }

    /// The same gains with every claim, their tube over all payloads, and those behind coarser encoders.
    fn confirmed(&mut self, mut best: Best) -> Result<Best, SessionError> {
        if best.whole {
            return Ok(best);
        }
        let (study, gains, parts) = (self.study, &mut best.gains, best.parts);
        self.certify(gains)?;
        let desired = self.told(gains)?;
        let bits = self.study.sensor.encoder_bits.as_ref();
        let mut coarser = Vec::new();
        let judged = judge_by(self.unlimited, gains, |own, gains| {
            let Some(bits) = bits else { return tube_in_parts(own, gains, (&desired, parts)) };
            let mut all = vec![bits.clone()];
            all.extend(encoders(bits));
            let mut tubes = tubes_behind(own, gains, (&desired, parts), &all)?;
            coarser = tubes.split_off(1);
            tubes.pop().unwrap_or_else(|| tube_in_parts(own, gains, (&desired, parts)))
        });
        let certificate = gains.certificate.as_ref();
        let armed = certificate.is_some_and(|all| all.refused().is_none());
        let settle = certificate.and_then(|all| all.tube.as_ref().and(all.settle.as_ref()));
        if let Some(settle) = settle {
            gains.coarser = told_of(study, settle.settle_s, coarser);
        }
        let tube = gains.certificate.as_ref().and_then(|all| all.tube.as_ref());
        let found = Figures::of(study, tube, &judged);
        if let (Some(promised), Some(found)) = (&best.found, &found) {
            self.beside = Some(found.over(promised));
        }
        let (rank, next) = next(&judged, found.as_ref(), &best.shares);
        Ok(Best { rank: Rank { armed, ..rank }, next, found, whole: true, ..best })
    }

    /// Laws for shares, and what the tube of the heaviest payloads says of them; where it does not close, what all say.
    fn tried(&mut self, shares: &[f64], parts: u32) -> Result<Option<(Best, bool)>, SessionError> {
        let Some((gains, _)) = self.search.laws(shares) else { return Ok(None) };
        let mut gains = Box::new(gains);
        if self.thorough {
            self.certify(&mut gains)?;
        }
        let armed = gains.certificate.as_ref().is_none_or(|all| all.refused().is_none());
        let desired = self.told(&gains)?;
        let (mut judged, mut tube) = promised(self.unlimited, &gains, |own, gains| {
            tube_of_heaviest(own, gains, (&desired, parts))
        });
        if matches!(judged, Judged::Open) {
            (judged, tube) = promised(self.unlimited, &gains, |own, gains| {
                tube_in_parts(own, gains, (&desired, parts))
            });
        }
        let found = Figures::of(self.study, tube.as_ref(), &judged);
        let expected = match (&found, &self.beside) {
            (Some(found), Some(beside)) => Some(found.times(beside)),
            _ => found.clone(),
        };
        let (rank, next) = next(&judged, expected.as_ref(), shares);
        let rank = Rank { armed, ..rank };
        let open = matches!(judged, Judged::Open);
        let shares = shares.to_vec();
        Ok(Some((Best { rank, gains, shares, parts, next, found, whole: false }, open)))
    }

    /// The best gains from these shares on, by the tubes of the heaviest of so many slices of the payload.
    fn sought(&mut self, first: Vec<f64>, parts: u32) -> Result<Option<Best>, SessionError> {
        let mut shares = first;
        let mut best: Option<Best> = None;
        let (mut stuck, mut open) = (0, 0);
        let finer = parts < FINER && divisible(self.study);
        let patience = if finer { 1 } else { STUCK };
        for round in 0..ROUNDS {
            let Some((tried, opened)) = self.tried(&shares, parts)? else { break };
            let rank = tried.rank;
            let closed = |rank: &Rank| rank.error.is_finite();
            // Until a tube closes there is nothing to go by but what was tried.
            let first_open = opened || open > 0;
            if first_open && !closed(&rank) && best.as_ref().is_none_or(|best| !closed(&best.rank))
            {
                best.get_or_insert(tried);
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
            let next = tried.next.clone();
            if better {
                best = Some(tried);
            }
            // Laws that satisfy the specification and could have less noise are tried once more, not for
            // ever; too large torque steps with too much error need finer slices.
            let beyond = finer && rank.error > 1.0 && rank.loudest > 1.0;
            if (kept && !better) || stuck == patience || round + 1 == ROUNDS || beyond {
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

/// Figures of each joint by a tube: its error and its change of torque, over their allowed values.
#[derive(Debug, Clone)]
struct Figures {
    errors: Vec<f64>,
    steps: Vec<f64>,
}

impl Figures {
    /// `None` where there is no tube.
    fn of(study: &Study, tube: Option<&Tube>, judged: &Judged) -> Option<Self> {
        let (Judged::Kept(errors) | Judged::Beyond(errors)) = judged else { return None };
        let period = study.control.period_ns as f64 * 1e-9;
        let step = |i: usize| -> f64 {
            let Some(joint) = tube.map(|tube| &tube.joints[i]) else { return 0.0 };
            let allowed = study.design.torque_step_max.as_ref().map(|most| most[i]);
            let steady = allowed.map_or(0.0, |allowed| joint.torque_step_steady_max_nm / allowed);
            // A limit must not act from the start on.
            let limit = study.limits(i).1.map(|rate| rate * period);
            limit.map_or(steady, |limit| steady.max(joint.torque_step_max_nm / limit))
        };
        let steps = (0..errors.len()).map(step).collect();
        let mut errors = errors.clone();
        // Where the time to settle is what the tube says, an error that is kept at the very end is none that is kept.
        let asked = tube.filter(|_| !study.spec.settle_stated).zip(study.spec.error_bound.as_ref());
        if let Some((tube, allowed)) = asked {
            let from = SETTLED_S.min(0.5 * study.duration);
            for ((error, joint), allowed) in errors.iter_mut().zip(&tube.joints).zip(allowed) {
                *error = error.max(late_error(tube.bin_s, joint, from) / allowed);
            }
        }
        Some(Self { errors, steps })
    }

    /// Figure by figure; 1 where one is of nothing.
    fn over(&self, other: &Self) -> Self {
        let ratio = |(a, b): (&f64, &f64)| if *b > 0.0 { a / b } else { 1.0 };
        Self {
            errors: self.errors.iter().zip(&other.errors).map(ratio).collect(),
            steps: self.steps.iter().zip(&other.steps).map(ratio).collect(),
        }
    }

    fn times(&self, other: &Self) -> Self {
        let product = |(a, b): (&f64, &f64)| a * b;
        Self {
            errors: self.errors.iter().zip(&other.errors).map(product).collect(),
            steps: self.steps.iter().zip(&other.steps).map(product).collect(),
        }
    }
}

/// Rank of gains.
#[derive(Debug, Clone, Copy)]
struct Rank {
    /// True if no claim is refused.
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

    /// Returns true if the tube satisfies every clause.
    fn kept(&self) -> bool {
        self.error <= 1.0 && self.loudest <= 1.0
    }

    /// Stage of a search, and its figure, the smaller the better: torque within its limits, then the error,
    /// then the noise.
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

    /// Returns true if laws of one kind are better than those of another, whose shares of the noise have
    /// another reference.
    fn pays(&self, other: &Self) -> bool {
        if self.armed && self.kept() && other.kept() {
            self.loudest < other.loudest
        } else {
            self.beats(other, 0.0)
        }
    }

    /// Returns true if it is better, by more than a share.
    fn beats(&self, other: &Self, share: f64) -> bool {
        let ((own, value), (theirs, others)) = (self.stage(), other.stage());
        own > theirs || (own == theirs && value < (1.0 - share) * others)
    }
}

/// Rank of gains, and the shares to try next; `None`: these are the last.
fn next(judged: &Judged, found: Option<&Figures>, shares: &[f64]) -> (Rank, Option<Vec<f64>>) {
    let to = |factor: &dyn Fn(usize) -> f64| -> Option<Vec<f64>> {
        let moved = shares.iter().enumerate();
        Some(moved.map(|(i, s)| (s * factor(i)).clamp(SHARES.0, SHARES.1)).collect())
    };
    let Some(Figures { errors, steps }) = found else {
        // Stiffer laws close a tube sooner.
        let open = matches!(judged, Judged::Open);
        return (Rank::UNKNOWN, if open { to(&|_| 1.5) } else { None });
    };
    let most = |list: &[f64]| list.iter().copied().largest();
    let (error, loudest) = (most(errors), most(steps));
    let rank = Rank { armed: true, error, loudest, noise: most(shares) };
    // All joints get stiffer where one has too much error, as far as each has room: they push each other.
    let needed = (1.03 * error).powf(1.0 / POWER);
    let factor = |i: usize| {
        let room = if steps[i] > 0.0 { ROOM / steps[i] } else { f64::INFINITY };
        let softer = room.powf(1.0 / STEP_POWER);
        if error > 1.0 {
            if room < 1.0 { softer } else { needed.min(room) }
        } else if steps[i] > 1.0 {
            softer
        } else if loudest <= 1.0 && error < ENOUGH {
            (error / ENOUGH.sqrt()).powf(1.0 / POWER).max(0.2)
        } else {
            1.0
        }
    };
    (rank, to(&factor))
}
