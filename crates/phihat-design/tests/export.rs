//! Exported gains are the controller they say they are: the YAML read by a YAML parser and run as ROS 2 runs a PID,
//! the C header compiled and run, the table read back. Wrong if a gain, a sign or a unit were exported wrongly, if a
//! name broke out of its place, or if what is claimed of the PID did not hold for it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use phihat::{Form, JointState, Measurement, Reference};
use phihat_design::export::{PidClaims, Target, export};
use phihat_design::{
    Arm, FilterSection, Gains, Outcome, Phi, PhiBasis, PositionObserver, design, requested_gains,
};
use phihat_study::Study;
use yaml_rust2::{Yaml, YamlLoader};

/// Names that try to leave a string, a comment or a row.
const HOSTILE: [&str; 3] = ["a\"b\\n ??/ */ end", "γ: {x}, #1\t\u{7}", "- 'yes' \n%"];

fn study(order: u32, rest: &str) -> Study {
    let text = format!(
        "duration_s = 4.0\n[robot]\nname = \"planar3r\"\n[spec]\nsettle_s = 2.0\nerror_bound_rad = 4e-3\n\
         [design]\ninertia_low_kg_m2 = [0.3, 0.2, 0.1]\n\
         inertia_high_kg_m2 = [0.6, 0.4, 0.2]\norders = [{order}]\n[loop]\ndelay_samples = 1\n{rest}\n[sensor]\n\
         encoder_bits = 18\nvelocity = \"differenced\"\nvelocity_filter_hz = 100.0\n[reference]\n\
         kind = \"sines\"\ncenter_rad = [0.3, 0.8, 0.4]\nfade_in_s = 1.0\n[[reference.sine]]\n\
         amplitude_rad = 0.2\nfrequency_hz = 0.2\nphase_rad = 0.7\n"
    );
    Study::from_text(&text, "arm.toml", Path::new(".")).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

fn designed(order: u32, rest: &str) -> Gains {
    let phi = |_: usize, _: f64| Phi {
        basis: PhiBasis::Typed,
        source: "typed".to_owned(),
        size_nm: Some(6.0),
        rate_nm_s: 8.0,
        jump_nm: 0.1,
        motion: None,
    };
    let study = study(order, rest);
    match design(&study, &Arm::of(&study).unwrap(), &phi).unwrap() {
        Outcome::Designed(gains) => *gains,
        Outcome::Infeasible(no) => panic!("{no:?}"),
    }
}

fn uncertified(a: &str) -> Gains {
    let text = format!(
        "duration_s = 2.0\n[robot]\nname = \"planar3r\"\n[gains]\nkp_per_s2 = 400.0\nkd_per_s = 40.0\n\
         a = {a}\ninertia_kg_m2 = [0.4, 0.3, 0.2]\n[reference]\nkind = \"hold\"\nq_rad = 0.0\n"
    );
    let study = Study::from_text(&text, "arm.toml", Path::new("."));
    requested_gains(&study.unwrap_or_else(|e| panic!("{e}"))).unwrap()
}

/// A PID as `control_toolbox` runs it: the clamped integral term first, then the answer.
struct RosPid {
    p: f64,
    i: f64,
    d: f64,
    i_clamp: f64,
    u_clamp: f64,
    i_term: f64,
}

impl RosPid {
    /// Every number must be a YAML float: ROS refuses an integer for a parameter of type double.
    fn read(entry: &Yaml) -> Self {
        let real = |key: &str| match &entry[key] {
            Yaml::Real(text) => text.parse::<f64>().unwrap(),
            other => panic!("{key} is {other:?}"),
        };
        let clamp = |high: &str, low: &str| {
            if entry[high].is_badvalue() {
                return f64::INFINITY;
            }
            assert!((real(high) + real(low)).abs() < 1e-12);
            real(high)
        };
        Self {
            p: real("p"),
            i: real("i"),
            d: real("d"),
            i_clamp: clamp("i_clamp_max", "i_clamp_min"),
            u_clamp: clamp("u_clamp_max", "u_clamp_min"),
            i_term: 0.0,
        }
    }

    fn command(&mut self, error: f64, error_dot: f64, dt: f64) -> f64 {
        self.i_term = (self.i_term + self.i * dt * error).clamp(-self.i_clamp, self.i_clamp);
        (self.p * error + self.i_term + self.d * error_dot).clamp(-self.u_clamp, self.u_clamp)
    }
}

fn pids(text: &str, names: &[&str]) -> Vec<RosPid> {
    let documents = YamlLoader::load_from_str(text).unwrap();
    let parameters = &documents[0]["joint_trajectory_controller"]["ros__parameters"];
    let joints: Vec<&str> =
        parameters["joints"].as_vec().unwrap().iter().map(|y| y.as_str().unwrap()).collect();
    assert_eq!(joints, names);
    assert_eq!(parameters["command_interfaces"][0].as_str(), Some("effort"));
    assert_eq!(
        documents[0]["controller_manager"]["ros__parameters"]["update_rate"].as_i64(),
        Some(1000)
    );
    names.iter().map(|name| RosPid::read(&parameters["gains"][*name])).collect()
}

fn signal(k: u32, seed: f64) -> f64 {
    let t = f64::from(k) * 1e-3;
    1e-3 * ((17.0 * t).sin() * seed + (53.0 * t).cos() - 1.0)
}

#[test]
fn the_yaml_is_the_literal_law() {
    let mut gains = designed(1, "torque_max_nm = 1e5");
    for (joint, name) in gains.joints.iter_mut().zip(HOSTILE) {
        joint.name = name.to_owned();
    }
    for (joint, name) in gains.certificate.as_mut().unwrap().joints.iter_mut().zip(HOSTILE) {
        joint.name = name.to_owned();
    }
    let text = export(&gains, Target::Ros).unwrap();
    let names: Vec<String> = HOSTILE.map(str::to_owned).into();
    let law = gains.joint_gains(&names, 1_000_000, Form::Literal).unwrap();
    for (j, (gains, mut pid)) in law.iter().zip(pids(&text, &HOSTILE)).enumerate() {
        let mut state = JointState::new();
        let seed = 1.0 + j as f64;
        for k in 0..3000 {
            let reference =
                Reference { q: signal(k, seed), dq: signal(k, -seed), ddq: 90.0 * signal(k, 2.0) };
            let measurement =
                Measurement { q: signal(k, 3.0), dq: 9.0 * signal(k, 4.0), tau_applied: 0.0 };
            // ROS 2 takes the feed-forward as the effort of the trajectory point.
            let effort = gains.inertia() * reference.ddq;
            let ros = effort
                + pid.command(reference.q - measurement.q, reference.dq - measurement.dq, 1e-3);
            let tau = gains.update(&mut state, &measurement, &reference).tau;
            assert!(
                (tau - ros).abs() <= 1e-9 * (1.0 + tau.abs()),
                "joint {j} sample {k}: {tau} {ros}"
            );
        }
    }
}

/// `q_d, q̇_d, q̈_d` of 0.2 sin² (0.9 t): from rest; `|q̈_d| ≤ 0.324`, `|q⃛_d| ≤ 0.583`.
fn reference(t: f64) -> [f64; 3] {
    let (s, c) = (1.8 * t).sin_cos();
    [0.1 * (1.0 - c), 0.18 * s, 0.324 * c]
}

/// The exported PID around an inertia `mu M̄` with what its certificate knows of: delay, encoder, filter, and a `φ` of
/// full size, rate and jump. The largest steady |e|, and the largest integral term of the whole run.
fn closed_loop(pid: &mut RosPid, inertia: f64, mu: f64, forward: bool) -> (f64, f64) {
    const T: f64 = 1e-3;
    let quantum = std::f64::consts::TAU / 2.0_f64.powi(18);
    let gain = 1.0 - (-std::f64::consts::TAU * 100.0 * T).exp();
    let (mut q, mut dq, mut before, mut filtered, mut late) = (0.0_f64, 0.0, 0.0, 0.0, 0.0);
    let (mut worst, mut integral) = (0.0_f64, 0.0_f64);
    for k in 0..12_000_u32 {
        let t = f64::from(k) * T;
        let [qd, dqd, ddqd] = reference(t);
        let sensed = quantum * (q / quantum).round();
        filtered += gain * ((sensed - before) / T - filtered);
        before = sensed;
        let effort = if forward { inertia * ddqd } else { 0.0 };
        let command = effort + pid.command(qd - sensed, dqd - filtered, T);
        if k >= 6000 {
            worst = worst.max((q - qd).abs());
        }
        integral = integral.max(pid.i_term.abs());
        // A triangle of slope 8 up to 5.9 and a jump of 0.1 as often as it hurts; (M − M̄) q̈_d is part of φ.
        let phase = (8.0 * t / 5.9 + 1.0).rem_euclid(4.0);
        let smooth = 5.9 * if phase < 2.0 { phase - 1.0 } else { 3.0 - phase };
        let asked = (mu - 1.0) * inertia * ddqd;
        let own = smooth + 0.1 * (47.0 * t).sin().signum() - asked;
        let ddq = (late - own) / (mu * inertia);
        q += T * dq + 0.5 * T * T * ddq;
        dq += T * ddq;
        late = command;
    }
    (worst, integral)
}

#[test]
fn what_is_claimed_of_the_pid_holds_for_the_exported_one() {
    let gains = designed(1, "torque_max_nm = 1e5");
    let certificate = gains.certificate.as_ref().unwrap();
    let names: Vec<&str> = gains.joints.iter().map(|j| j.name.as_str()).collect();
    let text = export(&gains, Target::Ros).unwrap();
    for (j, claim) in PidClaims::of(&gains).unwrap().iter().enumerate() {
        let inertia = gains.joints[j].inertia_kg_m2;
        for mu in [certificate.arm.low, 1.0, certificate.arm.high] {
            for (forward, motion) in [(true, &claim.forwarded), (false, &claim.bare)] {
                let mut pid = pids(&text, &names).swap_remove(j);
                let (worst, integral) = closed_loop(&mut pid, inertia, mu, forward);
                let moved = (motion.acceleration * 0.324).min(motion.jerk.unwrap() * 0.583);
                let bound = claim.bounds.unwrap().error_bound_rad + moved;
                println!(
                    "{j} μ {mu:.2} forward {forward}: {worst:.3e} ≤ {bound:.3e}; i {integral:.2}"
                );
                assert!(worst <= bound, "joint {j} μ {mu} forward {forward}: {worst} > {bound}");
                assert!(worst > 0.5 * bound, "too little was asked of the loop");
                assert!(!forward || integral <= claim.integral_nm.unwrap());
            }
        }
    }
}

#[test]
fn the_clamps_are_the_torque_limit_or_what_phi_asks_for() {
    let limited = designed(1, "torque_max_nm = [40.0, 30.0, 20.0]");
    let names: Vec<&str> = limited.joints.iter().map(|j| j.name.as_str()).collect();
    let clamps: Vec<f64> =
        pids(&export(&limited, Target::Ros).unwrap(), &names).iter().map(|p| p.i_clamp).collect();
    assert_eq!(clamps, [40.0, 30.0, 20.0]);
    let mut free = limited.clone();
    for joint in &mut free.certificate.as_mut().unwrap().joints {
        joint.limits = (None, None);
        joint.step.as_mut().unwrap().step_rad = None;
    }
    let claims = PidClaims::of(&free).unwrap();
    for (pid, claim) in pids(&export(&free, Target::Ros).unwrap(), &names).iter().zip(&claims) {
        let needed = claim.integral_nm.unwrap();
        assert!(needed >= 6.0 && pid.i_clamp >= 2.0 * needed && pid.i_clamp < 2.01 * needed);
        assert!(pid.u_clamp.is_infinite());
    }
    let open = uncertified("[60.0]");
    let text = export(&open, Target::Ros).unwrap();
    assert!(text.contains("UNCERTIFIED"));
    assert!(pids(&text, &names).iter().all(|pid| pid.i_clamp.is_infinite()));
}

#[test]
fn what_ros_cannot_run_is_refused() {
    let why = export(&designed(2, ""), Target::Ros).unwrap_err().to_string();
    assert!(
        why.contains("order 2") && why.contains("orders = [1]") && why.contains("c-header"),
        "{why}"
    );
    let mut odd = uncertified("[60.0]");
    odd.rate_hz = 1e9 / 3_000_001.0;
    let why = export(&odd, Target::Ros).unwrap_err().to_string();
    assert!(why.contains("rate_hz") && why.contains("whole"), "{why}");
    let mut forged = designed(1, "");
    forged.certificate.as_mut().unwrap().joints[1].window.as_mut().unwrap().high *= 1.3;
    let why = export(&forged, Target::Csv).unwrap_err().to_string();
    assert!(why.contains("refuted") && why.contains("window"), "{why}");
    let mut none = uncertified("[60.0]");
    none.joints.clear();
    assert!(export(&none, Target::CHeader).unwrap_err().to_string().contains("no joint"));
    let mut twins = uncertified("[60.0]");
    twins.joints[2].name = twins.joints[0].name.clone();
    assert!(export(&twins, Target::Ros).unwrap_err().to_string().contains("two joints"));
    let mut wild = uncertified("[60.0]");
    wild.joints[1].kd_per_s = -1.0;
    assert!(export(&wild, Target::CHeader).unwrap_err().to_string().contains("kd"));
}

/// Writes a program next to a header, compiles it with the controller's own header in reach, runs it, and
/// returns its output.
fn run_c(folder: &Path, compiler: &str, standard: &str, source: &str) -> String {
    let file = folder.join(if compiler == "cc" { "main.c" } else { "main.cpp" });
    let program = folder.join(format!("main-{compiler}"));
    fs::write(&file, source).unwrap();
    let output = Command::new(compiler)
        .args([standard, "-Wall", "-Wextra", "-Werror", "-pedantic"])
        .args(["-I", concat!(env!("CARGO_MANIFEST_DIR"), "/../phihat-c/include"), "-o"])
        .args([&program, &file])
        .arg("-lm")
        .output()
        .unwrap_or_else(|e| panic!("{compiler} cannot be started: {e}"));
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(Command::new(&program).output().unwrap().stdout).unwrap()
}

/// (T1), (T4) as the header's comment states them, on the signals of the test; torque with all digits.
const LAW: &str = r#"
#include <stdio.h>
#include <math.h>
#include "phihat.h"
#include "gains.h"
static double signal(int k, double seed) {
    double t = k * 1e-3;
    return 1e-3 * (sin(17.0 * t) * seed + cos(53.0 * t) - 1.0);
}
int main(void) {
    int i, j, k;
    for (i = 0; i < PHIHAT_JOINTS; i++) {
        double phi[PHIHAT_A_MAX + 1] = {0.0}, last = 0.0, applied = 0.0, T = PHIHAT_PERIOD_S;
        int m = phihat_order[i];
        double M = phihat_inertia_kg_m2[i];
        for (k = 0; k < 500; k++) {
            double q = signal(k, 3.0), dq = 9.0 * signal(k, 4.0);
            double e = q - signal(k, 1.0 + i), de = dq - signal(k, -1.0 - i), tau;
            double nu = T * (applied - phi[0]) - M * (dq - last);
            for (j = 0; j < m; j++) phi[j] += T * phi[j + 1] + phihat_alpha[i][m - 1 - j] * nu;
            if (k == 0) for (j = 0; j < m; j++) phi[j] = 0.0;
            tau = M * (90.0 * signal(k, 2.0) - phihat_kd_per_s[i] * de - phihat_kp_per_s2[i] * e) + phi[0];
            printf("%.17g\n", tau);
            last = dq;
            applied = tau;
        }
    }
    for (i = 0; i < PHIHAT_JOINTS; i++) {
        for (j = 0; phihat_joint_names[i][j] != 0; j++) printf("%d ", (unsigned char)phihat_joint_names[i][j]);
        printf("\n");
    }
    return 0;
}
"#;

#[test]
fn the_c_header_compiles_clean_and_is_the_law() {
    let folder =
        PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(env!("CARGO_PKG_NAME")).join("export-c");
    fs::create_dir_all(&folder).unwrap();
    for a in ["[60.0]", "[1600.0, 80.0]", "[2e5, 9e3, 150.0]"] {
        let mut gains = uncertified(a);
        for (joint, name) in gains.joints.iter_mut().zip(HOSTILE) {
            joint.name = name.to_owned();
        }
        gains.study = HOSTILE[0].to_owned();
        fs::write(folder.join("gains.h"), export(&gains, Target::CHeader).unwrap()).unwrap();
        let printed = run_c(
            &folder,
            "cc",
            "-std=c99",
            &LAW.replace("int main", "#include \"gains.h\"\nint main"),
        );
        assert_eq!(printed, run_c(&folder, "c++", "-std=c++11", LAW), "{a}: C and C++ differ");
        let mut lines = printed.lines();
        let names: Vec<String> = HOSTILE.map(str::to_owned).into();
        for (j, law) in
            gains.joint_gains(&names, 1_000_000, Form::Observer).unwrap().iter().enumerate()
        {
            let (mut state, mut applied) = (JointState::new(), 0.0);
            let seed = 1.0 + j as f64;
            for k in 0..500 {
                let reference = Reference {
                    q: signal(k, seed),
                    dq: signal(k, -seed),
                    ddq: 90.0 * signal(k, 2.0),
                };
                let measurement = Measurement {
                    q: signal(k, 3.0),
                    dq: 9.0 * signal(k, 4.0),
                    tau_applied: applied,
                };
                applied = law.update(&mut state, &measurement, &reference).tau;
                let c: f64 = lines.next().unwrap().parse().unwrap();
                assert!(
                    (c - applied).abs() <= 1e-9 * (1.0 + applied.abs()),
                    "{a} joint {j} sample {k}"
                );
            }
        }
        for name in HOSTILE {
            let bytes: Vec<u8> =
                lines.next().unwrap().split_whitespace().map(|b| b.parse().unwrap()).collect();
            assert_eq!(bytes, name.as_bytes());
        }
    }
}

/// The law from positions as the header's comment states it, on the signals of the test; torque with all digits.
const SEEING: &str = r#"
#include <stdio.h>
#include <math.h>
#include "phihat.h"
#include "gains.h"
static double signal(int k, double seed) {
    double t = k * 1e-3;
    return 1e-3 * (sin(17.0 * t) * seed + cos(53.0 * t) - 1.0);
}
static void carry(double x[PHIHAT_STATES_MAX + 1], double u, double M) {
    double T = PHIHAT_PERIOD_S, a = (u - x[2]) / M;
    int j;
    x[0] += T * x[1] + 0.5 * T * T * a;
    x[1] += T * a;
    for (j = 2; j < PHIHAT_STATES_MAX; j++) x[j] += T * x[j + 1];
}
int main(void) {
    int i, j, k;
    for (i = 0; i < PHIHAT_JOINTS; i++) {
        /* Torques less their feed-forward, the newest first: on the way, and the one that acted. */
        double x[PHIHAT_STATES_MAX + 1] = {0.0}, sent[6] = {0.0}, M = phihat_inertia_kg_m2[i], T = PHIHAT_PERIOD_S;
        int d = (int)phihat_delay_samples[i];
#ifdef PHIHAT_FILTER_SECTIONS
        double filter[PHIHAT_FILTER_SECTIONS][2] = {{0.0}};
#endif
        for (k = 0; k < 500; k++) {
            double q = signal(k, 3.5), e = q - signal(k, 1.0 + i), f = 0.0, g = phihat_share[i], ff, tau;
            double on[PHIHAT_STATES_MAX + 1] = {0.0};
            x[0] = k == 0 ? e : x[0];
            x[1] = k == 0 ? 9.0 * signal(k, 4.0) - signal(k, -1.0 - i) : x[1];
            if (k > 0) {
                double nu;
                carry(x, sent[d], M);
                nu = e - x[0];
                for (j = 0; j < PHIHAT_STATES_MAX; j++) x[j] += (j > 1 ? M : 1.0) * phihat_correction[i][j] * nu;
#ifdef PHIHAT_FILTER_SECTIONS
                for (j = 0; j < phihat_sections[i]; j++) {
                    const double *c = phihat_section_rates[i][j], *b = phihat_section_weights_per_s2[i][j];
                    double v = filter[j][0], w = filter[j][1];
                    filter[j][0] = v + w;
                    filter[j][1] = w + nu - c[0] * v - c[1] * w;
                    f += M * (b[0] * filter[j][0] + b[1] * filter[j][1]);
                }
#endif
            }
            for (j = 0; j < PHIHAT_STATES_MAX; j++) on[j] = x[j];
            for (j = d; j > 0; j--) carry(on, sent[j - 1], M);
            on[2] += T * (1.0 / g - 1.0) * on[3];
            ff = M * 90.0 * signal(k, 2.0);
            tau = sent[0] + g * (on[2] - M * (phihat_kd_per_s[i] * on[1] + phihat_kp_per_s2[i] * on[0]) + f - sent[0]);
            for (j = 5; j > 0; j--) sent[j] = sent[j - 1];
            sent[0] = tau;
            printf("%.17g\n", ff + tau);
        }
    }
    return 0;
}
"#;

/// Laws from positions with 2, 0 and 1 sections; without, the same laws unfiltered.
fn seeing(filtered: bool) -> Gains {
    let mut gains = uncertified("[60.0]");
    let section = |rates, weights_per_s2| FilterSection { rates, weights_per_s2 };
    let first = section([0.02, 0.3], [800.0, -300.0]);
    let filters = [vec![first, section([0.5, 1.2], [2500.0, 90.0])], Vec::new(), vec![first]];
    let corrections = [&[0.271, 28.5, -1000.0][..], &[0.344, 52.2, -3600.0, -1e5]];
    for (j, (joint, filter)) in gains.joints.iter_mut().zip(filters).enumerate() {
        joint.a.clear();
        joint.observer = Some(PositionObserver {
            correction: corrections[j % 2].to_vec(),
            share: 0.5 + 0.2 * j as f64,
            delay_samples: [1, 3, 0][j],
            innovation_filter: if filtered { filter } else { Vec::new() },
        });
    }
    gains
}

/// Torques of the core for one joint on the signals of the C program, whose torques act as told.
fn torques(law: &phihat::JointGains<f64>, joint: usize, delay: usize) -> Vec<f64> {
    let (mut state, mut told) = (JointState::new(), Vec::new());
    let seed = 1.0 + joint as f64;
    for k in 0..500_usize {
        let at = u32::try_from(k).unwrap();
        let reference =
            Reference { q: signal(at, seed), dq: signal(at, -seed), ddq: 90.0 * signal(at, 2.0) };
        let tau_applied = k.checked_sub(1 + delay).map_or(0.0, |then: usize| told[then]);
        let measurement =
            Measurement { q: signal(at, 3.5), dq: 9.0 * signal(at, 4.0), tau_applied };
        told.push(law.update(&mut state, &measurement, &reference).tau);
    }
    told
}

#[test]
fn the_c_header_of_a_law_from_positions_is_the_law_with_its_filter() {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
        .join(env!("CARGO_PKG_NAME"))
        .join("export-c-seeing");
    fs::create_dir_all(&folder).unwrap();
    let mut seen = Vec::new();
    for filtered in [false, true] {
        let gains = seeing(filtered);
        let header = export(&gains, Target::CHeader).unwrap();
        assert_eq!(header.contains("sections"), filtered, "told where there is one");
        fs::write(folder.join("gains.h"), header).unwrap();
        let printed = run_c(&folder, "cc", "-std=c99", SEEING);
        assert_eq!(printed, run_c(&folder, "c++", "-std=c++11", SEEING), "C and C++ differ");
        let mut lines = printed.lines();
        let names: Vec<String> = gains.joints.iter().map(|joint| joint.name.clone()).collect();
        let laws = gains.joint_gains(&names, 1_000_000, Form::Positions).unwrap();
        for (j, law) in laws.iter().enumerate() {
            let told =
                torques(law, j, gains.joints[j].observer.as_ref().unwrap().delay_samples as usize);
            for (k, tau) in told.iter().enumerate() {
                let c: f64 = lines.next().unwrap().parse().unwrap();
                assert!(
                    (c - tau).abs() <= 1e-9 * (1.0 + tau.abs()),
                    "joint {j} sample {k}: {c} {tau}"
                );
            }
            seen.push(told);
        }
    }
    let differ = [0, 1, 2].map(|j| seen[j] != seen[j + 3]);
    assert_eq!(differ, [true, false, true], "a filter acts where there is one");
}

#[test]
fn a_filter_reads_back_from_the_table_and_is_why_ros_refuses() {
    let gains = seeing(true);
    let text = export(&gains, Target::Csv).unwrap();
    assert!(text.contains("b_0 v + b_1 w"), "the law is stated: {text}");
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
    let header = reader.headers().unwrap().clone();
    let column = |name: &str| header.iter().position(|h| h == name).unwrap();
    for (record, joint) in reader.records().map(Result::unwrap).zip(&gains.joints) {
        let filter = &joint.observer.as_ref().unwrap().innovation_filter;
        for i in 0..2 {
            let own = filter.get(i).map_or([None; 4], |own| {
                let ([c0, c1], [b0, b1]) = (own.rates, own.weights_per_s2);
                [c0, c1, b0, b1].map(|value| Some(value.to_bits()))
            });
            let names = ["rate_0", "rate_1", "weight_0_per_s2", "weight_1_per_s2"];
            for (name, value) in names.iter().zip(own) {
                let cell = &record[column(&format!("section_{i}_{name}"))];
                let read = cell.parse::<f64>().ok().map(f64::to_bits);
                assert_eq!((read, cell.is_empty()), (value, value.is_none()), "{name} of {i}");
            }
        }
    }
    let plain = export(&seeing(false), Target::Csv).unwrap();
    assert!(!plain.contains("section") && !plain.contains("b_0"), "{plain}");
    let why = export(&gains, Target::Ros).unwrap_err().to_string();
    assert!(why.contains("an observer and a filter on its innovation"), "{why}");
    let why = export(&seeing(false), Target::Ros).unwrap_err().to_string();
    assert!(why.contains("has an observer, which"), "{why}");
}

#[test]
fn the_table_reads_back() {
    let mut gains = designed(2, "torque_max_nm = 50.0");
    let comma = "joint 1, \"upper\"".to_owned();
    gains.joints[0].name.clone_from(&comma);
    gains.certificate.as_mut().unwrap().joints[0].name.clone_from(&comma);
    let text = export(&gains, Target::Csv).unwrap();
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
    let header = reader.headers().unwrap().clone();
    let column = |name: &str| header.iter().position(|h| h == name).unwrap();
    for (record, joint) in reader.records().map(Result::unwrap).zip(&gains.joints) {
        let number = |name: &str| record[column(name)].parse::<f64>().unwrap().to_bits();
        assert_eq!(record[column("joint")], joint.name);
        assert_eq!(number("inertia_kg_m2"), joint.inertia_kg_m2.to_bits());
        assert_eq!((number("a_0"), number("a_1")), (joint.a[0].to_bits(), joint.a[1].to_bits()));
        assert_eq!(number("torque_max_nm"), 50.0_f64.to_bits());
        assert_eq!(&record[column("p_nm_per_rad")], "");
    }
}
