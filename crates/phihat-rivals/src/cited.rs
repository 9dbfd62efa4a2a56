//! Works that the paper cites as control of arms, and that have no row.

use serde::Serialize;

/// A cited work without a row, and why it has none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Cited {
    /// The paper's reference number: `[19]`.
    pub reference: &'static str,
    /// Authors and year of the source.
    pub source: &'static str,
    /// Subject of the work, as far as it is public.
    pub subject: &'static str,
    /// Reason why it has no row, and the rows that are nearest.
    pub reason: &'static str,
}

/// Works that the paper under reproduction (Hayat, Leibold, Buss, 2018) cites among its control methods and leaves out
/// of its Table 1, and that are no rows here either, in the paper's order. `[21]` of the same list is a row.
pub const WITHOUT_ROW: &[Cited] = &[
    Cited {
        reference: "[3]",
        source: "Chien, Huang, Robotica 30(1), 2012",
        subject: "adaptive impedance control without a regressor of arms with flexible joints and electric motors",
        reason: "no torque law of a rigid arm: its input is that of the motors, its task a contact. Of the same \
            authors' family for rigid arms and torques are fat and fat-lumped (Huang, Chien, Adaptive Control of \
            Robot Manipulators, 2010, treats all of these cases)",
    },
    Cited {
        reference: "[16]",
        source: "Yu, Fei, Sun, Huang, Yang, J. Intell. Robot. Syst. 77(3-4), 2015",
        subject: "robust adaptive neural switching control of arms with uncertainty and disturbances",
        reason: "by its title a law that could be a row, but no public copy of its equations was found. Nearest: \
            switching (two of the same authors), fuzzy, taylor-network",
    },
    Cited {
        reference: "[17]",
        source: "Yu, Fei, Trans. Inst. Meas. Control 36(6), 2014",
        subject: "neural switching control of arms, stable by an average dwell time",
        reason: "by its title a law that could be a row, but no public copy of its equations was found; its claim is \
            about switching, and the arms here have one mode. Nearest: switching, fuzzy",
    },
    Cited {
        reference: "[18]",
        source: "Xiao, Yin, Kaynak, Gao, IEEE AMC 2016",
        subject: "observer-based control of arms with uncertain kinematics and dynamics",
        reason: "no public copy of its equations was found, not even whether its output is a torque. Nearest: \
            task-space, momentum-observer",
    },
    Cited {
        reference: "[19]",
        source: "Qin, Léonard, Abba, IEEE T-CST 24(6), 2016",
        subject: "correction of the path of an industrial robot in friction stir welding by state estimators",
        reason: "no torque law: it corrects the reference of the robot's position loop, by an observer of \
            flexible joints (the authors' open papers: hdl.handle.net/10985/8178 and hdl.handle.net/10985/8755)",
    },
];

#[cfg(test)]
mod tests {
    use super::WITHOUT_ROW;
    use crate::rivals::RIVALS;

    /// A work is a row or has a reason, not both; the rows that a reason names exist.
    #[test]
    fn a_cited_work_is_a_row_or_has_a_reason() {
        for cited in WITHOUT_ROW {
            assert!(RIVALS.iter().all(|r| r.card.reference != cited.reference), "{cited:?}");
            let nearest = cited.reason.split_once("Nearest: ").map_or("", |(_, rows)| rows);
            let names = nearest.split(", ").filter_map(|name| name.split_whitespace().next());
            for name in names {
                assert!(RIVALS.iter().any(|r| r.card.id == name), "{name} of {cited:?}");
            }
        }
        let cited = |reference: &str| WITHOUT_ROW.iter().any(|cited| cited.reference == reference);
        let row = |reference: &str| RIVALS.iter().any(|r| r.card.reference == reference);
        for number in
            [2, 3, 4, 5, 12, 13, 15, 16, 17, 18, 19, 20, 21, 22, 23, 25, 26, 27, 28, 29, 30]
        {
            let reference = format!("[{number}]");
            assert!(cited(&reference) || row(&reference), "{reference}");
        }
    }
}
