//! Bounds of a safe stop, where a study has a supervisor.

use phihat::{Form, JointGains, Limits};
use phihat_design::Gains;
use phihat_study::Study;

use super::{align, figure, in_unit, plain_table};

/// Speeds of every joint at the beginning of the stop \[rad/s\].
const FROM: [f64; 2] = [0.2, 1.0];

/// Stopping distance of each joint, and its largest speed on the way; `None`: the study has no supervisor, or
/// the arm's inertia is not known.
pub(crate) fn stop(study: &Study, gains: &Gains) -> Option<String> {
    study.supervisor.as_ref()?;
    let arm = &gains.certificate.as_ref()?.arm;
    let names = study.robot.joint_names();
    let period = study.control.period_ns as f64 * 1e-9;
    let positions = gains.joints.iter().any(|joint| joint.observer.is_some());
    let form = if positions { Form::Positions } else { study.control.form };
    let laws = gains.joint_gains(&names, study.control.period_ns, form).ok()?;
    let limited = |(i, law): (usize, JointGains<f64>)| {
        let (torque, rate) = study.limits(i);
        Limits::new(torque, rate, period).map(|limits| law.with_limits(limits))
    };
    let laws: Vec<_> = laws.into_iter().enumerate().map(limited).collect::<Result<_, _>>().ok()?;
    let reserves: f64 = laws.iter().map(JointGains::stop_reserve).sum();
    let inertia: f64 = laws.iter().map(JointGains::inertia).sum();
    // ½ q̇ᵀ M q̇ at the stop, with M at most μ_high M̄, and what the drives may give back.
    let energy = |speed: f64| 0.5 * arm.high * inertia * speed * speed + reserves;
    let mut header = vec!["joint".to_owned(), "deceleration\nrad/s²".to_owned()];
    header.extend(FROM.map(|v| format!("from {v} rad/s\nrests after rad")));
    header.extend(FROM.map(|v| format!("from {v} rad/s\nat most rad/s")));
    let mut table = plain_table(header);
    for (law, name) in laws.iter().zip(&names) {
        let slides = gains.slides(name);
        let limits = law.stop_limits();
        let (a, j) = (limits.acceleration, limits.jerk);
        let mut row = vec![name.clone(), in_unit(figure(a, 2), "rad/s²", slides)];
        row.extend(
            FROM.map(|v| in_unit(figure(0.5 * v * v / a + 0.5 * v * a / j, 4), "rad", slides)),
        );
        let least = arm.low * law.inertia();
        row.extend(
            FROM.map(|v| in_unit(figure((2.0 * energy(v) / least).sqrt(), 2), "rad/s", slides)),
        );
        table.add_row(row);
    }
    align(&mut table);
    Some(format!(
        "{table}\na safe stop from so fast on every joint: the way of its reference to rest, and the speed beyond \
         which no joint comes while nobody pushes (theory, Q3; all energy of the arm in that joint). A push that does \
         W joules of work on the way adds 2 W/(μ_low M̄) to the square of a speed"
    ))
}
