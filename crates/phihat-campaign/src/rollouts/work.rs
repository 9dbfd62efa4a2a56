//! The runs, done in chunks on several threads.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::thread;
use std::time::Duration;

use phihat_sim::{Batch, Ended, FIGURES_BLOCK, Measured, Metrics, Trace};

use crate::sweep::SweepEnd;

use super::error::RolloutsError;
use super::rolled::{JOINT_FIGURES, Keep, Rolled, RolledSignal};
use super::told::Rollouts;

/// Runs of a chunk, at most: eight groups of lanes.
const CHUNK_MAX: usize = 64;
/// Longest wait between two calls of `watch`.
const TICK: Duration = Duration::from_millis(50);

/// Some runs that are done.
struct Chunk {
    runs: Range<usize>,
    ends: Vec<(Metrics, Ended)>,
    /// Per signal: run, kept sample, joint.
    signals: Vec<Vec<f64>>,
    alone: usize,
}

/// Data that the threads share.
struct SharedWork<'a> {
    rollouts: &'a Rollouts,
    signals: &'a [&'static RolledSignal],
    every: u64,
    kept: usize,
    /// Nobody waits for what is being done any more.
    abort: AtomicBool,
}

impl Rollouts {
    /// Simulates all runs. `watch` is called with the numbers of finished and of all runs, at least twenty
    /// times a second; it ends the rollouts by returning `false`.
    ///
    /// # Errors
    ///
    /// [`RolloutsError`]: the first run that cannot begin, a signal that there is not, no memory, or it was ended.
    pub fn run(
        &self,
        keep: &Keep,
        threads: Option<u16>,
        watch: &mut dyn FnMut(u64, u64) -> bool,
    ) -> Result<Rolled, RolloutsError> {
        let signals = keep.found()?;
        if !signals.is_empty() && self.other_times() {
            let why = "signals: loop.rate_hz is told run by run, so their samples would be at other times in each";
            return Err(RolloutsError::Keep(why.to_owned()));
        }
        let samples = self.samples_max().div_ceil(keep.every);
        let kept = if signals.is_empty() { 0 } else { samples };
        let kept = usize::try_from(kept).unwrap_or(usize::MAX);
        let shape = (self.runs, self.study.robot.joints.len(), kept);
        let mut rolled = Rolled::with_room(shape, signals.len())?;
        let work = SharedWork {
            rollouts: self,
            signals: &signals,
            every: keep.every,
            kept,
            abort: AtomicBool::new(false),
        };
        work.all(&mut rolled, phihat_session::threads(threads), watch)?;
        Ok(rolled)
    }
}

