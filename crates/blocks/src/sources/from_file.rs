use super::course::{After, Course};
use super::table::{Fault, parse};
use blocksim_block::prelude::*;

/// Signals over time from a file of comma-separated values, with straight lines in between.
///
/// The first line is a header that names columns and units; the first column is the time:
///
/// ```text
/// time [s],q1 [deg],q2 [deg]
/// 0.0,0,0
/// 0.5,90,-45
/// ```
///
/// Two lines of equal time are a jump: the former holds until then, the latter from then on. The solver steps exactly
/// onto each line. Before the first line its values hold. Several columns make a vector.
///
/// ```ron
/// FromFile(file: "reference.csv", columns: ["q1"], after: Hold)
/// ```
#[derive(Debug, Clone, BlockMeta)]
#[block(category = "Sources", symbol = Curve(Record))]
pub struct FromFile {
    /// Path of the file, relative to the diagram.
    pub file: String,
    /// Names of the columns to read; all if empty.
    #[block(default = Vec::new())]
    pub columns: Vec<String>,
    /// What follows the last line: `Hold` its values, `Extrapolate` the last straight line, `Zero`, or `Cyclic`: the
    /// whole again.
    #[block(default = After::Hold)]
    pub after: After,
    /// What was read.
    #[block(skip)]
    course: Course,
}

impl FromFile {
    fn error(&self, param: &'static str, code: &'static str, fault: Fault) -> LoadError {
        LoadError { param, code, message: format!("`{}`: {}", self.file, fault.message), help: fault.help }
    }
}

impl Block for FromFile {
    fn load(&mut self, files: &dyn Files) -> Result<(), LoadError> {
        let text = files.read(&self.file).map_err(|reason| LoadError {
            param: "file",
            code: "missing_file",
            message: format!("cannot read `{}`: {reason}", self.file),
            help: Some("the path is relative to the diagram that names it".to_owned()),
        })?;
        let table = parse(&text).map_err(|fault| self.error("file", "table", fault))?;
        let table =
            table.select(&self.columns).map_err(|fault| self.error("columns", "unknown_column", fault))?;
        table.dimension().map_err(|fault| self.error("columns", "unit_mismatch", fault))?;
        if self.after == After::Cyclic && table.times.first() == table.times.last() {
            let message = "the lines span no time, so there is no cycle".to_owned();
            return Err(self.error("after", "table", Fault { message, help: None }));
        }
        self.course = Course { table, after: self.after, held: false };
        Ok(())
    }

    fn interface(&self, _given: &Given) -> Result<Interface, InterfaceError> {
        let n = self.course.table.columns.len().max(self.columns.len());
        let shape = if n > 1 { Shape::Vector(n) } else { Shape::Scalar };
        let dimension = self.course.table.dimension().ok().flatten();
        Ok(Course::declare(Interface::new().output(Output::real("y").shape(shape).dimension(dimension)), n))
    }

    fn settle(&self, c: &Context, d: &mut [f64]) {
        if !self.course.table.times.is_empty() {
            self.course.keep(c.t, d);
        }
    }

    fn law(&self, l: &Recording) -> bool {
        if self.course.table.times.is_empty() {
            return false;
        }
        Course::record(l);
        true
    }

    fn outputs(&self, _group: usize, c: &Context, _w: &mut Scratch, _y: &mut [f64]) {
        c.fail(format!("`{}` has not been read", self.file));
    }

    fn next_event(&self, c: &Context) -> f64 {
        self.course.next(c.t)
    }

