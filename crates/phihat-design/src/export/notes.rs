//! Notes in every exported file: origin, law, what the target lacks, what is claimed.

use super::number::{down, up};
use super::pid::{Pid, PidClaims};
use crate::Gains;
use crate::sampled::{LoopModel, ReferenceError};
use crate::{Certificate, JointCertificate};
use phihat::VelocitySource;

/// Origin of the gains.
pub(super) fn origin(gains: &Gains) -> Vec<String> {
    let mut lines = vec![
        format!(
            "Gains of the study {}, written by phihat {}.",
            line(&gains.study),
            env!("CARGO_PKG_VERSION")
        ),
        format!("SHA-256 of the study: {}", line(&gains.study_sha256)),
        format!("How they were found: {}", line(&gains.method)),
        format!(
            "Loop rate: {} Hz. Units: rad (m for prismatic joints), N m (N), kg m^2 (kg), s.",
            gains.rate_hz
        ),
        "Not a safety function: keep the machine's own limits and protective stop.".to_owned(),
    ];
    if gains.certificate.is_none() {
        lines.push(String::new());
        lines.push(
            "UNCERTIFIED: these gains carry no certificate. Nothing is known of their".to_owned(),
        );
        lines.push("stability on any arm; no bound on the error follows.".to_owned());
    }
    lines
}

/// The law of `phihat`, and what is certified of it.
pub(super) fn law(gains: &Gains) -> Vec<String> {
    let seen = gains.joints.iter().any(|joint| joint.observer.is_some());
    let filtered = gains.joints.iter().any(|joint| !joint.innovation_filter().is_empty());
    let mut lines = if seen { from_positions(filtered) } else { fed() };
    if let Some(hz) = gains.torque_filter_hz {
        lines.push("tau then goes through a low-pass, before its limits: tau = r + s (tau - r), r the last".to_owned());
        lines.push(format!(
            "torque as the limits let it through, s = 1 - exp(-2 pi f T), f = {hz} Hz."
        ));
    }
    if let Some(certificate) = &gains.certificate {
        lines.push("Certified of it (check with: phihat verify):".to_owned());
        lines.extend(arm(certificate));
        let bound = |(i, joint): (usize, &JointCertificate)| {
            let error = certificate.error_bound(i);
            let error = error.map_or("not known".to_owned(), |b| up(b.error_bound_rad));
            let window = joint.window.map_or("none".to_owned(), |window| {
                format!("{} .. {}", up(window.low), down(window.high))
            });
            format!("  {}: window of mu {window}, |e| <= {error} rad", line(&joint.name))
        };
        lines.extend(certificate.joints.iter().enumerate().map(bound));
        lines.extend(certificate.joints.first().map(|joint| assumed(&joint.model)));
    }
    lines
}

/// Properties that a PID lacks, and the claims that hold for it instead.
pub(super) fn pid(gains: &Gains, claims: &[PidClaims]) -> Vec<String> {
    let mut lines: Vec<String> = [
        "The law as a PID, per joint, e = q - q_d (measured minus desired):",
        "  tau = feed-forward - p e - i sum(T e) - d de",
        "  the sum takes in e of this sample before tau is answered (backward Euler).",
        "What the PID lacks against the controller that the certificate is about:",
        "  - Acceleration feed-forward M qdd_d: give it as the effort of the reference.",
        "  - The torque that acted: the PID does not see limits, delay and drive. It winds up while a",
        "    limit acts, but for the clamps; no bound holds then, nor until it has recovered.",
        "  - A start without a kick: begin at rest with e = 0, or i sum(T e) starts at once.",
        "  - Sampled coefficients alpha: the sum is Euler's. The figures below are those of the PID itself.",
    ]
    .map(str::to_owned)
    .into();
    let Some(certificate) = &gains.certificate else { return lines };
    lines.push("What is claimed of the PID, in place of the certificate's bounds:".to_owned());
    lines.extend(arm(certificate));
    lines.extend(certificate.joints.first().map(|joint| assumed(&joint.model)));
    lines.extend([
        "  |e| <= E + A max|qdd_d| or E + B max|qddd_d| (jerk), whichever is less, once settled and while".to_owned(),
        "  no clamp acts. E is from phi as in the certificate and from the encoder, A and B from the".to_owned(),
        "  motion of the reference (A for qdd_d held over a sample); A*, B* are without feed-forward.".to_owned(),
    ]);
    for (joint, claim) in gains.joints.iter().zip(claims) {
        let error = claim.bounds.map_or("not known (no phi)".to_owned(), |b| up(b.error_bound_rad));
        let integral =
            claim.integral_nm.map_or("not known".to_owned(), |n| format!("{} N m", up(n)));
        let (window, margins) = (claim.window, claim.margins);
        let jerk = |error: &ReferenceError| error.jerk.map_or("unbounded".to_owned(), up);
        lines.push(format!("  {}: M = {} kg m^2", line(&joint.name), joint.inertia_kg_m2));
        lines.push(format!(
            "    window of mu {} .. {}, modulus margin {}, phase margin {} deg",
            up(window.low),
            down(window.high),
            down(margins.modulus),
            down(margins.phase_deg),
        ));
        lines.push(format!(
            "    E = {error} rad, A = {} s^2, B = {} s^3, A* = {} s^2, B* = {} s^3",
            up(claim.forwarded.acceleration),
            jerk(&claim.forwarded),
            up(claim.bare.acceleration),
            jerk(&claim.bare),
        ));
        lines.push(format!("    integral term: at most {integral} from phi"));
    }
    lines
}

