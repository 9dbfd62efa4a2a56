//! Gains, what is claimed about them, and why there are none.

use phihat_design::{
    Certificate, ElasticJoints, ErrorBound, FilterSection, Gains, JointCertificate, LeftOut,
    NotCounted, Settle, SettleFrom,
};
use phihat_report::section_poles;

use super::coupled::coupled;
use super::{Fitted, MILLI, align, figure, in_unit, plain_table};

/// One row of gains per joint.
pub(crate) fn gains(gains: &Gains) -> Fitted {
    let seen = gains.joints.iter().any(|joint| joint.observer.is_some());
    let last = if seen { "g; ℓ_0 … ℓ_(m+1)" } else { "a_0 … a_(m−1)" };
    let mut header = vec!["joint", "M̄\nkg·m²", "K_p\n1/s²", "K_d\n1/s", "m", last];
    let filtered = gains.joints.iter().any(|joint| !joint.innovation_filter().is_empty());
    if filtered {
        header.extend(["poles of the filter\nrad/s", "b_0, b_1\n1/s²"]);
    }
    let mut table = plain_table(header);
    for joint in &gains.joints {
        let estimator = joint.observer.as_ref().map_or_else(
            || joint.a.iter().map(|a| format!("{a:.1}")).collect::<Vec<_>>().join(", "),
            |own| {
                let l: Vec<String> = own.correction.iter().map(|l| format!("{l:.4}")).collect();
                format!("{:.4}; {}", own.share, l.join(", "))
            },
        );
        let mut row = vec![
            joint.name.clone(),
            in_unit(figure(joint.inertia_kg_m2, 4), "kg·m²", gains.slides(&joint.name)),
            format!("{:.1}", joint.kp_per_s2),
            format!("{:.2}", joint.kd_per_s),
            joint.order().to_string(),
            estimator,
        ];
        if filtered {
            row.extend(sections(joint.innovation_filter(), gains.rate_hz));
        }
        table.add_row(row);
    }
    align(&mut table);
    table
}

/// Poles and weights of a filter's sections, a line each.
fn sections(filter: &[FilterSection], rate_hz: f64) -> [String; 2] {
    let lines = |of: &dyn Fn(&FilterSection) -> String| {
        filter.iter().map(of).collect::<Vec<_>>().join("\n")
    };
    let weights = |own: &FilterSection| own.weights_per_s2.map(|b| format!("{b:.1}")).join(", ");
    [lines(&|own| section_poles(own, rate_hz)), lines(&weights)]
}

/// Claims of a certificate, one row per joint; refused ones below.
pub(crate) fn certificate(certificate: &Certificate, gains: &Gains) -> String {
    let mut table = plain_table([
        "joint",
        "bound |e|\nmrad",
        "bound |ė|\nmrad/s",
        "bound |∫e|\nmrad·s",
        "window\nμ",
        "gain margin\n÷ … ×",
        "phase\n°",
        "delay\nms",
        "modulus",
        "|Δτ| from encoder\nN·m, rms / bound",
        "largest step\nmrad",
    ]);
    for (i, joint) in certificate.joints.iter().enumerate() {
        let integral = certificate.own_bounds(i).and_then(|own| own.integral_rad_s);
        let bounds = (certificate.error_bound(i), integral);
        table.add_row(row(joint, bounds, gains.slides(&joint.name)));
    }
    align(&mut table);
    let arm = &certificate.arm;
    let range = format!("the arm's inertia: μ = {:.3} … {:.3}", arm.low, arm.high);
    let mut lines = vec![table.to_string()];
    match certificate.refused() {
        None => lines.push(format!(
            "{range}, inside every window by a factor of {} at both ends",
            certificate.window_margin
        )),
        Some(why) => lines.push(format!("{range}; these gains do NOT arm: {why}")),
    }
    lines.push(format!("({})", arm.source));
    if let Some(proved) = arm.searched.as_ref().and_then(|searched| searched.proved.as_ref()) {
        lines.push(format!(
            "proved in {} cells: no eigenvalue below {:.3}, none above {:.3}, at no posture",
            proved.cells, proved.low, proved.high
        ));
    }
    lines.extend(certificate.elastic.as_deref().map(elastic_joints));
    lines.push(moving(certificate));
    if let Some(phi) = certificate.joints.first().and_then(|joint| joint.phi.as_ref()) {
        lines.push(format!("φ: {}", phi.source));
    }
    if let Some(first) = certificate.joints.first() {
        lines.push(law(first));
        // What one joint's form shows of an arm it shows of joints with that one law.
        let frozen = certificate.frozen.as_ref();
        lines.extend(frozen.and_then(|frozen| frozen.decay_per_s).map(|rate| {
            format!("return: every frozen posture forgets what moved the arm at least as e^(−{rate:.2} t), t in s")
        }));
        lines.push(if frozen.is_some() { any_speed(certificate) } else { jumps(first) });
    }
    lines.extend(coupled(certificate, gains));
    lines.extend(not_counted(&certificate.not_counted));
    if let Some(tip) = certificate.tube.as_ref().and_then(|tube| tube.tip.as_ref()) {
        let (most, turned) = (tip.error_bound_m * MILLI, tip.angle_max_rad.to_degrees());
        lines.push(format!("bound of the tip ({}): {most:.3} mm, {turned:.4}°", tip.frame));
    }
    lines.push(proved(certificate));
    lines.extend(certificate.settle.map(settle));
    lines.join("\n")
}

