//! Lemma 1 and Theorem 1: the two forms of the estimator, and where its error goes.

use core::f64::consts::TAU;

use phihat_design::claims::{UnitLaw, polynomial};

use crate::compose::{number, three, words};
use crate::gains::{OUTER, all, equal_rate};
use crate::joint::{PaperForm, PhiCourse, largest, run};
use crate::published::Published;
use crate::record::{Section, Statement, Table, Verdict};

/// Estimator rate at which orders are compared \[rad/s\].
const RATE: f64 = 69.6;

/// One turn of Fig. 4 \[rad/s\].
const TURN: f64 = TAU / 6.17;

/// A φ with a constant and two sines, as an arm under load makes it \[N·m\].
fn lively() -> PhiCourse {
    PhiCourse::sines(&[(5.0, 0.0, TAU / 4.0), (12.0, TURN, 0.3), (3.0, 7.0 * TURN, 1.1)])
}

/// (16) and (8) are one controller, from rest.
pub(super) fn lemma_1() -> Section {
    let mut rows = Vec::new();
    let mut worst: f64 = 0.0;
    for order in 1..=4 {
        let law = equal_rate(order, RATE);
        let of = |form| run(&law, form, &[], &lively(), (1e-3, 3000));
        let (eight, sixteen) = (of(PaperForm::Estimator), of(PaperForm::Ladder));
        let size = largest(eight.iter().map(|x| x.phi_hat));
        let apart = largest(eight.iter().zip(&sixteen).map(|(a, b)| a.phi_hat - b.phi_hat)) / size;
        worst = worst.max(apart);
        rows.push(words(&[format!("{order}"), format!("{apart:.1e}")]));
    }
    let equal = Published {
        id: "lemma1-forms",
        place: "Lemma 1",
        claim: "The feedback (16) of the integrals of e is the estimator (8)",
        paper: "equivalent",
    }
    .found(
        format!("φ̂ differs by at most {worst:.1e} of its size over 3 s, m = 1 … 4"),
        Verdict::of(worst < 1e-6, false),
        "Both loops are linear and are solved exactly, from rest, for a φ of a constant and two sines.",
        vec![number("largest relative difference", "", worst, 1e3)],
    );
    Section {
        id: "lemma-1".to_owned(),
        title: "Lemma 1: two forms of the estimator".to_owned(),
        text: words(&[
            "(16) integrates (7) m times. An integral has a value to start from, and the proof takes \
                       it to be zero: the forms agree from rest and part ways with the first error.",
        ]),
        statements: vec![equal, start(), shapes()],
        tables: vec![Table {
            id: "lemma-1-orders".to_owned(),
            title: "Difference of φ̂ between (8) and (16), relative to its largest value".to_owned(),
            columns: words(&["m", "largest difference"]),
            rows,
        }],
        figures: Vec::new(),
    }
}

/// "Starts with zero system information" is true of (8) only.
fn start() -> Statement {
    let e = 0.1;
    let first = |law: &UnitLaw, form, x: &[f64]| {
        run(law, form, x, &PhiCourse::polynomial(&[0.0]), (1e-3, 1))[0].phi_hat
    };
    let ladder = |law: &UnitLaw| {
        let mut x = vec![0.0; law.order() + 2];
        x[law.order()] = e;
        first(law, PaperForm::Ladder, &x)
    };
    let printed = all().map(|(name, law)| (name, ladder(&law)));
    let eight = largest(all().iter().map(|(_, law)| first(law, PaperForm::Estimator, &[e])));
    let least = printed.iter().fold(f64::INFINITY, |least, (_, v)| least.min(v.abs()));
    let listed = printed.iter().map(|(name, v)| format!("{name}: {}", three((*v).into())));
    let number =
        |(name, v): &(&str, f64)| number(&format!("φ̂(0) at e = 0.1 rad, {name}"), "N·m", *v, 1e-9);
    Published {
        id: "lemma1-start",
        place: "Abstract; Sec. II-B; (9), (10)",
        claim: "The estimate starts from zero",
        paper: "φ̂(0) = 0",
    }
    .found(
        format!(
            "φ̂(0) at e = 0.1 rad [N·m], (9) and (10): {}; (8): {}",
            listed.collect::<Vec<_>>().join("; "),
            three(eight.into())
        ),
        Verdict::of(least < 1e-9, eight < 1e-9),
        "With integrators at zero, (9) and (10) begin at −a_{m−1}(ė + K_d e) − a_{m−2} e, not at zero: the \
         estimate of an unloaded joint that is 0.1 rad off. The estimator (8) itself can start at zero; the observer \
         form of this project does. What that does to an arm is simulated at Figs. 5 and 6.",
        printed.iter().map(number).collect(),
    )
    .assuming(&["gains"])
}

