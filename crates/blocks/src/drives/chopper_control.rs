use crate::math::elements::ON_OFF;
use blocksim_block::prelude::*;

/// Gate of a brake chopper: on while the voltage of the DC link is too high, with hysteresis.
///
/// On when $v_{dc} \ge$ `on_at`, off when $v_{dc} \le$ `off_at`, in between as before; off at the start unless the voltage
/// is at `on_at` or above. The solver stops where the voltage reaches the point that matters.
///
/// A machine that brakes feeds its power into the DC link. If only a rectifier feeds the link, its capacitor takes it
/// all, and the voltage rises until the chopper sends it into a resistor.
///
/// ```ron
/// ChopperControl(on_at: "700 V", off_at: "680 V")
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Drives", symbol = Curve(Relay))]
pub struct ChopperControl {
    /// Voltage at which the chopper is turned on.
    #[block(unit = "V", finite)]
    pub on_at: f64,
    /// Voltage at which it is turned off; less than `on_at`.
    #[block(
        unit = "V", finite, below = on_at,
        remedy = "without a distance between them the chopper switches without end",
    )]
    pub off_at: f64,
}

impl Block for ChopperControl {
    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        Ok(Interface::new()
            .input(Input::real("vdc").scalar().unit("V").doc("voltage of the DC link"))
            .output(Output::boolean("gate").doc("of the switch of the chopper"))
            .modes("on", 1, 0.0, ON_OFF)
            .guard("switches")
            .called_by_mode())
    }

    fn law(&self, l: &Recording) -> bool {
        let (vdc, on) = (l.u(0), l.d()[0]);
        let [on_at, off_at] = [self.on_at, self.off_at].map(|level| l.constant(level));
        let stays = vdc.live(Relation::LessEqual, off_at).select(l.constant(0.0), on);
        l.settle(0, vdc.live(Relation::GreaterEqual, on_at).select(l.constant(1.0), stays));
        l.set(0, 0, on);
        l.guard(0, vdc - on.is_true().select(off_at, on_at));
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use blocksim_block::testing::Bench;

    const CHOPPER: ChopperControl = ChopperControl { on_at: 700.0, off_at: 680.0 };

    #[test]
    fn it_walks_round_the_hysteresis() {
        let mut bench = Bench::new(CHOPPER);
        for (v, on) in [(690.0, 0.0), (700.0, 1.0), (690.0, 1.0), (680.0, 0.0), (699.9, 0.0), (750.0, 1.0)] {
            assert_eq!(bench.respond(v), on, "{v} V");
        }
        assert_eq!(bench.guards(), [70.0]);
        assert_eq!(bench.interface.outputs[0].port_type.kind, Kind::Bool);
    }

    #[test]
    fn the_points_keep_a_distance() {
        let error = ChopperControl { off_at: 700.0, ..CHOPPER }.errors()[0].clone();
        assert_eq!(error.param, "off_at");
        assert_eq!(ChopperControl { on_at: f64::INFINITY, ..CHOPPER }.errors()[0].param, "on_at");
    }
}
