/* Blocks that do what the tests of the host want to see: groups of outputs, vectors, and every way to fail. */
#include <math.h>
#include <string.h>

#include "blocksim_plugin.h"

#define Q(length, name, unit, def, reads)                                                                         \
    {sizeof(blocksim_quantity), length, BLOCKSIM_TEXT(name), BLOCKSIM_TEXT(unit), BLOCKSIM_TEXT(""), def, reads}
#define LIST(count, list) .count = sizeof(list) / sizeof(list[0])

static blocksim_status say(blocksim_status status, const char *text, const blocksim_message *message)
{
    if (message && message->text && message->capacity > strlen(text))
        memcpy(message->text, text, strlen(text) + 1);
    return status;
}

/* Groups: each output reads another input, one reads none. Sampled every 0.1 s. */
static const double three[] = {3.0, 3.0};
static const blocksim_quantity groups_in[] = {Q(1, "a", "V", 0, 0), Q(2, "b", "", three, 0)};
static const blocksim_quantity groups_out[] = {
    Q(1, "twice", "V", 0, BLOCKSIM_READS(0)),
    Q(2, "same", "", 0, BLOCKSIM_READS(1)),
    Q(1, "hits", "1", 0, 0),
};
static const blocksim_quantity groups_state[] = {Q(1, "n", "1", 0, 0)};

static blocksim_status tenth(const double *params, double *period, const blocksim_message *message)
{
    (void)params, (void)message;
    *period = 0.1;
    return BLOCKSIM_OK;
}

static blocksim_status groups_outputs(const double *params, double t, const double *x, const double *xd,
                                      const double *u, double *y, const blocksim_message *message)
{
    (void)params, (void)t, (void)x, (void)message;
    y[0] = 2.0 * u[0];
    y[1] = u[1];
    y[2] = u[2];
    y[3] = xd[0];
    return BLOCKSIM_OK;
}

static blocksim_status groups_update(const double *params, double t, const double *x, const double *xd,
                                     const double *u, double *next, const blocksim_message *message)
{
    (void)params, (void)t, (void)x, (void)u, (void)message;
    next[0] = xd[0] + 1.0;
    return BLOCKSIM_OK;
}

/* Oscillator: dx = (x1, -x0 w^2), a vector state that starts at the vector parameter x0. */
static const double one[] = {1.0};
static const blocksim_quantity oscillator_params[] = {Q(2, "x0", "m", 0, 0), Q(1, "w", "rad/s", one, 0)};
static const blocksim_quantity oscillator_out[] = {Q(2, "x", "m", 0, 0)};
static const blocksim_quantity oscillator_state[] = {Q(2, "x", "m", 0, 0)};

static blocksim_status oscillator_reset(const double *params, double *x, double *xd, const blocksim_message *message)
{
    (void)xd, (void)message;
    memcpy(x, params, 2 * sizeof(double));
    return BLOCKSIM_OK;
}

static blocksim_status oscillator_outputs(const double *params, double t, const double *x, const double *xd,
                                          const double *u, double *y, const blocksim_message *message)
{
    (void)params, (void)t, (void)xd, (void)u, (void)message;
    memcpy(y, x, 2 * sizeof(double));
    return BLOCKSIM_OK;
}

static blocksim_status oscillator_derivatives(const double *params, double t, const double *x, const double *xd,
                                              const double *u, double *dx, const blocksim_message *message)
{
    (void)t, (void)xd, (void)u, (void)message;
    dx[0] = x[1];
    dx[1] = -x[0] * params[2] * params[2];
    return BLOCKSIM_OK;
}

/* Faulty: fails in the way that `how` says. */
enum { FINE, ERROR, SILENT, PANIC, ODD, NOT_A_NUMBER, INFINITE_STATE, FAILING_UPDATE, CHECK_ERROR, CHECK_PANIC,
       NEGATIVE_TIME, RESET_ERROR };
static const blocksim_quantity faulty_params[] = {Q(1, "how", "1", 0, 0)};
static const blocksim_quantity faulty_in[] = {Q(1, "speed", "rad/s", 0, 0), Q(2, "v", "1", three, 0)};
static const blocksim_quantity faulty_out[] = {Q(1, "y", "1", 0, BLOCKSIM_READS(0) | BLOCKSIM_READS(1))};
static const blocksim_quantity faulty_state[] = {Q(2, "s", "1", 0, 0)};

