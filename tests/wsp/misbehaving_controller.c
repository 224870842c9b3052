/* A controller that does what no controller should, once its time has come: see DEEDS in test_foreign.py. */
#include "railslide_controller.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#ifndef VERSION
#define VERSION RAILSLIDE_ABI_VERSION
#endif

enum { GOOD, CRASH, EXIT, HANG, NOT_A_NUMBER, INFINITE, NO_SUCH_VALVE, NO_SUCH_SAND, ERROR, SILENT_ERROR, CHATTER,
       REFUSE = 20, CRASH_AT_START, HANG_AT_START, FORK_AT_START };

static int deed;
static double at_s;

static void crash(void) {
    volatile int *nowhere = NULL;
    *nowhere = 1;
}

static void hang(void) {
    for (volatile int i = 0;; i = 0) {
    }
}

int32_t railslide_abi_version(void) { return VERSION; }

void *railslide_create(double period_s, const railslide_parameter *parameters, int32_t count, char *message) {
    for (int32_t i = 0; i < count; i++) {
        if (strcmp(parameters[i].name, "deed") == 0)
            deed = (int)parameters[i].number;
        if (strcmp(parameters[i].name, "at_s") == 0)
            at_s = parameters[i].number;
        if (strcmp(parameters[i].name, "says") == 0)
            printf("%s", parameters[i].text);
    }
    if (deed == REFUSE) {
        strcpy(message, "not today");
        return NULL;
    }
    if (deed == CRASH_AT_START)
        crash();
    if (deed == HANG_AT_START)
        hang();
    if (deed == FORK_AT_START && fork() == 0)
        for (;;)
            pause();
    return &deed;
}

int32_t railslide_reset(void *controller, double t_s, int32_t direction, char *message) { return 0; }

int32_t railslide_step(void *controller, const railslide_input *in, railslide_output *out, char *message) {
    if (in->t_s < at_s)
        return 0;
    switch (deed) {
    case CRASH:
        printf("first line\n\033[2Jlast words"); /* what clears a terminal, and no line end */
        crash();
    case EXIT:
        exit(3);
    case HANG:
        hang();
    case NOT_A_NUMBER:
        out->reference_speed_mps = NAN;
        return 0;
    case INFINITE:
        out->reference_speed_mps = INFINITY;
        return 0;
    case NO_SUCH_VALVE:
        out->valve[1] = 7;
        return 0;
    case NO_SUCH_SAND:
        out->sand[2] = -1;
        return 0;
    case ERROR:
        strcpy(message, "axle 3 is on fire");
        return 1;
    case SILENT_ERROR:
        return 1;
    case CHATTER: /* far more than a pipe holds */
        for (int i = 0; i < 20000; i++)
            printf("tick tack\n");
    }
    return 0;
}

void railslide_destroy(void *controller) {}
