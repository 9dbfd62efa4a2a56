//! A study's text and table with keys of earlier versions under the names that they have now.

use toml::{Table, Value};

use crate::study::{ReferenceRequest, Study};

impl Study {
    /// The study's text with keys of earlier versions under the names that they have now; all else, comments and
    /// order included, is as it was. `None` where such a key stands at several places, as `key.joint1`, `key.joint2`.
    pub fn rewritten(&self) -> Option<String> {
        let mut text = self.text.clone();
        for key in self.renamed.iter().rev() {
            text.replace_range(key.span.clone(), key.now);
        }
        (text.parse::<Table>().ok()? == self.table().ok()?).then_some(text)
    }

    /// Warnings before a run, one line each: of the robot's description, of keys of earlier versions, of columns of a
    /// reference that are no joint's.
    pub fn warnings(&self) -> Vec<String> {
        let renamed = self.renamed.iter().map(ToString::to_string);
        self.robot.warnings.iter().cloned().chain(renamed).chain(self.unread_columns()).collect()
    }

    /// A line for each column of a reference's file that is of no joint of the arm.
    pub fn unread_columns(&self) -> impl Iterator<Item = String> {
        let unread = match &self.reference {
            ReferenceRequest::Samples { unread, .. }
            | ReferenceRequest::Setpoints { unread, .. } => &unread[..],
            _ => &[],
        };
        unread.iter().map(|column| {
            format!("reference.file: column `{column}` is of no joint of this arm, and is not read")
        })
    }

    /// The study's keys as a table, those of earlier versions under the names that they have now.
    ///
    /// # Errors
    ///
    /// None for the text of a study that was read.
    pub fn table(&self) -> Result<Table, toml::de::Error> {
        let mut table: Table = self.text.parse()?;
        for key in &self.renamed {
            if let Some(Value::Table(section)) = table.get_mut(key.section)
                && let Some(value) = section.remove(key.before)
            {
                section.insert(key.now.to_owned(), value);
            }
        }
        Ok(table)
    }
}
