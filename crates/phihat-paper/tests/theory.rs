//! For this to be wrong, closed forms written down here, the tables as printed and the exact loops of the reproduction
//! would have to agree by accident.

use std::collections::BTreeSet;
use std::sync::OnceLock;

use phihat_paper::{
    Coverage, Extent, Kind, Origin, Reproduction, Statement, Verdict, coverage, part,
    reproduce_only,
};
use phihat_report::kit::figure::Content;

/// The parts that these statements are of, by name.
fn made() -> &'static [(&'static str, Reproduction)] {
    static MADE: OnceLock<Vec<(&'static str, Reproduction)>> = OnceLock::new();
    MADE.get_or_init(|| {
        let make = |name| {
            (name, reproduce_only(Some(name), Extent { quick: true }, 1, &|_, _| ()).unwrap())
        };
        ["theory", "table 1", "table 2", "figures 12 and 13"].map(make).into()
    })
}

fn reproduced(name: &str) -> &'static Reproduction {
    &made().iter().find(|(part, _)| *part == name).unwrap().1
}

fn all() -> impl Iterator<Item = &'static Statement> {
    let sections = made().iter().flat_map(|(_, part)| &part.sections);
    sections.flat_map(|section| &section.statements)
}

/// A section and a statement lead back to the part that says them.
fn what_a_quick_part_says_leads_back_to_it() {
    for (name, made) in &made()[..2] {
        for section in &made.sections {
            assert_eq!(part(&section.id).unwrap(), *name);
            let all = section.statements.iter().map(|statement| part(&statement.id));
            assert!(all.flatten().all(|part| part == *name), "{}", section.id);
        }
    }
}

fn statement(id: &str) -> &'static Statement {
    all().find(|statement| statement.id == id).unwrap()
}

fn value(id: &str, number: usize) -> f64 {
    statement(id).numbers[number].value.unwrap()
}

fn near(value: f64, expected: f64, relative: f64) {
    assert!((value - expected).abs() <= relative * expected.abs(), "{value} is not {expected}");
}

/// One test, since all of them read the same statements, which take a minute of processor time to make.
#[test]
fn statements_of_the_theory() {
    let checks: [(&str, fn()); 16] = [
        ("what_a_quick_part_says_leads_back_to_it", what_a_quick_part_says_leads_back_to_it),
        ("what_theorem_1_leaves_is_the_closed_form", what_theorem_1_leaves_is_the_closed_form),
        (
            "the_residual_of_the_printed_q33_is_its_own_error",
            the_residual_of_the_printed_q33_is_its_own_error,
        ),
        ("game_and_bounds", game_and_bounds),
        ("table_2_in_numbers", table_2_in_numbers),
        ("what_is_left_of_polynomials", what_is_left_of_polynomials),
        ("what_the_paper_says_around_its_theorems", what_the_paper_says_around_its_theorems),
        ("statements_say_how_they_were_read", statements_say_how_they_were_read),
        ("what_is_said_in_words", what_is_said_in_words),
        ("what_is_covered_is_counted", what_is_covered_is_counted),
        ("table_1_has_the_rows_of_the_paper", table_1_has_the_rows_of_the_paper),
        ("whose_statement_it_is", whose_statement_it_is),
        ("errata_come_out_as_corrections", errata_come_out_as_corrections),
        ("well_formed", well_formed),
        ("every_reading_of_the_gains_is_judged", every_reading_of_the_gains_is_judged),
        ("a_second_referee", a_second_referee),
    ];
    for (name, check) in checks {
        println!("{name}");
        check();
    }
}