/// The same for files that hold the law anyway: nothing for other orders, and the reason where the arm is
/// outside the PID's window.
pub(super) fn pid_section(gains: &Gains) -> Vec<String> {
    if pids(gains).is_none() {
        return Vec::new();
    }
    let mut lines = vec![String::new()];
    match PidClaims::of(gains) {
        Ok(claims) => lines.extend(pid(gains, &claims)),
        Err(why) => {
            lines.push(
                "DO NOT RUN THE PID: without the torque that acted it does not hold the arm:"
                    .to_owned(),
            );
            lines.push(line(&format!("  {why}")));
        }
    }
    lines
}

/// The gains as PIDs; `None` for other orders.
pub(super) fn pids(gains: &Gains) -> Option<Vec<Pid>> {
    // A PID has no low-pass on its torque.
    let plain = gains.torque_filter_hz.is_none();
    gains.joints.iter().map(Pid::of).collect::<Option<_>>().filter(|_| plain)
}

fn arm(certificate: &Certificate) -> Vec<String> {
    let (low, high) = (down(certificate.arm.low), up(certificate.arm.high));
    vec![
        format!("  for inertia M(q) with eigenvalues mu of M^-1 M(q) in {low} .. {high}"),
        format!("  ({})", line(&certificate.arm.source)),
    ]
}

fn assumed(model: &LoopModel) -> String {
    let velocity = match model.velocity {
        VelocitySource::Measured => "measured velocity",
        VelocitySource::Differenced => "velocity = backward difference of the position",
    };
    let filter = model.velocity_filter_hz.map_or(String::new(), |hz| format!(", low-pass {hz} Hz"));
    let drive = model.drive_bandwidth_hz.map_or(String::new(), |hz| format!(", drive {hz} Hz"));
    let late = match model.sample_delay_samples {
        0 => String::new(),
        late => format!(", measurements {late} samples late"),
    };
    format!(
        "  in a loop with T = {} s, {} samples of delay{late}, {velocity}{filter}{drive}",
        model.period_s, model.delay_samples
    )
}

/// A user's text in one line of printable ASCII, so that it stays inside a comment of any language.
pub(super) fn line(text: &str) -> String {
    let shown = |c: char| {
        if c.is_ascii_graphic() || c == ' ' {
            c.to_string()
        } else {
            c.escape_unicode().to_string()
        }
    };
    let line: String = text.chars().map(shown).collect();
    line.replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?")
}

/// Every line behind a mark.
pub(super) fn commented(mark: &str, lines: &[String]) -> String {
    lines.iter().map(|line| format!("{mark} {line}").trim_end().to_owned() + "\n").collect()
}

/// The law that is fed with velocity.
fn fed() -> Vec<String> {
    vec![
        "The controller, per joint, e = q - q_d (measured minus desired):".to_owned(),
        "  tau = M (qdd_d - K_d de - K_p e) + phi_hat[0]".to_owned(),
        "  nu = T (tau_applied - phi_hat[0]) - M (dq - dq of the last sample)".to_owned(),
        "  phi_hat[j] <- phi_hat[j] + T phi_hat[j+1] + alpha[m-1-j] nu,  j = 0 .. m-1,".to_owned(),
        "  first nu and phi_hat (0 at the first sample), then tau; phi_hat[m] = 0; tau_applied is the".to_owned(),
        "  mean torque that acted since the last sample, after limits, delay and drive.".to_owned(),
    ]
}

/// The law from positions, with a filter on the innovation or without one.
fn from_positions(filtered: bool) -> Vec<String> {
    let observer = [
        "The controller, per joint, e = q - q_d (measured minus desired), x = (e, de, phi[0], phi[1], ...):",
        "  x   <- x carried over the last period by the torque that acted less its feed-forward:",
        "         e += T de + T^2/2 (u - phi[0])/M, de += T (u - phi[0])/M, phi[j] += T phi[j+1]",
        "  x_i <- x_i + l_i (e measured - e expected), the phi times M",
    ];
    let filter = [
        "  and each section of the filter, with v = w = 0 at the first sample, from the second on:",
        "         v, w <- v + w, w + (e measured - e expected) - c_0 v - c_1 w, both from what was before",
        "  f   =  M times the sum of b_0 v + b_1 w over the sections",
    ];
    let answer = [
        "  x+  =  x carried on through the torques on their way, phi[0] by T (1/g - 1) phi[1] more",
        if filtered {
            "  tau =  ff + r + g (phi+[0] - M (K_d de+ + K_p e+) + f - r),  r = tau - ff of the last sample,"
        } else {
            "  tau =  ff + r + g (phi+[0] - M (K_d de+ + K_p e+) - r),  r = tau - ff of the last sample,"
        },
        "  ff  =  M times the mean qdd_d of the interval in which tau acts.",
    ];
    let filter = if filtered { &filter[..] } else { &[] };
    [&observer, filter, &answer].concat().into_iter().map(str::to_owned).collect()
}
