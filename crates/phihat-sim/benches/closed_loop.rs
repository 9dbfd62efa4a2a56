//! Simulated seconds per wall second of the 7-joint Panda at 1 kHz, RK4 with one step per sample:
//! `cargo bench -p phihat-sim --bench closed_loop` prints one JSON line per study.
#![allow(clippy::print_stdout, reason = "a benchmark prints its figures")]
#![allow(clippy::disallowed_methods, reason = "a benchmark reads the clock")]
#![allow(clippy::unwrap_used, reason = "a benchmark stops on a bad set-up")]

use std::path::Path;
use std::time::Instant;

use phihat::{Form, JointDesign, JointGains};
use phihat_sim::{Batch, Measured, Simulation};
use phihat_study::Study;

/// Reference: one sinusoid per joint, as in the loops of other libraries that this is set beside.
const PLAIN: &str = r#"
duration_s = 20.0
[robot]
name = "panda"
[gains]
order = 2
bandwidth_rad_s = 20.0
damping = 1.0
estimator_bandwidth_rad_s = 70.0
estimator_damping = 1.0
inertia_kg_m2 = 1.0
[world]
friction = "none"
[reference]
kind = "sines"
center = "ready"
fade_in_s = 1.0
[[reference.sine]]
amplitude_rad = 0.2
frequency_hz = [0.2, 0.22, 0.24, 0.26, 0.28, 0.3, 0.32]
phase_rad = 0.0
"#;

fn gains(study: &Study) -> Vec<JointGains<f64>> {
    let a = &[4900.0, 140.0];
    let (period, form) = (1e-3, Form::Observer);
    let joint = |m: &f64| {
        JointGains::new(&JointDesign { inertia: *m, kp: 400.0, kd: 40.0, a, period, form })
    };
    study.gains.as_ref().unwrap().inertia.iter().map(|m| joint(m).unwrap()).collect()
}

fn times_real_time(study: &Study, runs: usize) -> f64 {
    let gains = gains(study);
    let mut times: Vec<f64> = (0..runs)
        .map(|_| {
            let simulation = Simulation::new(study, &gains).unwrap();
            let start = Instant::now();
            let outcome = simulation.run(|_| ());
            let elapsed = start.elapsed().as_secs_f64();
            assert!(outcome.divergence.is_none());
            study.duration / elapsed
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// The same with figures alone, and of as many arms as there are lanes, each with a load of its own: simulated seconds of all
/// arms per second of one core.
fn figures(study: &Study, arms: usize, runs: usize) -> (f64, f64) {
    let gains = gains(study);
    let own = |arm: usize| {
        let mut study = study.clone();
        if let Some(payload) = &mut study.world.payload {
            payload.mass = 0.1 * arm as f64;
        }
        study.seed = arm as u64;
        study
    };
    let studies: Vec<Study> = (0..arms).map(own).collect();
    let (mut alone, mut together) = (Vec::new(), Vec::new());
    for _ in 0..runs {
        let simulation = Simulation::new(study, &gains).unwrap();
        let start = Instant::now();
        let mut measured = Measured::new(study);
        let each = |block: &mut phihat_sim::Trace| -> Result<(), std::convert::Infallible> {
            measured.block(block);
            Ok(())
        };
        let Ok(_) = simulation.stream(64, |_| (), each);
        alone.push(study.duration / start.elapsed().as_secs_f64());
        let simulations = studies.iter().map(|study| Simulation::new(study, &gains).unwrap());
        let batch = Batch::new(simulations.collect());
        assert_eq!(batch.alone().count(), 0);
        let start = Instant::now();
        let figures = batch.measure(&studies.iter().collect::<Vec<_>>());
        together.push(arms as f64 * study.duration / start.elapsed().as_secs_f64());
        assert!(figures.iter().all(|(_, ended)| ended.divergence.is_none()));
    }
    alone.sort_by(f64::total_cmp);
    together.sort_by(f64::total_cmp);
    (alone[runs / 2], together[runs / 2])
}

fn main() {
    let asked = |word: &str| std::env::args().any(|a| a == word);
    // `cargo bench` says `--bench`; run as a test it is brief.
    let quick = asked("--quick") || !asked("--bench");
    let runs = if quick { 1 } else { 15 };
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let plain = Study::from_text(PLAIN, "closed_loop", &root).unwrap();
    let full = Study::read(&root.join("studies/panda_hand.toml")).unwrap();
    for (name, study) in
        [("closed_loop_panda_rk4", &plain), ("closed_loop_panda_full_world", &full)]
    {
        let figure = times_real_time(study, runs);
        println!(r#"{{"algorithm":"{name}","times_real_time":{figure:.1}}}"#);
    }
    let (alone, together) = figures(&full, 8, if quick { 1 } else { 9 });
    for (name, figure) in [("figures", alone), ("figures_in_lanes", together)] {
        println!(
            r#"{{"algorithm":"closed_loop_panda_full_world_{name}","times_real_time":{figure:.1}}}"#
        );
    }
}
