//! The mechanism that moves while a run runs: what is seen of it, and where its joints are among what is recorded.

use std::collections::HashMap;
use std::path::Path;

use blocksim_block::schedule::Recorded;
use blocksim_diagram::Sources;
use blocksim_scene::Scene;
use blocksim_signal::Unit;
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
    /// Why something is not seen, in words.
    pub unseen: Option<String>,
}

impl Mechanism {
    /// The mechanism of a model that is about to run.
    pub fn of(args: &RunArgs, loaded: &Loaded, recorded: &[Recorded]) -> Mechanism {
        let Some(scene) = loaded.scene() else { return Mechanism::default() };
        let mut mechanism = Mechanism::moved(scene, recorded);
        if !mechanism.scene.is_null() {
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
        Mechanism { scene, sources, unseen: None }
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

#[cfg(test)]
mod tests {
    use blocksim_block::schedule::Keep;
    use blocksim_multibody::Placement;
    use blocksim_scene::{Motion, SceneBody};
    use blocksim_signal::Kind;

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
    fn more_positions_than_can_be_sent_are_told() {
        let (scene, recorded) = slides(MOST + 1);
        let found = Mechanism::moved(&scene, &recorded);
        assert!(found.scene.is_null() && found.sources.is_empty());
        assert!(found.unseen.unwrap().contains("257 positions, and up to 256"));
        let (scene, recorded) = slides(MOST);
        assert_eq!(Mechanism::moved(&scene, &recorded).sources.len(), MOST);
    }
}