/// The clause of elastic joints.
fn elastic_joints(elastic: &ElasticJoints) -> String {
    let margin = if elastic.modulus > 0.0 {
        format!("modulus margin {:.2}", elastic.modulus)
    } else {
        "no margin beside these springs".to_owned()
    };
    format!(
        "joints that bend as stated, encoders at the {}: every frozen posture is stable, {margin}",
        elastic.encoder.word()
    )
}

/// Largest rate of change of the arm's inertia, with the rates that are needed.
fn moving(certificate: &Certificate) -> String {
    let Some(moving) = &certificate.moving else {
        let why = certificate.moving_refused.as_ref().map(ToString::to_string);
        return format!("NOT proved, stability while moving: {}", why.unwrap_or_default());
    };
    let rate = |rate: Option<f64>| rate.map_or_else(|| "–".to_owned(), |rate| format!("{rate:.2}"));
    format!(
        "stable while the inertia changes by at most {:.1} 1/s (Coriolis torque and gradients left out); the reference \
         needs {}, all joints at their speed limits {} (searched)",
        moving.rate_per_s,
        rate(moving.needed_motion_per_s),
        rate(moving.needed_limits_per_s)
    )
}

/// Range in which the coupled arm's inertia may move at any speed, where laws differ.
fn any_speed(certificate: &Certificate) -> String {
    certificate.any_speed.as_ref().map_or_else(
        || "NOT proved, stability while the inertia moves at any speed".to_owned(),
        |any| {
            let (low, high) = (any.low, any.high);
            format!("the inertia may move at any speed within μ = {low:.3} … {high:.3}, Coriolis torque and gradients \
                left out")
        },
    )
}

fn row(
    joint: &JointCertificate,
    (bound, integral): (Option<ErrorBound>, Option<f64>),
    slides: bool,
) -> Vec<String> {
    let none = || "–".to_owned();
    let milli = |value: Option<f64>, decimals: usize| {
        value.map_or_else(none, |v| figure(v * MILLI, decimals))
    };
    let own = |value: Option<f64>, decimals: usize, unit: &str| {
        value.map_or_else(none, |v| in_unit(figure(v * MILLI, decimals), unit, slides))
    };
    let margins = joint.margins.as_ref();
    let noise = joint.noise.as_ref();
    vec![
        joint.name.clone(),
        own(bound.map(|b| b.error_bound_rad), 3, "mrad"),
        own(bound.map(|b| b.velocity_error_bound_rad_s), 1, "mrad/s"),
        own(integral, 2, "mrad·s"),
        joint.window.map_or_else(none, |w| format!("{:.3} … {:.2}", w.low, w.high)),
        margins.map_or_else(none, |m| format!("{:.2} … {:.2}", m.gain_down, m.gain_up)),
        margins.map_or_else(none, |m| format!("{:.0}", m.phase_deg)),
        milli(margins.map(|m| m.delay_s), 1),
        margins.map_or_else(none, |m| format!("{:.2}", m.modulus)),
        noise.map_or_else(none, |n| {
            let both = [n.change_rms_nm, n.change_max_nm].map(|nm| figure(nm, 3)).join(" / ");
            in_unit(both, "N·m", slides)
        }),
        own(joint.step.as_ref().and_then(|s| s.step_rad), 2, "mrad"),
    ]
}

/// Clauses of the specification that are not proved, else the scope of the proof.
fn proved(certificate: &Certificate) -> String {
    if !certificate.unproved.is_empty() {
        let each = certificate.unproved.iter().map(|why| format!("  {why}"));
        return format!("NOT PROVED of this study:\n{}", each.collect::<Vec<_>>().join("\n"));
    }
    match &certificate.tube {
        Some(tube) => format!(
            "the specification is kept by every run in the tube: payload {}, dry friction as stated, \
                from t = 0, no limit acts",
            tube.payload
        ),
        None if certificate.class.as_ref().is_some_and(|class| class.is_supervised()) => {
            "the specification is kept by every motion of the class while the supervisor holds or tracks".to_owned()
        }
        None if certificate.class.is_some() => {
            "the specification is kept by every motion of the class, from a start in balance"
                .to_owned()
        }
        None => {
            "bounds are those of each joint alone: nothing is known of how they push each other"
                .to_owned()
        }
    }
}

