/* What the FMI functions of both versions have in common: one instance of the coach and its Python process. */
#ifndef RAILSLIDE_COACH_H
#define RAILSLIDE_COACH_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "child.h"
#include "variables.h" /* written at export: the table of variables.py */

#define LOG_CATEGORY "logStatusError"

typedef enum { INSTANTIATED, INITIALIZING, STEPPING, TERMINATED, BROKEN } CoachState;

typedef struct Coach Coach;

struct Coach {
    char *name;
    char *resources; /* folder */
    void (*log)(const Coach *coach, const char *text);
    void (*logger)(void); /* the host's callback, and what it wants to be called with: for `log` alone */
    void *environment;
    Child child;
    CoachState state;
    bool greeted; /* the child has said that it is there */
    double start_s;
    int64_t ticks;
    double values[VALUES];
};

/* `like` carries name, resources, log, logger and environment, which are copied; NULL if it cannot be made, and the
   reason is logged. The Python process is started; whether it fits shows in coach_initialize. */
Coach *coach_new(const Coach *like, const char *token);
void coach_free(Coach *coach);

/* All of these log why they fail. */
bool coach_initialize(Coach *coach, double start_s);
bool coach_begin(Coach *coach);
bool coach_step(Coach *coach, double from_s, double size_s);
bool coach_terminate(Coach *coach);
bool coach_reset(Coach *coach);
double coach_now_s(const Coach *coach);

/* Value of that kind ('r', 'i' or 'b'), NULL if there is none at this value reference. */
const double *coach_get(const Coach *coach, char kind, uint32_t reference);
bool coach_set(Coach *coach, char kind, uint32_t reference, double value);

/* Logs that the function is none of a co-simulation FMU of these capabilities; false. */
bool coach_lacks(const Coach *coach, const char *function);

#endif
