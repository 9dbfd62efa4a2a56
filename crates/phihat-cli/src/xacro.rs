//! Options for files of xacro.

use std::path::{Path, PathBuf};

use clap::Args;
use phihat_model::xacro::XacroOptions;

use crate::failure::Failure;

/// Arguments and packages of a file of xacro.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct Xacro {
    /// Values of the arguments of a file of xacro.
    #[arg(value_name = "NAME:=VALUE")]
    arguments: Vec<String>,
    /// Folder of a ROS package that such a file finds, beside those that are installed or near the file.
    #[arg(long = "package", value_name = "NAME=FOLDER")]
    packages: Vec<String>,
}

impl Xacro {
    pub(crate) fn options(&self) -> Result<XacroOptions, Failure> {
        let mut options = XacroOptions::default();
        for text in &self.arguments {
            let (name, value) = text.split_once(":=").ok_or_else(|| {
                Failure::plain(format!("{text:?}: an argument of xacro is NAME:=VALUE"))
            })?;
            options.arguments.insert(name.trim().to_owned(), value.to_owned());
        }
        for text in &self.packages {
            let (name, folder) = text.split_once('=').ok_or_else(|| {
                Failure::plain(format!("--package {text}: a package is NAME=FOLDER"))
            })?;
            if !Path::new(folder).is_dir() {
                return Err(Failure::plain(format!("--package {text}: {folder} is no folder")));
            }
            options.packages.insert(name.trim().to_owned(), PathBuf::from(folder));
        }
        Ok(options)
    }
}
