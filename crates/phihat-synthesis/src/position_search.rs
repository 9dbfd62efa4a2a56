//! Laws from positions whose tube keeps the specification: with the least share of the torque noise that is allowed.

use phihat_design::tube::{Desired, FINER, PARTS, tube_in_parts, tube_of_heaviest, tubes_behind};
use phihat_design::{Arm, DesignError, Gains, Outcome, Phi, PositionSearch};
use phihat_sim::Demand;
use phihat_study::{PhiSource, Study};

use crate::along::phi_along;
use crate::coarser::{encoders, told_of};
use crate::commanded::Commanded;
use crate::error::SynthesisError;
use crate::judged::{Judged, judge, judge_by, promised, without_rate_limits};
use crate::rank::{ROOM, Rank, SHARES, TubeFigures, next};
use crate::steps::Steps;
use crate::tube_parts::tube_parts;

/// Rounds of a search for laws, at most.
const ROUNDS: u32 = 7;

/// After so many in a row that gain nothing, it ends; where finer slices are to come, after one.
const STUCK: u32 = 2;

/// The encoder's share of the torque step that a study allows, at the start of a search. Other causes of a torque step
/// have the rest.
const FIRST: f64 = 0.6;

/// Factors on [`FIRST`] that are tried after a tube that does not close: stiffer laws mostly close one
/// sooner, but where the encoder widens it, softer ones do. After the first, all by the search for the least
/// error.
const OPEN: [f64; 5] = [1.5, 1.0, 1.5, 0.5, 0.25];

/// Rounds in which the tube over all payloads is computed for a law that satisfies the specification with the
/// heaviest, at most.
const CONFIRMED: u32 = 3;

