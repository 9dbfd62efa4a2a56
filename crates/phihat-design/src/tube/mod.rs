//! The tube: an envelope of `e`, `ė` from the start of a run, which no run in scope leaves.
//!
//! See `docs/theory.md`, "The tube". [`find`] simulates the study's loop with the middle of every interval, makes
//! the loop linear around that run, and finds bounds on the deviation `ε` that one evaluation of the causal sums
//! confirms.
//!
//! # Not claimed
//!
//! What the linear loop lacks: [`TubeRefusal::Unsupported`] names it, and there is no tube.

mod basis;
mod controller;
mod deviation;
mod document;
mod kernel;
mod lanes;
mod linear;
mod nominal;
mod scene;
mod sweep;
mod tensors;

use phihat_study::Study;
use thiserror::Error;

use basis::Slice;
use deviation::Deviation;
pub use document::tube;
use kernel::{Course, Scale};
use lanes::WIDE;
use linear::{Differences, Interval, middle};
use nominal::Nominal;
use phihat_certificate::Gains;
use phihat_certificate::extremes::{hull, larger, smaller};
use scene::{Scene, centre};
use sweep::{Along, Bin, Group, Segment, Shape, Sweep};
use tensors::Looked;

/// Length of a bin \[s\].
const BIN: f64 = 0.005;

/// Length of a group of bins that share a launch \[s\]: a share of what the loop remembers, between two ends.
const GROUP: (f64, f64) = (0.04, 0.16);
const GROUPS_REMEMBERED: f64 = 16.0;

/// Second derivatives are looked at so often \[s\].
const LOOK: f64 = 0.04;

/// A loop has forgotten when its state is below this share of its peak.
const FORGOTTEN: f64 = 1e-3;

/// The narrowest slice of the payload's mass that is tried, as a share of the interval.
const NARROWEST: f64 = 1.0 / 8.0;

/// The motion at every sample, rows of `n`.
#[derive(Debug, Clone, PartialEq)]
pub struct Desired {
    /// `q_d` \[rad\].
    pub q: Vec<f64>,
    /// `q̇_d` \[rad/s\].
    pub dq: Vec<f64>,
    /// `q̈_d` \[rad/s²\].
    pub ddq: Vec<f64>,
}

impl Desired {
    /// Samples a motion `(joint, t) → q_d, q̇_d, q̈_d` as a study's run does.
    pub fn of(study: &Study, at: impl Fn(usize, f64) -> [f64; 3]) -> Self {
        let n = study.robot.joints.len();
        let period_ns = study.control.period_ns;
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the study bounds duration and rate"
        )]
        let samples = ((study.duration * 1e9 / period_ns as f64).round() as u64).max(1);
        let mut out = Self { q: Vec::new(), dq: Vec::new(), ddq: Vec::new() };
        for k in 0..samples {
            let t = (k * period_ns) as f64 * 1e-9;
            for joint in 0..n {
                let [q, dq, ddq] = at(joint, t);
                out.q.push(q);
                out.dq.push(dq);
                out.ddq.push(ddq);
            }
        }
        out
    }
}

/// Why there is no tube.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum TubeRefusal {
    /// The linear loop does not have this part of the study.
    #[error("`{0}` is not in the loop that a tube is about")]
    Unsupported(String),
    /// The payload cannot be attached.
    #[error("payload: {0}")]
    Payload(String),
    /// A limit could act.
    #[error(
        "the {} limit can act at t = {t:.3} s on joint {joint}",
        if *torque { "torque" } else { "torque-rate" }
    )]
    Limit {
        /// Joint.
        joint: String,
        /// When \[s\].
        t: f64,
        /// The torque limit, not that of its rate.
        torque: bool,
    },
    /// The nominal run diverges.
    #[error("the run itself diverges at t = {t:.3} s on joint {joint}")]
    Diverges {
        /// Joint.
        joint: String,
        /// When \[s\].
        t: f64,
    },
    /// No bounds were found that one evaluation confirms.
    #[error(
        "the bounds on joint {joint} grow without end at t = {t:.3} s: the intervals are too wide for these gains"
    )]
    Open {
        /// Joint.
        joint: String,
        /// When \[s\].
        t: f64,
    },
}

/// Bounds on one joint, one entry per bin.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct JointEnvelope {
    /// `e` \[rad\], low and high.
    pub error: Vec<(f64, f64)>,
    /// `ė` \[rad/s\].
    pub velocity: Vec<(f64, f64)>,
    /// `|τ|` commanded \[N·m\].
    pub torque: Vec<f64>,
    /// `|τ_k − τ_{k−1}|` commanded \[N·m\].
    pub step: Vec<f64>,
}