/// `|φ̃/φ| = (ω/|jω + a|)^m` for equal poles.
fn what_theorem_1_leaves_is_the_closed_form() {
    let omega = core::f64::consts::TAU / 6.17;
    for (number, power) in [(0, 1), (1, 2), (2, 3)] {
        near(value("theorem1-convergence", number), (omega / omega.hypot(69.6)).powi(power), 1e-4);
    }
    assert_eq!(statement("theorem1-convergence").verdict, Verdict::WithCorrection);
    near(value("lemma1-start", 0), -69.6 * 40.0 * 0.1, 1e-9);
    // H1, H2, H3: −(a_1 K_d + a_0) e.
    for (number, [a_0, a_1]) in [(1, [4844.16, 69.6]), (2, [9688.32, 139.2]), (3, [4844.16, 139.2])]
    {
        near(value("lemma1-start", number), -(a_1 * 40.0 + a_0) * 0.1, 1e-9);
    }
}

/// Statements about gains that the paper does not print name all four hypotheses, or H3 and H4 where a certificate is
/// needed, or H1 and H2 where its absence is.
fn every_reading_of_the_gains_is_judged() {
    // Without a certificate at any K̃ (H1, H2), or at the printed K̃ only (H3).
    let about_certificates = ["table2-c2"];
    let with_gains = all().filter(|s| s.assumptions.iter().any(|a| a == "gains"));
    let in_part = with_gains.filter(|statement| {
        let names = statement.numbers.iter().map(|number| number.name.as_str());
        let text: String = names.chain([&*statement.ours]).collect();
        let [h1, h2, h3, h4] = ["H1", "H2", "H3", "H4"].map(|name| text.contains(name));
        !(h1 == h2 && (!h1 || (h3 && h4)) || about_certificates.contains(&&*statement.id))
    });
    let in_part: Vec<_> = in_part.map(|s| (&s.id, &s.ours, &s.numbers)).collect();
    assert!(in_part.is_empty(), "{in_part:#?}");
}

/// By hand: areas under |ė| and |e| put H4's threshold below 22.2 N·m, and √1211.04/20 = 1.74.
fn a_second_referee() {
    for id in ["theorem5-error-second", "step3-gain", "results-show-a2"] {
        assert_eq!(statement(id).verdict, Verdict::Open, "{id}");
    }
    near(value("theorem5-error-second", 3), 19.8, 5e-3);
    near(value("step3-gain", 4), 1.74, 1e-9);
    // K_d² = 2K_p − K̃b_0²/(K̃ − 2b_0) is where Q_33 vanishes; over K̃ the other entries decide.
    near(value("theorem2-a2", 1), 27.6, 2e-3);
    near(value("theorem2-a2", 2), 27.09, 1e-3);
    for (id, [k_tilde, roots]) in [("table2-a2", [463.172, 3.0]), ("table2-b2", [57.58, 3.0])] {
        let numbers = &statement(id).numbers;
        let number = |name: &str| numbers.iter().find(|n| n.name == name).unwrap().value.unwrap();
        near(number("roots of (44)"), roots, 0.0);
        near(number("least K̃ of a root"), k_tilde, 1e-4);
        near(number("K_p of that root"), 100.0, 1e-6);
        near(number("K_d of that root"), 20.0, 1e-6);
    }
}

/// Residual of entry (3, 3) of (13) with the printed `Q_33`: `K̃ b_0² − K̃ b_0` over its largest term.
fn the_residual_of_the_printed_q33_is_its_own_error() {
    let (k, b, kp, kd) = (100.0, 34.8, 400.0, 40.0);
    let s34: f64 = kd + b;
    let s23 = b * kd * kd + k * kp + b * k * kd + kp * kd - b * kp;
    // 2 (S_23 − K_p S_34) − a_1 S_34² + S_34²/γ² + Q_33, a_1 = 139.2.
    let largest = (139.2 * s34 * s34).max(s23 - kp * s34);
    near(value("erratum-q33", 0), k * (b * b - b) / largest, 1e-6);
    near(value("erratum-q33", 2), (139.2_f64 - 100.0).sqrt().recip(), 1e-9);
}

