//! The mechanism that moves while a run runs: what is seen of it, and where its joints are among what is recorded.

use std::collections::HashMap;
use std::path::Path;

use blocksim_block::schedule::{Recorded, Schedule, Signal};
use blocksim_diagram::Sources;
use blocksim_scene::Scene;
use blocksim_signal::{Kind, Unit};
use serde_json::Value;

use crate::args::model::RunArgs;
use crate::disk::Disk;
use crate::loaded::Loaded;
use crate::mechanism::surroundings;
use crate::scene::json;

/// Most positions that go out with every row.
const MOST: usize = 256;

/// What moves; nothing of all where the model has no mechanism.
#[derive(Debug, Clone, Default)]
pub struct Mechanism {
    /// Bodies, shapes, masses and frames as in `scene.json`, with what stands around; null where there is nothing to show.
    pub scene: Value,
    /// Where each position of [`Scene::signals`] is among what is recorded, in SI.
    pub sources: Vec<(usize, Unit)>,
    /// Which of these have a set value that is recorded, and where that is.
    pub sets: Vec<(usize, (usize, Unit))>,
    /// Why something is not seen, in words.
    pub unseen: Option<String>,
}

impl Mechanism {
    /// The mechanism of a model that is about to run.
    pub fn of(args: &RunArgs, loaded: &Loaded, schedule: &Schedule) -> Mechanism {
        let Some(scene) = loaded.scene() else { return Mechanism::default() };
        let mut mechanism = Mechanism::moved(scene, &schedule.recorded);
        if !mechanism.scene.is_null() {
            mechanism.sets = sets(&scene.signals(), &schedule.signals, &schedule.recorded);
            mechanism.surround(&args.model.model, &args.model.set);
        }
        mechanism
    }

    fn moved(scene: &Scene, recorded: &[Recorded]) -> Mechanism {
        let signals = scene.signals();
        let found = |path: &&str| recorded.iter().position(|recorded| recorded.path == **path);
        // Without joints nothing moves, as in the page of a run.
        let places: Option<Vec<usize>> = signals.iter().map(found).collect();
        let (Some(places), Ok(one)) = (places.filter(|places| !places.is_empty()), Unit::parse("1")) else {
            return Mechanism::default();
        };
        if places.len() > MOST {
            let unseen = format!(
                "The mechanism has {} positions, and up to {MOST} are shown while a run goes on. Its results show all of them.",
                places.len()
            );
            return Mechanism { unseen: Some(unseen), ..Mechanism::default() };
        }
        let scene = serde_json::from_str(&json(scene, &HashMap::new())).unwrap_or_default();
        let sources = places.into_iter().map(|place| (place, one.clone())).collect();
        Mechanism { scene, sources, ..Mechanism::default() }
    }

    /// Adds what stands around.
    fn surround(&mut self, model: &Path, overrides: &[String]) {
        let disk = Disk::default();
        match surroundings::of_model(&Sources::new(&disk), model, overrides) {
            Ok(Some(around)) => surroundings::draw(&around, &mut self.scene),
            Ok(None) => {}
            Err(reason) => self.unseen = Some(format!("What stands around is not shown: {reason}.")),
        }
    }
}

/// The set values of positions: a scope whose input `actual` is, to the cell, the position of a joint has its set value at `set`.
fn sets(positions: &[&str], signals: &[Signal], recorded: &[Recorded]) -> Vec<(usize, (usize, Unit))> {
    let set_of = |(n, path): (usize, &&str)| {
        let cells = || signals.iter().filter(|signal| signal.path == **path).map(|signal| signal.offset);
        let scopes = recorded.iter().filter(|one| cells().any(|cell| cell == one.cell));
        let blocks = scopes.filter_map(|one| one.path.strip_suffix(".actual"));
        let set = blocks.map(|block| format!("{block}.set")).find_map(|set| {
            let at = recorded.iter().position(|one| one.path == set)?;
            // One scalar for one position.
            (recorded[at].kind == Kind::Real).then_some(at)
        });
        Some((n, (set?, Unit::parse("1").ok()?)))
    };
    positions.iter().enumerate().filter_map(set_of).collect()
}

#[cfg(test)]
mod tests {
    use blocksim_block::schedule::Keep;
    use blocksim_multibody::Placement;
    use blocksim_scene::{Motion, SceneBody};

    use super::*;

    /// Slides one on the other; what is recorded is something else, then their positions backwards.
    fn slides(count: usize) -> (Scene, Vec<Recorded>) {
        let mut scene = Scene::new();
        for n in 0..count {
            scene.bodies.push(SceneBody {
                name: format!("slide{n}"),
                parent: Some(n),
                place: Placement::identity(),
                motion: Motion::Slide { axis: [1.0, 0.0, 0.0], signal: format!("slide{n}.q") },
                start: vec![0.0],
            });
        }
        let recorded = |path: String| Recorded {
            path,
            cell: 0,
            kind: Kind::Real,
            dimension: None,
            display: None,
            title: Vec::new(),
            legend: None,
            over: None,
            keep: Keep::All,
            held: false,
        };
        let positions = (0..count).rev().map(|n| format!("slide{n}.q"));
        let paths = std::iter::once("other.y".to_owned()).chain(positions);
        (scene, paths.map(recorded).collect())
    }

    #[test]
    fn each_position_is_found_among_what_is_recorded() {
        let (scene, mut recorded) = slides(3);
        let found = Mechanism::moved(&scene, &recorded);
        assert_eq!(found.sources.iter().map(|source| source.0).collect::<Vec<_>>(), [3, 2, 1]);
        assert_eq!((found.scene["bodies"].as_array().unwrap().len(), found.unseen), (4, None));
        recorded.pop();
        assert!(
            Mechanism::moved(&scene, &recorded).scene.is_null(),
            "where a joint is missing, nothing is known"
        );
        assert!(Mechanism::moved(&Scene::new(), &recorded).scene.is_null());
    }

    #[test]
    fn set_values_are_those_of_the_scope_that_shows_a_position() {
        use blocksim_signal::Shape;
        let (_, mut recorded) = slides(2);
        let signal = |path: &str, offset| Signal {
            path: path.to_owned(),
            offset,
            kind: Kind::Real,
            shape: Shape::Scalar,
            dimension: None,
        };
        let one = |path: &str, cell| Recorded { path: path.to_owned(), cell, ..recorded[0].clone() };
        // One scope shows the position itself, the other one something that is called alike.
        let scopes = [one("a.set", 7), one("a.actual", 3), one("b.set", 8), one("b.actual", 9)];
        recorded.extend(scopes);
        let signals = [signal("slide0.q", 3), signal("slide1.q", 4), signal("slide1.q", 5)];
        let found = sets(&["slide0.q", "slide1.q"], &signals, &recorded);
        assert_eq!(found.iter().map(|(n, (at, _))| (*n, *at)).collect::<Vec<_>>(), [(0, 3)]);
    }

    #[test]
    fn more_positions_than_can_be_sent_are_told() {
        let (scene, recorded) = slides(MOST + 1);
        let found = Mechanism::moved(&scene, &recorded);
        assert!(found.scene.is_null() && found.sources.is_empty());
        assert!(found.unseen.unwrap().contains("257 positions, and up to 256"));
        let (scene, recorded) = slides(MOST);
        assert_eq!(Mechanism::moved(&scene, &recorded).sources.len(), MOST);
    }
}
