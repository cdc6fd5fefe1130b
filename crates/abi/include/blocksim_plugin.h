/* Generated from crates/abi/src/table.rs by the tests of that crate.

   The table of a controller plug-in, version 1.

   WHO OWNS WHAT
     The plug-in owns its tables and texts: constant, valid from loading to the end of the process.
     The host owns all numbers: parameters, signals, states, results, and the message buffer. The plug-in
     may touch them during a call only and keeps no pointer to them.
     The plug-in owns no state at all. Same arguments, same bits: no globals, no clock, no files, no
     random numbers. Rejected steps, saving, rewinding and parallel runs then work by themselves.

   WHAT A BUFFER HOLDS
     Numbers are f64 and always SI. A buffer holds the quantities of its list one after the other, vectors
     in place: after a scalar and a vector of 3, the next quantity begins at index 4. The length of a
     buffer is thus the sum of the lengths in its list; the pointer of an empty buffer may be NULL.
     Buffers of one call never overlap.

   PHASES, stated for each function
     load    the library was opened, the tables are read
     build   a diagram is compiled: the parameters are known
     start   a run begins
     run     the run goes on
     Functions may be called on any thread, and on several threads at once with different buffers.
     None may block; in `run` none should allocate.

   HOW IT GROWS
     Each struct but `text` begins with its own size in bytes as its author compiled it. New fields are
     added at the end only, with a higher minor version; a reader takes `size` bytes at most and treats
     the rest as zero. In an array, the size of the first element is the distance between elements.
     A change of any other kind gets a new major version and a new symbol.
*/
#ifndef BLOCKSIM_PLUGIN_H
#define BLOCKSIM_PLUGIN_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The function that a library exports: see `entry_fn`. */
#define BLOCKSIM_SYMBOL "blocksim_plugin_v1"

/* In every plug-in table, so that another library with such a symbol is not taken for a plug-in. */
#define BLOCKSIM_MAGIC {'B', 'L', 'K', 'S', 'I', 'M', 'P', '1'}

/* Compatibility: the host refuses another major version. */
#define BLOCKSIM_ABI_MAJOR 1

/* Fields known: the host takes lower and higher minor versions. */
#define BLOCKSIM_ABI_MINOR 0

/* The most input ports a block can have, as `reads` has a bit for each. */
#define BLOCKSIM_MAX_INPUTS 64

/* What a function reports. The host treats any number it does not know as an error. */
typedef int32_t blocksim_status;

/* Done; all results are written. */
#define BLOCKSIM_OK 0

/* Refused or failed for a reason that is in the message. Results are not used; the run ends with the
   path of the block, the time and the message. */
#define BLOCKSIM_ERROR 1

/* A bug in the plug-in was caught at the border; the message says what is known. No exception, panic
   or longjmp may leave a function of a plug-in. */
#define BLOCKSIM_PANICKED 2

/* UTF-8 text of the plug-in: `length` bytes, no NUL needed. Empty: length 0, data may be NULL. */
typedef struct blocksim_text {
    /* First byte; constant for the life of the process. */
    const char *data;
    /* Number of bytes. */
    size_t length;
} blocksim_text;

/* Where a function may say why it failed. The host owns it; it is empty text at the call.
   A plug-in that fails writes UTF-8 with a NUL behind, cut to fit between two characters.
   It writes nothing when it is given a NULL `message`, NULL `text` or capacity 0. */
typedef struct blocksim_message {
    /* Size of this struct as the host was compiled. */
    uint32_t size;
    /* Bytes at `text`, the NUL included. */
    uint32_t capacity;
    /* The buffer. */
    char *text;
} blocksim_message;

/* A named number or vector: a parameter, a port or a state. */
typedef struct blocksim_quantity {
    /* Size of this struct as the plug-in was compiled. */
    uint32_t size;
    /* 1: a number; n > 1: a vector of n numbers. Never 0. */
    uint32_t length;
    /* As written in diagrams: a letter, then letters, digits and underscores; unique in its list. */
    blocksim_text name;
    /* An SI unit as written in diagrams, as "rad/s"; "1": dimensionless; "": whatever comes, unchecked. */
    blocksim_text unit;
    /* One or two sentences for the manual, Markdown. */
    blocksim_text doc;
    /* `length` numbers, or NULL.
       Parameter: its default; NULL: the diagram must give it.
       Input: its value when it is not connected; NULL: it must be connected.
       State: its value before `reset` is called; NULL: zeros.
       Output: NULL. */
    const double *default_value;
    /* Outputs: bit i is set if the output at time t depends on input i at the same t (direct
       feedthrough). It decides the order of blocks and what counts as an algebraic loop.
       0 in all other lists. */
    uint64_t reads;
} blocksim_quantity;

/* Are these parameters possible? The message names the parameter and the limits.
   [build; once per instance, before any other function]
   NULL function: all parameters are fine. */
typedef blocksim_status (*blocksim_check_fn)(const double *params, const blocksim_message *message);

/* Writes the sample time in seconds. [build; after `check` said OK]
   0: continuous. `outputs` is evaluated whenever time or an input changes; `update` is never called.
   Positive: sampled at the start and every `period` after it. At a hit `outputs` is called, then
   `update`; in between the outputs are held. Such a block has no continuous states.
   Negative, infinite or not a number: the host refuses the block.
   NULL function: continuous. */