impl SharedWork<'_> {
    fn all(
        &self,
        rolled: &mut Rolled,
        threads: usize,
        watch: &mut dyn FnMut(u64, u64) -> bool,
    ) -> Result<(), RolloutsError> {
        let runs = rolled.runs;
        let size = (runs / (4 * threads.max(1))).next_multiple_of(8).clamp(8, CHUNK_MAX);
        let count = runs.div_ceil(size);
        let (next, no_more) = (AtomicUsize::new(0), AtomicBool::new(false));
        let (sender, receiver) = sync_channel(2 * threads.max(1));
        let (mut first, mut done) = (None::<(usize, RolloutsError)>, 0);
        thread::scope(|scope| {
            for _ in 0..threads.clamp(1, count.max(1)) {
                let (sender, next, no_more) = (sender.clone(), &next, &no_more);
                scope.spawn(move || {
                    while !no_more.load(Ordering::Relaxed) {
                        let chunk = next.fetch_add(1, Ordering::Relaxed);
                        if chunk >= count {
                            break;
                        }
                        let own = chunk * size..((chunk + 1) * size).min(runs);
                        if sender.send((chunk, self.chunk(own))).is_err() {
                            break;
                        }
                    }
                });
            }
            drop(sender);
            let mut stopped = false;
            loop {
                match receiver.recv_timeout(TICK) {
                    Ok((_, Ok(chunk))) => {
                        done += chunk.runs.len() as u64;
                        put(rolled, chunk);
                    }
                    // Chunks before this one were begun before it: the first one that fails is known once all
                    // have ended.
                    Ok((at, Err(why))) => {
                        no_more.store(true, Ordering::Relaxed);
                        if first.as_ref().is_none_or(|(other, _)| at < *other) {
                            first = Some((at, why));
                        }
                    }
                    Err(RecvTimeoutError::Timeout) => {}
                    Err(RecvTimeoutError::Disconnected) => break,
                }
                if !stopped && !watch(done, runs as u64) {
                    stopped = true;
                    no_more.store(true, Ordering::Relaxed);
                    self.abort.store(true, Ordering::Relaxed);
                }
            }
            match (stopped, first) {
                (true, _) => Err(RolloutsError::Stopped),
                (false, Some((_, why))) => Err(why),
                (false, None) => Ok(()),
            }
        })
    }

    /// Some runs, in lanes where they can be.
    fn chunk(&self, runs: Range<usize>) -> Result<Chunk, RolloutsError> {
        let mut simulations = Vec::with_capacity(runs.len());
        let mut measured = Vec::with_capacity(runs.len());
        for run in runs.clone() {
            let (study, simulation) = self.rollouts.simulation(run)?;
            measured.push(Measured::new(&study));
            simulations.push(simulation);
        }
        let joints = self.rollouts.study.robot.joints.len();
        let length = runs.len() * self.kept * joints;
        let mut signals = vec![vec![f64::NAN; length]; self.signals.len()];
        let batch = Batch::new(simulations);
        let alone = batch.alone().count();
        let ends = batch.stream(FIGURES_BLOCK, |arm, block| {
            if self.abort.load(Ordering::Relaxed) {
                return Err(RolloutsError::Stopped);
            }
            if let Some(measured) = measured.get_mut(arm) {
                measured.block(block);
            }
            for (signal, values) in self.signals.iter().zip(&mut signals) {
                let own = arm * self.kept * joints..(arm + 1) * self.kept * joints;
                if let Some(values) = values.get_mut(own) {
                    self.keep(signal, block, values);
                }
            }
            Ok(())
        })?;
        let ends = measured.into_iter().map(Measured::metrics).zip(ends).collect();
        Ok(Chunk { runs, ends, signals, alone })
    }

    /// Every so many samples of a block, in their places: kept sample by kept sample, joint by joint.
    fn keep(&self, signal: &RolledSignal, block: &Trace, values: &mut [f64]) {
        let joints = block.joints.len();
        for (k, t_ns) in block.t_ns.iter().enumerate() {
            let sample = t_ns / block.period_ns.max(1);
            if !sample.is_multiple_of(self.every) {
                continue;
            }
            let at = usize::try_from(sample / self.every).unwrap_or(usize::MAX);
            let place = at.saturating_mul(joints);
            let Some(place) = values.get_mut(place..place.saturating_add(joints)) else { continue };
            for (value, joint) in place.iter_mut().zip(&block.joints) {
                if let Some(signal) = (signal.of)(joint).get(k) {
                    *value = *signal;
                }
            }
        }
    }
}

/// Puts what is done in its place.
fn put(rolled: &mut Rolled, chunk: Chunk) {
    let Chunk { runs, ends, signals, alone } = chunk;
    rolled.in_lanes += runs.len() - alone;
    let first = runs.start * rolled.joints * rolled.kept;
    for (all, own) in rolled.signals.iter_mut().zip(&signals) {
        if let Some(place) = all.get_mut(first..first + own.len()) {
            place.copy_from_slice(own);
        }
    }
    for (run, (metrics, ended)) in runs.zip(&ends) {
        rolled.ended[run] = SweepEnd::of(ended);
        rolled.within_spec[run] = metrics.within_spec && rolled.ended[run] == SweepEnd::Whole;
        rolled.samples[run] = metrics.samples;
        rolled.tip[run] = metrics.tip.as_ref().map_or(f64::NAN, |tip| tip.error_steady_max_m);
        let place = run * rolled.joints..(run + 1) * rolled.joints;
        for (figure, all) in JOINT_FIGURES.iter().zip(&mut rolled.figures) {
            for (value, joint) in all[place.clone()].iter_mut().zip(&metrics.joints) {
                *value = (figure.of)(joint);
            }
        }
    }
}
