/* What fmi2.c and fmi3.c share: an instance that holds a controller of railslide_controller.h.
 * build.py defines PARAMETER_NAMES and PARAMETER_STARTS, the parameters that the FMU offers. */
#ifndef FMU_H
#define FMU_H

#include "railslide_controller.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PERIOD_S 0.01

/* value references, the same in modelDescription.xml; an array of FMI 3 has that of its first element here */
enum { TIME = 0, AXLE_SPEED = 1, DEMAND = 5, OUTSIDE = 6, VALID = 11, DIRECTION = 15,
       VALVE = 21, SAND = 31, TRACK_BRAKE = 35, REFERENCE = 41, PARAMETER = 101 };

static const char *const parameter_names[] = {PARAMETER_NAMES};
static const double parameter_starts[] = {PARAMETER_STARTS};
enum { PARAMETERS = sizeof parameter_starts / sizeof *parameter_starts };

typedef struct {
    void *controller;
    double start_s, now_s;
    double parameter[PARAMETERS];
    railslide_input in;
    railslide_output out;
    char message[RAILSLIDE_MESSAGE_SIZE];
    void *environment;
    void (*log)(void); /* of the type that the version of FMI has */
} fmu;

static const railslide_output silent = {RAILSLIDE_NONE, {RAILSLIDE_FILL}, {0}, 0};

/* Back to where it was when it was made. */
static void forget(fmu *f) {
    if (f->controller)
        railslide_destroy(f->controller);
    f->controller = NULL;
    memcpy(f->parameter, parameter_starts, sizeof f->parameter);
    memset(&f->in, 0, sizeof f->in);
    f->in.outside_reference_mps = RAILSLIDE_NONE;
    f->in.direction = 1;
    f->out = silent;
}

static fmu *make(void) {
    fmu *f = calloc(1, sizeof *f);
    if (f)
        forget(f);
    return f;
}

/* The parameters are fixed from here on; 0 if the controller takes them. */
static int start(fmu *f) {
    railslide_parameter given[PARAMETERS];
    for (int i = 0; i < PARAMETERS; i++)
        given[i] = (railslide_parameter){parameter_names[i], NULL, f->parameter[i]};
    f->controller = railslide_create(PERIOD_S, given, PARAMETERS, f->message);
    f->now_s = f->start_s;
    return f->controller == NULL || railslide_reset(f->controller, f->start_s, f->in.direction, f->message);
}

static int step(fmu *f, double at_s, double period_s) {
    if (fabs(period_s - PERIOD_S) > 1e-9) {
        strcpy(f->message, "the communication step must be 0.01 s");
        return 1;
    }
    f->in.t_s = at_s;
    f->now_s = at_s + period_s;
    f->out = silent;
    return railslide_step(f->controller, &f->in, &f->out, f->message);
}

/* Where a real value is kept; NULL: there is none of that reference. */
static double *real_at(fmu *f, unsigned reference) {
    if (reference >= AXLE_SPEED && reference < AXLE_SPEED + 4)
        return &f->in.axle_speed_mps[reference - AXLE_SPEED];
    if (reference >= PARAMETER && reference < PARAMETER + PARAMETERS)
        return &f->parameter[reference - PARAMETER];
    return reference == TIME        ? &f->now_s
           : reference == DEMAND    ? &f->in.demand
           : reference == OUTSIDE   ? &f->in.outside_reference_mps
           : reference == REFERENCE ? &f->out.reference_speed_mps
                                    : NULL;
}

/* The same of whole numbers and booleans. */
static int32_t *whole_at(fmu *f, unsigned reference) {
    if (reference >= VALID && reference < VALID + 4)
        return &f->in.valid[reference - VALID];
    if (reference >= VALVE && reference < VALVE + 4)
        return &f->out.valve[reference - VALVE];
    if (reference >= SAND && reference < SAND + 4)
        return &f->out.sand[reference - SAND];
    return reference == DIRECTION ? &f->in.direction : reference == TRACK_BRAKE ? &f->out.track_brake : NULL;
}

#endif
