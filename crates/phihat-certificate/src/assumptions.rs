//! Assumptions under which the claims of a certificate hold, by their numbers in the theory.

use serde::Serialize;

use crate::{Certificate, ClassBound};

/// Assumption of a theorem: its number in `docs/theory` and its text for a reader.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Assumption {
    /// Number, as in `docs/theory/assumptions.md` (A) or `docs/theory/class.md` (C).
    pub number: &'static str,
    /// Text, in a line.
    pub text: &'static str,
}

const fn assume(number: &'static str, text: &'static str) -> Assumption {
    Assumption { number, text }
}

const HOLD: Assumption = assume(
    "A4",
    "a torque acts after the stated delay, and is constant over a sample or passes the stated drive",
);
const CLOCK: Assumption =
    assume("A5", "all joints are sampled together, one period apart; no sample is lost or late");
const RIGID: Assumption = assume(
    "A1",
    "links and joints do not bend; joints of a real arm do, and fast gains can shake them",
);

/// Assumptions of the claims about the loop, where nothing bounds an error.
const LOOP: [Assumption; 4] = [
    RIGID,
    HOLD,
    CLOCK,
    assume(
        "A11",
        "no eigenvalue of the normalised inertia lies outside of the range that was searched",
    ),
];

/// Assumptions of a tube.
const TUBE: [Assumption; 9] = [
    RIGID,
    assume(
        "A2",
        "the description's dynamics, with a payload and levels of dry friction that are constant over a run",
    ),
    assume("A3", "dry friction is smooth below 1 mrad/s; no stiction"),
    HOLD,
    CLOCK,
    assume(
        "A6",
        "a reading is the position, rounded to the encoder's quantum; no noise, no ripple",
    ),
    assume("A8", "the run starts at rest in the study's posture, with the study's torque"),
    assume("A9", "sums in double precision, widened by 1 %, are those of real numbers"),
    assume(
        "A10",
        "second derivatives of the dynamics are at most 1.25 times those every 40 ms along the run",
    ),
];

/// Assumptions of the bound for a class of motions.
const CLASS: [Assumption; 8] = [
    assume(
        "C1",
        "links and joints do not bend, as for A1; the payload is a constant of the stated set",
    ),
    assume("C2", "all other forces are at most the stated friction, stiction and cogging"),
    assume(
        "C3",
        "torques act whole samples late and are constant over a sample; measurements are not late",
    ),
    assume(
        "C4",
        "a reading is off by at most half a quantum, the stated bias and the stated largest noise",
    ),
    assume("C5", "references stay in the box and within its speed, acceleration and jerk"),
    assume("C6", "the start is at rest and in balance"),
    assume(
        "C7",
        "no limit of torque or torque rate acts (the bounds on torque and torque step say so)",
    ),
    assume(
        "C8",
        "no maximum over box and payloads is larger than what was searched, derivatives times 1.1",
    ),
];

/// Assumptions of such a bound that a supervisor brings, in place of C6.
const SUPERVISED: [Assumption; 3] = [
    assume(
        "C9",
        "the supervisor's reference box and motion limits are the class's; nothing else changes the law",
    ),
    assume("C10", "the start is at rest in the box, out of balance by at most the stated torque"),
    assume("C11", "every sample comes in time, and no fault is reported"),
];

/// Assumptions of such a bound about signals, where they are imperfect.
const JITTER: Assumption = assume(
    "C12",
    "samples are taken early by at most the stated jitter; a stamp that is counted on says when, exactly",
);
const LOSSES: Assumption = assume(
    "C13",
    "no more commands are lost in a row, and no sooner again, than stated; none while it is armed",
);

impl Certificate {
    /// Assumptions under which the claims hold; of several kinds of bounds, those of the one that is printed.
    pub fn assumptions(&self) -> Vec<Assumption> {
        match (&self.tube, &self.class) {
            (Some(_), _) => TUBE.to_vec(),
            (None, Some(class)) => of_class(class),
            (None, None) => LOOP.to_vec(),
        }
    }
}

fn of_class(class: &ClassBound) -> Vec<Assumption> {
    let (supervised, signals) = (class.is_supervised(), class.signals.as_ref());
    let own = CLASS.into_iter().filter(|one| !supervised || one.number != "C6");
    let started = SUPERVISED.into_iter().filter(|_| supervised);
    let early = signals.filter(|own| own.jitter_s > 0.0).map(|_| JITTER);
    let lost = signals.filter(|own| own.commands_lost > 0).map(|_| LOSSES);
    own.chain(started).chain(early).chain(lost).collect()
}

#[cfg(test)]
mod tests {
    use super::{CLASS, JITTER, LOOP, LOSSES, SUPERVISED, TUBE};

    #[test]
    fn every_assumption_stands_in_the_theory_under_its_number() {
        let theory = concat!(
            include_str!("../../../docs/theory/assumptions.md"),
            include_str!("../../../docs/theory/class.md")
        );
        for one in
            LOOP.iter().chain(&TUBE).chain(&CLASS).chain(&SUPERVISED).chain([&JITTER, &LOSSES])
        {
            let row = [format!("| **{}** ", one.number), format!("| {} |", one.number)];
            assert!(row.iter().any(|row| theory.contains(row)), "{}", one.number);
            assert!(one.text.len() < 115, "{}", one.text);
        }
    }
}
