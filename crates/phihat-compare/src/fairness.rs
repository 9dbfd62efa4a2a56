//! The terms that every rival was tuned and judged on, and what they do not show.

use crate::adapter::NOMINAL_MASSES;
use crate::cost::NOISE_CAP;
use crate::plan::ComparisonPlan;
use crate::record::Fairness;
use crate::world::TRAINING;

/// The terms of a plan.
pub(crate) fn fairness(plan: &ComparisonPlan) -> Fairness {
    let extent = &plan.extent;
    let scored = (0..plan.arms.len()).map(|g| plan.span(g)).map(|(end, from)| end - from);
    Fairness {
        optimiser: "CMA-ES in the logarithms of the free scalars, from the default values"
            .to_owned(),
        tuning_runs: extent.tuning_runs,
        widenings: extent.widenings,
        training: (
            usize::try_from(extent.training_motions).unwrap_or(usize::MAX),
            extent.training_s,
        ),
        training_worlds: TRAINING.map(|world| world.name.to_owned()).to_vec(),
        seeds: extent.seeds,
        scored_s: scored.fold(0.0, f64::max),
        nominal_masses: NOMINAL_MASSES,
        noise_cap: NOISE_CAP,
        draws: extent.draws,
        notes: notes(),
    }
}

fn notes() -> Vec<String> {
    [
        "Every rival is tuned once per arm, not once per world, with the same optimiser, number of evaluations \
         and seed, from its default gains, inside ranges around them. Where the best gains lie at an end of a range, \
         that end gives way tenfold and the tuning goes on with as many evaluations again; what is still at an end \
         after the last such round is marked beside its value. The cost is the rms error of the worst \
         joint; gains whose torque noise is above the cap are worse than all that keep it, the more the noisier; \
         a run that does not follow, or meets the torque limits in more than 2 % of its samples, is worse than \
         any noise; a run that ends early is worse than all that do not, the more the sooner.",
        "Motions that are trained on are not scored on. Training is in two worlds, friction and payload, so that gains \
         have to bear the arm with and without its load; the other worlds are met for the first time when they are \
         scored.",
        "Every rival gets the same nominal inertia per joint as the unit of its torque gains. Rivals that need \
         a model get the arm's own with lighter links, without payload and without dry friction.",
        "The row with gains by design is not tuned: its gains come from the specification, the study's loop, the range \
         of inertia with and without payload, and the load along the study's own motion. Neither the drawn motions nor \
         the dry friction of the worlds were declared to the design: there its bound, computed for that very run, may \
         be beyond the specification.",
        "The rows from positions are this project's too, and not the paper's law. They are handed no velocity; they \
         know the loop's delay and torque limits, and get the reference's acceleration where their torque will act, \
         which is the study's to foresee; other laws get it at the sample. Their tuning begins at ADRC's default \
         poles. A law per joint has too many scalars for this tuner: that row has the gains of least error that the \
         design of this project reckons for torque steps of the cap on noise, as far as the encoder makes them, from \
         the range of inertia and the load along the study's own motion, without a tube; that clause is for the worst \
         step, and the cap for the mean, so that this row uses about a quarter of the cap. Other laws have one set of \
         gains for all joints: what it gains from a law per joint, they were not offered.",
        "A law with more free scalars gets no more evaluations: a law with many may be better than its row. \
         Where an author's tuning procedure is not a choice of scalars, it is not followed.",
        "Bounds are asked for where the declared load fits the torque limits: none is asked for a drive that \
            saturates.",
        "Bounds: that of this project's law, with a velocity or from positions, and of the disturbance observer which \
         is the first of these, counts encoder, filter, delay and the range of inertia; for a law per joint there is \
         none here. Those of other laws are the formulas of their proofs, which mostly do not: a broken one shows \
         that, and not that the law is the worse one. Where none is computed the authors may have one. A full mark is \
         for a bound that held in every run but those made to saturate, and was nowhere more than ten times the error.",
        "Tuned gains can be worse than the default ones: where these are noisier than the cap, and on motions unlike \
         those that were trained on. Both are in the data.",
        "A law that follows a path and no time table is judged by its distance to the path.",
        "To follow is not to be quiet: a torque that jumps from limit to limit can hold an arm on its path. \
         Chatter and noise show it.",
        "The specification decides what share of draws is easy. Another specification gives other shares.",
        "This project chose the arms, worlds and cost, and knows its own law best.",
    ]
    .map(|note| note.split_whitespace().collect::<Vec<_>>().join(" "))
    .to_vec()
}