/// Two matrices are printed as columns.
fn shapes() -> Statement {
    type Shape = (usize, usize);
    let (n, m) = (3, 2);
    let states = (m + 2) * n;
    // Rows and columns of a product; none where it is not defined.
    let times = |a: Shape, b: Shape| (a.1 == b.0).then_some((a.0, b.1));
    let defined = |c: Shape, b: Shape| {
        times(c, (n, 1)) == Some((n, 1)) && times(b, (n, 1)) == Some((states, 1))
    };
    let (printed, corrected) = (((n, 1), (states, 1)), ((n, n), (states, n)));
    let listed = |((r, c), (s, d)): (Shape, Shape)| format!("C {r}×{c}, B {s}×{d}");
    Published {
        id: "erratum-shapes",
        place: "(1), (15)",
        claim: "C(q, q̇)q̇ and Bφ̂ are products of matrix and vector",
        paper: "C ∈ ℝ^{n×1}, B ∈ ℝ^{(m+2)n×1}",
    }
    .found(
        format!(
            "n = 3, m = 2, for vectors of 3: printed {}; it takes {}",
            listed(printed),
            listed(corrected)
        ),
        Verdict::of(defined(printed.0, printed.1), defined(corrected.0, corrected.1)),
        "C ∈ ℝ^{n×n} in (1), B ∈ ℝ^{(m+2)n×n} in (15). The paper uses both as if they were.",
        vec![number("columns of C and of B", "", n as f64, 0.0)],
    )
}

/// Theorem 1: convergence of e and φ̃.
pub(super) fn theorem_1() -> Section {
    let (mut rows, mut numbers) = (Vec::new(), Vec::new());
    let (mut vanish, mut persist, mut off): (f64, f64, f64) = (0.0, f64::INFINITY, 0.0);
    for order in 1..=3 {
        let law = equal_rate(order, RATE);
        let degree: Vec<f64> = [20.0, 30.0, 40.0][..order].to_vec();
        let free =
            run(&law, PaperForm::Estimator, &[0.1], &PhiCourse::polynomial(&degree), (1e-3, 4000));
        let left = largest(free.iter().skip(3500).map(|x| x.phi_hat - x.phi)) / 20.0;
        vanish = vanish.max(left);
        let turning = PhiCourse::sines(&[(20.0, TURN, 0.0)]);
        let driven = run(&law, PaperForm::Estimator, &[], &turning, (1e-3, 12_000));
        let steady = largest(driven.iter().skip(5800).map(|x| x.phi_hat - x.phi)) / 20.0;
        let closed = closed_form(&law);
        persist = persist.min(steady);
        off = off.max((steady / closed - 1.0).abs());
        rows.push(words(&[
            format!("{order}"),
            format!("{left:.1e}"),
            format!("{steady:.3e}"),
            format!("{closed:.3e}"),
        ]));
        numbers.push(number(&format!("|φ̃|/|φ| on a sine, m = {order}"), "", steady, 1e-4));
    }
    numbers.push(number("left of a polynomial of degree m − 1", "", vanish, 1e4));
    let converges = Published {
        id: "theorem1-convergence",
        place: "Theorem 1",
        claim: "e = 0 and φ̃ = 0 are asymptotically stable",
        paper: "asymptotic stability, for system (1)",
    }
    .found(
        format!(
            "degree < m: {vanish:.1e} of φ is left after 3.5 s at most, rounding. Sine of 6.17 s: {} of φ is left at m \
                = 1, for ever",
            three(closed_form(&equal_rate(1, RATE)).into())
        ),
        Verdict::of(vanish < 1e-8 && persist < 1e-8, vanish < 1e-8 && off < 1e-3),
        "φ̃ obeys φ̃^{(m)} + Σ a_i φ̃^{(i)} = −φ^{(m)}. It goes to zero where φ^{(m)} does; any other φ, such as that \
         of an arm that moves, leaves |jω|^m/|A_o(jω)| of it: input-to-state stability from φ^{(m)}, not \
         asymptotic stability.",
        numbers,
    );
    Section {
        id: "theorem-1".to_owned(),
        title: "Theorem 1: where the mismatch goes".to_owned(),
        text: vec![format!(
            "K_p = {}, K_d = {}, every estimator pole at {RATE} rad/s. The joint starts 0.1 rad off.",
            OUTER.0, OUTER.1
        )],
        statements: vec![converges],
        tables: vec![mismatch_table(rows)],
        figures: Vec::new(),
    }
}

/// Remaining mismatch, order by order.
fn mismatch_table(rows: Vec<Vec<String>>) -> Table {
    Table {
        id: "theorem-1-mismatch".to_owned(),
        title: "What is left of the mismatch φ̃, relative to φ".to_owned(),
        columns: words(&[
            "m",
            "polynomial of degree m − 1, after 3.5 s",
            "sine of 6.17 s",
            "|jω|^m/|A_o(jω)|",
        ]),
        rows,
    }
}

/// `|ω^m/A_o(jω)|` at one turn of Fig. 4.
fn closed_form(law: &UnitLaw) -> f64 {
    let square = polynomial::value(&polynomial::magnitude_squared(&law.a_o()), TURN * TURN);
    (0..law.order()).fold(1.0, |p, _| p * TURN) / square.sqrt()
}