static blocksim_status faulty_check(const double *params, const blocksim_message *message)
{
    switch ((int)params[0]) {
    case CHECK_ERROR: return say(BLOCKSIM_ERROR, "`how` is 8, which nobody wants", message);
    case CHECK_PANIC: return say(BLOCKSIM_PANICKED, "index 3 of 2", message);
    default: return BLOCKSIM_OK;
    }
}

static blocksim_status faulty_time(const double *params, double *period, const blocksim_message *message)
{
    (void)message;
    *period = params[0] == NEGATIVE_TIME ? -1.0 : 0.1;
    return BLOCKSIM_OK;
}

static blocksim_status faulty_reset(const double *params, double *x, double *xd, const blocksim_message *message)
{
    (void)x, (void)xd;
    return params[0] == RESET_ERROR ? say(BLOCKSIM_ERROR, "no start", message) : BLOCKSIM_OK;
}

static blocksim_status faulty_outputs(const double *params, double t, const double *x, const double *xd,
                                      const double *u, double *y, const blocksim_message *message)
{
    (void)t, (void)x, (void)xd;
    y[0] = u[0];
    switch ((int)params[0]) {
    case ERROR: return say(BLOCKSIM_ERROR, "the winding is too hot", message);
    case SILENT: return BLOCKSIM_ERROR;
    case PANIC: return say(BLOCKSIM_PANICKED, "attempt to divide by zero", message);
    case ODD: return 77;
    case NOT_A_NUMBER: y[0] = NAN; return BLOCKSIM_OK;
    default: return BLOCKSIM_OK;
    }
}

static blocksim_status faulty_update(const double *params, double t, const double *x, const double *xd,
                                     const double *u, double *next, const blocksim_message *message)
{
    (void)t, (void)x, (void)xd, (void)u;
    next[0] = 5.0;
    if (params[0] == INFINITE_STATE)
        next[1] = INFINITY;
    return params[0] == FAILING_UPDATE ? say(BLOCKSIM_ERROR, "no next state", message) : BLOCKSIM_OK;
}

static const blocksim_block_table blocks[] = {
    {
        .size = sizeof(blocksim_block_table), .kind = BLOCKSIM_TEXT("Groups"),
        LIST(input_count, groups_in), .input_ports = groups_in,
        LIST(output_count, groups_out), .output_ports = groups_out,
        LIST(discrete_count, groups_state), .discrete_states = groups_state,
        .sample_time = tenth, .outputs = groups_outputs, .update = groups_update,
    },
    {
        .size = sizeof(blocksim_block_table), .kind = BLOCKSIM_TEXT("Oscillator"),
        LIST(parameter_count, oscillator_params), .parameters = oscillator_params,
        LIST(output_count, oscillator_out), .output_ports = oscillator_out,
        LIST(continuous_count, oscillator_state), .continuous_states = oscillator_state,
        .reset = oscillator_reset, .outputs = oscillator_outputs, .derivatives = oscillator_derivatives,
    },
    {
        .size = sizeof(blocksim_block_table), .kind = BLOCKSIM_TEXT("Faulty"),
        LIST(parameter_count, faulty_params), .parameters = faulty_params,
        LIST(input_count, faulty_in), .input_ports = faulty_in,
        LIST(output_count, faulty_out), .output_ports = faulty_out,
        LIST(discrete_count, faulty_state), .discrete_states = faulty_state,
        .check = faulty_check, .sample_time = faulty_time, .reset = faulty_reset,
        .outputs = faulty_outputs, .update = faulty_update,
    },
    {
        .size = sizeof(blocksim_block_table), .kind = BLOCKSIM_TEXT("Hybrid"),
        LIST(parameter_count, oscillator_params), .parameters = oscillator_params,
        LIST(continuous_count, oscillator_state), .continuous_states = oscillator_state,
        .sample_time = tenth, .derivatives = oscillator_derivatives,
    },
};

static const blocksim_plugin_table table = {
    .size = sizeof(blocksim_plugin_table),
    .abi_major = BLOCKSIM_ABI_MAJOR, .abi_minor = BLOCKSIM_ABI_MINOR, .magic = BLOCKSIM_MAGIC,
    .name = BLOCKSIM_TEXT("probe"), .version = BLOCKSIM_TEXT("1"),
    .block_count = sizeof(blocks) / sizeof(blocks[0]), .blocks = blocks,
};

BLOCKSIM_EXPORT const blocksim_plugin_table *blocksim_plugin_v1(void)
{
    return &table;
}
