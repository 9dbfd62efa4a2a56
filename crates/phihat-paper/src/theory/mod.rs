//! The paper's theorems, each as a numerical check, and its errata by computation.

mod alpha;
mod background;
mod ball;
mod bounds;
mod convergence;
mod entrywise;
mod gain;
mod game;
mod in_words;
mod iss;
mod limits;
mod only_state;
mod optimal;
mod printed;
mod recipe;
mod remark_9;
mod rows;
mod step_one;
mod stray;
mod table;
mod theorem_5;
mod unmeasured;

use crate::part::{Extent, PaperPart, PartError};
use crate::record::Assumption;

/// Sec. II, Lemma 1, Theorems 1 to 5, (11), Remark 9, Sec. V.
pub(super) fn theory(extent: Extent, progress: &dyn Fn(f64)) -> Result<PaperPart, PartError> {
    let draws = if extent.quick { 200 } else { 2000 };
    let mut sections =
        vec![background::section_2(), convergence::lemma_1(), convergence::theorem_1()];
    progress(0.1);
    sections.push(optimal::theorem_2(draws)?);
    progress(0.3);
    sections.push(remark_9::remark_9()?);
    sections.push(gain::l2_gain()?);
    progress(0.5);
    sections.push(iss::theorem_3(draws)?);
    progress(0.6);
    sections.push(game::theorem_4()?);
    progress(0.8);
    sections.push(theorem_5::theorem_5()?);
    progress(0.95);
    sections.push(recipe::recipe()?);
    sections.push(in_words::in_words()?);
    sections.push(unmeasured::unmeasured());
    sections.push(table::errata(stray::stray()?));
    progress(1.0);
    Ok(PaperPart { assumptions: assumptions(), sections })
}

fn assumptions() -> Vec<Assumption> {
    vec![Assumption {
        id: "phi-max".to_owned(),
        missing: "φ_max is not printed.".to_owned(),
        assumed: "22.2, the only value from which K_p = 200 and K_d = 32.3 of Table 2 (A), m = 1, follow."
            .to_owned(),
        influence: "Every bound is proportional to it. That (40) is vacuous at the printed gains does not depend on \
                    it: bound and worst case grow together."
            .to_owned(),
    }]
}