/// Factor on the shares of noise with finer slices: their tube has less change of torque.
const FINER_ROOM: f64 = 1.12;

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
/// [`SynthesisError`] of the search.
pub(crate) fn by_positions(
    study: &Study,
    (arm, demand): (&Arm, &Demand),
    steps: Steps<'_>,
) -> Result<Outcome, SynthesisError> {
    let motion = Commanded::of(study)?;
    // For the search alone: the certificate of an arm with a description says nothing of φ.
    let phi = |joint: usize, inertia: f64| {
        let along = phi_along(demand, joint, inertia);
        let PhiSource::Typed { rate, jump } = &study.design.phi else { return along };
        Phi { rate_nm_s: rate[joint], jump_nm: jump[joint], ..along }
    };
    // Where a limit can act there is no tube, and no figure to go by.
    let unlimited = without_rate_limits(study);
    let search = PositionSearch::new(study, arm, &phi)?;
    let least = || PositionSearch::with_least_error(study, arm, &phi);
    let mut rounds = Rounds {
        study,
        unlimited: &unlimited,
        motion: &motion,
        search,
        least: Some(&least),
        thorough: false,
        beside: None,
        steps,
    };
    let joints = study.robot.joints.len();
    let mut best = rounds.best(&vec![FIRST; joints])?;
    let found = best.as_ref().filter(|best| study.design.innovation_filter && best.found.is_some());
    if let Some(plain) = found
        && let desired = rounds.desired(&plain.gains)?
        && let Some(parts) = tube_parts(&unlimited, &plain.gains, (&desired, plain.parts))
    {
        rounds.search.weigh(&plain.gains, &parts);
        rounds.search.filter();
        let filtered = rounds.best(&vec![ROOM; joints])?;
        best = filtered.filter(|own| own.rank.pays(&plain.rank)).or(best);
    }
    // Laws of which a claim is refused do not arm.
    let Some(BestGains { rank, mut gains, parts, .. }) = best.filter(|best| best.rank.armed) else {
        return Ok(Outcome::Infeasible(rounds.search.refused()));
    };
    // A tube whose steps are within the limits is that of the loop with them.
    let free = rank.loudest <= 1.0 || (0..gains.joints.len()).all(|i| study.limits(i).1.is_none());
    if !free {
        gains.coarser.clear();
        let desired = rounds.desired(&gains)?;
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
struct BestGains {
    rank: Rank,
    gains: Box<Gains>,
    shares: Vec<f64>,
    parts: u32,
    /// Shares of the next round of a search.
    next: Option<Vec<f64>>,
    /// Figures of each joint.
    found: Option<TubeFigures>,
    /// True if every claim was computed, and the tube over all payloads.
    whole: bool,
}

/// Data that every round needs.
struct Rounds<'a> {
    study: &'a Study,
    unlimited: &'a Study,
    motion: &'a Commanded<'a>,
    search: PositionSearch<'a>,
    /// Another search, once, where no tube closes for laws of this one.
    least: Option<&'a dyn Fn() -> Result<PositionSearch<'a>, DesignError>>,
    /// True if every claim is computed in every round.
    thorough: bool,
    /// By how much the tube over all payloads is wider than that of the heaviest.
    beside: Option<TubeFigures>,
    steps: Steps<'a>,
}

impl Rounds<'_> {
    /// The best laws of the search from these shares on, with every claim.
    fn best(&mut self, first: &[f64]) -> Result<Option<BestGains>, SynthesisError> {
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

    fn desired(&self, gains: &Gains) -> Result<Desired, SynthesisError> {
        Ok(self.motion.desired(gains)?)
    }

    fn certify(&self, gains: &mut Gains) -> Result<(), SynthesisError> {
        Ok(self.search.certify(gains)?)
    }

    /// The best gains from these shares on, confirmed, unless finer slices are to come.
    fn settled(&mut self, first: &[f64], parts: u32) -> Result<Option<BestGains>, SynthesisError> {
        let last = parts >= FINER || !divisible(self.study);
        let mut shares = first.to_vec();
        let mut sure: Option<BestGains> = None;
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
    fn confirmed(&mut self, mut best: BestGains) -> Result<BestGains, SynthesisError> {
        if best.whole {
            return Ok(best);
        }
        self.steps.begin("tube over all payloads of these laws")?;
        let (study, gains, parts) = (self.study, &mut best.gains, best.parts);
        self.certify(gains)?;
        let desired = self.desired(gains)?;
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
        let found = TubeFigures::of(study, tube, &judged);
        if let (Some(promised), Some(found)) = (&best.found, &found) {
            self.beside = Some(found.over(promised));
        }
        let (rank, next) = next(&judged, found.as_ref(), &best.shares);
        Ok(BestGains { rank: Rank { armed, ..rank }, next, found, whole: true, ..best })
    }

    /// Laws for shares, and what the tube of the heaviest payloads says of them; where it does not close, what all say.
    fn tried(
        &mut self,
        shares: &[f64],
        parts: u32,
    ) -> Result<Option<(BestGains, bool)>, SynthesisError> {
        self.steps.begin("laws from positions, and the tube of the heaviest payload")?;
        let Some((gains, _)) = self.search.laws(shares) else { return Ok(None) };
        let mut gains = Box::new(gains);
        if self.thorough {
            self.certify(&mut gains)?;
        }
        let armed = gains.certificate.as_ref().is_none_or(|all| all.refused().is_none());
        let desired = self.desired(&gains)?;
        let (mut judged, mut tube) = promised(self.unlimited, &gains, |own, gains| {
            tube_of_heaviest(own, gains, (&desired, parts))
        });
        if matches!(judged, Judged::Open) {
            (judged, tube) = promised(self.unlimited, &gains, |own, gains| {
                tube_in_parts(own, gains, (&desired, parts))
            });
        }
        let found = TubeFigures::of(self.study, tube.as_ref(), &judged);
        let expected = match (&found, &self.beside) {
            (Some(found), Some(beside)) => Some(found.times(beside)),
            _ => found.clone(),
        };
        let (rank, next) = next(&judged, expected.as_ref(), shares);
        let rank = Rank { armed, ..rank };
        let open = matches!(judged, Judged::Open);
        let shares = shares.to_vec();
        Ok(Some((BestGains { rank, gains, shares, parts, next, found, whole: false }, open)))
    }

    /// The best gains from these shares on, by the tubes of the heaviest of so many slices of the payload.
    fn sought(&mut self, first: Vec<f64>, parts: u32) -> Result<Option<BestGains>, SynthesisError> {
        let mut shares = first;
        let mut best: Option<BestGains> = None;
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
                    self.search = least()?;
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
