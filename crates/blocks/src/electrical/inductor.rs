use blocksim_block::physical::Element;
use blocksim_block::prelude::*;

/// Inductor: $v = L \frac{di}{dt}$. Its current is a state.
///
/// Currents of inductances that meet at a node where nothing else is connected cannot be independent: a resistance in
/// parallel to one of them, or an `Inductor` for both, avoids that.
///
/// ```ron
/// Inductor(l: "2.5 mH")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Electrical")]
pub struct Inductor {
    /// Inductance, positive.
    #[block(unit = "H")]
    pub l: f64,
    /// Current at the start, from `p` to `n`.
    #[block(unit = "A", default = 0.0)]
    pub i0: f64,
}

impl Block for Inductor {
    fn check(&self) -> Result<(), ParamError> {
        positive("l", self.l)?;
        finite("i0", self.i0)
    }

    fn component(&self) -> Option<&dyn Component> {
        Some(self)
    }
}

impl Component for Inductor {
    fn part(&self, _given: &Given) -> Part {
        let winding = Element::Winding { p: 0, n: 1, from_state: true };
        Part::new().pins().state("i", self.i0).element(winding).measures(
            "i",
            "A",
            Needs::State,
            "current from p to n",
        )
    }

    fn currents(&self, c: &Law, i: &mut [f64]) {
        i[0] = c.x[0];
    }

    fn derivatives(&self, c: &Law, dx: &mut [f64]) {
        dx[0] = c.voltage[0] / self.l;
    }

    fn measure(&self, c: &Law, _needs: Needs, y: &mut [f64]) {
        y[0] = c.x[0];
    }
}
