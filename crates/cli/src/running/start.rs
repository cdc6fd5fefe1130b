//! Where a run began, in words and as data.

use blocksim_block::schedule::{Start, Steady};
use blocksim_sim::{Rest, Simulation};
use serde_json::{Value, json};

use crate::terminal::format::short_time;

/// Names that are told in words.
const NAMED: usize = 5;

/// The steady state of a run, if it began in one.
#[derive(Debug, Clone, PartialEq)]
pub struct Began {
    /// Constants whose values were found, with value in SI units and unit.
    found: Vec<(String, f64, String)>,
    rest: Rest,
}

impl Began {
    /// What a simulation tells of it.
    pub fn of(simulation: &Simulation) -> Option<Began> {
        let Start::Steady(Steady { free, .. }) = &simulation.schedule().settings.start else { return None };
        let rest = simulation.rest()?.clone();
        let unit = |free: &blocksim_block::schedule::Free| {
            free.dimension.map_or(String::new(), |dimension| dimension.to_string())
        };
        let found = free.iter().zip(&rest.found).map(|(free, value)| (free.name.clone(), *value, unit(free)));
        Some(Began { found: found.collect(), rest })
    }

    /// In a line.
    pub fn text(&self) -> String {
        let mut text = "in a steady state".to_owned();
        for (name, value, unit) in &self.found {
            let unit = if matches!(unit.as_str(), "" | "1") { String::new() } else { format!(" {unit}") };
            text += &format!("; `{name}` = {}{unit}", short_time(*value));
        }
        if !self.rest.undetermined.is_empty() {
            text += &format!("; not determined, near what is written: {}", listed(&self.rest.undetermined));
        }
        text
    }

    /// As data.
    pub fn json(&self) -> Value {
        let found =
            |(name, value, unit): &(String, f64, String)| json!({"name": name, "value": value, "unit": unit});
        let adrift = |(name, rate): &(String, f64)| json!({"name": name, "rate": rate});
        json!({
            "found": self.found.iter().map(found).collect::<Vec<_>>(),
            "adrift": self.rest.adrift.iter().map(adrift).collect::<Vec<_>>(),
            "undetermined": self.rest.undetermined,
        })
    }
}

fn listed(names: &[String]) -> String {
    let told = names.iter().take(NAMED).map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(NAMED) {
        0 => told,
        more => format!("{told} and {more} more"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_found_and_what_is_free_is_told_in_a_line() {
        let names = |n: usize| (0..n).map(|i| format!("a{i}.x")).collect::<Vec<_>>();
        let found = vec![("volts.value".to_owned(), 12.345_678_9, "V".to_owned())];
        let began = Began { found, rest: Rest { undetermined: names(6), ..Rest::default() } };
        assert_eq!(
            began.text(),
            "in a steady state; `volts.value` = 12.34568 V; not determined, near what is written: `a0.x`, `a1.x`, `a2.x`, \
             `a3.x`, `a4.x` and 1 more"
        );
        assert_eq!(began.json()["found"][0]["unit"], "V");
    }
}
