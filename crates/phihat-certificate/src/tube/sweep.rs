//! One causal sweep over the run: window by window, bounds that follow from bounds before them.

use super::adjoint::{Back, Boxes, Weights};
use super::dense::{count, reaches};
use super::frame::{Distance, Frame};
use super::round::{Past, Round, RoundGuess};
use super::scope::ScopeRefusal;
use super::setting::TubeSetting;
use super::shapes::Shapes;
use crate::extremes::{Extremes as _, larger};

/// Longest window of later outputs that share one set of rows \[s\].
const WINDOW: f64 = 25e-3;
/// Factor by which a window is shorter where the bounds of a longer one are too wide.
const SHORTER: usize = 5;
/// Share of its largest value below which a response to torque counts as forgotten.
const FORGOTTEN: f64 = 0.0003;
/// Longest time that rows go back \[s\]; beyond, the whole state's bound takes their place.
const MEMORY_MAX: f64 = 4.0;
/// First anchor \[samples\]: from here on the laws are the same at every sample.
const FIRST_ANCHOR: usize = 2;
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

/// Torques and torque steps \[N·m\], by sample and joint.
type SampleTorques = (Vec<Vec<f64>>, Vec<Vec<f64>>);

/// Bounds on the whole state over as many instants as a window has.
struct Anchor {
    /// First of them.
    at: usize,
    bounds: Vec<f64>,
}

/// Sums of the outputs of a window, which share one set of rows.
#[derive(Clone)]
struct SharedSums {
    /// Sums that are the same for all of them, by row.
    common: Vec<f64>,
    /// Sums of torques, by row, for one output after the other: friction of a joint that reverses is large for a few
    /// samples, and counts in those alone.
    torques: Vec<f64>,
}

impl SharedSums {
    fn none(rows: usize, outputs: usize) -> Self {
        Self { common: vec![0.0; rows], torques: vec![0.0; rows * outputs] }
    }

    /// Largest sum of any of the outputs, by row.
    fn largest(&self) -> Vec<f64> {
        let rows = self.common.len();
        let torques = |row: usize| self.torques.iter().skip(row).step_by(rows).copied().largest();
        self.common.iter().enumerate().map(|(row, common)| common + torques(row)).collect()
    }
}

/// Bounds that grow, window by window.
pub(super) struct CheckedSweep<'a> {
    setting: TubeSetting<'a>,
    /// Longest shared window, samples between anchors, shortest memory, samples before any window is shared.
    shared: usize,
    spacing: usize,
    memory: usize,
    alone: usize,
    /// By sample.
    window_of: Vec<usize>,
    past: Vec<Past>,
    raw: Vec<Boxes>,
    shifted: Vec<Boxes>,
    dilated: Vec<Boxes>,
    anchors: Vec<Anchor>,
}

impl<'a> CheckedSweep<'a> {
    pub(super) fn new(setting: TubeSetting<'a>) -> Self {
        let whole = |x: f64| count((x / setting.period).round().max(1.0));
        let memory = memory(&setting, whole(MEMORY_MAX));
        Self {
            shared: whole(WINDOW).min(memory),
            spacing: (memory / 3).max(1),
            memory,
            alone: memory / 2,
            setting,
            window_of: Vec::new(),
            past: Vec::new(),
            raw: Vec::new(),
            shifted: Vec::new(),
            dilated: Vec::new(),
            anchors: Vec::new(),
        }
    }

    /// The whole sweep.
    pub(super) fn run(mut self, progress: &dyn Fn(f64)) -> Result<Swept, ScopeRefusal> {
        let samples = self.setting.run.command.len();
        let n = self.setting.n;
        let zero = vec![0.0; n];
        let mut swept = Swept {
            position: vec![(zero.clone(), zero.clone())],
            velocity: vec![(zero.clone(), zero.clone())],
            ..Swept::default()
        };
        let mut shapes = Shapes::new(n, self.setting.loops, self.setting.arm.slice.is_some());
        let mut first = 0;
        let mut guess = None;
        let mut most = self.shared;
        while first < samples {
            let ready = first >= self.alone && !self.anchors.is_empty();
            let len = if ready { most.min(samples - first) } else { 1 };
            match self.window((first, len), &shapes, guess.clone(), &mut swept) {
                // A shorter window has tighter bounds.
                Err(ScopeRefusal::LimitCanAct { .. } | ScopeRefusal::Open { .. }) if len > 1 => {
                    most = (len / SHORTER).max(1);
                    continue;
                }
                Err(refusal) => return Err(refusal),
                Ok((after, bounds)) => (shapes, guess) = (after, Some(bounds)),
            }
            first += len;
            most = self.shared.min(SHORTER * most);
            self.bound_anchors(first);
            progress(first as f64 / samples as f64);
        }
        Ok(swept)
    }

