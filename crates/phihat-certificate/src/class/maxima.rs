//! Maxima over the class of torques and of their rates: drawn, then climbed from the best.

use phihat_model::{Model, Workspace};
use phihat_study::MotionClass;

use super::places::PostureDice;
use crate::extremes::larger;

/// Points that are drawn.
pub(super) const POINTS: usize = 1500;

/// Half the time over which a rate is a difference \[s\].
const MOMENT: f64 = 3e-5;

/// Passes over all signs and positions from the best of the points.
const PASSES: usize = 3;

/// Torques of the arm along motions of the class.
pub(super) struct ClassTorques<'a> {
    pub(super) class: &'a MotionClass,
    /// `M̄`.
    pub(super) nominal: &'a [f64],
    /// Torque that is fed forward in place of `M̄ q̈_d`; true: gravity alone, on top of it.
    pub(super) fed: Option<(&'a Model, bool)>,
    /// The arm whose torque of gravity the robot adds by itself.
    pub(super) added: Option<&'a Model>,
    /// Torque that the law starts with.
    pub(super) preset: &'a [f64],
}

/// Maxima per joint.
#[derive(Debug, Clone)]
pub(super) struct Maxima {
    /// Rate at constant acceleration; rate without the part in the acceleration.
    pub(super) whole: Vec<f64>,
    pub(super) slow: Vec<f64>,
    /// Rate of what is fed forward.
    pub(super) fed: Vec<f64>,
    /// Size of the torque of the motion, without friction.
    pub(super) torque: Vec<f64>,
    /// Size of the part in the acceleration, and its rate by the jerk.
    pub(super) size: Vec<f64>,
    pub(super) jerk: Vec<f64>,
    /// Torque of gravity that the start leaves.
    pub(super) start: Vec<f64>,
    /// Points looked at.
    pub(super) points: usize,
}

/// Velocity and acceleration of a joint that are tried, as shares of the largest.
const SIGNS: [(f64, f64); 6] =
    [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0), (0.0, 1.0), (0.0, -1.0)];

/// Kinds that depend on signs: whole, slow, fed, torque.
const KINDS: usize = 4;

/// A point of the class: posture, velocity, acceleration, and the index of the arm with its payload.
#[derive(Debug, Clone)]
struct ClassPoint {
    q: Vec<f64>,
    dq: Vec<f64>,
    ddq: Vec<f64>,
    case: usize,
}

/// Scratch memory of the arm, of what is fed forward, of what the robot adds.
type Rooms = (Workspace<f64>, Workspace<f64>, Workspace<f64>);

impl Maxima {
    /// Looks at points of the class, all of them corners of speed and acceleration, with every payload.
    pub(super) fn of(torques: &ClassTorques<'_>, models: &[Model], dice: &mut PostureDice) -> Self {
        let n = torques.nominal.len();
        let mut search = Search::new(torques, models);
        let mut best: Vec<Option<(f64, ClassPoint)>> = vec![None; KINDS * n];
        for k in 0..POINTS {
            let class = torques.class;
            let q = dice.place(class);
            let dq = class.speed.iter().map(|v| v * dice.sign()).collect();
            let ddq = class.acceleration.iter().map(|a| a * dice.sign()).collect();
            let point = ClassPoint { q, dq, ddq, case: k % models.len().max(1) };
            for (best, value) in best.iter_mut().zip(search.values(&point)) {
                if best.as_ref().is_none_or(|(most, _)| value.is_nan() || value > *most) {
                    *best = Some((value, point.clone()));
                }
            }
        }
        let climbed = |(which, found): (usize, Option<(f64, ClassPoint)>)| {
            found.map_or(f64::NAN, |(value, point)| search.climbed(which, value, point, dice))
        };
        let most: Vec<f64> = best.into_iter().enumerate().map(climbed).collect();
        let row = |kind: usize| most[kind * n..(kind + 1) * n].to_vec();
        let [size, jerk, fed_jerk, start] = search.inertial;
        let fed = row(2).iter().zip(fed_jerk).map(|(fed, jerk)| fed + jerk).collect();
        let (whole, slow, torque) = (row(0), row(1), row(3));
        Self { whole, slow, fed, torque, size, jerk, start, points: search.points }
    }
}

struct Search<'a> {
    torques: &'a ClassTorques<'a>,
    models: &'a [Model],
    rooms: Vec<Rooms>,
    /// Size and rate by the jerk of the part in the acceleration, rate by the jerk of what is fed, what a start leaves.
    inertial: [Vec<f64>; 4],
    points: usize,
}

impl<'a> Search<'a> {
    fn new(torques: &'a ClassTorques<'a>, models: &'a [Model]) -> Self {
        let room = |model: &Model| {
            let fed = torques.fed.map_or(model, |(fed, _)| fed);
            let bare = torques.added.unwrap_or(model);
            (Workspace::new(model), Workspace::new(fed), Workspace::new(bare))
        };
        let zero = || vec![0.0; torques.nominal.len()];
        let rooms = models.iter().map(room).collect();
        Self { torques, models, rooms, inertial: [zero(), zero(), zero(), zero()], points: 0 }
    }

