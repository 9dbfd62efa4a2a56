//! 05: a run with everything that hurts in a laboratory, its figures, and a report.
//!
//! Run it: `cargo run --release -p phihat-examples --example 05_simulate`

use std::error::Error;
use std::path::Path;

use phihat::Form;
use phihat_design::{Arm, arm_inside_window, requested_gains};
use phihat_report::{Drawing, Record, RunInfo, page};
use phihat_sim::{Metrics, Simulation};
use phihat_study::Study;

fn main() -> Result<(), Box<dyn Error>> {
    // Unknown payload and friction, 18-bit encoders, no velocity sensor, one sample of delay.
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut study = Study::read(&root.join("studies/panda_hand.toml"))?;
    study.duration = 4.0; // of 10 s: this is an example

    // This study states its gains. They run only if the arm's inertia stays inside their window.
    let gains = requested_gains(&study).ok_or("the study states no gains")?;
    arm_inside_window(&study, &Arm::of(&study)?, &gains)?;
    let names = study.robot.joint_names();
    let law = gains.joint_gains(&names, study.control.period_ns, Form::Observer)?;

    let run = Simulation::new(&study, &law)?.run(|_samples_done| ());
    assert!(run.divergence.is_none() && run.abort.is_none());

    // One row of figures per joint; "steady" means after spec.settle_s.
    let metrics = Metrics::of(&run.trace, &study);
    for joint in &metrics.joints {
        println!("{}: {:.3} mrad", joint.name, 1e3 * joint.error_steady_max_rad);
        assert!(joint.error_steady_max_rad < 5e-4);
    }
    assert!(metrics.within_spec);

    // φ̂ is the controller's estimate of everything it was not told. The trace has every signal of every sample.
    let from = run.trace.index_at(study.spec.settle);
    for joint in &run.trace.joints {
        let (phi, phi_hat) = (&joint.phi[from..], &joint.phi_hat[from..]);
        let largest = phi.iter().fold(0.0_f64, |most, phi| most.max(phi.abs()));
        let squares = phi.iter().zip(phi_hat).map(|(phi, hat)| (phi - hat).powi(2)).sum::<f64>();
        let missed = (squares / phi.len() as f64).sqrt();
        println!("{}: |φ| up to {largest:.1} N·m, {missed:.2} N·m (rms) missed", joint.name);
        assert!(missed < 0.5);
    }

    // The same study, the same bits.
    let again = Simulation::new(&study, &law)?.run(|_| ());
    assert!(again.trace == run.trace);

    // The report: a pure function of the record, one page, no network.
    let html = page(&Record {
        run: &origin(&study),
        study_text: &study.text,
        gains: Some(&gains),
        drawing: &Drawing::of(&run.trace, study.spec.settle),
        metrics: &metrics,
        tube: None,
    });
    let file = std::env::temp_dir().join(format!("phihat-{}-report.html", std::process::id()));
    std::fs::write(&file, &html)?;
    println!("report: {} kB", std::fs::metadata(&file)?.len() / 1000);
    std::fs::remove_file(&file)?;
    Ok(())
}

/// Origin of the run: the page repeats it, so that a reader can make it again.
fn origin(study: &Study) -> RunInfo {
    RunInfo {
        study: study.name.clone(),
        title: study.title.clone(),
        study_sha256: study.sha256.clone(),
        seed: study.seed,
        robot: study.robot.name.clone(),
        robot_description: study.robot.description.clone(),
        robot_provenance: study.robot.provenance.clone(),
        phihat_version: env!("CARGO_PKG_VERSION").to_owned(),
        toolchain: std::env::consts::ARCH.to_owned(),
        form: "observer".to_owned(),
        rate_hz: 1e9 / study.control.period_ns as f64,
        delay_samples: study.control.delay_samples,
        world: Vec::new(),
        command: "cargo run -p phihat-examples --example 05_simulate".to_owned(),
        warnings: vec!["the first 4 s of a study of 10 s".to_owned()],
        bound: None,
        contact: None,
    }
}

#[test]
fn runs() -> Result<(), Box<dyn Error>> {
    main()
}
