use blocksim_block::prelude::*;

use super::interval::{
    Extrapolation, Kinks, below, bends, enough, in_interval, mix, recorded_below, recorded_mix,
    recorded_share, share,
};
use crate::continuous::units::{agrees, element};

/// Looks a value up in a table with rows and columns, bilinearly: $y = f(u_1, u_2)$ with
/// $f(\mathrm{rows}_i, \mathrm{columns}_j) = \mathrm{table}_{ij}$.
///
/// In each cell of the table, with the shares $s = (u_1 - r_i)/(r_{i+1} - r_i)$ and
/// $t = (u_2 - c_j)/(c_{j+1} - c_j)$,
///
/// $$ y = (1-s)(1-t)\,z_{ij} + (1-s)\,t\,z_{i,j+1} + s(1-t)\,z_{i+1,j} + s\,t\,z_{i+1,j+1} $$
///
/// At the breakpoints the values are exact. Beyond the ends the cells at the border are continued, or the inputs
/// clipped with `extrapolation: Clip`. The solver steps onto the kinks at rows and columns. The output has the unit of
/// `table`. Direct feedthrough; vectors are looked up element by element.
///
/// ```ron
/// LookupTable2D(rows: [1.0, 2.0, 3.0], columns: [1.0, 2.0, 3.0],
///     table: [[4.0, 5.0, 6.0], [16.0, 19.0, 20.0], [10.0, 18.0, 23.0]])
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Lookup", symbol = Curve(Table))]
pub struct LookupTable2D {
    /// Values of `u1`, strictly increasing, one for each row.
    #[block(not_empty, finite, increasing, remedy = "sort the breakpoints and name each only once")]
    pub rows: Vec<f64>,
    /// Values of `u2`, strictly increasing, one for each column.
    #[block(not_empty, finite, increasing, remedy = "sort the breakpoints and name each only once")]
    pub columns: Vec<f64>,
    /// Values of the output, a list of rows.
    #[block(finite, as_many_as = rows)]
    pub table: Vec<Vec<f64>>,
    /// `Clip` or `Linear`.
    #[block(default = Extrapolation::Linear)]
    pub extrapolation: Extrapolation,
}

/// Guards of an element: the next row and column above, the next below.
const GUARDS: usize = 4;

/// Most values of a table that is a law: in a larger one the place of a value is searched for.
const FEW: usize = 64;

impl LookupTable2D {
    /// Whether the slope across breakpoint `i` of an axis changes there, `value(i, k)` being the `k`th of `lines` values at it.
    fn has_kink(&self, axis: &[f64], lines: usize, i: usize, value: impl Fn(usize, usize) -> f64) -> bool {
        let clip = self.extrapolation == Extrapolation::Clip;
        let slope = |i: usize, k: usize| (value(i + 1, k) - value(i, k)) / (axis[i + 1] - axis[i]);
        let last = axis.len() - 1;
        let outside = |slope: f64| if clip { 0.0 } else { slope };
        let slopes = |k: usize| match i {
            _ if last == 0 => [0.0; 2],
            0 => [outside(slope(0, k)), slope(0, k)],
            i if i == last => [slope(last - 1, k), outside(slope(last - 1, k))],
            i => [slope(i - 1, k), slope(i, k)],
        };
        (0..lines).any(|k| {
            let [before, after] = slopes(k);
            bends(before, after, axis, i, value(i, k))
        })
    }

    fn kinks_of_rows(&self) -> Kinks<'_, impl Fn(usize) -> bool> {
        let is_kink = |i| self.has_kink(&self.rows, self.columns.len(), i, |i, k| self.table[i][k]);
        Kinks { breakpoints: &self.rows, is_kink }
    }

    fn kinks_of_columns(&self) -> Kinks<'_, impl Fn(usize) -> bool> {
        let is_kink = |j| self.has_kink(&self.columns, self.rows.len(), j, |j, k| self.table[k][j]);
        Kinks { breakpoints: &self.columns, is_kink }
    }

    fn value(&self, u1: f64, u2: f64) -> f64 {
        let (i, s) = share(&self.rows, u1, self.extrapolation);
        let (j, t) = share(&self.columns, u2, self.extrapolation);
        let along = |row: &[f64]| mix(row[j], row[(j + 1).min(row.len() - 1)], t);
        mix(along(&self.table[i]), along(&self.table[(i + 1).min(self.table.len() - 1)]), s)
    }

    fn validate(&self, errors: &mut ParamErrors) {
        enough("rows", &self.rows, self.extrapolation, errors);
        enough("columns", &self.columns, self.extrapolation, errors);
        let n = self.columns.len();
        for (i, row) in self.table.iter().enumerate().filter(|(_, row)| row.len() != n) {
            let message = format!("row {i} of `table` has {} values, but `columns` has {n}", row.len());
            let error = ParamError::new(format!("table[{i}]"), message).beside(&["columns"]);
            errors.add(error.help("give one value for each value of `columns`"));
        }
    }
}

