//! Size of the errors of Table 3, and their unit.

use phihat_campaign::statistics::geometric_mean;

use super::arm::ArmScores;
use super::bench::{Score, mean_square};
use super::printed::PRINTED;
use super::ratios::{on_arms, span, written};
use super::robots::Table3Robot;
use crate::compose::{number, three};
use crate::item::{Item, Kind};
use crate::published::Published;
use crate::record::{PaperNumber, Statement, Verdict};

/// Two sizes are alike where their geometric means over the joints are within so many times each other.
pub(super) const SAME_SIZE: f64 = 2.0;

/// Table 3 and (51).
const COVERS: [Item; 2] =
    [Item { kind: Kind::Table, number: 3 }, Item { kind: Kind::Equation, number: 51 }];

/// A quantity per joint: the paper's as printed, and ours on a robot, both as rms \[rad\] or a ratio of rms.
struct Sized<'a> {
    /// Name of the quantity, for names of numbers.
    what: &'a str,
    paper: Vec<f64>,
    ours: &'a dyn Fn(&Table3Robot) -> Vec<f64>,
    /// From the paper's figure to what it would be were the table one of (51) as the text says.
    as_text: fn(f64) -> f64,
}

impl Sized<'_> {
    /// Geometric mean of the paper over that of ours, on every arm and robot; the paper read as its heading has it,
    /// or as its text has it.
    fn apart(&self, arms: &[ArmScores], heading: bool) -> Vec<Vec<f64>> {
        let read = |value: &f64| if heading { *value } else { (self.as_text)(*value) };
        let paper = geometric_mean(&self.paper.iter().map(read).collect::<Vec<_>>());
        let of = |arm: &ArmScores| {
            arm.robots.iter().map(|robot| paper / geometric_mean(&(self.ours)(robot))).collect()
        };
        arms.iter().map(of).collect()
    }

    /// The robots on which the size is the paper's, in every arm, by their places.
    fn alike(&self, arms: &[ArmScores], heading: bool) -> Vec<usize> {
        let apart = self.apart(arms, heading);
        let robots = apart.first().map_or(0, Vec::len);
        let near = |apart: f64| (1.0 / SAME_SIZE..=SAME_SIZE).contains(&apart);
        (0..robots).filter(|k| apart.iter().all(|arm| near(arm[*k]))).collect()
    }

    /// As printed where the text's reading fits on some robot, with a correction where the heading's does.
    fn verdict(&self, arms: &[ArmScores]) -> Verdict {
        let some = |heading| !self.alike(arms, heading).is_empty();
        Verdict::assumed(some(false), some(true))
    }

    fn numbers(&self, arms: &[ArmScores]) -> Vec<PaperNumber> {
        let apart = self.apart(arms, true);
        let of = |(arm, apart): (&ArmScores, &Vec<f64>)| {
            let each = arm.robots.iter().zip(apart).map(|(robot, apart)| {
                let (name, left) = (arm.name(), robot.left.words());
                number(
                    &format!("{}, the paper's over ours, {name}, {left}", self.what),
                    "",
                    *apart,
                    0.05,
                )
            });
            each.collect::<Vec<_>>()
        };
        arms.iter().zip(&apart).flat_map(of).collect()
    }

    /// Robots on which the sizes agree, and the smallest factor between the sizes in either reading, in words.
    fn threshold(&self, arms: &[ArmScores]) -> String {
        let nearest = |heading: bool| {
            let all =
                self.apart(arms, heading).into_iter().flatten().map(|apart| apart.max(1.0 / apart));
            three(Some(all.fold(f64::INFINITY, f64::min)))
        };
        let alike = self.alike(arms, true);
        let robots = arms.first().map_or(&[][..], |arm| &arm.robots);
        let listed: Vec<String> = alike.iter().map(|k| robots[*k].left.words()).collect();
        let listed = if listed.is_empty() { "none".to_owned() } else { listed.join("; ") };
        format!(
            "Within {SAME_SIZE} times on both arms where the law is left: {listed}. The nearest robot is {} times off \
             as roots, {} times as (51).",
            nearest(true),
            nearest(false)
        )
    }
}

const VARIED: &str = "Panda and iiwa; all of gravity and friction left to the law, or no gravity and 100, 20, 5, 0 % \
                      of the friction; the table as (51) and as its root.";

/// Finds a statement on size.
fn sized(arms: &[ArmScores], of: &Sized<'_>, published: Published<'_>, why: &str) -> Statement {
    let spans = |place: usize| {
        on_arms(arms, |arm| arm.robots.get(place).map_or_else(Vec::new, |robot| (of.ours)(robot))).0
    };
    // The robot that leaves a twentieth of its friction, and the one that leaves everything.
    let (bare, light) = (spans(0), spans(3));
    published
        .found(
            format!("5 % of the friction left: {light}; nothing compensated: {bare}"),
            of.verdict(arms),
            why,
            of.numbers(arms),
        )
        .read_as(
            "Geometric means over seven joints, the paper's against ours: its own arm is not printed. The table's \
             figures as root mean squares in rad, as its heading has it.",
        )
        .varying(VARIED)
        .turning(of.threshold(arms))
        .covering(&COVERS)
}

