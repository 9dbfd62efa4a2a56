//! Sec. II: the error dynamics, the law as feedback, its parameters.

use phihat_design::claims::{UnitLaw, polynomial};

use crate::compose::{number, three};
use crate::draw::Draw;
use crate::gains::{NAMES, all};
use crate::joint::largest;
use crate::published::Published;
use crate::record::{Section, Statement, Verdict};

/// Joints of the arm of (7).
const N: usize = 3;

/// Sec. II: statements before the paper's theorems.
pub(super) fn section_2() -> Section {
    Section {
        id: "section-2".to_owned(),
        title: "Sec. II: the law and its parameters".to_owned(),
        text: Vec::new(),
        statements: vec![error_dynamics(), feedback(), parameters(), extra_term(), references()],
        tables: Vec::new(),
        figures: Vec::new(),
    }
}

/// (7) from (1), (5) and (6), at random.
fn error_dynamics() -> Statement {
    let mut draw = Draw::new(7);
    let mut worst: f64 = 0.0;
    for _ in 0..200 {
        let mut vector =
            |scale: f64| -> Vec<f64> { draw.spread(N, 3.0).iter().map(|v| scale * v).collect() };
        let [ddq, ddq_d, e, de] = [1.0, 1.0, 0.1, 1.0].map(&mut vector);
        let [load, phi_hat] = [50.0, 20.0].map(&mut vector);
        let m: Vec<Vec<f64>> = (0..N).map(|_| vector(3.0)).collect();
        let (kp, kd) = (vector(400.0), vector(40.0));
        // M = LLᵀ, load = N + Fq̇.
        let inertia = |i: usize, j: usize| (0..N).map(|k| m[i][k] * m[j][k]).sum::<f64>();
        for i in 0..N {
            let rigid = (0..N).map(|j| inertia(i, j) * ddq[j]).sum::<f64>() + load[i];
            let tau_in = phi_hat[i] + ddq_d[i] - kd[i] * de[i] - kp[i] * e[i];
            // (1) says which τ_d goes with this motion.
            let tau_d = rigid - tau_in;
            let phi = rigid - ddq[i] - tau_d;
            let left = ddq[i] - ddq_d[i] + kd[i] * de[i] + kp[i] * e[i];
            let size =
                [ddq[i], tau_in, phi, phi_hat[i]].iter().fold(0.0_f64, |s, v| s.max(v.abs()));
            worst = worst.max((left - (phi_hat[i] - phi)).abs() / size);
        }
    }
    Published {
        id: "eq7-identity",
        place: "(7)",
        claim: "(1), (5) and (6) together give ë + K_dė + K_pe = φ̂ − φ",
        paper: "(7)",
    }
    .found(
        format!("left and right differ by {worst:.0e} of the largest term at 200 random motions of three joints"),
        Verdict::of(worst < 1e-9, false),
        "(5) and (1) say φ = τ_in − q̈, whatever M, C, G, F and τ_d are; (6) does the rest.",
        vec![number("largest relative difference", "", worst, 1e4)],
    )
}

/// (16), (19) and (21) hold the same coefficients.
fn feedback() -> Statement {
    let difference = |law: &UnitLaw| {
        let (kp, kd, a) = (law.kp, law.kd, &law.a);
        // a_i = 0 for i < 0 and i > m − 1: E1.
        let at = |i: usize, less: usize| {
            i.checked_sub(less).and_then(|k| a.get(k)).copied().unwrap_or(0.0)
        };
        let sixteen: Vec<f64> =
            (0..a.len() + 2).map(|i| at(i, 0) * kp + at(i, 1) * kd + at(i, 2)).collect();
        let mut off = vec![polynomial::product(a, &law.d())];
        if let [a0, a1] = a[..] {
            let b = a0 / a1;
            off.push([b * kp, kp + b * kd, kd + b, 1.0].iter().map(|k| a1 * k).collect());
        }
        let to = |other: &Vec<f64>| largest(sixteen.iter().zip(other).map(|(s, o)| s / o - 1.0));
        largest(off.iter().map(to))
    };
    let worst = largest(all().iter().map(|(_, law)| difference(law)));
    Published {
        id: "eq16-feedback",
        place: "(16), (19), (21), Remark 7",
        claim: "K of (16) is that of (19), and at m = 2 that of (21)",
        paper: "K = a_1[b_0K_p, K_p + b_0K_d, K_d + b_0, I]",
    }
    .found(
        format!("coefficients differ by {worst:.0e} at most ({NAMES})"),
        Verdict::of(worst < 1e-12, false),
        "(19) is φ̂^{(m)} = −(a_{m−1}s^{m−1} + … + a_0)(s² + K_ds + K_p)e, and the product of the two polynomials has \
         the coefficients of (16).",
        vec![number("largest relative difference", "", worst, 1e4)],
    )
    .assuming(&["gains"])
}

