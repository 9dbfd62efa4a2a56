//! Wrong if a reproduction that says something else passed for the same, or the same one for another.

use phihat_paper::{FORMAT, Kept, Origin, PaperNumber, Reproduction, Section, Statement, Verdict};

fn number(name: &str, value: Option<f64>, tolerance: f64) -> PaperNumber {
    PaperNumber { name: name.into(), unit: "mrad".into(), value, tolerance }
}

fn statement(id: &str) -> Statement {
    Statement {
        id: id.into(),
        place: "(40)".into(),
        origin: Origin::Paper,
        claim: "The error stays in the ball.".into(),
        paper: "2 mrad".into(),
        ours: "3 mrad".into(),
        verdict: Verdict::WithCorrection,
        reading: String::new(),
        varied: String::new(),
        turns: String::new(),
        covers: vec![],
        why: String::new(),
        numbers: vec![number("bound", Some(2.0), 0.01), number("literal", None, 0.01)],
        assumptions: vec![],
        studies: vec![],
    }
}

fn whole() -> Reproduction {
    let section = |id: &str| Section {
        id: id.into(),
        title: id.into(),
        text: vec![],
        statements: vec![statement(&format!("{id}-1")), statement(&format!("{id}-2"))],
        tables: vec![],
        figures: vec![],
    };
    Reproduction {
        format: FORMAT,
        phihat_version: "0.1.0".into(),
        quick: false,
        only: None,
        assumptions: vec![],
        sections: vec![section("a"), section("b")],
    }
}

fn against(change: impl Fn(&mut Reproduction)) -> Vec<String> {
    let kept = Kept::from_json(&serde_json::to_string(&whole()).unwrap()).unwrap();
    let mut fresh = whole();
    change(&mut fresh);
    kept.disagreements(&fresh)
}

fn first(fresh: &mut Reproduction) -> &mut Statement {
    &mut fresh.sections[0].statements[0]
}

#[test]
fn the_same_agrees_up_to_its_tolerance() {
    assert!(against(|_| ()).is_empty());
    assert!(against(|r| first(r).numbers[0].value = Some(2.0 * 1.009)).is_empty());
    assert!(against(|r| first(r).numbers[0].value = Some(2.0 / 1.009)).is_empty());
}

#[test]
fn another_number_or_verdict_is_told() {
    for (value, words) in
        [(Some(2.05), "bound was 2.0, is 2.05"), (None, "is none"), (Some(-2.0), "is -2.0")]
    {
        let lines = against(|r| first(r).numbers[0].value = value);
        assert!(lines.len() == 1 && lines[0].contains(words), "{lines:?}");
    }
    assert_eq!(against(|r| first(r).numbers[1].value = Some(1.0)).len(), 1);
    let lines = against(|r| first(r).verdict = Verdict::AsPrinted);
    assert_eq!(lines, ["a-1: was \"holds with a correction\", is \"holds as printed\""]);
}

#[test]
fn what_is_missing_or_new_is_told_unless_less_was_asked_for() {
    assert_eq!(against(|r| drop(r.sections.pop())).len(), 2);
    assert_eq!(
        against(|r| first(r).id = "c".into()),
        ["a-1: no longer a statement", "c: a new statement"]
    );
    assert_eq!(against(|r| first(r).numbers.truncate(1)), ["a-1: literal is missing"]);
    let part = |r: &mut Reproduction| {
        r.only = Some("a".into());
        r.sections.truncate(1);
    };
    assert!(against(part).is_empty());
    let quick = |r: &mut Reproduction| {
        r.quick = true;
        first(r).numbers.truncate(1);
    };
    assert!(against(quick).is_empty());
}

#[test]
fn what_is_no_reproduction_is_refused() {
    for text in ["", "[]", "{}", "{\"format\": 2}"] {
        assert!(
            Kept::from_json(text).unwrap_err().to_string().contains("no reproduction"),
            "{text}"
        );
    }
    let mut other = whole();
    other.format = FORMAT + 1;
    let text = serde_json::to_string(&other).unwrap();
    assert!(Kept::from_json(&text).unwrap_err().to_string().contains("format 2"));
}