/// From when on the specification is held against a run, and why then.
fn settle(settle: Settle) -> String {
    let why = match settle.from {
        SettleFrom::Study => "as the study says",
        SettleFrom::Tube => {
            "the study does not say when: from then on the tube stays inside the specification"
        }
        SettleFrom::TubeLevel => {
            "the study does not say when, and the tube never keeps the specification: from then on it is at its own \
                level"
        }
        SettleFrom::Default => "the study does not say when, and there is no tube: the default",
    };
    format!("steady from t = {} s on: {why}", settle.settle_s)
}

/// Parts of the study that the claims leave out, one line for each kind of claim.
pub(crate) fn not_counted(list: &[NotCounted]) -> Vec<String> {
    let line = |(claims, words): (LeftOut, &str)| {
        let of = list.iter().filter(|one| one.claims == claims);
        let of: Vec<String> = of.map(|one| format!("{} = {}", one.key, one.value)).collect();
        (!of.is_empty()).then(|| format!("{words}: {}", of.join(" · ")))
    };
    [
        (LeftOut::Bounds, "NOT counted in the bounds"),
        (LeftOut::BoundsAndStability, "NOT counted at all, neither in the bounds nor in stability"),
        (
            LeftOut::TubeBesideValue,
            "counted in range, stability and bounds; tube and coupled gains are for the simulated value",
        ),
        (LeftOut::AllButTube, "NOT counted but in a tube, where there is one"),
        (
            LeftOut::AllButElastic,
            "counted in the clause of elastic joints alone; bounds and tube are those of rigid joints",
        ),
        (LeftOut::Assumed, "ASSUMED"),
    ]
    .into_iter()
    .filter_map(line)
    .collect()
}

/// Optimality of the law that the joints share, and the paper's bound (40).
fn law(joint: &JointCertificate) -> String {
    joint.continuous.as_ref().map_or_else(
        || "a law from positions: no claim in continuous time".to_owned(),
        |law| {
            let gamma = law.attenuation.gamma_return_difference;
            let optimal = gamma.map_or_else(
                || "no H-infinity level: the return difference fails".to_owned(),
                |gamma| format!("inverse optimal for every H-infinity level γ > {gamma:.4}"),
            );
            format!(
                "{optimal}\nthe paper's (40), per unit of φ/M̄: |x| ≤ {:.4} as printed, which is no bound; {:.4} holds \
                 in the end",
                law.paper.printed, law.paper.corrected
            )
        },
    )
}

/// Range in which the inertia of joints with one law may jump.
fn jumps(joint: &JointCertificate) -> String {
    joint.sampled_varying.as_ref().map_or_else(
        || "no common quadratic form for inertia that varies from sample to sample".to_owned(),
        |v| {
            let (low, high) = (v.low, v.high);
            format!("inertia may jump from sample to sample within μ = {low:.3} … {high:.3}")
        },
    )
}

#[cfg(test)]
mod tests {
    use super::gains;
    use phihat_design::Gains;

    fn table(filter: &str) -> String {
        let text = format!(
            r#"{{"format": "phihat-gains", "version": 3, "study": "", "study_sha256": "", "rate_hz": 1000.0,
            "method": "by hand", "joints": [{{"name": "elbow", "inertia_kg_m2": 0.5, "kp_per_s2": 400.0,
            "kd_per_s": 40.0, "a": [], "observer": {{"correction": [0.271, 28.5, -1000.0], "share": 0.5,
            "delay_samples": 1{filter}}}}}]}}"#
        );
        gains(&Gains::from_json(&text).unwrap()).to_string()
    }

    #[test]
    fn a_filter_stands_beside_its_law_by_poles_and_weights() {
        let plain = table("");
        assert!(plain.contains("0.2710, 28.5000") && !plain.contains("filter"), "{plain}");
        // z = 0.5 and 0.8; and 0.5 twice.
        let filter = r#", "innovation_filter": [{"rates": [0.1, 0.7], "weights_per_s2": [800.0, -300.0]},
            {"rates": [0.25, 1.0], "weights_per_s2": [12.5, 0.0]}]"#;
        let told = table(filter);
        for expected in [
            "poles of the filter",
            "−223.1, −693.1",
            "800.0, -300.0",
            "−693.1, −693.1",
            "12.5, 0.0",
        ] {
            assert!(told.contains(expected), "no {expected}:\n{told}");
        }
    }
}
