use crate::moves::arm::{robot, tool};
use crate::moves::lines::{BENT, request};
use blocksim_multibody::Placement;
use blocksim_robotics::collision::Rules;
use blocksim_robotics::planner::{
    CartesianMove, Orientation, RobotShapes, Space, Surroundings, Timing, encounters,
};
use blocksim_scene::{Form, Purpose, Shape};

fn shape(form: Form, place: Placement) -> Shape {
    Shape { purpose: Purpose::Both, form, place, colour: None }
}

/// A ball of 10 mm about the tip, and a forearm.
fn shapes() -> RobotShapes {
    let mut links = vec![Vec::new(); 6];
    let along_x = Placement::from_rpy([0.4, 0.0, 0.0], [0.0, std::f64::consts::FRAC_PI_2, 0.0]);
    links[3].push(shape(Form::Capsule { radius: 0.07, length: 0.6 }, along_x));
    let tip = robot().parts().tool;
    RobotShapes { base: Vec::new(), links, tool: vec![shape(Form::Sphere { radius: 0.01 }, tip)] }
}

/// Below the tool, whose place is told in the base, 0.1 m above the origin of the world.
fn bench(top: f64) -> (String, Vec<Shape>) {
    let at = robot().parts().base.point(&tool(&robot(), &BENT).translation);
    let place = Placement::from_translation([at.x, at.y, top + 0.1 - 0.02]);
    ("bench".to_owned(), vec![shape(Form::Box { size: [0.4, 0.4, 0.04] }, place)])
}

#[test]
fn the_first_place_where_the_tool_meets_a_bench_is_found() {
    let robot = robot();
    let down =
        CartesianMove::plan(&robot, &request(&robot, [0.0, 0.0, -0.3], Orientation::Fixed, Timing::Sin2))
            .unwrap();
    let height = tool(&robot, &BENT).translation.z;
    let around = Surroundings { floor: Some(-1.0), things: vec![bench(height - 0.11)] };
    let space = Space::new(&robot, &shapes(), &around, &Rules::default());
    let met = encounters(&robot, &down, &space, 1000);
    let first = met.first.expect("a collision");
    assert_eq!(first.names, ["tool".to_owned(), "bench".to_owned()]);
    let way = first.spot.way.expect("a path");
    // the ball has 10 mm, so it touches after 100 mm
    assert!((way.done - 0.1).abs() < 1e-6, "{first}");
    assert!((first.point.z - (height - 0.01)).abs() < 1e-6, "{first:?}");
    assert!(first.distance <= 0.0 && first.distance > -1e-6);
    // deepest in the middle of the plate: the ball and half of the thickness, or wholly through
    let deepest = met.around.expect("a pair");
    assert!(deepest.distance < -0.02 && deepest.distance > -0.06, "{deepest:?}");
    assert!(first.to_string().starts_with("at 33.333 % of the path (s = 100 mm, t = "), "{first}");
}

#[test]
fn a_move_that_hits_nothing_tells_the_least_distance() {
    let robot = robot();
    let down =
        CartesianMove::plan(&robot, &request(&robot, [0.0, 0.0, -0.3], Orientation::Fixed, Timing::Sin2))
            .unwrap();
    let height = tool(&robot, &BENT).translation.z;
    let around = Surroundings { floor: None, things: vec![bench(height - 0.36)] };
    let met = encounters(&robot, &down, &Space::new(&robot, &shapes(), &around, &Rules::default()), 1000);
    assert_eq!(met.first, None);
    let least = met.around.expect("a pair");
    assert!((least.distance - 0.05).abs() < 1e-9 && least.spot.share == 1.0, "{least:?}");
    // what may touch is not looked at
    let rules = Rules { may_touch: vec![["bench".to_owned(), "tool".to_owned()]], ..Rules::default() };
    let around = Surroundings { floor: None, things: vec![bench(height - 0.11)] };
    let met = encounters(&robot, &down, &Space::new(&robot, &shapes(), &around, &rules), 1000);
    assert!(met.first.is_none_or(|first| !first.names.contains(&"tool".to_owned())));
}
