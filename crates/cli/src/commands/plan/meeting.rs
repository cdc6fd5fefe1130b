//! What is told of collisions and distances.

use blocksim_robotics::planner::{Encounter, Encounters, Space};
use serde_json::{Value, json};

/// For people.
pub fn text(met: Option<(&Space, &Encounters)>) -> String {
    let Some((space, met)) = met else {
        return "collisions not checked: the description of the robot has no shapes\n".to_owned();
    };
    let mut text = String::new();
    if let Some(first) = &met.first {
        text += &format!(
            "collision  {first}\n           axes {}; {}\n  = help: {}\n",
            first.axes_text(),
            first.point_text(),
            first.help()
        );
        let all = [&met.own, &met.around].into_iter().flatten();
        if let Some(deepest) = all.min_by(|a, b| a.distance.total_cmp(&b.distance)) {
            let [a, b] = &deepest.names;
            let (depth, place) = (-1e3 * deepest.distance, deepest.place());
            text += &format!("deepest    `{a}` {depth:.1} mm in `{b}` {place}\n");
        }
    }
    let apart = |met: &Option<Encounter>| met.clone().filter(|met| met.distance > 0.0);
    for (what, least) in [("surroundings", apart(&met.around)), ("itself", apart(&met.own))] {
        if let Some(least) = least {
            text += &format!("distance   to {what} at least {least}\n");
        }
    }
    for [a, b] in space.left_out() {
        text += &format!("note       `{a}` and `{b}` touch at the start of the robot and are not checked\n");
    }
    for name in space.unchecked() {
        text += &format!(
            "note       the mesh of `{name}` is not checked; give it simple shapes with `use: Text(\"collision\")`\n"
        );
    }
    text
}

/// For programs; SI units.
pub fn data(space: &Space, met: &Encounters) -> Value {
    let one = |met: &Option<Encounter>| {
        met.as_ref().map(|met| {
            json!({
                "names": met.names, "time": met.spot.t, "share": met.spot.share,
                "way": met.spot.way.map(|way| way.done),
                "positions": met.q, "distance": met.distance, "point": <[f64; 3]>::from(met.point),
            })
        })
    };
    json!({
        "first": one(&met.first), "itself": one(&met.own), "surroundings": one(&met.around), "poses": met.poses,
        "pairs": space.pairs(), "left_out": space.left_out(), "meshes": space.unchecked(),
    })
}
