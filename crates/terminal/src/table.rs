//! A text table.

/// On which side the cells of a column are aligned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// Words.
    Left,
    /// Numbers; give them the same number of decimals and the points stand below each other.
    Right,
}

/// Widest column that others are aligned behind. A longer cell, such as a damaged text, stands out whole.
const WIDEST: usize = 300;

/// Rows under headings, two spaces between columns, no lines.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Table {
    columns: Vec<(String, Align)>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with these headings; headings may be empty.
    pub fn new(columns: &[(&str, Align)]) -> Table {
        let columns = columns.iter().map(|&(heading, align)| (heading.to_owned(), align)).collect();
        Table { columns, rows: Vec::new() }
    }

    /// Adds a row. Missing cells are empty, cells beyond the last column are left out.
    pub fn row(&mut self, cells: impl IntoIterator<Item = impl Into<String>>) {
        let mut row: Vec<String> = cells.into_iter().map(Into::into).collect();
        row.resize(self.columns.len(), String::new());
        self.rows.push(row);
    }

    /// Adds an empty line.
    pub fn gap(&mut self) {
        self.row([""; 0]);
    }

    /// The table as text, each line ending in a line feed.
    pub fn render(&self) -> String {
        let headings: Vec<String> = self.columns.iter().map(|(heading, _)| heading.clone()).collect();
        let lines = || std::iter::once(&headings).chain(&self.rows);
        let width =
            |column: usize| lines().map(|row| row[column].chars().count()).max().unwrap_or(0).min(WIDEST);
        let widths: Vec<usize> = (0..self.columns.len()).map(width).collect();

        let mut text = String::new();
        let without = usize::from(headings.iter().all(String::is_empty));
        for row in lines().skip(without) {
            let cells: Vec<String> = row
                .iter()
                .zip(&widths)
                .zip(&self.columns)
                .map(|((cell, &width), (_, align))| match align {
                    Align::Left => format!("{cell:<width$}"),
                    Align::Right => format!("{cell:>width$}"),
                })
                .collect();
            text.push_str(cells.join("  ").trim_end());
            text.push('\n');
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use expect_test::expect;

    #[test]
    fn numbers_stand_right_and_words_left() {
        let mut table = Table::new(&[("axis", Align::Left), ("T_acc [s]", Align::Right), ("", Align::Left)]);
        table.row(["joint 1", "0.367", "leads"]);
        table.row(["joint 10", "-12.000"]);
        table.row(["größer", "3.000", "", "left out"]);
        expect![[r#"
            axis      T_acc [s]
            joint 1       0.367  leads
            joint 10    -12.000
            größer        3.000
        "#]]
        .assert_eq(&table.render());
    }

    #[test]
    fn a_gap_is_an_empty_line_between_rows_of_the_same_columns() {
        let mut table = Table::new(&[("", Align::Left), ("", Align::Right)]);
        table.row(["a", "1"]);
        table.gap();
        table.row(["b", "12"]);
        assert_eq!(table.render(), "a   1\n\nb  12\n");
    }

    #[test]
    fn a_very_long_cell_is_printed_whole_and_the_others_stay_short() {
        let mut table = Table::new(&[("", Align::Left), ("", Align::Right), ("", Align::Left)]);
        let long = "x".repeat(100_000);
        table.row([long.as_str(), long.as_str(), "end"]);
        table.row(["a", "1", "end"]);
        let text = table.render();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[0], format!("{long}  {long}  end"));
        assert_eq!(lines[1].len(), 2 * WIDEST + 4 + 3);
    }

    #[test]
    fn a_table_of_nothing_is_nothing() {
        assert_eq!(Table::default().render(), "");
        assert_eq!(Table::new(&[("", Align::Left)]).render(), "");
    }
}
