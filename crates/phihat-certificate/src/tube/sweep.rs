//! One causal sweep over the run: window by window, bounds that follow from bounds before them.

use super::Inputs;
use super::adjoint::{Back, Boxes, Rows, Weights};
use super::chain::Chain;
use super::dense::{apply_sizes, count, product, reaches, transpose};
use super::frame::{Arm, Distance, Frame, arc};
use super::law::{LinearLoop, Loop};
use super::nominal::Nominal;
use super::scope::{Adds, Dry, PayloadSlice, Refusal, Smooth};
use super::shapes::{Shapes, Spread};
use crate::extremes::Extremes as _;

/// Longest window of later outputs that share one set of rows \[s\].
const WINDOW: f64 = 5e-3;
/// Distance of the instants whose whole state is bounded \[s\].
const ANCHORS: f64 = 0.1;
/// How far rows go back at least \[s\]; beyond, the whole state's bound takes their place.
const MEMORY: f64 = 0.3;
/// Beyond this half width \[rad\] nothing is proved any more.
const WIDEST: f64 = 0.5;
/// Rounds of one window before it is given up.
const ROUNDS: usize = 60;

/// Bounds of one slice, relative to the nominal run.
#[derive(Debug, Clone, Default)]
pub(super) struct Swept {
    /// Deviation at each sample: position low, high; velocity low, high.
    pub(super) position: Vec<(Vec<f64>, Vec<f64>)>,
    pub(super) velocity: Vec<(Vec<f64>, Vec<f64>)>,
    /// Commanded torque and its change since the sample before: sizes with the nominal in them.
    pub(super) torque: Vec<Vec<f64>>,
    pub(super) torque_step: Vec<Vec<f64>>,
}

/// What is known of one finished window.
struct Past {
    frame: Frame,
    /// Radii at its instants of what shapes do not explain: `ε`, `M⁻¹P`.
    rest: (Vec<f64>, Vec<f64>),
}

/// Whole-state bounds at an instant.
struct Anchor {
    at: usize,
    /// At the instant itself, and over the window of instants from it on.
    exact: Vec<f64>,
    shared: Vec<f64>,
}

pub(super) struct Sweep<'a> {
    pub(super) inputs: &'a Inputs<'a>,
    pub(super) arm: Arm<'a>,
    pub(super) run: &'a Nominal,
    pub(super) dry: &'a Dry,
    pub(super) loops: &'a [Loop],
    n: usize,
    hand: usize,
    period: f64,
    joints: Vec<LinearLoop>,
    reads_rate: bool,
    half_step: Vec<f64>,
    /// Longest shared window, samples between anchors, shortest memory: all in samples.
    shared: usize,
    spacing: usize,
    memory: usize,
    /// By sample.
    window_of: Vec<usize>,
    past: Vec<Past>,
    raw: Vec<Boxes>,
    shifted: Vec<Boxes>,
    dilated: Vec<Boxes>,
    anchors: Vec<Anchor>,
    load: Vec<[Vec<f64>; 3]>,
    pushes: Vec<(usize, usize, f64)>,
}

/// What one round of a window gives.
struct Round {
    boxes: Vec<Boxes>,
    shapes: Shapes,
    spread: Spread,
    /// Per sample: deviation of the velocity inside it.
    inside: Vec<(Vec<f64>, Vec<f64>)>,
    reach: Vec<f64>,
    twist: Vec<f64>,
    radii: Vec<f64>,
    rest: (Vec<f64>, Vec<f64>),
    direct: Vec<f64>,
}

/// What is taken for granted in a round.
#[derive(Clone)]
struct Guess {
    inside: Vec<(Vec<f64>, Vec<f64>)>,
    reach: Vec<f64>,
    twist: Vec<f64>,
    rest: (Vec<f64>, Vec<f64>),
}

