//! The errata in one list, each with the statement that shows it.

use crate::compose::words;
use crate::record::{Section, Statement, Table};

/// Place, printed, correct, id of the statement that computes it.
const ERRATA: &[[&str; 4]] = &[
    ["(1)", "C ∈ ℝ^{n×1}", "C ∈ ℝ^{n×n}", "erratum-shapes"],
    ["(15)", "B ∈ ℝ^{(m+2)n×1}", "B ∈ ℝ^{(m+2)n×n}", "erratum-shapes"],
    ["(12)", "ẋ = Ax + CBu + CDd", "ẋ = Ax + Bu + Dd", "erratum-stray-c"],
    ["(20), Sec. V-A", "a_{m−1}I with K̃(i, i)", "one a_{m−1} per joint", "erratum-20-scalar"],
    ["Remark 5", "only a_i, K_p and K_d to tune", "and M̄, printed as 1", "remark5-parameters"],
    [
        "Abstract, Sec. II-B",
        "(9), (10) start at φ̂ = 0",
        "they start at −a_{m−1}(ė + K_d e) − a_{m−2}e",
        "lemma1-start",
    ],
    [
        "Theorem 1",
        "asymptotic stability",
        "input-to-state stability from φ^{(m)}",
        "theorem1-convergence",
    ],
    ["(18), Q_33", "K̃ b_0 + …", "K̃ b_0² + …", "erratum-q33"],
    [
        "Before Theorem 2",
        "no general procedure for all m",
        "q_i and S in closed form for every m",
        "theorem2-orders",
    ],
    [
        "(20), Sec. III-B",
        "proved in Sec. V; α = 1 in Sec. IV-B",
        "Sec. IV-C, both",
        "erratum-references",
    ],
    ["Sec. III-B", "stable for φ ∈ L₂[0, ∞)", "bounded for bounded φ", "erratum-l2"],
    ["(32), (34)", "no term with x[1]", "− K̃b_0²K_p² x[1]²", "erratum-32"],
    ["After (28)", "also asymptotically stable", "at d = 0", "eq28-asymptotic"],
    [
        "Theorem 4",
        "ρ⁻¹(|x|)/|x_Δ| = 1/γ²",
        "1/γ² in its place: no ρ ∈ K∞ does",
        "theorem4-condition",
    ],
    ["Theorem 4, proof", "J = −2V(x(0)) − …", "J = +2V(x(0)) + …", "theorem4-value"],
    ["Theorem 4, proof", "2xᵀSBu C xᵀSBK̃BᵀSx", "a plus in place of C", "erratum-chain"],
    ["After (41)", "SBK̃BS", "SBK̃BᵀS", "erratum-41"],
    ["(39)", "φ̂ = +(K̃ + I/γ²)x_Δ", "minus", "erratum-39"],
    ["(40)", "ultimate bound", "√cond(S) times it", "theorem5-radius"],
    ["End of proof of Theorem 5", "V̇ < 0 iff |x| ≤ …", "if |x| > …", "erratum-40-sign"],
    [
        "(40)",
        "a bound entry by entry",
        "a bound of the length, with √cond(S)",
        "theorem5-entrywise",
    ],
    ["End of proof of Theorem 5", "proves Theorem 1", "bounded, under A1 to A3", "proves-theorem1"],
    ["(44)", "row by row, a bound", "no bound", "theorem5-componentwise"],
    ["After (44), K_d", "√(2K_p + c²) − c", "+ c", "erratum-kd"],
    [
        "Sec. V-A, m = 1",
        "no analytical solution with xᵀSBBᵀSx",
        "in closed form",
        "analytical-first",
    ],
    ["Sec. V-B", "third order: faster", "smaller, not faster", "third-order-faster"],
    ["Table 2 (A), m = 1", "K̃ = 222", "444 by its own formula", "table2-a1"],
    ["Table 2 (B), m = 1", "K_d = 0", "violates B2", "table2-b1"],
    ["Table 2 (A), m = 2", "b_0 = 0", "violates A1", "table2-a2"],
    ["Table 2 (C), m = 2", "K̃ = 68.9, b_0 = 69.6", "violates A3", "table2-c2"],
    [
        "Table 1, Sec. VI",
        "[5], [12]: ✓ model-free",
        "\"-\"; their design needs the system",
        "erratum-table1-pid",
    ],
    [
        "After Theorem 2",
        "the results show A2 unnecessary",
        "no stable column is without it",
        "results-show-a2",
    ],
    ["Sec. VII-B", "φ̂ → 0", "φ̃ small", "phi-hat-to-zero"],
    ["Sec. VII-A", "parameters of table 1", "Table 2", "erratum-table-number"],
    ["Sec. VII-C", "hyperbolic φ", "parabolic φ", "erratum-hyperbolic"],
    ["Table 3", "rad", "rad²", "erratum-table3-unit"],
];

/// The list.
pub(super) fn errata(statements: Vec<Statement>) -> Section {
    Section {
        id: "errata".to_owned(),
        title: "Errata".to_owned(),
        text: words(&[
            "Found with a text copy of the paper; single signs and digits may be the copy's. Each line names the \
                       statement that computes it.",
        ]),
        statements,
        tables: vec![Table {
            id: "errata-list".to_owned(),
            title: "What is printed, what is right, and where it is shown".to_owned(),
            columns: words(&["place", "printed", "correct", "shown by"]),
            rows: ERRATA.iter().map(|row| words(row)).collect(),
        }],
        figures: Vec::new(),
    }
}
