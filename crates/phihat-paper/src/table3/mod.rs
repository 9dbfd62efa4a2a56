//! Table 3 and Fig. 14: PD, the H-infinity PID and the proposed law on arms of seven joints.

mod against;
mod arm;
mod bench;
mod left;
mod order;
mod outer_loop;
mod page;
mod printed;
mod ratios;
mod robots;
mod size;
mod words_only;

use super::compose::{section, words};
use super::record::Section;
use crate::part::{Extent, PaperPart, PartError};
use crate::record::Assumption;
use against::{beats_comparator, beats_pd, fair};
use arm::{ArmScores, RUNS};
use bench::Bench;
use order::Started;
use page::{errors_table, fig_14, gains_table, robots_table};
use size::{SAME_SIZE, size_of_pd, size_of_proposed, times_better, unit};

/// The studies, as shipped.
pub(super) const SHIPPED: [(&str, &str); 2] = [
    ("studies/paper/table3_panda.toml", include_str!("../../studies/table3_panda.toml")),
    ("studies/paper/table3_iiwa14.toml", include_str!("../../studies/table3_iiwa14.toml")),
];

/// Table 3 on two arms, with gains as far as they are stated, and with every law tuned alike.
pub(super) fn table3(_: Extent, progress: &dyn Fn(f64)) -> Result<PaperPart, PartError> {
    let (mut arms, mut done) = (Vec::new(), 0.0);
    for ((path, text), name) in SHIPPED.into_iter().zip(["panda", "iiwa14"]) {
        let bench = Bench::new(path, name, text)?;
        arms.push(ArmScores::of(bench, || {
            done += 1.0 / 6.0;
            progress(done);
        })?);
    }
    Ok(PaperPart { assumptions: assumptions(), sections: vec![page(&arms)?] })
}

fn assumptions() -> Vec<Assumption> {
    vec![Assumption {
        id: "seven-joints".to_owned(),
        missing: "The seven-joint arm of Table 3 and Fig. 14, its gains, its references, the comparator's gains and \
            T_1, T_2."
            .to_owned(),
        assumed: "Franka Panda and KUKA iiwa 14 under gravity, with encoders, one sample of delay and dry friction; \
                  K_p = 400, K_d = 40, a_0 = 69.6 with one nominal inertia per joint, the law in observer form, \
                  started on its reference; the comparator at this project's default gains; (51) from 4 to 10 s."
            .to_owned(),
        influence: "Two arms; gains as stated, a weaker comparator, and all laws tuned alike: each statement tells \
                    where the answer differs."
            .to_owned(),
    },
    Assumption {
        id: "what-pd-is".to_owned(),
        missing: "What “simple PD” is, what the robot compensates by itself, and whether Table 3 lists (51) or its \
            root.".to_owned(),
        assumed: "PD as −K_p e − K_d ė and as the outer loop (3) with q̈_d; a robot that leaves all of its gravity and \
                  friction to the law, or no gravity and 100, 20, 5 or 0 % of its friction; the table as (51) and as \
                  its root."
            .to_owned(),
        influence: "It decides the size: read as (51) no robot tried has errors of the printed size, read as roots the \
                    robots that compensate do."
            .to_owned(),
    }]
}

fn page(arms: &[ArmScores]) -> Result<Section, PartError> {
    let text = format!(
        "Gains as far as the paper states them: PD and the proposed law with the same K_p and K_d. Its comparator was \
         tuned by trial and error, to gains that are not printed; here it has this project's default gains, and once a \
         quarter of them. Then, a comparison of ours: every law tuned by the same optimiser with {RUNS} runs on two \
         other motions, torque noise capped alike, and scored on the motion of the study. Absolute numbers depend on \
         an arm that is not published; ratios between the laws are compared."
    );
    let robots = format!(
        "“Simple PD” and the unit are read in two ways. PD: −K_p e − K_d ė, or the outer loop (3), with q̈_d. Unit: \
         (51) is a mean square, in rad²; the heading “rad” fits its root. And a lightweight arm, as in the paper's \
         experiments, compensates its gravity and most of its friction by itself, so that a law is left a share of \
         them. Two sizes are called alike where their geometric means over the joints are within {SAME_SIZE} times \
         each other: joint by joint two different arms cannot be compared."
    );
    let mut section = section("table-3", "Table 3 and Fig. 14: seven joints", &[&text, &robots]);
    let started = arms.iter().map(|arm| Started::of(&arm.bench)).collect::<Result<Vec<_>, _>>()?;
    let mut statements = vec![
        beats_pd(arms),
        beats_comparator(arms),
        fair(arms),
        size_of_proposed(arms),
        size_of_pd(arms),
        times_better(arms),
        unit(arms),
        words_only::radius(arms)?,
        words_only::higher_order(arms),
        order::transient(&started),
    ];
    for statement in &mut statements {
        statement.assumptions = words(&["seven-joints"]);
        statement.studies = arms.iter().map(|arm| arm.bench.path.to_owned()).collect();
    }
    section.statements = statements;
    section.tables = arms
        .iter()
        .flat_map(|arm| [errors_table(arm), robots_table(arm), gains_table(arm)])
        .collect();
    section.figures = arms.iter().flat_map(fig_14).collect();
    Ok(section)
}
