/* A plug-in of one block, y = FACTOR u, with a table that can be broken from the command line. */
#include "blocksim_plugin.h"

#ifndef MAJOR
#define MAJOR BLOCKSIM_ABI_MAJOR
#endif
#ifndef MAGIC
#define MAGIC BLOCKSIM_MAGIC
#endif
#ifndef PLUGIN_SIZE
#define PLUGIN_SIZE sizeof(blocksim_plugin_table)
#endif
#ifndef BLOCK_SIZE
#define BLOCK_SIZE sizeof(blocksim_block_table)
#endif
#ifndef BLOCK_COUNT
#define BLOCK_COUNT 1
#endif
#ifndef BLOCKS
#define BLOCKS blocks
#endif
#ifndef INPUT_COUNT
#define INPUT_COUNT 1
#endif
#ifndef INPUTS
#define INPUTS inputs
#endif
#ifndef KIND
#define KIND "Factor"
#endif
#ifndef INPUT_NAME
#define INPUT_NAME "u"
#endif
#ifndef OUTPUT_LENGTH
#define OUTPUT_LENGTH 1
#endif
#ifndef UNIT
#define UNIT "1"
#endif
#ifndef READS
#define READS BLOCKSIM_READS(0)
#endif
#ifndef OUTPUTS
#define OUTPUTS factor
#endif
#ifndef FACTOR
#define FACTOR 1.0
#endif
#ifndef ENTRY
#define ENTRY blocksim_plugin_v1
#endif
#ifndef TABLE
#define TABLE &table
#endif

static const blocksim_quantity inputs[] = {
    {sizeof(blocksim_quantity), 1, BLOCKSIM_TEXT(INPUT_NAME), BLOCKSIM_TEXT("1"), BLOCKSIM_TEXT(""), 0, 0},
};
static const blocksim_quantity outputs[] = {
    {sizeof(blocksim_quantity), OUTPUT_LENGTH, BLOCKSIM_TEXT("y"), BLOCKSIM_TEXT(UNIT), BLOCKSIM_TEXT(""), 0, READS},
};

blocksim_status factor(const double *params, double t, const double *x, const double *xd, const double *u,
                       double *y, const blocksim_message *message)
{
    (void)params, (void)t, (void)x, (void)xd, (void)message;
    y[0] = FACTOR * u[0];
    return BLOCKSIM_OK;
}

const blocksim_block_table blocks[] = {{
    .size = BLOCK_SIZE, .kind = BLOCKSIM_TEXT(KIND),
    .input_count = INPUT_COUNT, .input_ports = INPUTS, .output_count = 1, .output_ports = outputs,
    .outputs = OUTPUTS,
}};

const blocksim_plugin_table table = {
    .size = PLUGIN_SIZE, .abi_major = MAJOR, .abi_minor = BLOCKSIM_ABI_MINOR, .magic = MAGIC,
    .name = BLOCKSIM_TEXT("table"), .version = BLOCKSIM_TEXT("1"), .block_count = BLOCK_COUNT, .blocks = BLOCKS,
};

BLOCKSIM_EXPORT const blocksim_plugin_table *ENTRY(void)
{
    return TABLE;
}
