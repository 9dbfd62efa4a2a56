//! The mode machine against a table of rules, written down again in another form. Wrong if any sequence of
//! requests and faults reaches a mode, an action or a refusal that the rules do not say.

use std::collections::{BTreeMap, BTreeSet};

use phihat::{Action, Mode, ModeEvents, ModeRequest, Refusal, next_mode};

/// One rule: mode, request, what must hold, and what follows. The first that fits counts.
type Rule = (&'static str, &'static str, fn(&ModeEvents) -> bool, &'static str);

const ACTIVE: [&str; 3] = ["Armed", "Holding", "Tracking"];

/// A stop is above the table: fault or request, from every active mode.
const RULES: [Rule; 30] = [
    ("Idle", "Idle", |_| true, "Idle None -"),
    ("Idle", "Stop", |_| true, "Idle None -"),
    ("Idle", "Hold", |_| true, "Idle None NotArmed"),
    ("Idle", "Track", |_| true, "Idle None NotArmed"),
    ("Idle", "Arm", |e| e.fault, "Idle None Fault"),
    ("Idle", "Arm", |e| !e.fresh, "Idle None NotFresh"),
    ("Idle", "Arm", |e| !e.at_rest, "Idle None NotAtRest"),
    ("Idle", "Arm", |_| true, "Armed Capture -"),
    ("Armed", "Idle", |_| true, "Idle Release -"),
    ("Armed", "Arm", |_| true, "Armed None -"),
    ("Armed", "Track", |_| true, "Armed None NotHolding"),
    ("Armed", "Hold", |e| !e.fresh, "Armed None NotFresh"),
    ("Armed", "Hold", |e| e.outside_box, "Armed None OutsideBox"),
    ("Armed", "Hold", |_| true, "Holding Engage -"),
    ("Holding", "Idle", |_| true, "Holding None NotStopped"),
    ("Holding", "Arm", |_| true, "Holding None AlreadyActive"),
    ("Holding", "Hold", |_| true, "Holding None -"),
    ("Holding", "Track", |e| !e.fresh, "Holding None NotFresh"),
    ("Holding", "Track", |e| !e.start_matches, "Holding None StartMismatch"),
    ("Holding", "Track", |_| true, "Tracking Follow -"),
    ("Tracking", "Idle", |_| true, "Tracking None NotStopped"),
    ("Tracking", "Arm", |_| true, "Tracking None AlreadyActive"),
    ("Tracking", "Hold", |_| true, "Holding Settle -"),
    ("Tracking", "Track", |_| true, "Tracking None -"),
    ("SafeStop", "Idle", |_| true, "Idle Release -"),
    ("SafeStop", "Stop", |_| true, "SafeStop None -"),
    ("SafeStop", "Arm", |e| !e.request_is_new, "SafeStop None NotNew"),
    ("SafeStop", "Arm", |e| !e.fault && e.fresh && e.at_rest, "Armed Capture -"),
    ("SafeStop", "Arm", |e| e.fault, "SafeStop None Fault"),
    ("SafeStop", "Arm", |e| !e.fresh, "SafeStop None NotFresh"),
];

fn oracle(mode: Mode, e: ModeEvents) -> String {
    let (mode, request) = (format!("{mode:?}"), format!("{:?}", e.request));
    if ACTIVE.contains(&mode.as_str()) && (e.fault || request == "Stop") {
        return "SafeStop Stop -".to_owned();
    }
    let rule = RULES.iter().find(|r| r.0 == mode && r.1 == request && r.2(&e));
    match (rule, mode.as_str(), request.as_str()) {
        (Some(rule), _, _) => rule.3.to_owned(),
        (None, "SafeStop", "Arm") => "SafeStop None NotAtRest".to_owned(),
        (None, "SafeStop", "Hold" | "Track") => "SafeStop None Latched".to_owned(),
        _ => unreachable!("no rule for {mode} {request}"),
    }
}

fn answer(mode: Mode, e: ModeEvents) -> (Mode, String) {
    let t = next_mode(mode, e);
    let refusal = t.refusal.map_or("-".to_owned(), |r: Refusal| format!("{r:?}"));
    (t.mode, format!("{:?} {:?} {refusal}", t.mode, t.action))
}

const MODES: [Mode; 5] = [Mode::Idle, Mode::Armed, Mode::Holding, Mode::Tracking, Mode::SafeStop];
const REQUESTS: [ModeRequest; 5] =
    [ModeRequest::Idle, ModeRequest::Arm, ModeRequest::Hold, ModeRequest::Track, ModeRequest::Stop];

fn events(request: ModeRequest, bits: u64) -> ModeEvents {
    ModeEvents {
        request,
        request_is_new: bits & 1 != 0,
        fault: bits & 2 != 0,
        fresh: bits & 4 != 0,
        at_rest: bits & 8 != 0,
        start_matches: bits & 16 != 0,
        outside_box: bits & 32 != 0,
    }
}

#[test]
fn every_mode_request_and_fact_follows_the_rules() {
    let mut cases = 0;
    for mode in MODES {
        for request in REQUESTS {
            for bits in 0..64 {
                let e = events(request, bits);
                let (_, is) = answer(mode, e);
                assert_eq!(is, oracle(mode, e), "{mode:?} {e:?}");
                cases += 1;
            }
        }
    }
    assert_eq!(cases, 1600);
}

#[test]
fn f20_a_million_random_events_cover_every_transition_and_refusal() {
    let mut seed = 7_u64;
    let mut mode = Mode::Idle;
    let mut seen: BTreeMap<String, u32> = BTreeMap::new();
    for _ in 0..1_000_000 {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let draw = seed >> 33;
        // Facts are true most of the time, faults rare, so that deep modes are reached.
        let outside = (draw >> 18) & (draw >> 24) & 0b10_0000;
        let mut bits = (draw >> 8) & 0b1_1111 | ((draw >> 13) & 0b1_1100) | outside;
        if (draw >> 18) & 7 != 0 {
            bits &= !2;
        }
        let e = events(REQUESTS[(draw % 5) as usize], bits);
        let before = mode;
        let (after, is) = answer(mode, e);
        assert_eq!(is, oracle(mode, e), "{mode:?} {e:?}");
        if before == Mode::SafeStop && after == Mode::Armed {
            assert!(e.request == ModeRequest::Arm && e.request_is_new && !e.fault);
        }
        *seen.entry(format!("{before:?} -> {is}")).or_default() += 1;
        mode = after;
    }
    for line in &seen {
        println!("{} {}", line.0, line.1);
    }
    let mut all = BTreeSet::new();
    for (mode, request) in MODES.iter().flat_map(|m| REQUESTS.map(|r| (*m, r))) {
        all.extend((0..64).map(|bits| {
            let e = events(request, bits);
            format!("{mode:?} -> {}", oracle(mode, e))
        }));
    }
    assert_eq!(seen.keys().cloned().collect::<BTreeSet<_>>(), all, "not everything was reached");
    let never = |from: Mode, action: Action| {
        let start = format!("{from:?} -> ");
        !seen.keys().any(|k| k.starts_with(&start) && k.contains(&format!("{action:?}")))
    };
    assert!(never(Mode::SafeStop, Action::Engage) && never(Mode::Idle, Action::Follow));
}

#[test]
fn names_in_files_are_what_they_were() {
    let modes = Mode::ALL.map(Mode::name);
    assert_eq!(modes, ["idle", "armed", "holding", "tracking", "safe-stop"]);
    let faults = phihat::Fault::ALL.map(phihat::Fault::name);
    let own = [
        "link-lost",
        "link-quality",
        "bad-sample",
        "bad-reference",
        "frozen-sensor",
        "joint-limit",
        "tracking-error",
        "error-bound",
        "overspeed",
        "oscillation",
        "actuation",
        "saturation",
        "clock",
        "not-finite",
    ];
    assert_eq!(faults, own);
    let refusals = [
        (Refusal::NotArmed, "not-armed"),
        (Refusal::NotHolding, "not-holding"),
        (Refusal::NotStopped, "not-stopped"),
        (Refusal::AlreadyActive, "already-active"),
        (Refusal::Latched, "latched"),
        (Refusal::NotNew, "not-new"),
        (Refusal::Fault, "fault"),
        (Refusal::NotFresh, "not-fresh"),
        (Refusal::NotAtRest, "not-at-rest"),
        (Refusal::StartMismatch, "start-mismatch"),
        (Refusal::OutsideBox, "outside-box"),
    ];
    assert!(refusals.iter().all(|(refusal, name)| refusal.name() == *name));
}
