//! For this to be wrong, three laws would have to fall apart on seven joints in the way that their structure says they must,
//! by accident.
#![allow(clippy::unwrap_used, reason = "tests: a panic is the report")]

use std::collections::BTreeSet;

use phihat_paper::{Extent, Origin, Verdict, reproduce_only, studies};

#[test]
fn table_3_on_two_arms() {
    let extent = Extent { quick: true };
    let all = reproduce_only(Some("table 3"), extent, 1, &|_, _| ()).unwrap();
    let section = &all.sections[0];
    let named: BTreeSet<_> = studies().iter().map(|(path, _)| *path).collect();
    for statement in &section.statements {
        assert!(statement.studies.iter().all(|path| named.contains(path.as_str())));
        assert!(statement.numbers.iter().all(|number| number.value.is_some()), "{statement:?}");
    }
    let statement = |id: &str| section.statements.iter().find(|s| s.id == id).unwrap();
    assert_eq!(statement("erratum-table3-unit").verdict, Verdict::WithCorrection);
    // The lowest ratio of the page is the one that its verdict rests on.
    let pd = statement("table3-pd");
    let least = pd.numbers.iter().filter_map(|n| n.value).fold(f64::INFINITY, f64::min);
    assert_eq!(pd.verdict == Verdict::AsPrinted, least > 1.0);
    for arm in ["panda", "iiwa14"] {
        let table = section.tables.iter().find(|t| t.id == format!("table-3-{arm}")).unwrap();
        assert_eq!(table.rows.len(), 7);
        for row in &table.rows {
            let cell = |k: usize| row[k].parse::<f64>().unwrap();
            // PD under load is the worst of the three, whatever its gains: it has no integral action.
            assert!(cell(7) > cell(8) && cell(7) > cell(9), "{arm}: {row:?}");
        }
        let figure = section.figures.iter().find(|f| f.id == format!("fig-14-{arm}")).unwrap();
        assert_eq!(figure.panels.len(), 7);
    }
    for arm in ["panda", "iiwa14"] {
        let table = section.tables.iter().find(|t| t.id == format!("table-3-{arm}")).unwrap();
        let column = |k: usize| -> Vec<f64> {
            table.rows.iter().map(|row| row[k].parse::<f64>().unwrap()).collect()
        };
        let value = |id: &str, name: &str| {
            let number = statement(id).numbers.iter().find(|n| n.name == format!("{name}, {arm}"));
            (number.unwrap().value.unwrap(), number.unwrap().tolerance)
        };
        // Counted again from the table's own cells; another count must not pass for the same.
        let wins = column(8).iter().zip(column(9)).filter(|(pid, ours)| **pid > *ours).count();
        let (told, tolerance) = value("table3-fair", "joints on which the proposed law is better");
        assert_eq!((told, tolerance), (wins as f64, 0.0), "{arm}");
        assert!(statement("table3-fair").ours.contains(&format!("{arm} on {wins} of 7 joints")));
        let pairs = column(3).into_iter().zip(column(6));
        let most = pairs.map(|(paper, ours)| (paper / ours).sqrt()).fold(0.0, f64::max);
        let told = value("table3-size", "largest rms of proposed, the paper's over ours").0;
        assert!((told / most - 1.0).abs() < 0.01, "{arm}: {told} {most}");
        // A weaker comparator is a worse one: its gains decide what is said of it.
        let at_defaults = value("table3-comparator", "least comparator : proposed").0;
        let weak = value("table3-comparator", "least weak comparator : proposed").0;
        assert!(weak > 2.0 * at_defaults, "{arm}: {weak} {at_defaults}");
        assert!(value("eq40-seven-joints", "(40)").0 > 0.0);
    }
    // The paper compares no laws that are tuned alike.
    let ours: Vec<_> = section.statements.iter().filter(|s| s.origin == Origin::Ours).collect();
    assert_eq!(ours.iter().map(|s| s.id.as_str()).collect::<Vec<_>>(), ["table3-fair"]);
    // Copied from the paper's table: 3.5 mrad rms on joint 1.
    assert_eq!(section.tables[0].rows[0][3], "0.123");
}
