/* A plug-in in C: y = k u.
 *   cc -std=c99 -shared -fPIC -I crates/abi/include -o libgain.so crates/abi/tests/c_gain.c */
#include <string.h>

#include "blocksim_plugin.h"

static const double one = 1.0;

static const blocksim_quantity parameters[] = {
    {sizeof(blocksim_quantity), 1, BLOCKSIM_TEXT("k"), BLOCKSIM_TEXT("1"), BLOCKSIM_TEXT("Gain."), &one, 0},
};
static const blocksim_quantity inputs[] = {
    {sizeof(blocksim_quantity), 1, BLOCKSIM_TEXT("u"), BLOCKSIM_TEXT(""), BLOCKSIM_TEXT("Input."), 0, 0},
};
static const blocksim_quantity outputs[] = {
    {sizeof(blocksim_quantity), 1, BLOCKSIM_TEXT("y"), BLOCKSIM_TEXT(""), BLOCKSIM_TEXT("Output."), 0,
     BLOCKSIM_READS(0)},
};

static blocksim_status check(const double *params, const blocksim_message *message)
{
    if (params[0] == params[0])
        return BLOCKSIM_OK;
    if (message && message->text && message->capacity > 17)
        memcpy(message->text, "k is not a number", 18);
    return BLOCKSIM_ERROR;
}

static blocksim_status gain(const double *params, double t, const double *x, const double *xd,
                            const double *u, double *y, const blocksim_message *message)
{
    (void)t, (void)x, (void)xd, (void)message;
    y[0] = params[0] * u[0];
    return BLOCKSIM_OK;
}

static const blocksim_block_table blocks[] = {{
    .size = sizeof(blocksim_block_table),
    .kind = BLOCKSIM_TEXT("Gain"),
    .doc = BLOCKSIM_TEXT("y = k u"),
    .parameter_count = 1, .parameters = parameters,
    .input_count = 1,     .input_ports = inputs,
    .output_count = 1,    .output_ports = outputs,
    .check = check,
    .outputs = gain,
}};

static const blocksim_plugin_table table = {
    .size = sizeof(blocksim_plugin_table),
    .abi_major = BLOCKSIM_ABI_MAJOR,
    .abi_minor = BLOCKSIM_ABI_MINOR,
    .magic = BLOCKSIM_MAGIC,
    .name = BLOCKSIM_TEXT("c_gain"),
    .version = BLOCKSIM_TEXT("1"),
    .block_count = 1,
    .blocks = blocks,
};

BLOCKSIM_EXPORT const blocksim_plugin_table *blocksim_plugin_v1(void)
{
    return &table;
}