typedef blocksim_status (*blocksim_sample_time_fn)(const double *params, double *period,
        const blocksim_message *message);

/* Writes the states at the start. [start; once per run]
   `x` and `xd` hold the default values of the lists at the call: states not written keep them.
   NULL function: the default values are the start. */
typedef blocksim_status (*blocksim_reset_fn)(const double *params, double *x, double *xd,
        const blocksim_message *message);

/* y = h(t, x, xd, u): writes every element of `y`. [start and run; any number of times per instant]
   The host asks as soon as the inputs that the wanted output reads are known; other inputs may then
   hold older or arbitrary numbers, and the outputs that read them are asked for again later. A function
   must therefore not fail over an input, not a number included, that only another output reads.
   Steps may be tried and rejected: time may go back between calls.
   NULL function: allowed for a block without outputs. */
typedef blocksim_status (*blocksim_outputs_fn)(const double *params, double t, const double *x,
        const double *xd, const double *u, double *y, const blocksim_message *message);

/* xd(k+1) = g(t, x, xd(k), u) at a sample hit, after `outputs` of the same hit. [run; once per hit]
   `xd_next` holds a copy of `xd` at the call: states not written stay. The host takes it over when all
   blocks of the hit are done, and drops it after a failure.
   NULL function: the discrete states never change. */
typedef blocksim_status (*blocksim_update_fn)(const double *params, double t, const double *x,
        const double *xd, const double *u, double *xd_next, const blocksim_message *message);

/* dx/dt = f(t, x, xd, u): writes every element of `dx`, per second. [run; several times per step]
   Steps may be tried and rejected: time may go back between calls.
   NULL function: allowed for a block without continuous states. */
typedef blocksim_status (*blocksim_derivatives_fn)(const double *params, double t, const double *x,
        const double *xd, const double *u, double *dx, const blocksim_message *message);

/* One block kind of a plug-in: what it looks like from outside, and its functions. */
typedef struct blocksim_block_table {
    /* Size of this struct as the plug-in was compiled. */
    uint32_t size;
    /* Elements at `parameters`. */
    uint32_t parameter_count;
    /* Elements at `input_ports`; at most `MAX_INPUTS`. */
    uint32_t input_count;
    /* Elements at `output_ports`. */
    uint32_t output_count;
    /* Elements at `continuous_states`. */
    uint32_t continuous_count;
    /* Elements at `discrete_states`. */
    uint32_t discrete_count;
    /* The name in diagrams, as "Cascade"; unique in the plug-in. */
    blocksim_text kind;
    /* The page of the manual, Markdown: law first. */
    blocksim_text doc;
    /* What `params` holds. The pointer of an empty list may be NULL, here and below. */
    const blocksim_quantity *parameters;
    /* What `u` holds. */
    const blocksim_quantity *input_ports;
    /* What `y` holds. */
    const blocksim_quantity *output_ports;
    /* What `x` and `dx` hold. */
    const blocksim_quantity *continuous_states;
    /* What `xd` and `xd_next` hold. */
    const blocksim_quantity *discrete_states;
    /* See `check_fn`. */
    blocksim_check_fn check;
    /* See `sample_time_fn`. */
    blocksim_sample_time_fn sample_time;
    /* See `reset_fn`. */
    blocksim_reset_fn reset;
    /* See `outputs_fn`. */
    blocksim_outputs_fn outputs;
    /* See `update_fn`. */
    blocksim_update_fn update;
    /* See `derivatives_fn`. */
    blocksim_derivatives_fn derivatives;
} blocksim_block_table;

/* What the exported function returns. */
typedef struct blocksim_plugin_table {
    /* Size of this struct as the plug-in was compiled. */
    uint32_t size;
    /* `ABI_MAJOR` as the plug-in was compiled. */
    uint16_t abi_major;
    /* `ABI_MINOR` as the plug-in was compiled. */
    uint16_t abi_minor;
    /* `MAGIC`. */
    uint8_t magic[8];
    /* Name of the plug-in, for messages. */
    blocksim_text name;
    /* Its own version, for messages and the manifest of a run. */
    blocksim_text version;
    /* The block kinds. */
    const blocksim_block_table *blocks;
    /* Elements at `blocks`. */
    uint32_t block_count;
    /* Zero. */
    uint32_t reserved;
} blocksim_plugin_table;

/* The type of the exported function. It returns the same constant table at each call, or NULL if it has
   none. A function rather than a variable, as every linker exports functions in the same way.
   [load; any thread] */
typedef const blocksim_plugin_table *(*blocksim_entry_fn)(void);

/* For authors: a constant text, the bit of input `i` in `reads`, and what makes a function visible. */
#define BLOCKSIM_TEXT(literal) {(literal), sizeof(literal) - 1}
#define BLOCKSIM_READS(i) (UINT64_C(1) << (i))
#if defined(_WIN32)
#define BLOCKSIM_EXPORT __declspec(dllexport)
#else
#define BLOCKSIM_EXPORT __attribute__((visibility("default")))
#endif

/* The plug-in defines this one. */
BLOCKSIM_EXPORT const blocksim_plugin_table *blocksim_plugin_v1(void);

#ifdef __cplusplus
}
#endif
#endif