/// What was found.
#[derive(Debug, Clone, PartialEq)]
pub struct Envelope {
    /// Length of a bin \[s\].
    pub bin_s: f64,
    /// Per joint.
    pub joints: Vec<JointEnvelope>,
    /// Slices of the payload's mass.
    pub slices: u32,
}

/// Finds the tube of a study under gains.
///
/// # Errors
///
/// [`TubeRefusal`].
pub fn find(study: &Study, gains: &Gains, desired: &Desired) -> Result<Envelope, TubeRefusal> {
    let scene = Scene::new(study, gains, desired)?;
    let Some(set) = scene.payload.clone() else {
        return sliced(&scene, None, threads());
    };
    let wide = set.mass.1 > set.mass.0;
    let threads = threads();
    let mut whole: Option<Envelope> = None;
    let mut slices = 0;
    let mut open = Slice::of(&set, set.mass, if wide { 2 } else { 1 });
    let mut probed = false;
    while !open.is_empty() {
        // As many side by side as there are threads; what each does inside is theirs to share.
        let (now, later) = open.split_at(open.len().min(threads));
        let inner = threads.div_ceil(now.len());
        let found = parallel(&(0..now.len()).collect::<Vec<_>>(), threads, |i| {
            sliced(&scene, Some(&now[i]), inner)
        });
        let mut next = Vec::new();
        for (slice, found) in now.iter().zip(found) {
            let width = (slice.mass.1 - slice.mass.0) / (set.mass.1 - set.mass.0);
            match found {
                Ok(found) => {
                    slices += 1;
                    match &mut whole {
                        None => whole = Some(found),
                        Some(whole) => whole.join(&found),
                    }
                }
                Err(TubeRefusal::Open { .. }) if wide && width > 1.5 * NARROWEST => {
                    if !probed && width > 3.0 * NARROWEST {
                        // Where the narrowest slice does not close, nothing around it will.
                        let top = slice.mass.1;
                        let low = top - NARROWEST * (set.mass.1 - set.mass.0);
                        let narrow = Slice::of(&set, (low, top), 1);
                        sliced(&scene, narrow.first(), threads)?;
                        probed = true;
                    }
                    next.extend(Slice::of(&set, slice.mass, 2));
                }
                Err(why) => return Err(why),
            }
        }
        next.extend_from_slice(later);
        open = next;
    }
    let mut whole = whole.ok_or_else(|| TubeRefusal::Payload("no mass".to_owned()))?;
    whole.slices = slices;
    Ok(whole)
}

impl Envelope {
    /// The union of two.
    fn join(&mut self, other: &Self) {
        let hull = |a: &mut [(f64, f64)], b: &[(f64, f64)]| {
            for (a, b) in a.iter_mut().zip(b) {
                *a = hull([*a, *b].into_iter());
            }
        };
        let larger = |a: &mut [f64], b: &[f64]| {
            for (a, b) in a.iter_mut().zip(b) {
                *a = larger(*a, *b);
            }
        };
        for (a, b) in self.joints.iter_mut().zip(&other.joints) {
            hull(&mut a.error, &b.error);
            hull(&mut a.velocity, &b.velocity);
            larger(&mut a.torque, &b.torque);
            larger(&mut a.step, &b.step);
        }
    }
}

