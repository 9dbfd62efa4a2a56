//! One causal sweep over the run: window by window, bounds that follow from bounds before them.

use super::adjoint::{Back, Boxes, Weights};
use super::dense::{count, reaches};
use super::frame::{Distance, Frame};
use super::round::{Past, Round, RoundGuess};
use super::scope::ScopeRefusal;
use super::setting::TubeSetting;
use super::shapes::Shapes;
use crate::extremes::Extremes as _;

/// Longest window of later outputs that share one set of rows \[s\].
const WINDOW: f64 = 5e-3;
/// Distance of the instants whose whole state is bounded \[s\].
const ANCHORS: f64 = 0.1;
/// Least time that rows go back \[s\]; beyond, the whole state's bound takes their place.
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

/// Whole-state bounds at an instant.
struct Anchor {
    at: usize,
    /// At the instant itself, and over the window of instants from it on.
    exact: Vec<f64>,
    shared: Vec<f64>,
}

/// Sums of the outputs of a window, which share one set of rows.
#[derive(Clone)]
struct SharedSums {
    /// Sums that are the same for all of them, by row.
    common: Vec<f64>,
    /// Sums of torques, for the output so many samples after the first, by row: friction of a joint that reverses is
    /// large for a few samples, and counts in those alone.
    torques: Vec<Vec<f64>>,
}

impl SharedSums {
    fn none(rows: usize, outputs: usize) -> Self {
        Self { common: vec![0.0; rows], torques: vec![vec![0.0; rows]; outputs] }
    }

    /// Largest sum of any of the outputs, by row.
    fn largest(&self) -> Vec<f64> {
        let torques = |row: usize| self.torques.iter().map(|sums| sums[row]).largest();
        self.common.iter().enumerate().map(|(row, common)| common + torques(row)).collect()
    }
}

/// Bounds that grow, window by window.
pub(super) struct CheckedSweep<'a> {
    setting: TubeSetting<'a>,
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
}

impl<'a> CheckedSweep<'a> {
    pub(super) fn new(setting: TubeSetting<'a>) -> Self {
        let whole = |x: f64| count((x / setting.period).round().max(1.0));
        Self {
            shared: whole(WINDOW),
            spacing: whole(ANCHORS),
            memory: whole(MEMORY),
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
        while first < samples {
            let ready = first + 1 >= self.memory + self.spacing
                && self.anchors.iter().any(|a| a.at + self.memory <= first + 1);
            let len = if ready { self.shared.min(samples - first) } else { 1 };
            let t = first as f64 * self.setting.period;
            let round = self.window((first, len), &shapes, guess.take(), &mut swept)?;
            guess = Some(round.1);
            shapes = round.0;
            first += len;
            self.bound_anchor(first);
            progress(t / (samples as f64 * self.setting.period));
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
        let anchor = self.anchors.iter().rev().find(|a| a.at + self.memory <= from);
        let stop = anchor.map_or(0, |a| a.at);
        let reach = if shared { self.shared } else { 1 };
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
                for (shift, sums) in sums.torques.iter_mut().enumerate() {
                    weights.add_torques(&self.known(sample + shift, shift).u, sums);
                }
            }
        }
        if let Some(anchor) = anchor {
            let bounds = if shared { &anchor.shared } else { &anchor.exact };
            for (lambda, bound) in back.lambda.chunks_exact(back.rows).zip(bounds) {
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
        sums.torques.truncate(frame.len);
        let shared = frame.len > 1;
        let shift = if shared {
            let own = &boxes[0];
            self.shift_boxes(frame, (&guess.rest.0, &guess.rest.1), own)
        } else {
            Boxes::none(self.setting.n, self.setting.hand)
        };
        for (weights, at) in near {
            let own = self.past.get(*at).map_or(frame, |past| &past.frame);
            let mut cover = Boxes::none(self.setting.n, self.setting.hand);
            for (later, sums) in sums.torques.iter_mut().enumerate() {
                let sample = weights.sample + later;
                let here = if sample < frame.first {
                    self.known(sample, later).clone()
                } else {
                    let mut here = boxes[sample - frame.first].clone();
                    if later > 0 {
                        add(&mut here, &shift);
                    }
                    here
                };
                weights.add_torques(&here.u, sums);
                cover.cover(&here);
            }
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
            let k = frame.first + at - 1;
            let nominal = &self.setting.run.command[k];
            let before = if k > 0 {
                self.setting.run.command[k - 1].clone()
            } else {
                self.setting.inputs.held()
            };
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

    /// Bounds the whole state at an anchor, once all samples that its window needs are done.
    fn bound_anchor(&mut self, done: usize) {
        let next = self.anchors.last().map_or(self.spacing, |a| a.at + self.spacing);
        // Instants next … next+shared−1 use samples before them.
        if done + 1 < next + self.shared {
            return;
        }
        let states = self.setting.rows().states();
        let identity = || {
            let mut back = Back::new(self.setting.n, self.setting.hand, states, states);
            for i in 0..states {
                back.lambda[i * back.rows + i] = 1.0;
            }
            back
        };
        let known = |from: usize| self.anchors.iter().any(|a| a.at + self.memory <= from);
        let exact = self.go_back(&mut identity(), None, (next, next, false)).0.largest();
        let shared = if known(next) {
            let own = next + self.shared - 1;
            self.go_back(&mut identity(), None, (next, own, true)).0.largest()
        } else {
            let mut most = exact.clone();
            for later in 1..self.shared {
                let at = next + later;
                let here = self.go_back(&mut identity(), None, (at, at, false)).0.largest();
                most.iter_mut().zip(here).for_each(|(m, h)| *m = m.max(h));
            }
            most
        };
        self.anchors.push(Anchor { at: next, exact, shared });
    }
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
