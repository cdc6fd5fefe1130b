use crate::routing::names::validate_names;
use blocksim_block::RecordRequest;
use blocksim_block::prelude::*;
use blocksim_signal::Unit;

/// Records its inputs and shows them in one picture.
///
/// Signals of any kind and shape are recorded in SI units; `display` is only the unit in which they are shown.
///
/// `label` gives the picture a title, `legend` names the signals in it as people call them.
///
/// ```ron
/// Scope(inputs: ["set", "actual"], display: "deg", legend: ["set angle", "measured angle"])
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Sinks", symbol = Scope)]
pub struct Scope {
    /// Names of the inputs.
    #[block(default = vec!["u".to_owned()])]
    pub inputs: Vec<String>,
    /// Unit in which numbers are shown; SI without.
    #[block(a_unit, default = None)]
    pub display: Option<String>,
    /// A text for each input, for legends; the names of the inputs without.
    #[block(default = Vec::new())]
    pub legend: Vec<String>,
}

impl Scope {
    fn validate(&self, errors: &mut ParamErrors) {
        validate_names("inputs", self.inputs.iter().map(String::as_str), errors);
        if !self.legend.is_empty() && self.legend.len() != self.inputs.len() {
            let (texts, inputs) = (self.legend.len(), self.inputs.len());
            let error = ParamError::new("legend", format!("{texts} texts do not fit {inputs} inputs"));
            let help = "write one text for each input, in the same order, or leave `legend` away";
            errors.add(error.beside(&["inputs"]).help(help));
        }
    }
}

impl Block for Scope {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        let display = self.display.as_ref().and_then(|text| Unit::parse(text).ok());
        let mut interface = Interface::new();
        for name in &self.inputs {
            interface = interface.input(Input::any(name));
            let shown = given.input_or_unknown(name);
            if let (Some(unit), Some(dimension), Kind::Real) = (&display, shown.dimension, shown.kind)
                && !unit.dimension.compatible(dimension)
            {
                let message = format!("`{name}` is in {dimension}, which cannot be shown in {}", unit.text);
                return Err(InterfaceError::units(&[name], message)
                    .help("use one Scope for each unit, or leave `display` away"));
            }
        }
        Ok(interface.records(RecordRequest {
            display: self.display.clone(),
            legend: self.legend.clone(),
            ..RecordRequest::default()
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::given;

    fn scope(inputs: &[&str], display: Option<&str>) -> Scope {
        Scope {
            inputs: inputs.iter().map(ToString::to_string).collect(),
            display: display.map(str::to_owned),
            legend: Vec::new(),
        }
    }

    #[test]
    fn all_inputs_are_recorded_in_the_unit_of_display() {
        let interface = scope(&["set", "actual"], Some("deg")).interface(&Given::nothing()).unwrap();
        let names: Vec<_> = interface.inputs.iter().map(|input| input.name.as_str()).collect();
        assert_eq!(names, ["set", "actual"]);
        assert_eq!(interface.recorded.unwrap().display.as_deref(), Some("deg"));
    }

    #[test]
    fn volts_are_not_shown_in_degrees() {
        let scope = scope(&["set", "actual"], Some("deg"));
        let error = scope.interface(&given(&[("set", "rad"), ("actual", "V")], &[])).unwrap_err();
        assert_eq!((error.code, error.ports), ("unit_mismatch", vec!["actual".to_owned()]));
    }

    #[test]
    fn truth_values_are_shown_beside_anything() {
        let inputs = vec![("set".to_owned(), PortType::boolean())];
        assert!(scope(&["set"], Some("V")).interface(&Given::new(inputs, Default::default())).is_ok());
    }

    #[test]
    fn names_and_unit_must_make_sense() {
        assert_eq!(scope(&[], None).errors()[0].param, "inputs");
        assert_eq!(scope(&["a", "a"], None).errors()[0].param, "inputs[1]");
        assert_eq!(scope(&["a"], Some("degg")).errors()[0].param, "display");
        assert!(scope(&["a"], Some("deg")).errors().is_empty());
    }

    #[test]
    fn a_legend_has_a_text_for_each_input() {
        let with = |legend: &[&str]| Scope {
            legend: legend.iter().map(ToString::to_string).collect(),
            ..scope(&["set", "actual"], None)
        };
        assert!(with(&["Sollwert", "Istwert"]).errors().is_empty());
        let error = with(&["Sollwert"]).errors()[0].clone();
        assert_eq!((error.param.as_str(), error.message.as_str()), ("legend", "1 texts do not fit 2 inputs"));
        let interface = with(&["Sollwert", "Istwert"]).interface(&Given::nothing()).unwrap();
        assert_eq!(interface.recorded.unwrap().legend, ["Sollwert", "Istwert"]);
    }
}