impl<'a> Sweep<'a> {
    pub(super) fn new(
        inputs: &'a Inputs<'a>,
        (chain, slice, smooth): (&'a Chain, Option<&'a PayloadSlice>, &'a [Smooth]),
        (run, dry, adds): (&'a Nominal, &'a Dry, &'a Adds),
        (loops, drives): (&'a [Loop], &'a [f64]),
    ) -> Self {
        let period = inputs.study.control.period_ns as f64 * 1e-9;
        let n = loops.len();
        let joints = loops.iter().map(Loop::linear_loop).collect();
        let measured = loops.iter().any(|own| own.measured);
        let whole = |x: f64| count((x / period).round().max(1.0));
        let samples = run.command.len();
        let mut pushes = Vec::new();
        for push in &inputs.study.world.pushes {
            for edge in [push.start, push.start + push.duration] {
                let at = edge / period;
                if (at - at.round()).abs() > 1e-6 && at < samples as f64 {
                    pushes.push((count(at.floor()), push.joint, push.torque.abs()));
                }
            }
        }
        let load = match slice {
            None => Vec::new(),
            Some(_) => (0..samples).map(|k| load_torques(chain, run, k)).collect(),
        };
        Self {
            inputs,
            arm: Arm { chain, slice, smooth, adds, drives, period },
            run,
            dry,
            loops,
            n,
            hand: if slice.is_some() { 6 } else { 0 },
            period,
            joints,
            reads_rate: measured || adds.friction.is_some(),
            half_step: inputs.misread(),
            shared: whole(WINDOW),
            spacing: whole(ANCHORS),
            memory: whole(MEMORY),
            window_of: Vec::new(),
            past: Vec::new(),
            raw: Vec::new(),
            shifted: Vec::new(),
            dilated: Vec::new(),
            anchors: Vec::new(),
            load,
            pushes,
        }
    }

    fn rows(&self) -> Rows<'_> {
        Rows {
            n: self.n,
            period: self.period,
            joints: &self.joints,
            reads_rate: self.reads_rate,
            half_step: &self.half_step,
        }
    }

    /// The whole sweep.
    pub(super) fn run(mut self, progress: &dyn Fn(f64)) -> Result<Swept, Refusal> {
        let samples = self.run.command.len();
        let n = self.n;
        let zero = vec![0.0; n];
        let mut swept = Swept {
            position: vec![(zero.clone(), zero.clone())],
            velocity: vec![(zero.clone(), zero.clone())],
            ..Swept::default()
        };
        let mut shapes = Shapes::new(n, self.loops, self.arm.slice.is_some());
        let mut first = 0;
        let mut guess = None;
        while first < samples {
            let ready = first + 1 >= self.memory + self.spacing
                && self.anchors.iter().any(|a| a.at + self.memory <= first + 1);
            let len = if ready { self.shared.min(samples - first) } else { 1 };
            let t = first as f64 * self.period;
            let round = self.window((first, len), &shapes, guess.take(), &mut swept)?;
            guess = Some(round.1);
            shapes = round.0;
            first += len;
            self.bound_anchor(first);
            progress(t / (samples as f64 * self.period));
        }
        Ok(swept)
    }

    pub(super) fn load_at(&self, k: usize) -> &[Vec<f64>; 3] {
        &self.load[k]
    }

    pub(super) fn joint(&self, i: usize) -> &LinearLoop {
        &self.joints[i]
    }

    pub(super) fn reads_rate(&self) -> bool {
        self.reads_rate
    }

    fn too_fast(&self, first: usize) -> Refusal {
        Refusal::TooFast { t: first as f64 * self.period }
    }

    fn window(
        &mut self,
        (first, len): (usize, usize),
        shapes: &Shapes,
        before: Option<Guess>,
        swept: &mut Swept,
    ) -> Result<(Shapes, Guess), Refusal> {
        let n = self.n;
        let mut reach: Vec<f64> = match &before {
            Some(guess) => guess.reach.iter().map(|e| 1.3 * e + 1e-6).collect(),
            None => self.half_step.iter().map(|h| 4.0 * h + 1e-6).collect(),
        };
        let (frame, mut distance) =
            self.arm.window(self.run, (first, len), &reach).ok_or_else(|| self.too_fast(first))?;
        self.window_of.resize(first + len, self.past.len());
        let (history, near) = self.history(&frame);
        let last_inside = before.as_ref().and_then(|g| g.inside.last().cloned());
        let mut guess = match before {
            Some(mut g) => {
                let last = last_inside.unwrap_or_else(|| (vec![0.0; n], vec![0.0; n]));
                g.inside = vec![last; len];
                g
            }
            None => Guess {
                inside: vec![(vec![-1e-6; n], vec![1e-6; n]); len],
                reach: reach.clone(),
                twist: vec![1e-6; 2 * self.hand],
                rest: (reach.clone(), vec![1e-6; n]),
            },
        };
        for tries in 0..ROUNDS {
            if guess.reach.iter().zip(&distance.reach).any(|(e, have)| e > have) {
                reach = guess.reach.iter().map(|e| 1.2 * e + 1e-6).collect();
                distance = self
                    .arm
                    .window(self.run, (first, len), &reach)
                    .ok_or_else(|| self.too_fast(first))?
                    .1;
            }
            let round = self.round(&frame, &distance, &guess, (shapes, &history, &near));
            if let Some(widest) = (0..n).find(|i| reaches(round.reach[*i], WIDEST)) {
                return Err(Refusal::Open {
                    t: first as f64 * self.period,
                    joint: self.inputs.joints[widest].name.clone(),
                    width: round.reach[widest],
                });
            }
            if within(&round, &guess) {
                self.finish(frame, &round, &guess, swept)?;
                return Ok((round.shapes, guess));
            }
            guess = next_guess(&round, &guess, tries);
        }
        let widest = (0..n).max_by(|a, b| guess.reach[*a].total_cmp(&guess.reach[*b])).unwrap_or(0);
        Err(Refusal::Open {
            t: first as f64 * self.period,
            joint: self.inputs.joints[widest].name.clone(),
            width: guess.reach[widest],
        })
    }

    /// Outputs: `ε`, `M⁻¹P`, commands, their changes, twist of the hand, what drives are off.
    fn outputs(&self) -> usize {
        4 * self.n + 2 * self.hand + self.arm.drives.len()
    }

    fn start_rows(&self, frame: &Frame) -> Back {
        let n = self.n;
        let mut back = Back::new(n, self.hand, self.rows().states(), self.outputs());
        let rows = back.rows;
        let mut set =
            |state: usize, row: usize, value: f64| back.lambda[state * rows + row] = value;
        let mut at = 2 * n;
        let twist = if self.hand > 0 {
            product(&frame.outlook, &frame.m_inverse, (12, n, n))
        } else {
            Vec::new()
        };
        for i in 0..n {
            set(i, i, 1.0);
            for j in 0..n {
                set(n + j, n + i, frame.m_inverse[i * n + j]);
            }
            let newest = at + self.loops[i].newest();
            set(newest, 2 * n + i, 1.0);
            set(newest, 3 * n + i, 1.0);
            set(newest + 1, 3 * n + i, -1.0);
            if let Some(gap) = self.joints[i].gap {
                set(at + gap, 4 * n + 2 * self.hand + i, 1.0);
            }
            at += self.loops[i].size;
            for c in 0..2 * self.hand {
                set(n + i, 4 * n + c, twist[c * n + i]);
            }
        }
        back
    }

    /// Takes rows from an instant back to an anchor or the start. Boxes of samples before `own` are known;
    /// the weights of the others come back.
    fn go_back(
        &self,
        back: &mut Back,
        own_frame: Option<&Frame>,
        (from, own, shared): (usize, usize, bool),
    ) -> (Vec<f64>, Vec<(Weights, usize)>) {
        let rows = self.rows();
        let mut sums = vec![0.0; back.rows];
        let mut near = Vec::new();
        let anchor = self.anchors.iter().rev().find(|a| a.at + self.memory <= from);
        let stop = anchor.map_or(0, |a| a.at);
        let reach = if shared { self.shared } else { 1 };
        for sample in (stop..from).rev() {
            let at = self.window_of[sample];
            let frame = match self.past.get(at) {
                Some(past) => &past.frame,
                None => match own_frame {
                    Some(frame) => frame,
                    None => break,
                },
            };
            let weights = rows.step(back, frame, sample);
            if sample + reach > own {
                near.push((weights.clone(), at));
            } else {
                let boxes = if shared { &self.dilated[sample] } else { &self.raw[sample] };
                weights.add(boxes, frame, self.period, &mut sums);
            }
        }
        if let Some(anchor) = anchor {
            let bounds = if shared { &anchor.shared } else { &anchor.exact };
            for (lambda, bound) in back.lambda.chunks_exact(back.rows).zip(bounds) {
                sums.iter_mut().zip(lambda).for_each(|(sum, l)| *sum += l.abs() * bound);
            }
        }
        sums.iter_mut().zip(&back.noise).for_each(|(sum, noise)| *sum += noise);
        (sums, near)
    }

    fn history(&self, frame: &Frame) -> (Vec<f64>, Vec<(Weights, usize)>) {
        let mut back = self.start_rows(frame);
        let shared = frame.len > 1;
        self.go_back(&mut back, Some(frame), (frame.first + 1, frame.first, shared))
    }

    /// One evaluation of a window's bounds from a guess of them.
    fn round(
        &self,
        frame: &Frame,
        distance: &Distance,
        guess: &Guess,
        (shapes, history, near): (&Shapes, &[f64], &[(Weights, usize)]),
    ) -> Round {
        let n = self.n;
        let sizes: Vec<f64> = (0..n)
            .map(|i| guess.inside.iter().map(|(l, h)| l[i].abs().max(h[i].abs())).largest())
            .collect();
        let smooth = self.smooth_boxes(distance, guess, &sizes);
        let mut boxes = Vec::with_capacity(frame.len);
        let (mut signs, mut added) = (Vec::with_capacity(frame.len), Vec::new());
        for at in 0..frame.len {
            let k = frame.first + at;
            let (mut own, middle) = self.sample_boxes(frame, (k, &smooth), &guess.inside[at]);
            added.push(self.added(distance, (k, &guess.reach), &guess.inside[at], &mut own));
            boxes.push(own);
            signs.push(middle);
        }
        let (after, spread) = shapes.advance(self, frame, (&signs, &added));
        let radii = self.radii(frame, (history, near), &boxes, guess);
        self.conclude(frame, distance, (boxes, after, spread, radii, sizes))
    }

    /// What acts on all samples of a window alike.
    fn smooth_boxes(&self, distance: &Distance, guess: &Guess, sizes: &[f64]) -> Boxes {
        let n = self.n;
        let mut out = Boxes::none(n, self.hand);
        let s = apply_sizes(&distance.s, sizes);
        let k = apply_sizes(&distance.k, &guess.reach);
        let posture = apply_sizes(&distance.m, sizes);
        for i in 0..n {
            let mut bend = 0.0;
            for j in 0..n {
                for l in 0..n {
                    bend += distance.slopes[(i * n + j) * n + l] * sizes[j] * sizes[l];
                }
            }
            out.u[i] = s[i] + k[i] + 0.5 * bend;
            out.x[i] = posture[i];
        }
        if let Some(slice) = self.arm.slice {
            let deviation = slice.deviation();
            for (mu, row) in out.mu.iter_mut().zip(&deviation) {
                *mu = row.iter().zip(&guess.twist).map(|(d, nu)| d * nu).sum();
            }
            let (twist, turning) = guess.twist.split_at(6);
            out.wrench = apply_sizes(&distance.wrench, twist);
            for (wrench, row) in out.wrench.iter_mut().zip(&deviation) {
                *wrench += row.iter().zip(turning).map(|(d, rate)| d * rate).sum::<f64>();
            }
            let add = |to: &mut [f64], by: &[f64], size: &[f64]| {
                let turned = apply_sizes(&transpose(by, (6, n)), size);
                to.iter_mut().zip(turned).for_each(|(x, t)| *x += t);
            };
            add(&mut out.x, &distance.hand_now, &out.mu);
            add(&mut out.u, &distance.rate, &out.mu);
            add(&mut out.u, &distance.hand, &out.wrench);
        }
        out
    }

    /// Boxes of one sample, and the middle of the sign of each joint's velocity in it.
    fn sample_boxes(
        &self,
        frame: &Frame,
        (k, smooth): (usize, &Boxes),
        inside: &(Vec<f64>, Vec<f64>),
    ) -> (Boxes, Vec<f64>) {
        let n = self.n;
        let run = self.run;
        let mut out = smooth.clone();
        let mut middles = vec![0.0; n];
        let ends = |i: usize| {
            let (a, b, c) = (run.v[k][i], run.v_mid[k][i], run.v[k + 1][i]);
            let arc = arc(&run.v, &run.v_mid, k, i);
            (a.min(b).min(c) - arc + inside.0[i], a.max(b).max(c) + arc + inside.1[i])
        };
        // A stage of the simulator's integration may see another velocity than the run has.
        let jump: Vec<f64> = (0..n)
            .map(|i| {
                let (low, high) = ends(i);
                self.dry.high[i] * (Dry::sign(high) - Dry::sign(low)).abs()
            })
            .collect();
        let kick = apply_sizes(&frame.m_inverse, &jump);
        let step = self.period / f64::from(self.inputs.study.world.substeps.max(1));
        let drift: Vec<f64> = kick.iter().map(|a| step * a / 72.0).collect();
        let (defect_q, defect_v) = &run.defect[k];
        let rates: Vec<f64> =
            defect_q.iter().zip(&drift).map(|(q, d)| q / self.period + d).collect();
        let lost = apply_sizes(&frame.m, &rates);
        let dragged = apply_sizes(&frame.s, &rates);
        let pushed = apply_sizes(&frame.m, defect_v);
        for i in 0..n {
            let (mut low, mut high) = ends(i);
            let slip = step * kick[i];
            (low, high) = (low - slip, high + slip);
            let (a, b) = (Dry::sign(low), Dry::sign(high));
            middles[i] = 0.5 * (a + b);
            let (v_low, v_high) = ends(i);
            let v = inside.0[i].abs().max(inside.1[i].abs());
            // From the nominal velocity to the true one.
            let (below, above) = (inside.0[i].max(0.0), inside.1[i].min(0.0));
            let bend = self.arm.smooth[i].bend(v_low - below, v_high - above);
            out.u[i] += self.dry.high[i] * 0.5 * (b - a)
                + 0.5 * bend * v * v
                + dragged[i]
                + pushed[i] / self.period;
            out.x[i] += lost[i];
        }
        for (at, joint, size) in &self.pushes {
            if *at == k {
                out.u[*joint] += size;
            }
        }
        if let Some(slice) = self.arm.slice {
            let [start, middle, end] = &self.load[k];
            for i in 0..n {
                let off = |other: &[f64]| {
                    let slopes = core::array::from_fn(|c| other[c * n + i] - middle[c * n + i]);
                    let (low, high) = slice.range(&slopes);
                    low.abs().max(high.abs())
                };
                // Three instants of a sample; in between it may be half as much again.
                out.u[i] += 1.5 * off(start).max(off(end));
            }
        }
        (out, middles)
    }

    /// What the robot adds at a sample: the known part of what it is more than in the nominal run; the rest goes to the
    /// boxes.
    fn added(
        &self,
        distance: &Distance,
        (k, reach): (usize, &[f64]),
        (low, high): &(Vec<f64>, Vec<f64>),
        boxes: &mut Boxes,
    ) -> Vec<f64> {
        let adds = self.arm.adds;
        let gravity = apply_sizes(&distance.added.gravity, reach);
        boxes.u.iter_mut().zip(gravity).for_each(|(u, off)| *u += off);
        let Some(friction) = &adds.friction else { return vec![0.0; self.n] };
        let of = |i: usize| {
            let v = self.run.v[k][i];
            let size = low[i].abs().max(high[i].abs());
            let (from, to) = (v + low[i].min(0.0), v + high[i].max(0.0));
            let bend = 0.5 * friction[i].bend(from, to) * size * size;
            let (a, b) = (Dry::sign(v + low[i]), Dry::sign(v + high[i]));
            boxes.u[i] +=
                distance.added.damping[i] * size + bend + adds.dry[i].abs() * 0.5 * (b - a);
            adds.dry[i] * (0.5 * (a + b) - self.dry.wide(v))
        };
        (0..self.n).map(of).collect()
    }

    /// What the shifted copies of the reference system are off: for samples of this window.
    fn shift_boxes(&self, frame: &Frame, rest: (&[f64], &[f64]), own: &Boxes) -> Boxes {
        let n = self.n;
        let mut out = Boxes::none(n, self.hand);
        let from = (frame.first + 1).saturating_sub(self.shared);
        let mut seen = usize::MAX;
        for sample in from..frame.first {
            let at = self.window_of[sample];
            if at == seen {
                continue;
            }
            seen = at;
            let other = &self.past[at].frame;
            let off = |a: &[f64], b: &[f64]| -> Vec<f64> {
                a.iter().zip(b).map(|(a, b)| a - b).collect()
            };
            let mut x = apply_sizes(&off(&frame.m, &other.m), rest.1);
            let s = apply_sizes(&off(&frame.s, &other.s), rest.1);
            let k = apply_sizes(&off(&frame.k, &other.k), rest.0);
            let mut u: Vec<f64> = s.iter().zip(k).map(|(s, k)| s + k).collect();
            let gravity = apply_sizes(&off(&frame.added.gravity, &other.added.gravity), rest.0);
            u.iter_mut().zip(gravity).for_each(|(u, off)| *u += off);
            let damping = off(&frame.added.damping, &other.added.damping);
            for ((u, off), rate) in u.iter_mut().zip(damping).zip(rest.1) {
                *u += off.abs() * rate;
            }
            if self.hand > 0 {
                let (turn, rate) = self.turned(frame, other);
                let by = |m: &[f64], size: &[f64]| apply_sizes(&transpose(m, (6, n)), size);
                x.iter_mut().zip(by(&turn, &own.mu)).for_each(|(x, by)| *x += by);
                u.iter_mut().zip(by(&rate, &own.mu)).for_each(|(u, by)| *u += by);
                u.iter_mut().zip(by(&turn, &own.wrench)).for_each(|(u, by)| *u += by);
            }
            out.cover(&Boxes { u, x, ..Boxes::none(n, self.hand) });
        }
        out
    }

    /// Most that the hand's `J` and `J̇` differ between any two instants of two windows.
    fn turned(&self, one: &Frame, other: &Frame) -> (Vec<f64>, Vec<f64>) {
        let span = |rows: &[Vec<f64>]| -> Vec<f64> {
            (0..6 * self.n)
                .map(|at| {
                    let all = rows.iter().map(|row| row[at]);
                    let (low, high) = all.ends();
                    high - low
                })
                .collect()
        };
        let ends: Vec<_> = other.ends.iter().chain(&one.ends).cloned().collect();
        let rates: Vec<Vec<f64>> = [other, one]
            .iter()
            .flat_map(|frame| frame.ends.windows(2))
            .map(|pair| pair[0].iter().zip(&pair[1]).map(|(a, b)| (b - a) / self.period).collect())
            .collect();
        (span(&ends), span(&rates))
    }

    /// Radii of all outputs of a window.
    fn radii(
        &self,
        frame: &Frame,
        (history, near): (&[f64], &[(Weights, usize)]),
        boxes: &[Boxes],
        guess: &Guess,
    ) -> Vec<f64> {
        let mut sums = history.to_vec();
        let shared = frame.len > 1;
        let shift = if shared {
            let own = &boxes[0];
            self.shift_boxes(frame, (&guess.rest.0, &guess.rest.1), own)
        } else {
            Boxes::none(self.n, self.hand)
        };
        for (weights, at) in near {
            let own = self.past.get(*at).map_or(frame, |past| &past.frame);
            let mut cover = Boxes::none(self.n, self.hand);
            let reach = if shared { self.shared } else { 1 };
            for sample in weights.sample..(weights.sample + reach).min(frame.first + frame.len) {
                if sample < frame.first {
                    let known = if shared { &self.shifted[sample] } else { &self.raw[sample] };
                    cover.cover(known);
                } else {
                    let mut here = boxes[sample - frame.first].clone();
                    add(&mut here, &shift);
                    cover.cover(&here);
                }
            }
            weights.add(&cover, own, self.period, &mut sums);
        }
        sums
    }

    #[allow(clippy::too_many_lines, reason = "one list of what follows from the radii")]
    fn conclude(
        &self,
        frame: &Frame,
        distance: &Distance,
        (boxes, shapes, spread, radii, sizes): (Vec<Boxes>, Shapes, Spread, Vec<f64>, Vec<f64>),
    ) -> Round {
        let n = self.n;
        let most =
            |of: &dyn Fn(&Boxes) -> &[f64], i: usize| boxes.iter().map(|b| of(b)[i]).largest();
        let mut x: Vec<f64> = (0..n).map(|i| most(&|b| &b.x, i)).collect();
        let mut u: Vec<f64> = (0..n).map(|i| most(&|b| &b.u, i)).collect();
        let mu = boxes[0].mu.clone();
        if self.hand > 0 {
            // Here against the frame's own hand.
            let by = apply_sizes(&transpose(&distance.hand, (6, n)), &mu);
            x.iter_mut().zip(by).for_each(|(x, by)| *x += by);
            let hand = transpose(&frame.hand, (6, n));
            let rate = transpose(&frame.outlook[6 * n..], (6, n));
            let (by, turned) = (apply_sizes(&hand, &boxes[0].wrench), apply_sizes(&rate, &mu));
            for i in 0..n {
                u[i] += by[i] + turned[i];
            }
        }
        let mut direct = apply_sizes(&frame.m_inverse, &x);
        let mut arc = apply_sizes(&frame.s, &sizes);
        let gravity = apply_sizes(&frame.k, &sizes);
        for i in 0..n {
            let lag = spread.gap.get(i).map_or(0.0, |gap| gap + radii[4 * n + 2 * self.hand + i]);
            arc[i] = 0.5 * self.period * (u[i] + arc[i] + 0.5 * self.period * gravity[i] + lag);
        }
        let arc = apply_sizes(&frame.m_inverse, &arc);
        let mut twist = Vec::new();
        if self.hand > 0 {
            let out = product(&frame.m_inverse, &transpose(&frame.hand, (6, n)), (n, n, 6));
            let by = apply_sizes(&out, &mu);
            direct.iter_mut().zip(by).for_each(|(d, by)| *d += by);
            let through = product(&frame.outlook, &frame.m_inverse, (12, n, n));
            let (by_x, by_mu) = (
                apply_sizes(&through, &x),
                apply_sizes(&product(&frame.outlook, &out, (12, n, 6)), &mu),
            );
            let off: Vec<f64> = distance.hand.iter().chain(&distance.rate).copied().collect();
            let turned = apply_sizes(&off, &sizes);
            let bent = apply_sizes(&frame.outlook, &arc);
            for c in 0..12 {
                let rows = radii[4 * n + c];
                twist.push(spread.twist[c] + rows + by_x[c] + by_mu[c] + turned[c] + bent[c]);
            }
        }
        // The instant before this window, as this window's frame sees it.
        let entering = match self.past.last() {
            None => vec![0.0; n],
            Some(past) => {
                let off: Vec<f64> = frame.m.iter().zip(&past.frame.m).map(|(a, b)| a - b).collect();
                let change = product(&frame.m_inverse, &off, (n, n, n));
                let more = apply_sizes(&change, &past.rest.1);
                past.rest.1.iter().zip(more).map(|(a, b)| a + b).collect()
            }
        };
        let radius = |at: usize, i: usize| if at == 0 { entering[i] } else { radii[n + i] };
        let inside: Vec<(Vec<f64>, Vec<f64>)> = (0..frame.len)
            .map(|at| {
                let low = |i: usize| {
                    let here = |at: usize| spread.velocity[at].0[i] - radius(at, i);
                    here(at).min(here(at + 1)) - direct[i] - arc[i]
                };
                let high = |i: usize| {
                    let here = |at: usize| spread.velocity[at].1[i] + radius(at, i);
                    here(at).max(here(at + 1)) + direct[i] + arc[i]
                };
                ((0..n).map(low).collect(), (0..n).map(high).collect())
            })
            .collect();
        let mut reach = Vec::new();
        let mut rest = (Vec::new(), Vec::new());
        for i in 0..n {
            let shape = spread.position.iter().map(|(l, h)| l[i].abs().max(h[i].abs())).largest();
            let v = inside.iter().map(|(l, h)| l[i].abs().max(h[i].abs())).largest();
            let before = self.past.last().map_or(0.0, |p| p.rest.0[i]);
            let e = radii[i].max(before);
            let between = 0.5 * self.period * v;
            reach.push(shape + e + between);
            rest.0.push(e + between);
            rest.1.push(radii[n + i].max(entering[i]) + direct[i] + arc[i]);
        }
        Round { boxes, shapes, spread, inside, reach, twist, radii, rest, direct }
    }

    fn finish(
        &mut self,
        frame: Frame,
        round: &Round,
        guess: &Guess,
        swept: &mut Swept,
    ) -> Result<(), Refusal> {
        let n = self.n;
        let own = &round.boxes[0];
        let shift = self.shift_boxes(&frame, (&guess.rest.0, &guess.rest.1), own);
        for own in &round.boxes {
            let mut more = own.clone();
            add(&mut more, &shift);
            self.raw.push(own.clone());
            self.shifted.push(more);
        }
        // Samples whose whole reach is known now.
        while self.dilated.len() + self.shared <= self.shifted.len() {
            let at = self.dilated.len();
            let mut cover = Boxes::none(n, self.hand);
            for sample in at..at + self.shared {
                cover.cover(&self.shifted[sample]);
            }
            self.dilated.push(cover);
        }
        for at in 1..=frame.len {
            let (low, high) = &round.spread.position[at];
            let e = &round.radii[..n];
            swept.position.push(widened(low, high, e));
            let (low, high) = &round.spread.velocity[at];
            let v: Vec<f64> = (0..n).map(|i| round.radii[n + i] + round.direct[i]).collect();
            swept.velocity.push(widened(low, high, &v));
            let k = frame.first + at - 1;
            let nominal = &self.run.command[k];
            let before = if k > 0 { self.run.command[k - 1].clone() } else { vec![0.0; n] };
            let mut torques = Vec::new();
            let mut steps = Vec::new();
            for i in 0..n {
                let ((tl, th), (sl, sh)) =
                    (&round.spread.torque[at - 1], &round.spread.step[at - 1]);
                let (t, s) = (round.radii[2 * n + i], round.radii[3 * n + i]);
                let torque = (nominal[i] + tl[i] - t).abs().max((nominal[i] + th[i] + t).abs());
                let change = nominal[i] - before[i];
                let step = (change + sl[i] - s).abs().max((change + sh[i] + s).abs());
                self.check_limits(k, i, (torque, step))?;
                torques.push(torque);
                steps.push(step);
            }
            swept.torque.push(torques);
            swept.torque_step.push(steps);
        }
        let rest = (round.radii[..n].to_vec(), round.radii[n..2 * n].to_vec());
        self.past.push(Past { frame, rest });
        Ok(())
    }

    fn check_limits(&self, k: usize, i: usize, (torque, step): (f64, f64)) -> Result<(), Refusal> {
        let (most, rate) = self.inputs.study.limits(i);
        let beyond = most.is_some_and(|most| reaches(torque, most))
            || rate.is_some_and(|rate| reaches(step, rate * self.period));
        if beyond {
            let joint = self.inputs.joints[i].name.clone();
            return Err(Refusal::LimitCanAct { t: k as f64 * self.period, joint });
        }
        Ok(())
    }

    /// Bounds the whole state at an anchor, once all samples that its window needs are done.
    fn bound_anchor(&mut self, done: usize) {
        let next = self.anchors.last().map_or(self.spacing, |a| a.at + self.spacing);
        // Instants next … next+shared−1 use samples before them.
        if done + 1 < next + self.shared {
            return;
        }
        let states = self.rows().states();
        let identity = || {
            let mut back = Back::new(self.n, self.hand, states, states);
            for i in 0..states {
                back.lambda[i * back.rows + i] = 1.0;
            }
            back
        };
        let known = |from: usize| self.anchors.iter().any(|a| a.at + self.memory <= from);
        let exact = self.go_back(&mut identity(), None, (next, next, false)).0;
        let shared = if known(next) {
            let own = next + self.shared - 1;
            self.go_back(&mut identity(), None, (next, own, true)).0
        } else {
            let mut most = exact.clone();
            for later in 1..self.shared {
                let at = next + later;
                let here = self.go_back(&mut identity(), None, (at, at, false)).0;
                most.iter_mut().zip(here).for_each(|(m, h)| *m = m.max(h));
            }
            most
        };
        self.anchors.push(Anchor { at: next, exact, shared });
    }
}

fn load_torques(chain: &Chain, run: &Nominal, k: usize) -> [Vec<f64>; 3] {
    let of = |q: &[f64], v: &[f64], a: &[f64]| chain.place::<f64>(q, None).load_torques(v, a);
    [
        of(&run.q[k], &run.v[k], &run.a[k][0]),
        of(&run.q_mid[k], &run.v_mid[k], &run.a[k][1]),
        of(&run.q[k + 1], &run.v[k + 1], &run.a[k][2]),
    ]
}

fn add(to: &mut Boxes, more: &Boxes) {
    let Boxes { u, x, mu, wrench } = to;
    for (a, b) in [(u, &more.u), (x, &more.x), (mu, &more.mu), (wrench, &more.wrench)] {
        a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
    }
}

fn widened(low: &[f64], high: &[f64], by: &[f64]) -> (Vec<f64>, Vec<f64>) {
    (
        low.iter().zip(by).map(|(l, r)| l - r).collect(),
        high.iter().zip(by).map(|(h, r)| h + r).collect(),
    )
}

/// Whether all that came out is strictly inside what was taken for granted.
fn within(round: &Round, guess: &Guess) -> bool {
    let less = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| a < b);
    let all =
        [&round.spread.position, &round.spread.velocity, &round.spread.torque, &round.spread.step];
    let finite = |list: &[f64]| list.iter().all(|x| x.is_finite());
    let known = finite(&round.radii)
        && finite(&round.direct)
        && all.into_iter().flatten().all(|(low, high)| finite(low) && finite(high));
    let spans = round.inside.iter().zip(&guess.inside);
    known
        && less(&round.reach, &guess.reach)
        && less(&round.twist, &guess.twist)
        && less(&round.rest.0, &guess.rest.0)
        && less(&round.rest.1, &guess.rest.1)
        && spans.into_iter().all(|(new, old)| less(&old.0, &new.0) && less(&new.1, &old.1))
}