impl Block for LookupTable2D {
    fn interface(&self, given: &Given) -> Result<Interface, InterfaceError> {
        agrees(given, "rows", "u1", given.input_or_unknown("u1").dimension)?;
        agrees(given, "columns", "u2", given.input_or_unknown("u2").dimension)?;
        let shape = given.common_shape(&["u1", "u2"], &[])?;
        let y = PortType::UNKNOWN.shaped(shape).of(Some(given.parameters.get("table")));
        let n = y.shape.len();
        let mut interface = Interface::new()
            .input(Input::real("u1").doc("Chooses between rows."))
            .input(Input::real("u2").doc("Chooses between columns."))
            .output(Output::like("y", y));
        if self.kinks_of_rows().any() || self.kinks_of_columns().any() {
            interface = interface.settles().memory("row", n, 0.0).memory("column", n, 0.0);
            for detail in (0..n).map(|i| (n > 1).then(|| format!("element {i}"))) {
                for name in ["row above", "row below"] {
                    interface = interface.kink(name).detail(detail.clone());
                }
                interface = interface.called("passes a row upwards", "passes a row downwards");
                for name in ["column above", "column below"] {
                    interface = interface.kink(name).detail(detail.clone());
                }
                interface = interface.called("passes a column upwards", "passes a column downwards");
            }
        }
        Ok(interface)
    }

    /// Tables of few values; all others are called.
    fn law(&self, l: &Recording) -> bool {
        let (rows, columns) = (&self.rows, &self.columns);
        if rows.len() < 2 || columns.len() < 2 || rows.len() * columns.len() > FEW {
            return false;
        }
        let n = l.width(0);
        for i in 0..n {
            let (u1, u2) = (l.element(0, i), l.element(1, i));
            let s = recorded_share(l, rows, u1, self.extrapolation);
            let t = recorded_share(l, columns, u2, self.extrapolation);
            let along: Vec<Value> = self
                .table
                .iter()
                .map(|row| {
                    let ends = [0, 1].map(|side| in_interval(l, columns, u2, |j| l.constant(row[j + side])));
                    recorded_mix(ends[0], ends[1], t)
                })
                .collect();
            let [low, high] = [0, 1].map(|side| in_interval(l, rows, u1, |i| along[i + side]));
            l.set(0, i, recorded_mix(low, high, s));
            if l.guards() > 0 {
                let of_rows = self.kinks_of_rows().recorded(l, u1, l.d()[i]);
                let of_columns = self.kinks_of_columns().recorded(l, u2, l.d()[n + i]);
                let guards = of_rows.into_iter().chain(of_columns).enumerate();
                guards.for_each(|(k, guard)| l.guard(GUARDS * i + k, guard));
                l.settle(i, recorded_below(l, rows, u1));
                l.settle(n + i, recorded_below(l, columns, u2));
            }
        }
        true
    }

    /// In which cell the inputs are; guards alone read that.
    fn settle(&self, c: &Context, d: &mut [f64]) {
        let (rows, columns) = d.split_at_mut(d.len() / 2);
        for (i, (row, column)) in rows.iter_mut().zip(columns).enumerate() {
            *row = below(&self.rows, element(c.input(0), i)) as f64;
            *column = below(&self.columns, element(c.input(1), i)) as f64;
        }
    }

    fn guards(&self, c: &Context, _w: &mut Scratch, g: &mut [f64]) {
        let (rows, columns) = c.d.split_at(c.d.len() / 2);
        for (i, g) in g.chunks_exact_mut(GUARDS).enumerate() {
            let [u1, u2] = [element(c.input(0), i), element(c.input(1), i)];
            g[..2].copy_from_slice(&self.kinks_of_rows().around(rows[i] as usize, u1));
            g[2..].copy_from_slice(&self.kinks_of_columns().around(columns[i] as usize, u2));
        }
    }

