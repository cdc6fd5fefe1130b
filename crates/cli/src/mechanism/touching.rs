//! What touches in a run, and how near the rest comes.

use blocksim_robotics::collision::{Check, History};
use blocksim_scene::Scene;

use super::recorded::Movement;

/// How far something may move from one pose that is looked at to the next, m.
const STRIDE: f64 = 0.01;
/// Poses between two rows at most.
const BETWEEN: f64 = 50.0;
/// Pairs of solids that are looked at, over all poses.
const MOST: usize = 50_000_000;

/// What was found.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Found {
    /// Contacts and least distances.
    pub history: History,
    /// How far a point moved at most between two poses that were looked at, m.
    pub stride: f64,
    /// Rows that were left out because a position is not a number.
    pub unknown: usize,
    /// One row of so many was taken.
    pub every: usize,
}

/// Looks at the rows of a movement, and between those that are far from each other: there, joints go straight from row to row.
pub fn look(check: &Check, scene: &Scene, movement: &Movement) -> Found {
    let known = |row: &usize| movement.positions.iter().all(|all| all[*row].is_finite());
    let (rows, lost): (Vec<usize>, Vec<usize>) = (0..movement.time.len()).partition(known);
    let every = rows.len().saturating_mul(check.pairs()).div_ceil(MOST).max(1);
    let last = rows.last().copied().filter(|_| (rows.len() - 1) % every != 0);
    let at = |row: usize| -> Vec<f64> { movement.positions.iter().map(|all| all[row]).collect() };
    let mut stride: f64 = 0.0;
    let mut before: Option<(f64, Vec<f64>)> = None;
    let way = rows.iter().copied().step_by(every).chain(last).flat_map(|row| {
        let (time, positions) = (movement.time[row], at(row));
        let (start, from) = before.replace((time, positions.clone())).unwrap_or((time, positions.clone()));
        let moved = check.moved(&scene.poses(&from), &scene.poses(&positions));
        let parts = (moved / STRIDE).ceil().clamp(1.0, BETWEEN);
        stride = stride.max(moved / parts);
        let pose = move |part: f64| {
            let between = from.iter().zip(&positions).map(|(a, b)| a + (b - a) * part);
            (start + (time - start) * part, scene.poses(&between.collect::<Vec<f64>>()))
        };
        (1..=parts as usize).map(move |part| pose(part as f64 / parts))
    });
    let history = check.history(way);
    Found { history, stride, unknown: lost.len(), every }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanism::surroundings;
    use blocksim_multibody::Placement;
    use blocksim_scene::{Form, Motion, Purpose, SceneBody, SceneShape, Shape};

    /// A mast that slides along x with a ball of 0.1 m at 1 m of height.
    pub fn mast() -> Scene {
        let mut scene = Scene::new();
        scene.bodies.push(SceneBody {
            name: "slide".to_owned(),
            parent: Some(0),
            place: Placement::from_translation([0.0, 0.0, 1.0]),
            motion: Motion::Slide { axis: [1.0, 0.0, 0.0], signal: "slide.q".to_owned() },
            start: vec![0.0],
        });
        let form = Form::Sphere { radius: 0.1 };
        let shape = Shape { purpose: Purpose::Both, form, place: Placement::identity(), colour: None };
        scene.shapes.push(SceneShape { body: 1, owner: "mast".to_owned(), shape });
        scene
    }

    /// It goes 1 m along x in 1 s and back again, in rows that are so many to the second.
    fn there_and_back(rate: u32) -> Movement {
        let time: Vec<f64> = (0..=2 * rate).map(|k| f64::from(k) / f64::from(rate)).collect();
        let positions = vec![time.iter().map(|t| 1.0 - (t - 1.0).abs()).collect()];
        Movement { time, positions }
    }

    fn looked(around: &str, movement: &Movement) -> Found {
        let around = surroundings::tests::around(around);
        look(&surroundings::check(&mast(), &around), &mast(), movement)
    }

    const WALL: &str = r#"(kind: Text("box"), size: ["0.2 m", "1 m", "1 m"], centre: ["0.9 m", 0, "1 m"])"#;

    /// The ball is at the wall from 0.7 s to 1.3 s, and a row stands at each half second: a window that ends between two rows, or lies
    /// between them altogether, holds what happens in it.
    #[test]
    fn a_window_ends_where_it_is_said_to_end() {
        let around = format!(r#"(things: [(name: Text("wall"), shapes: [{WALL}])])"#);
        for (window, touches) in [
            ([0.5, 0.69], None),
            ([0.5, 0.9], Some([0.7, 0.9])),
            ([0.8, 0.9], Some([0.8, 0.9])),
            ([1.2, 2.0], Some([1.2, 1.3])),
            ([1.2, 1.2], Some([1.2, 1.2])),
            ([f64::NEG_INFINITY, 0.75], Some([0.7, 0.75])),
        ] {
            let movement = there_and_back(2).within(window);
            assert!(movement.time.iter().all(|time| (window[0]..=window[1]).contains(time)), "{movement:?}");
            let contacts = looked(&around, &movement).history.contacts;
            let found = contacts.first().map(|contact| [contact.from, contact.to]);
            let near = |[a, b]: [f64; 2], [c, d]: [f64; 2]| (a - c).abs() < 0.011 && (b - d).abs() < 0.011;
            let is_right =
                found.zip(touches).map_or(found == touches, |(found, touches)| near(found, touches));
            assert!(is_right, "{window:?}: {found:?}");
        }
        assert_eq!(there_and_back(2).within([2.5, 3.0]).time, [] as [f64; 0]);
    }

    #[test]
    fn a_contact_lasts_as_long_as_the_ball_is_at_the_wall() {
        let around = format!(r#"(floor: "0.2 m", things: [(name: Text("wall"), shapes: [{WALL}])])"#);
        // Rows that are 0.5 m apart are as good, for what is between them is looked at, too.
        for rate in [500, 2] {
            let found = looked(&around, &there_and_back(rate));
            // The wall begins at 0.8 m, the ball reaches it at 0.7 m; in its middle it is 0.2 m deep.
            let [contact] = &found.history.contacts[..] else { panic!("{found:?}") };
            assert!((contact.from - 0.7).abs() < 0.011 && (contact.to - 1.3).abs() < 0.011, "{found:?}");
            assert_eq!(contact.names, ["mast", "wall"]);
            assert!((contact.deepest.distance.distance + 0.2).abs() < 0.011, "{found:?}");
            let [(names, nearest)] = &found.history.nearest[..] else { panic!("{found:?}") };
            assert_eq!(names, &["mast", "floor"]);
            assert!((nearest.distance.distance - 0.7).abs() < 1e-9, "{found:?}");
            assert!(found.stride < 0.011 && found.unknown == 0 && found.every == 1, "{found:?}");
        }
    }

    #[test]
    fn what_may_touch_is_no_contact_and_the_floor_can_be_touched() {
        let allowed = format!(
            r#"(things: [(name: Text("wall"), shapes: [{WALL}])], may_touch: [[Text("tool"), Text("wall")]])"#
        );
        assert!(looked(&allowed, &there_and_back(500)).history.contacts.is_empty());
        let high = looked(r#"(floor: "0.95 m")"#, &there_and_back(500)).history.contacts;
        assert_eq!((high.len(), high[0].from, high[0].to), (1, 0.0, 2.0));
        assert!((high[0].deepest.distance.distance + 0.05).abs() < 1e-9, "{high:?}");
    }

    #[test]
    fn positions_that_are_no_numbers_are_left_out() {
        let mut movement = there_and_back(500);
        movement.positions[0][3] = f64::NAN;
        let found = looked(r#"(floor: "0 m")"#, &movement);
        assert_eq!((found.unknown, found.history.contacts.len(), found.history.nearest.len()), (1, 0, 1));
    }
}
