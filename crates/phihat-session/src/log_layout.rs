//! Layout of a log in a viewer: plots of the signals by which a controller is judged.

use phihat_study::Study;
use serde_json::{Map, Value, json};

/// A layout for Foxglove and Lichtblick, which read the same form: errors, torques, φ with φ̂, positions with
/// their references, and the supervisor's modes, of a log as `phihat run --mcap` writes it.
pub fn log_layout(study: &Study) -> Value {
    let names: Vec<&str> = study.robot.joints.iter().map(|joint| joint.name.as_str()).collect();
    let plots = [
        ("Plot!error", "error e", &[("/phihat/error.position", "e")][..]),
        (
            "Plot!position",
            "position, measured and wanted",
            &[("/joint_states.position", "q"), ("/phihat/reference.position", "q_d")],
        ),
        (
            "Plot!torque",
            "torque, commanded and applied",
            &[("/phihat/torque_command.effort", "command"), ("/joint_states.effort", "applied")],
        ),
        (
            "Plot!phi",
            "unknown torque φ and its estimate φ̂",
            &[("/phihat/phi.effort", "φ"), ("/phihat/phi_hat.effort", "φ̂")],
        ),
    ];
    let mut panels = Map::new();
    for (id, title, signals) in plots {
        panels.insert(id.to_owned(), plot(title, signals, &names));
    }
    let modes = json!({
        "title": "mode",
        "paths": [{ "value": "/phihat/mode.data", "label": "mode", "timestampMethod": "receiveTime" }],
        "isSynced": true,
    });
    panels.insert("StateTransitions!mode".to_owned(), modes);
    let column = |first: Value, second: Value| {
        json!({ "direction": "column", "first": first, "second": second,
        "splitPercentage": 50 })
    };
    let plots = json!({
        "direction": "row",
        "first": column("Plot!error".into(), "Plot!position".into()),
        "second": column("Plot!torque".into(), "Plot!phi".into()),
        "splitPercentage": 50,
    });
    json!({
        "configById": panels,
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": { "speed": 1 },
        "layout": {
            "direction": "column",
            "first": plots,
            "second": "StateTransitions!mode",
            "splitPercentage": 85,
        },
    })
}

fn plot(title: &str, signals: &[(&str, &str)], names: &[&str]) -> Value {
    let path = |(i, name): (usize, &&str), (topic, label): &(&str, &str)| {
        json!({
            "value": format!("{topic}[{i}]"),
            "label": format!("{label} {name}"),
            "enabled": true,
            "timestampMethod": "receiveTime",
        })
    };
    let paths: Vec<Value> = names
        .iter()
        .enumerate()
        .flat_map(|joint| signals.iter().map(move |signal| path(joint, signal)))
        .collect();
    json!({
        "title": title,
        "paths": paths,
        "showLegend": true,
        "legendDisplay": "floating",
        "showXAxisLabels": true,
        "showYAxisLabels": true,
        "isSynced": true,
        "xAxisVal": "timestamp",
    })
}