    fn outputs(&self, _group: usize, c: &Context, _w: &mut Scratch, y: &mut [f64]) {
        for (i, y) in y.iter_mut().enumerate() {
            *y = self.value(element(c.input(0), i), element(c.input(1), i));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::continuous::units::testing::{interface_with, output_unit};
    use blocksim_block::testing::Bench;

    fn block(extrapolation: Extrapolation) -> LookupTable2D {
        LookupTable2D {
            rows: vec![1.0, 2.0, 3.0],
            columns: vec![1.0, 2.0, 4.0],
            table: vec![vec![4.0, 5.0, 6.0], vec![16.0, 19.0, 20.0], vec![10.0, 18.0, 23.0]],
            extrapolation,
        }
    }

    fn value(block: &LookupTable2D, u1: f64, u2: f64) -> f64 {
        Bench::new(block.clone()).set(0, &[u1]).set(1, &[u2]).major()[0]
    }

    #[test]
    fn values_at_breakpoints_are_exact() {
        for extrapolation in [Extrapolation::Clip, Extrapolation::Linear] {
            let block = block(extrapolation);
            for (i, row) in block.rows.iter().enumerate() {
                for (j, column) in block.columns.iter().enumerate() {
                    assert_eq!(value(&block, *row, *column), block.table[i][j]);
                }
            }
        }
    }

    #[test]
    fn the_law_leaves_the_bits_of_the_search() {
        for extrapolation in [Extrapolation::Clip, Extrapolation::Linear] {
            let block = block(extrapolation);
            let mut bench = Bench::new(block.clone());
            for k in 0..500 {
                // Inside, at breakpoints and beyond all borders.
                let (u1, u2) = (f64::from(k % 25) * 0.25 - 1.0, f64::from(k / 25) * 0.3 - 0.2);
                let y = bench.set(0, &[u1]).set(1, &[u2]).major()[0];
                assert_eq!(y.to_bits(), block.value(u1, u2).to_bits(), "f({u1}, {u2})");
                let [row, column] = [(&block.rows, u1), (&block.columns, u2)].map(|(axis, u)| below(axis, u));
                assert_eq!(bench.d, [row as f64, column as f64], "f({u1}, {u2})");
                let rows = block.kinks_of_rows().around(row, u1);
                assert_eq!(bench.guards(), [rows, block.kinks_of_columns().around(column, u2)].concat());
            }
        }
    }

    #[test]
    fn a_bilinear_function_is_met_inside_and_outside() {
        let f = |u: f64, v: f64| 2.0 + 3.0 * u - v + 0.5 * u * v;
        let axis = [-1.0, 0.0, 2.0];
        let table = axis.map(|u| axis.map(|v| f(u, v)).to_vec()).to_vec();
        let block = LookupTable2D {
            rows: axis.to_vec(),
            columns: axis.to_vec(),
            table,
            extrapolation: Extrapolation::Linear,
        };
        for (u, v) in [(0.5, 1.0), (-0.3, 1.7), (-3.0, 5.0), (4.0, -2.0)] {
            assert!((value(&block, u, v) - f(u, v)).abs() < 1e-13, "{u} {v}");
        }
    }

    #[test]
    fn a_clipped_table_stays_at_its_border() {
        let block = block(Extrapolation::Clip);
        assert_eq!(value(&block, 9.0, -9.0), 10.0);
        assert_eq!(value(&block, 1.5, 9.0), 13.0);
        let one = LookupTable2D { rows: vec![0.0], columns: vec![0.0], table: vec![vec![7.0]], ..block };
        assert_eq!(value(&one, 3.0, -3.0), 7.0);
    }

    #[test]
    fn what_is_not_a_number_stays_so() {
        for extrapolation in [Extrapolation::Clip, Extrapolation::Linear] {
            assert!(value(&block(extrapolation), f64::NAN, 1.0).is_nan());
            assert!(value(&block(extrapolation), 1.0, f64::NAN).is_nan());
        }
    }

    #[test]
    fn the_guards_are_distances_to_the_kinks_around_the_cell() {
        let mut bench = Bench::new(block(Extrapolation::Clip));
        bench.set(0, &[1.5]).set(1, &[3.0]).major();
        assert_eq!(bench.guards(), [-0.5, 0.5, -1.0, 1.0]);
        // Held until the next instant, however far the inputs go.
        assert_eq!(bench.set(0, &[9.0]).set(1, &[0.0]).guards(), [7.0, 8.0, -4.0, -2.0]);
        let mut bench = Bench::new(block(Extrapolation::Linear));
        bench.set(0, &[1.5]).set(1, &[3.0]).major();
        assert_eq!(bench.guards(), [-0.5, 1.0, -1.0, 1.0], "without ends");
        let plane = LookupTable2D {
            table: (0..3).map(|i| [1.0, 2.0, 4.0].map(|c| 2.0 * c + f64::from(i)).to_vec()).collect(),
            ..block(Extrapolation::Linear)
        };
        assert!(interface_with(&plane, &[], &[]).unwrap().guards.is_empty());
    }

    #[test]
    fn a_scalar_goes_with_a_vector() {
        let inputs = vec![("u1".to_owned(), PortType::vector(2)), ("u2".to_owned(), PortType::scalar())];
        let mut bench = Bench::with_inputs(block(Extrapolation::Clip), inputs);
        assert_eq!(bench.set(0, &[1.0, 3.0]).set(1, &[2.0]).major(), [5.0, 18.0]);
    }

    #[test]
    fn units_are_those_of_the_table_and_the_breakpoints() {
        let block = block(Extrapolation::Clip);
        assert_eq!(output_unit(&block, &[("u1", "V")], &[("table", "N")]), "N");
        assert!(interface_with(&block, &[("u2", "V")], &[("columns", "A")]).is_err());
    }

    #[test]
    fn tables_of_the_wrong_size_are_refused() {
        let block = || block(Extrapolation::Linear);
        let short = LookupTable2D { table: vec![vec![1.0; 3], vec![1.0; 2], vec![1.0; 3]], ..block() };
        let refused = [
            (LookupTable2D { rows: vec![1.0, 1.0, 2.0], ..block() }, "rows[1]"),
            (LookupTable2D { columns: vec![1.0], ..block() }, "columns"),
            (LookupTable2D { table: vec![vec![1.0; 3]], ..block() }, "table"),
            (short, "table[1]"),
        ];
        for (block, param) in refused {
            assert_eq!(block.errors()[0].param, param);
        }
    }
}