/// The value of the game by the last 2×2 block of (18), and the errors of m = 1 by peak-to-peak gains of a PD
/// loop with a lag, found elsewhere.
fn game_and_bounds() {
    let (k, b, kd, x): (f64, f64, f64, [f64; 2]) = (100.0, 34.8, 40.0, [0.1, 0.5]);
    let s33 = kd * kd + b * k + k * kd;
    let expected = s33 * x[0] * x[0] + 2.0 * (kd + b) * x[0] * x[1] + x[1] * x[1];
    near(value("theorem4-value", 0), expected, 1e-6);
    assert!(value("theorem4-value", 2) < expected);
    assert!(
        value("l2-gain-bound", 1) <= value("l2-gain-bound", 0)
            && value("l2-gain-bound", 2) <= value("l2-gain-bound", 0)
    );
    near(value("theorem5-radius", 0), 207.0, 1e-2);
    near(value("theorem5-error-first", 0), 1e-2 / 5.02e-4, 1e-3);
    near(value("theorem5-velocity-first", 0), 0.1 / 1.69e-2, 5e-3);
    // H1 and H2 are there as well: the loop is stable with them, only the certificate is not.
    let last = statement("theorem5-error-second").numbers.iter().find(|n| n.name.ends_with("H3"));
    near(last.unwrap().value.unwrap(), 1e-2 / 1.96e-4, 2e-3);
    assert_eq!(statement("theorem5-velocity-second").verdict, Verdict::Refuted);
    assert_eq!(statement("theorem5-integrals-first").verdict, Verdict::AsPrinted);
    // ∫e under a constant φ is φ/(a_0 K_p), and that is the worst of an overdamped loop.
    near(value("theorem5-integrals-first", 0), 1e-3 * 69.6 * 400.0, 1e-4);
    // An entry beyond its own (40), by the gain and by a run that does not know it.
    assert_eq!(statement("theorem5-entrywise").verdict, Verdict::Refuted);
    near(value("theorem5-entrywise", 1), value("theorem5-entrywise", 0), 1e-3);
    assert!(value("theorem5-entrywise", 0) > 1.2 && value("theorem5-entrywise", 4) < 1.0);
    // m = 1: γ² = 1/(69.6 − 68.9), and at ω = 0 the gain is (K̃/a_0 + 1)/a_0.
    near(value("l2-gain-bound", 3), 1.0 / 0.7, 1e-9);
    near(value("l2-gain-bound", 5), (68.9 / 69.6 + 1.0) / 69.6, 1e-6);
}

fn table_2_in_numbers() {
    near(value("table2-a1", 0), 444.0, 1e-9);
    near(value("erratum-kd", 0), 500.0_f64.sqrt() - 10.0, 1e-9);
    near(value("table2-b1", 0), -3.3 * 156.0, 1e-9);
    near(value("table2-c2", 0), 68.9 - 139.2, 1e-6);
    // H1 and H2 have no K̃, and half the printed b_0 is not enough at the printed K̃.
    let c2 = statement("table2-c2");
    assert!(c2.numbers[1].value.is_none() && c2.numbers[2].value.is_none());
    near(value("table2-c2", 4), 68.9 - 69.6, 1e-6);
    assert_eq!(c2.verdict, Verdict::Refuted);
    near(value("table2-c1", 0), 0.7_f64.sqrt().recip(), 1e-6);
    near(value("table2-higher", 2), 222.0 / 68.9, 1e-9);
    // Row 1 of (44), m = 2 (B): ½K̃(b_0 K_p ∬e + BᵀSx).
    let x = [1e-4, 1e-3, 1e-2, 1e-1];
    let pull = 2000.0 * x[0] + 500.0 * x[1] + 40.0 * x[2] + x[3];
    near(value("table2-b2", 1), 0.5 * 63.4 * (2000.0 * x[0] + pull), 1e-9);
}

/// A ramp of slope c leaves c/a_0 at m = 1, a parabola with φ̈ = c the same over a_0 at m = 2.
fn what_is_left_of_polynomials() {
    near(value("fig13-polynomials", 0), 1.0, 1e-6);
    near(value("fig13-polynomials", 1), 20.0 / 400.0, 1e-6);
    assert_eq!(statement("fig13-polynomials").verdict, Verdict::AsPrinted);
    assert!(value("erratum-hyperbolic", 0) > 1e-3);
    let falls = |id: &str| (1..3).all(|k| value(id, k) < value(id, k - 1));
    assert!(falls("fig12-gain") && falls("fig13-real"));
}

