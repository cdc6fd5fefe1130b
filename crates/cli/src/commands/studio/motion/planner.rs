//! What planning needs again and again while somebody types: the robot, and moves that have not changed.

use std::cell::RefCell;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use blocksim_blocks::motion::Segments;
use blocksim_diagram::Reader;

use super::common;
use crate::commands::plan::Setting;
use crate::disk::Disk;
use crate::failure::Failure;

/// The robot of the model that was planned for last. It is read anew as soon as one of its files has another text.
#[derive(Default)]
pub struct Planner(Mutex<Option<Ready>>);

struct Ready {
    model: PathBuf,
    /// Files that the robot was read from, and what was in them.
    files: Vec<(PathBuf, String)>,
    setting: Arc<Setting>,
    segments: Segments,
}

impl Planner {
    /// Does something with the robot of a model and the moves that are known of it.
    ///
    /// # Errors
    /// Why the robot cannot be read.
    pub fn with<T>(
        &self,
        model: &Path,
        does: impl FnOnce(&Arc<Setting>, &mut Segments) -> T,
    ) -> Result<T, Failure> {
        let mut place = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut ready = match place.take().filter(|known| known.is_of(model)) {
            Some(known) => known,
            None => Ready::read(model)?,
        };
        let done = does(&ready.setting, &mut ready.segments);
        *place = Some(ready);
        Ok(done)
    }
}

impl Ready {
    fn read(model: &Path) -> Result<Ready, Failure> {
        let noting = Noting::default();
        let setting = Arc::new(Setting::read(&common(model), &noting)?);
        let (model, files) = (model.to_owned(), noting.read.into_inner());
        Ok(Ready { model, files, setting, segments: Segments::default() })
    }

    fn is_of(&self, model: &Path) -> bool {
        let disk = Disk::default();
        self.model == model
            && self.files.iter().all(|(path, text)| disk.read(path).is_ok_and(|present| present == *text))
    }
}

/// The disk, noting what is read.
#[derive(Default)]
struct Noting {
    disk: Disk,
    read: RefCell<Vec<(PathBuf, String)>>,
}

impl Reader for Noting {
    fn read(&self, path: &Path) -> Result<String, String> {
        let text = self.disk.read(path)?;
        self.read.borrow_mut().push((path.to_owned(), text.clone()));
        Ok(text)
    }
}