    fn too_fast(&self, first: usize) -> ScopeRefusal {
        ScopeRefusal::TooFast { t: first as f64 * self.setting.period }
    }

    fn window(
        &mut self,
        (first, len): (usize, usize),
        shapes: &Shapes,
        before: Option<RoundGuess>,
        swept: &mut Swept,
    ) -> Result<(Shapes, RoundGuess), ScopeRefusal> {
        let n = self.setting.n;
        let mut reach: Vec<f64> = match &before {
            Some(guess) => guess.reach.iter().map(|e| 1.3 * e + 1e-6).collect(),
            None => self.setting.half_step.iter().map(|h| 4.0 * h + 1e-6).collect(),
        };
        let (frame, mut distance) = self
            .setting
            .arm
            .window(self.setting.run, (first, len), &reach)
            .ok_or_else(|| self.too_fast(first))?;
        self.window_of.resize(first + len, self.past.len());
        let (history, near) = self.history(&frame);
        let last_inside = before.as_ref().and_then(|g| g.inside.last().cloned());
        let mut guess = match before {
            Some(mut g) => {
                let last = last_inside.unwrap_or_else(|| (vec![0.0; n], vec![0.0; n]));
                g.inside = vec![last; len];
                g
            }
            None => RoundGuess {
                inside: vec![(vec![-1e-6; n], vec![1e-6; n]); len],
                reach: reach.clone(),
                twist: vec![1e-6; 2 * self.setting.hand],
                rest: (reach.clone(), vec![1e-6; n]),
            },
        };
        for tries in 0..ROUNDS {
            if guess.reach.iter().zip(&distance.reach).any(|(e, have)| e > have) {
                reach = guess.reach.iter().map(|e| 1.2 * e + 1e-6).collect();
                distance = self
                    .setting
                    .arm
                    .window(self.setting.run, (first, len), &reach)
                    .ok_or_else(|| self.too_fast(first))?
                    .1;
            }
            let round = self.round(&frame, &distance, &guess, (shapes, &history, &near));
            if let Some(widest) = (0..n).find(|i| reaches(round.reach[*i], WIDEST)) {
                return Err(ScopeRefusal::Open {
                    t: first as f64 * self.setting.period,
                    joint: self.setting.inputs.joints[widest].name.clone(),
                    width: round.reach[widest],
                });
            }
            if round.within(&guess) {
                self.finish(frame, &round, &guess, swept)?;
                return Ok((round.shapes, guess));
            }
            guess = guess.next(&round, tries);
        }
        let widest = (0..n).max_by(|a, b| guess.reach[*a].total_cmp(&guess.reach[*b])).unwrap_or(0);
        Err(ScopeRefusal::Open {
            t: first as f64 * self.setting.period,
            joint: self.setting.inputs.joints[widest].name.clone(),
            width: guess.reach[widest],
        })
    }

