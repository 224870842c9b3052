/* A wheel slide protection for railslide as a C shared library.
 *
 * Export the five functions below and name the library in a scenario:
 *
 *     [wsp]
 *     controller = "my_controller.so"     # .dll, .dylib; relative to the scenario file
 *     [wsp.parameters]
 *     slip_share = 0.12                   # any names of your own, numbers or texts
 *
 * The library runs in a process of its own. At tick k (each period_s) railslide_step reads what the tachometers show
 * at that moment; what it answers acts from tick k+1 on. Add no delay of your own for this link.
 *
 * The functions are called by one thread. Those that return int32_t return 0, or anything else for an error, which ends
 * the run; `message` then tells why. It points to RAILSLIDE_MESSAGE_SIZE bytes, filled with zeros, for a text in UTF-8.
 * What the library prints does not reach the terminal; its last lines are shown if it fails.
 */
#ifndef RAILSLIDE_CONTROLLER_H
#define RAILSLIDE_CONTROLLER_H

#include <stdint.h>

#if defined(_WIN32)
#define RAILSLIDE_EXPORT __declspec(dllexport)
#else
#define RAILSLIDE_EXPORT __attribute__((visibility("default")))
#endif

#define RAILSLIDE_ABI_VERSION 1
#define RAILSLIDE_MESSAGE_SIZE 512

/* valve commands: neither magnet energised, the hold valve, both */
#define RAILSLIDE_FILL 0
#define RAILSLIDE_HOLD 1
#define RAILSLIDE_VENT 2

/* a speed that there is not, either way; test for it with speed < 0 */
#define RAILSLIDE_NONE (-1.0)

#ifdef __cplusplus
extern "C" {
#endif

/* One entry of [wsp.parameters]; true and false arrive as 1 and 0. */
typedef struct {
    const char *name;
    const char *text; /* NULL if the value is a number */
    double number;    /* nan if the value is a text */
} railslide_parameter;

/* Axles 1..4 from the front are the indices 0..3. */
typedef struct {
    double t_s;
    double axle_speed_mps[4];     /* signed, positive forward; 0 where it is not valid */
    double demand;                /* brake demand, 0..1 of full service */
    double outside_reference_mps; /* speed of the train found elsewhere, >= 0; RAILSLIDE_NONE = none */
    int32_t valid[4];             /* 1 where the axle's speed can be used */
    int32_t direction;            /* of travel, +1 forward, -1 backward */
} railslide_input;

/* Before each step it holds no reference speed, FILL for every axle, no sand, no track brake. */
typedef struct {
    double reference_speed_mps; /* speed of the train as the controller sees it, >= 0; RAILSLIDE_NONE = has none */
    int32_t valve[4];           /* RAILSLIDE_FILL, _HOLD or _VENT */
    int32_t sand[4];            /* 1: sand before this axle */
    int32_t track_brake;        /* 1: lower the magnetic track brakes */
} railslide_output;

/* Returns RAILSLIDE_ABI_VERSION. */
RAILSLIDE_EXPORT int32_t railslide_abi_version(void);

/* Makes a controller that is stepped each period_s; NULL with a message refuses a parameter. railslide_reset follows. */
RAILSLIDE_EXPORT void *railslide_create(double period_s, const railslide_parameter *parameters, int32_t count,
                                        char *message);

/* Forgets everything: a run begins at t_s. */
RAILSLIDE_EXPORT int32_t railslide_reset(void *controller, double t_s, int32_t direction, char *message);

/* One tick. */
RAILSLIDE_EXPORT int32_t railslide_step(void *controller, const railslide_input *input, railslide_output *output,
                                        char *message);

RAILSLIDE_EXPORT void railslide_destroy(void *controller);

#ifdef __cplusplus
}
#endif

#endif
