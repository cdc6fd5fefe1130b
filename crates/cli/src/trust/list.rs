//! The list of what is trusted: folders and libraries, by paths without links.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use blocksim_recording::{limited_text, write_whole};
use serde_json::{Value, json};

use crate::disk;
use crate::home;

/// Name of the file.
const FILE: &str = "trusted.json";
/// File that is there while somebody changes the list, and how long others wait for that; to write it takes milliseconds.
const LOCK: &str = "trusted.lock";
const PATIENCE: Duration = Duration::from_secs(3);
/// Most bytes of it.
const LARGEST: u64 = 4 << 20;

/// What is trusted.
#[derive(Debug, Default, PartialEq)]
pub struct TrustList {
    /// Folders, with all that is below them, and libraries; in the order of their paths.
    pub entries: Vec<PathBuf>,
}

impl TrustList {
    /// As it is now; nothing where there is no list.
    ///
    /// # Errors
    /// Why it cannot be read. Nothing is trusted then.
    pub fn read() -> Result<TrustList, String> {
        match file() {
            Some(file) => read_from(&file),
            None => Ok(TrustList::default()),
        }
    }

    /// Whether a path without links is trusted, or is below what is.
    pub fn covers(&self, path: &Path) -> bool {
        self.entries.iter().any(|entry| path.starts_with(entry))
    }

    /// Adds a path without links; whether that changed anything.
    ///
    /// # Errors
    /// Why the list cannot be read or written.
    pub fn add(path: &Path) -> Result<bool, String> {
        // What is on the list already needs no place for it.
        if TrustList::read()?.covers(path) {
            return Ok(false);
        }
        let _alone = Alone::wait()?;
        let mut list = TrustList::read()?;
        if list.covers(path) {
            return Ok(false);
        }
        if path.to_str().is_none() {
            return Err("its path is not text in UTF-8".to_owned());
        }
        list.entries.push(path.to_owned());
        list.entries.sort();
        list.write().map(|()| true)
    }

    /// Removes an entry; whether there was one.
    ///
    /// # Errors
    /// Why the list cannot be read or written.
    pub fn remove(path: &Path) -> Result<bool, String> {
        let _alone = Alone::wait()?;
        let mut list = TrustList::read()?;
        let before = list.entries.len();
        list.entries.retain(|entry| entry != path);
        if list.entries.len() == before {
            return Ok(false);
        }
        list.write().map(|()| true)
    }

    fn write(&self) -> Result<(), String> {
        let folder = folder()?;
        let file = folder.join(FILE);
        let entries: Vec<&str> = self.entries.iter().filter_map(|entry| entry.to_str()).collect();
        let text = format!("{:#}\n", json!({ "v": 1, "trusted": entries }));
        write_whole(&folder, FILE, |out| out.write_all(text.as_bytes()))
            .map(|_| ())
            .map_err(|error| format!("`{}` cannot be written: {}", file.display(), error.reason()))
    }
}

/// The folder of the list, made where it is missing.
fn folder() -> Result<PathBuf, String> {
    let folder = home::config().ok_or("this system has no folder for settings; name one in BLOCKSIM_HOME")?;
    fs::create_dir_all(&folder)
        .map_err(|error| format!("`{}` cannot be created: {error}", folder.display()))?;
    Ok(folder)
}

/// Nobody else changes the list as long as this is held: two programs that read, add and write at once would lose an entry.
struct Alone(PathBuf);

impl Alone {
    fn wait() -> Result<Alone, String> {
        let lock = folder()?.join(LOCK);
        let begin = Instant::now();
        loop {
            match fs::File::create_new(&lock) {
                Ok(_) => return Ok(Alone(lock)),
                Err(error) if error.kind() != io::ErrorKind::AlreadyExists => {
                    return Err(format!("`{}` cannot be written: {error}", lock.display()));
                }
                // A program that was ended in the middle has left it.
                Err(_) if begin.elapsed() > PATIENCE => {
                    let _ = fs::remove_file(&lock);
                }
                Err(_) => std::thread::sleep(Duration::from_millis(5)),
            }
        }
    }
}

impl Drop for Alone {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

/// Where the list is.
fn file() -> Option<PathBuf> {
    Some(home::config()?.join(FILE))
}

fn read_from(file: &Path) -> Result<TrustList, String> {
    let cannot = |reason: String| format!("`{}` cannot be read: {reason}", file.display());
    let text = match limited_text(file, LARGEST) {
        Ok(text) => text,
        Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(TrustList::default()),
        Err(error) => return Err(cannot(disk::reason(&error))),
    };
    let value: Value = serde_json::from_str(&text).map_err(|error| cannot(error.to_string()))?;
    let listed = value["trusted"].as_array().ok_or_else(|| cannot("it has no list `trusted`".to_owned()))?;
    let mut entries = Vec::new();
    for entry in listed {
        let path = entry.as_str().map(PathBuf::from).filter(|path| path.is_absolute());
        entries.push(path.ok_or_else(|| cannot(format!("{entry} is not an absolute path")))?);
    }
    Ok(TrustList { entries })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_below_a_trusted_folder_is_trusted() {
        let list = TrustList { entries: vec!["/home/a/robot".into(), "/opt/x.so".into()] };
        for (path, covered) in [
            ("/home/a/robot", true),
            ("/home/a/robot/plugins/pid", true),
            ("/home/a/robot2", false),
            ("/home/a", false),
            ("/opt/x.so", true),
            ("/opt/x.so.1", false),
        ] {
            assert_eq!(list.covers(Path::new(path)), covered, "{path}");
        }
    }

    #[test]
    fn a_list_that_makes_no_sense_trusts_nothing() {
        let folder = std::env::temp_dir().join(format!("blocksim-trust-list-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let file = folder.join(FILE);
        assert_eq!(read_from(&file), Ok(TrustList::default()));
        for (text, reason) in [
            ("{", "EOF"),
            ("{}", "no list `trusted`"),
            ("{\"trusted\": [\"here\"]}", "\"here\" is not an absolute path"),
            ("{\"trusted\": [1]}", "1 is not an absolute path"),
        ] {
            fs::write(&file, text).unwrap();
            assert!(read_from(&file).unwrap_err().contains(reason), "{text}");
        }
        fs::write(&file, "{\"v\": 1, \"trusted\": [\"/a/b\"]}").unwrap();
        assert_eq!(read_from(&file).unwrap().entries, [PathBuf::from("/a/b")]);
        fs::remove_dir_all(folder).unwrap();
    }
}
