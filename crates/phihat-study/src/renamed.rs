//! Keys of earlier versions: read under the names that they have now, and rewritten so.

use std::fmt;
use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use crate::error::{StudyError, StudyErrorKind as Kind};
use crate::source::Source;

/// Section, name in an earlier version, name now.
const RENAMED: [(&str, &str, &str); 4] = [
    ("spec", "error_max_rad", "error_bound_rad"),
    ("spec", "error_integral_max_rad_s", "error_integral_bound_rad_s"),
    ("spec", "velocity_error_max_rad_s", "velocity_error_bound_rad_s"),
    ("spec", "tip_error_max_mm", "tip_error_bound_mm"),
];

/// A key of a study that has the name of an earlier version.
///
/// `Display` gives one line: file, line, key, name now.
///
/// # Example
///
/// ```
/// # let text = "duration_s = 2.0\n[robot]\nname = \"planar3r\"\n[gains]\nbandwidth_rad_s = 20.0\n\
/// #     estimator_bandwidth_rad_s = 70.0\ninertia_kg_m2 = 0.3\n[reference]\nkind = \"hold\"\npose = \"ready\"\n\
/// #     [spec]\nerror_max_rad = 2e-3 # old name\n";
/// let study = phihat_study::Study::from_text(text, "demo.toml", "".as_ref())?;
/// assert_eq!(study.spec.error_bound, Some(vec![2e-3; 3]));
/// assert_eq!(study.renamed[0].now(), "spec.error_bound_rad");
/// assert!(study.rewritten().is_some_and(|text| text.ends_with("\nerror_bound_rad = 2e-3 # old name\n")));
/// # Ok::<(), phihat_study::StudyError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct RenamedKey {
    file: String,
    line: usize,
    pub(crate) section: &'static str,
    pub(crate) before: &'static str,
    pub(crate) now: &'static str,
    pub(crate) span: Range<usize>,
}

impl RenamedKey {
    /// Line of the file, from 1.
    pub fn line(&self) -> usize {
        self.line
    }

    /// Dotted path as the file has it.
    pub fn before(&self) -> String {
        format!("{}.{}", self.section, self.before)
    }

    /// Dotted path under the name of now.
    pub fn now(&self) -> String {
        format!("{}.{}", self.section, self.now)
    }
}

impl fmt::Display for RenamedKey {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}:{}: {} is called {} now; `phihat check --rewrite` renames it in the file",
            self.file,
            self.line,
            self.before(),
            self.now()
        )
    }
}

/// Gives keys of earlier versions the names that they have now; returns them in the order of the file.
pub(crate) fn rename(
    source: &Source<'_>,
    top: &mut DeTable<'_>,
) -> Result<Vec<RenamedKey>, StudyError> {
    let mut all = Vec::new();
    for (section, before, now) in RENAMED {
        let Some(DeValue::Table(table)) = top.get_mut(section).map(Spanned::get_mut) else {
            continue;
        };
        let Some((key, value)) = table.remove_entry(before) else { continue };
        let span = key.span();
        if table.contains_key(now) {
            let message = format!("both `{before}` and `{now}` are given");
            let path = format!("{section}.{before}");
            let error = source.error(Kind::Conflict, &span, path, message);
            let help = format!("`{before}` is the earlier name of `{now}`: keep `{now}`");
            source.found.note(error.with_help(help))?;
            continue;
        }
        table.insert(Spanned::new(span.clone(), now.into()), value);
        let place = source.place(&span);
        all.push(RenamedKey { file: place.file, line: place.line, section, before, now, span });
    }
    all.sort_by_key(|key| key.span.start);
    Ok(all)
}