/// Each against a closed form of its own.
fn what_the_paper_says_around_its_theorems() {
    // Routh for μs³ + (K_d + a_0)s² + (K_p + K_d a_0)s + K_p a_0.
    let (kp, kd, a) = (400.0, 40.0, 69.6);
    near(value("remark5-parameters", 0), (kd + a) * (kp + kd * a) / (kp * a), 1e-9);
    // φ/(a_0 K_p), and the integral is the first entry of x.
    near(value("eq28-asymptotic", 0), 22.2 / (a * kp), 1e-6);
    near(value("eq28-asymptotic", 1), 22.2 / (a * a * kp), 1e-6);
    near(value("theorem4-condition", 0), kp.hypot(kd).hypot(1.0), 1e-9);
    // With K_p = 100 and K_d = 20 the row of ė reads K̃ (0.1 + ½·0.6) = 2φ.
    near(value("analytical-first", 0), 22.2 / (0.5 * 0.1 + 0.5 * 0.4), 1e-9);
    // e^{−rt} = 0.01, and (rt − 1)e^{−rt} = 0.01.
    near(value("third-order-faster", 0), 100.0_f64.ln() / 20.0, 1e-3);
    let rt = 20.0 * value("third-order-faster", 1);
    near((rt - 1.0) * (-rt).exp(), 0.01, 1e-2);
    assert!(value("third-order-faster", 2) > value("third-order-faster", 1));
    // K_P²/(2K_I) at K_d = 28: more than 1 without B2.
    let (gain, k_p) = (28.0 + a, kp + a * 28.0);
    near(value("remark9-choi-condition", 1), k_p * k_p / (2.0 * a * kp * gain), 1e-9);
    assert!(value("remark9-choi-condition", 1) > 1.0 && 28.0 * 28.0 < 2.0 * kp);
    // Any ρ, up to the edge of (28) and not beyond.
    near(value("theorem3-alpha", 0), 0.456, 1e-2);
    assert_eq!(value("theorem3-alpha", 1).to_bits(), 0);
}

/// Every statement of the paper says how it was read and where it turns, and covers what it says.
fn statements_say_how_they_were_read() {
    for statement in all().filter(|statement| statement.origin == Origin::Paper) {
        let Statement { id, reading, turns, .. } = statement;
        assert!(!reading.is_empty() && !turns.is_empty(), "{id}");
    }
    let covered: BTreeSet<_> = all().flat_map(|s| s.covers.iter().copied()).collect();
    let theorems = covered.iter().filter(|item| item.kind == Kind::Theorem).count();
    assert_eq!(theorems, 5);
}

/// Poles of ±√78 j; the least K̃ of (40) is 2φ_max K_p/(∫e_max λ_min) with λ_min = K̃ min(K_p², …) at K_p = 1.
fn what_is_said_in_words() {
    assert!(statement("results-show-a2").ours.contains("±8.83j"));
    near(value("step1-by-40", 0), 2.0 * 22.2 / 1e-3, 1e-3);
    // (1 + 20t)e^{−20t} = 0.02.
    near(value("step2-transient", 5), 5.834 / 20.0, 1e-3);
    // An estimate held at φ_max while φ goes to −φ_max.
    near(value("pd-after-convergence", 1), 2.0 * 22.2 / 400.0, 1e-2);
    assert_eq!(value("only-state", 0).to_bits(), 0);
    assert!(value("only-state", 1) > 0.1);
    assert!(value("low-cost", 0) < value("low-cost", 1));
}