/// The tube of one slice of the payload.
#[allow(clippy::too_many_lines, reason = "one step after the other")]
fn sliced(
    scene: &Scene<'_>,
    slice: Option<&Slice>,
    threads: usize,
) -> Result<Envelope, TubeRefusal> {
    let model = match slice {
        Some(slice) => slice.model(scene)?,
        None => scene.bare.clone(),
    };
    let nominal = Nominal::run(scene, &model)?;
    let intervals = intervals(scene, &nominal, &model, threads)?;
    let jacobians = match slice {
        Some(_) => jacobians(scene, &nominal, &model),
        None => Vec::new(),
    };
    let bin = even(BIN / scene.period, 1);
    let course = Course { scene, intervals: &intervals, jacobians: &jacobians, bin };
    let (scale, memory) = course.pilot(FORGOTTEN);
    let shared = (memory as f64 * scene.period / GROUPS_REMEMBERED).clamp(GROUP.0, GROUP.1);
    // Where velocity is read, a launch elsewhere is an error of the reading, and the law makes much of it.
    let shared = if scene.measured_velocity { 0.25 * shared } else { shared };
    let group = 2 * even(0.5 * shared / (bin as f64 * scene.period), 1);
    let looks = even(LOOK / scene.period, 1);
    let samples = intervals.len();
    let bins = samples.div_ceil(bin);
    let length = (memory.div_ceil(bin * group) + 1) * bin * group;
    let segments = segments(&course, length, &scale, threads);
    let directions = match slice {
        Some(slice) => slice.directions(scene)?,
        None => Vec::new(),
    };
    let shapes = shapes(&course, &nominal, &directions);
    let ends = match slice {
        Some(slice) => vec![slice.with(scene, slice.mass.0)?, slice.with(scene, slice.mass.1)?],
        None => vec![scene.bare.clone()],
    };
    let along = Along {
        course: &course,
        nominal: &nominal,
        slice,
        shapes: &shapes,
        bins,
        segments: &segments,
    };
    let first = course.kernel(0, length.min(samples + bin), &scale);
    let mut sweep = Sweep::new(&along, first);
    let groups = bins.div_ceil(group);
    let moved = Moved::new(&course, &nominal, group);
    let chunk = 4 * threads;
    for start in (0..groups).step_by(chunk) {
        let list: Vec<usize> = (start..(start + chunk).min(groups)).collect();
        let made = parallel(&list, threads, |g| {
            let launch = (g * group + group / 2) * bin;
            let boundary = (launch + length).div_ceil(length) * length;
            let end = boundary.min((bins + group + 2) * bin);
            let kernel = course.kernel(launch, end, &scale);
            let mut looked = Looked::new(&ends, &directions);
            let first = g * group * bin + looks / 2;
            let mut tensors = looked.at(&middle(scene, &nominal, first.min(samples - 1)), slice);
            for k in (first + looks..((g + 1) * group * bin).min(samples)).step_by(looks) {
                tensors.widen(&looked.at(&middle(scene, &nominal, k), slice));
            }
            let [m, d, k] = [0, 1, 2].map(|i| moved.by(i, g));
            Group {
                kernel,
                tensors,
                moved: [m, d, k],
                moved_rate: moved.by(3, g),
                moved_jacobian: moved.by(4, g),
                jacobian_rate: moved.jacobian_rate(g),
            }
        });
        for (g, made) in list.iter().zip(&made) {
            for b in g * group..((g + 1) * group).min(bins) {
                sweep.bin(b, made)?;
            }
        }
    }
    envelope(scene, &nominal, bin, &sweep.bin_results)
}

fn threads() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

fn even(x: f64, least: usize) -> usize {
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "a small positive number"
    )]
    let x = x.round().max(0.0) as usize;
    x.max(least)
}

fn parallel<T: Send>(list: &[usize], threads: usize, make: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let share = list.len().div_ceil(threads).max(1);
    let make = &make;
    std::thread::scope(|scope| {
        let parts: Vec<_> = list
            .chunks(share)
            .map(|part| scope.spawn(move || part.iter().map(|i| make(*i)).collect::<Vec<T>>()))
            .collect();
        parts
            .into_iter()
            .flat_map(|part| part.join().unwrap_or_else(|why| std::panic::resume_unwind(why)))
            .collect()
    })
}

fn intervals(
    scene: &Scene<'_>,
    nominal: &Nominal,
    model: &phihat_model::Model,
    threads: usize,
) -> Result<Vec<Interval>, TubeRefusal> {
    let starts: Vec<usize> = (0..scene.samples).step_by(256).collect();
    let parts = parallel(&starts, threads, |start| {
        let mut differences = Differences::new(model);
        let mut bare = Differences::new(&scene.bare);
        (start..(start + 256).min(scene.samples))
            .map(|k| Interval::new(scene, nominal, k, &mut differences, &mut bare))
            .collect::<Option<Vec<Interval>>>()
    });
    let mut all = Vec::with_capacity(scene.samples);
    for part in parts {
        let part = part.ok_or_else(|| {
            TubeRefusal::Payload("the mass matrix is not positive definite".into())
        })?;
        all.extend(part);
    }
    Ok(all)
}

