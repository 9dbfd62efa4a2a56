//! A value per joint means the same in each of its three forms, and names decide, never order.
//!
//! Wrong if a table by name puts a value on another joint than the one it names.

use crate::support::{read, with_line};

fn inertia(text: &str) -> Vec<f64> {
    read(&with_line(16, &format!("inertia_kg_m2 = {text}"))).unwrap().gains.unwrap().inertia
}

#[test]
fn the_three_forms_agree() {
    assert_eq!(inertia("0.5"), inertia("[0.5, 0.5, 0.5]"));
    assert_eq!(inertia("0.5"), inertia("{ joint1 = 0.5, joint2 = 0.5, joint3 = 0.5 }"));
    assert_eq!(inertia("[1, 2, 3]"), inertia("{ joint1 = 1.0, joint2 = 2.0, joint3 = 3.0 }"));
    assert_eq!(inertia("[1, 2, 3]"), [1.0, 2.0, 3.0]);
}

#[test]
fn all_permutations_of_a_table_by_name_map_right() {
    let entry = |j: usize| format!("joint{} = {}.5", j + 1, j + 1);
    for (a, b, c) in [(0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0)] {
        let table = format!("{{ {}, {}, {} }}", entry(a), entry(b), entry(c));
        assert_eq!(inertia(&table), [1.5, 2.5, 3.5], "{table}");
    }
}

/// All orders of `rest`, each behind `head`.
fn orders(head: &mut Vec<usize>, rest: &[usize], visit: &mut impl FnMut(&[usize])) {
    if rest.is_empty() {
        visit(head);
    }
    for (i, &j) in rest.iter().enumerate() {
        let others: Vec<usize> = [&rest[..i], &rest[i + 1..]].concat();
        head.push(j);
        orders(head, &others, visit);
        head.pop();
    }
}

#[test]
fn all_5040_orders_of_seven_joints_map_right() {
    // 11 shares no factor with 7!: no joint stands in one place in all that are tried.
    let every = if std::env::var_os("PHIHAT_ALL").is_some() { 1 } else { 11 };
    let mut count = 0;
    orders(&mut Vec::new(), &[1, 2, 3, 4, 5, 6, 7], &mut |order| {
        count += 1;
        if count % every != 0 {
            return;
        }
        let entries: Vec<String> =
            order.iter().map(|j| format!("panda_joint{j} = {j}.25")).collect();
        let text = format!(
            "duration_s = 2.0\n[robot]\nname = 'panda'\n[gains]\nbandwidth_rad_s = 10\n\
             estimator_bandwidth_rad_s = 30\ninertia_kg_m2 = {{ {} }}\n[reference]\nkind = 'hold'\n\
             pose = 'ready'\n",
            entries.join(", ")
        );
        let expected = [1.25, 2.25, 3.25, 4.25, 5.25, 6.25, 7.25];
        assert_eq!(read(&text).unwrap().gains.unwrap().inertia, expected, "{entries:?}");
    });
    assert_eq!(count, 5040);
}