/// Coverage is counted from the references, and what is left out has a reason.
fn what_is_covered_is_counted() {
    let all = coverage(reproduced("theory"));
    for Coverage { kind, covered, all, left_out } in &all {
        assert_eq!((*all, covered + left_out.len()), (kind.count().into(), *all));
        assert!(left_out.iter().all(|left| !left.why.is_empty()));
    }
    let mut nothing = reproduced("theory").clone();
    nothing.sections.clear();
    assert!(coverage(&nothing).iter().all(|part| part.covered == 0));
}

/// Thirteen rows, one of them "-", one of them two laws of which one is handed a model.
fn table_1_has_the_rows_of_the_paper() {
    let rows: Vec<f64> = (0..3).map(|number| value("table1-model-free", number)).collect();
    assert_eq!(rows, [13.0, 12.0, 1.0]);
    let ours = &statement("table1-model-free").ours;
    assert!(ours.contains("[5], [12] (nric)") && ours.ends_with("\"-\": [22]"), "{ours}");
    for id in ["fat", "taylor-network", "fuzzy", "ultra-local"] {
        assert!(phihat_rivals::rival(id).unwrap().card.printed.is_none(), "{id}");
    }
}

/// Statements that are not the paper's are not counted as such, and H1 and H2 have none that needs a certificate.
fn whose_statement_it_is() {
    let of = |origin| all().filter(move |s| s.origin == origin).map(|s| s.id.as_str());
    let ours: Vec<_> = of(Origin::Ours).collect();
    assert_eq!(
        ours,
        ["remark9-choi-condition", "erratum-40-cond", "theorem5-attained", "step3-gain"]
    );
    let again: Vec<_> = of(Origin::Again).collect();
    assert_eq!(again, ["term-ignored", "table2-equal-rows", "eq50-joint"]);
    for id in ["theorem4-worst-case", "theorem4-value"] {
        assert!(statement(id).ours.starts_with("H3: "), "{id}");
    }
    assert!(all().all(|s| !s.ours.contains("literal") && !s.why.contains("literal")));
}

fn errata_come_out_as_corrections() {
    let errata = reproduced("theory").sections.iter().find(|s| s.id == "errata").unwrap();
    let rows = &errata.tables[0].rows;
    assert!(rows.len() >= 19);
    for row in rows {
        let elsewhere = ["erratum-table3-unit", "phi-hat-to-zero"];
        for id in row[3].split(", ").filter(|id| !elsewhere.contains(id)) {
            assert_ne!(statement(id).verdict, Verdict::AsPrinted, "{id}");
        }
    }
    for sound in ["lemma1-forms", "theorem2-conditions", "theorem2-first-order", "theorem2-a2"] {
        assert_eq!(statement(sound).verdict, Verdict::AsPrinted, "{:?}", statement(sound));
    }
    for sound in ["remark9-choi", "l2-gain-bound", "theorem3-dissipation", "theorem4-worst-case"] {
        assert_eq!(statement(sound).verdict, Verdict::AsPrinted, "{:?}", statement(sound));
    }
}

/// Requirements of a page: unique names, square tables, curves that can be drawn.
fn well_formed() {
    let mut ids = BTreeSet::new();
    for name in ["theory", "table 1", "table 2", "figures 12 and 13"] {
        for section in &reproduced(name).sections {
            assert!(ids.insert(section.id.clone()), "{}", section.id);
            for statement in &section.statements {
                assert!(ids.insert(statement.id.clone()), "{}", statement.id);
                assert!(!statement.ours.is_empty() && !statement.why.is_empty());
            }
            for table in &section.tables {
                assert!(
                    table.rows.iter().all(|row| row.len() == table.columns.len()),
                    "{}",
                    table.id
                );
            }
            for panel in section.figures.iter().flat_map(|figure| &figure.panels) {
                let Content::Lines { series, .. } = &panel.content else { continue };
                assert!((1..=6).contains(&series.len()), "{}", panel.title);
                let finite = |point: &[f64; 2]| point.iter().all(|v| v.is_finite());
                assert!(series.iter().all(|s| s.points.len() > 10 && s.points.iter().all(finite)));
            }
        }
    }
}
