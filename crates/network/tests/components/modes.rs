//! The choice of modes where many frictions meet at rest.

use crate::plant::Plant;

/// Four discs with clutches between neighbours, across two, and brakes to the frame; all hold half as much again as they
/// transmit while sliding, so that there may be several solutions.
fn web() -> Plant {
    let mut blocks = vec![("frame".to_owned(), "RotationalReference".to_owned())];
    let mut joined: Vec<Vec<String>> = vec![Vec::new(); 4];
    let mut ground = vec!["frame.r".to_owned()];
    for (disc, joined) in joined.iter_mut().enumerate() {
        blocks.push((format!("disc{disc}"), format!("Inertia(j: {:?})", 0.1 * (disc + 1) as f64)));
        blocks.push((format!("push{disc}"), "IdealTorqueSource".to_owned()));
        blocks.push((format!("eye{disc}"), "MotionSensor".to_owned()));
        blocks.push((format!("brake{disc}"), format!("Brake(torque: {:?}, peak: 1.5)", 1.0 + disc as f64)));
        joined.extend(["disc", "push", "eye", "brake"].map(|kind| format!("{kind}{disc}.r")));
        ground.extend(["push", "eye", "brake"].map(|kind| format!("{kind}{disc}.c")));
    }
    for (i, (a, b)) in [(0, 1), (1, 2), (2, 3), (0, 2)].into_iter().enumerate() {
        blocks.push((format!("clutch{i}"), format!("Clutch(torque: {:?}, peak: 1.5)", 2.5 - 0.5 * i as f64)));
        joined[a].push(format!("clutch{i}.r"));
        joined[b].push(format!("clutch{i}.c"));
    }
    let lines: Vec<String> = joined.iter().chain([&ground]).map(|set| set.join(" <-> ")).collect();
    let blocks: Vec<(&str, &str)> =
        blocks.iter().map(|(path, text)| (path.as_str(), text.as_str())).collect();
    let lines: Vec<&str> = lines.iter().map(String::as_str).collect();
    Plant::new(&blocks, &lines)
}

/// Numbers in -1..1 that look random (Weyl's sequence).
fn scattered(i: u32) -> f64 {
    2.0 * (f64::from(i) * 0.618_033_988_749_894_9).fract() - 1.0
}

#[test]
fn modes_agree_with_torques_and_speeds_wherever_the_frictions_bring_the_discs() {
    let mut plant = web();
    let inertia = [0.1, 0.2, 0.3, 0.4];
    let mut seen = [0, 0];
    for round in 0..400 {
        // Torques and pressures jump; every tenth time all are let go for a while.
        for k in 0..4_u32 {
            let pressed =
                if round % 10 == 9 { 0.0 } else { (3.0 * scattered(13 * round + k)).clamp(0.0, 1.0) };
            plant.set(&format!("push{k}.tau"), 6.0 * scattered(7 * round + k));
            plant.set(&format!("clutch{k}.normal"), pressed);
            plant.set(&format!("brake{k}.engaged"), (2.0 * scattered(29 * round + k)).clamp(0.0, 1.0));
        }
        plant.bench.major();
        plant.run_to(plant.bench.t + 0.02, 1e-3);
        let w = [0, 1, 2, 3].map(|k| plant.get(&format!("eye{k}.w")));
        let a = [0, 1, 2, 3].map(|k| plant.get(&format!("eye{k}.a")));
        let mut balance: [f64; 4] =
            std::array::from_fn(|k| inertia[k] * a[k] - 6.0 * scattered(7 * round + k as u32));
        let ends = [(0, 1), (1, 2), (2, 3), (0, 2)];
        for k in 0..4 {
            let (from, to) = ends[k];
            let clutch = (3.0 * scattered(13 * round + k as u32)).clamp(0.0, 1.0);
            let clutch = if round % 10 == 9 { 0.0 } else { clutch } * (2.5 - 0.5 * k as f64);
            let brake = (2.0 * scattered(29 * round + k as u32)).clamp(0.0, 1.0) * (1.0 + k as f64);
            for (name, slides, slip, gains) in
                [("clutch", clutch, w[from] - w[to], a[from] - a[to]), ("brake", brake, w[k], a[k])]
            {
                let torque = plant.get(&format!("{name}{k}.tau"));
                let locked = plant.get(&format!("{name}{k}.locked")) == 1.0;
                seen[usize::from(locked)] += 1;
                let text = format!("round {round}, {name}{k}: {torque} N*m, {slip} rad/s, {gains} rad/s^2");
                if locked {
                    assert!(slip.abs() < 1e-9 && gains.abs() < 1e-9, "it is locked and slips: {text}");
                    assert!(torque.abs() <= 1.5 * slides + 1e-9, "it holds more than it can: {text}");
                } else {
                    assert!((torque.abs() - slides).abs() < 1e-9, "it slides with another torque: {text}");
                    let opposes = torque * slip >= -1e-9 || torque * gains >= -1e-9 && slip.abs() < 1e-6;
                    assert!(opposes, "it drives instead of braking: {text}");
                }
                balance[if name == "clutch" { from } else { k }] += torque;
                if name == "clutch" {
                    balance[to] -= torque;
                }
            }
        }
        assert!(balance.iter().all(|rest| rest.abs() < 1e-9), "round {round}: {balance:?}");
    }
    assert!(seen.iter().all(|count| *count > 300), "{seen:?}");
}