    fn end_time(&self) -> Option<f64> {
        if self.after == After::Cyclic { None } else { self.course.table.times.last().copied() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::elements::dimension;
    use blocksim_block::testing::Bench;
    use std::path::Path;

    struct Text(&'static str);

    impl Files for Text {
        fn read(&self, path: &str) -> Result<String, String> {
            if path == "a.csv" { Ok(self.0.to_owned()) } else { Err(format!("cannot read `{path}`")) }
        }

        fn folder(&self) -> &Path {
            Path::new(".")
        }
    }

    fn block(columns: &[&str], after: After) -> FromFile {
        let columns = columns.iter().map(ToString::to_string).collect();
        FromFile { file: "a.csv".to_owned(), columns, after, course: Course::default() }
    }

    fn bench(text: &'static str, after: After) -> Bench {
        let mut block = block(&[], after);
        block.load(&Text(text)).unwrap();
        Bench::new(block)
    }

    fn at(bench: &mut Bench, t: f64) -> f64 {
        bench.t = t;
        bench.major()[0]
    }

    const TENT: &str = "time [s],v [V]\n1,0\n2,10\n4,4\n";

    #[test]
    fn between_lines_the_signal_is_straight() {
        let mut bench = bench(TENT, After::Hold);
        for (t, y) in [(0.0, 0.0), (1.0, 0.0), (1.25, 2.5), (2.0, 10.0), (3.0, 7.0), (4.0, 4.0)] {
            assert_eq!(at(&mut bench, t), y, "{t}");
        }
        assert_eq!(bench.interface.outputs[0].port_type.dimension, Some(dimension("V")));
    }

    #[test]
    fn four_ways_to_go_on_behind_the_end() {
        for (after, expected) in
            [(After::Hold, 4.0), (After::Extrapolate, 1.0), (After::Zero, 0.0), (After::Cyclic, 10.0)]
        {
            assert_eq!(at(&mut bench(TENT, after), 5.0), expected, "{after:?}");
        }
    }

    #[test]
    fn a_jump_is_exact_and_a_trial_step_onto_it_sees_the_value_before() {
        let mut bench = bench("time [s],v\n0,1\n2,3\n2,-5\n3,-5\n", After::Hold);
        assert_eq!(at(&mut bench, 1.0), 2.0);
        assert_eq!(bench.next_event(), 2.0);
        bench.t = 2.0;
        assert_eq!(bench.minor(), [3.0]);
        assert_eq!(bench.major(), [-5.0]);
        assert_eq!(bench.next_event(), 3.0);
        assert_eq!(at(&mut bench, 3.0), -5.0);
        assert_eq!(bench.next_event(), f64::INFINITY);
    }

    #[test]
    fn cycles_meet_every_line_for_ever() {
        let mut bench = bench("time [s],v\n0,0\n0.1,1\n0.3,0\n", After::Cyclic);
        for event in 0..2000 {
            let y = bench.major()[0];
            assert_eq!(y, f64::from(event % 2), "event {event} at {}", bench.t);
            let next = bench.next_event();
            assert!(next > bench.t);
            bench.t = next;
        }
        assert!((bench.t - 300.0).abs() < 1e-9, "{}", bench.t);
    }

    #[test]
    fn several_columns_make_a_vector() {
        let mut block = block(&["b", "a"], After::Hold);
        block.load(&Text("time [s],a [deg],b [rad]\n0,180,1\n1,180,2\n")).unwrap();
        let mut bench = Bench::new(block);
        bench.t = 0.5;
        assert_eq!(bench.major(), [1.5, std::f64::consts::PI]);
        assert_eq!(bench.interface.outputs[0].port_type.shape, Shape::Vector(2));
    }

    #[test]
    fn a_single_line_is_a_constant() {
        for after in [After::Hold, After::Extrapolate] {
            let mut bench = bench("time [s],v\n1,7\n", after);
            assert_eq!([at(&mut bench, 0.0), at(&mut bench, 1.0), at(&mut bench, 2.0)], [7.0; 3]);
        }
    }

    #[test]
    fn the_end_of_the_table_is_the_end_of_what_there_is_to_see() {
        assert_eq!(bench(TENT, After::Hold).next_event(), 1.0);
        let mut table = block(&[], After::Hold);
        table.load(&Text(TENT)).unwrap();
        assert_eq!(table.end_time(), Some(4.0));
        assert_eq!(FromFile { after: After::Cyclic, ..table }.end_time(), None);
    }

    #[test]
    fn faults_name_the_parameter_the_file_and_the_place() {
        let fault = |mut block: FromFile, text| block.load(&Text(text)).unwrap_err();
        let missing = FromFile { file: "b.csv".to_owned(), ..block(&[], After::Hold) };
        assert_eq!(fault(missing, TENT).code, "missing_file");
        let error = fault(block(&["w"], After::Hold), TENT);
        assert_eq!((error.param, error.message.as_str()), ("columns", "`a.csv`: there is no column `w`"));
        let error = fault(block(&[], After::Hold), "time [s],v\n0,x\n");
        assert_eq!(error.message, "`a.csv`: line 2, column 2 (`v`): `x` is not a number");
        assert_eq!(fault(block(&[], After::Hold), "time [s],a [V],b [A]\n0,1,2\n").code, "unit_mismatch");
        assert_eq!(fault(block(&[], After::Cyclic), "time [s],v\n0,1\n").param, "after");
    }
}
