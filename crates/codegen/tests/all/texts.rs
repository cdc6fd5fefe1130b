//! The code as it is read.

use expect_test::expect;

use crate::support::{Loop, every, text_of, told};

#[test]
fn a_small_part() {
    let main = r#"Diagram(
    title: "Small",
    simulation: (stop_time: "0.1 s"),
    blocks: {
        "source": Sine(amplitude: "2 V", frequency: "1 Hz"),
        "control": Subsystem(file: "control.ron"),
        "show": Scope(inputs: ["y"]),
    },
    connections: ["source.y -> control.voltage", "control.y -> show.y"],
)"#;
    let control = r#"Diagram(
    inputs: { "voltage": (unit: "V") },
    outputs: { "y": "limit.y", "is high": "high.y" },
    blocks: {
        "late": UnitDelay(ts: "2 ms"),
        "limit": Saturation(lower: "-1 V", upper: "1.5 V"),
        "high": Compare(operator: Greater, constant: "1 V"),
    },
    connections: ["in.voltage -> late.u, high.u", "late.y -> limit.u"],
)"#
    .replace("is high", "is_high");
    let made = Loop::new(main, &control)
        .export(&every(1e-3))
        .unwrap_or_else(|problems| panic!("{}", told(&problems)));
    expect![[r#"
        /* control of the diagram "Small", a step of 0.001 s.
         *
         * Made by blocksim. Call control_init once, then control_step every 0.001 s. All values are in SI units.
         * There are no globals and no allocation; each control_State is an instance of its own. */
        #ifndef CONTROL_H
        #define CONTROL_H

        #include <stdbool.h>
        #include <stdint.h>

        typedef struct {
            double voltage; /* unit V; in the diagram source.y */
        } control_Inputs;

        typedef struct {
            double y; /* unit V; in the diagram control/limit.y */
            bool is_high; /* true or false; in the diagram control/high.y */
        } control_Outputs;

        /* What is kept from step to step. */
        typedef struct {
            uint64_t step; /* number of steps made */
            uint32_t wait_0_002_s; /* steps to the next sample */
            double late_x_0; /* late.x[0] */
            double high_y; /* signal high.y */
            double late_y; /* signal late.y */
            double limit_y; /* signal limit.y */
        } control_State;

        /* The state at the start. */
        void control_init(control_State *self);

        /* One step: outputs from inputs and state, then the state of the next step. Returns 0. */
        int control_step(control_State *self, const control_Inputs *in, control_Outputs *out);

        #endif
    "#]].assert_eq(&text_of(&made, ".h"));
    expect![[r#"
        /* control of the diagram "Small". Made by blocksim; compile it without contraction of products and sums
         * (-ffp-contract=off), so that it gives the same bits everywhere. */
        #include "control.h"

        /* What is not a number stays so. */
        static double clamp(double u, double lower, double upper)
        {
            return u > upper ? upper : (u < lower ? lower : u);
        }

        void control_init(control_State *self)
        {
            self->step = 0u;
            self->wait_0_002_s = 0u;
            self->late_x_0 = 0.0;
            self->high_y = 0.0;
            self->late_y = 0.0;
            self->limit_y = 0.0;
        }

        int control_step(control_State *self, const control_Inputs *in, control_Outputs *out)
        {
            int status = 0;
            if (self->wait_0_002_s == 0u) {
                self->late_y = self->late_x_0;
            }
            {
                /* limit (Saturation) */
                const double v0 = clamp(self->late_y, -1.0, 1.5);
                /* high (Compare) */
                const bool v1 = in->voltage > 1.0;
                self->limit_y = v0;
                self->high_y = (double)v1;
            }
            if (self->wait_0_002_s == 0u) {
                self->late_x_0 = in->voltage;
            }
            out->y = self->limit_y;
            out->is_high = (self->high_y != 0.0);
            self->wait_0_002_s = self->wait_0_002_s == 0u ? 1u : self->wait_0_002_s - 1u;
            self->step += 1u;
            return status;
        }
    "#]].assert_eq(&text_of(&made, ".c"));
}
