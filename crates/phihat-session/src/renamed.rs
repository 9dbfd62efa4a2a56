//! Figures of records of earlier versions, under the names that they have now.

use serde_json::Value;

/// Name in the metrics.json of an earlier version, name now.
const RENAMED: [(&str, &str); 9] = [
    ("error_max_rad", "error_peak_rad"),
    ("error_spec_rad", "error_bound_rad"),
    ("error_tube_rad", "error_bound_rad"),
    ("error_integral_spec_rad_s", "error_integral_bound_rad_s"),
    ("velocity_error_max_rad_s", "velocity_error_peak_rad_s"),
    ("velocity_error_spec_rad_s", "velocity_error_bound_rad_s"),
    ("velocity_error_tube_rad_s", "velocity_error_bound_rad_s"),
    ("error_max_m", "error_peak_m"),
    ("error_spec_m", "error_bound_m"),
];

/// Gives figures of an earlier version the names that they have now, at every depth.
pub(crate) fn rename(figures: &mut Value) {
    match figures {
        Value::Object(map) => {
            for (before, now) in RENAMED {
                if let Some(figure) = map.remove(before) {
                    map.insert(now.to_owned(), figure);
                }
            }
            map.values_mut().for_each(rename);
        }
        Value::Array(all) => all.iter_mut().for_each(rename),
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::rename;
    use serde_json::json;

    #[test]
    fn figures_of_before_get_their_names_of_now_and_others_stay() {
        let mut old = json!({
            "joints": [{ "error_max_rad": 1.0, "error_spec_rad": null, "error_steady_max_rad": 2.0 }],
            "tip": { "error_max_m": 3.0, "error_spec_m": 4.0 },
            "tube": { "joints": [{ "error_max_rad": 5.0, "error_tube_rad": 6.0, "velocity_error_max_rad_s": 7.0 }] },
        });
        let new = json!({
            "joints": [{ "error_peak_rad": 1.0, "error_bound_rad": null, "error_steady_max_rad": 2.0 }],
            "tip": { "error_peak_m": 3.0, "error_bound_m": 4.0 },
            "tube": { "joints": [{ "error_peak_rad": 5.0, "error_bound_rad": 6.0, "velocity_error_peak_rad_s": 7.0 }] },
        });
        rename(&mut old);
        assert_eq!(old, new);
        rename(&mut old);
        assert_eq!(old, new);
    }
}