/// The largest inertia at which the continuous loop is stable with M̄ = 1 \[kg·m²\].
fn largest_inertia(law: &UnitLaw) -> f64 {
    let stable = |mu: f64| polynomial::is_hurwitz(&law.denominator(mu));
    let (mut low, mut high) = (1.0, 1e4);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if stable(middle) { low = middle } else { high = middle }
    }
    low
}

/// M̄ is a parameter.
fn parameters() -> Statement {
    let most = all().map(|(name, law)| (name, largest_inertia(&law)));
    let any = most.iter().all(|(_, inertia)| *inertia > 9e3);
    let own = all().iter().all(|(_, law)| polynomial::is_hurwitz(&law.denominator(1.0)));
    let listed = most.iter().map(|(name, inertia)| format!("{name}: {}", three((*inertia).into())));
    Published {
        id: "remark5-parameters",
        place: "Remarks 3, 5",
        claim: "The only parameters are a_i, K_p and K_d; q̈ in (5) only saves an estimate of the acceleration",
        paper: "only tuning parameters",
    }
    .found(
        format!(
            "stable in continuous time up to an inertia of [kg·m²] {}",
            listed.collect::<Vec<_>>().join("; ")
        ),
        Verdict::of(any, own),
        "The q̈ of (5) and the q̈_d − K_dė − K_pe of (6) have a factor with the unit of an inertia that is printed as \
         1. It is the nominal inertia M̄, a fourth parameter: with gains as used, a joint of more inertia than M̄ \
         times this figure is unstable, and with M̄ = M the same gains are stable at any constant inertia. Sampling \
         adds a smallest inertia.",
        most.iter()
            .map(|(name, inertia)| number(&format!("largest stable inertia, {name}"), "kg·m²", *inertia, 1e-6))
            .collect(),
    )
    .assuming(&["gains"])
}

/// No term of the error in (8).
fn extra_term() -> Statement {
    let stable =
        all().iter().filter(|(_, law)| polynomial::is_hurwitz(&law.denominator(1.0))).count();
    Published {
        id: "remark6-extra-term",
        place: "Remark 6",
        claim: "(8) needs no term f(e, ė) for stability",
        paper: "not needed",
    }
    .found(
        format!("the loop without it is stable at {stable} of {} laws ({NAMES})", all().len()),
        Verdict::of(stable == all().len(), false),
        "At M = M̄ its polynomial is D(s)A_o(s), stable exactly where (4) and (8) are. The paper's proof asks for A1 \
         to A3 besides, which H1 and H2 do not meet.",
        vec![number("stable laws", "", stable as f64, 0.0)],
    )
    .assuming(&["gains"])
}

/// Statement on the paper's references to its own sections.
fn references() -> Statement {
    Published {
        id: "erratum-references",
        place: "(20), after Theorem 2",
        claim: "R⁻¹ is shown in Sec. V, and α = 1 explained in Sec. IV-B",
        paper: "Sec. V; Sec. IV-B",
    }
    .found(
        "read, not computed: both stand in Sec. IV-C",
        Verdict::WithCorrection,
        "R⁻¹ is (37), and α = 1 comes with Theorem 4, \"without loss of generality\": αK̃ may be called K̃.",
        Vec::new(),
    )
}
