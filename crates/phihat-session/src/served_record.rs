//! The record of a served motion, written while the motion runs, on a thread of its own.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::{self, JoinHandle};

use phihat_fci::{Ending, Packets, Reflex};
use phihat_sim::{Abort, BLOCK, Stepped, StopReason, Trace};
use phihat_study::Study;

use crate::disk::Lock;
use crate::error::SessionError;
use crate::layout::TraceKind;
use crate::observer::RunObserver;
use crate::outside::OutsideRun;
use crate::record::{Done, TraceFiles};

/// A motion of a client's.
#[derive(Debug)]
pub struct ServedMotion {
    /// End of the motion.
    pub ending: Ending,
    /// Cycles that the world went on.
    pub cycles: u64,
    /// Packet counts since serving began.
    pub packets: Packets,
    /// The record, and its page.
    pub record: Option<(Box<Done>, PathBuf)>,
}

/// Blocks on their way to the disk, at most: 12 s at 1 kHz.
const ROOMS: usize = 3;

/// Destination of the records, one in place of the other.
#[derive(Debug)]
pub(crate) struct RecordPlace {
    /// The study that is served.
    pub(crate) study: Box<Study>,
    /// Their folder.
    pub(crate) folder: PathBuf,
    /// Kind of file of the trace.
    pub(crate) kind: TraceKind,
}

/// Input of the writer thread.
enum WriterInput {
    /// The next samples of a motion.
    Block(Trace),
    /// A motion has ended; its last samples, if it had any.
    Ended(ServedMotion, Option<Box<OutsideRun>>),
}

/// Report of the writer thread.
#[derive(Debug)]
pub(crate) enum WriterReport {
    /// These files are being written.
    Begun(Vec<PathBuf>),
    /// The record of a motion is on the disk.
    Motion(ServedMotion),
    /// It is not, and no other one will be.
    Failed(SessionError),
}

/// The end of the way to the disk that the serving loop has.
#[derive(Debug)]
pub(crate) struct ServedRecorder {
    parts: Sender<WriterInput>,
    rooms: Receiver<Trace>,
    written: Receiver<WriterReport>,
    thread: Option<JoinHandle<()>>,
    /// True if the loop may wait for the disk.
    waits: bool,
}

impl ServedRecorder {
    /// Makes a recorder that waits for a slow disk, if `waits`; else samples stay with the run until there is
    /// room, so that a real-time loop never waits.
    pub(crate) fn new(place: RecordPlace, waits: bool) -> Self {
        let (parts, taken) = channel();
        let (back, rooms) = channel();
        let (tell, written) = channel();
        let (names, period_ns) = (place.study.robot.joint_names(), place.study.control.period_ns);
        for _ in 0..ROOMS {
            // Both ends are here.
            let _ = back.send(Trace::new(&names, period_ns, BLOCK as u64));
        }
        let thread = thread::spawn(move || {
            if let Err(why) = place.write(&taken, &back, &tell) {
                let _ = tell.send(WriterReport::Failed(why));
            }
        });
        Self { parts, rooms, written, thread: Some(thread), waits }
    }

    /// Takes what a run recorded, once it is a block.
    pub(crate) fn take(&self, run: &mut Stepped) {
        if run.trace().len() < BLOCK {
            return;
        }
        let room = if self.waits { self.rooms.recv().ok() } else { self.rooms.try_recv().ok() };
        if let Some(room) = room {
            // Where nobody takes it, `told` says why.
            let _ = self.parts.send(WriterInput::Block(run.hand_over(room)));
        }
    }

    /// A motion has ended; `run`: as far as it came.
    pub(crate) fn ended(&self, motion: ServedMotion, run: Option<OutsideRun>) {
        let _ = self.parts.send(WriterInput::Ended(motion, run.map(Box::new)));
    }

    /// Report since the last call; with `wait`, the next report.
    pub(crate) fn told(&mut self, wait: bool) -> Option<WriterReport> {
        let told = if wait { self.written.recv().ok() } else { self.written.try_recv().ok() };
        if told.is_none()
            && let Some(thread) = self.thread.take_if(|thread| wait || thread.is_finished())
            && let Err(panic) = thread.join()
        {
            std::panic::resume_unwind(panic);
        }
        told
    }
}

/// A record on its way.
struct Writing {
    files: TraceFiles,
    seen: RunObserver<'static>,
    _held: Lock,
}

impl RecordPlace {
    /// Writes what comes until nobody is there to send any.
    fn write(
        &self,
        parts: &Receiver<WriterInput>,
        rooms: &Sender<Trace>,
        tell: &Sender<WriterReport>,
    ) -> Result<(), SessionError> {
        let mut writing = None;
        for part in parts {
            match part {
                WriterInput::Block(block) => {
                    let now = self.begun(&mut writing, tell)?;
                    now.block(&block)?;
                    // Whoever served may have gone.
                    let _ = rooms.send(block);
                }
                WriterInput::Ended(mut motion, run) => {
                    if let Some(run) = run {
                        self.begun(&mut writing, tell)?;
                        let now = writing.take();
                        let left = now.map(|now| self.leave(now, *run, motion.ending));
                        motion.record = left.transpose()?;
                    }
                    let _ = tell.send(WriterReport::Motion(motion));
                }
            }
        }
        Ok(())
    }

    /// The record of this motion, begun where it was not.
    fn begun<'a>(
        &self,
        writing: &'a mut Option<Writing>,
        tell: &Sender<WriterReport>,
    ) -> Result<&'a mut Writing, SessionError> {
        let now = writing.take().map_or_else(|| self.begin(tell), Ok)?;
        Ok(writing.insert(now))
    }

    fn begin(&self, tell: &Sender<WriterReport>) -> Result<Writing, SessionError> {
        let held = Lock::take(&self.folder)?;
        let files = TraceFiles::begin(&self.folder, self.kind)?;
        let _ = tell.send(WriterReport::Begun(files.prepared.clone()));
        Ok(Writing { files, seen: RunObserver::new(&self.study, None), _held: held })
    }

    /// Leaves the record of a motion, with its page.
    fn leave(
        &self,
        writing: Writing,
        run: OutsideRun,
        ending: Ending,
    ) -> Result<(Box<Done>, PathBuf), SessionError> {
        let Writing { mut files, seen, _held } = writing;
        let t = run.run.t();
        let interface = run.study().interface.profile.name.clone();
        let reason = match ending {
            Ending::Reflex(reflex) => Some(StopReason::Robot(reflex.name())),
            Ending::Disconnected => Some(StopReason::Robot(Reflex::Communication.name())),
            Ending::Finished | Ending::Stopped | Ending::Over => None,
        };
        let abort = reason.map(|reason| Abort { t, interface, joint: None, reason });
        let more = match ending {
            _ if run.run.is_over() => Vec::new(),
            ending => vec![format!("the motion ended at t = {t} s: {ending}")],
        };
        let (done, rest) = run.stop_seen(seen, abort, more);
        if !rest.is_empty() {
            files.block(&rest)?;
        }
        let page = self.folder.join("report.html");
        done.leave(files, &self.folder, Some(&page), None)?;
        Ok((Box::new(done), page))
    }
}

impl Writing {
    fn block(&mut self, block: &Trace) -> Result<(), SessionError> {
        self.seen.block(block);
        Ok(self.files.block(block)?)
    }
}
