// The controller `MyController` in C++; `demo.ron` closes a loop with it. The contract is `blocksim_plugin.h`,
// which is put on the path of the compiler; `blocksim manual plugins` is the guide.
//
// Proportional and integral, sampled, limited: u = kp e + x, x(k+1) = x(k) + ki ts e.
#include <cmath>
#include <cstdio>
#include <exception>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "blocksim_plugin.h"

namespace {

// Places in the buffers: the order of the lists below.
enum Parameter { KP, KI, LIMIT, TS };
enum Input { E };
enum Output { U };
enum State { X };

constexpr double one = 1.0, unlimited = std::numeric_limits<double>::infinity(), millisecond = 1e-3;

// A number: name, unit, description, default, inputs that it reads.
template <std::size_t N, std::size_t M, std::size_t K>
constexpr blocksim_quantity number(const char (&name)[N], const char (&unit)[M], const char (&doc)[K],
                                   const double *value = nullptr, std::uint64_t reads = 0)
{
    return {sizeof(blocksim_quantity), 1, {name, N - 1}, {unit, M - 1}, {doc, K - 1}, value, reads};
}

constexpr blocksim_quantity parameters[] = {
    number("kp", "", "Proportional gain.", &one),
    number("ki", "", "Integral gain, that of kp per second.", &one),
    number("limit", "", "Largest size of u.", &unlimited),
    number("ts", "s", "Sample time.", &millisecond),
};
constexpr blocksim_quantity inputs[] = {number("e", "", "Set value less actual value.")};
constexpr blocksim_quantity outputs[] = {number("u", "", "What the plant gets.", nullptr, BLOCKSIM_READS(E))};
constexpr blocksim_quantity states[] = {number("x", "", "Integral part.")};

// No exception may leave a function of a plug-in: this makes a message of it.
template <typename Body>
blocksim_status guarded(const blocksim_message *message, Body body) noexcept
{
    try {
        body();
        return BLOCKSIM_OK;
    } catch (const std::exception &error) {
        std::snprintf(message->text, message->capacity, "%s", error.what());
    } catch (...) {
        std::snprintf(message->text, message->capacity, "an exception of another type");
    }
    return BLOCKSIM_ERROR;
}

// What the law wants.
double wanted(const double *p, const double *xd, const double *u)
{
    return p[KP] * u[E] + xd[X];
}

// What the limits leave of it.
double limited(const double *p, double value)
{
    return std::fmin(std::fmax(value, -p[LIMIT]), p[LIMIT]);
}

// Refuses parameters that make no sense, with a reason for the user.
blocksim_status check(const double *p, const blocksim_message *message)
{
    return guarded(message, [=] {
        if (!(p[TS] > 0.0) || std::isinf(p[TS]))
            throw std::domain_error("`ts` must be above zero");
        if (!(p[LIMIT] >= 0.0))
            throw std::domain_error("`limit` must not be below zero");
    });
}

blocksim_status sample_time(const double *p, double *period, const blocksim_message *)
{
    *period = p[TS];
    return BLOCKSIM_OK;
}

// y = h(t, x, xd, u): writes every output, and depends on nothing but its arguments.
blocksim_status law(const double *p, double, const double *, const double *xd, const double *u, double *y,
                    const blocksim_message *message)
{
    return guarded(message, [=] { y[U] = limited(p, wanted(p, xd, u)); });
}

// The states of the next sample. What has to be remembered is a state, never a `static`.
blocksim_status update(const double *p, double, const double *, const double *xd, const double *u, double *next,
                       const blocksim_message *message)
{
    return guarded(message, [=] {
        const double value = wanted(p, xd, u);
        // At a limit the integral part must not grow further, or it takes long to come back.
        if ((value - limited(p, value)) * u[E] <= 0.0)
            next[X] = xd[X] + p[KI] * p[TS] * u[E];
    });
}

const blocksim_block_table blocks[] = {{
    .size = sizeof(blocksim_block_table),
    .parameter_count = std::size(parameters),
    .input_count = std::size(inputs),
    .output_count = std::size(outputs),
    .continuous_count = 0,
    .discrete_count = std::size(states),
    .kind = BLOCKSIM_TEXT("MyController"),
    .doc = BLOCKSIM_TEXT("Proportional and integral, sampled, limited."),
    .parameters = parameters,
    .input_ports = inputs,
    .output_ports = outputs,
    .continuous_states = nullptr,
    .discrete_states = states,
    .check = check,
    .sample_time = sample_time,
    .reset = nullptr,
    .outputs = law,
    .update = update,
    .derivatives = nullptr,
}};

const blocksim_plugin_table table = {
    .size = sizeof(blocksim_plugin_table),
    .abi_major = BLOCKSIM_ABI_MAJOR,
    .abi_minor = BLOCKSIM_ABI_MINOR,
    .magic = BLOCKSIM_MAGIC,
    .name = BLOCKSIM_TEXT("my_controller"),
    .version = BLOCKSIM_TEXT("0.1.0"),
    .blocks = blocks,
    .block_count = std::size(blocks),
    .reserved = 0,
};

} // namespace

const blocksim_plugin_table *blocksim_plugin_v1(void)
{
    return &table;
}
