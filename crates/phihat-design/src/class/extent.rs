//! Maxima over class, box and payloads: rates of the unknown torque, second derivatives of the dynamics.

use phihat_certificate::extremes::larger;
use phihat_model::evenly;

use super::scene::{ClassScene, Room};
use super::slopes::{Bends, Posed, Slopes};

/// Points of box and signs at which a search looks first, with every payload together.
const POINTS: u32 = 1200;

/// Passes over all coordinates of a search that goes on from the best of them.
const PASSES: u32 = 3;

/// Postures at which second derivatives are looked at, with every payload together.
const BENT: u32 = 96;

/// Factor on entries that are maxima over postures without a search that goes on.
const MARGIN: f64 = 1.1;

/// Half the time over which a rate is a difference \[s\].
const MOMENT: f64 = 1e-5;

/// Largest speed, acceleration and jerk per joint.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ClassPaceLimits {
    pub(super) v: Vec<f64>,
    pub(super) a: Vec<f64>,
    pub(super) j: Vec<f64>,
}

impl ClassPaceLimits {
    /// The pace of a class.
    pub(super) fn of(class: &phihat_study::MotionClass) -> Self {
        Self { v: class.speed.clone(), a: class.acceleration.clone(), j: class.jerk.clone() }
    }
}

/// Maxima per joint that depend on speed, acceleration and jerk.
#[derive(Debug, Clone)]
pub(super) struct Rates {
    /// Rate of the unknown torque at constant `q̈_d` \[N·m/s\].
    pub(super) whole: Vec<f64>,
    /// Rate of the unknown torque without its part in `q̈_d` \[N·m/s\].
    pub(super) slow: Vec<f64>,
    /// Size of that part \[N·m\].
    pub(super) size: Vec<f64>,
    /// Rate of that part by the jerk \[N·m/s\].
    pub(super) jerk: Vec<f64>,
    /// Rate of what is fed forward, `M̄ q̈_d` included \[N·m/s\].
    pub(super) fed: Vec<f64>,
    /// Size of the torque of the motion, friction aside \[N·m\].
    pub(super) torque: Vec<f64>,
    /// Points looked at.
    pub(super) points: u32,
}

/// Kinds of [`Rates`] that depend on signs: whole, slow, fed, torque.
const KINDS: usize = 4;

/// A place of the class: posture, signs of velocity and acceleration, payload.
#[derive(Debug, Clone)]
struct ClassPlace {
    q: Vec<f64>,
    dq: Vec<f64>,
    ddq: Vec<f64>,
    case: usize,
}

impl Rates {
    /// Searches box, signs and payloads.
    pub(super) fn of(scene: &ClassScene<'_>, pace: &ClassPaceLimits) -> Self {
        let n = scene.n;
        let mut search = ExtentSearch::new(scene, pace);
        let mut best: Vec<Option<(f64, ClassPlace)>> = vec![None; KINDS * n];
        let share = POINTS / u32::try_from(scene.cases.len()).unwrap_or(1).max(1);
        // Box, and the sign of each velocity and acceleration, evenly together.
        let mut ends: Vec<(f64, f64)> = scene.ends();
        ends.extend(core::iter::repeat_n((-1.0, 1.0), 2 * n));
        for case in 0..scene.cases.len() {
            for (k, at) in evenly(&ends, share.max(40)).enumerate() {
                let sign = |x: f64, most: f64| if x < 0.0 { -most } else { most };
                let corner = k % 3 == 0;
                let q = (0..n).map(|i| {
                    let (low, high) = ends[i];
                    let middle = 0.5 * (low + high);
                    if corner { if at[i] < middle { low } else { high } } else { at[i] }
                });
                let place = ClassPlace {
                    q: q.collect(),
                    dq: (0..n).map(|i| sign(at[n + i], pace.v[i])).collect(),
                    ddq: (0..n).map(|i| sign(at[2 * n + i], pace.a[i])).collect(),
                    case,
                };
                let values = search.values(&place);
                for (best, value) in best.iter_mut().zip(values) {
                    if best.as_ref().is_none_or(|(most, _)| value > *most) {
                        *best = Some((value, place.clone()));
                    }
                }
            }
        }
        let mut most = Vec::with_capacity(KINDS * n);
        for (which, found) in best.into_iter().enumerate() {
            let Some((value, place)) = found else { continue };
            most.push(search.climbed(which, value, place));
        }
        let row = |kind: usize| most[kind * n..(kind + 1) * n].to_vec();
        let inertial = search.inertial.clone();
        let (size, jerk, fed_jerk) = (&inertial[..n], &inertial[n..2 * n], &inertial[2 * n..]);
        Self {
            whole: row(0),
            slow: row(1),
            size: size.to_vec(),
            jerk: jerk.to_vec(),
            fed: row(2).iter().zip(fed_jerk).map(|(a, b)| a + b).collect(),
            torque: row(3),
            points: search.points,
        }
    }
}