/// A little more than what came out; after some rounds never less than before.
fn next_guess(round: &Round, guess: &Guess, tries: usize) -> Guess {
    let slack = if tries < 8 { 1e-3 } else { 2e-2 };
    let keep = tries >= 3;
    let more = |new: &[f64], old: &[f64]| -> Vec<f64> {
        let of = |(new, old): (&f64, &f64)| {
            let wide = new * (1.0 + slack) + 1e-12;
            if keep { wide.max(*old) } else { wide }
        };
        new.iter().zip(old).map(of).collect()
    };
    let inside = round.inside.iter().zip(&guess.inside).map(|(new, old)| {
        let n = new.0.len();
        let mut out = (Vec::with_capacity(n), Vec::with_capacity(n));
        for i in 0..n {
            let pad = slack * (new.1[i] - new.0[i]).abs() + 1e-10;
            let (mut low, mut high) = (new.0[i] - pad, new.1[i] + pad);
            if keep {
                low = low.min(old.0[i]);
                high = high.max(old.1[i]);
            }
            out.0.push(low);
            out.1.push(high);
        }
        out
    });
    Guess {
        inside: inside.collect(),
        reach: more(&round.reach, &guess.reach),
        twist: more(&round.twist, &guess.twist),
        rest: (more(&round.rest.0, &guess.rest.0), more(&round.rest.1, &guess.rest.1)),
    }
}