    /// The four kinds at a point, joint by joint; what depends on the posture alone is collected.
    fn values(&mut self, point: &ClassPoint) -> Vec<f64> {
        let n = self.torques.nominal.len();
        let Some((model, rooms)) = self.models.get(point.case).zip(self.rooms.get_mut(point.case))
        else {
            return vec![f64::NAN; KINDS * n];
        };
        self.points += 1;
        let mut ends = |pushed: f64| {
            [MOMENT, -MOMENT].map(|t| {
                let at = |i: usize| point.q[i] + t * point.dq[i] + 0.5 * t * t * point.ddq[i];
                let place: Vec<f64> = (0..n).map(at).collect();
                let speed: Vec<f64> = (0..n).map(|i| point.dq[i] + t * point.ddq[i]).collect();
                let push: Vec<f64> = point.ddq.iter().map(|a| pushed * a).collect();
                self.torques.at(model, rooms, (&place, &speed, &push))
            })
        };
        let ([more, less], [slow_more, slow_less]) = (ends(1.0), ends(0.0));
        let rate = |a: f64, b: f64| ((a - b) / (2.0 * MOMENT)).abs();
        let left = |(tau, fed): &(Vec<f64>, Vec<f64>), i: usize| tau[i] - fed[i];
        let mut values = vec![0.0; KINDS * n];
        for i in 0..n {
            values[i] = rate(left(&more, i), left(&less, i));
            values[n + i] = rate(left(&slow_more, i), left(&slow_less, i));
            values[2 * n + i] = rate(more.1[i], less.1[i]);
            values[3 * n + i] = larger(more.0[i].abs(), less.0[i].abs());
        }
        self.posture(point);
        values
    }

    /// Of each joint at a posture: the part in the acceleration, and what the start leaves of gravity.
    fn posture(&mut self, point: &ClassPoint) {
        let (torques, n) = (self.torques, self.torques.nominal.len());
        let Some((model, rooms)) = self.models.get(point.case).zip(self.rooms.get_mut(point.case))
        else {
            return;
        };
        let rest = vec![0.0; n];
        let (base, fed_base) = torques.at(model, rooms, (&point.q, &rest, &rest));
        let mut sums = vec![[0.0; 4]; n];
        for ((sums, held), preset) in sums.iter_mut().zip(&base).zip(torques.preset) {
            sums[3] = (held - preset).abs();
        }
        for j in 0..n {
            let mut unit = vec![0.0; n];
            unit[j] = 1.0;
            let (tau, fed) = torques.at(model, rooms, (&point.q, &rest, &unit));
            for (i, sums) in sums.iter_mut().enumerate() {
                let fed = fed[i] - fed_base[i];
                let left = (tau[i] - base[i] - fed).abs();
                sums[0] += left * torques.class.acceleration[j];
                sums[1] += left * torques.class.jerk[j];
                sums[2] += fed.abs() * torques.class.jerk[j];
            }
        }
        for (i, sums) in sums.into_iter().enumerate() {
            for (most, sum) in self.inertial.iter_mut().zip(sums) {
                most[i] = larger(most[i], sum);
            }
        }
    }

    /// The largest value reached from a point: one sign, position or payload after the other, each change that raises
    /// it.
    fn climbed(
        &mut self,
        which: usize,
        mut value: f64,
        mut point: ClassPoint,
        dice: &mut PostureDice,
    ) -> f64 {
        let n = self.torques.nominal.len();
        for _ in 0..PASSES {
            let before = value;
            for i in 0..n {
                let (low, high) = (self.torques.class.low[i], self.torques.class.high[i]);
                let drawn = low + (high - low) * dice.share();
                let mut moved: Vec<ClassPoint> = Vec::new();
                for q in [low, high, drawn] {
                    let mut other = point.clone();
                    other.q[i] = q;
                    moved.push(other);
                }
                let (speed, push) =
                    (self.torques.class.speed[i], self.torques.class.acceleration[i]);
                for (dq, ddq) in SIGNS {
                    let mut other = point.clone();
                    (other.dq[i], other.ddq[i]) = (dq * speed, ddq * push);
                    moved.push(other);
                }
                for other in moved {
                    self.better(which, other, (&mut value, &mut point));
                }
            }
            for case in 0..self.models.len() {
                self.better(which, ClassPoint { case, ..point.clone() }, (&mut value, &mut point));
            }
            if value <= before * (1.0 + 1e-6) {
                break;
            }
        }
        value
    }

    fn better(
        &mut self,
        which: usize,
        other: ClassPoint,
        (value, point): (&mut f64, &mut ClassPoint),
    ) {
        let own = self.values(&other).get(which).copied().unwrap_or(f64::NAN);
        if own.is_nan() || own > *value {
            (*value, *point) = (own, other);
        }
    }
}

impl ClassTorques<'_> {
    /// Torque of a motion without friction, less what the robot adds, and of what is fed forward for it.
    fn at(
        &self,
        model: &Model,
        rooms: &mut Rooms,
        (q, dq, ddq): (&[f64], &[f64], &[f64]),
    ) -> (Vec<f64>, Vec<f64>) {
        let n = q.len();
        let mut tau = vec![0.0; n];
        model.inverse_dynamics(&mut rooms.0, q, dq, ddq, &mut tau);
        if let Some(bare) = self.added {
            let (rest, mut weight) = (vec![0.0; n], vec![0.0; n]);
            bare.bias(&mut rooms.2, q, &rest, &mut weight);
            tau.iter_mut().zip(weight).for_each(|(tau, added)| *tau -= added);
        }
        let mut fed: Vec<f64> = self.nominal.iter().zip(ddq).map(|(m, a)| m * a).collect();
        match self.fed {
            Some((own, true)) => {
                let (rest, mut still) = (vec![0.0; n], vec![0.0; n]);
                own.bias(&mut rooms.1, q, &rest, &mut still);
                fed.iter_mut().zip(still).for_each(|(fed, g)| *fed += g);
            }
            Some((own, false)) => own.inverse_dynamics(&mut rooms.1, q, dq, ddq, &mut fed),
            None => {}
        }
        (tau, fed)
    }
}