/// Statement on the error of the proposed law.
pub(super) fn size_of_proposed(arms: &[ArmScores]) -> Statement {
    let paper: Vec<f64> = PRINTED.iter().map(|row| row[2] * 1e-4 * 1e3).collect();
    let of = Sized {
        what: "rms of the proposed law",
        paper: paper.clone(),
        ours: &|robot| robot.proposed[0].rms().into_iter().map(|rms| rms * 1e3).collect(),
        as_text: |printed| (printed * 1e-3).sqrt() * 1e3,
    };
    let published = Published {
        id: "table3-size-proposed",
        place: "Table 3",
        claim: "How large the error of the proposed law is",
        paper: &format!("{} mrad, if roots", written(span(&paper))),
    };
    let why = "Read as roots of (51) the size comes out with the gains of Table 2 (C). Read as (51), the errors would \
               be larger by an order of magnitude or more on every robot tried: the heading is right, and the table's \
               figures are roots.";
    let bad = "Neither reading gives the size on both arms.";
    let why = if of.verdict(arms) == Verdict::Open { bad } else { why };
    sized(arms, &of, published, why)
}

/// Statement on the error of PD.
pub(super) fn size_of_pd(arms: &[ArmScores]) -> Statement {
    let paper: Vec<f64> = PRINTED.iter().map(|row| row[0] * 1e-4 * 1e3).collect();
    let of = Sized {
        what: "rms of PD as (3)",
        paper: paper.clone(),
        ours: &|robot| robot.outer.rms().into_iter().map(|rms| rms * 1e3).collect(),
        as_text: |printed| (printed * 1e-3).sqrt() * 1e3,
    };
    let plain = Sized {
        what: "rms of PD without q̈_d",
        ours: &|robot| robot.plain.rms().into_iter().map(|rms| rms * 1e3).collect(),
        paper: paper.clone(),
        ..of
    };
    let published = Published {
        id: "table3-size-pd",
        place: "Table 3",
        claim: "How large the error of PD is",
        paper: &format!("{} mrad, if roots", written(span(&paper))),
    };
    let without = if plain.alike(arms, true).is_empty() {
        "Without q̈_d PD has that size on no robot tried on both arms: its error is then that of the acceleration as \
            well"
    } else {
        "Without q̈_d PD has that size on some of the robots as well"
    };
    let why = format!(
        "“Simple PD” as the outer loop (3), on a robot that compensates its gravity and nearly all of its friction, as \
         the lightweight arms of such experiments do. {without}. On a robot that compensates nothing no PD of these \
         gains comes near."
    );
    let mut statement = sized(arms, &of, published, &why);
    statement.numbers.extend(plain.numbers(arms));
    statement
}

/// By how much the one is better than the other.
pub(super) fn times_better(arms: &[ArmScores]) -> Statement {
    let paper: Vec<f64> = PRINTED.iter().map(|row| row[0] / row[2]).collect();
    let outer: fn(&Table3Robot) -> &Score = |robot| &robot.outer;
    let of = Sized {
        what: "rms of PD as (3) over the proposed law's",
        paper: paper.clone(),
        ours: &|robot| robot.times(outer),
        as_text: f64::sqrt,
    };
    let published = Published {
        id: "table3-size",
        place: "Table 3",
        claim: "By how much the proposed law is better than PD",
        paper: &format!("{} times, if roots", written(span(&paper))),
    };
    let why = "With PD as the outer loop (3) on a robot that compensates its gravity and most of its friction the \
               factor is the paper's. On a robot that compensates nothing it is larger by an order of magnitude, as \
               gravity has it: PD has no integral action.";
    sized(arms, &of, published, why)
}

/// (51) is a mean square.
pub(super) fn unit(arms: &[ArmScores]) -> Statement {
    let errors = arms.first().and_then(|arm| arm.stated[2].errors.first()).map_or(&[][..], |e| e);
    let doubled: Vec<f64> = errors.iter().map(|e| 2.0 * e).collect();
    let factor = mean_square(&doubled) / mean_square(errors);
    Published {
        id: "erratum-table3-unit",
        place: "Table 3, (51)",
        claim: "Table 3 lists (51), in rad",
        paper: "rad",
    }
    .found(
        format!("twice the error gives {} times (51): rad²", three(factor.into())),
        Verdict::of((factor - 2.0).abs() < 1e-9, (factor - 4.0).abs() < 1e-9),
        "(51) is a mean square, in rad², and the heading says rad: one of the two has to give way. Which one a \
         dimension does not show; the sizes above are those of roots, in rad.",
        vec![number("factor", "", factor, 1e-9)],
    )
    .read_as("The dimension of (51) against the heading of Table 3.")
    .turning("None: a matter of dimension.")
    .covering(&COVERS)
}
