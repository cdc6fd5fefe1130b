//! The diagram as the solver sees it: dx/dt = f(t, x).

use blocksim_solve::{Failed, System};

use crate::evaluation::evaluate::Diagram;
use crate::program::influence::influence;

impl System for Diagram {
    fn dimension(&self) -> usize {
        self.now.x.len()
    }

    fn derivatives(&mut self, t: f64, x: &[f64], dx: &mut [f64]) -> Result<(), Failed> {
        if self.derive_directly(t, x, dx) {
            return Ok(());
        }
        self.minor(t, x)?;
        self.derive(dx)?;
        self.look(t);
        Ok(())
    }

    fn step(&mut self, t: f64, t1: f64, h: f64, x: &mut [f64]) -> bool {
        self.step_wholly(t, t1, h, x)
    }

    fn influence(&self) -> Option<Vec<Vec<usize>>> {
        influence(&self.schedule)
    }

    fn along(&mut self, t: f64, x: &[f64], direction: &[f64], change: &mut [f64]) -> bool {
        let Self { plan, signals, d, .. } = self;
        let Some(slopes) = &plan.fused.slopes else { return false };
        plan.fused.place(t, x, signals);
        slopes.run(signals, d, direction, change)
    }

    fn prepare(&mut self, t: f64, x: &[f64], hg: f64) -> Result<(), Failed> {
        self.minor(t, x)?;
        if !self.now.derived {
            // Blocks are promised that their derivatives come first.
            let mut unused = std::mem::take(&mut self.unused);
            let derived = self.derive(&mut unused);
            self.unused = unused;
            derived?;
        }
        for i in 0..self.plan.implicit.len() {
            let block = self.plan.implicit[i];
            let Self { plan, now, signals, d, scratch, .. } = self;
            let unit = &plan.units[block];
            let c = now.context(unit, signals, &d[unit.d.range()]);
            unit.block.prepare(&c, hg, &mut scratch[block]);
            self.checked(block)?;
        }
        Ok(())
    }

    fn solve(&mut self, r: &mut [f64]) {
        for &block in &self.plan.implicit {
            let unit = &self.plan.units[block];
            unit.block.solve(&mut self.scratch[block], &mut r[unit.x.range()]);
        }
    }
}
