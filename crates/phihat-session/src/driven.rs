//! A session whose loop somebody else runs: sample by sample, on whatever is at the other end of a link.

use std::path::Path;

use phihat_design::Gains;
use phihat_report::RecordedBound;
use phihat_sim::{ControlSide, Ended, Trace, WorldSide};
use phihat_study::Study;
use serde_json::{Map, Value};

use crate::disk::Lock;
use crate::error::SessionError;
use crate::observer::RunObserver;
use crate::record::Done;
use crate::session::{Session, finished, form, run_info};
use crate::unfinished::DriveJournal;
use crate::watch::Watch;

/// Destination of a record.
#[derive(Debug, Clone, Copy)]
pub struct Leave<'a> {
    /// Its folder.
    pub folder: &'a Path,
    /// Its page, if it is to have one.
    pub page: Option<&'a Path>,
}

/// End of a loop that an external driver ran.
#[derive(Debug)]
pub struct DrivenSession {
    /// Divergence or stop.
    pub ended: Ended,
    /// Lines of the page about what drove it: label, and value with its unit.
    pub facts: Vec<(String, String)>,
    /// Warnings on the validity of the figures.
    pub warnings: Vec<String>,
    /// `drive.json` of the record.
    pub document: Value,
    /// Bound on the error as it was checked before.
    pub bound: Option<RecordedBound>,
}

/// Takes the next samples of a record.
pub type Take<'a> = dyn FnMut(&Trace) -> Result<(), SessionError> + 'a;

impl Session {
    /// The study.
    pub fn study(&self) -> &Study {
        &self.study
    }

    /// The gains chosen.
    pub fn gains(&self) -> &Gains {
        &self.gains
    }

    /// Hands both sides of the loop to `drive`, which runs it and hands back the record block by block;
    /// leaves record and page as [`simulate`](Self::simulate) does. `command` says in the record what drove
    /// it, `begun` holds the entries of its `drive.json` that are known before: if the process is killed,
    /// [`recover`](crate::recover) makes a record of these and of the blocks that were handed back.
    ///
    /// # Errors
    ///
    /// Error of `drive`; another process is at work in the folder, or a file cannot be written.
    pub fn driven<E: From<SessionError>>(
        self,
        leave: Leave<'_>,
        (command, begun): (String, Map<String, Value>),
        watch: &mut dyn Watch,
        drive: impl FnOnce(
            (ControlSide, WorldSide),
            &mut dyn Watch,
            &mut Take<'_>,
        ) -> Result<DrivenSession, E>,
    ) -> Result<Done, E> {
        let _held = Lock::take(leave.folder).map_err(SessionError::from)?;
        self.warn(watch);
        let mut files = self.files(leave.folder)?;
        let told = (command.clone(), self.warnings.clone());
        let run = run_info(&self.study, form(&self.study), told, None);
        let own = (&*self.study, &self.gains);
        let mut journal = DriveJournal::begin(leave.folder, own, run, (self.trace, begun))?;
        watch.begun(&files.prepared);
        let Self { study, gains, simulation, mut warnings, .. } = self;
        let mut seen = RunObserver::new(&study, Some(&gains));
        let driven = drive(simulation.apart(), watch, &mut |block: &Trace| {
            journal.keep(block)?;
            seen.block(block);
            Ok(files.block(block)?)
        });
        watch.ended();
        let driven = match driven {
            Ok(driven) => driven,
            Err(why) => {
                journal.abandon().iter().for_each(|line| watch.warn(line));
                return Err(why);
            }
        };
        let figures = seen.finish(&study.sha256);
        warnings.extend(driven.warnings);
        let mut done = finished((study, gains), figures, driven.ended, (command, warnings));
        done.run.world.extend(driven.facts);
        done.run.bound = driven.bound;
        if let Err(why) = done.leave(files, leave.folder, leave.page, Some(&driven.document)) {
            journal.abandon().iter().for_each(|line| watch.warn(line));
            return Err(why.into());
        }
        if let Err(why) = journal.remove() {
            // The record is whole all the same.
            watch.warn(&why.to_string());
        }
        Ok(done)
    }
}
