//! A studio: opened, then served until the program ends.

use std::hash::{BuildHasher as _, RandomState};
use std::net::{Ipv4Addr, SocketAddr};
use std::path::{Path, PathBuf};

use phihat_session::RunOptions;
use tokio::net::TcpListener;
use tokio::runtime::Runtime;

use crate::error::StudioError;
use crate::folder::Folder;
use crate::gate::Gate;
use crate::live::Begin;
use crate::player::{Order, Player};
use crate::proof::Proof;
use crate::routes::{Open, Shared, router};
use crate::wire::serve;

/// What a studio is told.
#[derive(Debug, Clone)]
pub struct StudioOptions {
    /// The study file (TOML).
    pub study: PathBuf,
    /// A gains document in place of those that the study states or leaves to the design.
    pub gains: Option<PathBuf>,
    /// Where studies are written, and all that is read after the start.
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
}

impl StudioOptions {
    /// Reads the study, finds its gains, and listens on this machine alone.
    ///
    /// # Errors
    ///
    /// [`StudioError`]: the study cannot be run, as `phihat run` says it; or the port is taken.
    pub fn open(&self) -> Result<Studio, StudioError> {
        let folder = Folder::at(&self.folder)?;
        let options = RunOptions {
            study: self.study.clone(),
            gains: self.gains.clone(),
            ..RunOptions::default()
        };
        let (session, _) = options.open()?;
        let warnings = session.warnings().to_vec();
        let (study, gains) = session.into_parts();
        let name = self.study.file_name().map_or_else(|| "study.toml".into(), PathBuf::from);
        let begin = Begin { study, gains };
        let path = folder_of(&folder, &self.study, &name);
        let failed = |why| StudioError::Listen { port: self.port, why };
        let builder = || tokio::runtime::Builder::new_current_thread().enable_all().build();
        let runtime = builder().map_err(failed)?;
        let at = (Ipv4Addr::LOCALHOST, self.port);
        let listener = runtime.block_on(TcpListener::bind(at)).map_err(failed)?;
        let address = listener.local_addr().map_err(failed)?;
        let open = Open { begin, warnings, path };
        Ok(Studio { runtime, listener, address, key: key(), folder, open })
    }
}

/// Where a study that is read again would stand: beside what it names, where that is inside of the working folder.
fn folder_of(folder: &Folder, study: &Path, name: &Path) -> PathBuf {
    match study.canonicalize() {
        Ok(real) if real.starts_with(folder.path()) => real,
        _ => folder.path().join(name),
    }
}

impl Studio {
    /// Where it listens.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// What a browser opens: with the key, without which nothing is told.
    pub fn link(&self) -> String {
        format!("http://{}/?key={}", self.address, self.key)
    }

    /// Name of the study.
    pub fn study(&self) -> &str {
        &self.open.begin.study.name
    }

    /// What is said before the run.
    pub fn warnings(&self) -> &[String] {
        &self.open.warnings
    }

    /// Serves for as long as the program lives.
    ///
    /// # Errors
    ///
    /// [`StudioError`]: the run cannot begin.
    pub fn serve(self) -> Result<(), StudioError> {
        let (player, _thread) = Player::begin(self.open.begin.clone())?;
        let proof = Proof::new(self.open.begin.clone());
        let taker = player.clone();
        proof.work(Box::new(move |begin| taker.order(Order::Gains(Box::new(begin)))))?;
        let gate = Gate::new(self.address.port(), self.key);
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