    /// Takes rows from an instant back to an anchor or the start. Boxes of samples before `own` are known;
    /// the weights of the others come back.
    fn go_back(
        &self,
        back: &mut Back,
        own_frame: Option<&Frame>,
        (from, own, shared): (usize, usize, bool),
    ) -> (SharedSums, Vec<(Weights, usize)>) {
        let rows = self.setting.rows();
        let mut near = Vec::new();
        // Rows of later outputs must end where the laws are those of every sample; others may end at the start.
        let old_enough =
            |a: &&Anchor| a.at + self.memory <= from || (shared && a.at == FIRST_ANCHOR);
        let anchor = self.anchors.iter().rev().find(old_enough);
        let stop = anchor.map_or(0, |a| a.at);
        let reach = if shared { self.shared } else { 1 };
        let mut torques = vec![0.0; self.setting.n * reach];
        let mut sums = SharedSums::none(back.rows, reach);
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
                weights.add_rest(boxes, frame, self.setting.period, &mut sums.common);
                for shift in 0..reach {
                    let u = &self.known(sample + shift, shift).u;
                    torques[shift..].iter_mut().step_by(reach).zip(u).for_each(|(to, u)| *to = *u);
                }
                weights.add_torques((&torques, reach), &mut sums.torques);
            }
        }
        if let Some(anchor) = anchor {
            for (lambda, bound) in back.lambda.chunks_exact(back.rows).zip(&anchor.bounds) {
                let sums = sums.common.iter_mut().zip(lambda);
                sums.for_each(|(sum, l)| *sum += l.abs() * bound);
            }
        }
        sums.common.iter_mut().zip(&back.noise).for_each(|(sum, noise)| *sum += noise);
        (sums, near)
    }

    /// Boxes of a finished sample, for rows that are those of an output so many samples earlier.
    fn known(&self, sample: usize, shift: usize) -> &Boxes {
        if shift == 0 { &self.raw[sample] } else { &self.shifted[sample] }
    }

    fn history(&self, frame: &Frame) -> (SharedSums, Vec<(Weights, usize)>) {
        let mut back = self.setting.start_rows(frame);
        let shared = frame.len > 1;
        self.go_back(&mut back, Some(frame), (frame.first + 1, frame.first, shared))
    }

    /// One evaluation of a window's bounds from a guess of them.
    fn round(
        &self,
        frame: &Frame,
        distance: &Distance,
        guess: &RoundGuess,
        (shapes, history, near): (&Shapes, &SharedSums, &[(Weights, usize)]),
    ) -> Round {
        let n = self.setting.n;
        let sizes: Vec<f64> = (0..n)
            .map(|i| guess.inside.iter().map(|(l, h)| l[i].abs().max(h[i].abs())).largest())
            .collect();
        let smooth = self.setting.smooth_boxes(distance, guess, &sizes);
        let mut boxes = Vec::with_capacity(frame.len);
        let (mut signs, mut added) = (Vec::with_capacity(frame.len), Vec::new());
        for at in 0..frame.len {
            let k = frame.first + at;
            let (mut own, middle) =
                self.setting.sample_boxes(frame, (k, &smooth), &guess.inside[at]);
            added.push(self.setting.added(
                distance,
                (k, &guess.reach),
                &guess.inside[at],
                &mut own,
            ));
            boxes.push(own);
            signs.push(middle);
        }
        let (after, spread) = shapes.advance(&self.setting, frame, (&signs, &added));
        let radii = self.radii(frame, (history, near), &boxes, guess);
        self.setting.conclude(
            self.past.last(),
            (frame, distance),
            (boxes, after, spread, radii, sizes),
        )
    }

    /// Boxes of the difference of the shifted copies of the reference system, for samples of this window.
    fn shift_boxes(&self, frame: &Frame, rest: (&[f64], &[f64]), own: &Boxes) -> Boxes {
        let mut out = Boxes::none(self.setting.n, self.setting.hand);
        let from = (frame.first + 1).saturating_sub(self.shared);
        let mut seen = usize::MAX;
        for sample in from..frame.first {
            let at = self.window_of[sample];
            if at == seen {
                continue;
            }
            seen = at;
            out.cover(&self.setting.shifted((frame, &self.past[at].frame), rest, own));
        }
        out
    }

    /// Radii of all outputs of a window.
    fn radii(
        &self,
        frame: &Frame,
        (history, near): (&SharedSums, &[(Weights, usize)]),
        boxes: &[Boxes],
        guess: &RoundGuess,
    ) -> Vec<f64> {
        let mut sums = history.clone();
        sums.torques.truncate(frame.len * sums.common.len());
        let mut torques = vec![0.0; self.setting.n * frame.len];
        let shared = frame.len > 1;
        let shift = if shared {
            let own = &boxes[0];
            self.shift_boxes(frame, (&guess.rest.0, &guess.rest.1), own)
        } else {
            Boxes::none(self.setting.n, self.setting.hand)
        };
        let moved: Vec<Boxes> = boxes.iter().map(|own| own.plus(&shift)).collect();
        for (weights, at) in near {
            let own = self.past.get(*at).map_or(frame, |past| &past.frame);
            let mut cover = Boxes::none(self.setting.n, self.setting.hand);
            for later in 0..frame.len {
                let sample = weights.sample + later;
                let here = match sample.checked_sub(frame.first) {
                    None => self.known(sample, later),
                    Some(own) if later == 0 => &boxes[own],
                    Some(own) => &moved[own],
                };
                let to = torques[later..].iter_mut().step_by(frame.len);
                to.zip(&here.u).for_each(|(to, u)| *to = *u);
                cover.cover(here);
            }
            weights.add_torques((&torques, frame.len), &mut sums.torques);
            weights.add_rest(&cover, own, self.setting.period, &mut sums.common);
        }
        sums.largest()
    }

    fn finish(
        &mut self,
        frame: Frame,
        round: &Round,
        guess: &RoundGuess,
        swept: &mut Swept,
    ) -> Result<(), ScopeRefusal> {
        let n = self.setting.n;
        let (torques, steps) = self.torques(&frame, round)?;
        let own = &round.boxes[0];
        let shift = self.shift_boxes(&frame, (&guess.rest.0, &guess.rest.1), own);
        for own in &round.boxes {
            self.shifted.push(own.plus(&shift));
            self.raw.push(own.clone());
        }
        // Samples whose whole reach is known now.
        while self.dilated.len() + self.shared <= self.shifted.len() {
            let at = self.dilated.len();
            let mut cover = Boxes::none(n, self.setting.hand);
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
        }
        swept.torque.extend(torques);
        swept.torque_step.extend(steps);
        let rest = (round.radii[..n].to_vec(), round.radii[n..2 * n].to_vec());
        self.past.push(Past { frame, rest });
        Ok(())
    }

    /// Largest torques and torque steps of each sample of a window, by joint.
    fn torques(&self, frame: &Frame, round: &Round) -> Result<SampleTorques, ScopeRefusal> {
        let n = self.setting.n;
        let (mut torques, mut steps) = (Vec::new(), Vec::new());
        for at in 0..frame.len {
            let k = frame.first + at;
            let nominal = &self.setting.run.command[k];
            let before = if k > 0 {
                self.setting.run.command[k - 1].clone()
            } else {
                self.setting.inputs.held()
            };
            let of = |i: usize| {
                let ((tl, th), (sl, sh)) = (&round.spread.torque[at], &round.spread.step[at]);
                let (t, s) = (round.radii[2 * n + i], round.radii[3 * n + i]);
                let torque = (nominal[i] + tl[i] - t).abs().max((nominal[i] + th[i] + t).abs());
                let change = nominal[i] - before[i];
                let step = (change + sl[i] - s).abs().max((change + sh[i] + s).abs());
                (torque, step)
            };
            let both: Vec<(f64, f64)> = (0..n).map(of).collect();
            for (i, both) in both.iter().enumerate() {
                self.check_limits(k, i, *both)?;
            }
            let (torque, step) = both.into_iter().unzip();
            torques.push(torque);
            steps.push(step);
        }
        Ok((torques, steps))
    }

    fn check_limits(
        &self,
        k: usize,
        i: usize,
        (torque, step): (f64, f64),
    ) -> Result<(), ScopeRefusal> {
        let (most, rate) = self.setting.inputs.study.limits(i);
        let beyond = most.is_some_and(|most| reaches(torque, most))
            || rate.is_some_and(|rate| reaches(step, rate * self.setting.period));
        if beyond {
            let joint = self.setting.inputs.joints[i].name.clone();
            return Err(ScopeRefusal::LimitCanAct { t: k as f64 * self.setting.period, joint });
        }
        Ok(())
    }

    /// Bounds the whole state at each anchor whose samples are all done.
    fn bound_anchors(&mut self, done: usize) {
        loop {
            let next = self.anchors.last().map_or(FIRST_ANCHOR, |a| a.at + self.spacing);
            // Instants next … next + shared − 1 use the samples before them.
            if done + 1 < next + self.shared {
                return;
            }
            let states = self.setting.rows().states();
            let state_at = |from: usize, shared: bool| {
                let mut back = Back::new(self.setting.n, self.setting.hand, states, states);
                for i in 0..states {
                    back.lambda[i * back.rows + i] = 1.0;
                }
                let own = if shared { next + self.shared - 1 } else { from };
                self.go_back(&mut back, None, (from, own, shared)).0.largest()
            };
            let bounds = if next == FIRST_ANCHOR {
                let each = (next..next + self.shared).map(|at| state_at(at, false));
                let cover = |a: Vec<f64>, b: Vec<f64>| {
                    a.iter().zip(b).map(|(a, b)| larger(*a, b)).collect()
                };
                each.reduce(cover).unwrap_or_default()
            } else {
                state_at(next, true)
            };
            self.anchors.push(Anchor { at: next, bounds });
        }
    }
}

/// Samples after which the response of positions to a torque is forgotten, at most `most`.
fn memory(setting: &TubeSetting<'_>, most: usize) -> usize {
    let last = setting.run.command.len().saturating_sub(1);
    let at = (FIRST_ANCHOR.min(last), 1);
    let Some((frame, _)) = setting.arm.window(setting.run, at, &vec![1e-6; setting.n]) else {
        return most;
    };
    let (n, rows) = (setting.n, setting.rows());
    let mut back = setting.start_rows(&frame);
    let (mut largest, mut memory) = (0.0, 1);
    for sample in 1..=most {
        rows.step(&mut back, &frame, frame.first);
        let of = |joint: usize| -> f64 {
            (0..n).map(|i| back.lambda[(n + i) * back.rows + joint].abs()).sum()
        };
        let size = (0..n).map(of).largest();
        largest = larger(largest, size);
        if reaches(size, FORGOTTEN * largest) {
            memory = sample;
        }
    }
    memory
}

fn widened(low: &[f64], high: &[f64], by: &[f64]) -> (Vec<f64>, Vec<f64>) {
    (
        low.iter().zip(by).map(|(l, r)| l - r).collect(),
        high.iter().zip(by).map(|(h, r)| h + r).collect(),
    )
}
