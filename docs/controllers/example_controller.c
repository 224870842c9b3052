/* A wheel slide protection in C. example_controller.py is the same law, line by line, and both give the same commands
 * to the bit: the operations and their order are the same, and the compiler may not fuse them (-ffp-contract=off).
 *
 *     [wsp]
 *     controller = "example_controller.so"
 *     [wsp.parameters]
 *     vent_slip = 0.12
 */
#include "railslide_controller.h"

#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    double vent_slip, hold_slip, slip_offset_mps, vent_below_mps2, fall_limit_mps2, filter_ticks;
    double pulse_ticks, cycle_ticks, cut_off_mps, watchdog_ticks;
} parameters;

typedef struct {
    parameters p;
    double period_s;
    double reference_mps; /* negative: none yet */
    double speed_mps[4];  /* negative: not known */
    double acceleration_mps2[4];
    int in_cycle[4]; /* ticks since the last pulse began, -1: the axle is left alone */
    int unfilled[4]; /* ticks since it was last filled */
} example;

static const parameters defaults = {0.10, 0.03, 0.4, -3.0, 1.8, 4.0, 3.0, 9.0, 1.0, 600.0};

static const struct {
    const char *name;
    size_t at;
    double least;
} known[] = {
    {"vent_slip", offsetof(parameters, vent_slip), 0.0},
    {"hold_slip", offsetof(parameters, hold_slip), 0.0},
    {"slip_offset_mps", offsetof(parameters, slip_offset_mps), 0.0},
    {"vent_below_mps2", offsetof(parameters, vent_below_mps2), -100.0},
    {"fall_limit_mps2", offsetof(parameters, fall_limit_mps2), 0.0},
    {"filter_ticks", offsetof(parameters, filter_ticks), 1.0},
    {"pulse_ticks", offsetof(parameters, pulse_ticks), 1.0},
    {"cycle_ticks", offsetof(parameters, cycle_ticks), 1.0},
    {"cut_off_mps", offsetof(parameters, cut_off_mps), 0.0},
    {"watchdog_ticks", offsetof(parameters, watchdog_ticks), 1.0},
};

int32_t railslide_abi_version(void) { return RAILSLIDE_ABI_VERSION; }

static int set(parameters *p, const railslide_parameter *given, char *message) {
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        if (strcmp(given->name, known[i].name) != 0)
            continue;
        if (given->text != NULL || !(given->number >= known[i].least)) {
            snprintf(message, RAILSLIDE_MESSAGE_SIZE, "%s must be a number from %g on", given->name, known[i].least);
            return 1;
        }
        *(double *)((char *)p + known[i].at) = given->number;
        return 0;
    }
    snprintf(message, RAILSLIDE_MESSAGE_SIZE, "there is no parameter %s", given->name);
    return 1;
}

void *railslide_create(double period_s, const railslide_parameter *given, int32_t count, char *message) {
    parameters p = defaults;
    for (int32_t i = 0; i < count; i++)
        if (set(&p, &given[i], message))
            return NULL;
    example *c = calloc(1, sizeof *c);
    if (c == NULL)
        return NULL;
    c->p = p;
    c->period_s = period_s;
    return c;
}

int32_t railslide_reset(void *controller, double t_s, int32_t direction, char *message) {
    example *c = controller;
    (void)t_s, (void)direction, (void)message;
    c->reference_mps = -1.0;
    for (int axle = 0; axle < 4; axle++) {
        c->speed_mps[axle] = -1.0;
        c->acceleration_mps2[axle] = 0.0;
        c->in_cycle[axle] = -1;
        c->unfilled[axle] = 0;
    }
    return 0;
}

/* The fastest axle, its fall limited; a speed found elsewhere is believed. */
static void follow_train(example *c, double outside_reference_mps) {
    if (outside_reference_mps >= 0.0) {
        c->reference_mps = outside_reference_mps;
        return;
    }
    double fastest = c->reference_mps - c->p.fall_limit_mps2 * c->period_s;
    for (int axle = 0; axle < 4; axle++)
        if (c->speed_mps[axle] > fastest)
            fastest = c->speed_mps[axle];
    c->reference_mps = fastest >= 0.0 || c->reference_mps < 0.0 ? fastest : 0.0;
}

/* The valve command of an axle under the brake. */
static int command(example *c, int axle) {
    const parameters *p = &c->p;
    double slip_mps = c->reference_mps - c->speed_mps[axle] - p->slip_offset_mps;
    double acceleration = c->acceleration_mps2[axle];
    int answer;
    if ((slip_mps > p->vent_slip * c->reference_mps && acceleration < 0.0) ||
        (slip_mps > 0.0 && acceleration < p->vent_below_mps2)) {
        answer = RAILSLIDE_VENT;
        c->in_cycle[axle] = 0;
    } else if (c->in_cycle[axle] < 0) {
        answer = RAILSLIDE_FILL;
    } else if (slip_mps > p->hold_slip * c->reference_mps) {
        answer = RAILSLIDE_HOLD;
    } else {
        c->in_cycle[axle] += 1;
        if (c->in_cycle[axle] >= p->cycle_ticks)
            c->in_cycle[axle] = 0;
        answer = c->in_cycle[axle] < p->pulse_ticks ? RAILSLIDE_FILL : RAILSLIDE_HOLD;
    }
    c->unfilled[axle] = answer == RAILSLIDE_FILL ? 0 : c->unfilled[axle] + 1;
    if (c->unfilled[axle] > p->watchdog_ticks) {
        c->in_cycle[axle] = -1;
        c->unfilled[axle] = 0;
        answer = RAILSLIDE_FILL;
    }
    return answer;
}

int32_t railslide_step(void *controller, const railslide_input *in, railslide_output *out, char *message) {
    example *c = controller;
    (void)message;
    for (int axle = 0; axle < 4; axle++) {
        if (!in->valid[axle]) {
            c->speed_mps[axle] = -1.0;
            continue;
        }
        double speed = in->direction * in->axle_speed_mps[axle];
        if (!(speed > 0.0))
            speed = 0.0;
        double before = c->speed_mps[axle];
        if (before < 0.0) {
            c->acceleration_mps2[axle] = 0.0;
        } else {
            double change = (speed - before) / c->period_s - c->acceleration_mps2[axle];
            c->acceleration_mps2[axle] += change / c->p.filter_ticks;
        }
        c->speed_mps[axle] = speed;
    }
    follow_train(c, in->outside_reference_mps);
    int off = in->demand <= 0.0 || c->reference_mps < c->p.cut_off_mps;
    for (int axle = 0; axle < 4; axle++) {
        if (off || c->speed_mps[axle] < 0.0) {
            c->in_cycle[axle] = -1;
            c->unfilled[axle] = 0;
        } else { /* all others keep FILL and no sand, which `out` came with */
            out->valve[axle] = command(c, axle);
            out->sand[axle] = c->in_cycle[axle] >= 0;
        }
    }
    if (c->reference_mps >= 0.0)
        out->reference_speed_mps = c->reference_mps;
    return 0;
}

void railslide_destroy(void *controller) { free(controller); }
