//! Claims that pass, and edits of them that have to be refused.
#![allow(dead_code, reason = "each test file uses its part")]

use phihat_certificate::Refutation;

/// An edit of a claim, with its name.
pub(crate) type Edit<C> = (&'static str, fn(&mut C));

/// Edits that passed and should not have, and honest claims that were refused.
#[derive(Default)]
pub(crate) struct Passed {
    pub(crate) tried: u32,
    list: Vec<String>,
}

impl Passed {
    /// The claim itself has to pass, and every edit of it to be refused.
    pub(crate) fn edits<C: Clone>(
        &mut self,
        about: &str,
        claim: &C,
        verify: impl Fn(&C) -> Result<(), Refutation>,
        list: &[Edit<C>],
    ) {
        self.holds(about, verify(claim));
        for (what, edit) in list {
            let mut other = claim.clone();
            edit(&mut other);
            self.refused(&format!("{what}: {about}"), &verify(&other));
        }
    }

    pub(crate) fn holds(&mut self, about: &str, checked: Result<(), Refutation>) {
        self.tried += 1;
        if let Err(why) = checked {
            self.list.push(format!("refused though honest: {why} {about}"));
        }
    }

    pub(crate) fn refused(&mut self, about: &str, checked: &Result<(), Refutation>) {
        self.tried += 1;
        if checked.is_ok() {
            self.list.push(format!("passes: {about}"));
        }
    }

    pub(crate) fn none(self, at_least: u32) {
        println!("{} checks", self.tried);
        assert!(self.list.is_empty(), "{} {:#?}", self.list.len(), self.list);
        assert!(self.tried >= at_least, "{}", self.tried);
    }
}
