//! Dots in the cells of a terminal.

/// Signs of the series without braille, in their order.
pub(crate) const MARKS: [char; 8] = ['*', '+', 'o', 'x', '#', '@', '%', '&'];

/// Bits of the dots of a braille sign, by row and column; sign = U+2800 + bits.
const BRAILLE: [[u8; 2]; 4] = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]];

/// A drawing area of `columns` × `rows` cells, each of 2 × 4 dots in braille or of one in ASCII.
pub(crate) struct Canvas {
    columns: usize,
    rows: usize,
    ascii: bool,
    /// Per cell: bits of the dots in braille; 1 + series in ASCII; 0 where nothing is drawn.
    cells: Vec<u8>,
}

impl Canvas {
    pub fn new(columns: usize, rows: usize, ascii: bool) -> Canvas {
        Canvas { columns, rows, ascii, cells: vec![0; columns * rows] }
    }

    /// Dots across.
    pub fn width(&self) -> usize {
        self.columns * if self.ascii { 1 } else { 2 }
    }

    /// Dots down.
    pub fn height(&self) -> usize {
        self.rows * if self.ascii { 1 } else { 4 }
    }

    /// Row of cells in which a row of dots lies.
    pub fn row_of(&self, y: usize) -> usize {
        y * self.rows / self.height()
    }

    fn dot(&mut self, x: usize, y: usize, series: usize) {
        let (bit, column, row) = if self.ascii {
            ((series % MARKS.len()) as u8 + 1, x, y)
        } else {
            (BRAILLE[y % 4][x % 2], x / 2, y / 4)
        };
        if column < self.columns && row < self.rows {
            let cell = &mut self.cells[row * self.columns + column];
            *cell = if self.ascii { bit } else { *cell | bit };
        }
    }

    /// A straight line, both ends included (Bresenham).
    pub fn line(&mut self, from: (usize, usize), to: (usize, usize), series: usize) {
        let (dx, dy) = (from.0.abs_diff(to.0) as i64, from.1.abs_diff(to.1) as i64);
        let towards = |at: usize, end: usize| if at < end { at + 1 } else { at.saturating_sub(1) };
        let (mut x, mut y) = from;
        let mut error = dx - dy;
        loop {
            self.dot(x, y, series);
            if (x, y) == to {
                return;
            }
            let twice = 2 * error;
            if twice >= -dy && x != to.0 {
                error -= dy;
                x = towards(x, to.0);
            }
            if twice <= dx && y != to.1 {
                error += dx;
                y = towards(y, to.1);
            }
        }
    }

    /// The signs of a row of cells.
    pub fn row(&self, row: usize) -> impl Iterator<Item = char> {
        let sign = |&cell: &u8| match (cell, self.ascii) {
            (0, _) => ' ',
            (n, true) => MARKS[usize::from(n) - 1],
            (bits, false) => char::from_u32(0x2800 + u32::from(bits)).unwrap_or(' '),
        };
        self.cells[row * self.columns..(row + 1) * self.columns].iter().map(sign)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dots_fall_into_the_bits_of_braille() {
        let mut canvas = Canvas::new(1, 1, false);
        for (y, row) in BRAILLE.iter().enumerate() {
            for x in 0..row.len() {
                canvas.dot(x, y, 0);
            }
        }
        assert_eq!(canvas.row(0).collect::<String>(), "⣿");
    }

    #[test]
    fn lines_have_both_ends_and_no_holes_in_any_direction() {
        for to in [(0, 0), (8, 0), (0, 8), (8, 8), (4, 0), (8, 5), (3, 8), (0, 3), (4, 4)] {
            let mut canvas = Canvas::new(9, 9, true);
            canvas.line((4, 4), to, 0);
            let drawn = canvas.cells.iter().filter(|&&c| c > 0).count();
            let longest = to.0.abs_diff(4).max(to.1.abs_diff(4));
            assert_eq!(drawn, longest + 1, "to {to:?}");
            assert!(canvas.cells[to.1 * 9 + to.0] > 0 && canvas.cells[4 * 9 + 4] > 0);
        }
    }
}
