//! A studio: opened, then served until the program ends.

use std::hash::{BuildHasher as _, RandomState};
use std::net::{Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};

use phihat_session::{RunOptions, drawn_arm, files, recorded};
use tokio::net::TcpListener;
use tokio::runtime::Runtime;

use crate::begin::Begin;
use crate::error::StudioError;
use crate::folder::Folder;
use crate::gate::PageGate;
use crate::open::{Open, RecordAbout};
use crate::player::{Player, PlayerOrder};
use crate::proof::Proof;
use crate::recorded::Recorded;
use crate::routes::{Shared, router};
use crate::stage::Stage;
use crate::text;
use crate::wire::serve;

/// Options of a studio.
#[derive(Debug, Clone, Default)]
pub struct StudioOptions {
    /// The study file (TOML); `None`: that of the record that is played.
    pub study: Option<PathBuf>,
    /// A gains document in place of those that the study states or leaves to the design.
    pub gains: Option<PathBuf>,
    /// A record to be played: the folder of a run or a drive, or a log of joint states (MCAP) of the study's arm.
    pub replay: Option<PathBuf>,
    /// Folder in which studies are written, and from which all is read after the start.
    pub folder: PathBuf,
    /// Port on this machine that is listened on; 0: any that is free.
    pub port: u16,
}

/// A studio that listens.
#[derive(Debug)]
pub struct Studio {
    runtime: Runtime,
    listener: TcpListener,
    address: SocketAddr,
    key: String,
    folder: Folder,
    open: Open,
    stage: Stage,
}

impl StudioOptions {
    /// Reads the study, finds its gains, and listens on this machine alone.
    ///
    /// # Errors
    ///
    /// [`StudioError`]: the study cannot be run, as `phihat run` says it; or the port is taken.
    pub fn open(&self) -> Result<Studio, StudioError> {
        let folder = Folder::at(&self.folder)?;
        let (open, stage) = match &self.replay {
            Some(record) => self.replay(record)?,
            None => self.live(&folder)?,
        };
        let failed = |why| StudioError::Listen { port: self.port, why };
        let builder = || tokio::runtime::Builder::new_current_thread().enable_all().build();
        let runtime = builder().map_err(failed)?;
        let at = (Ipv4Addr::LOCALHOST, self.port);
        let listener = runtime.block_on(TcpListener::bind(at)).map_err(failed)?;
        let address = listener.local_addr().map_err(failed)?;
        Ok(Studio { runtime, listener, address, key: key(), folder, open, stage })
    }

    fn live(&self, folder: &Folder) -> Result<(Open, Stage), StudioError> {
        let study = self.study.clone();
        let study =
            study.ok_or_else(|| StudioError::refused("which study? or --replay a record"))?;
        let options =
            RunOptions { study: study.clone(), gains: self.gains.clone(), ..RunOptions::default() };
        let (session, _) = options.open()?;
        let warnings = session.warnings().to_vec();
        let name = study.file_name().map_or_else(|| "study.toml".into(), PathBuf::from);
        let path = folder_of(folder, &study, &name);
        let (study, gains) = session.into_parts();
        let stage = Stage::live(Begin { study: study.clone(), gains: gains.clone() })?;
        let arm = Box::new(drawn_arm(&study, None));
        Ok((Open { study, arm, gains: Some(gains), warnings, path, played: None }, stage))
    }

    fn replay(&self, record: &Path) -> Result<(Open, Stage), StudioError> {
        let is_log = record.extension().is_some_and(|end| end == "mcap");
        let (study, gains, play) = match &self.study {
            Some(path) if is_log => {
                let study = text::study(&files::read(path)?, path)?;
                let play = Recorded::of_log(record, &study)?;
                (study, None, play)
            }
            None if is_log => {
                let why = "a log names no arm: give the study of its arm as well";
                return Err(StudioError::refused(why));
            }
            _ => {
                let folder = if record.is_dir() { record } else { folder_beside(record) };
                let (done, trace) = recorded(folder)?;
                (done.study, done.gains, Recorded::of_trace(&trace))
            }
        };
        let played = Some(RecordAbout { length: play.length(), path: play.path() });
        let path = record.to_owned();
        let warnings = Vec::new();
        let arm = Box::new(drawn_arm(&study, None));
        let open = Open { study, arm, gains, warnings, path, played };
        Ok((open, Stage::Record(Box::new(play))))
    }
}

/// The folder of a file of a record.
fn folder_beside(file: &Path) -> &Path {
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Path of a study that is read again: its own where that is inside of the working folder, else `name` in
/// that folder.
fn folder_of(folder: &Folder, study: &Path, name: &Path) -> PathBuf {
    match study.canonicalize() {
        Ok(real) if real.starts_with(folder.path()) => real,
        _ => folder.path().join(name),
    }
}

impl Studio {
    /// Address that it listens on.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Link for a browser, with the key, without which nothing is reported.
    pub fn link(&self) -> String {
        format!("http://{}/?key={}", self.address, self.key)
    }

    /// Name of the study.
    pub fn study(&self) -> &str {
        &self.open.study.name
    }

    /// Warnings before the run.
    pub fn warnings(&self) -> &[String] {
        &self.open.warnings
    }

    /// Serves for as long as the program lives.
    ///
    /// # Errors
    ///
    /// [`StudioError`]: the run cannot begin.
    pub fn serve(self) -> Result<(), StudioError> {
        let (player, _thread) = Player::begin(self.stage)?;
        let proof = self.open.begin().map(Proof::new);
        if let Some(proof) = &proof {
            let taker = player.clone();
            proof.work(Box::new(move |begin| taker.order(PlayerOrder::Gains(Box::new(begin)))))?;
        }
        let gate = PageGate::new(self.address.port(), self.key);
        let shared = Shared::new(gate, player, proof, self.folder, self.open);
        self.runtime.block_on(serve(self.listener, router(shared)));
        Ok(())
    }
}

/// 128 bits that nobody else knows: of the keys that the system's randomness gives every hash table.
fn key() -> String {
    let half = || RandomState::new().hash_one(0x7068_6968_6174_u64);
    format!("{:016x}{:016x}", half(), half())
}