/// Twist of the middle of the payload's box per joint velocity, in the frame's axes, at every sample.
fn jacobians(scene: &Scene<'_>, nominal: &Nominal, model: &phihat_model::Model) -> Vec<Vec<f64>> {
    let Some(set) = &scene.payload else { return Vec::new() };
    let Some(frame) = model.frame(&set.frame) else { return Vec::new() };
    let n = scene.n;
    let mut workspace = phihat_model::Workspace::new(model);
    let mut world = vec![0.0; 6 * n];
    let c = centre(set);
    (0..scene.samples)
        .map(|k| {
            model.jacobian(&mut workspace, &nominal.q[k * n..(k + 1) * n], frame, &mut world);
            let r = model.pose(&workspace, frame).r;
            let mut out = vec![0.0; 6 * n];
            for j in 0..n {
                let turned = |at: usize| -> [f64; 3] {
                    core::array::from_fn(|i| {
                        (0..3).map(|w| r[w][i] * world[(at + w) * n + j]).sum()
                    })
                };
                let (linear, angular) = (turned(0), turned(3));
                let [x, y, z] = angular;
                let at = [
                    linear[0] + y * c[2] - z * c[1],
                    linear[1] + z * c[0] - x * c[2],
                    linear[2] + x * c[1] - y * c[0],
                ];
                for i in 0..3 {
                    out[i * n + j] = at[i];
                    out[(3 + i) * n + j] = angular[i];
                }
            }
            out
        })
        .collect()
}

/// What a state left at the start of each segment does.
fn segments(course: &Course<'_>, length: usize, scale: &Scale, threads: usize) -> Vec<Segment> {
    let samples = course.intervals.len();
    let starts: Vec<usize> = (length..samples).step_by(length).collect();
    parallel(&starts, threads, |from| {
        let to = (from + length).min(samples);
        let (rows, left) = course.segment(from, to, scale);
        Segment { from, rows, left }
    })
}

/// The linear runs of the payload's parameters.
fn shapes(
    course: &Course<'_>,
    nominal: &Nominal,
    directions: &[Option<basis::Direction>],
) -> Vec<Option<Shape>> {
    let scene = course.scene;
    let n = scene.n;
    if directions.is_empty() {
        return Vec::new();
    }
    let mut pairs: Vec<Option<(Differences<'_>, Differences<'_>, f64)>> = directions
        .iter()
        .map(|d| {
            d.as_ref().map(|d| (Differences::new(&d.plus), Differences::new(&d.minus), d.scale))
        })
        .collect();
    let empty = Shape { e: vec![0.0; n], v: vec![0.0; n], command: Vec::new() };
    let mut shapes: Vec<Option<Shape>> =
        directions.iter().map(|d| d.as_ref().map(|_| empty.clone())).collect();
    let mut runs = [Deviation::<WIDE>::new(scene), Deviation::<WIDE>::new(scene)];
    let (mut plus, mut minus) = (vec![0.0; n], vec![0.0; n]);
    for (k, interval) in course.intervals.iter().enumerate() {
        let [q, v, a] = middle(scene, nominal, k);
        let mut torque = vec![[0.0_f64; 2 * WIDE]; n];
        for (d, pair) in pairs.iter_mut().enumerate() {
            let Some((with, without, scale)) = pair else { continue };
            with.torque((&q, &v, &a), &mut plus);
            without.torque((&q, &v, &a), &mut minus);
            for i in 0..n {
                torque[i][d] = -(plus[i] - minus[i]) * *scale;
            }
        }
        for (pack, run) in runs.iter_mut().enumerate() {
            let held = |i: usize| core::array::from_fn(|c| torque[i][pack * WIDE + c]);
            run.step(scene, (k, interval), held);
        }
        for (d, shape) in shapes.iter_mut().enumerate() {
            let Some(shape) = shape else { continue };
            let (run, c) = (&runs[d / WIDE], d % WIDE);
            for i in 0..n {
                shape.e.push(run.state[i][c]);
                shape.v.push(run.state[n + i][c]);
                shape.command.push(run.control.command[i][c]);
            }
        }
    }
    shapes
}

/// How far matrices of the linear run differ between a launch and where its responses are used.
struct Moved {
    /// Per kind (`M`, `D`, `K`, `Ṁ`, `J`) and group: entry by entry.
    ranges: [Vec<Vec<f64>>; 5],
    rates: Vec<Vec<f64>>,
}

