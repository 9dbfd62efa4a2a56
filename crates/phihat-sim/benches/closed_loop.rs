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

/// Batches that are timed together: what has been computed is told in steps of some milliseconds.
const REPEATED: usize = 8;

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

/// Processor time of this thread \[s\], which does not grow while it waits for others; elapsed time where the
/// system does not report it.
fn computed() -> f64 {
    let told = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let ns = told.and_then(|told| told.split(' ').next()?.parse::<f64>().ok());
    ns.map_or_else(
        || {
            std::time::SystemTime::now()
                .duration_since(std::time::UNIX_EPOCH)
                .unwrap()
                .as_secs_f64()
        },
        |ns| ns * 1e-9,
    )
}

/// The same with figures alone, and of as many arms as there are lanes, each with load, friction and seed of
/// its own, one after the other in one program: simulated seconds of all arms per second of one core, and the
/// ratio; each a median and the quartiles.
fn figures(study: &Study, arms: usize, runs: usize) -> [[f64; 3]; 3] {
    let gains = gains(study);
    let own = |arm: usize| {
        let mut study = study.clone();
        if let Some(payload) = &mut study.world.payload {
            payload.mass = 0.1 * arm as f64;
        }
        for (i, coulomb) in study.world.extra_coulomb.iter_mut().enumerate() {
            *coulomb *= 1.0 + 0.05 * ((arm + i) % 8) as f64;
        }
        study.seed = arm as u64;
        study
    };
    let studies: Vec<Study> = (0..arms).map(own).collect();
    let (mut alone, mut together, mut ratio) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..runs {
        let simulation = Simulation::new(study, &gains).unwrap();
        let start = computed();
        let mut measured = Measured::new(study);
        let Ok(_) = simulation.record(&mut measured, |_| ());
        alone.push(study.duration / (computed() - start));
        let batch = || {
            let simulations = studies.iter().map(|study| Simulation::new(study, &gains).unwrap());
            let batch = Batch::new(simulations.collect());
            assert_eq!(batch.alone().count(), 0);
            batch
        };
        let batches: Vec<Batch> = (0..REPEATED).map(|_| batch()).collect();
        let all: Vec<&Study> = studies.iter().collect();
        let start = computed();
        let figures: Vec<_> = batches.into_iter().flat_map(|batch| batch.measure(&all)).collect();
        together.push((REPEATED * arms) as f64 * study.duration / (computed() - start));
        assert!(figures.iter().all(|(_, ended)| ended.divergence.is_none()));
        ratio.push(together[together.len() - 1] / alone[alone.len() - 1]);
    }
    [alone, together, ratio].map(|mut all| {
        all.sort_by(f64::total_cmp);
        [all.len() / 4, all.len() / 2, 3 * all.len() / 4].map(|at| all[at])
    })
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
    let [alone, together, ratio] = figures(&full, 8, if quick { 1 } else { 15 });
    let [_, bare, _] = figures(&plain, 8, if quick { 1 } else { 15 });
    let [low, ratio, high] = ratio;
    for (name, [first, median, third]) in [
        ("full_world_figures", alone),
        ("full_world_figures_in_lanes", together),
        ("rk4_many", bare),
    ] {
        print!(r#"{{"algorithm":"closed_loop_panda_{name}","times_real_time":{median:.1},"#);
        println!(r#""quartiles":[{first:.1},{third:.1}]}}"#);
    }
    println!(
        r#"{{"algorithm":"lanes_over_alone","ratio":{ratio:.2},"quartiles":[{low:.2},{high:.2}]}}"#
    );
}
