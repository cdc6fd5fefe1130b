/* The controller `MyController` in C; `demo.ron` closes a loop with it. The contract is `blocksim_plugin.h`,
   which is put on the path of the compiler; `blocksim manual plugins` is the guide.

   Proportional and integral, sampled, limited: u = kp e + x, x(k+1) = x(k) + ki ts e. */
#include <math.h>
#include <stdio.h>

#include "blocksim_plugin.h"

/* Places in the buffers: the order of the lists below. */
enum { KP, KI, LIMIT, TS };
enum { E };
enum { U };
enum { X };

/* A number: name, unit, description, default (0: none), inputs that it reads. */
#define NUMBER(name, unit, doc, value, reads)                                                                       \
    {sizeof(blocksim_quantity), 1, BLOCKSIM_TEXT(name), BLOCKSIM_TEXT(unit), BLOCKSIM_TEXT(doc), value, reads}
#define COUNT(list) (sizeof(list) / sizeof((list)[0]))

static const double one = 1.0, unlimited = INFINITY, millisecond = 1e-3;

static const blocksim_quantity parameters[] = {
    NUMBER("kp", "", "Proportional gain.", &one, 0),
    NUMBER("ki", "", "Integral gain, that of kp per second.", &one, 0),
    NUMBER("limit", "", "Largest size of u.", &unlimited, 0),
    NUMBER("ts", "s", "Sample time.", &millisecond, 0),
};
static const blocksim_quantity inputs[] = {NUMBER("e", "", "Set value less actual value.", 0, 0)};
static const blocksim_quantity outputs[] = {NUMBER("u", "", "What the plant gets.", 0, BLOCKSIM_READS(E))};
static const blocksim_quantity states[] = {NUMBER("x", "", "Integral part.", 0, 0)};

/* What the law wants. */
static double wanted(const double *p, const double *xd, const double *u)
{
    return p[KP] * u[E] + xd[X];
}

/* What the limits leave of it. */
static double limited(const double *p, double value)
{
    return fmin(fmax(value, -p[LIMIT]), p[LIMIT]);
}

/* Refuses parameters that make no sense, with a reason for the user. */
static blocksim_status check(const double *p, const blocksim_message *message)
{
    if (!(p[TS] > 0.0) || isinf(p[TS])) {
        snprintf(message->text, message->capacity, "`ts` is %g s, it must be above zero", p[TS]);
        return BLOCKSIM_ERROR;
    }
    if (!(p[LIMIT] >= 0.0)) {
        snprintf(message->text, message->capacity, "`limit` is %g, it must not be below zero", p[LIMIT]);
        return BLOCKSIM_ERROR;
    }
    return BLOCKSIM_OK;
}

static blocksim_status sample_time(const double *p, double *period, const blocksim_message *message)
{
    (void)message;
    *period = p[TS];
    return BLOCKSIM_OK;
}

/* y = h(t, x, xd, u): writes every output, and depends on nothing but its arguments. */
static blocksim_status law(const double *p, double t, const double *x, const double *xd, const double *u, double *y,
                           const blocksim_message *message)
{
    (void)t, (void)x, (void)message;
    y[U] = limited(p, wanted(p, xd, u));
    return BLOCKSIM_OK;
}

/* The states of the next sample. What has to be remembered is a state, never a `static`. */
static blocksim_status update(const double *p, double t, const double *x, const double *xd, const double *u,
                              double *next, const blocksim_message *message)
{
    (void)t, (void)x, (void)message;
    double value = wanted(p, xd, u);
    /* At a limit the integral part must not grow further, or it takes long to come back. */
    if ((value - limited(p, value)) * u[E] <= 0.0)
        next[X] = xd[X] + p[KI] * p[TS] * u[E];
    return BLOCKSIM_OK;
}

static const blocksim_block_table blocks[] = {{
    .size = sizeof(blocksim_block_table),
    .parameter_count = COUNT(parameters),
    .input_count = COUNT(inputs),
    .output_count = COUNT(outputs),
    .discrete_count = COUNT(states),
    .kind = BLOCKSIM_TEXT("MyController"),
    .doc = BLOCKSIM_TEXT("Proportional and integral, sampled, limited."),
    .parameters = parameters,
    .input_ports = inputs,
    .output_ports = outputs,
    .discrete_states = states,
    .check = check,
    .sample_time = sample_time,
    .outputs = law,
    .update = update,
}};

static const blocksim_plugin_table table = {
    .size = sizeof(blocksim_plugin_table),
    .abi_major = BLOCKSIM_ABI_MAJOR,
    .abi_minor = BLOCKSIM_ABI_MINOR,
    .magic = BLOCKSIM_MAGIC,
    .name = BLOCKSIM_TEXT("my_controller"),
    .version = BLOCKSIM_TEXT("0.1.0"),
    .blocks = blocks,
    .block_count = COUNT(blocks),
};

const blocksim_plugin_table *blocksim_plugin_v1(void)
{
    return &table;
}