/// Scratch memory of a search for maxima.
struct ExtentSearch<'a> {
    scene: &'a ClassScene<'a>,
    pace: &'a ClassPaceLimits,
    rooms: Vec<Room>,
    /// Maxima of what depends on the posture alone: size, rate by the jerk, rate by the jerk of what is fed.
    inertial: Vec<f64>,
    points: u32,
}

impl<'a> ExtentSearch<'a> {
    fn new(scene: &'a ClassScene<'a>, pace: &'a ClassPaceLimits) -> Self {
        let rooms = scene.cases.iter().map(|case| scene.room(case)).collect();
        Self { scene, pace, rooms, inertial: vec![0.0; 3 * scene.n], points: 0 }
    }

    /// The four kinds at a place, joint by joint; what depends on the posture alone is collected.
    fn values(&mut self, place: &ClassPlace) -> Vec<f64> {
        self.points += 1;
        let (scene, n) = (self.scene, self.scene.n);
        let case = &scene.cases[place.case];
        let room = &mut self.rooms[place.case];
        let zero = vec![0.0; n];
        let moved = |x: &[f64], dx: &[f64], sign: f64| -> Vec<f64> {
            x.iter().zip(dx).map(|(x, dx)| x + sign * MOMENT * dx).collect()
        };
        let mut ends = [
            [vec![0.0; n], vec![0.0; n], vec![0.0; n]],
            [vec![0.0; n], vec![0.0; n], vec![0.0; n]],
        ];
        for (end, sign) in ends.iter_mut().zip([1.0, -1.0]) {
            let (q, dq) = (moved(&place.q, &place.dq, sign), moved(&place.dq, &place.ddq, sign));
            scene.unknown(case, room, (&q, &dq, &place.ddq), &mut end[0]);
            scene.unknown(case, room, (&q, &dq, &zero), &mut end[1]);
            scene.commanded(case, room, (&q, &dq, &place.ddq), &mut end[2]);
        }
        let rate = |kind: usize, i: usize| (ends[0][kind][i] - ends[1][kind][i]) / (2.0 * MOMENT);
        let mut values = vec![0.0; KINDS * n];
        for i in 0..n {
            values[i] = rate(0, i).abs();
            values[n + i] = rate(1, i).abs();
            values[2 * n + i] = (rate(2, i) - rate(0, i)).abs();
            values[3 * n + i] = larger(ends[0][2][i].abs(), ends[1][2][i].abs());
        }
        self.inertial_at(place);
        values
    }

    fn inertial_at(&mut self, place: &ClassPlace) {
        let (scene, n) = (self.scene, self.scene.n);
        let case = &scene.cases[place.case];
        let room = &mut self.rooms[place.case];
        let zero = vec![0.0; n];
        let (mut base, mut column) = (vec![0.0; n], vec![0.0; n]);
        let mut unit = zero.clone();
        let mut mass = vec![0.0; n * n];
        case.model.mass_matrix(&mut room.arm, &place.q, &mut mass);
        scene.unknown(case, room, (&place.q, &zero, &zero), &mut base);
        let mut sums = vec![0.0; 3 * n];
        for j in 0..n {
            unit[j] = 1.0;
            scene.unknown(case, room, (&place.q, &zero, &unit), &mut column);
            unit[j] = 0.0;
            for i in 0..n {
                let left = column[i] - base[i];
                sums[i] += left.abs() * self.pace.a[j];
                sums[n + i] += left.abs() * self.pace.j[j];
                sums[2 * n + i] += (mass[i * n + j] - left).abs() * self.pace.j[j];
            }
        }
        for (most, sum) in self.inertial.iter_mut().zip(sums) {
            *most = larger(*most, sum);
        }
    }

    /// The largest value that coordinate ascent from a place reaches.
    fn climbed(&mut self, which: usize, mut value: f64, mut place: ClassPlace) -> f64 {
        let (n, ends) = (self.scene.n, self.scene.ends());
        let mut step = 0.5;
        for _ in 0..PASSES {
            let before = value;
            for k in 0..3 * n {
                let i = k % n;
                let candidates: Vec<ClassPlace> = match k / n {
                    0 => {
                        let (low, high) = ends[i];
                        let width = step * (high - low);
                        let at = place.q[i];
                        let moves = [low, high, (at + width).min(high), (at - width).max(low)];
                        moves
                            .map(|q| {
                                let mut p = place.clone();
                                p.q[i] = q;
                                p
                            })
                            .to_vec()
                    }
                    1 => [-place.dq[i], 0.0]
                        .map(|x| {
                            let mut p = place.clone();
                            p.dq[i] = x;
                            p
                        })
                        .to_vec(),
                    _ => {
                        let mut p = place.clone();
                        p.ddq[i] = -p.ddq[i];
                        vec![p]
                    }
                };
                for candidate in candidates {
                    let own = self.values(&candidate)[which];
                    if own > value {
                        (value, place) = (own, candidate);
                    }
                }
            }
            step *= 0.5;
            if value <= before * (1.0 + 1e-6) && step < 0.2 {
                break;
            }
        }
        value
    }
}

