//! A run of a plug-in allocates nothing. A program of its own, because all that it does goes through an allocator that counts.

#[path = "all/common/mod.rs"]
mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use blocksim_block::{Block, Context, Fault, Scratch};
use common::{built, here, load, set, with_unit};

/// Counts the allocations of this thread.
struct Counting;

thread_local!(static COUNT: Cell<usize> = const { Cell::new(0) });

// SAFETY: hands everything to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        COUNT.set(COUNT.get() + 1);
        // SAFETY: as the caller says.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        // SAFETY: as the caller says.
        unsafe { System.dealloc(at, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn outputs_and_updates_do_not_allocate() {
    let library = built("blocksim_plugin_cascade");
    let block = load(&here(), &library, "Cascade", set([("w1", with_unit(4.0, "rad/s"))])).unwrap();
    let inputs = [(0, 1), (1, 2), (2, 3), (3, 4), (4, 5), (5, 6)];
    let (fault, mut scratch) = (Fault::default(), Scratch::default());
    let (mut d, mut y, mut u) = ([0.0; 3], [0.0], [0.0; 6]);
    fn context<'a>(u: &'a [f64], d: &'a [f64], inputs: &'a [(u32, u32)], fault: &'a Fault) -> Context<'a> {
        Context {
            t: 0.0,
            x: &[],
            d,
            u,
            inputs,
            outputs: &[(0, 1)],
            evaluation: 0,
            resolution: blocksim_block::Resolution::default(),
            seed: 0,
            fault,
        }
    }
    block.initialize(&context(&[], &[], &[], &fault), &mut [], &mut d);
    let before = COUNT.get();
    for k in 0..1000 {
        u[0] = 1e-3 * f64::from(k);
        block.outputs(0, &context(&u, &d, &inputs, &fault), &mut scratch, &mut y);
        block.update(&context(&u, &[], &inputs, &fault), &mut Scratch::default(), &mut d);
    }
    assert_eq!(COUNT.get() - before, 0);
    assert!(!fault.is_raised() && y[0] == 1.0, "{y:?}");
}
