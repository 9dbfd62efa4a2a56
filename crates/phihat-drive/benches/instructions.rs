//! The control thread's own part of a cycle, to be counted by callgrind: `instructions supervised N`, or `bare`. The link is one that costs
//! nothing, so that what is counted is order, reference, law, supervisor and record.
#![allow(clippy::unwrap_used, reason = "a benchmark stops on a bad set-up")]

use std::sync::atomic::AtomicBool;

use phihat_design::requested_gains;
use phihat_drive::{Clock, Desk, Facts, Link, LinkFault, Order, Plan, SimLink, Wait, cycles, ring};
use phihat_sim::{Sample, Simulation};
use phihat_study::Study;

const STUDY: &str = r#"
duration_s = 60.0
[robot]
name = "panda"
[spec]
settle_s = 1.0
[gains]
order = 2
bandwidth_rad_s = 20.0
estimator_bandwidth_rad_s = 50.0
inertia_kg_m2 = [1.78, 2.22, 1.02, 1.28, 0.247, 0.259, 0.212]
[loop]
rate_hz = 1000.0
[reference]
kind = "sines"
center = "ready"
[[reference.sine]]
amplitude_rad = 0.1
frequency_hz = 0.3
"#;

/// A robot that stands still.
struct Still {
    facts: Facts,
    k: u64,
}

impl Link for Still {
    fn facts(&self) -> &Facts {
        &self.facts
    }
    fn start(&mut self) -> Result<(), LinkFault> {
        Ok(())
    }
    fn wait(&mut self, sample: &mut Sample) -> Wait {
        let t_ns = self.k * 1_000_000;
        (sample.sequence, sample.t_ns) = (self.k, t_ns);
        self.k += 1;
        Wait::Fresh { t_ns }
    }
    fn send(&mut self, tau: &[f64]) {
        core::hint::black_box(tau);
    }
    fn finish(&mut self, _: &[f64]) -> Result<(), LinkFault> {
        Ok(())
    }
    fn recover(&mut self) -> Result<(), LinkFault> {
        Ok(())
    }
}

fn main() {
    let mut words = std::env::args().skip(1).filter(|word| !word.starts_with("--"));
    let supervised = words.next().is_none_or(|word| word == "supervised");
    let samples = words.next().and_then(|count| count.parse().ok()).unwrap_or(100);
    let guard = if supervised { "[supervisor]\nstart_mismatch_max_rad = 9.0\n" } else { "" };
    let study = Study::from_text(&format!("{STUDY}{guard}"), "bench.toml", "".as_ref()).unwrap();
    let names: Vec<_> = study.robot.joints.iter().map(|joint| joint.name.clone()).collect();
    let gains = requested_gains(&study).unwrap();
    let law = gains.joint_gains(&names, study.control.period_ns, study.control.form).unwrap();
    let (mut control, _) = Simulation::new(&study, &law).unwrap().apart();
    let mut facts = SimLink::facts_of(&study, Clock::LockStep);
    facts.tells.truth = true;
    let mut desk = Desk::new(Order::new(&names, facts.joints.as_deref(), 7).unwrap(), 7);
    let (mut tape, _reader) = ring(7, 100_000, false);
    let stop = AtomicBool::new(false);
    let plan = Plan { samples, stop_samples: 0, stop: &stop };
    let tally = cycles(&mut Still { facts, k: 0 }, &mut control, &mut tape, &mut desk, &plan);
    assert_eq!(tally.cycles, samples, "{tally:?}");
}