impl ClassScene<'_> {
    /// Ends of the box.
    pub(super) fn ends(&self) -> Vec<(f64, f64)> {
        self.class.low.iter().copied().zip(self.class.high.iter().copied()).collect()
    }
}

/// Maxima of derivatives of the dynamics over box and payloads, entry by entry, with a margin.
#[derive(Debug, Clone)]
pub(super) struct Bent {
    pub(super) n: usize,
    /// `|∂_c M|`.
    pub(super) mass: Vec<Vec<f64>>,
    /// `|∂_c M − D_c|`.
    pub(super) less: Vec<Vec<f64>>,
    /// `|D_c|`.
    pub(super) coriolis: Vec<Vec<f64>>,
    /// `|∂_b ∂_c M|`, `|∂_b (2 ∂_c M − D_c)|`, `|∂_b (∂_c M − D_c)|`, `|∂_b D_c|`, at `c n + b`.
    pub(super) second: [Vec<Vec<f64>>; 4],
    /// `|∂_b ∂g/∂q|`.
    pub(super) gravity: Vec<Vec<f64>>,
    /// `|∂g/∂q|` of the arm whose gravity the robot adds; 0 where it adds none.
    pub(super) added: Vec<f64>,
    pub(super) postures: u32,
}

impl Bent {
    /// Looks at postures of the box, a little wider than it, with every payload.
    pub(super) fn of(scene: &ClassScene<'_>) -> Self {
        let n = scene.n;
        let zero = |count: usize| vec![vec![0.0; n * n]; count];
        let mut own = Self {
            n,
            mass: zero(n),
            less: zero(n),
            coriolis: zero(n),
            second: [zero(n * n), zero(n * n), zero(n * n), zero(n * n)],
            gravity: zero(n),
            added: vec![0.0; n * n],
            postures: 0,
        };
        // Rotors change no derivative: cases differ in it by payload alone.
        let share = (BENT / u32::try_from(scene.cases.len()).unwrap_or(1).max(1)).max(12);
        let ends = scene.ends();
        let mut bare = scene.added.as_ref().map(|bare| Posed::of(bare, None, n));
        for case in &scene.cases {
            let mut arm = scene.posed(case);
            for (k, mut q) in evenly(&ends, share).enumerate() {
                if k % 2 == 0 {
                    for (q, (low, high)) in q.iter_mut().zip(&ends) {
                        *q = if *q < 0.5 * (low + high) { *low } else { *high };
                    }
                }
                own.take(&mut arm, &q);
                if let Some(bare) = &mut bare {
                    let slopes = bare.gravity_slopes(&q);
                    own.added
                        .iter_mut()
                        .zip(slopes)
                        .for_each(|(most, x)| *most = larger(*most, x.abs()));
                }
            }
        }
        own.added.iter_mut().for_each(|entry| *entry *= MARGIN);
        let lists = [&mut own.mass, &mut own.less, &mut own.coriolis, &mut own.gravity];
        let all = lists.into_iter().chain(&mut own.second);
        all.flatten().flatten().for_each(|entry| *entry *= MARGIN);
        own
    }

    fn take(&mut self, arm: &mut Posed<'_>, q: &[f64]) {
        let n = self.n;
        self.postures += 1;
        let slopes = Slopes::at(arm, q);
        let bends = Bends::at(arm, q);
        let most = |into: &mut [f64], of: &dyn Fn(usize) -> f64| {
            for (k, into) in into.iter_mut().enumerate() {
                *into = larger(*into, of(k).abs());
            }
        };
        for c in 0..n {
            let (dm, coriolis) = (&slopes.dm[c], slopes.coriolis(c));
            most(&mut self.mass[c], &|k| dm[k]);
            most(&mut self.less[c], &|k| dm[k] - coriolis[k]);
            most(&mut self.coriolis[c], &|k| coriolis[k]);
            most(&mut self.gravity[c], &|k| bends.gravity[c][k]);
            for b in 0..n {
                let (m, d) = (&bends.ddm[b][c], &bends.coriolis[b][c]);
                let [mass, twice, once, own] = &mut self.second;
                most(&mut mass[c * n + b], &|k| m[k]);
                most(&mut twice[c * n + b], &|k| 2.0 * m[k] - d[k]);
                most(&mut once[c * n + b], &|k| m[k] - d[k]);
                most(&mut own[c * n + b], &|k| d[k]);
            }
        }
    }
}