impl Moved {
    fn new(course: &Course<'_>, nominal: &Nominal, group: usize) -> Self {
        let n = course.scene.n;
        let _ = nominal;
        let samples = course.intervals.len();
        let bin = course.bin;
        let reach = group * bin / 2 + bin + 1;
        let groups = samples.div_ceil(group * bin);
        // Largest and smallest of every entry over blocks of a bin, then over windows of 2·reach around each block.
        let blocks = samples.div_ceil(bin);
        let window = reach.div_ceil(bin);
        let ranged = |entries: usize, value: &dyn Fn(usize, usize) -> f64| -> Vec<Vec<f64>> {
            let mut low = vec![vec![f64::INFINITY; entries]; blocks];
            let mut high = vec![vec![f64::NEG_INFINITY; entries]; blocks];
            for k in 0..samples {
                for e in 0..entries {
                    let x = value(k, e);
                    low[k / bin][e] = smaller(low[k / bin][e], x);
                    high[k / bin][e] = larger(high[k / bin][e], x);
                }
            }
            let mut out = vec![vec![0.0_f64; entries]; groups];
            for block in 0..blocks {
                let g = block / group;
                let around = block.saturating_sub(window)..(block + window + 1).min(blocks);
                for e in 0..entries {
                    let (bottom, top) = hull(around.clone().map(|b| (low[b][e], high[b][e])));
                    // Either way from the block's own values.
                    let up = top - low[block][e];
                    let down = high[block][e] - bottom;
                    out[g][e] = larger(out[g][e], larger(up, down));
                }
            }
            out
        };
        let square = n * n;
        let at = |k: usize| &course.intervals[k].derivatives;
        let t = course.scene.period;
        let twist = course.inputs().twist;
        let m = ranged(square, &|k, e| at(k).m[e]);
        let d = ranged(square, &|k, e| at(k).d[e]);
        let k_ = ranged(square, &|k, e| at(k).k[e]);
        let rate = ranged(square, &|k, e| {
            let next = (k + 1).min(samples - 1);
            let before = next.saturating_sub(1);
            (at(next).m[e] - at(before).m[e]) / t
        });
        let j = ranged(twist * n, &|k, e| course.jacobians[k][e]);
        let mut rates = vec![vec![0.0_f64; twist * n]; groups];
        if twist > 0 {
            for k in 1..samples {
                let g = k / (group * bin);
                for e in 0..twist * n {
                    let rate = (course.jacobians[k][e] - course.jacobians[k - 1][e]).abs() / t;
                    rates[g][e] = larger(rates[g][e], rate);
                }
            }
        }
        Self { ranges: [m, d, k_, rate, j], rates }
    }

    fn by(&self, kind: usize, group: usize) -> Vec<f64> {
        self.ranges[kind].get(group).cloned().unwrap_or_default()
    }

    fn jacobian_rate(&self, group: usize) -> Vec<f64> {
        self.rates.get(group).cloned().unwrap_or_default()
    }
}

/// Bounds relative to the reference, and that no limit acts.
fn envelope(
    scene: &Scene<'_>,
    nominal: &Nominal,
    bin: usize,
    results: &[Bin],
) -> Result<Envelope, TubeRefusal> {
    let n = scene.n;
    let mut joints = vec![JointEnvelope::default(); n];
    for (b, result) in results.iter().enumerate() {
        let from = b * bin;
        let rows = result.command.len() / n;
        for (i, joint) in joints.iter_mut().enumerate() {
            let none = (f64::INFINITY, f64::NEG_INFINITY);
            let (mut error, mut velocity) = (none, none);
            let (mut torque, mut step) = (0.0_f64, 0.0_f64);
            for row in 0..rows {
                let k = from + row;
                let at = k * n + i;
                let wide = |out: &mut (f64, f64), middle: f64, around: (f64, f64)| {
                    *out = hull([*out, (middle + around.0, middle + around.1)].into_iter());
                };
                wide(&mut error, nominal.q[at] - scene.desired.q[at], result.e[row * n + i]);
                wide(&mut velocity, nominal.dq[at] - scene.desired.dq[at], result.v[row * n + i]);
                let own = result.command[row * n + i];
                let middle = nominal.command[at];
                let most_torque = larger(middle + own.1, -(middle + own.0));
                let before = if k > 0 { nominal.command[at - n] } else { 0.0 };
                let own = result.change[row * n + i];
                let change = larger(middle - before + own.1, -(middle - before + own.0));
                let (most, most_step) = scene.limits[i];
                let inside = |x: f64, limit: f64| x <= limit;
                if !inside(most_torque, most) || !inside(change, most_step) {
                    let t = k as f64 * scene.period;
                    let joint = scene.names[i].clone();
                    return Err(TubeRefusal::Limit {
                        joint,
                        t,
                        torque: !inside(most_torque, most),
                    });
                }
                torque = larger(torque, most_torque);
                step = larger(step, change);
            }
            joint.error.push(error);
            joint.velocity.push(velocity);
            joint.torque.push(torque);
            joint.step.push(step);
        }
    }
    Ok(Envelope { bin_s: bin as f64 * scene.period, joints, slices: 1 })
}
