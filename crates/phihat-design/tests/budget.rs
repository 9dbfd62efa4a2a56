//! Parts of an error budget against closed forms of the continuous loop, and the largest speed of a law
//! against the loop itself, played. Wrong if a part had another size than the integral that it stands for, or
//! if a law reported as stable grew.

use phihat::{
    Form, JointDesign, JointGains, JointState, Measurement, Reference, TorqueSource, VelocitySource,
};
use phihat_design::budget::{Cause, by_own_loop, largest_stable};
use phihat_design::sampled::LoopModel;
use phihat_design::{Gains, JointRecord, Phi, PhiBasis, requested_gains};
use phihat_study::Study;

const W: f64 = 20.0;
const A: f64 = 60.0;

fn study(rest: &str) -> Study {
    let text = format!(
        "duration_s = 2.0\n[robot]\nname = \"planar3r\"\n[spec]\nsettle_s = 1.0\nerror_bound_rad = \
         1e-3\n[gains]\norder = 1\nbandwidth_rad_s = {W:?}\nestimator_bandwidth_rad_s = {A:?}\ninertia_kg_m2 = \
         0.5\n[loop]\nrate_hz = 10000.0\n{rest}\n[reference]\nkind = \"hold\"\npose = \"ready\"\n"
    );
    Study::from_text(&text, "loop.toml", "".as_ref()).unwrap_or_else(|e| panic!("{e}"))
}

fn known(rate: f64, jump: f64) -> Phi {
    Phi {
        basis: PhiBasis::Typed,
        source: String::new(),
        size_nm: None,
        rate_nm_s: rate,
        jump_nm: jump,
        motion: None,
    }
}

#[test]
fn parts_are_the_integrals_of_the_continuous_loop() {
    let study = study("");
    let gains: Gains = requested_gains(&study).unwrap();
    // e/(φ/M̄) = s/((s + A)(s + W)²): with its impulse response h, a jump costs at most ∫|h|,
    // a ramp ∫|∫h| = 1/(A W²), as 1/((s + A)(s + W)²) has no sign changes.
    let c = 1.0 / (A - W);
    let g = |t: f64| c * c * (-A * t).exp() + (c * t - c * c) * (-W * t).exp();
    let n = 200_000;
    let dt = 2.0 / f64::from(n);
    // h = ġ: its variation.
    let variation: f64 =
        (0..n).map(|k| (g(f64::from(k + 1) * dt) - g(f64::from(k) * dt)).abs()).sum();
    let (rate, jump) = (7.0, 0.4);
    for joint in by_own_loop(&study, &gains, (1.0, 1.0), &|_, _| known(rate, jump)) {
        let friction = joint.part(Cause::Friction).unwrap();
        let motion = joint.part(Cause::Motion).unwrap();
        assert!((friction / (variation * jump / 0.5) - 1.0).abs() < 0.02, "{friction}");
        assert!((motion / (rate / (A * W * W * 0.5)) - 1.0).abs() < 0.02, "{motion}");
        assert!((joint.total_rad.unwrap() - friction - motion).abs() < 1e-12);
        assert_eq!(joint.part(Cause::Encoder), Some(0.0));
    }
}

#[test]
fn delay_and_encoder_cost_more_the_more_of_them_there_is() {
    let of = |rest: &str| {
        let study = study(rest);
        let gains = requested_gains(&study).unwrap();
        by_own_loop(&study, &gains, (0.7, 1.4), &|_, _| known(7.0, 0.4)).remove(0)
    };
    let coarse = of("[sensor]\nencoder_bits = 14\nvelocity = \"differenced\"");
    let fine = of("[sensor]\nencoder_bits = 16\nvelocity = \"differenced\"");
    let ratio = coarse.part(Cause::Encoder).unwrap() / fine.part(Cause::Encoder).unwrap();
    assert!((ratio - 4.0).abs() < 1e-6, "two bits are a factor of four: {ratio}");
    let late = of("delay_samples = 8");
    let prompt = of("");
    let within = late.parts.iter().find(|part| part.within).unwrap();
    assert_eq!(within.cause, Cause::Delay);
    let lost = late.total_rad.unwrap() - prompt.total_rad.unwrap();
    assert!(lost > 0.0 && (within.error_rad / lost - 1.0).abs() < 1e-9, "{within:?} {lost}");
}

/// Returns true if a kick dies out in a loop of the core's law and a double integrator, played sample by
/// sample.
fn forgets(law: &JointRecord, delay: usize, mu: f64, factor: f64) -> bool {
    let t = 1e-3;
    let a = [law.a[0] * factor];
    let gains = JointGains::new(&JointDesign {
        inertia: law.inertia_kg_m2,
        kp: law.kp_per_s2 * factor * factor,
        kd: law.kd_per_s * factor,
        a: &a,
        period: t,
        form: Form::Observer,
    })
    .unwrap();
    let (mut state, mut q, mut dq) = (JointState::new(), 1e-3, 0.0);
    let mut line = vec![0.0; delay + 1];
    let reference = Reference { q: 0.0, dq: 0.0, ddq: 0.0 };
    let mut size: f64 = 0.0;
    for k in 0..60_000 {
        let tau_applied = line[0];
        let tau = gains.update(&mut state, &Measurement { q, dq, tau_applied }, &reference).tau;
        line.rotate_left(1);
        line[delay] = tau;
        // With a delay of d the torque of this sample acts d samples on.
        let acts = line[0];
        let ddq = acts / (mu * law.inertia_kg_m2);
        q += t * dq + 0.5 * t * t * ddq;
        dq += t * ddq;
        if k >= 50_000 {
            size = size.max(q.abs());
        }
        if q.abs() > 1e6 {
            return false;
        }
    }
    size < 1e-6
}

#[test]
fn a_law_is_stable_as_far_as_it_is_told() {
    for (delay, ratios) in [(1_u32, (0.5, 2.0)), (3, (0.8, 1.3)), (0, (0.3, 1.0))] {
        let law = JointRecord {
            name: "joint".to_owned(),
            inertia_kg_m2: 0.5,
            kp_per_s2: 600.0 * 600.0,
            kd_per_s: 1200.0,
            a: vec![1500.0],
            observer: None,
        };
        let model = LoopModel {
            period_s: 1e-3,
            delay_samples: delay,
            sample_delay_samples: 0,
            torque: TorqueSource::Applied,
            velocity: VelocitySource::Measured,
            velocity_filter_hz: None,
            torque_filter_hz: None,
            form: Form::Observer,
            drive_bandwidth_hz: None,
        };
        let share = largest_stable(&law, &model, ratios).unwrap();
        assert!(share < 1.0, "{delay}: {share}");
        let ends = |factor: f64| {
            let between = [ratios.0, (ratios.0 * ratios.1).sqrt(), ratios.1];
            between.into_iter().all(|mu| forgets(&law, delay as usize, mu, factor))
        };
        assert!(ends(0.98 * share), "delay {delay}: {share} is told stable");
        assert!(!ends(1.03 * share), "delay {delay}: {share} is told the largest");
    }
}
